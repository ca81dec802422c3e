//! Levels 3 to 5: every digest, size and count in the bundle made right; from the fabrications on, everything that follows
//! from records, too.

use super::case::Case;
use super::forger::{
    METADATA, RESOLVED, STUDY, add_input, describe, edit, rederive, replace, reseal, set_cell,
    set_json, set_records,
};
use reenact::bundle::Tree;
use serde_json::{Value, json};

const TRIALS: &str = "data/results/trials.csv";
const CLAIMS: &str = "data/results/claims.json";
const ROBOT: &str = "data/inputs/kobuki.urdf";
const WORLD: &str = "data/inputs/basic.yaml";

fn resealed(name: &'static str, attack: impl FnOnce(&mut Tree)) -> Case {
    Case::on_honest(name, 3, |tree| {
        attack(tree);
        reseal(tree);
    })
}

/// Returns results that do not follow from the records.
pub(crate) fn results() -> Vec<Case> {
    vec![
        resealed("a changed number in trials.csv", |tree| {
            set_cell(tree, TRIALS, 2, "distance-m", "1.5");
        }),
        resealed("a changed outcome in trials.csv", |tree| {
            set_cell(tree, TRIALS, 1, "outcome", "explored");
        }),
        resealed("a row less in trials.csv", |tree| {
            edit(tree, TRIALS, |text| text.split_inclusive('\n').take(6).collect());
        }),
        resealed("a row more in trials.csv", |tree| {
            edit(tree, TRIALS, |text| format!("{text}{}\n", text.lines().last().unwrap()));
        }),
        resealed("rows in another order in trials.csv", |tree| {
            edit(tree, TRIALS, |text| {
                let mut lines: Vec<&str> = text.lines().collect();
                lines.swap(1, 2);
                lines.join("\n") + "\n"
            });
        }),
        resealed("a column renamed in trials.csv", |tree| {
            replace(tree, TRIALS, "turning-rad", "turning-deg");
        }),
        resealed("a changed point of a curve", |tree| {
            set_cell(tree, "data/results/series.csv", 3, "time-s", "0.5");
        }),
        resealed("a changed number in a table", |tree| {
            replace(tree, "data/results/tables/table-1.csv", "floor-plan,", "floor-plan,1");
        }),
        resealed("a changed number in a printed table", |tree| {
            replace(tree, "data/results/tables/table-1.md", "+0 %", "+40 %");
        }),
        resealed("a changed line of a figure", |tree| {
            edit(tree, "data/results/figures/figure-1.svg", |text| {
                let is_line = |at: usize| text[at + 1..].starts_with(|c: char| c.is_ascii_digit());
                let (at, _) = text.match_indices('L').find(|(at, _)| is_line(*at)).unwrap();
                format!("{}1{}", &text[..=at], &text[at + 1..])
            });
        }),
        resealed("a script in a figure", |tree| {
            replace(
                tree,
                "data/results/figures/figure-1.svg",
                "</svg>",
                "<script>alert(1)</script></svg>",
            );
        }),
        resealed("a changed verdict", |tree| {
            set_json(tree, CLAIMS, |claims| claims[0]["verdict"] = "contradicted".into());
        }),
        resealed("a changed number that decided a verdict", |tree| {
            set_json(tree, CLAIMS, |claims| {
                claims[0]["comparisons"][0]["p-for"] = 0.5.into();
            });
        }),
        resealed("a verdict lost", |tree| set_json(tree, CLAIMS, |claims| *claims = json!([]))),
        resealed("a table of the forger's own", |tree| {
            tree.insert("data/results/tables/table-2.csv".into(), b"x\n1\n".to_vec());
            describe(tree, "results/tables/table-2.csv");
        }),
        resealed("a table lost", |tree| {
            drop(tree.remove("data/results/tables/table-1.csv").unwrap());
            set_json(tree, METADATA, |metadata| {
                let is_table = |e: &Value| e["@id"] == "results/tables/table-1.csv";
                metadata["@graph"].as_array_mut().unwrap().retain(|e| !is_table(e));
            });
        }),
        resealed("another title in the README", |tree| {
            replace(tree, "data/README.md", "A tiny study", "A vast study");
        }),
        resealed("another licence", |tree| {
            edit(tree, "data/LICENSE.txt", |text| format!("{text}All rights reserved.\n"));
        }),
        resealed("another author in the crate", |tree| {
            replace(tree, METADATA, "A. Researcher", "Somebody Else");
        }),
        resealed("a script in the preview", |tree| {
            replace(
                tree,
                "data/ro-crate-preview.html",
                "</body>",
                "<script>alert(1)</script></body>",
            );
        }),
        resealed("fifteen million lines in trials.csv", |tree| {
            edit(tree, TRIALS, |text| text.to_owned() + &"\n".repeat(15_000_000));
        }),
        resealed("thirty million commas in trials.csv", |tree| {
            tree.insert(TRIALS.into(), b",".repeat(30_000_000));
        }),
        resealed("verdicts of four million objects", |tree| {
            tree.insert(CLAIMS.into(), format!("[{}0]", "{\"\":0},".repeat(4_000_000)).into());
        }),
        Case::on_honest("a million measures", 2, |tree| {
            let measures: String = (0..360_000)
                .flat_map(|i| format!("\"{i:06}\":1,").into_bytes())
                .map(char::from)
                .collect();
            replace(
                tree,
                "data/trials/none.jsonl",
                "\"measures\":{",
                &format!("\"measures\":{{{measures}"),
            );
            reseal(tree);
        }),
        resealed("state hashes that fill the memory", |tree| {
            let hashes = format!("\"{}\",", "0".repeat(16)).repeat(219_000);
            for path in ["data/trials/none.jsonl", "data/trials/floor-plan.jsonl"] {
                replace(tree, path, "{\"chain\":[", &format!("{{\"chain\":[{hashes}"));
            }
        }),
        resealed("half a million state hashes", |tree| {
            let hashes = format!("\"{}\",", "0".repeat(16)).repeat(180_000);
            replace(
                tree,
                "data/trials/none.jsonl",
                "{\"chain\":[",
                &format!("{{\"chain\":[{hashes}"),
            );
        }),
    ]
}

