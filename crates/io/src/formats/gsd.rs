//! GSD files of HOOMD: frames of named arrays, found by an index.
//!
//! The reader uses `particles/position`, `particles/diameter`, `configuration/box`,
//! `configuration/dimensions` and `configuration/step`. A missing array is taken from frame 0,
//! otherwise HOOMD's default is used: diameter 1. The box is periodic along all vectors and centred
//! at the origin. Numbers are f32, which f64 holds exactly. Vectors of a tilted box are products of
//! two f32, which f64 holds exactly too.
//!
//! Format: <https://gsd.readthedocs.io/en/stable/file-layer.html>,
//! <https://gsd.readthedocs.io/en/stable/schema-hoomd.html>.

use anyhow::{Context, bail, ensure};

use crate::columns::Column;
use crate::formats::Indexed;
use crate::frames::Framed;
use crate::options::{Opened, Options};
use crate::particles::{Loaded, Particles, loaded};
use crate::raw::lines::Source;
use crate::raw::room::room_for;
use crate::types::{About, Declared, RadiusSource, assumed};

pub(crate) const MAGIC: &[u8] = b"\xdf\x65\xdf\x65\xdf\x65\xdf\x65";

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Indexed::<File>::new(source, options))
}

impl Framed for Indexed<'_, File> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        self.next_of(File::read, |file| file.frames)
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let (Some(file), name, k) = (&self.index, self.source.name, self.next - 1) else {
            return Ok(None);
        };
        let read = keep.then(|| file.frame(k, name, self.options)).transpose();
        read.with_context(|| format!("{name}: frame {k}"))
    }
}

#[derive(Clone, Copy)]
struct Chunk {
    frame: u64,
    rows: u64,
    columns: u32,
    location: u64,
    name: u16,
    kind: u8,
}

struct File {
    bytes: Vec<u8>,
    chunks: Vec<Chunk>,
    names: Vec<Vec<u8>>,
    frames: u64,
}

