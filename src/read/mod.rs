//! Files that people bring: particles in (CSV, XYZ, extended XYZ, NumPy npy), pairs out (CSV, npy).
//!
//! The format is told by the file's first bytes (npy), then by its ending (`.csv`, `.xyz`, `.extxyz`, `.npy`), then by its first line
//! (a single whole number: XYZ; else CSV). Numbers are converted with correct rounding. Errors name file, line and column, and
//! elements are numbered from 0 as everywhere.
//!
//! **Dimension.** Columns z or three-vectors give spheres, even where all z are 0: a plane scene written with z = 0 stays a scene of
//! spheres unless `dim: Some(2)` asks for discs; then every z must be 0. An array of three columns without names is x, y, z; with
//! `dim: Some(2)` it is x, y, radius.
//!
//! **Radii.** From the file (a column of diameters is halved, without error above 10^-307), or one for all from the options; both, or
//! neither, is refused. Equal radii become one radius for all.

pub mod csv;
pub mod npy;
pub mod write;
pub mod xyz;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use anyhow::{Context, bail, ensure};
use nalgebra::Point;

use crate::scene::{AnyScene, Radii, Scene};

/// Longest line of a text file. A longer one is some other kind of file, and would fill the memory.
pub const LONGEST_LINE: usize = 1 << 20;

/// What the file does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The radius of all particles, for files that hold none.
    pub radius: Option<f64>,
    /// 2 or 3, where the file leaves it open; none lets the file decide.
    pub dim: Option<u32>,
}

/// Reads the particles of a file, in file order.
pub fn scene(path: &Path, options: Options) -> anyhow::Result<AnyScene<'static>> {
    let name = path.display().to_string();
    let file = File::open(path).with_context(|| format!("cannot read {name}"))?;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    from(BufReader::with_capacity(1 << 16, file), &name, &ending, options)
}

/// Reads particles from a stream; `name` stands in messages, `ending` is the file name's, in lower case.
pub fn from(mut reader: impl BufRead, name: &str, ending: &str, options: Options) -> anyhow::Result<AnyScene<'static>> {
    if let Some(radius) = options.radius {
        ensure!(radius.is_finite() && radius >= 0.0, "the radius given is {radius}; it must be finite and not negative");
    }
    if let Some(dim) = options.dim {
        ensure!(dim == 2 || dim == 3, "the dimension given is {dim}; it must be 2 or 3");
    }
    let start = reader.fill_buf().with_context(|| format!("cannot read {name}"))?;
    ensure!(!start.is_empty(), "{name} is empty; a particle file has at least a header such as x,y,r");
    let starts = |magic: &str| start.starts_with(magic.as_bytes());
    ensure!(
        !starts("ITEM:"),
        "{name} is a LAMMPS dump, which is not read; write its x, y, z and radius columns as CSV with a header x,y,z,r"
    );
    ensure!(!starts("# vtk"), "{name} is a VTK file, which is not read; write its points as CSV with a header x,y,z,r, or as npy");
    let particles = if start.starts_with(npy::MAGIC) {
        npy::read(reader, name, options)?
    } else {
        ensure!(ending != "npy", "{name} is not a NumPy file: it does not begin with \\x93NUMPY; write it with numpy.save");
        let counted =
            || std::str::from_utf8(start.split(|&b| b == b'\n').next().unwrap_or_default()).is_ok_and(|l| l.trim().parse::<u64>().is_ok());
        match ending {
            "xyz" | "extxyz" => xyz::read(reader, name, options)?,
            "csv" | "tsv" => csv::read(reader, name, options)?,
            _ if counted() => xyz::read(reader, name, options)?,
            _ => csv::read(reader, name, options)?,
        }
    };
    particles.finish(name, options)
}

/// Particles as read: `dim` coordinates each, one after the other, and a radius each where the file has them.
#[derive(Debug, PartialEq)]
struct Particles {
    dim: usize,
    coordinates: Vec<f64>,
    radii: Option<Vec<f64>>,
}

impl Particles {
    fn new(dim: usize, has_radii: bool) -> Particles {
        Particles { dim, coordinates: Vec::new(), radii: has_radii.then(Vec::new) }
    }

    fn len(&self) -> usize {
        self.coordinates.len() / self.dim
    }

    fn finish(mut self, name: &str, options: Options) -> anyhow::Result<AnyScene<'static>> {
        let n = self.len();
        let radii = match (self.radii.take(), options.radius) {
            (Some(_), Some(radius)) => bail!("{name} holds radii, but the radius {radius} was given too; leave one out"),
            (None, None) => bail!("{name} holds no radii; give --radius R (half the diameter), or add a column named r"),
            (None, Some(radius)) => Radii::Uniform(radius),
            (Some(radii), None) => match radii.first() {
                Some(&first) if radii.iter().all(|&r| r == first) => Radii::Uniform(first),
                _ => Radii::Each(radii.into()),
            },
        };
        if options.dim == Some(2) && self.dim == 3 {
            if let Some(k) = (0..n).find(|&k| self.coordinates[3 * k + 2] != 0.0) {
                bail!("{name}: particle {k} has z = {}; only particles with z = 0 can be read as 2D", self.coordinates[3 * k + 2]);
            }
            self.coordinates = self.coordinates.chunks_exact(3).flat_map(|p| [p[0], p[1]]).collect();
            self.dim = 2;
        }
        ensure!(
            options.dim != Some(3) || self.dim == 3,
            "{name} holds plane points (x and y only); it cannot be read as 3D: add a column z"
        );
        Ok(match self.dim {
            2 => AnyScene::from(Scene::<f64, 2>::new(points(&self.coordinates), radii).with_context(|| name.to_string())?),
            _ => AnyScene::from(Scene::<f64, 3>::new(points(&self.coordinates), radii).with_context(|| name.to_string())?),
        })
    }
}

