//! The layout in which Foxglove opens a bag of ours: the building from above, curves of what is one number, the log.

use super::Bag;
use serde_json::{Value, json};

/// Topics of one number, in the order in which curves are told apart.
const NUMBERS: [&str; 3] = ["/coverage", "/time_left", "/distance_travelled"];
/// Topics that stand in the scene, those that are shown at first before those that can be.
const SHOWN: [&str; 6] = ["/map", "/world", "/scan", "/plan", "/frontiers", "/graph"];
const HIDDEN: [&str; 2] = ["/prior_map", "/ground_truth/pose"];

/// Returns the layout for `bag`, of the topics that it has: a file that Foxglove imports.
pub fn foxglove_layout(bag: &Bag) -> String {
    let there = |topic: &&&str| bag.counts.contains_key(**topic);
    let mut topics = serde_json::Map::new();
    for (names, visible) in [(&SHOWN[..], true), (&HIDDEN[..], false)] {
        for topic in names.iter().filter(there) {
            topics.insert((*topic).to_owned(), json!({"visible": visible}));
        }
    }
    let plots: Vec<(String, Value)> = NUMBERS
        .iter()
        .filter(there)
        .map(|topic| {
            let name = topic.trim_start_matches('/');
            let path = json!({"value": format!("{topic}.data"), "enabled": true, "timestampMethod": "receiveTime"});
            let plot = json!({
                "paths": [path], "title": name.replace('_', " "), "showLegend": false, "xAxisVal": "timestamp",
                "isSynced": true, "showXAxisLabels": true, "showYAxisLabels": true,
            });
            (format!("Plot!{name}"), plot)
        })
        .collect();
    let scene = json!({
        "layers": {"robot": {
            "layerId": "foxglove.Urdf", "instanceId": "robot", "label": "robot", "sourceType": "topic",
            "topic": "/robot_description", "displayMode": "auto", "visible": true, "order": 1,
        }},
        "cameraState": {"perspective": false, "phi": 0.0, "thetaOffset": 90.0, "distance": 60.0, "target": [0, 0, 0]},
        "followMode": "follow-none", "followTf": "world", "scene": {}, "transforms": {}, "topics": topics,
    });
    // From the last to the first: each stands above what follows it.
    let right = plots.iter().rev().fold(json!("RosOut!log"), |below, (name, _)| {
        json!({"direction": "column", "first": name, "second": below, "splitPercentage": 40})
    });
    let mut panels = serde_json::Map::from_iter([("3D!scene".to_owned(), scene)]);
    panels.insert("RosOut!log".to_owned(), json!({"searchTerms": [], "minLogLevel": 1}));
    panels.extend(plots);
    let layout = json!({
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 5},
        "layout": {"direction": "row", "first": "3D!scene", "second": right, "splitPercentage": 65},
    });
    format!("{layout:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn it_shows_what_the_bag_has_and_nothing_else() {
        let topics = ["/world", "/scan", "/time_left", "/distance_travelled", "/rosout"];
        let counts: BTreeMap<_, _> = topics.map(|topic| (topic, 1)).into();
        let text = foxglove_layout(&Bag { bytes: Vec::new(), counts });
        let layout: Value = serde_json::from_str(&text).unwrap();
        let panels: Vec<&String> = layout["configById"].as_object().unwrap().keys().collect();
        assert_eq!(panels, ["3D!scene", "Plot!distance_travelled", "Plot!time_left", "RosOut!log"]);
        let shown = layout["configById"]["3D!scene"]["topics"].as_object().unwrap();
        assert_eq!(shown.keys().collect::<Vec<_>>(), ["/scan", "/world"]);
        let plot = &layout["configById"]["Plot!time_left"]["paths"][0]["value"];
        assert_eq!(plot, "/time_left.data");
        // Every panel has its place.
        for panel in panels {
            assert!(layout["layout"].to_string().contains(panel.as_str()), "{panel}");
        }
        assert_eq!(layout["layout"]["second"]["first"], "Plot!time_left");
    }
}
