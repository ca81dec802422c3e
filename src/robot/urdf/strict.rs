//! The requirements on a URDF before it is used: one tree of uniquely named links, numbers that are numbers, no macro
//! left unexpanded. The tree is checked in four steps:
//! 1. Links and joints have unique names.
//! 2. Every joint names a known parent and child, and no link is the child of two joints.
//! 3. One link has no parent: the root.
//! 4. Every link leads to the root: there is no loop.

use crate::document::sdf;
use crate::document::xml::{self, Faults};
use crate::document::{quoted, suggestion};
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, BTreeSet};

/// The result of the strict pass.
pub(super) struct Tree {
    /// The link that is no joint's child.
    pub(super) root: String,
}

/// Attributes that hold numbers: element, attribute, count, least value allowed.
const NUMBERS: [(&str, &str, usize, Least); 18] = [
    ("origin", "xyz", 3, Least::Any),
    ("origin", "rpy", 3, Least::Any),
    ("axis", "xyz", 3, Least::Any),
    ("box", "size", 3, Least::Positive),
    ("cylinder", "radius", 1, Least::Positive),
    ("cylinder", "length", 1, Least::Positive),
    ("capsule", "radius", 1, Least::Positive),
    ("capsule", "length", 1, Least::Positive),
    ("sphere", "radius", 1, Least::Positive),
    ("mesh", "scale", 3, Least::Any),
    ("mass", "value", 1, Least::Zero),
    ("inertia", "ixx", 1, Least::Zero),
    ("inertia", "iyy", 1, Least::Zero),
    ("inertia", "izz", 1, Least::Zero),
    ("inertia", "ixy", 1, Least::Any),
    ("inertia", "ixz", 1, Least::Any),
    ("inertia", "iyz", 1, Least::Any),
    ("limit", "velocity", 1, Least::Zero),
];

#[derive(Clone, Copy, PartialEq)]
enum Least {
    Any,
    Zero,
    Positive,
}

/// Elements known below `<robot>`; those after the fourth carry nothing that we use.
const TOP_LEVEL: [&str; 7] =
    ["link", "joint", "gazebo", "material", "transmission", "ros2_control", "sensor"];

/// Reports every fault of the document, and returns the tree where its links and joints form one.
pub(super) fn check(document: &Document<'_>, faults: &mut Faults<'_>) -> Option<Tree> {
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        let found = robot.tag_name().name();
        let fault = faults
            .at(robot, "not a robot description")
            .label(format!("expected <robot> of URDF or <sdf>, found <{found}>"));
        faults.push(fault);
        return None;
    }
    named(robot, faults);
    check_macros(document, faults);
    for element in xml::elements(robot) {
        let name = element.tag_name().name();
        if element.tag_name().namespace().is_none() && !TOP_LEVEL.contains(&name) {
            let mut fault =
                faults.at(element, format!("unknown element <{name}>")).label("ignored").warning();
            if let Some(near) = suggestion(name, TOP_LEVEL) {
                fault = fault.help(format!("did you mean <{near}>?"));
            }
            faults.push(fault);
        }
        if matches!(name, "link" | "joint") {
            for node in element.descendants().filter(Node::is_element) {
                check_numbers(node, faults);
                check_turn(node, faults);
            }
        }
    }
    tree(robot, faults)
}

/// Returns the `name` of an element, or a fault.
fn named<'a>(node: Node<'a, '_>, faults: &mut Faults<'_>) -> Option<&'a str> {
    let name = node.attribute("name").filter(|name| !name.trim().is_empty());
    if name.is_none() {
        let fault = faults
            .at(node, format!("<{}> without a name", node.tag_name().name()))
            .label("expected an attribute `name`");
        faults.push(fault);
    }
    name
}

/// Reports what is left of macros, all of it as one fault: it has one cause.
fn check_macros(document: &Document<'_>, faults: &mut Faults<'_>) {
    let expression = |text: &str| text.contains("${") || text.contains("$(");
    let mut first = None;
    let mut count = 0;
    for node in document.descendants() {
        let attributes = node.attributes().filter(|attribute| expression(attribute.value()));
        let in_text = node.is_text() && node.text().is_some_and(expression);
        let found = attributes.clone().count() + usize::from(in_text);
        count += found;
        if found > 0 && first.is_none() {
            let place = if in_text { node.parent_element().unwrap_or(node) } else { node };
            first = Some((place, attributes.map(|a| (a.name(), a.value())).next()));
        }
    }
    let Some((place, attribute)) = first else { return };
    let label = match attribute {
        Some((name, value)) => format!("`{name}` holds `{}`", quoted(value)),
        None => "its text holds one".to_owned(),
    };
    let message = match count {
        1 => "xacro expression left in the description".to_owned(),
        many => format!("{many} xacro expressions left in the description"),
    };
    let fault = faults.at(place, message).label(label).help(
        "it does not say that it is xacro: give <robot> the attribute \
         `xmlns:xacro=\"http://www.ros.org/wiki/xacro\"`, or expand it beforehand: \
         `xacro robot.urdf.xacro > robot.urdf` (`pip install xacro` does without ROS)",
    );
    faults.push(fault);
}

