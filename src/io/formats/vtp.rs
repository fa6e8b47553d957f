//! VTK XML: `.vtp` (PolyData) and `.vtu` (UnstructuredGrid), one piece: text, base64, or appended
//! (raw or base64), each also compressed with zlib.
//!
//! The size is a point array named `radius`, `r`, `diameter` or `d`. Format:
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use std::io::{BufRead, BufReader, Read};

use anyhow::{Context, bail, ensure};
use flate2::bufread::ZlibDecoder;

use crate::io::formats::gzip::Unpacking;
use crate::io::formats::xml::{Base64, Tag, Xml};
use crate::io::lines::{Source, number, short, shown};
use crate::io::particles::{Particles, loaded};
use crate::io::scalars::{Arrays, Kind, Target};
use crate::io::{About, Options};

/// What holds for all arrays of a file.
#[derive(Clone, Copy)]
struct Layout {
    big: bool,
    /// Bytes of the numbers that announce lengths.
    header: usize,
    zlib: bool,
}

/// An array that is kept, where its numbers are not beside its name.
struct Appended {
    offset: u64,
    target: Target,
    kind: Kind,
    count: u64,
}

pub(crate) fn read(source: Source<'_>, _: Options) -> anyhow::Result<(Particles, About)> {
    let (name, unpacking) = (source.name, source.unpacking);
    let mut xml = Xml { source, line: 1 };
    let mut layout = Layout { big: false, header: 4, zlib: false };
    let (mut arrays, mut appended) = (Arrays::default(), Vec::new());
    let (mut within, mut points, mut known, mut ended) = (String::new(), None, false, false);
    while let Some(tag) = xml.tag()? {
        let place = xml.place();
        match (tag.name.as_str(), tag.closing) {
            ("VTKFile", false) => {
                let kind = tag.get("type").unwrap_or_default();
                ensure!(
                    matches!(kind, "PolyData" | "UnstructuredGrid"),
                    "{place}: a VTK file of type '{}' is not read; write PolyData (.vtp)",
                    short(kind)
                );
                known = true;
                layout = of_file(&tag).with_context(|| place)?;
            }
            _ if !known => bail!("{place}: '<{}' begins what is no VTK XML file", short(&tag.name)),
            ("VTKFile", true) => {
                ended = true;
                break;
            }
            ("Piece", false) => {
                let n = tag.get("NumberOfPoints").and_then(|n| n.parse::<u64>().ok());
                let n = n.with_context(|| {
                    format!("{place}: the piece does not say its NumberOfPoints")
                })?;
                ensure!(
                    n <= u64::from(u32::MAX),
                    "{place}: {n} points; at most 2^32 - 1 = {} can be numbered: split the file",
                    u32::MAX
                );
                ensure!(
                    points.unwrap_or(0) == 0 || n == 0,
                    "{place}: a second piece with points; write one piece"
                );
                points = Some(points.unwrap_or(0).max(n));
            }
            (
                "Points" | "PointData" | "CellData" | "Cells" | "Verts" | "Lines" | "Strips"
                | "Polys" | "FieldData",
                closing,
            ) => {
                within = if closing || tag.empty { String::new() } else { tag.name.clone() };
            }
            ("DataArray", false) => {
                let target = match within.as_str() {
                    "Points" => Target::points(),
                    "PointData" => {
                        Target::named(tag.get("Name").unwrap_or_default(), components(&tag))
                    }
                    _ => Target::Nothing,
                };
                let is_points = matches!(target, Target::Points(..));
                ensure!(
                    !is_points || components(&tag) == 3,
                    "{place}: Points have {} components; 3 are needed",
                    components(&tag)
                );
                if let (Target::Nothing, _) | (_, None) = (&target, points) {
                    continue;
                }
                let count = points.unwrap_or(0).saturating_mul(components(&tag));
                let label = tag.get("type").unwrap_or_default();
                let kind = Kind::named(label).with_context(|| {
                    format!(
                        "{place}: numbers of type '{}' are not read; write Float32 or Float64",
                        short(label)
                    )
                })?;
                match tag.get("format").unwrap_or("ascii") {
                    "appended" => {
                        let offset = tag.get("offset").and_then(|offset| offset.parse().ok());
                        let offset = offset.with_context(|| {
                            format!(
                                "{place}: the array does not say at which offset its numbers are"
                            )
                        })?;
                        appended.push(Appended { offset, target, kind, count });
                    }
                    "ascii" if !tag.empty => arrays.keep(text(&mut xml, target, count)?, name)?,
                    "binary" if !tag.empty => {
                        let mut bytes = Base64::new(&mut xml);
                        arrays.keep(
                            numbers(&mut bytes, unpacking, layout, target, kind, count)
                                .with_context(|| place)?,
                            name,
                        )?;
                    }
                    "ascii" | "binary" => ensure!(count == 0, "{place}: the array is empty"),
                    other => bail!(
                        "{place}: the format '{}' is neither ascii, binary nor appended",
                        short(other)
                    ),
                }
            }
            ("AppendedData", false) => {
                let raw = tag.get("encoding") == Some("raw");
                appended.sort_by_key(|array| array.offset);
                behind(&mut xml, raw, layout, std::mem::take(&mut appended), &mut arrays)?;
                ended = true;
                break;
            }
            _ => {}
        }
    }
    ensure!(appended.is_empty(), "{name} ends before its AppendedData; write it again");
    ensure!(ended, "{name} ends before </VTKFile>; write it again");
    let (particles, radius) = arrays.particles(name)?;
    ensure!(
        points == Some(particles.len() as u64),
        "{name} announces {} points, but holds {}; write it again",
        points.unwrap_or_default(),
        particles.len()
    );
    Ok(loaded("VTK XML", particles, radius))
}

