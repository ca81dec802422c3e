//! World YAML.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::Source;
use reenact::world::document;

fuzz_target!(|text: &str| {
    if let Ok(world) = document::read(&Source::new("fuzz.yaml", text), None) {
        world.slice(0.16);
        world.contact(0.0, 0.5);
        world.meaning();
    }
});
