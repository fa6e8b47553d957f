//! Particles while they are read. Memory grows with the bytes of the file, whatever number its
//! header announces.

mod given;
mod ids;
pub mod sizes;

use anyhow::{Context, bail, ensure};
use nalgebra::Point;

use crate::boxes::along;
use crate::columns::shapes::Clump;
use crate::columns::without::Groups;
use crate::raw::lines::{listed, short};
use crate::raw::room::{numbered, room, room_for};
use crate::types::{About, Notice, RadiusSource, assumed};
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Scene};
pub use given::Given;

#[derive(Debug, PartialEq)]
pub enum Centres {
    Plane(Vec<Point<f64, 2>>),
    Space(Vec<Point<f64, 3>>),
}

impl Default for Centres {
    fn default() -> Centres {
        Centres::Space(Vec::new())
    }
}

macro_rules! with_points {
    ($centres:expr, $points:ident => $body:expr) => {
        match $centres {
            $crate::particles::Centres::Plane($points) => $body,
            $crate::particles::Centres::Space($points) => $body,
        }
    };
}
pub(crate) use with_points;

fn point<const D: usize>(row: &[f64]) -> Point<f64, D> {
    Point::from(std::array::from_fn(|k| row[k]))
}

#[derive(Debug, Default, PartialEq)]
pub struct Particles {
    pub centres: Centres,
    pub radii: Option<Vec<f64>>,
    /// The file's own numbers of the particles, if it has them and the options ask for them.
    pub ids: Option<Vec<i64>>,
    pub groups: Option<Groups>,
    pub(crate) clump: Option<Clump>,
    /// The periodic box; `None` in open space.
    pub lattice: Option<Lattice>,
    /// Whether the file has a box, periodic or not.
    pub has_box: bool,
    pub notices: Vec<Notice>,
    /// Names of unused columns or arrays, for the message about missing radii.
    pub(crate) unused: Vec<String>,
    pub source: Option<RadiusSource>,
    /// Index in the file of the first particle, if only a part was read.
    pub first: Option<u64>,
}

/// Particles, and what is known about their file.
pub type Loaded = (Particles, About);

impl Particles {
    pub fn new(dim: usize, has_radii: bool) -> Particles {
        let centres = if dim == 2 { Centres::Plane(Vec::new()) } else { Centres::default() };
        Particles { centres, radii: has_radii.then(Vec::new), ..Particles::default() }
    }

