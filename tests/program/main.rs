//! What the program promises to its users: verbs, files, runs, records, reports, runners, pages.

mod arrays;
mod boxes;
mod browser;
mod check_finds;
mod cli;
mod codes;
mod committed;
mod common;
mod compare;
mod doubts;
mod errors;
mod files_cli;
mod frames;
mod habits;
mod harness;
mod hidden;
mod hostile;
mod integrity;
mod layout;
mod limits;
mod maps;
mod names;
mod new_detector;
mod origins;
mod page;
mod partial;
mod peers;
mod protocol;
mod readme;
mod real_data;
mod records;
mod resume;
mod runners;
mod satellites;
mod seeing;
mod slips;
mod track;
mod users;
mod walls;

// What the file that `new-detector` writes finds around it in the crate of detectors.
use contactbench::{contact, detect, filter, probe, scene, sink};
