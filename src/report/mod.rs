//! What people look at: drawings of inputs, one offline page of a bundle, and pages in which trials play.
//!
//! Everything here is a pure function of its arguments: no clock, no file, no network. Pages carry their
//! style and script inside and forbid everything else by their own content security policy.

mod appendix;
mod assumptions;
pub mod bag;
mod banner;
mod claim;
mod content;
mod difference;
mod evaluation;
mod finding;
mod gain_still;
mod gather;
mod graph_still;
mod hinges;
mod inline_svg;
mod latex;
mod multiverse;
mod origin;
mod pack;
pub mod page;
mod played;
mod print;
mod recorded;
pub mod replay;
pub mod show;
mod site;
mod still;
mod template;

pub use appendix::{Packed, appendix};
pub use bag::{Bag, BagError, bag, bag_under_banner, foxglove_layout};
pub use banner::{drawing_under_banner, page_under_banner};
pub use claim::{ClaimRow, ComparisonRow, NoVerdicts};
pub use content::{
    Answer, Assumption, Citation, Figure, FlipRow, Headline, Matrix, MatrixCell, MatrixColumn,
    MatrixRow, OutcomeCount, RefusedDraw, ReportContent, ReportTable, Tried,
};
pub use difference::difference_page;
pub use evaluation::{Badge, Command, Evaluation};
pub use finding::finding;
pub use gain_still::{GainError, GainView, gain_svg};
pub use gather::{UnreadBundle, content_of};
pub use latex::latex;
pub use origin::{InputRow, Provenance};
pub use page::page;
pub use played::{Played, Sensing, play};
pub use print::{NoFigures, Unprintable, printed_figures};
pub use replay::{Note, replay_page};
pub use site::{Site, site_page};
pub use still::{Shown, still_svg};
pub use template::script_source;

/// How the page that checks bundles says what wrote it; its version and engine follow.
pub const PAGE_GENERATOR: &str = "Reenact verify.html";

/// The style that all pages share.
pub const STYLE: &str = include_str!("templates/style.css");

/// Returns what lets the scripts of reports and replays run under the content security policy of a page that frames them: what it
/// does not allow itself, its frames may not.
pub fn framed_script_sources() -> [String; 2] {
    [script_source(page::SCRIPT), script_source(replay::SCRIPT)]
}

#[cfg(test)]
mod fixtures;
