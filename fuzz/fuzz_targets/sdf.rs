//! Gazebo worlds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::Source;
use reenact::world::sdf;

fuzz_target!(|text: &str| {
    if let Ok(world) = sdf::read(&Source::new("fuzz.world", text)) {
        world.slice(0.16);
        world.contact(0.0, 0.5);
        world.meaning();
    }
});
