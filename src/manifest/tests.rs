//! Settings beneath parameters; the study's own worlds and priors, where a test finds them.

use super::*;
use crate::document::Source;
use crate::studies::{Setup, prior_map};
use crate::world::originals;
use std::path::PathBuf;

/// What `settings` and the manifest's own `parameters` make of the range, the noise and the resolution.
fn with_settings(overrides: &[&str]) -> (prior_map::Parameters, Experiment) {
    struct Shared;
    impl Inputs for Shared {
        fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, String> {
            let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
            match as_written {
                "shared.yaml" => Ok(b"reenact-settings: 1\nstudy: prior-map\nparameters:\n  sensing:\n    \
                    range-m: {value: 10, why: hardware}\n    range-noise-sd-m: {value: 0.1, why: shared}\n  \
                    mapping: {resolution-m: {value: 0.2, why: coarse}}\n"
                    .to_vec()),
                "other.yaml" => Ok(b"reenact-settings: 1\nstudy: prior-map\nparameters: {sensing: {range-m: 7}}\n".to_vec()),
                _ => std::fs::read(root.join(as_written)).map_err(|e| e.to_string()),
            }
        }
    }
    let text = "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\nseed: 1\ntrials: 1\nrobot: robots/kobuki.urdf\n\
        world: {file: worlds/basic.yaml}\nstart: {x-m: 3, y-m: 2}\nsettings: shared.yaml\n\
        parameters: {sensing: {range-noise-sd-m: {value: 0.01, why: own}}}\n";
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let (experiment, _) = resolve(&Source::new("a.yaml", text), &overrides, &Shared)
        .unwrap_or_else(|faults| panic!("{}", faults[0].render(false)));
    let Setup::PriorMap(setup) = &experiment.conditions[0].1 else {
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

struct Folder(PathBuf);

impl Inputs for Folder {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, String> {
        let path = match as_written.strip_prefix("robots/") {
            Some(robot) => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("robots").join(robot),
            None => self.0.join(as_written),
        };
        std::fs::read(path).map_err(|e| e.to_string())
    }
}

/// Warnings and prior of the basic world with `prior`, which is written in flow style.
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
    let Setup::PriorMap(setup) = &experiment.conditions[0].1 else {
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
