//! The page of one bundle.

use super::inline_svg::inline_svg;
use super::template::render;
use super::{Agreement, ReportContent};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct View<'a> {
    report: &'a ReportContent,
    /// The figures' drawings, as they may stand in a page; empty where a figure is none.
    drawings: Vec<String>,
    rule: &'static str,
    /// Mark and words of every agreement by its name.
    agreements: BTreeMap<String, [&'static str; 2]>,
}

/// One self-contained offline page: what the study does not show, its numbers beside the paper's, the
/// figures, the claims, the assumptions, and how to check it all.
pub fn page(content: &ReportContent) -> String {
    let all = [Agreement::Within, Agreement::Near, Agreement::Apart, Agreement::Silent];
    let name = |a: &Agreement| serde_json::to_value(a).ok()?.as_str().map(str::to_owned);
    let drawing = |f: &super::Figure| inline_svg(&f.svg, &f.alt).unwrap_or_default();
    let view = View {
        report: content,
        drawings: content.figures.iter().map(drawing).collect(),
        rule: Agreement::RULE,
        agreements: all.iter().filter_map(|a| Some((name(a)?, [a.mark(), a.words()]))).collect(),
    };
    render(include_str!("templates/page.html"), include_str!("templates/page.js"), &view)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{assert_offline, content};
    use super::*;

    #[test]
    fn limits_come_before_numbers_and_every_part_is_there() {
        let page = page(&content());
        assert_offline(&page);
        let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text} in the page"));
        let order = [
            "<h1>",
            "id=\"limits\"",
            "id=\"headline\"",
            "id=\"claims\"",
            "id=\"machine-claims\"",
            "id=\"table-1\"",
            "id=\"coverage\"",
            "id=\"assumptions\"",
            "id=\"provenance\"",
        ];
        assert!(order.windows(2).all(|pair| at(pair[0]) < at(pair[1])), "{order:?}");
        for text in [
            "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
            "parameters.mapping.particles",
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
            "more than two published sd away",
            "reenact verify prior-9f86d081.zip --level 3",
            "not reached",
            "a footprint never harms",
            "no range stated",
            "0.2 … 0.6: no verdict changes",
            "at 0.3: P1 supported → inconclusive",
            "15 trials per condition, one setting at a time, same noise",
        ] {
            at(text);
        }
        assert_eq!(page.matches("<svg").count(), 3);
        assert_eq!(page, super::page(&content()), "the same content gives the same bytes");
    }

    #[test]
    fn what_is_absent_leaves_no_empty_part() {
        let page = page(&ReportContent { title: "Nothing".into(), ..ReportContent::default() });
        for part in [
            "id=\"claims\"",
            "id=\"machine-claims\"",
            "id=\"tables\"",
            "id=\"figures\"",
            "id=\"assumptions\"",
            "id=\"limits\"",
        ] {
            assert!(!page.contains(part), "{part}");
        }
        assert_offline(&page);
    }

    #[test]
    fn hostile_content_stays_text() {
        let mut content = content();
        content.title = "</title><script>alert(1)</script>".into();
        content.claims[0].says = "<img src=x onerror=alert(1)>".into();
        content.figures[0].svg = "<svg><script>alert(2)</script></svg>".into();
        content.figures[1].svg = "not a drawing".into();
        let page = page(&content);
        assert!(!page.contains("<script>alert") && !page.contains("<img"));
        assert_eq!(page.matches("</script>").count(), 1);
        assert!(page.contains("This figure could not be read as SVG"));
    }
}
