//! Reads particles and contact lists from files, and writes pairs and scenes.
//!
//! Each format has one module and one entry in [`FORMATS`]. The first bytes of a file give its
//! format, otherwise its ending does; the option `format` overrides both. Files may be compressed
//! with gzip. Numbers are rounded correctly. Errors name file, line and column; particles are
//! numbered from 0.
//!
//! **Dimension.** A column z or three-dimensional vectors make spheres, even if every z is 0. If
//! `dim` is `Some(2)`, they make discs, and every z must be 0. An array of three unnamed columns is
//! x, y, z, or x, y, radius with `dim: Some(2)`.
//!
//! **Radii.** A radius from the options replaces those of the file. Diameters are halved, which is
//! exact above 10^-307. Equal radii are stored as one.
//!
//! **Frames.** A file of several frames is refused unless the options choose one. [`frames`] reads
//! all of them, one at a time.
//!
//! **Boxes.** Particles keep their periodic box. They do not become an open scene unless the
//! options ask for it; see [`boxes`].
//!
//! **Memory.** Lists of particles grow by a quarter at a time, as bytes are read, whatever number
//! the header announces. Nothing else is kept.

pub mod boxes;
mod columns;
pub mod exchange;
mod formats;
mod frames;
mod given;
mod notice;
mod options;
pub mod pairs;
mod particles;
mod raw;
mod without;
pub mod write;

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use anyhow::{Context, ensure};
pub use boxes::{Boundaries, Declared};
pub use columns::chosen::Chosen;
use formats::gzip::{self, Unpacking};
pub use formats::{FORMATS, Format};
use frames::Choice;
pub use frames::series::exists;
pub use frames::{Frame, Frames};
pub use given::Given;
pub use notice::{Notice, Place};
pub use options::{FileOption, OPTIONS, Options};
pub use particles::Particles;
pub use raw::lines::LONGEST_LINE;
use raw::lines::Source;
pub use raw::lines::short;
pub use raw::room::room;
pub use without::{Groups, Without};

use contactbench_ground::scene::AnyScene;

#[derive(Clone, Debug, Default, PartialEq)]
pub enum RadiusSource {
    Column(String),
    /// Name of the column or array of diameters, whose values were halved.
    Halved(String),
    Given,
    #[default]
    Missing,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    pub format: &'static str,
    pub gzip: bool,
    pub radius: RadiusSource,
    pub frames: u64,
    pub frame: u64,
    pub step: Option<i64>,
    pub time: Option<f64>,
    /// The box in the file, and whether it is periodic.
    pub declared: Option<Declared>,
    pub file: Option<String>,
}

pub type Loaded = (Particles, About);

impl About {
    pub fn which(&self) -> String {
        match self.step {
            Some(step) => format!("frame {} (step {step})", self.frame),
            None => format!("frame {}", self.frame),
        }
    }
}

pub fn scene(path: &Path, options: Options) -> anyhow::Result<AnyScene<'static>> {
    let (particles, _) = load(path, options)?;
    particles.scene(&path.display().to_string(), options.radius)
}

pub fn given(path: &Path, options: Options) -> anyhow::Result<Given> {
    let (particles, _) = load(path, options)?;
    particles.given(&path.display().to_string(), options.radius)
}

/// Reads a scene from a stream. `name` is used in messages; `ending` is the file name's ending in
/// lower case.
pub fn from(
    reader: impl BufRead,
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<AnyScene<'static>> {
    let (particles, _) = load_from(reader, name, ending, options)?;
    particles.scene(name, options.radius)
}

/// Reads the particles of a file, which need not have radii.
pub fn load(path: &Path, options: Options) -> anyhow::Result<Loaded> {
    frames(path, options, |frames| frames.chosen())
}

