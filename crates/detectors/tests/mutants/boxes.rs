//! Mutants in periodic boxes: a small reference that wraps particles and tests all images is made
//! wrong in one way at a time. The hard cases of boxes must find each mutant.

use contactbench_detectors::oracle::boxes;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::contact::image::{Shift, compare};
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice, Scene, array};
use contactbench_scenes::hard::{Case, cases};
use rayon::prelude::*;

ways! {
    // Mistakes in making images.
    /// Makes no images: the box is ignored.
    Open,
    /// Makes images along open vectors, too.
    RepeatsWhereOpen,
    /// Makes images through one face, but not through edges and corners.
    FacesOnly,
    /// Makes all images except those through all faces at once.
    NoCorners,
    /// Makes one image on each side along each vector, however small the box.
    NextOnly,
    /// Makes only the nearest image of each pair, found by rounded fractions.
    MinimumImage,
    /// Makes images within reach by the lengths of edges instead of the distances of faces.
    ByEdges,
    /// Makes images without the tilt of the box.
    IgnoresTilt,
    /// Makes images with the absolute value of the tilt.
    TiltWithoutSign,

    // Mistakes in wrapping particles.
    /// Particles are not wrapped.
    NotWrapped,
    /// Particles are wrapped by one vector at most.
    WrappedOnce,
    /// Particles that round to the upper face are lost.
    LosesUpperFace,

    // Mistakes in choosing pairs to test.
    /// No particle is tested with its own images.
    NoSelf,
    /// For two different particles, only half of the images are tested.
    HalfForOrdered,
    /// Each pair has only one contact.
    OncePerPair,

    // Mistakes in reporting pairs.
    /// Contacts through a face are reported from both sides.
    BothSides,
    /// Images are reported with the opposite sign.
    Reversed,
    /// Reported images are those of the wrapped particles instead of the given ones.
    NamedAsWrapped,
    /// Reported images are those of the same lattice with another tilt.
    NamedAsReduced,

    /// Rounds the coordinates of images to f64.
    RoundedPlaces,
    StrictThroughFaces,
    ;

    // Changes that look wrong but are not.
    Images,
    /// Makes one more image on each side.
    OneMore,
    /// The box begins at another corner.
    OtherCorner,
}

/// Search of one scene by the reference detector.
struct Search<'a, const D: usize> {
    way: Way,
    scene: &'a Scene<'a, f64, D>,
    /// Lattice of the scene, after a change by the mutant.
    lattice: Lattice,
    vectors: [[f64; D]; 3],
    found: Vec<ImagePair>,
}

/// Position of a wrapped particle, and its shift in numbers of box vectors.
type Wrapped = ([f64; 3], [i32; 3]);

