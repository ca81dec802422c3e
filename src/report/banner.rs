//! A banner over what is shown of a bundle that did not pass its check: whoever sees the page or drawing must see that.

use crate::figure::svg::Element;

/// Puts `page`, one of ours, under a banner that screen readers announce and printers print.
pub fn page_under_banner(page: &str, words: &str) -> String {
    // Inline, so that no print style hides it.
    let style = "margin:0;padding:.7rem 1rem;max-width:none;background:#8a1c00;color:#fff;font-weight:700;\
                 border-bottom:4px solid #000;print-color-adjust:exact;-webkit-print-color-adjust:exact";
    let banner = Element::new("p").set("class", "banner").set("role", "alert").set("style", style);
    let begin = "<body>\n";
    page.replacen(begin, &format!("{begin}{}\n", banner.text(words).into_string()), 1)
}

/// Puts a banner across the top of `drawing`, one of ours.
pub fn drawing_under_banner(drawing: &str, words: &str) -> String {
    let ground =
        Element::new("rect").set("width", "100%").at("height", 40.0).set("fill", "#8a1c00");
    // Two lines: a drawing is as wide as its map.
    let (first, second) = words.split_once(": ").unwrap_or((words, ""));
    let line = |y: f64, text: &str| {
        let line = Element::new("text").at("x", 8.0).at("y", y).set("fill", "#ffffff");
        line.set("font-family", "sans-serif").at("font-size", 12.0).text(text)
    };
    let banner = Element::new("g").set("class", "banner").set("role", "alert");
    let banner = banner.child(ground).child(line(16.0, first)).child(line(32.0, second));
    let banner = banner.into_string();
    match drawing.rfind("</svg>") {
        Some(end) => format!("{}{banner}\n{}", &drawing[..end], &drawing[end..]),
        None => drawing.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{assert_offline, content, recording};
    use super::super::{Shown, page, replay_page, still_svg};
    use super::*;

    const WORDS: &str = "NOT WHAT IT SAYS: <b>3 faults & more";

    #[test]
    fn every_page_shows_its_banner_first_and_once() {
        let recording = recording(5);
        for page in [page(&content()), replay_page("R", &[("a".into(), &recording)], &[])] {
            let shown = page_under_banner(&page, WORDS);
            assert_offline(&shown);
            let body = shown.split_once("<body>\n").unwrap().1;
            let banner = "<p class=\"banner\" role=\"alert\" style=\"";
            assert!(body.starts_with(banner), "{}", &body[..200]);
            let first = body.split_once("</p>").unwrap().0;
            assert!(first.ends_with(">NOT WHAT IT SAYS: &lt;b&gt;3 faults &amp; more"), "{first}");
            assert_eq!(shown.matches("class=\"banner\"").count(), 1);
        }
    }

    #[test]
    fn a_drawing_shows_its_banner_on_top_of_all_else() {
        let still = still_svg(&recording(5), None, Shown::Everything);
        let shown = drawing_under_banner(&still, WORDS);
        let read = roxmltree::Document::parse(&shown).unwrap();
        let last = read.root_element().children().rfind(roxmltree::Node::is_element).unwrap();
        assert_eq!(last.attribute("role"), Some("alert"));
        let told: Vec<_> = last.descendants().filter_map(|node| node.text()).collect();
        assert!(
            told.contains(&"NOT WHAT IT SAYS") && told.contains(&"<b>3 faults & more"),
            "{told:?}"
        );
    }
}
