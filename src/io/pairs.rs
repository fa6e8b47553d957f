//! Contact lists that other codes wrote: CSV, npy, MercuryDPM `.fstat`, LAMMPS dump local.
//!
//! A list names particles by numbers, whose meaning is the caller's business: indices from 0 or 1,
//! or the ids of the particles' file.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use crate::io::Frame;
use crate::io::formats::gzip::{self, Unpacking};
use crate::io::formats::npy;
use crate::io::frames::{Frames, Step};
use crate::io::lines::{Lines, Separator, Source, number, shown};
use crate::io::particles::room;
use crate::sink::splitmix64;

mod columns;
mod list;
use columns::Columns;
pub use columns::Other;
pub use list::{List, columns_of};

/// Reads a contact list. `columns` names those of a LAMMPS dump or a CSV that hold the numbers:
/// none, the two of the particles, or these and the two or three of the image.
pub fn read(path: &Path, columns: &[&str], frame: Frame) -> anyhow::Result<List> {
    let name = path.display().to_string();
    let file = File::open(path).with_context(|| format!("cannot read {name}"))?;
    from(BufReader::with_capacity(1 << 17, file), &name, columns, frame)
}

/// As [`read`], from a stream.
pub fn from(
    reader: impl BufRead,
    name: &str,
    columns: &[&str],
    frame: Frame,
) -> anyhow::Result<List> {
    ensure!(
        matches!(columns.len(), 0 | 2 | 4 | 5),
        "--pairs-columns takes the two columns of the particles, and those of the image where \
         there is one, with commas between: I,J or I,J,SX,SY or I,J,SX,SY,SZ"
    );
    let unpacking = &Unpacking::default();
    let mut reader = unpacking.file(reader);
    let mut head = Vec::new();
    (&mut reader)
        .take(4096)
        .read_to_end(&mut head)
        .with_context(|| format!("cannot read {name}"))?;
    let mut reader = std::io::Cursor::new(&head[..]).chain(reader);
    if head.starts_with(gzip::MAGIC) {
        let mut unpacked = BufReader::with_capacity(1 << 17, unpacking.gzip(reader));
        let mut inner = Vec::new();
        (&mut unpacked)
            .take(4096)
            .read_to_end(&mut inner)
            .with_context(|| format!("cannot read {name}"))?;
        let input = &mut std::io::Cursor::new(&inner[..]).chain(unpacked);
        return plain(Source { input, name, unpacking }, &inner, columns, frame);
    }
    plain(Source { input: &mut reader, name, unpacking }, &head, columns, frame)
}

fn plain(source: Source<'_>, head: &[u8], columns: &[&str], frame: Frame) -> anyhow::Result<List> {
    let name = source.name;
    if head.starts_with(npy::MAGIC) {
        return array(source);
    }
    ensure!(
        !head.contains(&0),
        "{name} is binary, and no npy file; write the pairs as CSV with a header i,j"
    );
    if head.starts_with(b"ITEM:") {
        return dump_local(Lines::new(source), columns, frame);
    }
    // MercuryDPM writes three lines that begin with #, then lines of 14 numbers.
    let mut data = head
        .split(|&b| b == b'\n')
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    if head.starts_with(b"#")
        && data.next().is_some_and(|line| crate::io::lines::words(line).count() >= 13)
        || name.ends_with(".fstat")
    {
        return fstat(Lines::new(source), frame);
    }
    csv(Lines::new(source), columns)
}

fn push(list: &mut List, pair: [i64; 2]) -> anyhow::Result<()> {
    room(&mut list.pairs)?;
    list.pairs.push(pair);
    Ok(())
}

/// A whole number; some programs write it as 12.0.
fn whole(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    // An exponent is the mark of %g, which keeps six digits of a number.
    let plain = !cell.iter().any(|c| matches!(c, b'e' | b'E'));
    text.parse().ok().or_else(|| {
        number(cell).filter(|x| plain && x.fract() == 0.0 && x.abs() < 9e15).map(|x| x as i64)
    })
}

fn cell(lines: &Lines<'_>, cells: &[&[u8]], k: usize) -> anyhow::Result<i64> {
    let found = cells.get(k).copied().unwrap_or_default();
    whole(found).with_context(|| {
        format!(
            "{}: column {}: '{}' is not the number of a particle",
            lines.place(),
            k + 1,
            shown(found)
        )
    })
}

