//! `map_server` maps: a descriptor, a zero byte, an image.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::Source;
use reenact::world::map_server::{self, Options};

fuzz_target!(|data: &[u8]| {
    let Some(zero) = data.iter().position(|byte| *byte == 0) else { return };
    let Ok(text) = std::str::from_utf8(&data[..zero]) else { return };
    let source = Source::new("fuzz.yaml", text);
    for average_alpha in [true, false] {
        let options = Options { average_alpha };
        if let Err(faults) = map_server::read(&source, "fuzz.png", &data[zero + 1..], options) {
            assert!(!faults.is_empty(), "a refusal says why");
        }
    }
});
