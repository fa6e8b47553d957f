//! Scenes for the relations: lattices in exact touch, decimal lattices, clouds, clusters and lines,
//! in which particles are moved by a last bit, are of very different sizes, or lie far away.

use contactbench::contact::Arithmetic;
use contactbench::scene::{AnyScene, Radii, Real, Scene, array};
use contactbench::with_scene;
use nalgebra::Point;
use proptest::prelude::*;

/// Centres and radii that are changed and then made to a scene.
#[derive(Clone, Debug)]
pub struct Bag<const D: usize> {
    pub centres: Vec<[f64; D]>,
    pub radii: Size,
}

/// One radius, or one each.
#[derive(Clone, Debug)]
pub enum Size {
    One(f64),
    Each(Vec<f64>),
}

impl<const D: usize> Bag<D> {
    pub fn len(&self) -> usize {
        self.centres.len()
    }

    pub fn radius(&self, k: usize) -> f64 {
        match &self.radii {
            Size::One(r) => *r,
            Size::Each(radii) => radii[k],
        }
    }

    pub fn largest(&self) -> f64 {
        match &self.radii {
            Size::One(r) => *r,
            Size::Each(radii) => radii.iter().copied().fold(0.0, f64::max),
        }
    }

    /// The particles of these numbers, in this order.
    pub fn chosen(&self, order: &[u32]) -> Bag<D> {
        let radii = match &self.radii {
            Size::One(r) => Size::One(*r),
            Size::Each(radii) => Size::Each(order.iter().map(|&k| radii[k as usize]).collect()),
        };
        Bag { centres: order.iter().map(|&k| self.centres[k as usize]).collect(), radii }
    }

    /// Centres and radii changed, each by itself.
    pub fn map(
        &self,
        centre: impl Fn([f64; D]) -> [f64; D],
        radius: impl Fn(f64) -> f64,
    ) -> Bag<D> {
        let radii = match &self.radii {
            Size::One(r) => Size::One(radius(*r)),
            Size::Each(radii) => Size::Each(radii.iter().copied().map(radius).collect()),
        };
        Bag { centres: self.centres.iter().copied().map(centre).collect(), radii }
    }

    pub fn scene(&self) -> AnyScene<'static>
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        let radii = match &self.radii {
            Size::One(r) => Radii::Uniform(*r),
            Size::Each(radii) => Radii::Each(radii.clone().into()),
        };
        Scene::new(self.centres.iter().copied().map(Point::from).collect::<Vec<_>>(), radii)
            .unwrap()
            .into()
    }

    /// What an arithmetic keeps of the bag, in f64; by cells in units of the cell. `None` if it
    /// cannot be stored.
    pub fn kept(&self, arithmetic: Arithmetic) -> Option<Bag<D>>
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        with_scene!(self.scene().stored(arithmetic).ok()?, scene => {
            let wide = |x| Real::wide(x);
            Some(Bag {
                centres: scene.centres().iter().map(|p| std::array::from_fn(|k| wide(array(p)[k]))).collect(),
                radii: match scene.radii() {
                    Radii::Uniform(r) => Size::One(wide(*r)),
                    Radii::Each(radii) => Size::Each(radii.iter().map(|&r| wide(r)).collect()),
                },
            })
        })
    }
}

/// How the sites of particles become places.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Lattice,
    Cloud,
    Clusters,
    Line,
}

/// One particle before its place and size are known.
#[derive(Clone, Debug)]
struct Seed<const D: usize> {
    site: [i8; D],
    noise: [f64; D],
    size: f64,
    nudge: i8,
}

fn seed<const D: usize>() -> impl Strategy<Value = Seed<D>> {
    // A ratio of 1,000 at most, from the dust of 1/100 to the giants of 10.
    let size = prop_oneof![12 => Just(1.0), 2 => Just(0.5), 2 => 0.3..1.0, 2 => Just(0.01), 1 => Just(0.0), 1 => Just(10.0)];
    // Multiples of 2^-30, so that no difference is nearly nothing.
    let noise = (-(1i32 << 29)..1 << 29).prop_map(|k| f64::from(k) / f64::from(1 << 30));
    let nudge = prop_oneof![8 => Just(0i8), 1 => Just(1), 1 => Just(-1)];
    (prop::array::uniform::<_, D>(-2i8..4), prop::array::uniform::<_, D>(noise), size, nudge)
        .prop_map(|(site, noise, size, nudge)| Seed { site, noise, size, nudge })
}

/// The scenes.
pub fn bags<const D: usize>() -> impl Strategy<Value = Bag<D>> {
    let shape = prop_oneof![3 => Just(Shape::Lattice), 2 => Just(Shape::Cloud), 1 => Just(Shape::Clusters), 1 => Just(Shape::Line)];
    let spacing = prop_oneof![3 => Just(1.0), 2 => Just(0.25), 2 => Just(0.1), 1 => Just(0.3), 1 => Just(1.0 / 3.0), 1 => Just(3e3)];
    // Radii per spacing: neighbours touch, or those at 2, 3 or (3, 4), or one last bit short of it,
    // or none.
    let half = 0.5f64;
    let share = prop::sample::select(vec![
        0.5,
        0.5,
        0.5,
        1.0,
        1.5,
        2.5,
        0.7,
        0.3,
        half.next_up(),
        half.next_down(),
        0.0,
    ]);
    let offset = prop::sample::select(vec![0.0, 0.0, 0.5, -7.0, 0.1, 1e6, -1e6 / 3.0]);
    let far = prop::sample::select(vec![0.0, 0.0, 0.0, 0.0, 300.0, 3e4, 1e12]);
    let particles = prop_oneof![1 => prop::collection::vec(seed::<D>(), 0..4), 6 => prop::collection::vec(seed::<D>(), 4..60)];
    (shape, spacing, share, offset, any::<bool>(), far, particles).prop_map(
        |(shape, spacing, share, offset, mixed, far, particles)| {
            let place = |seed: &Seed<D>| -> [f64; D] {
                std::array::from_fn(|k| {
                    let (site, noise) = (f64::from(seed.site[k]), seed.noise[k]);
                    let x = match shape {
                        Shape::Lattice => site,
                        Shape::Cloud => site + noise,
                        Shape::Clusters => (site / 3.0).floor() * 16.0 + noise,
                        Shape::Line => 4.0 * if k == 0 { site + noise } else { 0.0 },
                    };
                    nudged((x + offset) * spacing, seed.nudge)
                })
            };
            let mut centres: Vec<[f64; D]> = particles.iter().map(place).collect();
            if let (Some(last), true) = (centres.last_mut(), far > 0.0) {
                last[D - 1] = far * spacing;
            }
            let r = share * spacing;
            let radii = if mixed {
                Size::Each(particles.iter().map(|seed| seed.size * r).collect())
            } else {
                Size::One(r)
            };
            Bag { centres, radii }
        },
    )
}

/// The next number up or down; of zero, the other zero.
fn nudged(x: f64, nudge: i8) -> f64 {
    match nudge {
        0 => x,
        _ if x == 0.0 => -x,
        1 => x.next_up(),
        _ => x.next_down(),
    }
}