/// Returns studies that are not the one whose trials were run.
pub(crate) fn studies() -> Vec<Case> {
    vec![
        resealed("another seed", |tree| replace(tree, STUDY, "seed: 7", "seed: 8")),
        resealed("a changed parameter", |tree| {
            replace(tree, STUDY, "time-limit-s: 20", "time-limit-s: 21");
        }),
        resealed("a changed parameter in the resolved study only", |tree| {
            replace(tree, RESOLVED, "\"time-limit-s\": 20", "\"time-limit-s\": 21");
        }),
        resealed("a changed range of the robot's lidar", |tree| {
            replace(tree, ROBOT, "<max>10.0</max>", "<max>9.5</max>");
        }),
        resealed("a moved wall", |tree| replace(tree, WORLD, "[4.99, -0.7]", "[4.99, -0.6]")),
        resealed("a changed threshold of a claim", |tree| {
            replace(tree, STUDY, "low: 5", "low: 5000");
        }),
        resealed("a claim left out", |tree| {
            edit(tree, STUDY, |text| text[..text.find("claims:").unwrap()].to_owned());
        }),
        resealed("another text of a claim", |tree| {
            replace(tree, STUDY, "at least 5 m\n", "at least 5 km\n");
        }),
        resealed("a factor's value left out", |tree| {
            replace(tree, STUDY, "[none, floor-plan]", "[none]");
        }),
        resealed("more trials asked for than run", |tree| {
            replace(tree, STUDY, "trials: 3", "trials: 4");
        }),
        resealed("a million trials asked for", |tree| {
            replace(tree, STUDY, "trials: 3", "trials: 1000000");
        }),
        resealed("an override slipped in", |tree| {
            set_json(tree, RESOLVED, |resolved| {
                resolved["study"]["overrides"] = json!(["seed=8"]);
            });
        }),
        resealed("an override that reads a file outside", |tree| {
            set_json(tree, RESOLVED, |resolved| {
                resolved["study"]["overrides"] = json!(["world.file=/etc/passwd"]);
            });
        }),
        resealed("a shard of none", |tree| {
            set_json(tree, RESOLVED, |resolved| {
                resolved["study"]["selection"] =
                    json!({"only": {}, "trials": null, "shard": [1, 0]});
            });
        }),
        resealed("records of another trial under this trial's key", |tree| {
            set_records(tree, "none", |records| {
                let key = records[0]["key"].clone();
                records[0]["key"] = records[1]["key"].clone();
                records[1]["key"] = key;
            });
        }),
        resealed("a manifest of anchors that multiply", |tree| {
            let mut bomb = "a: &a [x,x,x,x,x,x,x,x,x,x]\n".to_owned();
            for (one, next) in "abcdefghi".chars().zip("bcdefghij".chars()) {
                bomb += &format!("{next}: &{next} [{}]\n", vec![format!("*{one}"); 10].join(","));
            }
            edit(tree, STUDY, |text| text.to_owned() + &bomb);
        }),
        resealed("a manifest a hundred thousand lists deep", |tree| {
            edit(tree, STUDY, |text| text.to_owned() + "x: " + &"[".repeat(100_000) + "\n");
        }),
        resealed("a robot of entities that multiply", |tree| {
            let doctype =
                "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;\">]>";
            tree.insert(ROBOT.into(), format!("{doctype}<robot name=\"&b;\"/>").into_bytes());
        }),
        resealed("a robot that reads a file outside", |tree| {
            let doctype = "<!DOCTYPE r [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>";
            tree.insert(ROBOT.into(), format!("{doctype}<robot name=\"&x;\"/>").into_bytes());
        }),
        resealed("a prior map of sixty-four million pixels", |tree| {
            replace(tree, STUDY, "{floor-plan-of: world}", "{map: map.yaml}");
            let map = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n\
                       occupied_thresh: 0.65\nfree_thresh: 0.2\n";
            add_input(tree, "map.yaml", map);
            add_input(tree, "map.pgm", "P5\n8192 8192\n255\n");
        }),
        resealed("a world as wide as a country", |tree| {
            replace(tree, WORLD, "[-3.86, 4.125]", "[-9000, 9000]");
        }),
        resealed("published numbers of fifteen million lines", |tree| {
            replace(tree, STUDY, "tables:\n", "published: {distance-m: p.csv}\ntables:\n");
            let lines = "prior,coverage-percent,value\n".to_owned() + &"\n".repeat(15_000_000);
            add_input(tree, "p.csv", lines);
        }),
    ]
}

