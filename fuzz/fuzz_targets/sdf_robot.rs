//! Robots as SDF models.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::Source;
use reenact::robot::urdf;

fuzz_target!(|text: &str| {
    let model = format!("<sdf version='1.8'><model name='m'>{text}</model></sdf>");
    for text in [text, &model] {
        if let Ok((robot, _)) = urdf::read(&Source::new("fuzz.sdf", text)) {
            robot.meaning();
        }
    }
});
