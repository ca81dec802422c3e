//! CSV tables.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::table::Table;

fuzz_target!(|text: &str| {
    if let Ok(table) = Table::from_csv(text) {
        table.to_csv();
        table.to_markdown();
    }
});
