//! Progress for people: a bar where stderr is a terminal, in pipes a line now and then. For programs that ask for it
//! (`REENACT_PROGRESS=json`): a line of JSON whenever there is news.
//!
//! What matters most comes first, so that a narrow terminal cuts off what matters least.

use super::estimate::{Estimate, in_words};
use super::fold::wrapped;
use super::interrupt::{self, Underway};
use super::terminal::{Terminal, counted};
use crate::provenance::RunClock;
use crate::runner::{Observer, RunEvent};
use crate::studies::{Outcome, TrialSpec};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Least time (s) between two lines in a pipe where another tenth of the trials is done.
const SPARSE_S: f64 = 30.0;
/// Time (s) after which a line comes though it is not: silence looks like a hang to whoever reads a log.
const SILENT_S: f64 = 120.0;

/// Least time (s) between two lines for a program.
const HEARD_S: f64 = 0.1;

/// Trials done, failed and cached, time left and how much faster than real time it goes.
#[derive(Debug)]
pub(super) struct Progress {
    terminal: Terminal,
    /// What runs, where there is more than one thing.
    label: Option<String>,
    /// Whether finished trials are kept, where this is a run that one would go on with.
    keeps: Option<bool>,
    bar: ProgressBar,
    /// Condition of every trial, by number.
    conditions: Vec<usize>,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    clock: RunClock,
    estimate: Estimate,
    trials: usize,
    cached: usize,
    failed: usize,
    /// When the last line was written (s), and how many tenths were done.
    told: (f64, usize),
}

impl Progress {
    /// Creates the progress of a run of `trials`.
    pub(super) fn of(trials: &[TrialSpec], terminal: Terminal) -> Self {
        let mut seen = Vec::new();
        let number = |spec: &TrialSpec| {
            // Trials of one condition follow one another.
            if seen.last() != Some(&spec.condition) {
                seen.push(spec.condition.clone());
            }
            seen.len() - 1
        };
        Self::new(trials.iter().map(number).collect(), terminal)
    }

    /// Creates the progress of a run whose trials are known only when it begins.
    pub(super) fn unplanned(terminal: Terminal) -> Self {
        Self::new(Vec::new(), terminal)
    }

    /// Puts `label` in front of the state, to say what runs.
    #[must_use]
    pub(super) fn labelled(self, label: &str) -> Self {
        Self { label: Some(label.to_owned()), ..self }
    }

    /// Makes an interrupted run say how to go on: with the trials that are done where it `keeps` them.
    #[must_use]
    pub(super) fn interruptible(self, keeps: bool) -> Self {
        Self { keeps: Some(keeps), ..self }
    }

    fn new(conditions: Vec<usize>, terminal: Terminal) -> Self {
        let bar = if terminal.is_watched() {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
        } else {
            ProgressBar::hidden()
        };
        let template =
            if terminal.color() { "{bar:12.cyan} {wide_msg}" } else { "{bar:12} {wide_msg}" };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars(if terminal.utf8() { "━╸ " } else { "=> " }));
        }
        let state = State {
            clock: RunClock::start(),
            estimate: Estimate::default(),
            trials: 0,
            cached: 0,
            failed: 0,
            told: (0.0, 0),
        };
        Self { terminal, label: None, keeps: None, bar, conditions, state: Mutex::new(state) }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        interrupt::set(None);
        self.bar.finish_and_clear();
    }

    /// Shows the state where it is to be seen.
    fn tell(&self, state: &mut State) {
        let elapsed = state.clock.elapsed_seconds();
        if self.terminal.is_watched() {
            let message = match &self.label {
                Some(label) => format!("{label}: {}", state.in_words(elapsed)),
                None => state.in_words(elapsed),
            };
            self.bar.set_message(message);
            return;
        }
        let done = state.done();
        if self.terminal.is_heard() {
            if done == 0 || done == state.trials || elapsed - state.told.0 >= HEARD_S {
                self.terminal.note(&state.to_json(self.label.as_deref()));
                state.told = (elapsed, 0);
            }
            return;
        }
        let tenths = 10 * done / state.trials.max(1);
        let since = elapsed - state.told.0;
        let due = since >= SILENT_S || (since >= SPARSE_S && tenths > state.told.1);
        if due && done < state.trials {
            let label = self.label.as_deref().unwrap_or("running");
            self.terminal.note(&format!("{label}: {}", state.in_words(elapsed)));
            state.told = (elapsed, tenths);
        }
    }
}

