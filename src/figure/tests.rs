//! What the charts draw, asked of the parsed SVG.

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

/// Every coordinate of every mark lies on the sheet.
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
    for svg in
        [LineChart::default().to_svg(), BarChart::default().to_svg(), Scatter::default().to_svg()]
    {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(count(&svg, "svg"), 1);
    }
}

pub(crate) fn bar_chart() -> BarChart {
    let bar = |value: f64, published: f64| Bar {
        value: Some(value),
        interval: Some((value - 4.0, value + 4.0)),
        published: Some(published),
        published_interval: Some((published - 3.0, published + 3.0)),
    };
    BarChart {
        title: "Distance by coverage".into(),
        x_title: "coverage (%)".into(),
        y_title: "distance travelled (m)".into(),
        meaning: "mean ± sd of 10 trials".into(),
        series: ["none", "floor plan", "footprint", "bounding box"].map(String::from).to_vec(),
        groups: (0..4_u32)
            .map(|g| BarGroup {
                name: format!("{} %", 70 + 10 * g),
                bars: (0..4_u32)
                    .map(|i| {
                        let value = f64::from(20 + 8 * g + 3 * i);
                        if (g, i) == (3, 0) {
                            Bar::default()
                        } else {
                            bar(value, value * 1.1 - 2.0)
                        }
                    })
                    .collect(),
            })
            .collect(),
        at_least: None,
    }
}

#[test]
fn bars_have_intervals_and_the_paper_beside_them() {
    let svg = bar_chart().to_svg();
    assert_eq!(svg.matches("paper-fill").count(), 1 + 15 + 1, "ground, published cells, the key");
    assert!(texts(&svg).contains(&"–".to_owned()), "a missing bar is told");
    assert_eq!(count(&svg, "rect"), 1 + 2 * (15 + 4), "fill and outline of each bar and key");
    assert_on_sheet(&svg);
    assert_eq!(svg, bar_chart().to_svg());
}

pub(crate) fn scatter() -> Scatter {
    Scatter {
        title: "The paper against us".into(),
        quantity: "distance (m)".into(),
        groups: vec!["none".into(), "floor plan".into()],
        points: (0..16_u32)
            .map(|i| ScatterPoint {
                group: (i % 2) as usize,
                name: format!("cell {i}"),
                published: f64::from(8 + 3 * i),
                published_sd: Some(3.0),
                ours: f64::from(10 + 3 * i) * 0.97 + f64::from(i % 5),
                ours_sd: Some(2.5),
            })
            .collect(),
    }
}

#[test]
fn the_scatter_has_one_scale_and_the_identity_line() {
    let svg = scatter().to_svg();
    assert!(texts(&svg).contains(&"ours = published".to_owned()));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let marks = document
        .descendants()
        .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "title")))
        .count();
    assert_eq!(marks, 1 + 16, "the drawing and every point say what they are");
    let labels = texts(&svg);
    assert_eq!(labels.iter().filter(|t| *t == "20").count(), 2, "both axes share their ticks");
    assert_on_sheet(&svg);
}
