//! Level 3: texts whose faults, values or repetitions are meant to cost far more than they are long.

use super::case::Case;
use super::forger::{STUDY, edit, replace, reseal};

const ROBOT: &str = "data/inputs/kobuki.urdf";
const WORLD: &str = "data/inputs/basic.yaml";

/// How many of everything.
const MANY: usize = 200_000;

/// Returns `MANY` keys that begin like this.
fn numbered(key: &str) -> String {
    let mut text = String::new();
    for i in 0..MANY {
        text.push_str(&format!("{key}{i}: 1\n"));
    }
    text
}

/// Returns the honest bag with `what` appended to its manifest, and every digest right.
fn appended(name: &'static str, what: impl FnOnce() -> String) -> Case {
    Case::on_honest(name, 3, |tree| {
        edit(tree, STUDY, |text| format!("{text}{}", what()));
        reseal(tree);
    })
}

/// Returns texts that a manifest or a world may be, at the cost of a second.
pub(crate) fn bombs() -> Vec<Case> {
    vec![
        appended("two hundred thousand unknown keys", || numbered("k")),
        appended("two hundred thousand keys that are nearly known", || numbered("trial")),
        appended("one key two hundred thousand times", || "limits: []\n".repeat(MANY)),
        appended("two hundred thousand values of the wrong type", || {
            format!("limits: [{}]\n", "1,".repeat(MANY))
        }),
        appended("two hundred thousand values that are refused", || {
            format!("limits: [{}]\n", "yes,".repeat(MANY))
        }),
        appended("a key on a line of two megabytes", || format!("x: {}\n", "y".repeat(2_000_000))),
        appended("an alias of a megabyte, a hundred thousand times", || {
            let text = "x".repeat(1_000_000);
            format!("limits: [&a {text}, {}]\n", "*a,".repeat(100_000))
        }),
        appended("aliases that unfold into billions", || {
            let level = |i: usize| format!("a{i}: &a{i} [{}]\n", format!("*a{},", i - 1).repeat(9));
            "a0: &a0 [x]\n".to_owned() + &(1..12).map(level).collect::<String>()
        }),
        appended("lists a hundred thousand deep", || format!("limits: {}\n", "[".repeat(100_000))),
        Case::on_honest("fifty thousand claims that claim nothing", 3, |tree| {
            edit(tree, STUDY, |text| {
                let before = &text[..text.find("claims:").unwrap()];
                format!("{before}claims:\n{}", "  - {}\n".repeat(50_000))
            });
            reseal(tree);
        }),
        Case::on_honest("ten thousand values of a factor", 3, |tree| {
            let values: Vec<String> = (0..10_000).map(|i| format!("v{i}")).collect();
            let values = format!("[none, floor-plan, {}]", values.join(", "));
            replace(tree, STUDY, "[none, floor-plan]", &values);
            reseal(tree);
        }),
        Case::on_honest("a world of two hundred thousand unknown keys", 3, |tree| {
            edit(tree, WORLD, |text| format!("{text}{}", numbered("k")));
            reseal(tree);
        }),
        Case::on_honest("a robot of twenty thousand links that are none", 3, |tree| {
            edit(tree, ROBOT, |text| {
                let links =
                    "<link><inertial><mass value=\"x\"/></inertial></link>\n".repeat(18_000);
                text.replace("</robot>", &format!("{links}</robot>"))
            });
            reseal(tree);
        }),
        Case::on_honest("a list of passwords as the robot", 3, |tree| {
            edit(tree, ROBOT, |_| "root:secret:0:0\n".repeat(10));
            reseal(tree);
        }),
    ]
}
