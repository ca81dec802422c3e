//! The elements that charts draw, found in the parsed SVG.

use super::chart::{real, text_width};
use super::*;

fn count(text: &str, element: &str) -> usize {
    let document = roxmltree::Document::parse(text).unwrap();
    document
        .descendants()
        .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", element)))
        .count()
}

fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    document
        .descendants()
        .filter(|n| n.tag_name().name() == "text")
        .map(|n| n.text().unwrap_or_default().to_owned())
        .collect()
}

/// Asserts that every coordinate of every mark lies on the sheet.
fn assert_on_sheet(svg: &str) {
    let document = roxmltree::Document::parse(svg).unwrap();
    let root = document.root_element();
    let size = |name: &str| root.attribute(name).unwrap().parse::<f64>().unwrap();
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        for (name, limit) in [("cx", size("width")), ("cy", size("height")), ("x", size("width"))] {
            let in_key = node
                .ancestors()
                .any(|a| a.attribute("transform").is_some_and(|t| t.starts_with("translate")));
            if let (Some(at), false) = (node.attribute(name), in_key) {
                let at: f64 = at.parse().unwrap();
                assert!((0.0..=limit).contains(&at), "{name}={at} of {:?}", node.tag_name());
            }
        }
    }
}

pub(crate) fn line_chart(names: &[&str]) -> LineChart {
    let series = names.iter().enumerate().map(|(i, name)| {
        let pace = 1.0 + f64::from(u32::try_from(i).unwrap()) * 0.4;
        let points: Vec<_> =
            (0..=95).map(|c| (f64::from(c) * f64::from(c) / 150.0 * pace, f64::from(c))).collect();
        Series {
            name: (*name).into(),
            band: points.iter().map(|p| (p.0, (p.1 - 4.0).max(0.0), p.1 + 4.0)).collect(),
            published: vec![PublishedPoint {
                x: 40.0 * pace,
                y: 80.0,
                x_error: Some(5.0),
                y_error: None,
            }],
            points,
        }
    });
    LineChart {
        title: "Coverage over distance".into(),
        x_title: "distance travelled (m)".into(),
        y_title: "coverage (%)".into(),
        meaning: "median and middle half of 10 trials".into(),
        series: series.collect(),
    }
}

#[test]
fn curves_are_named_at_their_ends_and_the_paper_is_hollow() {
    let chart = line_chart(&["none", "floor plan", "footprint"]);
    let svg = chart.to_svg();
    let texts = texts(&svg);
    for wanted in ["none", "floor plan", "footprint", "distance travelled (m)", "coverage (%)"] {
        assert_eq!(texts.iter().filter(|t| *t == wanted).count(), 1, "{wanted}: {texts:?}");
    }
    assert!(texts.contains(&"hollow: published, ± sd".to_owned()));
    assert_eq!(svg.matches("paper-fill").count(), 1 + 3 + 1, "ground, three points, the key");
    assert_on_sheet(&svg);
    assert_eq!(svg, chart.to_svg(), "the same data give the same bytes");
}

#[test]
fn labels_that_do_not_fit_become_a_key() {
    let long = "a strategy whose name is far too long to stand beside the end of its curve";
    let svg = line_chart(&[long, "short"]).to_svg();
    assert_eq!(texts(&svg).iter().filter(|t| *t == long).count(), 1);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let label = document.descendants().find(|n| n.text() == Some(long)).unwrap();
    let plot_bottom = 344.0;
    assert!(label.attribute("y").unwrap().parse::<f64>().unwrap() > plot_bottom);
}

#[test]
fn hostile_and_empty_data_still_draw() {
    let mut chart = line_chart(&["</text><script>"]);
    chart.series[0].points[10].1 = f64::NAN;
    let svg = chart.to_svg();
    assert_eq!(count(&svg, "script"), 0);
    assert!(!svg.contains("NaN"));
    for svg in [
        LineChart::default().to_svg(),
        EstimateChart::default().to_svg(),
        ShareChart::default().to_svg(),
        Scatter::default().to_svg(),
        PolicyChart::default().to_svg(),
    ] {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(count(&svg, "svg"), 1);
    }
}

