//! What a plain scalar is, and which are refused.

use crate::document::{Content, quoted};

/// Reads a plain scalar by the core schema of YAML 1.2, or says why it is refused and what to write instead.
pub(super) fn plain_scalar(text: &str) -> Result<Content, (String, String)> {
    let old_boolean = |meant: bool| {
        Err((
            format!("`{text}` is a boolean in YAML 1.1 and text in YAML 1.2"),
            format!("write `{meant}` for the boolean or \"{text}\" for the text"),
        ))
    };
    match text {
        "" | "~" | "null" => return Ok(Content::Null),
        "true" => return Ok(Content::Bool(true)),
        "false" => return Ok(Content::Bool(false)),
        "yes" | "Yes" | "YES" | "on" | "On" | "ON" => return old_boolean(true),
        "no" | "No" | "NO" | "off" | "Off" | "OFF" => return old_boolean(false),
        "True" | "TRUE" | "False" | "FALSE" | "Null" | "NULL" => {
            let help = format!("write `{}`, or \"{text}\" for the text", text.to_ascii_lowercase());
            return Err((format!("`{text}` is written in lower case"), help));
        }
        _ => {}
    }
    let shown = quoted(text);
    let digits = text.trim_start_matches(['+', '-']);
    if text.len() - digits.len() > 1 {
        return Ok(Content::Text(text.to_owned()));
    }
    if matches!(digits, ".inf" | ".Inf" | ".INF" | ".nan" | ".NaN" | ".NAN") {
        return Err((
            format!("`{shown}` is not a finite number"),
            "write a finite number, or leave the key out where it is optional".to_owned(),
        ));
    }
    let Some(first) = digits.bytes().next().filter(|b| b.is_ascii_digit() || *b == b'.') else {
        return Ok(Content::Text(text.to_owned()));
    };
    let based = ["0x", "0o", "0b"].iter().any(|prefix| {
        digits.strip_prefix(prefix).is_some_and(|rest| {
            !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_hexdigit() || b == b'_')
        })
    });
    let grouped = digits.contains('_')
        && first.is_ascii_digit()
        && digits.bytes().all(|b| b.is_ascii_digit() || b"_.".contains(&b));
    if based || grouped {
        return Err((
            format!("`{shown}` is a number to some readers and text to others"),
            format!("write it in plain decimal digits, or \"{shown}\" for the text"),
        ));
    }
    if !is_decimal(digits) {
        return Ok(Content::Text(text.to_owned()));
    }
    if digits.len() > 1 && digits.starts_with('0') && digits.as_bytes()[1].is_ascii_digit() {
        return Err((
            format!("`{shown}` begins with a zero, which some readers take for octal"),
            format!("leave the zero out, or write \"{shown}\" for the text"),
        ));
    }
    if digits.bytes().all(|b| b.is_ascii_digit()) {
        return match text.parse::<i128>() {
            Ok(n) if (i128::from(i64::MIN)..=i128::from(u64::MAX)).contains(&n) => {
                Ok(Content::Integer(n))
            }
            _ => Err((
                format!("`{shown}` is too large to be kept exactly"),
                "whole numbers reach from -9223372036854775808 to 18446744073709551615".to_owned(),
            )),
        };
    }
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(Content::Float(x)),
        _ => Err((
            format!("`{shown}` is too large for a number"),
            "numbers reach to about 1.8e308".to_owned(),
        )),
    }
}

/// Returns whether `text` is `digits[.digits][e[+-]digits]`, with a digit before or after the point.
fn is_decimal(text: &str) -> bool {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text, None),
    };
    let all_digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    all_digits(whole)
        && all_digits(fraction)
        && !(whole.is_empty() && fraction.is_empty())
        && exponent.is_none_or(|e| {
            let digits = e.strip_prefix(['+', '-']).unwrap_or(e);
            !digits.is_empty() && all_digits(digits)
        })
}
