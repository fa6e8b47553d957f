//! Tests of all detectors of the table: answers, the book's counts, exactness, relations between
//! answers, and regressions.

mod agreement;
mod counts;
mod exactness;
mod fuzz;
mod limits;
mod metamorphic;
mod near_tangent;
mod regressions;
mod streamed;
mod tracking;

use contactbench::scene::AnyScene;
use contactbench::scene::spec::Spec;

fn make(text: &str) -> AnyScene<'static> {
    Spec::parse(text).and_then(|spec| spec.make()).unwrap()
}
