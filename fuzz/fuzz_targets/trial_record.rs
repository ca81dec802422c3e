//! A line of `trials/*.jsonl`: the canonical line of what was read reads back as the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::studies::TrialRecord;

fuzz_target!(|line: &str| {
    if let Ok(record) = TrialRecord::from_line(line) {
        assert_eq!(TrialRecord::from_line(&record.to_line()).as_ref(), Ok(&record));
    }
});
