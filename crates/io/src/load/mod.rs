//! Reads scenes, or the frames of a file one at a time.

pub mod series;

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

use anyhow::{Context, anyhow, ensure};

use crate::columns::advice::{self, Unclear};
use crate::columns::shapes;
use crate::doubts;
use crate::formats;
use crate::frames::{Choice, Stream};
use crate::options::Options;
use crate::particles::{Given, Loaded, Particles};
use crate::raw::gzip::{self, Unpacking};
use crate::raw::lines::Source;
use crate::types::{About, FrameChoice, Notice};
use contactbench_ground::scene::AnyScene;

pub fn scene(path: &Path, options: Options) -> anyhow::Result<AnyScene<'static>> {
    let (particles, _) = load(path, options)?;
    particles.scene(&path.display().to_string(), options.radius)
}

pub fn given(path: &Path, options: Options) -> anyhow::Result<Given> {
    let (particles, _) = load(path, options)?;
    particles.given(&path.display().to_string(), options.radius)
}

/// Reads the particles of a file, which need not have radii.
pub fn load(path: &Path, options: Options) -> anyhow::Result<Loaded> {
    frames(path, options, |frames| frames.chosen())
}

/// Calls `body` with the chosen frames of a file, or of the files of a pattern such as `run_*.csv`.
pub fn frames<T>(
    path: &Path,
    options: Options,
    body: impl FnOnce(Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let read = move |file: &Path, _, notice: &Option<Notice>| {
        let options = Options { frame: FrameChoice::Only, survey: false, ..options };
        let ((mut particles, about), _) = opened(file, options, |mut frames| frames.one())?;
        particles.notices.extend(notice.clone());
        Ok((particles, About { file: Some(file.display().to_string()), ..about }))
    };
    let Some(series) = series::of(path, read)? else {
        return opened(path, options, body);
    };
    options.check()?;
    let choice = Choice::new(options.frame, options.survey);
    let name = path.display().to_string();
    body(Frames { stream: Stream::new(Box::new(series), choice, &name), options })
}

fn opened<T>(
    path: &Path,
    options: Options,
    body: impl FnOnce(Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let name = path.display().to_string();
    ensure!(!path.is_dir(), "{name} is a folder; give a file, or a pattern of files in quotes");
    let file = File::open(path).with_context(|| format!("cannot read {name}"))?;
    let packed = path.file_stem().filter(|_| ending(path) == "gz").map(Path::new);
    // The names POSCAR and CONTCAR have no ending.
    let path = packed.unwrap_or(path);
    let bare = path.file_name().filter(|_| path.extension().is_none()).unwrap_or_default();
    let ending = ending(path) + &bare.to_string_lossy().to_ascii_lowercase();
    frames_from(file, &name, &ending, options, body)
}

/// Returns the ending of a file name, in lower case.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// Reads the particles of a stream. `name` is used in messages; `ending` is the file name's ending
/// in lower case.
pub fn load_from(
    reader: impl Read,
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<Loaded> {
    frames_from(reader, name, ending, options, |frames| frames.chosen())
}

pub fn frames_from<T>(
    reader: impl Read,
    name: &str,
    ending: &str,
    options: Options,
    body: impl FnOnce(Frames<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    options.check()?;
    unpacked(reader, name, |input, unpacking, head, gzip| {
        ensure!(!head.is_empty(), "{name} is empty; give another file");
        let twice = gzip && head.starts_with(gzip::MAGIC);
        ensure!(!twice, "{name} is compressed twice; unpack it once");
        let source = Source { input, name, unpacking };
        let reader = formats::find(head, name, ending, options)?.open(source, options);
        let mut choice = Choice::new(options.frame, options.survey);
        choice.gzip = gzip;
        let read = body(Frames { stream: Stream::new(reader, choice, name), options });
        read.map_err(|error| match error.chain().any(|cause| cause.is::<Unclear>()) {
            true => anyhow!("{error:#}; {}", advice::of(head, options.radius.is_some())),
            false => error,
        })
    })
}

/// Calls `body` with the unpacked bytes of a stream, its first bytes (which give the format), and
/// whether it was compressed.
pub(crate) fn unpacked<T>(
    reader: impl Read,
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
    let mut reader = BufReader::with_capacity(1 << 18, unpacking.file(reader));
    let packed = head(&mut reader)?;
    let mut reader = Cursor::new(&packed[..]).chain(reader);
    if !packed.starts_with(gzip::MAGIC) {
        return body(&mut reader, unpacking, &packed, false);
    }
    let mut reader = BufReader::with_capacity(1 << 17, unpacking.gzip(reader));
    let head = head(&mut reader)?;
    body(&mut Cursor::new(&head[..]).chain(reader), unpacking, &head, true)
}

/// The frames of a particle file. Only one frame is in memory at a time.
///
/// Particles keep the order of the file; [`Particles::sort_by_id`] gives all frames the same order.
/// Each frame has its number and, if the format has one, its time step ([`About`]). The number of
/// particles, ids and boxes may differ between frames.
pub struct Frames<'a> {
    stream: Stream<'a, Loaded>,
    options: Options,
}

impl Frames<'_> {
    fn chosen(mut self) -> anyhow::Result<Loaded> {
        let (read, frame) = self.one()?;
        self.finished(read, frame)
    }

    /// Returns the chosen frame as it was read, and its number.
    fn one(&mut self) -> anyhow::Result<(Loaded, u64)> {
        let (read, frame) = self.stream.one()?;
        let none = || format!("{} holds no frame of particles", self.stream.name);
        let (mut particles, about) = read.with_context(none)?;
        particles.notices.extend(self.stream.choice.torn.take());
        Ok(((particles, about), frame))
    }

    fn finished(&self, (particles, about): Loaded, frame: u64) -> anyhow::Result<Loaded> {
        let Stream { choice, name, .. } = &self.stream;
        let (gzip, frames) = (choice.gzip, choice.seen.max(1));
        let name = about.file.clone().unwrap_or_else(|| name.to_string());
        finished(particles, About { gzip, frames, frame, ..about }, &name, self.options)
    }
}

impl Iterator for Frames<'_> {
    type Item = anyhow::Result<Loaded>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.stream.next()?;
        let frame = self.stream.choice.seen.saturating_sub(1);
        let next = next.and_then(|read| self.finished(read, frame));
        self.stream.ended = next.is_err();
        Some(next)
    }
}

/// Applies the options to the particles as they were read.
fn finished(
    mut particles: Particles,
    mut about: About,
    name: &str,
    options: Options,
) -> anyhow::Result<Loaded> {
    if let Some(radius) = options.radius {
        particles.take_radius(radius, &mut about.radius);
    }
    particles.in_dim(options.dim).with_context(|| name.to_string())?;
    if options.without.is_some() {
        let groups = particles.groups.as_ref().with_context(|| {
            format!("{name}: --without needs a text with columns, and {} has none", about.format)
        })?;
        groups.check(particles.len(), options.frame, name)?;
    }
    let (dim, declared) = (particles.dim(), about.declared.as_ref());
    particles.lattice = options.boundaries.lattice(name, dim, declared, &mut particles.notices)?;
    particles.has_box = declared.is_some_and(|declared| declared.vectors.is_some());
    if options.boundaries.unknown(declared) {
        particles.notices.push(Notice::Boundaries);
    }
    if options.dim.is_none() && particles.is_flat() {
        particles.notices.push(Notice::Flat);
    }
    particles.notices.extend(shapes::notices(&particles));
    particles.notices.extend(doubts::of_box(&particles));
    particles.source = Some(about.radius.clone());
    Ok((particles, about))
}
