//! Plans of shipped manifests: the same worlds, robots and parameters for every benchmark.

use reenact::manifest::{self, InputError, Inputs, WrittenIn};
use reenact::plan::Plan;
use std::path::{Path, PathBuf};

/// Files relative to the manifests.
struct Files(PathBuf);

impl Inputs for Files {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        std::fs::read(self.0.join(as_written)).map_err(InputError::other)
    }
}

/// All trials of the manifest `name`.
pub(crate) fn plan(name: &str) -> Plan {
    plan_with(name, &[])
}

/// All trials of the manifest `name` after `assignments`, as `--set` takes them.
pub(crate) fn plan_with(name: &str, assignments: &[String]) -> Plan {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manifests");
    let text = std::fs::read_to_string(folder.join(name)).expect("it is shipped");
    let source = reenact::document::Source::new(name, text);
    let (experiment, _) = manifest::resolve(&source, assignments, &Files(folder))
        .unwrap_or_else(|faults| panic!("{name} has {} faults", faults.len()));
    Plan::of(experiment)
}
