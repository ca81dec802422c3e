//! The tests of the whole program, in one binary: each of them would else link the whole crate once more.
//!
//! One module a subject; `cargo test --test integration SUBJECT::` runs one. [`sandbox`] runs the program for all of them.

mod adversary;
mod architecture;
mod claims;
mod classes;
mod cli;
mod derived_inputs;
mod determinism;
mod documentation;
mod draws;
mod drift;
mod engines;
mod faults;
mod foreign;
mod hand_drawn;
mod hostile;
mod inference;
mod inference_from_trials;
mod interrupted;
mod large;
mod maneuvers;
mod manifests;
mod multiverse;
mod original_worlds;
mod own_worlds;
mod page;
mod robots;
mod sandbox;
mod schemas;
mod shards;
mod shared_store;
mod standards;
mod tutorial;
mod verification;
mod worlds;
