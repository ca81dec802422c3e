//! Progress for people: a bar where stderr is a terminal, silence in pipes.

use super::terminal::{Terminal, counted};
use crate::runner::{Observer, RunEvent};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::atomic::{AtomicU64, Ordering};

/// A bar with trials done, cached and failed, time left and how much faster than real time it goes.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    simulated_ms: AtomicU64,
    cached: AtomicU64,
    failed: AtomicU64,
}

impl Progress {
    pub(super) fn new(terminal: Terminal) -> Self {
        let bar = if terminal.is_watched() {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
        } else {
            ProgressBar::hidden()
        };
        let template = if terminal.color() {
            "{bar:24.cyan} {pos}/{len} trials  {msg}  {eta} left"
        } else {
            "{bar:24} {pos}/{len} trials  {msg}  {eta} left"
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("━╸ "));
        }
        let zero = || AtomicU64::new(0);
        Self { bar, simulated_ms: zero(), cached: zero(), failed: zero() }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn message(&self) -> String {
        let elapsed = self.bar.elapsed().as_secs_f64();
        #[expect(clippy::cast_precision_loss, reason = "a rate for people")]
        let simulated = self.simulated_ms.load(Ordering::Relaxed) as f64 / 1000.0;
        let mut message = if elapsed > 0.5 {
            format!("{:.0}x real time", simulated / elapsed)
        } else {
            String::new()
        };
        for (count, what) in [(&self.cached, "cached"), (&self.failed, "failed")] {
            let count = count.load(Ordering::Relaxed);
            if count > 0 {
                message.push_str(&format!("  {count} {what}"));
            }
        }
        message
    }
}

impl Observer for Progress {
    fn notice(&self, event: &RunEvent<'_>) {
        match event {
            RunEvent::Started { trials, cached, jobs } => {
                self.bar.set_length(*trials as u64);
                let threads = counted(*jobs, "thread");
                self.bar.println(format!("running {trials} trials, {cached} cached, on {threads}"));
            }
            RunEvent::Finished { record, cached, .. } => {
                if *cached {
                    self.cached.fetch_add(1, Ordering::Relaxed);
                } else {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "simulated seconds are positive and few"
                    )]
                    let ms = (record.sim_seconds * 1000.0) as u64;
                    self.simulated_ms.fetch_add(ms, Ordering::Relaxed);
                }
                if record.outcome == crate::studies::Outcome::Panicked {
                    self.failed.fetch_add(1, Ordering::Relaxed);
                }
                self.bar.set_message(self.message());
                self.bar.inc(1);
            }
        }
    }
}