/// Warns of an `rpy` that seems to be in degrees.
fn check_turn(origin: Node<'_, '_>, faults: &mut Faults<'_>) {
    let written = origin.attribute("rpy").unwrap_or_default().split_ascii_whitespace();
    if written.filter_map(|word| word.parse().ok()).any(sdf::is_overturn) {
        let fault = faults.at(origin, "an origin turns by more than once around");
        faults.push(super::super::sdf::overturned(fault));
    }
}

/// Warns of an axis that does not say which: x, as for whoever reads URDF.
fn check_axis(axis: Node<'_, '_>, faults: &mut Faults<'_>) {
    if axis.attribute("xyz").is_some() {
        return;
    }
    let mut fault = faults.at(axis, "<axis> without xyz").label("read as 1 0 0").warning();
    let written = axis.attributes().find(|attribute| attribute.name() != "rpy");
    if let Some(written) = written {
        fault = fault.help(format!("is `{}` meant to be `xyz`?", quoted(written.name())));
    }
    faults.push(fault);
}

fn check_numbers(node: Node<'_, '_>, faults: &mut Faults<'_>) {
    let element = node.tag_name().name();
    if element == "axis" {
        check_axis(node, faults);
    }
    for (_, attribute, count, least) in NUMBERS.iter().filter(|entry| entry.0 == element) {
        let smallest = if *count == 3 {
            faults
                .attribute::<3>(node, attribute)
                .map(|numbers| numbers.into_iter().fold(f64::INFINITY, f64::min))
        } else {
            faults.attribute::<1>(node, attribute).map(|[number]| number)
        };
        if *least == Least::Positive && node.attribute(*attribute).is_none() {
            let fault = faults
                .at(node, format!("<{element}> has no {attribute}"))
                .label(format!("expected an attribute `{attribute}`"));
            faults.push(fault);
        }
        let Some(smallest) = smallest else { continue };
        let expected = match least {
            Least::Zero if smallest < 0.0 => "zero or more",
            Least::Positive if smallest <= 0.0 => "more than zero",
            _ => continue,
        };
        let fault = faults
            .at(node, format!("{element} {attribute} out of range"))
            .label(format!("expected {expected}, found {smallest}"));
        faults.push(fault);
    }
}

fn tree(robot: Node<'_, '_>, faults: &mut Faults<'_>) -> Option<Tree> {
    // 1. Names.
    let mut links = BTreeSet::new();
    let mut joints = BTreeSet::new();
    let children_named =
        |name: &'static str| xml::elements(robot).filter(move |e| e.tag_name().name() == name);
    for (kind, names) in [("link", &mut links), ("joint", &mut joints)] {
        for node in children_named(kind) {
            if let Some(name) = named(node, faults)
                && !names.insert(name)
            {
                let fault = faults
                    .at(node, format!("duplicate {kind} `{name}`"))
                    .help(format!("give every {kind} a name of its own"));
                faults.push(fault);
            }
        }
    }
    // 2. Parents.
    let mut parent_of = BTreeMap::new();
    for joint in children_named("joint") {
        let mut end = |role: &str| {
            let Some(link) = xml::child(joint, role).and_then(|node| node.attribute("link")) else {
                let fault = faults
                    .at(joint, format!("joint without a {role}"))
                    .label(format!("expected <{role} link=\"...\"/>"));
                faults.push(fault);
                return None;
            };
            if !links.contains(link) {
                let mut fault =
                    faults.at(joint, format!("joint names an unknown {role} link `{link}`"));
                if let Some(near) = suggestion(link, links.iter().copied()) {
                    fault = fault.help(format!("did you mean `{near}`?"));
                }
                faults.push(fault);
                return None;
            }
            Some(link)
        };
        let (Some(parent), Some(child)) = (end("parent"), end("child")) else { continue };
        if parent_of.insert(child, parent).is_some() {
            let fault = faults.at(joint, format!("link `{child}` is the child of two joints"));
            faults.push(fault);
        }
    }
    if faults.any_error() {
        return None;
    }
    // 3. The root.
    let roots: Vec<&str> =
        links.iter().copied().filter(|link| !parent_of.contains_key(link)).collect();
    let [root] = roots[..] else {
        let found =
            if roots.is_empty() { "none".to_owned() } else { format!("`{}`", roots.join("`, `")) };
        let fault = faults
            .at(robot, "the links do not form one tree")
            .label(format!("expected one link without a parent, found {found}"))
            .help("connect every link to the base by joints");
        faults.push(fault);
        return None;
    };
    // 4. Every other link has one parent, so what does not reach the root is on a loop.
    for link in &links {
        let (mut at, mut steps) = (*link, 0);
        while let Some(parent) = parent_of.get(at) {
            (at, steps) = (parent, steps + 1);
            if steps > links.len() {
                let fault = faults.at(robot, format!("link `{link}` hangs on a loop of joints"));
                faults.push(fault);
                return None;
            }
        }
    }
    Some(Tree { root: root.to_owned() })
}
