//! The prior-knowledge study's own Gazebo world and floor plan, where they are at hand: set
//! `REENACT_ORIGINAL_WORLDS` to the folder that holds `worlds/` and `priors/`. They are never part of this
//! repository.

use crate::sandbox::repository;
use reenact::document::Source;
use reenact::manifest::{self, InputError, Inputs, WrittenIn};
use reenact::plan::{Plan, Selection};
use reenact::provenance::Environment;
use reenact::studies::{self, Outcome};
use std::path::PathBuf;

struct Disk(PathBuf);

impl Inputs for Disk {
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, InputError> {
        let path = match written_in {
            WrittenIn::Manifest => self.0.join(as_written),
            WrittenIn::CommandLine
            | WrittenIn::Calibration
            | WrittenIn::Inference
            | WrittenIn::PreviousMap => PathBuf::from(as_written),
        };
        std::fs::read(&path).map_err(|e| {
            InputError::other(std::io::Error::new(e.kind(), format!("{}: {e}", path.display())))
        })
    }
}

#[test]
fn the_original_basic_world_is_explored_with_and_without_its_own_floor_plan() {
    let Some(originals) = Environment::read().unwrap().original_worlds else {
        #[expect(clippy::print_stdout, reason = "a skipped test says so")]
        {
            println!("skipped: REENACT_ORIGINAL_WORLDS is not set");
        }
        return;
    };
    let root = repository();
    let text = std::fs::read_to_string(root.join("manifests/quickstart.yaml")).unwrap();
    let file = |name: &str| originals.join(name).display().to_string();
    let world = file("worlds/basic_no_furniture.world");
    let plan = file("priors/blueprint_map_server_basic_floorplan.yaml");
    let overrides = [
        format!("world.file={world}"),
        format!("prior-maps.floor-plan={{map: {plan}, frame: start}}"),
    ];
    let source = Source::new("manifests/quickstart.yaml", text);
    let inputs = Disk(root.join("manifests"));
    let (experiment, _) =
        manifest::resolve(&source, &overrides, &inputs).unwrap_or_else(|faults| {
            panic!("{}", faults.iter().map(|f| f.render(false)).collect::<String>())
        });
    let selection = Selection { trials: Some(1), ..Selection::default() };
    for spec in &Plan::select(experiment, &selection).unwrap().trials {
        let record = studies::execute(spec);
        assert_eq!(record.outcome, Outcome::EXPLORED, "{}: {}", spec.condition, record.cause);
        let coverage = record.measures["coverage-percent"].unwrap();
        assert!(coverage > 99.0, "{}: {coverage} %", spec.condition);
        assert_eq!(record.measures["contacts"], Some(0.0), "{}", spec.condition);
    }
}
