//! Settings beneath parameters; the study's own worlds and priors, where a test finds them.

use super::*;
use crate::document::{Diagnostic, Source};
use crate::geometry::{Outline, Point};
use crate::grid::{Occupancy, OccupancyGrid};
use crate::studies::{TrialSpec, prior_map};
use crate::world::originals;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Returns the parameters and the experiment that `settings`, the manifest's own `parameters` and `overrides` make of
/// the range, the noise and the resolution.
fn with_settings(overrides: &[&str]) -> (prior_map::Parameters, Experiment) {
    struct Shared;
    impl Inputs for Shared {
        fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
            let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
            match as_written {
                "shared.yaml" => Ok(b"reenact-settings: 1\nstudy: prior-map\nparameters:\n  sensing:\n    \
                    range-m: {value: 10, why: hardware}\n    range-noise-sd-m: {value: 0.1, why: shared}\n  \
                    mapping: {resolution-m: {value: 0.2, why: coarse}}\n"
                    .to_vec()),
                "other.yaml" => Ok(b"reenact-settings: 1\nstudy: prior-map\nparameters: {sensing: {range-m: 7}}\n".to_vec()),
                _ => std::fs::read(root.join(as_written)).map_err(InputError::other),
            }
        }
    }
    let text = "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: robots/kobuki.urdf\n\
        world: {file: worlds/basic.yaml}\nstart: {x-m: 3, y-m: 2}\nsettings: shared.yaml\n\
        parameters: {sensing: {range-noise-sd-m: {value: 0.01, why: own}}}\n";
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let (experiment, _) = resolve(&Source::new("a.yaml", text), &overrides, &Shared)
        .unwrap_or_else(|faults| panic!("{}", faults[0].render(false)));
    let Some(setup) = experiment.conditions[0].setup.of::<prior_map::Setup>() else {
        panic!("a study of another kind")
    };
    (setup.parameters.clone(), experiment)
}

#[test]
fn settings_lie_beneath_the_manifests_own_parameters() {
    let (parameters, experiment) = with_settings(&[]);
    let sensing = &parameters.sensing;
    assert_eq!((sensing.range_m, sensing.range_noise_sd_m), (Some(10.0), Some(0.01)));
    assert_eq!(parameters.mapping.resolution_m, 0.2);
    let whys: Vec<&str> = experiment.assumptions.iter().map(|a| a.why.as_str()).collect();
    assert_eq!(whys, ["coarse", "hardware", "own"], "a reason goes with the value it is for");
    assert!(experiment.inputs.iter().any(|input| input.as_written == "shared.yaml"), "sealed");
}

#[test]
fn the_command_line_goes_over_both_and_can_name_other_settings() {
    let (parameters, _) = with_settings(&["parameters.sensing.range-m=5"]);
    assert_eq!((parameters.sensing.range_m, parameters.mapping.resolution_m), (Some(5.0), 0.2));
    let (parameters, _) = with_settings(&["settings=other.yaml"]);
    assert_eq!((parameters.sensing.range_m, parameters.mapping.resolution_m), (Some(7.0), 0.1));
}

#[test]
fn of_several_settings_the_later_go_over_the_earlier() {
    let both = |files: &str| {
        let (parameters, _) = with_settings(&[&format!("settings={files}")]);
        (parameters.sensing.range_m, parameters.mapping.resolution_m)
    };
    assert_eq!(both("[shared.yaml, other.yaml]"), (Some(7.0), 0.2));
    assert_eq!(both("[other.yaml, shared.yaml]"), (Some(10.0), 0.2));
}

