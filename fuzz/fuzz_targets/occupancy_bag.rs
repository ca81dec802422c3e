//! The occupancy grid of an MCAP file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reenact::world::map_server::bag::read_bag;

fuzz_target!(|data: &[u8]| {
    for topic in [None, Some("/map")] {
        match read_bag(data, topic) {
            Ok(map) => assert!(!map.values().is_empty(), "a map has cells"),
            Err(why) => assert!(!why.to_string().is_empty(), "a refusal says why"),
        }
    }
});
