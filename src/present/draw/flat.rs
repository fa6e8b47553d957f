//! Discs as they are; spheres as circles in the plane of a slice.

use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use crate::scene::{AnyScene, Real, array};
use crate::with_scene;

/// A plane across one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// 0, 1 or 2: the axis that the plane cuts.
    pub axis: usize,
    /// Where.
    pub at: f64,
}

impl Slice {
    /// Through both particles of a pair, where one plane meets both: across the axis along which
    /// they are nearest, by their radii.
    pub fn through(scene: &AnyScene<'_>, [i, j]: [u32; 2]) -> Slice {
        with_scene!(scene, scene => {
            let body = |k: u32| {
                let centre = array(&scene.centres()[k as usize]).map(Real::wide).to_vec();
                (centre, scene.radius(k as usize).wide())
            };
            let ((a, ra), (b, rb)) = (body(i), body(j));
            let apart = |axis: usize| (a[axis] - b[axis]).abs();
            let axes = (0..a.len()).rev();
            let axis = axes.min_by(|&k, &l| apart(k).total_cmp(&apart(l))).unwrap_or(0);
            let part = if ra + rb > 0.0 { ra / (ra + rb) } else { 0.5 };
            Slice { axis, at: a[axis] * (1.0 - part) + b[axis] * part }
        })
    }
}

impl Slice {
    /// How far the particles reach along the axis that it cuts.
    pub fn range(&self, scene: &AnyScene<'_>) -> [f64; 2] {
        with_scene!(scene, scene => {
            let ends = scene.centres().iter().enumerate().map(|(k, point)| {
                let (x, r) = (array(point)[self.axis].wide(), scene.radius(k).wide());
                [x - r, x + r]
            });
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [from, to]| {
                [low.min(from), high.max(to)]
            })
        })
    }
}

impl FromStr for Slice {
    type Err = anyhow::Error;

    /// As on the command line: `z=0.5`.
    fn from_str(text: &str) -> anyhow::Result<Slice> {
        let (name, at) = text
            .split_once('=')
            .with_context(|| format!("'{text}' is not a slice; write axis=place, as in z=0.5"))?;
        let axis = match name.trim() {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            other => bail!("'{text}': the axis is '{other}'; it must be x, y or z, as in z=0.5"),
        };
        let at: f64 = at
            .trim()
            .parse()
            .ok()
            .with_context(|| format!("'{text}': '{at}' is not a number; write z=0.5"))?;
        ensure!(at.is_finite(), "'{text}': {at} is not a finite number; write z=0.5");
        Ok(Slice { axis, at })
    }
}

/// A circle to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The number of its particle.
    pub id: u32,
    /// The centre.
    pub at: [f64; 2],
    /// The radius in the plane.
    pub r: f64,
}

/// What lies in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    /// In order of the particles.
    pub circles: Vec<Circle>,
    /// For spheres: the slice.
    pub slice: Option<Slice>,
    /// The axes of the plane.
    pub axes: [usize; 2],
    /// Coordinates are those of the scene times this power of two, so that no difference overflows,
    /// and none vanishes.
    pub factor: f64,
    /// For every particle the place of its circle; `u32::MAX` if it has none.
    places: Vec<u32>,
}

impl Flat {
    /// All discs, or the spheres that meet the slice. If none is given, it goes through the middle
    /// of the first `count` particles.
    pub fn new(scene: &AnyScene<'_>, slice: Option<Slice>, count: usize) -> Flat {
        with_scene!(scene, scene => {
            let centre = |k: usize| array(&scene.centres()[k]).map(Real::wide).to_vec();
            let particles = (0..scene.len()).map(|k| (centre(k), scene.radius(k).wide()));
            Flat::cut(particles.collect(), slice, count)
        })
    }

    fn cut(particles: Vec<(Vec<f64>, f64)>, slice: Option<Slice>, count: usize) -> Flat {
        let largest = particles
            .iter()
            .flat_map(|(centre, r)| centre.iter().chain(std::iter::once(r)))
            .fold(0.0f64, |most, x| most.max(x.abs()));
        let factor = if largest > 1e300 {
            2f64.powi(-30)
        } else if largest > 0.0 && largest < 1e-290 {
            2f64.powi(300)
        } else {
            1.0
        };
        let space = particles.first().is_some_and(|(centre, _)| centre.len() == 3);
        let slice = space.then(|| {
            slice.unwrap_or_else(|| Slice {
                axis: 2,
                at: middle(particles.iter().take(count).map(|(centre, _)| centre[2])),
            })
        });
        let axes = match slice.map(|slice| slice.axis) {
            Some(0) => [1, 2],
            Some(1) => [0, 2],
            _ => [0, 1],
        };
        let (mut circles, mut places) = (Vec::new(), vec![u32::MAX; particles.len()]);
        for (k, (centre, r)) in particles.iter().enumerate() {
            let r = r * factor;
            let away = slice.map_or(0.0, |slice| centre[slice.axis] * factor - slice.at * factor);
            if away.abs() <= r {
                places[k] = circles.len() as u32;
                // (r - away)(r + away) loses no digits, and the root of each factor does not
                // overflow.
                let r = (r - away).sqrt() * (r + away).sqrt();
                circles.push(Circle {
                    id: k as u32,
                    at: axes.map(|axis| centre[axis] * factor),
                    r,
                });
            }
        }
        Flat { circles, slice, axes, factor, places }
    }

