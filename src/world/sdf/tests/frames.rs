//! Poses relative to frames, links, joints and models.

use super::*;
use crate::document::suggestion;

/// Returns where each collision of a world stands, rounded to a millimetre: its name, x, y and z.
fn stand(inner: &str) -> Vec<(String, [f64; 3])> {
    let text = format!("<sdf version='1.9'><world name='w'>{inner}</world></sdf>");
    let world = read(&Source::new("t.sdf", text)).unwrap_or_else(|faults| {
        panic!("{}", faults.iter().map(|f| f.render(false)).collect::<String>())
    });
    let at = |solid: &Solid| match &solid.body {
        Body::Box { placement, .. } => {
            let to = placement.translation.map(|v| (v * 1000.0).round() / 1000.0 + 0.0);
            (solid.name.clone(), to)
        }
        other => panic!("{other:?}"),
    };
    world.solids.iter().map(at).collect()
}

const BOX: &str =
    "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>";
const QUARTER: &str = "1.5707963267948966";

#[test]
fn poses_are_relative_to_what_they_say() {
    // A frame at (1, 0) turned by a quarter; what lies 1 ahead of it lies at (1, 1).
    let found = stand(&format!(
        "<model name='m'><static>1</static><pose>10 0 2 0 0 0</pose>
           <frame name='turned'><pose>1 0 0 0 0 {QUARTER}</pose></frame>
           <frame name='on' attached_to='a'><pose>0 0 0 0 0 0</pose></frame>
           <joint name='j' type='fixed'><parent>a</parent><child>a</child><pose>0 0 1 0 0 0</pose></joint>
           <link name='a'><pose relative_to='turned'>1 0 0 0 0 0</pose>{BOX}</link>
           <link name='b'><pose relative_to='on'>1 0 0 0 0 0</pose>{BOX}</link>
           <link name='c'><pose relative_to='j'>0 0 0 0 0 0</pose>{BOX}</link>
           <link name='d'><pose relative_to='__model__'>0 5 0 0 0 0</pose>
             <collision name='c'><pose relative_to='turned'>2 0 0 0 0 0</pose><geometry><box><size>1 1 1</size></box></geometry></collision></link>
           <link name='e'><pose frame='turned'>0 0 0 0 0 0</pose>{BOX}</link>
         </model>"
    ));
    let at: Vec<[f64; 3]> = found.iter().map(|(_, at)| *at).collect();
    assert_eq!(
        at,
        [[11.0, 1.0, 2.0], [11.0, 2.0, 2.0], [11.0, 1.0, 3.0], [11.0, 2.0, 2.0], [11.0, 0.0, 2.0]]
    );
}

#[test]
fn models_are_placed_by_frames_of_the_world_and_of_each_other() {
    let found = stand(&format!(
        "<frame name='hall'><pose>0 10 0 0 0 0</pose></frame>
         <model name='m' placement_frame='foot'><static>1</static><pose relative_to='hall'>1 0 1 0 0 0</pose>
           <link name='foot'><pose>0 0 -3 0 0 0</pose>{BOX}</link>
           <model name='inner'><pose>0 2 0 0 0 0</pose><link name='l'><pose>1 0 0 0 0 0</pose>{BOX}</link></model>
           <link name='beside'><pose relative_to='inner::l'>0 0 0.5 0 0 0</pose>{BOX}</link>
         </model>
         <model name='n' canonical_link='l'><static>1</static><pose relative_to='m::inner'>0 0 0 0 0 0</pose><link name='l'>{BOX}</link></model>"
    ));
    assert_eq!(
        found,
        [
            ("m/foot/c".to_owned(), [1.0, 10.0, 1.0]),
            ("m/inner/l/c".to_owned(), [2.0, 12.0, 4.0]),
            ("m/beside/c".to_owned(), [2.0, 12.0, 4.5]),
            ("n/l/c".to_owned(), [1.0, 12.0, 4.0]),
        ]
    );
}

#[test]
fn angles_may_be_degrees_or_quaternions() {
    let turned = |pose: &str| {
        stand(&format!(
            "<model name='m'><static>1</static>{pose}<link name='l'><pose>1 0 1 0 0 0</pose>{BOX}</link></model>"
        ))[0]
            .1
    };
    assert_eq!(turned("<pose degrees='true'>0 0 0 0 0 90</pose>"), [0.0, 1.0, 1.0]);
    assert_eq!(
        turned("<pose rotation_format='euler_rpy' degrees='true'>0 0 0 0 0 -90</pose>"),
        [0.0, -1.0, 1.0]
    );
    let quaternion = "<pose rotation_format='quat_xyzw'>0 0 0 0 0 0.7071068 0.7071068</pose>";
    assert_eq!(turned(quaternion), [0.0, 1.0, 1.0]);
}

#[test]
fn frames_that_lead_nowhere_are_told() {
    let told = |inner: &str| {
        let text = format!("<sdf version='1.9'><world name='w'>\n{inner}\n</world></sdf>");
        read(&Source::new("t.sdf", text)).unwrap_err()[0].render(false)
    };
    assert_eq!(
        told(&format!(
            "<model name='m'><link name='leg'>{BOX}</link>\n<link name='b'><pose relative_to='log'>0 0 0 0 0 0</pose></link></model>"
        )),
        "\
error: pose relative to the unknown frame `log`
 --> t.sdf:3:16
  |
3 | <link name='b'><pose relative_to='log'>0 0 0 0 0 0</pose></link></model>
  |                ^^^^^ expected a link, joint, frame or model of the same model
  |
  = help: did you mean `leg`? (known: b, leg)
"
    );
    assert_eq!(suggestion("log", ["leg"]), Some("leg"));
    let circle = told(&format!(
        "<model name='m'><frame name='a'><pose relative_to='b'/></frame><frame name='b' attached_to='a'/>\n<link name='l'><pose relative_to='a'/>{BOX}</link></model>"
    ));
    assert!(
        circle.starts_with(
            "error: poses in a circle: `a` relative to `b` relative to `a`\n --> t.sdf:3:16"
        ),
        "{circle}"
    );
    let format = told("<model name='m'><pose rotation_format='axis'>0 0 0 0 0 0</pose></model>");
    assert!(format.starts_with("error: unknown rotation format `axis`"), "{format}");
    let few = told("<model name='m'><pose rotation_format='quat_xyzw'>0 0 0 0 0 0</pose></model>");
    assert!(few.starts_with("error: wrong count of numbers in <pose>"), "{few}");
}

/// Checks that a chain of frames is followed however long it is.
#[test]
fn long_chains_of_frames_are_followed() {
    let mut frames = String::new();
    for i in 0..5000 {
        let (next, pose) = (i + 1, "<pose>0.001 0 0 0 0 0</pose>");
        frames += &format!("<frame name='f{next}' attached_to='f{i}'>{pose}</frame>");
    }
    let found = stand(&format!(
        "<model name='m'><static>1</static><frame name='f0'/>{frames}<link name='l'><pose relative_to='f5000'>0 0 1 0 0 0</pose>{BOX}</link></model>"
    ));
    assert_eq!(found[0].1, [5.0, 0.0, 1.0]);
}
