//! `index.html`: what was found, for whoever opens the folder in a browser. No script, nothing from the network; what it shows
//! lies beside it in the bundle.

use super::{Account, BundleContent, ToldClaim, ToldTable, format};
use crate::digest::ResultsDigest;
use crate::figure::svg::escape;
use crate::table::{Table, Value};

/// Tables of more lines are folded.
const LONG: usize = 40;

const STYLE: &str = ":root{color-scheme:light dark;--ink:#1a1a1a;--soft:#55595f;--ground:#fff;--edge:#d5d6d8;--link:#00568a;\
--good:#00694c;--bad:#a63d00}\
@media screen and (prefers-color-scheme:dark){:root{--ink:#ececea;--soft:#a9adb3;--ground:#14161a;--edge:#3a3e45;--link:#7cc4f5;\
--good:#4fd1a5;--bad:#ff9a5c}}\
*{box-sizing:border-box}body{font:16px/1.5 system-ui,sans-serif;max-width:64rem;margin:0 auto;padding:1rem;color:var(--ink);\
background:var(--ground);overflow-wrap:anywhere}h1,h2,h3{line-height:1.25}h2{margin-top:2.2rem}p,ul{max-width:46rem}\
a{color:var(--link)}:focus-visible{outline:3px solid var(--link);outline-offset:2px}.soft{color:var(--soft)}\
.finding{font-size:1.15rem;border-left:5px solid var(--link);padding-left:.8rem}\
code,pre{font:.86em ui-monospace,Menlo,Consolas,monospace}pre{border:1px solid var(--edge);border-radius:6px;padding:.6rem .8rem;\
white-space:pre-wrap}.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}\
th,td{text-align:left;vertical-align:top;padding:.3rem .8rem .3rem 0;border-bottom:1px solid var(--edge);overflow-wrap:normal}\
td.number{text-align:right}.verdict{white-space:nowrap;font-weight:600}.supported{color:var(--good)}.contradicted{color:var(--bad)}\
figure{margin:1.5rem 0}img{display:block;max-width:100%;height:auto;background:#fff;padding:.5rem;border:1px solid var(--edge);\
border-radius:6px}summary{cursor:pointer}\
@media (max-width:40rem){.claims thead{display:none}.claims tr{display:block;border-bottom:1px solid var(--edge);padding:.4rem 0}\
.claims td,.claims th{display:block;border:0;padding:.1rem 0}.claims td[data-is]::before{content:attr(data-is) \": \";\
color:var(--soft);font-weight:400}}\
@media print{body{font-size:10pt;max-width:none;padding:0}figure,tr{break-inside:avoid}h2,h3{break-after:avoid}\
img{border:0;padding:0;max-height:18cm}}";

/// Nothing but the style within and pictures beside it.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src 'self' file: data:";

/// Writes the page of the bundle that is called `stem`.
pub(super) fn page(content: &BundleContent, stem: &str, digest: ResultsDigest) -> String {
    let account = &content.account;
    let title = escape(&content.title);
    // What begins with the title has just been read.
    let description = content.description.strip_prefix(&format!("{}. ", content.title));
    let description = escape(description.unwrap_or(&content.description));
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<title>{title}</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n\
         <p class=\"soft\">{description}</p>\n"
    );
    if !account.finding.is_empty() {
        text.push_str(&format!("<p class=\"finding\">{}</p>\n", escape(&account.finding)));
    }
    if let Some(partial) = &account.partial {
        text.push_str(&format!("<p><strong>Partial run</strong>: {}</p>\n", escape(partial)));
    }
    text.push_str(&contents(account));
    if !account.limits.is_empty() {
        let items = account.limits.iter().map(|limit| format!("<li>{}</li>\n", escape(limit)));
        text.push_str(&section("limits", "What the numbers cannot show"));
        text.push_str(&format!("<ul>\n{}</ul>\n", items.collect::<String>()));
    }
    if !account.claims.is_empty() {
        text.push_str(&section("claims", "Claims"));
        let is_ours = |claim: &&ToldClaim| claim.is_ours;
        let (own, papers): (Vec<_>, Vec<_>) = account.claims.iter().partition(is_ours);
        text.push_str(&claims("the paper says", &papers));
        text.push_str(&claims("we check besides", &own));
        text.push_str(
            "<p class=\"soft\">The numbers behind each verdict: <a href=\"results/claims.json\">results/claims.json</a></p>\n",
        );
    }
    if !account.tables.is_empty() {
        text.push_str(&section("tables", "Tables"));
        text.extend(account.tables.iter().map(table));
    }
    if !account.figures.is_empty() {
        text.push_str(&section("figures", "Figures"));
        for figure in &account.figures {
            let [path, title, caption, alt] =
                [&figure.path, &figure.title, &figure.caption, &figure.alt].map(|t| escape(t));
            text.push_str(&format!(
                "<figure><a href=\"{path}\"><img src=\"{path}\" alt=\"{alt}\"></a>\n\
                 <figcaption><strong>{title}.</strong> {caption}</figcaption></figure>\n"
            ));
        }
    }
    text.push_str(&check(content, stem, digest));
    text + "</main>\n</body>\n</html>\n"
}

