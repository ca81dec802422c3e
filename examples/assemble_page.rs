//! Assembles `verify.html` of its parts in `page/` and the module that `.ci/page` has compiled.
//!
//! `cargo run --release --example assemble_page MODULE.wasm VERIFY.html`

#![expect(clippy::print_stdout, reason = "it says what it wrote")]

use flate2::Compression;
use flate2::write::DeflateEncoder;
use reenact::bundle::format;
use reenact::plan::ENGINE_VERSION;
use reenact::report::{PAGE_GENERATOR, STYLE, framed_script_sources, script_source};
use std::error::Error;
use std::fs;
use std::io::Write as _;

/// Most bytes of the page: what a journal's site or a mail takes.
const LARGEST: usize = 6 << 20;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (module, out) = (arguments.next(), arguments.next());
    let (Some(module), Some(out)) = (module, out) else {
        return Err("expected the module and the page to write: MODULE.wasm VERIFY.html".into());
    };
    let mut packed = DeflateEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&fs::read(&module)?)?;
    let part =
        |name: &str| fs::read_to_string(format!("{}/page/{name}", env!("CARGO_MANIFEST_DIR")));
    let script = part("page.js")?;
    let [report, replay] = framed_script_sources();
    let own = script_source(&script);
    let parts = [
        (
            "policy",
            format!(
                "default-src 'none'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; worker-src blob:; \
                 script-src {own} {report} {replay} 'wasm-unsafe-eval'; base-uri 'none'; form-action 'none'"
            ),
        ),
        ("generator", format!("{PAGE_GENERATOR} {}, engine {ENGINE_VERSION}", format::VERSION)),
        ("version", format::VERSION.to_owned()),
        ("engine", ENGINE_VERSION.to_owned()),
        ("style", format!("{STYLE}{}", part("page.css")?)),
        ("worker", part("engine.js")? + &part("worker.js")?),
        ("module", in_letters(&packed.finish()?)),
        ("script", script),
    ];
    // One pass over the template: what a part holds is never read as a template.
    let (mut page, template) = (String::new(), part("page.html")?);
    let mut rest = template.as_str();
    while let Some((before, after)) = rest.split_once("[[") {
        let (name, after) = after.split_once("]]").ok_or("page.html: a `[[` is not closed")?;
        let known = parts.iter().find(|(known, _)| *known == name);
        let (_, text) = known.ok_or_else(|| format!("page.html: no part is called `{name}`"))?;
        page.push_str(before);
        page.push_str(text);
        rest = after;
    }
    page.push_str(rest);
    if page.len() > LARGEST {
        return Err(
            format!("expected a page of at most {LARGEST} bytes, found {}", page.len()).into()
        );
    }
    fs::write(&out, &page)?;
    println!("{out}: {} bytes", page.len());
    Ok(())
}

/// Writes `bytes` in 85 letters that may stand in a page, five for each four bytes with the highest first, and before them how many
/// bytes there are: base64 would need a fifteenth more. `page/page.js` reads it.
fn in_letters(bytes: &[u8]) -> String {
    let mut text = format!("{} ", bytes.len());
    for four in bytes.chunks(4) {
        let mut padded = [0; 4];
        padded[..four.len()].copy_from_slice(four);
        let mut number = u32::from_be_bytes(padded);
        let mut letters = [0_u8; 5];
        for letter in letters.iter_mut().rev() {
            let digit = u8::try_from(number % 85).expect("a remainder of 85 is a byte");
            // A page reads `<` otherwise.
            *letter = if b'#' + digit == b'<' { b'}' } else { b'#' + digit };
            number /= 85;
        }
        text.extend(letters.iter().map(|letter| char::from(*letter)));
    }
    text
}