/// Returns what becomes of a manifest with one file of settings for each of two readings, or its first fault.
fn with_readings(described: &str, released: &str) -> Result<(Experiment, Vec<Diagnostic>), String> {
    struct Two([String; 2]);
    impl Inputs for Two {
        fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
            let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
            match as_written {
                "described.yaml" => Ok(self.0[0].clone().into_bytes()),
                "released.yaml" => Ok(self.0[1].clone().into_bytes()),
                _ => std::fs::read(root.join(as_written)).map_err(InputError::other),
            }
        }
    }
    let text = "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: robots/kobuki.urdf\n\
        world: {file: worlds/basic.yaml}\nstart: {x-m: 3, y-m: 2}\n\
        settings: {by: reading, values: {described: described.yaml, released: released.yaml}}\n\
        factors: {reading: [described, released]}\nparameters: {sensing: {range-m: 9}}\nclaims-by: reading\n\
        claims: [{id: a, ours: quick, expect: {between: {metric: time-s, high: 900}}}]\n";
    let head = "reenact-settings: 1\nstudy: prior-map\nparameters:\n";
    let files = Two([described, released].map(|parameters| format!("{head}{parameters}")));
    resolve(&Source::new("a.yaml", text), &[], &files)
        .map_err(|faults| faults.iter().map(|fault| fault.render(false)).collect())
}

#[test]
fn each_reading_has_settings_of_its_own_and_verdicts_of_its_own() {
    let (experiment, _) = with_readings(
        "  sensing: {range-m: 10}\n  exploration: {gain: paper, candidate: middle}\n",
        "  sensing: {range-m: 30}\n  exploration: {gain: {value: released, why: line 3}, candidate: nearest-to-centroid}\n",
    )
    .unwrap();
    let gains = experiment.conditions.iter().map(|condition| {
        let setup = condition.setup.of::<prior_map::Setup>().unwrap();
        (setup.parameters.sensing.range_m, setup.parameters.exploration.gain)
    });
    let (paper, released) = (prior_map::Gain::Paper, prior_map::Gain::Released);
    assert_eq!(gains.collect::<Vec<_>>(), [(Some(9.0), paper), (Some(9.0), released)]);
    let whys: Vec<_> =
        experiment.assumptions.iter().map(|a| (a.path.as_str(), a.why.as_str())).collect();
    assert_eq!(whys, [("parameters.exploration.gain.values.released", "line 3")]);
    let ids: Vec<&str> = experiment.claims.iter().map(|claim| claim.id.as_str()).collect();
    assert_eq!(ids, ["a-described", "a-released"]);
    assert_eq!(experiment.claims[1].only.to_string(), "reading=released");
}

#[test]
fn settings_of_a_reading_that_leave_out_what_another_sets_are_a_fault() {
    let fault = with_readings(
        "  exploration: {gain: paper}\n",
        "  exploration: {gain: released, candidate: nearest-to-centroid}\n",
    )
    .unwrap_err();
    assert_eq!(
        fault,
        "error: `exploration.candidate` is set here and not in `described.yaml`
 --> released.yaml:4:33
  |
4 |   exploration: {gain: released, candidate: nearest-to-centroid}
  |                                 ^^^^^^^^^ expected in all of `settings`
  |
  = help: say there what holds for `described`
"
    );
}

struct Folder(PathBuf);

impl Inputs for Folder {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        let path = match as_written.strip_prefix("robots/") {
            Some(robot) => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("robots").join(robot),
            None => self.0.join(as_written),
        };
        std::fs::read(path).map_err(InputError::other)
    }
}

/// Returns the warnings for the basic world with `prior`, which is written in flow style, and its experiment.
fn basic(folder: PathBuf, prior: &str) -> (String, Experiment) {
    let text = format!(
        "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: robots/kobuki.urdf\n\
         world: {{file: worlds/basic_no_furniture.world}}\nstart: {{x-m: 3, y-m: 2}}\nprior: p\n\
         prior-maps: {{p: {prior}}}\n"
    );
    match resolve(&Source::new("a.yaml", text), &[], &Folder(folder)) {
        Ok((experiment, warnings)) => {
            let told: Vec<String> = warnings.iter().map(|w| w.message.clone()).collect();
            (told.join("\n"), experiment)
        }
        Err(faults) => {
            panic!("{}", faults.iter().map(|f| f.render(false)).collect::<String>())
        }
    }
}