fn of_file(tag: &Tag) -> anyhow::Result<Layout> {
    let zlib = match tag.get("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => bail!(
            "compressed by {}, which is not read; write it with zlib or without compression",
            short(other)
        ),
    };
    let header = if tag.get("header_type") == Some("UInt64") { 8 } else { 4 };
    Ok(Layout { big: tag.get("byte_order") == Some("BigEndian"), header, zlib })
}

fn components(tag: &Tag) -> u64 {
    tag.get("NumberOfComponents").and_then(|k| k.parse().ok()).unwrap_or(1)
}

/// Numbers as text, up to the next tag.
fn text(xml: &mut Xml<'_>, mut target: Target, count: u64) -> anyhow::Result<Target> {
    let mut word = Vec::new();
    for k in 0..count {
        let Some(text) = xml.word(&mut word)? else {
            bail!(
                "{}: the array ends after {k} of its {count} numbers; write the file again",
                xml.place()
            )
        };
        let Some(value) = number(text) else {
            bail!(
                "{}: number {} of the array: '{}' is not a number",
                xml.place(),
                k + 1,
                shown(text)
            )
        };
        target.push(value).with_context(|| xml.place())?;
    }
    ensure!(
        xml.word(&mut word)?.is_none(),
        "{}: the array goes on after its {count} numbers; write the file again",
        xml.place()
    );
    Ok(target)
}