impl<'a, const D: usize> Search<'a, D> {
    fn new(way: Way, scene: &'a Scene<'a, f64, D>, lattice: &Lattice) -> Search<'a, D> {
        let (mut vectors, mut repeats) = (*lattice.vectors(), lattice.periodic());
        let mut origin = lattice.origin();
        for (v, k) in [(1, 0), (2, 0), (2, 1)] {
            match way {
                Way::IgnoresTilt => vectors[v][k] = 0.0,
                Way::TiltWithoutSign => vectors[v][k] = vectors[v][k].abs(),
                Way::NamedAsReduced => {
                    let times = (vectors[v][k] / vectors[k][k]).round();
                    let whole = vectors[k].map(|x| times * x);
                    (0..3).for_each(|k| vectors[v][k] -= whole[k]);
                }
                _ => {}
            }
        }
        match way {
            Way::Open => repeats = [false; 3],
            Way::RepeatsWhereOpen => repeats = [true, true, D == 3],
            Way::OtherCorner => (0..3).for_each(|k| origin[k] -= 0.625 * vectors[k][k]),
            _ => {}
        }
        // The given lattice is used if the change makes the box invalid.
        let lattice = Lattice::new(vectors, repeats, origin).unwrap_or(*lattice);
        let row = |v: usize| match lattice.periodic()[v] {
            true => std::array::from_fn(|k| lattice.vectors()[v][k]),
            false => [0.0; D],
        };
        Search { way, scene, lattice, vectors: std::array::from_fn(row), found: Vec::new() }
    }

    fn fraction(&self, v: usize, x: [f64; 3]) -> f64 {
        let dual = self.lattice.dual(v);
        (0..D).map(|k| dual[k] * x[k]).sum()
    }

    /// Wraps a particle; returns `None` if the mutant loses it.
    fn wrap(&self, i: usize) -> Option<Wrapped> {
        let given = array(&self.scene.centres()[i]);
        let from_corner = |x: &[f64; D]| {
            let mut from = [0.0; 3];
            (0..D).for_each(|k| from[k] = x[k] - self.lattice.origin()[k]);
            from
        };
        let mut by = [0; 3];
        for v in (0..3).filter(|&v| self.lattice.periodic()[v] && self.way != Way::NotWrapped) {
            let boxes = self.fraction(v, from_corner(given)).floor();
            by[v] =
                -if self.way == Way::WrappedOnce { boxes.clamp(-1.0, 1.0) } else { boxes } as i32;
        }
        let place = self.place(given, by);
        let mut wrapped = [0.0; 3];
        wrapped[..D].copy_from_slice(&place);
        let above =
            |v: usize| self.lattice.periodic()[v] && self.fraction(v, from_corner(&place)) >= 1.0;
        let lost = self.way == Way::LosesUpperFace && by != [0; 3] && (0..3).any(above);
        (!lost).then_some((wrapped, by))
    }

    fn place(&self, x: &[f64; D], by: [i32; 3]) -> [f64; D] {
        std::array::from_fn(|k| {
            (0..3).fold(x[k], |x, v| f64::from(by[v]).mul_add(self.vectors[v][k], x))
        })
    }

    /// Returns the largest number of an image along vector `v`; the smallest is its negative.
    fn most(&self, v: usize) -> i32 {
        let reach = 2.0 * self.scene.largest_radius();
        let length = |v: usize| self.vectors[v].iter().map(|x| x * x).sum::<f64>().sqrt();
        match self.way {
            _ if !self.lattice.periodic()[v] => 0,
            Way::NextOnly => 1,
            Way::ByEdges => (reach / length(v) + 1.0) as i32,
            // Wrapped fractions of two particles differ by at most 1, apart from rounding.
            way => {
                let beyond = reach / self.lattice.height(v) + 1.0 + 1e-9;
                beyond as i32 + i32::from(way == Way::OneMore)
            }
        }
    }

    fn run(mut self) -> Vec<ImagePair> {
        let wrapped: Vec<_> = (0..self.scene.len()).map(|i| self.wrap(i)).collect();
        let [x, y, z] = std::array::from_fn(|v| self.most(v));
        for (i, j) in (0..wrapped.len()).flat_map(|i| (i..wrapped.len()).map(move |j| (i, j))) {
            let (Some(a), Some(b)) = (wrapped[i], wrapped[j]) else { continue };
            for image in (-x..=x).flat_map(|a| (-y..=y).map(move |b| [a, b])) {
                for z in -z..=z {
                    self.test([i, j], [a, b], [image[0], image[1], z]);
                }
            }
        }
        if self.way == Way::OncePerPair {
            self.found.dedup_by_key(|pair| (pair.i, pair.j));
        }
        self.found
    }

    /// Returns whether particle `i` is tested against this image of particle `j`.
    fn tried(&self, [i, j]: [usize; 2], [a, b]: [Wrapped; 2], image: [i32; 3]) -> bool {
        let shifted = image.iter().filter(|&&number| number != 0).count();
        let nearest = |v: usize| match self.lattice.periodic()[v] {
            true => (self.fraction(v, a.0) - self.fraction(v, b.0)).round() as i32,
            false => 0,
        };
        (i < j || image > [0; 3])
            && match self.way {
                Way::FacesOnly => shifted < 2,
                Way::NoCorners => shifted < D,
                Way::MinimumImage => i < j && (0..3).all(|v| image[v] == nearest(v)),
                Way::NoSelf => i < j,
                Way::HalfForOrdered => image >= [0; 3],
                _ => true,
            }
    }

    fn test(&mut self, [i, j]: [usize; 2], [a, b]: [Wrapped; 2], image: [i32; 3]) {
        let (r, s) = (self.scene.radius(i), self.scene.radius(j));
        let there = self.place(&std::array::from_fn(|k| b.0[k]), image);
        // Rejects distant pairs quickly, with a wide margin.
        let apart = |k: usize| {
            (a.0[k] - there[k]).abs() > 2.0 * (r + s) + 1e-9 * (a.0[k].abs() + there[k].abs())
        };
        if (0..D).any(apart) || !self.tried([i, j], [a, b], image) {
            return;
        }
        let as_given = std::array::from_fn(|v| image[v] - a.1[v] + b.1[v]);
        let [p, q] = [i, j].map(|k| array(&self.scene.centres()[k]));
        let shift = Shift { image: as_given, vectors: &self.vectors };
        let touches = match self.way {
            Way::RoundedPlaces => {
                let square = |k: usize| (a.0[k] - there[k]) * (a.0[k] - there[k]);
                (0..D).map(square).sum::<f64>() <= (r + s) * (r + s)
            }
            Way::StrictThroughFaces if image != [0; 3] => compare(p, q, r, s, shift).is_lt(),
            _ => compare(p, q, r, s, shift).is_le(),
        };
        if touches {
            let pair = |image| ImagePair::new(i as u32, j as u32, image);
            self.found.push(pair(match self.way {
                Way::NamedAsWrapped => image,
                Way::Reversed => as_given.map(|number| -number),
                _ => as_given,
            }));
            if self.way == Way::BothSides && image != [0; 3] {
                self.found.push(pair(as_given));
            }
        }
    }
}

