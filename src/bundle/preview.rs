//! `ro-crate-preview.html`: the page that archives show for a crate. No script, nothing from the network.

use super::{BundleContent, Circumstance, Files, format, in_payload};
use crate::digest::ResultsDigest;
use crate::figure::svg::escape;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}\
h1,h2{line-height:1.2}code{font-size:.85em;overflow-wrap:anywhere}table{border-collapse:collapse;width:100%}\
td,th{text-align:left;padding:.25em .75em .25em 0;border-bottom:1px solid #ddd;vertical-align:top}\
td:last-child,th:last-child{text-align:right;padding-right:0}img{max-width:100%;height:auto}figure{margin:1em 0}";

/// Writes the page.
pub(super) fn page(
    content: &BundleContent,
    circumstance: &Circumstance,
    payload: Files<'_>,
    digest: ResultsDigest,
) -> String {
    let mut facts = String::new();
    let mut fact = |name: &str, value: String| {
        facts.push_str(&format!("<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>\n"));
    };
    let authors: Vec<_> = content.authors.iter().map(|a| escape(&a.name)).collect();
    if !authors.is_empty() {
        fact("Authors", authors.join(", "));
    }
    if let Some(cite) = &content.cite {
        fact("Reproduces", escape(&cite.text));
    }
    fact("Licence", escape(&content.license));
    fact("Run", format!("{} (as the run tells it)", escape(&circumstance.ended.iso())));
    fact("Engine", escape(&content.engine));
    fact("Results digest", format!("<code>sha256:{digest}</code>"));
    // The time of the run is its own word; this is the author's.
    let tables = [("Robustness", &content.robustness), ("Multiverse", &content.multiverse)];
    for (name, path) in tables {
        let Some(path) = path.as_deref().map(escape) else { continue };
        let words = format!(
            "<a href=\"{path}\">{path}</a> is the author's word until its runs are done again: <code>reenact verify --level 4 \
             --robustness all</code>"
        );
        fact(name, words);
    }

    let (mut figures, mut files) = (String::new(), String::new());
    for (path, file) in payload.iter() {
        let path = escape(in_payload(path).unwrap_or(path));
        if format::media_type(&path) == "image/svg+xml" && path.starts_with(format::RESULTS) {
            figures.push_str(&format!(
                "<figure><img src=\"{path}\" alt=\"{path}\"><figcaption>{path}</figcaption></figure>\n"
            ));
        }
        files.push_str(&format!(
            "<tr><td><a href=\"{path}\">{path}</a></td><td>{} bytes</td></tr>\n",
            file.size()
        ));
    }
    if !figures.is_empty() {
        figures.insert_str(0, "<h2>Figures</h2>\n");
    }
    let partial = if content.partial {
        "<p><strong>Partial run</strong>: no claim is judged on it.</p>\n"
    } else {
        ""
    };
    let (title, description) = (escape(&content.title), escape(&content.description));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p>{description}</p>\n{partial}<table>\n{facts}</table>\n\
         {figures}<h2>Files</h2>\n<table>\n{files}</table>\n</body>\n</html>\n"
    )
}
