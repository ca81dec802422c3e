//! A manifest of anyone, with a robot and a world that exist.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::{MOST_FAULTS, Source, reports};
use reenact::manifest::{self, InputError, Inputs, WrittenIn};

struct Shipped;

impl Inputs for Shipped {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        match as_written.rsplit('/').next() {
            Some("kobuki.urdf") => Ok(include_bytes!("../../robots/kobuki.urdf").to_vec()),
            Some("basic.yaml") => Ok(include_bytes!("../../worlds/basic.yaml").to_vec()),
            _ => Err(InputError::NoFile),
        }
    }
}

fuzz_target!(|text: &str| {
    if let Err(faults) = manifest::resolve(&Source::new("fuzz.yaml", text), &[], &Shipped) {
        assert!(!faults.is_empty(), "a refusal says why");
        // Of so many the first hundred are told, and how many more there are.
        assert!(reports(&faults, false).len() <= MOST_FAULTS + 2);
    }
});
