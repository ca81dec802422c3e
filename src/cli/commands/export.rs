//! `reenact export`: the same content in the forms that importers want.

use super::site;
use crate::bundle::{BundlePath, Edition, Files, Form, Tree, archive, format, in_bag, in_edition};
use crate::cli::args::{CrateEdition, DataFormat, ExportArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::Terminal;
use crate::cli::{checked, load};
use crate::report::{self, NoFigures, Packed};
use crate::verify::{path_in_bag, plan_of};
use serde_json::json;
use std::io;
use std::path::Path;

/// A column of most papers in two columns (mm).
const COLUMN_MM: f64 = 88.0;

/// Writes a bundle again.
pub(in crate::cli) fn run(args: &ExportArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let site = match (&args.site, &args.page) {
        (Some(folder), Some(page)) => {
            site::is_free(folder)?;
            Some((folder, site::checker(page)?))
        }
        _ => None,
    };
    let checked::Checked { bundle, words, banner } =
        checked::bundle(&args.bundle, args.unchecked, args.limits)?;
    let told = |path: &Path, form: &str| match args.format {
        DataFormat::Human => format!("{words}\n{}", path.display()),
        DataFormat::Json => json!({
            "path": path,
            "form": form,
            "results_digest": format!("sha256:{}", bundle.results_digest()),
            "checked": words,
        })
        .to_string(),
    };
    let stem = format!("{}-{}", bundle.name(), bundle.results_digest().short());
    if args.latex {
        let (plan, selection) = plan_of(&bundle).map_err(Failure::not_understood)?;
        let content = report::content_of(&bundle, &plan, &selection)
            .map_err(|error| Failure { exit: Exit::No, message: error.to_string() })?;
        let folder = args.out.join(format!("{stem}-latex"));
        for (name, text) in report::latex(&content) {
            load::write(&folder.join(name), text.as_bytes())?;
        }
        terminal.result(&told(&folder, "latex"));
        return Ok(Exit::Yes);
    }
    if args.appendix {
        let (plan, selection) = plan_of(&bundle).map_err(Failure::not_understood)?;
        let content = report::content_of(&bundle, &plan, &selection)
            .map_err(|error| Failure { exit: Exit::No, message: error.to_string() })?;
        let folder = args.out.join(format!("{stem}-appendix"));
        let file = format!("{stem}.zip");
        let bytes = bundle.files().iter().map(|(_, file)| file.size()).sum();
        for (name, text) in report::appendix(&content, Packed { file: &file, bytes }) {
            load::write(&folder.join(name), text.as_bytes())?;
        }
        terminal.result(&told(&folder, "appendix"));
        return Ok(Exit::Yes);
    }
    if let Some(folder) = &args.figures {
        let (plan, _) = plan_of(&bundle).map_err(Failure::not_understood)?;
        let files = report::printed_figures(&bundle, &plan, args.width.unwrap_or(COLUMN_MM));
        let files = files.map_err(|error| {
            let exit = match error {
                NoFigures::Unprintable { .. } => Exit::Failed,
                NoFigures::Records(_) => Exit::No,
                NoFigures::None => Exit::NotUnderstood,
            };
            Failure { exit, message: error.to_string() }
        })?;
        for (name, bytes) in files {
            load::write(&folder.join(name), &bytes)?;
        }
        terminal.result(&format!("{words}\n{}", folder.display()));
        return Ok(Exit::Yes);
    }
    let (mut tree, large) = in_bag(&bundle);
    if let Some(signature) = &args.signature {
        let bytes = load::text_bytes(signature)?;
        let path = path_in_bag(&bytes).ok_or_else(|| {
            let expected =
                "expected an OpenSSH signature (`ssh-keygen -Y sign`) or one of minisign";
            Failure::not_understood(format!("`{}`: {expected}", signature.display()))
        })?;
        tree.insert(path.to_owned(), bytes);
    }
    if args.dir {
        let folder = args.out.join(&stem);
        for (path, file) in (Files { tree: &tree, large: &large }).iter() {
            load::write_with(&folder.join(path), |mut out| {
                io::copy(&mut file.reader(), &mut out).map(drop)
            })?;
        }
        terminal.result(&told(&folder, "dir"));
        return Ok(Exit::Yes);
    }
    let (form, called, name) = match (args.flat, args.rocrate) {
        (true, _) => (Form::Flat, "flat", format!("{stem}.flat.zip")),
        (_, Some(edition)) => {
            restate(&mut tree, edition)?;
            (Form::Crate, "rocrate", format!("{stem}.crate.zip"))
        }
        _ => (Form::Bag, "bag", format!("{stem}.zip")),
    };
    let path = site.as_ref().map_or(args.out.as_path(), |(folder, _)| folder).join(&name);
    let files = Files { tree: &tree, large: &large };
    load::write_with(&path, |out| archive::write_to(files, &stem, form, out))?;
    if let Some((folder, checker)) = &site {
        let exit = site::write(folder, &name, &bundle, (&words, banner.as_deref()), checker)?;
        terminal.result(&told(folder, "site"));
        return Ok(exit);
    }
    terminal.result(&told(&path, called));
    Ok(Exit::Yes)
}

/// Puts the crate's metadata into the words of `edition`.
fn restate(tree: &mut Tree, edition: CrateEdition) -> Result<(), Failure> {
    let edition = match edition {
        CrateEdition::V1_1 => return Ok(()),
        CrateEdition::V1_3 => Edition::V1_3,
    };
    let path = BundlePath::payload(format::METADATA);
    let metadata = tree.get_mut(&*path).and_then(|metadata| {
        *metadata = in_edition(metadata, edition)?;
        Some(())
    });
    metadata.ok_or_else(|| Failure {
        exit: Exit::No,
        message: format!(
            "`{path}`: expected a crate's metadata as this program writes them, found others\nhelp: `--rocrate` without 1.3 writes \
             the crate as it is"
        ),
    })
}