impl State {
    fn done(&self) -> usize {
        self.trials - self.estimate.left()
    }

    /// Tells a program how far it is ([docs/answers.md](../../docs/answers.md)).
    fn to_json(&self, label: Option<&str>) -> String {
        let Self { trials, cached, failed, .. } = self;
        json!({"progress": {
            "name": label, "trials": trials, "done": self.done(), "cached": cached, "failed": failed,
        }})
        .to_string()
    }

    fn in_words(&self, elapsed: f64) -> String {
        let mut words = vec![format!("{}/{} trials", self.done(), self.trials)];
        if self.failed > 0 {
            words.push(format!("{} failed", self.failed));
        }
        // The first moments say little.
        if elapsed > 0.5 {
            let left = self.estimate.left_s(elapsed);
            words.extend(left.map(|seconds| format!("{} left", in_words(seconds))));
        }
        if self.cached > 0 {
            words.push(format!("{} cached", self.cached));
        }
        if elapsed > 0.5 {
            let rate = self.estimate.rate(elapsed);
            words.extend(rate.map(|rate| format!("{rate:.0}x real time")));
        }
        words.join(", ")
    }
}

impl Observer for Progress {
    fn notice(&self, event: &RunEvent<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            RunEvent::Started { trials, cached, jobs, .. } => {
                let known = self.conditions.len() == *trials;
                let conditions = if known { self.conditions.clone() } else { vec![0; *trials] };
                *state = State {
                    clock: RunClock::start(),
                    estimate: Estimate::new(conditions, *cached, *jobs),
                    trials: *trials,
                    cached: *cached,
                    failed: 0,
                    told: (0.0, 0),
                };
                if self.keeps.is_some() {
                    interrupt::watch(self.terminal);
                }
                interrupt::set(self.keeps.map(|keeps| Underway {
                    name: self.label.clone().unwrap_or_default(),
                    trials: *trials,
                    done: 0,
                    keeps,
                    bar: self.bar.clone(),
                }));
                self.bar.reset();
                self.bar.set_length(*trials as u64);
                let heading = format!(
                    "running {}, {cached} cached, on {}",
                    counted(*trials, "trial"),
                    counted(*jobs, "thread")
                );
                if self.terminal.is_watched() {
                    let heading = match &self.label {
                        Some(label) => format!("{label}: {heading}"),
                        None => heading,
                    };
                    // The bar's own printing fills the line with spaces and lets the terminal wrap it.
                    let heading = wrapped(&heading, 0, self.terminal.columns());
                    self.bar.suspend(|| self.terminal.note(&heading));
                }
                self.tell(&mut state);
            }
            RunEvent::Finished { index, record, cached } => {
                state.estimate.finished(*index, record.sim_seconds, *cached);
                if record.outcome == Outcome::PANICKED {
                    state.failed += 1;
                } else {
                    interrupt::one_more();
                }
                self.tell(&mut state);
                self.bar.set_position(state.done() as u64);
            }
        }
    }
}

/// Something under way of which nobody knows how long it takes; it is told to whoever watches, and taken away when dropped.
#[derive(Debug)]
pub(super) struct Working(ProgressBar);

impl Working {
    pub(super) fn at(what: &str, terminal: Terminal) -> Self {
        if !terminal.is_watched() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_msg}") {
            let ticks = if terminal.utf8() { "⠋⠙⠸⠴⠦⠇ " } else { "|/-\\ " };
            bar.set_style(style.tick_chars(ticks));
        }
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(bar)
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
