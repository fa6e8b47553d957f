//! Tests of the pages, the protocol, runners, templates and imports between crates.

mod codes;
mod help;
mod new_detector;
mod peers;
mod protocol;
mod readme;
mod satellites;
mod walls;
