//! What the program promises to its users: verbs, files, runs, records, reports, runners, pages.

mod cases;
mod check;
mod committed;
mod common;
mod files;
mod project;
mod record;
mod run;
mod seeing;
mod track;

// What the file that `new-detector` writes finds around it in the crate of detectors.
use contactbench::{contact, detect, filter, probe, scene, sink};
