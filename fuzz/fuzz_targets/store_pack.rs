//! A pack of records from another store: whole or refused, and nothing else.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::store::check_pack;

fuzz_target!(|bytes: &[u8]| {
    let lines = bytes.split(|byte| *byte == b'\n').count();
    if let Ok(records) = check_pack(bytes) {
        // A first line, a last one, and nothing behind its end.
        assert_eq!(lines, records + 3);
    }
});
