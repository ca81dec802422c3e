//! Bundles: archives of anyone, and what they hold.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::bundle::Bundle;
use reenact::bundle::archive::{self, Limits};

fuzz_target!(|bytes: &[u8]| {
    match archive::read(bytes, &Limits::default()) {
        Ok(archive) => drop(Bundle::open(archive)),
        Err(faults) => assert!(!faults.is_empty(), "a refusal says why"),
    }
});
