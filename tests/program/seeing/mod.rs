//! Tests drawings, traces, and pages in a browser.

mod boxes;
mod browser;
mod films;
mod layout;
mod page;
mod pages;
mod pictures;
mod traces;

use contactbench::contact::Arithmetic;
use contactbench::detect::{Options, table};
use contactbench::probe::Tally;
use contactbench::scene::spec::Spec;
use contactbench::scene::{AnyScene, Radii, Scene};
use contactbench::views::trace::Algorithm;

const ALL: [Algorithm; 4] =
    [Algorithm::Nbs, Algorithm::Sorting, Algorithm::Screening, Algorithm::BinaryTree];

fn scene(text: &str) -> AnyScene<'static> {
    Spec::parse(text).and_then(|spec| spec.make()).unwrap()
}

fn discs(centres: &[[f64; 2]], r: f64) -> AnyScene<'static> {
    let centres: Vec<_> = centres.iter().copied().map(nalgebra::Point::from).collect();
    Scene::new(centres, Radii::Uniform(r)).unwrap().into()
}

/// Returns the operation counts and contacts of a detector that counts.
fn counted(name: &str, scene: &AnyScene<'_>) -> (Tally, Vec<[u32; 2]>) {
    let (mut tally, mut pairs) = (Tally::default(), Vec::new());
    let mut detector = table::find(name).unwrap().make(Options::default());
    detector.count(scene, Arithmetic::Exact.test(), &mut tally, &mut pairs).unwrap();
    (tally, pairs)
}
