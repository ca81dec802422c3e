//! Files that are given as keys to trust: a refusal says why, and shows nothing of a private key.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::{Source, reports};
use reenact::verify::Trust;

fuzz_target!(|text: &str| {
    if let Err(faults) = Trust::read(&Source::new("keys", text)) {
        let told = reports(&faults, false);
        assert!(!told.is_empty(), "a refusal says why");
        if text.contains("-----BEGIN OPENSSH PRIVATE KEY-----") {
            assert_eq!(told.len(), 1, "one refusal, whatever else the file holds");
            assert!(!told[0].contains(" --> "), "no line of it is shown");
        }
    }
});