/// Returns panels of `rows` rows each, some without a value of ours or the paper's.
fn estimates(names: &[&str], panels: &[&str], lines: &[&str], dots: bool) -> EstimateChart {
    let row = |at: usize| {
        let value = real(at * 37 % 91) + 4.0;
        let known = at % 7 != 3;
        Estimate {
            value: known.then_some(value),
            interval: known.then_some((value - 6.0, value + 5.0)),
            band: None,
            middle_half: (known && dots).then_some((value - 12.0, value + 10.0)),
            n: Some(30 - (at as u64) % 4),
            published: (at % 5 != 4).then_some(100.0 - value),
            published_interval: (!dots && at % 5 != 4).then_some((95.0 - value, 104.0 - value)),
        }
    };
    EstimateChart {
        title: "Success".into(),
        quantity: "reached (% of trials)".into(),
        interval: "95 % interval".into(),
        boxes: if dots { "middle half of trials".into() } else { String::new() },
        band: String::new(),
        mark: String::new(),
        names: names.iter().map(|name| (*name).into()).collect(),
        lines: lines
            .iter()
            .enumerate()
            .map(|(l, line)| PanelLine {
                name: (*line).into(),
                panels: panels
                    .iter()
                    .enumerate()
                    .map(|(p, panel)| Panel {
                        name: (*panel).into(),
                        rows: (0..names.len()).map(|r| row(31 * l + 11 * p + r)).collect(),
                        mark: None,
                    })
                    .collect(),
            })
            .collect(),
        end: (!dots).then_some(100.0),
    }
}

pub(crate) fn bar_chart() -> EstimateChart {
    let names = ["random", "frontier", "normalized-frontier", "corridors-first"];
    estimates(&names, &["deadline 680 s", "deadline 68 s"], &["start A", "start B"], false)
}

#[test]
fn a_band_stands_in_the_place_of_an_interval_and_is_told_by_more_than_colour() {
    let mut chart = estimates(&["random", "frontier"], &["A"], &[""], false);
    let without = (count(&chart.to_svg(), "rect"), chart.data().columns.len());
    chart.band = "5 to 95 % over draw, median".to_owned();
    for row in chart.lines.iter_mut().flat_map(|line| &mut line.panels).flat_map(|p| &mut p.rows) {
        (row.interval, row.band) = (None, row.value.map(|value| [value - 9.0, value, value + 9.0]));
    }
    let svg = chart.to_svg();
    // A box in each row and in the key.
    assert_eq!(count(&svg, "rect"), without.0 + 3, "{svg}");
    assert!(svg.contains("ours, 5 to 95 % over draw, median"), "{svg}");
    let data = chart.data();
    assert_eq!(data.columns[without.1..], ["band-low", "band-median", "band-high"]);
    let row = &chart.lines[0].panels[0].rows[0];
    let [low, ..] = row.band.unwrap();
    assert_eq!(data.value(&data.rows[0], "band-low").as_f64(), Some(low));
}

pub(crate) fn share_chart() -> ShareChart {
    let part = |name: &str, look| Part { name: name.into(), look };
    let row =
        |ours: &[f64], published: &[f64]| Shares { ours: ours.into(), published: published.into() };
    ShareChart {
        title: "How trials ended".into(),
        quantity: "share of trials (%)".into(),
        parts: vec![
            part("reached", Look::Good),
            part("late", Look::Slow),
            part("collided", Look::Bad),
        ],
        names: vec!["random".into(), "frontier".into()],
        lines: vec![PanelLine {
            name: "start A".into(),
            panels: vec![Panel {
                name: "deadline 680 s".into(),
                rows: vec![row(&[96.0, 0.0, 4.0], &[50.0, 20.0, 30.0]), row(&[], &[])],
                mark: None,
            }],
        }],
    }
}

pub(crate) fn policy_chart() -> PolicyChart {
    let place = |x: f64, y: f64, label: &str, room| PolicyVertex {
        at: crate::geometry::Point::new(x, y),
        label: label.into(),
        room,
    };
    let go = |from, to, fast, probability| PolicyMove {
        from,
        to,
        fast,
        probability,
        passes: probability,
    };
    let panel = |name: &str, moves| PolicyPanel {
        name: name.into(),
        how: "binding".into(),
        told: "expected: 20 s".into(),
        moves,
    };
    PolicyChart {
        title: "Policy".into(),
        walls: Vec::new(),
        vertices: vec![
            place(0.0, 0.0, "c1a", false),
            place(30.0, 0.0, "c1b", false),
            place(30.0, 5.0, "R1", true),
            place(60.0, 0.0, "c1c", false),
        ],
        edges: vec![(0, 1), (1, 2), (1, 3)],
        start: 0,
        goal: 2,
        panels: vec![
            panel("within 60 s", vec![go(0, 1, true, 1.0), go(1, 2, false, 1.0)]),
            panel(
                "within 20 s",
                vec![go(0, 1, true, 1.0), go(1, 2, false, 0.25), go(1, 2, true, 0.75)],
            ),
        ],
    }
}