#[test]
fn the_authors_floor_plan_lies_on_their_world_in_the_frame_of_the_start() {
    let Some(folder) = originals::folder("their floor plan") else { return };
    let yaml = "priors/blueprint_map_server_basic_floorplan.yaml";
    let (told, experiment) = basic(folder.clone(), &format!("{{map: {yaml}, frame: start}}"));
    assert_eq!(told, "");
    let names: Vec<&str> = experiment.inputs.iter().map(|i| i.as_written.as_str()).collect();
    assert!(names.contains(&"floorplans/basic.png"), "{names:?}");
    let Some(setup) = experiment.conditions[0].setup.of::<prior_map::Setup>() else {
        panic!("a study of another kind")
    };
    let origin = setup.prior.as_ref().unwrap().frame().origin;
    // facts: P0 = (-8.9, -5.1) for a robot that starts at the world's origin.
    assert!((origin.x + 8.9).abs() < 1e-9 && (origin.y + 5.1).abs() < 1e-9, "{origin:?}");

    let footprint = "priors/blueprint_map_server_basic_footprint.yaml";
    assert_eq!(basic(folder.clone(), &format!("{{map: {footprint}, frame: start}}")).0, "");
    let (told, _) = basic(folder, &format!("{{map: {yaml}, frame: world}}"));
    assert!(told.starts_with("the prior map fits the world badly: "), "{told}");
}

/// Files in memory, and a count of the explorations that were asked for.
struct Workshop {
    files: BTreeMap<String, Vec<u8>>,
    explored: std::cell::RefCell<Vec<[String; 2]>>,
}

impl Inputs for Workshop {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        self.files.get(as_written).cloned().ok_or(InputError::NoFile)
    }

    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        self.explored.borrow_mut().push(sealed_as.clone());
        Ok(explored(spec, sealed_as)?)
    }
}

/// Two rooms that change: a box stands elsewhere at every time.
const ROOMS: &str = "reenact-world: 1\nname: rooms\nsource: test\nlayers:\n  walls:\n    walls:\n      \
    - {path-m: [[0, 0], [8, 0], [8, 4], [0, 4], [0, 0]], thickness-m: 0.2}\n      \
    - {path-m: [[4, 0], [4, 2.5]], thickness-m: 0.2}\n  \
    t0: {boxes: [{center-m: [6, 1], size-m: [0.6, 0.6]}]}\n  t1: {boxes: [{center-m: [7, 3], size-m: [0.6, 0.6]}]}\n  \
    t2: {boxes: [{center-m: [2, 3], size-m: [0.6, 0.6]}]}\nstarts: {a: {at-m: [1, 1], heading-deg: 0}}\n";

fn changing(
    prior_maps: &str,
    overrides: &[&str],
) -> (Result<Experiment, String>, Vec<[String; 2]>) {
    let text = format!(
        "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: kobuki.urdf\n\
         world: {{file: rooms.yaml, layers: [walls, t2]}}\nstart: a\nprior: m1\nprior-maps:\n{prior_maps}\n\
         parameters: {{sensing: {{range-m: 10}}}}\n"
    );
    let robot = std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("robots/kobuki.urdf"));
    let files = [("rooms.yaml", ROOMS.as_bytes().to_vec()), ("kobuki.urdf", robot.unwrap())];
    let workshop = Workshop {
        files: files.map(|(name, bytes)| (name.to_owned(), bytes)).into(),
        explored: std::cell::RefCell::default(),
    };
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let resolved = match resolve(&Source::new("a.yaml", text), &overrides, &workshop) {
        Ok((experiment, warnings)) => {
            assert_eq!(warnings, []);
            Ok(experiment)
        }
        Err(faults) => Err(faults.iter().map(|f| f.render(false)).collect()),
    };
    (resolved, workshop.explored.into_inner())
}

const CHAIN: &str = "  m0: {previous-map: {world: {file: rooms.yaml, layers: [walls, t0]}, prior: none, why: first}}\n  \
    m1: {previous-map: {world: {file: rooms.yaml, layers: [walls, t1]}, prior: m0, why: second}}";

