//! Processor time, which other processes on the machine do not lengthen as they do time on a clock.

/// Returns the seconds this thread has had on a processor where Linux tells them, else the seconds that passed.
pub(crate) fn seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(elapsed, |nanoseconds| nanoseconds / 1e9)
}

#[expect(clippy::disallowed_methods, reason = "a benchmark looks at the clock")]
fn elapsed() -> f64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.map_or(0.0, |now| now.as_secs_f64())
}