/// Calls `body` with the chosen frames of a file. `path` may also be a pattern such as `run_*.vtp`,
/// or a list of files (`.pvd`, `.series`).
pub fn frames<T>(
    path: &Path,
    options: Options,
    body: impl FnOnce(Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let Some(series) = frames::series::of(path, options)? else {
        return opened(path, options, body);
    };
    options.check()?;
    let choice = Choice::new(options.frame, options.survey);
    let (reader, name) = (Box::new(series), &*path.display().to_string());
    body(Frames { reader, choice, name, options, ended: false })
}

fn opened<T>(
    path: &Path,
    options: Options,
    body: impl FnOnce(Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let name = path.display().to_string();
    let file = File::open(path).with_context(|| format!("cannot read {name}"))?;
    let reader = BufReader::with_capacity(1 << 18, file);
    frames_from(reader, &name, &ending(path), options, body)
}

fn ending(path: &Path) -> String {
    let ending = |path: &Path| {
        path.extension()
            .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default()
    };
    match (ending(path), path.file_stem()) {
        (last, Some(stem)) if last == "gz" => ending(Path::new(stem)),
        (last, _) => last,
    }
}

pub fn load_from(
    reader: impl BufRead,
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<Loaded> {
    frames_from(reader, name, ending, options, |frames| frames.chosen())
}

pub fn frames_from<T>(
    reader: impl BufRead,
    name: &str,
    ending: &str,
    options: Options,
    body: impl FnOnce(Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    options.check()?;
    unpacked(reader, name, |input, unpacking, head, gzip| {
        ensure!(
            !head.is_empty(),
            "{name} is empty; a particle file has at least a header such as x,y,r"
        );
        let twice = "is compressed twice; unpack it once";
        ensure!(!gzip || !head.starts_with(gzip::MAGIC), "{name} {twice}");
        let source = Source { input, name, unpacking };
        let reader = formats::find(head, name, ending, options)?.open(source, options);
        let mut choice = Choice::new(options.frame, options.survey);
        choice.gzip = gzip;
        body(Frames { reader, choice, name, options, ended: false })
    })
}

/// Calls `body` with the unpacked bytes of a stream, its first bytes (which give the format), and
/// whether it was compressed.
fn unpacked<T>(
    reader: impl BufRead,
    name: &str,
    body: impl FnOnce(&mut dyn BufRead, &Unpacking, &[u8], bool) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let head = |reader: &mut dyn BufRead| {
        let mut head = Vec::new();
        let read = reader.take(4096).read_to_end(&mut head);
        read.with_context(|| format!("cannot read {name}"))?;
        anyhow::Ok(head)
    };
    let unpacking = &Unpacking::default();
    let mut reader = unpacking.file(reader);
    let packed = head(&mut reader)?;
    let mut reader = std::io::Cursor::new(&packed[..]).chain(reader);
    if !packed.starts_with(gzip::MAGIC) {
        return body(&mut reader, unpacking, &packed, false);
    }
    let mut reader = BufReader::with_capacity(1 << 17, unpacking.gzip(reader));
    let head = head(&mut reader)?;
    body(&mut std::io::Cursor::new(&head[..]).chain(reader), unpacking, &head, true)
}

fn finished(
    mut particles: Particles,
    mut about: About,
    name: &str,
    options: Options,
) -> anyhow::Result<Loaded> {
    particles.as_asked(name, options, &mut about.radius)?;
    if options.without.is_some() {
        let groups = particles.groups.as_ref().with_context(|| {
            format!(
                "{name}: --without needs a column with that name, and {} has none that is read; \
                 write a text such as CSV, or a LAMMPS dump",
                about.format
            )
        })?;
        groups.check(particles.len(), options.frame, name)?;
    }
    particles.notices.extend(formats::maybe_frames(about.format, &particles.unused));
    let (dim, declared) = (particles.dim(), about.declared.as_ref());
    particles.lattice = options.boundaries.lattice(name, dim, declared, &mut particles.notices)?;
    particles.has_box = declared.is_some_and(|declared| declared.vectors.is_some());
    if options.boundaries.unknown(declared) {
        particles.notices.push(Notice::Boundaries);
    }
    let repeats = particles.lattice.as_ref().is_some_and(|lattice| lattice.periodic()[2]);
    if options.dim.is_none() && particles.is_flat() {
        particles.notices.push(if repeats { Notice::Plane } else { Notice::Flat });
    }
    particles.notices.extend(particles.cut_to().map(Notice::Digits));
    particles.source = Some(about.radius.clone());
    Ok((particles, about))
}

#[cfg(test)]
mod tests;
