//! The scenes of the book's worked examples (Munjiza 2004, sections 3.6 to 3.8).
//!
//! The book gives the cells of its particles, not their centres. Here, centres are chosen in the
//! same cells of a 10 x 10 grid with edge 10 (or a little more, see
//! [`contactbench_ground::filter::cells`]) and a radius of 5. Some particles touch; particles 4 and
//! 10 of the ten touch exactly.

use crate::trace::Algorithm;
use contactbench_ground::scene::{AnyScene, Scene};

pub struct Example {
    pub name: &'static str,
    centres: &'static [(f64, f64)],
    /// Offset from this program's cell numbers, which begin at the lowest centre, to the book's.
    pub shift: [u32; 2],
}

/// The ten particles of NBS, p103-110. The book does not show the column of particle 9.
#[rustfmt::skip]
const TEN: [(f64, f64); 10] = [
    (32.0, 68.0), (41.0, 74.0), (31.0, 56.0), (46.0, 67.0), (36.0, 40.0),
    (45.0, 57.0), (20.0, 63.0), (53.0, 52.0), (84.0, 55.0), (38.0, 61.0),
];

/// The nine particles of screening, p90-91.
#[rustfmt::skip]
const NINE: [(f64, f64); 9] = [
    (42.0, 62.0), (48.0, 69.0), (10.0, 62.0), (41.0, 69.0), (16.0, 69.0),
    (46.0, 54.0), (18.0, 61.0), (54.0, 50.0), (11.0, 68.0),
];

pub fn example(algorithm: Algorithm) -> Example {
    let (name, centres, shift) = match algorithm {
        Algorithm::Nbs | Algorithm::BinaryTree => ("the book's ten particles", &TEN[..], [2, 4]),
        Algorithm::Screening => ("the book's nine particles", &NINE[..], [1, 5]),
        Algorithm::Sorting => ("the book's eight particles", &TEN[..8], [2, 4]),
    };
    Example { name, centres, shift }
}

impl Example {
    pub fn scene(&self) -> AnyScene<'static> {
        let rows = self.centres.iter().map(|&(x, y)| [x, y]);
        // This cannot fail, because centres are finite and radii positive.
        let scene = Scene::at(rows, 5.0).or_else(|_| Scene::<f64, 2>::at([], 5.0));
        scene.map_or_else(|error| unreachable!("an empty scene is valid: {error}"), AnyScene::from)
    }
}