fn prior_of(experiment: &Experiment) -> OccupancyGrid {
    let Some(setup) = experiment.conditions[0].setup.of::<prior_map::Setup>() else {
        panic!("a study of another kind")
    };
    setup.prior.as_deref().cloned().unwrap()
}

#[test]
fn a_previous_map_is_what_the_robot_before_ended_with_in_the_worlds_frame() {
    let (experiment, explored) = changing(CHAIN, &[]);
    let experiment = experiment.unwrap();
    assert_eq!(explored.len(), 2, "each exploration once");
    let map = prior_of(&experiment);
    let at = |x: f64, y: f64| map.at(map.frame().cell_at(Point::new(x, y)));
    // The walls and the box of t1 are drawn where they stood; the box of t0 left no trace, nor that of t2.
    assert_eq!(at(7.0, 2.72), Occupancy::Occupied);
    assert_eq!([at(6.0, 1.0), at(2.0, 3.0), at(1.0, 1.0)], [Occupancy::Free; 3]);
    assert_eq!([at(7.0, 3.0), at(-0.3, -0.3)], [Occupancy::Unknown; 2], "inside and outside");
    let sealed: Vec<&Input> =
        experiment.inputs.iter().filter(|i| i.written_in == WrittenIn::PreviousMap).collect();
    assert_eq!(sealed.len(), 4, "descriptor and image of each");
    let yaml = String::from_utf8(sealed[1].bytes.to_vec()).unwrap();
    assert!(yaml.starts_with(&format!("image: {}\n", sealed[0].name)), "{yaml}");
    let whys: Vec<&str> = experiment.assumptions.iter().map(|a| a.why.as_str()).collect();
    assert_eq!(whys, ["first", "second"]);

    let free = CHAIN.replace("prior: m0,", "prior: m0, unknown: free,");
    let map = prior_of(&changing(&free, &[]).0.unwrap());
    assert_eq!(map.count(Occupancy::Unknown), 0);
    let keys = |maps: &str| changing(maps, &[]).0.unwrap().conditions[0].meanings.prior;
    assert_eq!(keys(CHAIN), keys(CHAIN), "a function of the manifest");
    let second = |maps: &str| changing(maps, &[]).1.pop();
    assert_ne!(second(CHAIN), second(&CHAIN.replace("t0", "t2")), "what it knew then counts");
    assert_ne!(
        changing(CHAIN, &[]).1,
        changing(CHAIN, &["seed=2"]).1,
        "the experiment's seed is that of its explorations"
    );
    let seeded = CHAIN.replace("why: ", "seed: 5, why: ");
    assert_eq!(changing(&seeded, &[]).1, changing(&seeded, &["seed=2"]).1);
}

#[test]
fn a_previous_map_that_cannot_be_is_told() {
    let told = |maps: &str| changing(maps, &[]).0.unwrap_err();
    let circle = told(&CHAIN.replace("prior: none", "prior: m1"));
    assert!(circle.contains("error: `m1` from `m0` is made from `m1` again"), "{circle}");
    assert!(circle.contains("no exploration can be the first"), "{circle}");
    let near = told(&CHAIN.replace("prior: m0", "prior: mo"));
    assert!(
        near.contains("error: unknown prior map `mo`") && near.contains("did you mean `m0`?"),
        "{near}"
    );
    let turned = told(
        &CHAIN.replace("prior: none", "start: {x-m: 1, y-m: 1, heading-deg: 90}, prior: none"),
    );
    assert!(turned.contains("a previous map needs a start that faces along x"), "{turned}");
    assert!(turned.contains("this start is turned by 90 degrees"), "{turned}");
    let silent = told(&CHAIN.replace(", why: first", ""));
    assert!(silent.contains("why"), "{silent}");
}