    pub fn len(&self) -> usize {
        with_points!(&self.centres, points => points.len())
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn dim(&self) -> usize {
        if matches!(self.centres, Centres::Plane(_)) { 2 } else { 3 }
    }

    pub fn has_radii(&self) -> bool {
        self.radii.is_some()
    }

    pub fn is_flat(&self) -> bool {
        matches!(&self.centres, Centres::Space(points)
            if points.len() > 1 && points.iter().all(|point| point[2] == 0.0))
    }

    /// Coordinates of particle `k`; z is 0 for discs.
    pub fn centre(&self, k: usize) -> [f64; 3] {
        let mut centre = [0.0; 3];
        with_points!(&self.centres, points => {
            centre.iter_mut().zip(points[k].iter()).for_each(|(to, x)| *to = *x);
        });
        centre
    }

    /// Sets a coordinate of particle `k`; z of a disc is ignored.
    pub fn set(&mut self, k: usize, axis: usize, x: f64) {
        with_points!(&mut self.centres, points => {
            points[k].iter_mut().skip(axis).take(1).for_each(|to| *to = x);
        });
    }

    pub fn push(&mut self, place: [f64; 3], radius: f64, id: i64) -> anyhow::Result<()> {
        numbered(self.len() as u64 + 1, "particles")?;
        with_points!(&mut self.centres, points => {
            room(points)?;
            points.push(point(&place));
        });
        if let Some(radii) = &mut self.radii {
            room(radii)?;
            radii.push(radius);
        }
        if let Some(ids) = &mut self.ids {
            room(ids)?;
            ids.push(id);
        }
        Ok(())
    }

    pub fn extend(&mut self, numbers: &[f64], columns: usize) -> anyhow::Result<()> {
        let (rows, dim) = (numbers.chunks_exact(columns), self.dim());
        with_points!(&mut self.centres, points => {
            room_for(points, rows.len())?;
            points.extend(rows.clone().map(point));
        });
        if let Some(radii) = &mut self.radii {
            room_for(radii, rows.len())?;
            radii.extend(rows.map(|row| row[dim]));
        }
        Ok(())
    }

    /// Takes the given radius instead of the file's, whose source becomes [`RadiusSource::Given`].
    pub(crate) fn take_radius(&mut self, given: f64, source: &mut RadiusSource) {
        if self.radii.take().is_some() {
            let label = match source {
                RadiusSource::Column(label) | RadiusSource::Halved(label) => label.as_str(),
                RadiusSource::Given | RadiusSource::Missing => "the last column",
            };
            self.notices.push(unused_sizes(label, given));
        }
        *source = RadiusSource::Given;
    }

    /// Makes discs of spheres with z = 0, if `dim` is 2. Other changes of the dimension are
    /// refused.
    pub(crate) fn in_dim(&mut self, dim: Option<u32>) -> anyhow::Result<()> {
        let fits = dim != Some(3) || self.dim() == 3;
        ensure!(fits, "the points have x and y only, and cannot be read as 3D: add a column z");
        if let (Some(2), Centres::Space(points)) = (dim, &mut self.centres) {
            if let Some(k) = points.iter().position(|point| point[2] != 0.0) {
                bail!("particle {k} has z = {}; discs must have z = 0", points[k][2]);
            }
            let points = std::mem::take(points).into_iter();
            self.centres = Centres::Plane(points.map(|p| Point::from([p[0], p[1]])).collect());
        }
        Ok(())
    }

    pub fn scene(self, name: &str, radius: Option<f64>) -> anyhow::Result<AnyScene<'static>> {
        if let Some(lattice) = &self.lattice {
            let axes = along(lattice.periodic());
            bail!("{name}: the box repeats along {axes}; --open leaves out contacts across it");
        }
        self.given(name, radius).map(|given| given.scene)
    }

    pub fn given(self, name: &str, radius: Option<f64>) -> anyhow::Result<Given> {
        let radii = match (self.radii, radius) {
            (None, None) => bail!("{name} holds no radii{}", without_radii(&self.unused)),
            (None, Some(radius)) => Radii::Uniform(radius),
            (Some(radii), _) => match radii.first() {
                Some(&first) if radii.iter().all(|&r| r == first) => Radii::Uniform(first),
                _ => Radii::Each(radii.into()),
            },
        };
        let scene = with_points!(self.centres, points => {
            AnyScene::from(Scene::<f64, _>::new(points, radii).with_context(|| name.to_string())?)
        });
        let Particles { lattice, has_box, notices, source, .. } = self;
        Ok(Given { scene, lattice, has_box, notices, source })
    }
}

pub(crate) fn unused_sizes(label: &str, given: f64) -> Notice {
    assumed!("the sizes in '{}' are not used: the radius is {given}", short(label))
}

/// Remedy for particles without radii; names like those of sizes come first.
fn without_radii(names: &[String]) -> String {
    let like = |name: &&String| {
        let name = name.to_ascii_lowercase();
        ["rad", "diam", "size"].iter().any(|part| name.contains(part))
    };
    let (mut shown, others): (Vec<&String>, Vec<&String>) = names.iter().partition(like);
    shown.extend(others);
    let there = match shown[..] {
        [] => "; add a column named r".into(),
        _ => format!(
            " in a column r, radius, d or diameter; not used: {}; if one holds them, give \
             --columns r=NAME or d=NAME",
            listed(&shown)
        ),
    };
    format!("{there}, or give --radius R (half the diameter; in an experiment radius = R)")
}

pub fn loaded(format: &'static str, particles: Particles, radius: RadiusSource) -> Loaded {
    (particles, About { format, radius, ..About::default() })
}
