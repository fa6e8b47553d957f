//! Tests drawings, traces, and pages in a browser.

mod boxes;
mod browser;
mod films;
mod layout;
mod page;
mod pages;
mod pictures;
mod traces;

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
