//! Gazebo worlds: a world, and two models that it may include and that may include each other. The texts are parted by a line
//! of one `%`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::Source;
use reenact::world::sdf::{self, FilePath, Folders, Models};
use std::sync::Arc;

/// The models `a` and `b`, and a mesh.
struct Shelf<'t>([&'t str; 2]);

impl Models for Shelf<'_> {
    fn folders(&self) -> Folders {
        Folders { path: vec!["m".to_owned()], ..Folders::default() }
    }

    fn read(&mut self, path: &FilePath) -> Result<Arc<[u8]>, String> {
        match path.path.as_str() {
            "m/a/model.sdf" => Ok(self.0[0].as_bytes().into()),
            "m/b/model.sdf" => Ok(self.0[1].as_bytes().into()),
            "m/b/model.config" => Ok(self.0[0].as_bytes().into()),
            "m/a/c.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n".as_slice().into()),
            _ => Err("no such file".to_owned()),
        }
    }

    fn wanted(&mut self, name: &str) -> bool {
        name != "a/b"
    }
}

fuzz_target!(|text: &str| {
    let mut texts = text.splitn(3, "\n%\n");
    let mut next = || texts.next().unwrap_or_default();
    let (world, a, b) = (next(), next(), next());
    if let Ok(world) = sdf::read_with(&Source::new("fuzz.world", world), &mut Shelf([a, b])) {
        world.slice(0.16);
        world.contact(0.0, 0.5);
        world.meaning();
    }
});