fn array(mut source: Source<'_>) -> anyhow::Result<List> {
    let header = npy::header(&mut source)?;
    let name = source.name;
    let columns = header.columns.filter(|columns| [2, 4, 5].contains(columns));
    let Some(columns) = columns.filter(|_| !header.fortran) else {
        bail!(
            "{name}: the shape is ({}); pairs have the shape (pairs, 2), with images in a box \
             (pairs, 4) for discs and (pairs, 5) for spheres, in C order",
            header.shape
        );
    };
    let mut list = List { format: "npy", ..List::default() };
    list.images = (columns > 2).then(Vec::new);
    list.flat = columns == 4;
    let mut row = [0; 5];
    header.values(&mut source, header.rows.saturating_mul(columns as u64), |k, value| {
        let (pair, column) = (k / columns as u64, (k % columns as u64) as usize);
        ensure!(
            value.fract() == 0.0 && value.abs() < 9e15,
            "{name}: pair {pair}: {value} is not the number of {}",
            if column < 2 { "a particle" } else { "an image" }
        );
        row[column] = value as i64;
        if column + 1 < columns {
            return Ok(());
        }
        if let Some(images) = &mut list.images {
            room(images)?;
            images.push(image([row[2], row[3], row[4]], || format!("{name}: pair {pair}"))?);
        }
        push(&mut list, [row[0], row[1]])
    })?;
    source.end(&header)?;
    Ok(list)
}

/// Images are numbered in 32 bits.
fn image(numbers: [i64; 3], place: impl Fn() -> String) -> anyhow::Result<[i32; 3]> {
    let mut image = [0; 3];
    for (image, number) in image.iter_mut().zip(numbers) {
        *image = i32::try_from(number).ok().with_context(|| {
            format!("{}: {number} is not the number of an image: below 2^31", place())
        })?;
    }
    Ok(image)
}

/// Two columns of whole numbers, and those of images: by a header, which may be a comment, or the
/// first ones.
fn csv(mut lines: Lines<'_>, chosen: &[&str]) -> anyhow::Result<List> {
    let mut list = List { format: "CSV", ..List::default() };
    let mut layout: Option<(Separator, Columns)> = None;
    while lines.advance()? {
        let line = lines.line();
        let comment = line.strip_prefix(b"#").map(<[u8]>::trim_ascii);
        if line.is_empty() || comment.is_some() && layout.is_some() {
            continue;
        }
        let line = comment.unwrap_or(line);
        let separator = layout.as_ref().map_or_else(|| Separator::guess(line), |layout| layout.0);
        let cells: Vec<&[u8]> = separator.cells(line).collect();
        if let Some((_, columns)) = &mut layout {
            columns.push(&lines, &cells, &mut list)?;
            continue;
        }
        let names: Vec<String> =
            cells.iter().map(|cell| String::from_utf8_lossy(cell).into_owned()).collect();
        if comment.is_some() {
            let header = cells.iter().all(|cell| number(cell).is_none());
            if let (true, Ok(Some(columns))) =
                (header, Columns::named(&names, chosen, || lines.place()))
            {
                layout = Some((separator, columns));
            }
            continue;
        }
        ensure!(cells.len() >= 2, "{}: a pair needs two columns; write i,j", lines.place());
        let header = cells.iter().take(2).any(|cell| number(cell).is_none());
        let numbers = || (1..=cells.len()).map(|k| k.to_string()).collect();
        let names = if header { names } else { numbers() };
        let named = Columns::named(&names, chosen, || lines.place())?;
        ensure!(
            named.is_some() || !header || cells.len() == 2,
            "{}: which columns hold the numbers of a pair? Name them with --pairs-columns I,J",
            lines.place()
        );
        let mut columns = named.unwrap_or_else(|| Columns::bare(cells.len()));
        if !header {
            columns.push(&lines, &cells, &mut list)?;
        }
        layout = Some((separator, columns));
    }
    if let Some((_, columns)) = layout {
        columns.end(&mut list);
    }
    Ok(list)
}

