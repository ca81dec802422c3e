//! The template engine, and what every page shares: its policy, its style, its data blocks.

use super::pack::base64;
use crate::digest::Sha256Digest;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, Value};
use serde::Serialize;

/// A page and the parts that it includes by name, beside the head that every page begins with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Template<'a> {
    /// The page itself.
    pub(super) page: &'static str,
    /// Name and text of every part.
    pub(super) parts: &'a [(&'static str, &'static str)],
}

/// Renders `template` with `context`, in the style that all pages share.
pub(super) fn render<C: Serialize>(template: &'static str, script: &str, context: &C) -> String {
    let template = Template { page: template, parts: &[] };
    render_in(template, &[super::STYLE], script, context)
}

/// Renders `template` with `context` and the style sheets `style`, one after the other. Every template escapes for HTML;
/// numbers go through `fixed`.
///
/// # Panics
/// Where one of our own templates is wrong, which every test of a page would find.
pub(super) fn render_in<C: Serialize>(
    template: Template<'_>,
    style: &[&str],
    script: &str,
    context: &C,
) -> String {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
    environment.set_syntax(syntax.expect("the delimiters are the usual ones"));
    environment.add_filter("fixed", fixed);
    environment.add_filter("percent", percent);
    environment.add_global("style", Value::from_safe_string(style.concat()));
    environment.add_global("script", Value::from_safe_string(script.to_owned()));
    environment.add_global("policy", Value::from_safe_string(policy(script)));
    let head = [("head", include_str!("templates/head.html"))];
    for (name, part) in head.iter().chain(template.parts) {
        environment.add_template(name, part).expect("our own templates parse");
    }
    let page = environment.render_str(template.page, Value::from(Serde(context)));
    page.expect("our own templates render")
}

/// Returns a content security policy under which nothing is fetched and no script runs but this page's own.
fn policy(script: &str) -> String {
    let source = script_source(script);
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; script-src {source}; \
         img-src data:; base-uri 'none'; form-action 'none'"
    )
}

/// Returns what lets `script` run under a content security policy.
pub fn script_source(script: &str) -> String {
    format!("'sha256-{}'", base64(&Sha256Digest::of(script).0))
}

/// Writes `value` with `decimals` decimals and a true minus sign.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    // Minus zero is zero to a reader.
    let negative = text.starts_with('-') && text.contains(|c: char| ('1'..='9').contains(&c));
    format!("{}{}", if negative { "\u{2212}" } else { "" }, text.trim_start_matches('-'))
}

/// Writes a signed whole percentage.
pub(super) fn percent(value: f64) -> String {
    let text = fixed(value, 0);
    let sign = if text.starts_with('\u{2212}') || text == "0" { "" } else { "+" };
    format!("{sign}{text}\u{a0}%")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_true_signs() {
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
        assert_eq!(fixed(-0.04, 1), "0.0");
        assert_eq!(fixed(f64::NAN, 1), "–");
        assert_eq!(percent(-46.6), "\u{2212}47\u{a0}%");
        assert_eq!(percent(1.5), "+2\u{a0}%");
        assert_eq!(percent(0.2), "0\u{a0}%");
    }

    #[test]
    fn everything_is_escaped_but_our_own_script() {
        let context = std::collections::BTreeMap::from([("x", "</script><b>\"'&")]);
        let page = render("<p>{{ x }}</p><script>{{ script }}</script>", "a<b", &context);
        let text = "<p>&lt;&#x2f;script&gt;&lt;b&gt;&quot;&#x27;&amp;</p><script>a<b</script>";
        assert_eq!(page, text);
        // openssl dgst -sha256 -binary <<< (no newline) "" | base64
        assert!(policy("").contains("'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='"));
    }
}
