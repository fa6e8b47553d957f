//! Particles while they are read. Memory grows with the bytes of the file, whatever number its
//! header announces.

pub(super) mod digits;
mod ids;

use anyhow::{Context, bail, ensure};
use nalgebra::Point;

use crate::Given;
use crate::boxes::along;
pub(crate) use crate::columns::{Column, Columns, DECIMAL_COMMAS, Rows, is_decimal_comma};
use crate::raw::lines::{listed, short};
use crate::raw::room::{room, room_for};
use crate::{About, Groups, Loaded, Notice, Options, RadiusSource};
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Scene};

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
    pub(super) digits: digits::Counts,
}

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
        ensure!(
            self.len() < u32::MAX as usize,
            "more than 2^32 - 1 = {} particles; split the file",
            u32::MAX
        );
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

    /// Adds the particles of another file of the same scene; `name` is used in messages.
    pub fn append(&mut self, other: Particles, name: &str) -> anyhow::Result<()> {
        let n = self.len() + other.len();
        ensure!(n <= u32::MAX as usize, "more than 2^32 - 1 = {} particles", u32::MAX);
        ensure!(
            self.has_radii() == other.has_radii() || self.is_empty() || other.is_empty(),
            "{name}: of the pieces of one scene some hold radii, and others none; write them alike"
        );
        match (&mut self.centres, other.centres) {
            (Centres::Plane(all), Centres::Plane(more)) => {
                room_for(all, more.len())?;
                all.extend(more);
            }
            (Centres::Space(all), Centres::Space(more)) => {
                room_for(all, more.len())?;
                all.extend(more);
            }
            _ => bail!("{name}: some pieces of one scene hold discs, and others spheres"),
        }
        joined(&mut self.radii, other.radii, n)?;
        joined(&mut self.ids, other.ids, n)?;
        match (&mut self.groups, other.groups) {
            (Some(all), Some(more)) => all.append(more)?,
            (all, _) => *all = None,
        }
        let new = other.notices.into_iter().filter(|notice| !self.notices.contains(notice));
        let new: Vec<Notice> = new.collect();
        self.notices.extend(new);
        Ok(())
    }

    pub(crate) fn from_columns(
        points: Vec<Point<f64, 3>>,
        radii: Option<Vec<f64>>,
        name: &str,
    ) -> anyhow::Result<Particles> {
        if let Some(radii) = &radii {
            ensure!(
                radii.len() == points.len(),
                "{name} holds {} points but {} radii; write it again",
                points.len(),
                radii.len()
            );
        }
        Ok(Particles { centres: Centres::Space(points), radii, ..Particles::default() })
    }

    /// Applies the options: the given radius replaces the file's, and spheres with z = 0 become
    /// discs. Options that contradict the particles are refused.
    pub(crate) fn as_asked(
        &mut self,
        name: &str,
        options: Options,
        radius: &mut RadiusSource,
    ) -> anyhow::Result<()> {
        if let Some(given) = options.radius {
            if self.radii.take().is_some() {
                let label = match radius {
                    RadiusSource::Column(label) | RadiusSource::Halved(label) => label.as_str(),
                    RadiusSource::Given | RadiusSource::Missing => "the last column",
                };
                self.notices.push(unused_sizes(label, given));
            }
            *radius = RadiusSource::Given;
        }
        ensure!(
            options.dim != Some(3) || self.dim() == 3,
            "{name} holds plane points (x and y only); it cannot be read as 3D: add a column z"
        );
        if let (Some(2), Centres::Space(points)) = (options.dim, &mut self.centres) {
            if let Some(k) = points.iter().position(|point| point[2] != 0.0) {
                bail!(
                    "{name}: particle {k} has z = {}; only particles with z = 0 can be read as 2D",
                    points[k][2]
                );
            }
            self.centres = Centres::Plane(
                std::mem::take(points).into_iter().map(|p| Point::from([p[0], p[1]])).collect(),
            );
        }
        Ok(())
    }

    pub fn scene(self, name: &str, radius: Option<f64>) -> anyhow::Result<AnyScene<'static>> {
        if let Some(lattice) = &self.lattice {
            bail!(
                "{name}: the box repeats along {}, and here boundaries are open; give --open to \
                 leave out contacts across it",
                along(lattice.periodic())
            );
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

/// Appends the values of further particles, which are now `count` in all. The list is dropped if
/// some particle has no value.
fn joined<T>(all: &mut Option<Vec<T>>, more: Option<Vec<T>>, count: usize) -> anyhow::Result<()> {
    if all.is_none() && more.is_none() {
        return Ok(());
    }
    let (mut list, more) = (all.take().unwrap_or_default(), more.unwrap_or_default());
    room_for(&mut list, more.len())?;
    list.extend(more);
    *all = (list.len() == count).then_some(list);
    Ok(())
}

pub(crate) fn unused_sizes(label: &str, given: f64) -> Notice {
    Notice::Assumed(format!("the sizes in '{}' are not used: the radius is {given}", short(label)))
}

/// Remedy for particles without radii; names like those of sizes come first.
fn without_radii(names: &[String]) -> String {
    let like = |name: &&String| {
        let name = name.to_ascii_lowercase();
        ["rad", "diam", "size"].iter().any(|part| name.contains(part))
    };
    let (mut shown, others): (Vec<&String>, Vec<&String>) = names.iter().partition(like);
    let remedy = match shown.first() {
        Some(name) => format!("choose one: --columns r={0} or d={0}", short(name)),
        None => "give --columns r=NAME or d=NAME if one of the names is theirs".into(),
    };
    shown.extend(others);
    let there = match shown[..] {
        [] => "; add a column named r, or".into(),
        _ => format!(
            " in a column r, radius, d or diameter; not used: {}; {remedy}, or",
            listed(&shown)
        ),
    };
    format!("{there} give --radius R (half the diameter; in an experiment radius = R)")
}

pub fn loaded(format: &'static str, particles: Particles, radius: RadiusSource) -> Loaded {
    (particles, About { format, radius, ..About::default() })
}
