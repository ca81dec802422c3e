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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::Limits;
    use crate::figure::tests::{bar_chart, line_chart, policy_chart, scatter, share_chart};
    use crate::verify::plan_of;

    #[test]
    fn every_kind_of_chart_can_be_printed() {
        let medium = Medium::Paper { width_mm: 88.0 };
        for svg in [
            line_chart(&["a", "b"]).to_svg_on(medium),
            bar_chart().to_svg_on(medium),
            share_chart().to_svg_on(medium),
            scatter().to_svg_on(medium),
            policy_chart().to_svg_on(medium),
        ] {
            let drawing = Drawing::read(&for_paper(&svg, 88.0)).unwrap();
            assert!(drawing.marks.len() > 20 && !drawing.title.is_empty());
            let sizes = drawing.marks.iter().filter_map(|mark| match &mark.shape {
                drawing::Shape::Text { size, .. } => {
                    Some(size * 88.0 * 72.0 / 25.4 / drawing.width)
                }
                drawing::Shape::Path(_) => None,
            });
            let sizes: Vec<f64> = sizes.collect();
            assert!(sizes.iter().all(|size| (7.0..=8.0).contains(size)), "points: {sizes:?}");
        }
    }

    #[test]
    fn a_bundle_gives_each_figure_thrice_and_the_same_every_time() {
        let zip = include_bytes!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/artifacts/quickstart-published.zip"
        ));
        let bundle = Bundle::read(zip, &Limits::default()).unwrap();
        let (mut plan, _) = plan_of(&bundle).unwrap();
        let files = printed_figures(&bundle, &plan, 180.0).unwrap();
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["figure-4.csv", "figure-4.pdf", "figure-4.svg"]);
        assert_eq!(files, printed_figures(&bundle, &plan, 180.0).unwrap());
        let csv = String::from_utf8_lossy(&files[0].1);
        assert!(
            csv.starts_with("series,what,x,y,low,high,x-deviation,y-deviation\nno prior,curve,"),
            "{csv}"
        );
        assert!(String::from_utf8_lossy(&files[2].1).contains(" width=\"180mm\""));
        plan.experiment.figures.clear();
        assert_eq!(
            printed_figures(&bundle, &plan, 88.0).unwrap_err().to_string(),
            "the bundle has no figure: its manifest asks for none under `figures`, or no trial that was run has anything to show"
        );
    }
}