#[test]
fn every_row_has_ours_and_the_papers_hollow_mark_under_it() {
    let chart = bar_chart();
    let svg = chart.to_svg();
    let known = chart.lines.iter().flat_map(|l| &l.panels).flat_map(|p| &p.rows);
    let (ours, published) = known.fold((0, 0), |(ours, published), row| {
        (ours + usize::from(row.value.is_some()), published + usize::from(row.published.is_some()))
    });
    assert_eq!(svg.matches("paper-fill").count(), 1 + published + 1, "ground, diamonds, the key");
    assert_eq!(count(&svg, "rect"), 1 + ours + 1, "ground, bars, the key");
    let told = texts(&svg);
    assert_eq!(told.iter().filter(|t| *t == "–").count(), 16 - ours, "a missing bar is told");
    for wanted in ["start A", "deadline 680 s", "reached (% of trials)", "paper, 95 % interval"] {
        assert!(told.contains(&wanted.to_owned()), "{wanted}: {told:?}");
    }
    assert_on_sheet(&svg);
    assert_eq!(svg, bar_chart().to_svg(), "the same data give the same bytes");
    let words = chart.in_words();
    assert!(
        words.contains("of 16 cells: ours from") && words.contains("printed numbers"),
        "{words}"
    );
}

#[test]
fn shares_stand_in_two_bars_and_the_whole_is_full() {
    let svg = share_chart().to_svg();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let width =
        |node: roxmltree::Node<'_, '_>| node.attribute("width").unwrap().parse::<f64>().unwrap();
    let tall = |height: &str| {
        let bars = document
            .descendants()
            .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "rect")));
        let bars = bars.filter(|n| {
            n.attribute("height") == Some(height) && n.attribute("fill") != Some("none")
        });
        let in_key =
            |n: &roxmltree::Node<'_, '_>| n.ancestors().any(|a| a.attribute("transform").is_some());
        bars.filter(|n| !in_key(n)).map(width).collect::<Vec<_>>()
    };
    assert_eq!(tall("13").len(), 2, "nothing is drawn of what did not happen");
    assert!((tall("13").iter().sum::<f64>() - 300.0).abs() < 0.1, "the panel's whole width");
    assert_eq!(tall("6").len(), 3);
    assert!(
        texts(&svg).contains(&"–".to_owned())
            && texts(&svg).contains(&"thick: ours, thin: paper".to_owned())
    );
    assert!(
        share_chart().in_words().contains("reached at most 96 % (random, start A, deadline 680 s)")
    );
    assert_on_sheet(&svg);
}

#[test]
fn a_policy_is_drawn_whole_once_and_then_where_it_differs() {
    let chart = policy_chart();
    let svg = chart.to_svg();
    let told = texts(&svg);
    let drawn = |label: &str| told.iter().filter(|t| *t == label).count();
    assert_eq!((drawn("c1c"), drawn("elsewhere as above")), (1, 1), "{told:?}");
    assert_eq!(drawn("c1b"), 2);
    assert!(told.contains(&"25 %".to_owned()) && told.contains(&"75 %".to_owned()));
    assert!(chart.in_words().contains("c1b to R1 fast with 75 %"), "{}", chart.in_words());
    assert_on_sheet(&svg);
}

/// Returns the boxes of all upright texts (left, top, right, bottom) with their texts.
fn boxes(svg: &str) -> Vec<([f64; 4], String)> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|n| n.tag_name().name() == "text");
    let upright = texts.filter(|n| n.ancestors().all(|a| a.attribute("transform").is_none()));
    let number = |n: &roxmltree::Node<'_, '_>, name: &str| {
        n.attribute(name).unwrap().parse::<f64>().unwrap()
    };
    upright
        .map(|n| {
            let (x, y, size) = (number(&n, "x"), number(&n, "y"), number(&n, "font-size"));
            let text = n.text().unwrap_or_default().to_owned();
            let width = text_width(&text, size);
            let left = match n.attribute("text-anchor") {
                Some("end") => x - width,
                Some("middle") => x - width / 2.0,
                _ => x,
            };
            ([left, y - 0.72 * size, left + width, y], text)
        })
        .collect()
}

fn assert_no_text_on_another(svg: &str) {
    let boxes = boxes(svg);
    for (i, (a, one)) in boxes.iter().enumerate() {
        for (b, other) in &boxes[..i] {
            let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
            assert!(apart, "`{one}` lies on `{other}`: {a:?} {b:?}");
        }
    }
}

