//! Zips of anyone: what is read has the account of its bytes, and reads back alike once it is written again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::bundle::archive::{self, Limits};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits::default();
    match archive::read(bytes, &limits) {
        Ok(archive) => {
            // Nothing can be before or behind what was read.
            for unlisted in [[bytes, b"\0"].concat(), [b"\0", bytes].concat()] {
                assert!(archive::read(&unlisted, &limits).is_err(), "a byte of nobody");
            }
            let form = archive.form;
            let again = archive::read(&archive::write(&archive.tree, "bag", form), &limits);
            assert_eq!(again, Ok(archive), "{form:?}");
        }
        Err(faults) => assert!(!faults.is_empty() && faults.len() <= 101, "a refusal says why"),
    }
});
