//! What detectors are held to, all of the table in every test: the truth, the book's counts,
//! exactness, relations between answers, scenes that were got wrong, and mutants that must be
//! found.

mod agreement;
mod counts;
mod exactness;
mod fuzz;
mod limits;
mod metamorphic;
mod moving;
mod mutants;
mod near_tangent;
mod regressions;
mod streamed;
