//! The `allowed_signers` file of OpenSSH (ssh-keygen(1), ALLOWED SIGNERS): who may sign, with which key, for what, when.
//!
//! ```text
//! alice@example.org namespaces="reenact" ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAA... laptop
//! ```

use crate::bundle::Moment;
use crate::document::{Diagnostic, FaultList, Source};
use ssh_key::PublicKey;
use ssh_key::public::KeyData;
use std::ops::Range;

/// One line: a key and what it is trusted for.
#[derive(Debug, Clone)]
pub(super) struct Signer {
    /// Comma-separated principals, as written.
    pub(super) principals: String,
    key: PublicKey,
    pub(super) limits: Limits,
}

/// What a key is trusted for; without limits for everything, always.
#[derive(Debug, Clone, Default)]
pub(super) struct Limits {
    /// Comma-separated patterns of namespaces.
    namespaces: Option<String>,
    pub(super) valid_after: Option<Moment>,
    pub(super) valid_before: Option<Moment>,
    /// The key signs certificates, not files. We read no certificates.
    is_authority: bool,
}

impl Signer {
    /// Returns whether `key` is this signer's own.
    pub(super) fn owns(&self, key: &KeyData) -> bool {
        !self.limits.is_authority && self.key.key_data() == key
    }
}

impl Limits {
    /// Returns whether signatures of `namespace` count.
    pub(super) fn may_sign(&self, namespace: &str) -> bool {
        let Some(patterns) = &self.namespaces else { return true };
        let mut allowed = false;
        for pattern in patterns.split(',') {
            match pattern.strip_prefix('!') {
                Some(denied) if matches(denied.as_bytes(), namespace.as_bytes()) => return false,
                Some(_) => {}
                None => allowed |= matches(pattern.as_bytes(), namespace.as_bytes()),
            }
        }
        allowed
    }

    /// Returns whether the key is trusted at `now`.
    pub(super) fn is_valid(&self, now: Moment) -> bool {
        self.valid_after.is_none_or(|after| after <= now)
            && self.valid_before.is_none_or(|before| now < before)
    }
}

/// Returns whether `text` fits `pattern`, in which `*` stands for any text, `?` for one character (ssh_config(5),
/// PATTERNS).
fn matches(pattern: &[u8], text: &[u8]) -> bool {
    match pattern.split_first() {
        None => text.is_empty(),
        Some((b'*', rest)) => (0..=text.len()).any(|skipped| matches(rest, &text[skipped..])),
        Some((b'?', rest)) => text.split_first().is_some_and(|(_, text)| matches(rest, text)),
        Some((byte, rest)) => {
            text.split_first().is_some_and(|(first, text)| first == byte && matches(rest, text))
        }
    }
}

/// Reads the file.
///
/// # Errors
/// Every line that is not understood, and a file that names nobody.
pub(super) fn read(source: &Source) -> Result<Vec<Signer>, Vec<Diagnostic>> {
    let (mut signers, mut faults) = (Vec::new(), FaultList::default());
    let mut start = 0;
    let is_told = |line: &&str| !line.is_empty() && !line.starts_with('#');
    let told: Vec<&str> = source.text.lines().map(str::trim).filter(is_told).collect();
    if !told.iter().any(|line| line.split_whitespace().any(looks_like_a_key)) {
        // No line is shown where none is a key: it may be any file, named by a slip.
        let found = if told.is_empty() { "none" } else { "text of which no line is one" };
        return Err(vec![
            Diagnostic::placeless(format!(
                "`{}`: expected keys to trust, found {found}",
                source.name
            ))
            .help("it must be an OpenSSH `allowed_signers` file or a minisign public key"),
        ]);
    }
    for line in source.text.split_inclusive('\n') {
        let begin = start + line.len() - line.trim_start().len();
        start += line.len();
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match signer(line) {
            Ok(signer) => signers.push(signer),
            Err(Misread { span, message, label }) => faults.push(
                Diagnostic::error(source, begin + span.start..begin + span.end, message)
                    .label(label)
                    .help("a line is PRINCIPALS [OPTIONS] KEYTYPE KEY [COMMENT], as in ssh-keygen(1), ALLOWED SIGNERS"),
            ),
        }
    }
    if faults.is_empty() { Ok(signers) } else { Err(faults.finish()) }
}

