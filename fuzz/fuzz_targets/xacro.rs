//! Macros of robots: expanded, with one file to include.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::document::{Diagnostic, Source};
use reenact::robot::description::{self, Request};
use reenact::robot::given::Given;
use reenact::robot::{FilePath, Files, Rooted, Unfound};
use std::collections::BTreeMap;

/// Every file that is asked for is this one.
struct Same<'t>(&'t str);

impl Files for Same<'_> {
    fn text(&mut self, file: &FilePath) -> Result<Source, Unfound> {
        Ok(Source::new(file.path.as_str(), self.0))
    }

    fn corners(&mut self, _: &FilePath) -> Result<Vec<[f64; 3]>, Unfound> {
        Ok(vec![[0.0; 3], [1.0, 0.0, 0.5], [0.0, 1.0, 1.0]])
    }
}

fuzz_target!(|text: &str| {
    let body = format!("<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>{text}</robot>");
    let nothing = BTreeMap::new();
    let request = Request {
        path: FilePath { path: "pkg/r.xacro".to_owned(), rooted: Rooted::Robot },
        gazebo: Vec::new(),
        packages: &nothing,
        arguments: &nothing,
        given: &Given::default(),
        fault: &|_, message| Diagnostic::placeless(message),
    };
    if let Ok((robot, _)) = description::read(&Source::new("r", body), &request, &mut Same(text)) {
        robot.meaning();
    }
});
