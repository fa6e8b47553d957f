//! Tests drawings, traces, and pages in a browser.

mod boxes;
mod browser;
mod page;
mod pages;
mod pictures;
mod site;
mod traces;

use contactbench::scene::AnyScene;
use contactbench::scene::spec::Spec;
use contactbench::views::trace::Algorithm;

const ALL: [Algorithm; 4] =
    [Algorithm::Nbs, Algorithm::Sorting, Algorithm::Screening, Algorithm::BinaryTree];

fn scene(text: &str) -> AnyScene<'static> {
    Spec::parse(text).and_then(|spec| spec.make()).unwrap()
}

fn discs(centres: &[[f64; 2]], r: f64) -> AnyScene<'static> {
    AnyScene::at(centres.iter().copied(), r).unwrap()
}