#[test]
fn no_text_lies_on_another() {
    for svg in [share_chart().to_svg(), policy_chart().to_svg(), bar_chart().to_svg()] {
        assert_no_text_on_another(&svg);
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(48))]
    #[test]
    fn no_text_of_panels_lies_on_another_whatever_the_names(
        names in proptest::collection::vec("[a-z-]{1,24}", 1..6),
        panels in proptest::collection::vec("[a-zA-Z0-9 ]{0,30}", 1..7),
        lines in proptest::collection::vec("[a-z ]{0,20}", 1..4),
        dots in proptest::prelude::any::<bool>(),
    ) {
        fn trimmed(texts: &[String]) -> Vec<&str> {
            texts.iter().map(|text| text.trim()).collect()
        }
        let (n, p, l) = (trimmed(&names), trimmed(&panels), trimmed(&lines));
        let svg = estimates(&n, &p, &l, dots).to_svg();
        assert_no_text_on_another(&svg);
        assert_on_sheet(&svg);
    }

    #[test]
    fn no_label_of_a_scatter_lies_on_another(
        values in proptest::collection::vec((1.0_f64..100.0, 1.0_f64..100.0, proptest::prelude::any::<bool>()), 0..40),
        logarithmic in proptest::prelude::any::<bool>(),
    ) {
        let mut chart = scatter();
        chart.logarithmic = logarithmic;
        chart.points = values
            .iter()
            .enumerate()
            .map(|(i, (published, ours, called))| ScatterPoint {
                group: i % 2,
                name: format!("cell {i}"),
                published: *published,
                ours: *ours,
                label: if *called { format!("cell number {i}") } else { String::new() },
                ..ScatterPoint::default()
            })
            .collect();
        let svg = chart.to_svg();
        assert_no_text_on_another(&svg);
        assert_on_sheet(&svg);
    }
}

pub(crate) fn scatter() -> Scatter {
    Scatter {
        title: "The paper against us".into(),
        quantity: "distance (m)".into(),
        intervals: "95 % intervals".into(),
        logarithmic: false,
        end: None,
        notes: vec!["16 cells, r = 0.99".into(), "RMSE 2.1 m".into()],
        groups: vec!["none".into(), "floor plan".into()],
        points: (0..16_u32)
            .map(|i| ScatterPoint {
                group: (i % 2) as usize,
                name: format!("cell {i}"),
                published: f64::from(8 + 3 * i),
                published_interval: Some((f64::from(5 + 3 * i), f64::from(11 + 3 * i))),
                ours: f64::from(10 + 3 * i) * 0.97 + f64::from(i % 5),
                ours_interval: None,
                label: if i == 15 { "the last".into() } else { String::new() },
            })
            .collect(),
    }
}

#[test]
fn the_scatter_has_one_scale_and_the_identity_line() {
    let svg = scatter().to_svg();
    assert!(texts(&svg).contains(&"ours = paper".to_owned()));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let marks = document
        .descendants()
        .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "title")))
        .count();
    assert_eq!(marks, 1 + 16, "the drawing and every point say what they are");
    let labels = texts(&svg);
    assert_eq!(labels.iter().filter(|t| *t == "20").count(), 2, "both axes share their ticks");
    assert!(labels.contains(&"the last".to_owned()) && labels.contains(&"RMSE 2.1 m".to_owned()));
    assert_on_sheet(&svg);
}

#[test]
fn on_paper_every_chart_is_as_wide_as_the_column_and_its_texts_stay_apart() {
    for width_mm in [88.0, 180.0] {
        let medium = Medium::Paper { width_mm };
        let wide = medium.width().unwrap();
        let curves = line_chart(&["no prior", "floor plan", "footprint"]);
        for (name, svg) in [
            ("lines", curves.to_svg_on(medium)),
            ("bars", bar_chart().to_svg_on(medium)),
            ("shares", share_chart().to_svg_on(medium)),
            ("scatter", scatter().to_svg_on(medium)),
            ("policy", policy_chart().to_svg_on(medium)),
        ] {
            let document = roxmltree::Document::parse(&svg).unwrap();
            let found: f64 = document.root_element().attribute("width").unwrap().parse().unwrap();
            assert!((found - wide).abs() < 0.01, "{name}: {found} px, expected {wide} px");
            assert_on_sheet(&svg);
            if name != "policy" {
                assert_no_text_on_another(&svg);
            }
        }
    }
}

#[test]
fn what_is_drawn_can_be_drawn_again() {
    let table = line_chart(&["no prior"]).data();
    let count = |what: &str| table.rows.iter().filter(|row| row[1].to_string() == what).count();
    assert_eq!((count("curve"), count("band"), count("paper")), (96, 96, 1));
    let shares = share_chart();
    let rows: usize = shares.lines.iter().map(|line| line.rows().count()).sum();
    assert_eq!(shares.data().rows.len(), rows * shares.parts.len());
    let bars = bar_chart();
    let rows: usize = bars.lines.iter().map(|line| line.rows().count()).sum();
    assert_eq!(bars.data().rows.len(), rows);
    assert_eq!(scatter().data().rows.len(), scatter().points.len());
    let policy = policy_chart();
    let moves: usize = policy.panels.iter().map(|panel| panel.moves.len()).sum();
    assert_eq!(policy.data().rows.len(), moves);
}