/// Numbers behind all tags, in the order of their offsets.
fn behind(
    xml: &mut Xml<'_>,
    raw: bool,
    layout: Layout,
    list: Vec<Appended>,
    arrays: &mut Arrays,
) -> anyhow::Result<()> {
    let (name, unpacking) = (xml.source.name, xml.source.unpacking);
    while xml.take()?.with_context(|| format!("{name} ends before its appended numbers"))? != b'_' {
    }
    let mut at = 0;
    for Appended { offset, target, kind, count } in list {
        let apart = offset.checked_sub(at).with_context(|| {
            format!("{name}: two arrays stand at the same offset; write it again")
        })?;
        ensure!(
            xml.source.skip(apart)?,
            "{name} ends before offset {offset} of its appended numbers; write it again"
        );
        at = offset;
        let what = || format!("{name}: the array at offset {offset}");
        if raw {
            let mut bytes = Counting { inner: &mut *xml.source.input, count: 0 };
            arrays.keep(
                numbers(&mut bytes, unpacking, layout, target, kind, count).with_context(what)?,
                name,
            )?;
            at += bytes.count;
        } else {
            let mut bytes = Base64::new(xml);
            arrays.keep(
                numbers(&mut bytes, unpacking, layout, target, kind, count).with_context(what)?,
                name,
            )?;
            at += bytes.letters();
        }
    }
    Ok(())
}

/// Counts the bytes that are read.
struct Counting<'a> {
    inner: &'a mut dyn BufRead,
    count: u64,
}

impl Read for Counting<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(bytes)?;
        self.count += count as u64;
        Ok(count)
    }
}

/// The numbers of one array, behind the lengths of its blocks.
fn numbers(
    bytes: &mut dyn Read,
    unpacking: &Unpacking,
    layout: Layout,
    mut target: Target,
    kind: Kind,
    count: u64,
) -> anyhow::Result<Target> {
    let wanted = count.saturating_mul(kind.width() as u64);
    let length = |bytes: &mut dyn Read| -> anyhow::Result<u64> {
        let mut word = [0; 8];
        let word = &mut word[..layout.header];
        bytes.read_exact(word).context("its length is cut off; write the file again")?;
        Ok(if layout.big {
            word.iter().fold(0, |n, &b| n << 8 | u64::from(b))
        } else {
            word.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b))
        })
    };
    let first = length(bytes)?;
    if !layout.zlib {
        ensure!(
            first == wanted,
            "it has {first} bytes, but {count} numbers take {wanted}; write the file again"
        );
        feed(bytes, &mut target, kind, layout.big, wanted)?;
        return Ok(target);
    }
    let (blocks, size, last) = (first, length(bytes)?, length(bytes)?);
    let rest = if last == 0 { size } else { last };
    let all =
        blocks.checked_sub(1).map_or(Some(0), |full| full.checked_mul(size)?.checked_add(rest));
    ensure!(
        all == Some(wanted),
        "its blocks do not hold the {wanted} bytes of its {count} numbers; write the file again"
    );
    ensure!(
        size % kind.width() as u64 == 0,
        "its blocks of {size} bytes cut through numbers; write the file again"
    );
    // As many as are there, whatever is announced.
    let mut packed = Vec::new();
    for _ in 0..blocks {
        crate::io::room::room(&mut packed)?;
        packed.push(length(bytes)?);
    }
    for (k, &packed) in packed.iter().enumerate() {
        let size = if k as u64 + 1 == blocks { rest } else { size };
        let mut block = BufReader::new(bytes.take(packed));
        feed(
            &mut unpacking.unpacked(ZlibDecoder::new(&mut block)),
            &mut target,
            kind,
            layout.big,
            size,
        )
        .with_context(|| format!("block {k}"))?;
        std::io::copy(&mut block, &mut std::io::sink()).context("cannot read it")?;
    }
    Ok(target)
}

/// Takes `left` bytes of numbers.
fn feed(
    bytes: &mut dyn Read,
    target: &mut Target,
    kind: Kind,
    big: bool,
    mut left: u64,
) -> anyhow::Result<()> {
    let mut piece = [0; 1 << 13];
    while left > 0 {
        let count = left.min(piece.len() as u64) as usize;
        bytes
            .read_exact(&mut piece[..count])
            .context("it is cut off or damaged; write the file again")?;
        for number in piece[..count].chunks_exact(kind.width()) {
            target.push(kind.get(number, big))?;
        }
        left -= count as u64;
    }
    Ok(())
}