/// `time i j x y z overlap ...`, indices from 0, walls negative; each contact of two particles from
/// both sides.
fn fstat(mut lines: Lines<'_>, frame: Frame) -> anyhow::Result<List> {
    let mut frames = Frames::new(crate::io::Options { frame, ..crate::io::Options::default() });
    let mut list = List { format: "MercuryDPM fstat", ..List::default() };
    let (mut in_header, mut step) = (false, Step::Keep);
    while lines.advance_over_blanks()? {
        if lines.line().starts_with(b"#") {
            if !in_header {
                step = frames.begin(|| lines.place())?;
                if step == Step::Stop {
                    break;
                }
                if step == Step::Keep {
                    list = List { format: list.format, ..List::default() };
                }
            }
            in_header = true;
            continue;
        }
        in_header = false;
        if step != Step::Keep {
            continue;
        }
        let cells: Vec<&[u8]> = crate::io::lines::words(lines.line()).collect();
        ensure!(
            cells.len() >= 13,
            "{}: {} columns; lines of an .fstat file have 14: is it cut off?",
            lines.place(),
            cells.len()
        );
        let pair = [cell(&lines, &cells, 1)?, cell(&lines, &cells, 2)?];
        if pair.iter().any(|&k| k < 0) {
            list.walls += 1;
        } else {
            push(&mut list, pair)?;
        }
    }
    if let Frame::Number(_) = frame {
        frames.end(lines.source.name, crate::io::About::default())?;
    }
    // Where all are there from both sides, one side is taken: then fingerprints of the pairs as
    // they stand and of the pairs turned round are the same, whatever their order.
    let mix = |i: i64, j: i64| splitmix64(splitmix64(i as u64) ^ j as u64);
    let sum = |sum: [u64; 2], &[i, j]: &[i64; 2]| {
        [sum[0].wrapping_add(mix(i, j)), sum[1].wrapping_add(mix(j, i))]
    };
    let [there, back] = list.pairs.iter().fold([0; 2], sum);
    list.both_sides = there == back && !list.pairs.is_empty();
    if list.both_sides {
        list.pairs.retain(|[i, j]| i <= j);
    }
    Ok(list)
}

/// `ITEM: ENTRIES` of a LAMMPS dump local.
fn dump_local(mut lines: Lines<'_>, chosen: &[&str], frame: Frame) -> anyhow::Result<List> {
    let mut frames = Frames::new(crate::io::Options { frame, ..crate::io::Options::default() });
    let mut list = List { format: "LAMMPS dump local", ids: true, ..List::default() };
    let (mut n, mut open) = (None, false);
    while lines.advance_over_blanks()? {
        let (text, place) = (lines.text(), lines.place());
        let Some(item) = text.strip_prefix("ITEM:").map(str::trim) else {
            bail!(
                "{place}: '{}' stands where a line 'ITEM: ...' is expected; mend the file",
                crate::io::lines::short(&text)
            );
        };
        // The header of a frame has begun, and its entries have not come.
        open = !item.starts_with("ENTRIES");
        if item.starts_with("NUMBER OF") {
            ensure!(
                lines.advance()?,
                "{} is cut off in a header; write it again",
                lines.source.name
            );
            n = Some(lines.count(lines.line(), "the number of entries")?);
        } else if item.starts_with("BOX BOUNDS") {
            for _ in 0..3 {
                lines.advance()?;
            }
        } else if let Some(names) = item.strip_prefix("ENTRIES") {
            let names: Vec<String> = names.split_whitespace().map(str::to_string).collect();
            let named = Columns::named(&names, chosen, || place.clone())?;
            let mut columns = named.with_context(|| {
                format!(
                    "{place}: which columns hold the ids of a pair? Name them with --pairs-columns \
                     I,J; there are {}",
                    crate::io::lines::listed(&names)
                )
            })?;
            let n = n.take().with_context(|| {
                format!("{place}: no 'ITEM: NUMBER OF ENTRIES' stands before the entries")
            })?;
            let step = frames.begin(|| lines.place())?;
            if step == Step::Stop {
                break;
            }
            if step == Step::Keep {
                list.pairs.clear();
                list.images = None;
            }
            for k in 0..n {
                ensure!(
                    lines.advance()?,
                    "{} ends after {k} of the {n} entries that its header announces",
                    lines.source.name
                );
                if step == Step::Keep {
                    let cells: Vec<&[u8]> = crate::io::lines::words(lines.line()).collect();
                    columns.push(&lines, &cells, &mut list)?;
                }
            }
            if step == Step::Keep {
                columns.end(&mut list);
            }
        } else {
            ensure!(
                !item.starts_with("ATOMS"),
                "{place}: this is a dump of atoms, not of pairs; write pairs with dump local"
            );
            lines.advance()?;
        }
    }
    let name = lines.source.name;
    let about = frames.end(name, crate::io::About::default())?;
    ensure!(about.frames > 0, "{name} ends before a section 'ITEM: ENTRIES'; write it again");
    ensure!(
        !open,
        "{name} is cut off in the header of a frame; write it again, or take an earlier \
         --pairs-frame"
    );
    Ok(list)
}
