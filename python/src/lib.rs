//! The extension module `reenact._reenact`: the command line, and bundles as they were checked. What is thin in Python has its
//! logic here, and what is thin here has it in the library.

mod archive;
mod interruptible;
mod replayed;

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use reenact::cli::{self, Exit, Unopened};
use std::ffi::OsString;
use std::path::PathBuf;

create_exception!(
    _reenact,
    Refused,
    PyException,
    "Why something was not done: how the command would have ended, and what it would have said."
);

/// Creates the exception of what was refused.
fn refused(unopened: Unopened) -> PyErr {
    let Unopened { exit, message } = unopened;
    Refused::new_err((exit.code(), message))
}

/// Creates the exception of a command that would have ended with `exit`, and said `message` as an error.
fn refused_with(exit: Exit, message: impl std::fmt::Display) -> PyErr {
    Refused::new_err((exit.code(), format!("error: {message}")))
}

/// Runs the command line in this process, as the program that `program` starts; returns the code to end with.
#[pyfunction]
fn main(py: Python<'_>, program: PathBuf, words: Vec<OsString>) -> u8 {
    let words = std::iter::once(OsString::from("reenact")).chain(words);
    py.detach(|| cli::run_as(program, words).code())
}

/// The extension module.
#[pymodule]
fn _reenact(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Refused", module.py().get_type::<Refused>())?;
    module.add_class::<archive::Archive>()?;
    module.add_function(wrap_pyfunction!(main, module)?)
}
