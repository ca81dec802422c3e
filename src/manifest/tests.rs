//! The study's own worlds and priors, where a test finds them.

use super::*;
use crate::document::Source;
use crate::studies::Setup;
use crate::world::originals;
use std::path::PathBuf;

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