/// Returns the hard cases in boxes, with the truth of their last step.
fn trials() -> Vec<(&'static str, Periodic<'static>, Vec<ImagePair>)> {
    let mut trials = Vec::new();
    for case in cases().filter(|case: &&Case| case.group == "boxes") {
        for &dim in case.dims {
            let steps = case.steps(dim).unwrap();
            let periodic = steps[steps.len() - 1].periodic().unwrap().unwrap();
            let truth = boxes::truth(&periodic, Arithmetic::Exact, 1 << 28).unwrap();
            trials.push((case.name, periodic, truth.pairs));
        }
    }
    trials
}

fn is_right(way: Way, periodic: &Periodic<'_>, truth: &[ImagePair]) -> bool {
    let mut found = match periodic.scene() {
        AnyScene::Plane(scene) => Search::new(way, &scene.widened(), periodic.lattice()).run(),
        AnyScene::Space(scene) => Search::new(way, &scene.widened(), periodic.lattice()).run(),
    };
    found.sort_unstable();
    found == truth
}

#[test]
fn the_boxes_of_the_catalogue_find_out_every_mutant() {
    let trials = trials();
    println!("| mutant in boxes | cases | found out by |\n|---|---:|---|");
    let found_out = |&way: &Way| {
        let wrong = trials.iter().filter(|(_, periodic, truth)| !is_right(way, periodic, truth));
        let mut names: Vec<_> = wrong.map(|(name, ..)| *name).collect();
        names.dedup();
        (way, names)
    };
    let ways: Vec<(Way, Vec<&str>)> = mutants().par_iter().map(found_out).collect();
    for (way, names) in ways {
        let shown = names[..names.len().min(3)].join(", ");
        println!("| {way:?} | {} | {shown} |", names.len());
        assert!(!names.is_empty(), "no hard case finds out {way:?}: a case is missing");
    }
}

#[test]
fn the_boxes_of_the_catalogue_find_no_fault_with_what_is_right() {
    trials().par_iter().for_each(|(name, periodic, truth)| {
        for way in right() {
            assert!(is_right(way, periodic, truth), "{way:?} on {name}: {periodic:?}");
        }
    });
}
