//! Robots.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::Source;
use reenact::robot::urdf;

fuzz_target!(|text: &str| {
    if let Ok((robot, _)) = urdf::read(&Source::new("fuzz.urdf", text)) {
        robot.meaning();
    }
});