struct Misread {
    span: Range<usize>,
    message: String,
    label: &'static str,
}

fn signer(line: &str) -> Result<Signer, Misread> {
    let principals = word(line, 0);
    let after = skip_blanks(line, principals.end);
    let (mut limits, mut at) = (Limits::default(), after);
    // As ssh-keygen does: what is not a key must be options, and then the key.
    let mut key = PublicKey::from_openssh(&line[after..]);
    if key.is_err() && !looks_like_a_key(&line[after..]) {
        let written = word(line, after);
        at = skip_blanks(line, written.end);
        limits = options(line, written)?;
        key = PublicKey::from_openssh(&line[at..]);
    }
    let principals = line[principals].trim_matches('"').to_owned();
    key.map(|key| Signer { principals, key, limits }).map_err(|_| Misread {
        span: at..line.len(),
        message: "a trusted key cannot be read".to_owned(),
        label: "expected a public key such as `ssh-ed25519 AAAA...`",
    })
}

fn looks_like_a_key(text: &str) -> bool {
    ["ssh-", "ecdsa-", "sk-ssh-", "sk-ecdsa-"].iter().any(|kind| text.starts_with(kind))
}

/// Returns the word at `from`: up to a blank that is not within quotes.
fn word(line: &str, from: usize) -> Range<usize> {
    let mut quoted = false;
    let end = line[from..].find(|c: char| {
        quoted ^= c == '"';
        c.is_ascii_whitespace() && !quoted
    });
    from..end.map_or(line.len(), |end| from + end)
}

fn skip_blanks(line: &str, from: usize) -> usize {
    line.len() - line[from..].trim_start().len()
}

/// Reads the comma-separated options at `span`.
fn options(line: &str, span: Range<usize>) -> Result<Limits, Misread> {
    let mut limits = Limits::default();
    let mut at = span.start;
    while at < span.end {
        let mut quoted = false;
        let length = line[at..span.end].find(|c: char| {
            quoted ^= c == '"';
            c == ',' && !quoted
        });
        let end = length.map_or(span.end, |length| at + length);
        option(&line[at..end], &mut limits).map_err(|(message, label)| Misread {
            span: at..end,
            message,
            label,
        })?;
        at = end + 1;
    }
    Ok(limits)
}

fn option(written: &str, limits: &mut Limits) -> Result<(), (String, &'static str)> {
    let (name, value) = match written.split_once('=') {
        Some((name, value)) => {
            let bare = value.strip_prefix('"').and_then(|value| value.strip_suffix('"'));
            let wrong = || {
                (
                    format!("the value of `{name}` is not quoted"),
                    "expected it between double quotes",
                )
            };
            (name, Some(bare.ok_or_else(wrong)?))
        }
        None => (written, None),
    };
    match (name.to_ascii_lowercase().as_str(), value) {
        ("cert-authority", None) => limits.is_authority = true,
        ("namespaces", Some(value)) => limits.namespaces = Some(value.to_owned()),
        (name @ ("valid-after" | "valid-before"), Some(value)) => {
            let moment = moment(value).ok_or_else(|| {
                (
                    format!("`{value}` is no date of `{name}`"),
                    "expected YYYYMMDD, YYYYMMDDHHMM or YYYYMMDDHHMMSS, taken as UTC",
                )
            })?;
            let field = if name == "valid-after" {
                &mut limits.valid_after
            } else {
                &mut limits.valid_before
            };
            *field = Some(moment);
        }
        _ => {
            return Err((
                format!("unknown option `{name}` of a trusted key"),
                "expected cert-authority, namespaces=, valid-after= or valid-before=",
            ));
        }
    }
    Ok(())
}

