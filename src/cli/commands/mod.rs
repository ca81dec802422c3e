//! One file per command.

pub(super) mod attest;
pub(super) mod cache;
pub(super) mod check;
pub(super) mod completions;
pub(super) mod diff;
mod execution;
mod exhibit;
pub(super) mod export;
pub(super) mod import;
pub(super) mod infer;
pub(super) mod init;
pub(super) mod lock;
mod locked;
pub(super) mod man;
pub(super) mod plan;
mod probe;
pub(super) mod replay;
pub(super) mod report;
pub(super) mod run;
pub(super) mod schema;
pub(super) mod show;
pub(super) mod solve_cmdp;
pub(super) mod vary;
mod verdicts;
pub(super) mod verify;
