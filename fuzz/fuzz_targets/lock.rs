//! Locks: what is read is written again alike.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::compare::Lock;
use reenact::document::Source;

fuzz_target!(|text: &str| {
    if let Ok(lock) = Lock::read(&Source::new("fuzz.lock", text)) {
        let again = Lock::read(&Source::new("again.lock", lock.to_text()));
        assert_eq!(again, Ok(lock));
    }
});