fn points<const D: usize>(coordinates: &[f64]) -> Vec<Point<f64, D>> {
    coordinates.as_chunks::<D>().0.iter().map(|&point| Point::from(point)).collect()
}

/// What a column of a file means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    /// x, y or z, as 0, 1 or 2.
    Axis(usize),
    Radius,
    Diameter,
    /// Something else, which is skipped.
    Other,
}

/// The columns of a file of text, by meaning, and their names for messages.
struct Columns {
    meaning: Vec<Column>,
    names: Vec<String>,
}

impl Columns {
    /// Checks that there are x and y, and nothing twice; gives an empty set of particles of that kind.
    fn particles(&self, place: &str) -> anyhow::Result<Particles> {
        let count = |column| self.meaning.iter().filter(|&&other| other == column).count();
        for (k, column) in self.meaning.iter().enumerate() {
            ensure!(*column == Column::Other || count(*column) == 1, "{place}: the column '{}' stands twice; remove one", self.names[k]);
        }
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            ensure!(
                count(Column::Axis(axis)) == 1,
                "{place}: there is no column '{name}' among {}; name the columns x,y[,z][,r], with r, radius, d or diameter",
                self.names.iter().map(|name| format!("'{}'", short(name))).take(20).collect::<Vec<_>>().join(", ")
            );
        }
        let sizes = count(Column::Radius) + count(Column::Diameter);
        ensure!(sizes <= 1, "{place}: there are a radius and a diameter column; remove one");
        Ok(Particles::new(2 + count(Column::Axis(2)), sizes == 1))
    }

    /// Adds the particle of one line; `cells` has as many items as there are columns.
    fn push<'a>(&self, particles: &mut Particles, cells: impl Iterator<Item = &'a str>, place: &str) -> anyhow::Result<()> {
        ensure!(particles.len() < u32::MAX as usize, "{place}: more than 2^32 - 1 = {} particles; split the file", u32::MAX);
        let mut point = [0.0; 3];
        for ((column, name), cell) in self.meaning.iter().zip(&self.names).zip(cells) {
            if *column == Column::Other {
                continue;
            }
            let cell = cell.trim_matches(['"', ' ']);
            let value: f64 = match cell.parse() {
                Ok(value) => value,
                Err(_) => bail!("{place}: column '{name}': '{}' is not a number; mend or remove the line", short(cell)),
            };
            ensure!(value.is_finite(), "{place}: column '{name}': '{}' is not a finite number; mend or remove the line", short(cell));
            match column {
                Column::Axis(k) => point[*k] = value,
                _ => {
                    ensure!(value >= 0.0, "{place}: column '{name}': {value} is negative; mend or remove the line");
                    let radius = if *column == Column::Diameter { 0.5 * value } else { value };
                    particles.radii.get_or_insert_default().push(radius);
                }
            }
        }
        particles.coordinates.extend_from_slice(&point[..particles.dim]);
        Ok(())
    }
}

/// The beginning of a text, for messages.
fn short(text: &str) -> String {
    if text.chars().count() > 40 { text.chars().take(40).chain(['…']).collect() } else { text.to_string() }
}

/// The lines of a text, numbered from 1, without their ends.
struct Lines<'a, R> {
    reader: R,
    name: &'a str,
    line: Vec<u8>,
    number: u64,
}

impl<'a, R: BufRead> Lines<'a, R> {
    fn new(reader: R, name: &'a str) -> Lines<'a, R> {
        Lines { reader, name, line: Vec::new(), number: 0 }
    }

    /// The next line with its place (`file:line`), or none at the end. Bytes that are no UTF-8 become U+FFFD.
    fn next(&mut self) -> anyhow::Result<Option<(String, String)>> {
        self.line.clear();
        self.number += 1;
        let limit = LONGEST_LINE as u64 + 1;
        let read = std::io::Read::take(&mut self.reader, limit).read_until(b'\n', &mut self.line);
        let place = format!("{}:{}", self.name, self.number);
        read.with_context(|| format!("cannot read {place}"))?;
        ensure!(self.line.len() <= LONGEST_LINE, "{place}: the line is longer than {LONGEST_LINE} bytes; this is not a particle file");
        let line = if self.number == 1 { self.line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&self.line) } else { &self.line };
        let text = String::from_utf8_lossy(line).trim_end_matches(['\n', '\r']).to_string();
        Ok(if self.line.is_empty() { None } else { Some((text, place)) })
    }
}

#[cfg(test)]
mod tests;
