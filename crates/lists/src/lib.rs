//! Contacts in periodic boxes, and neighbour lists of moving particles, for the crates of
//! contactbench. Programs use `contactbench-core`.

pub mod periodic;
pub mod searcher;
pub mod track;