/// A world whose table is a mesh, and its lamp another.
const MESHED: &str = "<sdf version='1.6'><world name='w'><model name='house'><static>1</static><link name='l'>\
    <collision name='wall'><pose>0 3 1 0 0 0</pose><geometry><box><size>9 0.2 2</size></box></geometry></collision>\
    <collision name='table'><pose>2 0 0 0 0 0</pose><geometry><mesh><uri>model://shop/table.stl</uri></mesh></geometry></collision>\
    <collision name='lamp'><pose>0 2 0 0 0 0</pose><geometry><mesh><uri>model://shop/lamp.dae</uri></mesh></geometry></collision>\
    </link></model></world></sdf>";

fn meshed(world: &str, files: &[(&str, &str)]) -> Result<(Experiment, String), String> {
    let text = format!(
        "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: kobuki.urdf\n\
         world: {world}\nstart: {{x-m: -2, y-m: 0}}\n"
    );
    let robot = std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("robots/kobuki.urdf"));
    let all = [("w.world", MESHED)].iter().chain(files);
    let mut files: BTreeMap<String, Vec<u8>> =
        all.map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect();
    files.insert("kobuki.urdf".to_owned(), robot.unwrap());
    let workshop = Workshop { files, explored: std::cell::RefCell::default() };
    let told = |faults: &[Diagnostic]| faults.iter().map(|f| f.render(false)).collect::<String>();
    match resolve(&Source::new("a.yaml", text), &[], &workshop) {
        Ok((experiment, warnings)) => Ok((experiment, told(&warnings))),
        Err(faults) => Err(told(&faults)),
    }
}

const TABLE: &str = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0.4\nvertex 0 0 0.4\nendloop\n\
    endfacet\nendsolid t\n";

#[test]
fn meshes_in_the_folders_of_models_are_sealed_and_others_are_named() {
    let plain = meshed("{file: w.world}", &[("m/table.stl", TABLE)]).unwrap();
    assert!(plain.1.contains("`w.world` is incomplete (things missing: 2)"), "{}", plain.1);
    let (experiment, told) =
        meshed("{file: w.world, models: {shop: m}}", &[("m/table.stl", TABLE)]).unwrap();
    assert!(told.contains("`w.world` is incomplete (things missing: 1)"), "{told}");
    assert!(
        told.contains(
            "is a mesh `model://shop/lamp.dae`; `m/lamp.dae`: no such file: it is missing"
        ),
        "{told}"
    );
    let names: Vec<&str> = experiment.inputs.iter().map(|i| i.as_written.as_str()).collect();
    assert_eq!(names, ["kobuki.urdf", "m/table.stl", "w.world"]);
    assert_ne!(experiment.conditions[0].meanings.world, plain.0.conditions[0].meanings.world);
    let world = |experiment: &Experiment| experiment.conditions[0].described["world"].clone();
    assert_eq!(world(&experiment)["models"], serde_json::json!({"shop": "m"}));
    assert_eq!(world(&plain.0).get("models"), None, "nothing changes for others");

    let stand_in = "{file: w.world, models: {shop: m}, stand-ins: {\"model://shop/lamp.dae\": {circles: \
        [{center-m: [0, 0], radius-m: 0.1, z-m: [0, 1.5]}]}, \"model://shop/lamb.dae\": {}}}";
    let (experiment, told) = meshed(stand_in, &[("m/table.stl", TABLE)]).unwrap();
    assert!(!told.contains("incomplete") && told.contains("this stands in for nothing"), "{told}");
    let lamp = experiment.conditions[0].setup.world().solids.last().unwrap().body.slice(0.2);
    assert_eq!(lamp, [Outline::Circle { center: Point::new(0.0, 2.0), radius: 0.1 }]);

    let broken = meshed(&stand_in.replace("radius-m: 0.1", "radius-m: -1"), &[]).unwrap_err();
    assert!(broken.contains("error: length out of range"), "{broken}");
    let torn = TABLE.replace("vertex 1 0 0.4", "vertex 1 0");
    let torn = meshed("{file: w.world, models: {shop: m}}", &[("m/table.stl", &torn)]).unwrap_err();
    assert!(torn.contains("error: cannot read the mesh `m/table.stl`: "), "{torn}");
}