    /// The place of a particle's circle, if it has one.
    pub fn place(&self, particle: u32) -> Option<usize> {
        let place = *self.places.get(particle as usize)? as usize;
        (place < self.circles.len()).then_some(place)
    }

    /// The circle of a particle, if it has one.
    pub fn circle(&self, particle: u32) -> Option<&Circle> {
        self.circles.get(self.place(particle)?)
    }

    /// Leaves the neighbourhood of a pair; all circles where one of the two has none.
    pub fn zoom(&mut self, [i, j]: [u32; 2]) {
        let (Some(a), Some(b)) = (self.circle(i), self.circle(j)) else { return };
        let apart = [0, 1].map(|k| (a.at[k] - b.at[k]).abs());
        let reach = 3.0 * a.r.max(b.r) + apart[0].max(apart[1]);
        let middle = [0, 1].map(|k| 0.5 * a.at[k] + 0.5 * b.at[k]);
        self.circles.retain(|circle| {
            circle.id == i
                || circle.id == j
                || (0..2).all(|k| (circle.at[k] - middle[k]).abs() <= reach)
        });
        self.places.fill(u32::MAX);
        for (place, circle) in self.circles.iter().enumerate() {
            self.places[circle.id as usize] = place as u32;
        }
    }

    /// The box around all circles.
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for circle in &self.circles {
            for k in 0..2 {
                low[k] = low[k].min(circle.at[k] - circle.r);
                high[k] = high[k].max(circle.at[k] + circle.r);
            }
        }
        (!self.circles.is_empty()).then_some([low, high])
    }
}

fn middle(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let (low, high) =
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
    0.5 * low + 0.5 * high
}

#[cfg(test)]
mod tests {
    use nalgebra::Point;

    use super::*;
    use crate::scene::{Radii, Scene};

    fn spheres(centres: &[[f64; 3]], r: f64) -> AnyScene<'static> {
        Scene::new(centres.iter().copied().map(Point::from).collect::<Vec<_>>(), Radii::Uniform(r))
            .unwrap()
            .into()
    }

    #[test]
    fn a_slice_cuts_spheres_into_circles() {
        let scene =
            spheres(&[[0.0, 0.0, 0.0], [10.0, 5.0, 3.0], [20.0, 7.0, 5.5], [30.0, 0.0, 8.0]], 5.0);
        let flat = Flat::new(&scene, Some("z = 0".parse().unwrap()), usize::MAX);
        let found: Vec<_> = flat.circles.iter().map(|c| (c.id, c.at)).collect();
        assert_eq!(found, [(0, [0.0, 0.0]), (1, [10.0, 5.0])]);
        assert!((flat.circles[0].r - 5.0).abs() < 1e-14 && (flat.circles[1].r - 4.0).abs() < 1e-14);
        assert_eq!(
            (flat.circle(1).map(|c| c.id), flat.circle(2), flat.circle(9)),
            (Some(1), None, None)
        );
        // Through the middle: z = 4.
        let ids: Vec<u32> =
            Flat::new(&scene, None, usize::MAX).circles.iter().map(|c| c.id).collect();
        assert_eq!(ids, [0, 1, 2, 3]);
        let flat = Flat::new(&scene, Some(Slice { axis: 0, at: 31.0 }), usize::MAX);
        assert_eq!((flat.axes, flat.circles[0].at), ([1, 2], [0.0, 8.0]));
        // A plane that touches a sphere meets it in a point.
        assert_eq!(
            Flat::new(&scene, Some(Slice { axis: 0, at: 35.0 }), usize::MAX).circles[0].r,
            0.0
        );
    }

    #[test]
    fn no_number_is_too_large_or_too_small() {
        for scale in [f64::MAX, 1e-310, 1e200] {
            let scene = spheres(&[[scale, -scale, 0.0], [-scale, scale, 0.0]], scale);
            let flat = Flat::new(&scene, None, usize::MAX);
            let [low, high] = flat.bounds().unwrap();
            let extent = high[0] - low[0];
            assert!(extent.is_finite() && extent > 0.0, "{scale}: {extent}");
            assert!((flat.circles[0].r / extent - 0.25).abs() < 1e-12, "{scale}");
        }
        assert_eq!(Flat::new(&spheres(&[], 1.0), None, 0).bounds(), None);
    }

    #[test]
    fn slices_are_read_or_refused() {
        assert_eq!("y=-2.5e3".parse::<Slice>().unwrap(), Slice { axis: 1, at: -2500.0 });
        for text in ["z", "w=1", "z=", "z=inf", "z=NaN", "=1"] {
            let error = text.parse::<Slice>().unwrap_err().to_string();
            assert!(error.contains(&format!("'{text}'")) && error.contains("z=0.5"), "{error}");
        }
    }
}
