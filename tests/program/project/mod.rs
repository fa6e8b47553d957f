//! Tests of the project's pages, protocol, runners and templates, and of the walls between crates.

mod codes;
mod help;
mod new_detector;
mod protocol;
mod readme;
mod runners;
mod satellites;
mod walls;
