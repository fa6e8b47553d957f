//! Tests of all detectors of the table: in open space, in boxes and under trackers. Unit tests in
//! `src` use no detector of the table, because they would compile all detectors a second time.

mod classes;
mod hgrid;
mod particles;
mod periodic;
mod rules;
mod searcher;
mod sizes;
mod spec;
mod threads;
mod track;
mod truth;
