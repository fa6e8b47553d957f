//! Tests of all detectors of the table: answers, the book's counts, exactness, relations between
//! answers, regressions, and mutants that must be found.

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
