//! The first page of a site that publishes one bundle: what it is, and the ways to it.

use super::template::render;
use super::{ReportContent, finding};
use serde::Serialize;

/// What lies beside the page, by the names of the files.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Site<'a> {
    /// The bundle.
    pub bundle: &'a str,
    /// The page that checks it.
    pub checker: &'a str,
    /// Its report.
    pub report: &'a str,
}

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct View<'a> {
    title: &'a str,
    checked: &'a str,
    finding: String,
    site: Site<'a>,
}

/// Returns the page that leads to the others.
pub fn site_page(content: &ReportContent, site: Site<'_>) -> String {
    let (title, checked) = (&content.title, &content.checked);
    let view = View { title, checked, finding: finding(content), site };
    render(include_str!("templates/site.html"), "", &view)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{assert_offline, content};
    use super::*;

    #[test]
    fn a_site_leads_to_its_bundle_its_check_and_its_report() {
        let site = Site { bundle: "s-1a2b3c4d.zip", checker: "verify.html", report: "report.html" };
        let page = site_page(&content(), site);
        assert_offline(&page);
        for link in ["verify.html?bundle=s-1a2b3c4d.zip\"", "\"report.html\"", "\"s-1a2b3c4d.zip\""]
        {
            assert_eq!(page.matches(&link.replace('/', "&#x2f;")).count(), 1, "{link}: {page}");
        }
        assert!(page.contains("reenact verify --level 5 s-1a2b3c4d.zip"), "{page}");
    }
}
