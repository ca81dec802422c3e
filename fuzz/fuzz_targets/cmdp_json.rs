//! Problems for `reenact solve-cmdp`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::cmdp::solve_document;

fuzz_target!(|text: &str| {
    let _ = solve_document(text);
});