/// Reads an instant: `YYYYMMDD`, `YYYYMMDDHHMM` or `YYYYMMDDHHMMSS`, with or without `Z`. Without it OpenSSH means the
/// machine's own zone; we mean UTC, so that a check gives the same answer everywhere.
fn moment(text: &str) -> Option<Moment> {
    let digits = text.strip_suffix('Z').unwrap_or(text);
    if !digits.bytes().all(|b| b.is_ascii_digit()) || ![8, 12, 14].contains(&digits.len()) {
        return None;
    }
    let padded = format!("{digits:0<14}");
    Moment::from_iso(&format!(
        "{}-{}-{}T{}:{}:{}+00:00",
        &padded[..4],
        &padded[4..6],
        &padded[6..8],
        &padded[8..10],
        &padded[10..12],
        &padded[12..14]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str =
        "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIB4RJ5vmEBRyhfcnYdcYMpxIVSVb1pQyYsBpmBGpmSAh";

    fn read_text(text: &str) -> Result<Vec<Signer>, String> {
        read(&Source::new("signers", text))
            .map_err(|faults| faults.iter().map(|fault| fault.render(false)).collect())
    }

    #[test]
    fn lines_are_read_as_ssh_keygen_does() {
        let text = format!(
            "# who\n\n  alice@a.org {KEY} laptop\n\"bob@b.org,c d\" namespaces=\"git,re*\",valid-after=\"20200101\",\
             valid-before=\"202101011200Z\" {KEY}\n*@ca.org cert-authority {KEY}\n"
        );
        let signers = read_text(&text).unwrap();
        let principals: Vec<_> = signers.iter().map(|s| s.principals.as_str()).collect();
        assert_eq!(principals, ["alice@a.org", "bob@b.org,c d", "*@ca.org"]);
        let key = signers[0].key.key_data();
        assert_eq!(signers.iter().map(|s| s.owns(key)).collect::<Vec<_>>(), [true, true, false]);
        let bob = &signers[1].limits;
        assert_eq!(bob.valid_after.unwrap().iso(), "2020-01-01T00:00:00+00:00");
        assert_eq!(bob.valid_before.unwrap().iso(), "2021-01-01T12:00:00+00:00");
        let within = |iso: &str| bob.is_valid(Moment::from_iso(iso).unwrap());
        assert!(within("2020-01-01T00:00:00+00:00") && within("2021-01-01T11:59:59+00:00"));
        assert!(!within("2019-12-31T23:59:59+00:00") && !within("2021-01-01T12:00:00+00:00"));
    }

    #[test]
    fn namespaces_are_patterns() {
        let may = |patterns: &str, namespace: &str| {
            let text = format!("a namespaces=\"{patterns}\" {KEY}\n");
            read_text(&text).unwrap()[0].limits.may_sign(namespace)
        };
        assert!(may("reenact", "reenact") && may("git,re?n*", "reenact") && may("*", "reenact"));
        assert!(!may("git", "reenact") && !may("*,!reen*", "reenact") && !may("reenac", "reenact"));
    }

    #[test]
    fn every_fault_is_told_at_its_place() {
        let help = "a line is PRINCIPALS [OPTIONS] KEYTYPE KEY [COMMENT], as in ssh-keygen(1), ALLOWED SIGNERS";
        let text = format!(
            "a ssh-ed25519 AAAA\nb valid-after=\"soon\" {KEY}\nc namespace=\"x\" {KEY}\nd namespaces=x {KEY}\ne\n"
        );
        let Err(told) = read_text(&text) else { panic!("the file is faulty") };
        let lines: Vec<&str> = told
            .lines()
            .filter(|line| line.starts_with("error") || line.contains("-->") || line.contains('^'))
            .collect();
        let expected = [
            "error: a trusted key cannot be read",
            " --> signers:1:3",
            "  |   ^^^^^^^^^^^^^^^^ expected a public key such as `ssh-ed25519 AAAA...`",
            "error: `soon` is no date of `valid-after`",
            " --> signers:2:3",
            "  |   ^^^^^^^^^^^^^^^^^^ expected YYYYMMDD, YYYYMMDDHHMM or YYYYMMDDHHMMSS, taken as UTC",
            "error: unknown option `namespace` of a trusted key",
            " --> signers:3:3",
            "  |   ^^^^^^^^^^^^^ expected cert-authority, namespaces=, valid-after= or valid-before=",
            "error: the value of `namespaces` is not quoted",
            " --> signers:4:3",
            "  |   ^^^^^^^^^^^^ expected it between double quotes",
            "error: a trusted key cannot be read",
            " --> signers:5:2",
            "  |  ^ expected a public key such as `ssh-ed25519 AAAA...`",
        ];
        assert_eq!(lines, expected);
        assert_eq!(told.matches(help).count(), 5);
        assert_eq!(
            read_text("# nobody\n").unwrap_err(),
            "error: `signers`: expected keys to trust, found none\n |\n = help: it must be an OpenSSH `allowed_signers` file \
             or a minisign public key\n"
        );
    }
}
