//! Work that Ctrl-C is not kept waiting by.

use crate::refused_with;
use pyo3::prelude::*;
use reenact::cli::Exit;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How often Python is asked whether a signal came.
const HEED: Duration = Duration::from_millis(50);

/// As much as a process's first thread has: what the command does there is done here.
const STACK: usize = 8 << 20;

/// Does `work` in a thread of its own while Python heeds signals. Where one raises an exception (`KeyboardInterrupt`) that is
/// the answer, and the work goes on unheard until it is done: it only makes a value.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (say, hear) = channel();
    let worker = thread::Builder::new().stack_size(STACK).spawn(move || {
        // Nobody hears it after an interrupt.
        let _ = say.send(work());
    });
    worker.map_err(|problem| {
        refused_with(Exit::Failed, format!("cannot start a thread: {problem}"))
    })?;
    // A receiver is for one thread; whoever waits without the interpreter must be allowed to be another.
    let hear = std::sync::Mutex::new(hear);
    loop {
        let heard = py.detach(|| match hear.lock() {
            Ok(hear) => hear.recv_timeout(HEED),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match heard {
            Ok(value) => return Ok(value),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                let bug = "this is a bug in reenact: please report it with the lines above";
                return Err(refused_with(Exit::Failed, bug));
            }
        }
    }
}
