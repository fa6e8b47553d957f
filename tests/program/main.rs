//! Tests of the program: verbs, files, runs, records, reports, runners, pages.

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
