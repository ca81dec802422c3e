//! Figures for a paper: laid out anew for the width of its column, as SVG, as PDF, and as the numbers that are drawn.

mod drawing;
mod face;
mod pdf;

pub use drawing::Unprintable;

use crate::bundle::{Bundle, Fault, Forgetful, Gathered, assemble};
use crate::figure::{Medium, for_paper};
use crate::plan::Plan;
use drawing::Drawing;

/// Why a bundle's figures cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum NoFigures {
    /// Lines of it are no records.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Records(Vec<Fault>),
    /// One cannot be put on paper: a fault of this program.
    #[error("figure `{id}`: {why}")]
    Unprintable {
        /// The figure's id in the manifest.
        id: String,
        /// What is wrong.
        why: Unprintable,
    },
    /// Its manifest asks for none, or no trial has anything to show.
    #[error(
        "the bundle has no figure: its manifest asks for none under `figures`, or no trial that was run has anything to show"
    )]
    None,
}

/// Returns the figures of `bundle` for a column of `width_mm` mm: of each the drawing (`.svg`, `.pdf`) and what is drawn (`.csv`), by
/// file name.
///
/// # Errors
/// Where the records cannot be read, or there is no figure.
pub fn printed_figures(
    bundle: &Bundle,
    plan: &Plan,
    width_mm: f64,
) -> Result<Vec<(String, Vec<u8>)>, NoFigures> {
    let scratch = Forgetful::default();
    let Gathered { ledger, .. } = bundle.gathered(plan, &scratch).map_err(NoFigures::Records)?;
    let findings = assemble::findings(plan, &ledger);
    let experiment = &plan.experiment;
    let mut files = Vec::new();
    for request in &experiment.figures {
        let medium = Medium::Paper { width_mm };
        let Some(drawn) = request.draw_for(&findings, &experiment.tables, medium) else { continue };
        let svg = for_paper(&drawn.svg, width_mm);
        let id = &request.id;
        let drawing =
            Drawing::read(&svg).map_err(|why| NoFigures::Unprintable { id: id.clone(), why })?;
        files.push((format!("{id}.csv"), drawn.data.to_csv().into_bytes()));
        files.push((format!("{id}.pdf"), pdf::pdf(&drawing, width_mm)));
        files.push((format!("{id}.svg"), svg.into_bytes()));
    }
    if files.is_empty() { Err(NoFigures::None) } else { Ok(files) }
}
