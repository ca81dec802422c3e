//! `reenact export --site`: a bundle, the page that checks it and its report, ready for any host of files.

use crate::bundle::{Bundle, format};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::plan::ENGINE_VERSION;
use crate::report::{self, PAGE_GENERATOR, Site, page_under_banner};
use crate::store;
use crate::verify::plan_of;
use std::io::ErrorKind;
use std::path::Path;

/// The names of the pages of a site.
const PAGES: [&str; 3] = ["verify.html", "report.html", "index.html"];

/// Where the page that checks bundles says what wrote it.
const SAYS: &str = "<meta name=\"generator\" content=\"";

/// Bytes at its beginning in which it says so.
const HEAD: usize = 4096;

/// Reads the page at `path`, which must be one of this program's.
pub(super) fn checker(path: &Path) -> Result<Vec<u8>, Failure> {
    let page = load::bytes(path).map_err(|mut failure| {
        failure.message = format!("{}; {BUILT}", failure.message);
        failure
    })?;
    let head = String::from_utf8_lossy(&page[..page.len().min(HEAD)]);
    let told = head.split_once(SAYS).and_then(|(_, rest)| rest.split_once('"'));
    let expected = format!("{PAGE_GENERATOR} {}, engine {ENGINE_VERSION}", format::VERSION);
    match told.map(|(generator, _)| generator) {
        Some(generator) if generator == expected => Ok(page),
        found => {
            let found = match found {
                Some(generator) if generator.starts_with(PAGE_GENERATOR) => {
                    format!("`{generator}`")
                }
                _ => "another file".to_owned(),
            };
            Err(Failure::not_understood(format!(
                "`{}` cannot check this bundle: expected the page `{expected}`, found {found}; {BUILT}",
                path.display()
            )))
        }
    }
}

/// How the page is had.
const BUILT: &str = "`.ci/page` in the source of this program builds it as target/page/verify.html";

/// Returns an error unless a site may be written into `folder`: nothing that lies there already is to be published with it.
pub(super) fn is_free(folder: &Path) -> Result<(), Failure> {
    match store::holds_nothing(folder) {
        Ok(true) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(false) => Err(Failure::not_understood(format!(
            "`{}` is not empty: expected a new or empty folder, so that nothing else is published with the site; choose another, or \
             empty it",
            folder.display()
        ))),
        Err(error) => Err(Failure::not_understood(format!(
            "cannot write a site into `{}`: {}",
            folder.display(),
            store::reason(&error)
        ))),
    }
}

/// Writes the pages of the site of `bundle`, which lies in `folder` as the file `zip`.
pub(super) fn write(
    folder: &Path,
    zip: &str,
    bundle: &Bundle,
    (words, banner): (&str, Option<&str>),
    checker: &[u8],
) -> Result<Exit, Failure> {
    let (plan, selection) = plan_of(bundle).map_err(Failure::not_understood)?;
    let mut content = report::content_of(bundle, &plan, &selection)
        .map_err(|error| Failure { exit: Exit::No, message: error.to_string() })?;
    words.clone_into(&mut content.checked);
    let under = |page: String| match banner {
        Some(banner) => page_under_banner(&page, banner),
        None => page,
    };
    let [verify, report, index] = PAGES;
    let links = Site { bundle: zip, checker: verify, report };
    load::write(&folder.join(verify), checker)?;
    load::write(&folder.join(report), under(report::page(&content)).as_bytes())?;
    load::write(&folder.join(index), under(report::site_page(&content, links)).as_bytes())?;
    Ok(Exit::Yes)
}