fn word(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// Returns `count` items of `size` bytes; `None` if the file is too short.
fn part(bytes: &[u8], from: u64, count: u64, size: u64) -> Option<&[u8]> {
    let end = from.checked_add(count.checked_mul(size)?)?;
    bytes.get(usize::try_from(from).ok()?..usize::try_from(end).ok()?)
}

/// Bytes per number of a GSD type: 4 is u64, 3 is u32, 9 is f32, all others are bytes.
fn width(kind: u8) -> usize {
    match kind {
        4 => 8,
        3 | 9 => 4,
        _ => 1,
    }
}

impl File {
    fn read(source: &mut Source<'_>) -> anyhow::Result<File> {
        let (name, mut bytes) = (source.name, Vec::new());
        loop {
            let more = source.input.fill_buf().with_context(|| format!("cannot read {name}"))?;
            let count = more.len();
            if count == 0 {
                break;
            }
            room_for(&mut bytes, count)?;
            bytes.extend_from_slice(more);
            source.input.consume(count);
        }
        ensure!(bytes.starts_with(MAGIC), "{name} does not begin as a GSD file; write it again");
        let torn = || format!("{name}: the index of the GSD file is cut off; write it again");
        let field = |k: usize| word(&bytes, 8 * k).with_context(torn);
        let [index, entries, list, labels] = [field(1)?, field(2)?, field(3)?, field(4)?];
        let version = field(5)? >> 48;
        ensure!(matches!(version, 1 | 2), "{name} is GSD of version {version}, not 1 or 2");
        let list = part(&bytes, list, labels, 64).with_context(torn)?;
        // Names fill 64 bytes each in version 1, and end with a zero byte in version 2.
        let until_zero = |name: &[u8]| name.split(|&b| b == 0).next().unwrap_or_default().to_vec();
        let names: Vec<Vec<u8>> = match version {
            1 => list.chunks(64).map(until_zero).collect(),
            // Index entries refer to names by 16-bit numbers.
            _ => list.split(|&b| b == 0).take(1 << 16).map(<[u8]>::to_vec).collect(),
        };
        let mut chunks = Vec::new();
        for entry in part(&bytes, index, entries, 32).with_context(torn)?.chunks_exact(32) {
            let field = |at: usize| word(entry, at).unwrap_or_default();
            if field(16) == 0 {
                break;
            }
            let [.., n0, n1, kind, _] = *entry else { break };
            let (columns, name) = (field(24) as u32, u16::from_le_bytes([n0, n1]));
            room_for(&mut chunks, 1)?;
            let (frame, rows, location) = (field(0), field(8), field(16));
            chunks.push(Chunk { frame, rows, columns, location, name, kind });
        }
        let frames = chunks.iter().map(|chunk| chunk.frame.saturating_add(1)).max().unwrap_or(0);
        let sound = frames <= chunks.len() as u64 && chunks.is_sorted_by_key(|chunk| chunk.frame);
        ensure!(sound, "{name}: the frames in the index of the GSD file are wrong; write it again");
        Ok(File { bytes, chunks, names, frames })
    }

    fn chunk(&self, frame: u64, name: &str) -> Option<Chunk> {
        let id = self.names.iter().position(|known| known == name.as_bytes())?;
        [frame, 0].into_iter().find_map(|frame| {
            let from = self.chunks.partition_point(|chunk| chunk.frame < frame);
            let of_frame = self.chunks[from..].iter().take_while(|chunk| chunk.frame == frame);
            of_frame.copied().find(|chunk| usize::from(chunk.name) == id)
        })
    }

    fn data(&self, chunk: Chunk, name: &str, kind: u8, columns: u32) -> anyhow::Result<&[u8]> {
        let fits = chunk.kind == kind && chunk.columns == columns;
        ensure!(fits, "{name}: not {columns} columns of type {kind}, as HOOMD writes them");
        let size = u64::from(columns) * width(kind) as u64;
        let found = part(&self.bytes, chunk.location, chunk.rows, size);
        found.with_context(|| format!("{name}: its rows go beyond the end of the file"))
    }

    fn floats(&self, frame: u64, name: &str, columns: u32) -> anyhow::Result<Option<Vec<f64>>> {
        let Some(chunk) = self.chunk(frame, name) else { return Ok(None) };
        let data = self.data(chunk, name, 9, columns)?;
        let mut numbers = Vec::new();
        room_for(&mut numbers, data.len() / 4)?;
        let (floats, _) = data.as_chunks::<4>();
        numbers.extend(floats.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))));
        Ok(Some(numbers))
    }

    fn whole(&self, frame: u64, name: &str, kind: u8) -> anyhow::Result<Option<u64>> {
        let Some(chunk) = self.chunk(frame, name) else { return Ok(None) };
        let data = self.data(chunk, name, kind, 1)?;
        let mut wide = [0; 8];
        data.iter().take(width(kind)).zip(&mut wide).for_each(|(from, to)| *to = *from);
        Ok((!data.is_empty()).then(|| u64::from_le_bytes(wide)))
    }

    fn frame(&self, frame: u64, name: &str, options: Options) -> anyhow::Result<Loaded> {
        let columns = options.columns.is_some();
        ensure!(!columns, "{name}: GSD has one array of diameters; leave out --columns");
        let n = self.whole(frame, "particles/N", 3)?.unwrap_or(0) as usize;
        let dim = if self.whole(frame, "configuration/dimensions", 1)? == Some(2) { 2 } else { 3 };
        let mut notices = Vec::new();
        let places = match self.floats(frame, "particles/position", 3)? {
            Some(places) if places.len() == 3 * n => places,
            _ if n == 0 => Vec::new(),
            _ => bail!("there are no particles/position for its {n} particles"),
        };
        let sizes = match self.floats(frame, "particles/diameter", 1)? {
            _ if options.radius.is_some() => None,
            Some(sizes) if sizes.len() == n => Some(sizes),
            _ => {
                let shapes = self.chunk(frame, "particles/type_shapes").is_some();
                ensure!(!shapes, "{name} has sizes in particles/type_shapes alone; give --radius");
                notices.push(assumed!(
                    "the file has no diameters: HOOMD's default of 1 is used; --radius changes this"
                ));
                None
            }
        };
        let mut particles = Particles::new(dim, options.radius.is_none());
        for (k, place) in places.chunks_exact(3).enumerate() {
            let bad = place.iter().find(|x| !x.is_finite());
            ensure!(bad.is_none(), "particle {k} (from 0) is at {place:?}; it must be finite");
            ensure!(dim == 3 || place[2] == 0.0, "particle {k} (from 0) of a plane scene has a z");
            let size = sizes.as_ref().map_or(1.0, |sizes| sizes[k]);
            let radius = Column::Diameter.value(size);
            let radius = radius.map_err(|why| anyhow::anyhow!("particle {k}: {size} {why}"))?;
            particles.push([place[0], place[1], place[2]], radius, k as i64)?;
        }
        particles.notices = notices;
        let radius = match (options.radius, sizes) {
            (Some(_), _) => RadiusSource::Missing,
            (None, Some(_)) => RadiusSource::Halved("particles/diameter".into()),
            (None, None) => RadiusSource::Halved("particles/diameter (default)".into()),
        };
        let declared = self.floats(frame, "configuration/box", 1)?.map(|of| boxed(&of, dim));
        let step = self.whole(frame, "configuration/step", 4)?.unwrap_or(0);
        let (particles, about) = loaded("GSD", particles, radius);
        let step = i64::try_from(step).ok();
        Ok((particles, About { declared: declared.transpose()?, step, ..about }))
    }
}

fn boxed(numbers: &[f64], dim: usize) -> anyhow::Result<Declared> {
    let [x, y, z, xy, xz, yz] = *numbers else {
        bail!("configuration/box has {} numbers; six are expected", numbers.len())
    };
    ensure!(numbers.iter().all(|x| x.is_finite()), "configuration/box is {numbers:?}");
    // Scenes of discs ignore the third vector.
    let (z, xz, yz) = if dim == 2 { (0.0, 0.0, 0.0) } else { (z, xz, yz) };
    let vectors = [[x, 0.0, 0.0], [xy * y, y, 0.0], [xz * z, yz * z, z]];
    let origin = [0, 1, 2].map(|k| -0.5 * vectors.iter().map(|vector| vector[k]).sum::<f64>());
    let periodic = Some([true, true, dim == 3]);
    Ok(Declared { vectors: Some(vectors), origin, periodic, ..Declared::default() })
}