fn section(id: &str, title: &str) -> String {
    format!("<h2 id=\"{id}\">{title}</h2>\n")
}

/// Links to the parts that are there.
fn contents(account: &Account) -> String {
    let parts = [
        ("limits", "limits", account.limits.is_empty()),
        ("claims", "claims", account.claims.is_empty()),
        ("tables", "tables", account.tables.is_empty()),
        ("figures", "figures", account.figures.is_empty()),
        ("check", "how to check it", false),
    ];
    let there = parts.iter().filter(|(.., is_empty)| !is_empty);
    let links: Vec<String> =
        there.map(|(id, words, _)| format!("<a href=\"#{id}\">{words}</a>")).collect();
    format!("<nav aria-label=\"Parts\">{}</nav>\n", links.join(" · "))
}

fn claims(heading: &str, claims: &[&ToldClaim]) -> String {
    if claims.is_empty() {
        return String::new();
    }
    let rows = claims.iter().map(|claim| {
        let [id, words, cite, verdict, paper] =
            [&claim.id, &claim.words, &claim.cite, &claim.verdict, &claim.paper_table]
                .map(|text| escape(text));
        let mark = match claim.verdict.as_str() {
            "supported" => "✓",
            "contradicted" => "✗",
            "inconclusive" => "○",
            _ => "–",
        };
        let words = if claim.is_ours { words } else { format!("<q>{words}</q>") };
        let cite = if cite.is_empty() { cite } else { format!(" <span class=\"soft\">{cite}</span>") };
        let shown = verdict.replace('-', " ");
        let own = if paper == "silent" { paper } else { format!("{paper} it") };
        format!(
            "<tr id=\"claim-{id}\"><th scope=\"row\">{id}</th><td>{words}{cite}</td>\
             <td class=\"verdict {verdict}\" data-is=\"here\">{mark} {shown}</td><td data-is=\"the paper's own table\">{own}</td></tr>\n"
        )
    });
    let rows: String = rows.collect();
    format!(
        "<div class=\"scroll\"><table class=\"claims\"><thead><tr><th scope=\"col\">id</th><th scope=\"col\">{heading}</th>\
         <th scope=\"col\">here</th><th scope=\"col\">the paper's own table</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

fn table(told: &ToldTable) -> String {
    let (path, title) = (escape(&told.path), escape(&told.title));
    let mut text = format!("<h3>{title}</h3>\n");
    if let Some(answer) = &told.answer {
        text.push_str(&format!("<p>{}</p>\n", escape(answer)));
    }
    let lines = lines(&told.lines, &title);
    let count = told.lines.rows.len();
    if count > LONG {
        text.push_str(&format!("<details><summary>{count} lines</summary>\n{lines}</details>\n"));
    } else {
        text.push_str(&lines);
    }
    let more = if told.more > 0 { format!("{} more lines in ", told.more) } else { String::new() };
    text.push_str(&format!("<p class=\"soft\">{more}<a href=\"{path}\">{path}</a>"));
    if let Some(rules) = &told.rules {
        text.push_str(&format!("; marks: {}", escape(rules)));
    }
    text + "</p>\n"
}

fn lines(table: &Table, title: &str) -> String {
    let heads = table.columns.iter().map(|name| format!("<th scope=\"col\">{}</th>", escape(name)));
    let cell = |value: &Value| {
        let text = escape(&value.to_string());
        let is_number = text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
        format!("<td{}>{text}</td>", if is_number { " class=\"number\"" } else { "" })
    };
    let rows = table.rows.iter().map(|row| {
        let cells: String = row.iter().map(cell).collect();
        format!("<tr>{cells}</tr>\n")
    });
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table: {title}\"><table>\
         <thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
        heads.collect::<String>(),
        rows.collect::<String>()
    )
}

fn check(content: &BundleContent, stem: &str, digest: ResultsDigest) -> String {
    let stem = escape(stem);
    let mut links = vec![
        (format::README, "how to check it and run it again, read the data"),
        (format::DICTIONARY, "every column of every CSV file"),
        ("results/trials.csv", "one line a trial"),
        (format::STUDY, "the manifest"),
        (format::CITATION, "how to cite it"),
        (format::LICENSE, "under which licence"),
        (format::PREVIEW, "every file, and when it was run"),
    ];
    let trials = content.results.iter().any(|(path, _)| path == "trials.csv")
        || content.large_results.iter().any(|(path, _)| path == "trials.csv");
    links.retain(|(path, _)| trials || *path != "results/trials.csv");
    let links = links
        .iter()
        .map(|(path, words)| format!("<li><a href=\"{path}\">{path}</a>: {words}</li>\n"));
    let links: String = links.collect();
    format!(
        "{}<p>Nothing of ours is needed to see that no file changed; in the folder above this one:</p>\n\
         <pre>sha256sum --check manifest-sha256.txt tagmanifest-sha256.txt</pre>\n\
         <p>Reenact derives every table, figure and verdict again, and runs trials again, bit for bit; where the bundle lies:</p>\n\
         <pre>reenact verify {stem}.zip\nreenact verify {stem}.zip --level 5\nreenact report {stem}.zip</pre>\n\
         <p class=\"soft\">Results digest <code>sha256:{digest}</code></p>\n<ul>\n{links}</ul>\n",
        section("check", "How to check it")
    )
}

#[cfg(test)]
mod tests {
    use super::super::{sample, seal};
    use super::*;

    fn page_of(content: &BundleContent) -> String {
        let sealed = seal(content, &sample::circumstance()).unwrap();
        String::from_utf8(sealed.tree["data/index.html"].clone()).unwrap()
    }

    #[test]
    fn it_tells_the_finding_first_and_links_to_what_is_there() {
        let content = sample::content();
        let sealed = seal(&content, &sample::circumstance()).unwrap();
        let page = page_of(&content);
        let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is not in {page}"));
        assert!(
            at("<p class=\"finding\">Of the paper&apos;s one claim, 1 holds here.</p>") < at("<h2")
        );
        assert!(at("The corridors are invented.") < at("✓ supported"));
        at("<q>A floor plan shortens the way.</q> <span class=\"soft\">section 3</span>");
        at("<td data-is=\"the paper's own table\">supports it</td>");
        at(&format!("reenact verify {}.zip --level 5", sealed.stem));
        assert!(!page.contains("<script") && !page.contains("http:") && !page.contains("https:"));
        let links =
            page.split("href=\"").chain(page.split("src=\"")).filter(|l| !l.starts_with('<'));
        let mut count = 0;
        for link in links.map(|rest| rest.split('"').next().unwrap()) {
            count += 1;
            let is_there = match link.strip_prefix('#') {
                Some(id) => page.contains(&format!("<h2 id=\"{id}\">")),
                None => link == "data:," || sealed.tree.contains_key(&format!("data/{link}")),
            };
            assert!(is_there, "{link}");
        }
        assert!(count > 12, "{count} links");
    }

    #[test]
    fn what_a_stranger_wrote_stays_text() {
        let evil = "<script>alert(1)</script>\"'&";
        let mut content = sample::content();
        content.title = evil.into();
        content.account.finding = evil.into();
        content.account.limits = vec![evil.into()];
        content.account.partial = Some(evil.into());
        let claim = &mut content.account.claims[0];
        (claim.id, claim.words, claim.cite) = (evil.into(), evil.into(), evil.into());
        (claim.verdict, claim.paper_table) = (evil.into(), evil.into());
        let table = &mut content.account.tables[0];
        (table.title, table.answer, table.rules) =
            (evil.into(), Some(evil.into()), Some(evil.into()));
        table.lines = Table::new([evil]);
        table.lines.push(vec![evil.into()]);
        let figure = &mut content.account.figures[0];
        (figure.title, figure.caption, figure.alt) = (evil.into(), evil.into(), evil.into());
        let page = page_of(&content);
        assert!(!page.contains("<script") && !page.contains("alert(1)</script>"), "{page}");
        assert_eq!(page.matches("&lt;script&gt;").count(), 21, "{page}");
    }
}
