//! Ctrl-C, or a request to end: nothing half written stays, and whoever watches reads how to go on. The process then ends as
//! it would have without a word: by the signal.
//!
//! A process that is killed cannot do this, and need not: what is stored is stored, and the next run finds it.

use super::terminal::{Terminal, counted};
use crate::store;
use indicatif::ProgressBar;
use std::sync::{Mutex, Once, PoisonError};

/// The run that would be interrupted.
#[derive(Debug, Clone)]
pub(super) struct Underway {
    pub(super) name: String,
    pub(super) trials: usize,
    /// Those that are done.
    pub(super) done: usize,
    /// Whether what is done is in the store.
    pub(super) keeps: bool,
    pub(super) bar: ProgressBar,
}

static UNDERWAY: Mutex<Option<Underway>> = Mutex::new(None);

/// Says what runs from now on; `None` where nothing does.
pub(super) fn set(underway: Option<Underway>) {
    *UNDERWAY.lock().unwrap_or_else(PoisonError::into_inner) = underway;
}

/// Says that one more trial is done.
pub(super) fn one_more() {
    if let Some(run) = UNDERWAY.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
        run.done += 1;
    }
}

impl Underway {
    fn in_words(&self) -> String {
        let Self { name, trials, done, keeps, .. } = self;
        let all = counted(*trials, "trial");
        if *keeps {
            format!(
                "interrupted: {done} of {all} of {name} are kept; the same command goes on where it was"
            )
        } else {
            format!(
                "interrupted: none of {all} of {name} is kept without the store; the same command begins anew"
            )
        }
    }
}

/// Waits for an interrupt in a thread of its own: called by every command that runs trials and keeps them, before anything else.
pub(super) fn watch(terminal: Terminal) {
    static WATCHED: Once = Once::new();
    WATCHED.call_once(|| wait(terminal));
}

#[cfg(unix)]
fn wait(terminal: Terminal) {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;
    // Where the system refuses, an interrupt ends the process without a word.
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    let wait = move || {
        let Some(signal) = signals.forever().next() else { return };
        store::abandon(|| {
            let underway = UNDERWAY.lock().unwrap_or_else(PoisonError::into_inner).take();
            match underway {
                Some(run) => {
                    run.bar.finish_and_clear();
                    terminal.note(&run.in_words());
                }
                // Between two runs: while a manifest is read, or what was run is sealed.
                None => {
                    terminal.note("interrupted: the same command goes on with what the store has");
                }
            }
            let _ = emulate_default_handler(signal);
        });
    };
    let _ = std::thread::Builder::new().name("interrupts".to_owned()).spawn(wait);
}

/// Does nothing: other systems end the process themselves, and a later run sweeps up what it was writing.
#[cfg(not(unix))]
fn wait(_: Terminal) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interrupted_run_says_how_to_go_on() {
        let run = Underway {
            name: "tiny".into(),
            trials: 40,
            done: 3,
            keeps: true,
            bar: ProgressBar::hidden(),
        };
        assert_eq!(
            run.in_words(),
            "interrupted: 3 of 40 trials of tiny are kept; the same command goes on where it was"
        );
        assert_eq!(
            Underway { keeps: false, ..run }.in_words(),
            "interrupted: none of 40 trials of tiny is kept without the store; the same command begins anew"
        );
    }
}