/// Returns fabrications with everything derived from them by the program itself: only running a trial again can show
/// them.
pub(crate) fn fabrications() -> Vec<Case> {
    let case = |name, attack: fn(&mut Tree)| {
        let case = Case::on_honest(name, 4, |tree| {
            attack(tree);
            *tree = rederive(std::mem::take(tree));
        });
        Case { level: 4, ..case }
    };
    let full = |name, attack: fn(&mut Tree)| Case { level: 5, ..case(name, attack) };
    vec![
        case("a better distance", |tree| {
            set_records(tree, "floor-plan", |records| {
                records[1]["measures"]["distance-m"] = 5.25.into();
            });
        }),
        full("an invented record", |tree| {
            set_records(tree, "none", |records| {
                records[2]["measures"]["coverage-percent"] = 99.5.into();
                records[2]["outcome"] = "explored".into();
                records[2]["sim-seconds"] = 30.into();
                let chain = ["1111111111111111", "2222222222222222", "3333333333333333"];
                records[2]["chain"] = json!(chain);
            });
        }),
        case("two trials' results swapped", |tree| {
            set_records(tree, "none", |records| {
                records.swap(0, 1);
                records[0]["trial"] = 0.into();
                records[1]["trial"] = 1.into();
            });
        }),
        case("two conditions' results swapped", |tree| {
            let (mut none, mut plan) = (Vec::new(), Vec::new());
            set_records(tree, "none", |records| {
                none.clone_from(records);
                records.clear();
            });
            set_records(tree, "floor-plan", |records| {
                plan.clone_from(records);
                records.clone_from(&none);
                for record in records {
                    record["condition"][0][1] = "floor-plan".into();
                }
            });
            let lines: String = plan
                .iter_mut()
                .map(|record| {
                    record["condition"][0][1] = "none".into();
                    reenact::json::canonical(record) + "\n"
                })
                .collect();
            tree.insert("data/trials/none.jsonl".into(), lines.into_bytes());
        }),
        case("one trial's result for every trial", |tree| {
            set_records(tree, "none", |records| {
                for trial in 1..records.len() {
                    records[trial] = records[0].clone();
                    records[trial]["trial"] = trial.into();
                }
            });
        }),
        case("a failure called a time limit reached", |tree| {
            set_records(tree, "none", |records| records[0]["outcome"] = "stuck".into());
        }),
        case("a point left out of a curve", |tree| {
            set_records(tree, "none", |records| {
                drop(records[0]["series"].as_array_mut().unwrap().remove(3));
            });
        }),
        case("a last digit", |tree| {
            set_records(tree, "none", |records| {
                let turning = records[0]["measures"]["turning-rad"].as_f64().unwrap();
                records[0]["measures"]["turning-rad"] = turning.next_up().into();
            });
        }),
        case("a changed state hash", |tree| {
            set_records(tree, "none", |records| records[0]["chain"][2] = "0000000000000000".into());
        }),
        case("another seed, the old results", |tree| replace(tree, STUDY, "seed: 7", "seed: 8")),
        case("a changed parameter, the old results", |tree| {
            replace(tree, STUDY, "time-limit-s: 20", "time-limit-s: 19");
        }),
        case("a changed lidar, the old results", |tree| {
            replace(tree, ROBOT, "<max>10.0</max>", "<max>4.0</max>");
        }),
        case("a moved wall, the old results", |tree| {
            replace(tree, WORLD, "[4.99, -0.7]", "[4.99, -0.6]");
        }),
    ]
}
