//! Reads the header of an npy array, and its numbers in blocks.

use std::io::{self, Write};

use anyhow::{Context, bail, ensure};

use crate::raw::lines::{Source, short};
use crate::raw::room::room_for;
use crate::raw::scalars::Scalar;

pub const MAGIC: &[u8] = b"\x93NUMPY";

/// Maximum length of a header in bytes; NumPy's own default is 10,000.
const LONGEST_HEADER: usize = 1 << 20;

pub fn shape(sizes: &[u64]) -> String {
    match sizes {
        [one] => format!("({one},)"),
        _ => format!("({})", sizes.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    }
}

impl Source<'_> {
    pub(crate) fn end(&mut self, header: &Header) -> anyhow::Result<()> {
        let more = self.fill(&mut [0])?;
        let (name, shape) = (self.name, shape(&header.sizes));
        ensure!(!more, "{name} goes on after the {shape} numbers that its header announces");
        Ok(())
    }
}

#[derive(Debug)]
pub(crate) struct Header {
    pub kind: Scalar,
    pub descr: String,
    pub big: bool,
    pub fortran: bool,
    /// Number of frames; `None` for an array of one or two dimensions.
    pub frames: Option<u64>,
    pub rows: u64,
    /// Number of columns; `None` for an array of one dimension.
    pub columns: Option<usize>,
    pub sizes: Vec<u64>,
    /// The numbers in C order, if they were read as a whole, and how many of them are used.
    kept: Option<(Vec<f64>, usize)>,
}

impl Header {
    pub fn count(&self) -> u64 {
        self.sizes.iter().fold(1, |count, &size| count.saturating_mul(size))
    }

    pub fn words(&self) -> String {
        let order = if self.fortran && self.sizes.len() > 1 { " in Fortran order" } else { "" };
        format!("an array of shape {} and type {}{order}", shape(&self.sizes), self.descr)
    }

    pub(super) fn of_rows(&self, frames: bool) -> anyhow::Result<()> {
        let shape = shape(&self.sizes);
        match self.sizes[..] {
            [_] | [_, _] => Ok(()),
            // Empty frames need no bytes, so a false header could announce any number of them.
            [count, rows, 2..=4] if frames && count.min(rows) > 0 => Ok(()),
            _ => bail!("the shape is {shape}; it must be that of rows: (N, 2 to 4)"),
        }
    }

    pub fn is_real(&self) -> bool {
        matches!(self.kind, Scalar::F64 | Scalar::F32)
    }

    /// Whether the numbers are stored in an order other than that of their rows.
    fn is_turned(&self) -> bool {
        self.fortran && self.sizes.len() > 1
    }

    /// Takes the rows as columns, and the columns as rows.
    pub fn transpose(&mut self) {
        self.sizes.reverse();
        self.fortran = !self.fortran;
    }

    /// Reads all numbers into memory, in C order.
    pub fn keep(&mut self, source: &mut Source<'_>) -> anyhow::Result<()> {
        let (mut all, turned) = (Vec::new(), self.is_turned());
        self.read(source, self.count(), 1, |_, numbers| {
            room_for(&mut all, numbers.len())?;
            all.extend_from_slice(numbers);
            Ok(())
        })?;
        if turned {
            let mut rows = Vec::new();
            room_for(&mut rows, all.len())?;
            rows.extend((0..all.len()).map(|k| {
                let (mut rest, mut at, mut stride) = (k, 0, all.len());
                for &size in self.sizes.iter().rev() {
                    stride /= size as usize;
                    at += rest % size as usize * stride;
                    rest /= size as usize;
                }
                all[at]
            }));
            all = rows;
        }
        self.kept = Some((all, 0));
        Ok(())
    }

    /// How many numbers a frame has.
    pub fn frame_size(&self) -> u64 {
        self.rows.saturating_mul(self.columns.unwrap_or(1) as u64)
    }

    /// Returns the numbers that were kept. The frame that is read next is number `frame`.
    pub fn kept(&mut self, frame: u64) -> &[f64] {
        let first = (frame * self.frame_size()) as usize;
        let Some((all, at)) = &mut self.kept else { return &[] };
        *at = first;
        all
    }

    pub fn values(
        &mut self,
        source: &mut Source<'_>,
        count: u64,
        mut then: impl FnMut(u64, f64) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        self.pieces(source, count, 1, |first, numbers| {
            (first..).zip(numbers).try_for_each(|(at, &number)| then(at, number))
        })
    }

    /// Calls `then` with blocks of the next `count` rows, and the index of the first row of each.
    pub fn pieces(
        &mut self,
        source: &mut Source<'_>,
        count: u64,
        columns: usize,
        mut then: impl FnMut(u64, &[f64]) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        if self.is_turned() && self.kept.is_none() {
            self.keep(source)?;
        }
        let Some((all, at)) = &mut self.kept else {
            return self.read(source, count, columns, then);
        };
        let first = std::mem::replace(at, *at + count as usize * columns);
        then(0, &all[first..*at])
    }

    /// Because of the blocks, a false shape cannot reserve more memory than the file has bytes.
    fn read(
        &self,
        source: &mut Source<'_>,
        count: u64,
        columns: usize,
        mut then: impl FnMut(u64, &[f64]) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let row = columns * self.kind.width();
        let most = ((1 << 16) / row).max(1) as u64;
        let (mut piece, mut numbers) = (vec![0; most as usize * row], Vec::new());
        let mut first = 0;
        while first < count {
            let rows = (count - first).min(most);
            let bytes = &mut piece[..rows as usize * row];
            if !source.fill(bytes)? {
                let (name, shape) = (source.name, shape(&self.sizes));
                bail!("{name} ends before the {shape} numbers that its header announces");
            }
            numbers.clear();
            match (self.kind, self.big) {
                (Scalar::F64, false) => {
                    let words = bytes.as_chunks().0;
                    numbers.extend(words.iter().map(|word| f64::from_le_bytes(*word)));
                }
                (kind, big) => {
                    let words = bytes.chunks_exact(kind.width());
                    numbers.extend(words.map(|word| kind.get(word, big)));
                }
            }
            then(first, &numbers)?;
            first += rows;
        }
        Ok(())
    }
}

pub fn header(source: &mut Source<'_>) -> anyhow::Result<Header> {
    let header = any_header(source)?;
    header.of_rows(false).with_context(|| source.name.to_string())?;
    Ok(header)
}

pub(crate) fn any_header(source: &mut Source<'_>) -> anyhow::Result<Header> {
    let name = source.name;
    let mut need = |bytes: &mut [u8]| match source.fill(bytes) {
        Ok(true) => Ok(()),
        Ok(false) => bail!("{name}: the npy header is cut off; write the file again"),
        Err(error) => Err(error),
    };
    let mut start = [0; 8];
    need(&mut start)?;
    let is_npy = start.starts_with(MAGIC);
    ensure!(is_npy, "{name} is not a NumPy file: it does not begin with \\x93NUMPY");
    let wide = match start[6] {
        1 => 2,
        2 | 3 => 4,
        version => bail!("{name} is npy version {version}; versions 1 to 3 are read"),
    };
    let mut length = [0; 4];
    need(&mut length[..wide])?;
    let length = u32::from_le_bytes(length) as usize;
    ensure!(length <= LONGEST_HEADER, "{name}: the npy header has {length} bytes, too many");
    let mut text = vec![0; length];
    need(&mut text)?;
    let text = String::from_utf8_lossy(&text).to_string();
    parse(&text).with_context(|| format!("{name}: npy header {}", short(text.trim())))
}

pub(crate) fn write_header(
    out: &mut dyn Write,
    kind: &str,
    rows: usize,
    columns: usize,
) -> io::Result<()> {
    let shape = format!("({rows}, {columns})");
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // The data start at a multiple of 64 bytes, after magic, version, length and a header padded
    // with blanks.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(length as u16).to_le_bytes())?;
    writeln!(out, "{header:width$}", width = length - 1)
}

/// Parses the Python dictionary of the header, such as `{'descr': '<f8', 'fortran_order': False,
/// 'shape': (10, 3), }`.
fn parse(text: &str) -> anyhow::Result<Header> {
    let value = |key: &str| -> anyhow::Result<&str> {
        let find = |quoted: &String| text.find(quoted.as_str()).map(|at| at + quoted.len());
        let at = [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(find);
        let rest = text[at.with_context(|| format!("it has no '{key}'"))?..].trim_start();
        Ok(rest.strip_prefix(':').with_context(|| format!("'{key}' has no value"))?.trim_start())
    };
    let descr = value("descr")?;
    let fields = descr.starts_with('[');
    ensure!(!fields, "the array has fields; save numpy.column_stack([a['x'], a['y'], a['z']])");
    let descr = short(descr.split(',').next().unwrap_or_default());
    let kind = kind_of(descr.trim_matches(['\'', '"']));
    let (kind, big) =
        kind.with_context(|| format!("the type {descr} is not read; convert with .astype('f8')"))?;
    let order = value("fortran_order")?;
    let fortran = order.starts_with("True");
    ensure!(fortran || order.starts_with("False"), "fortran_order is neither True nor False");
    let shape = value("shape")?
        .strip_prefix('(')
        .and_then(|rest| rest.split_once(')'))
        .map(|(shape, _)| shape);
    let shape = short(shape.context("the shape is not of the form (N, 3)")?);
    let sizes: Option<Vec<u64>> = shape
        .split(',')
        .map(str::trim)
        .filter(|size| !size.is_empty())
        .map(|size| size.parse().ok())
        .collect();
    let sizes = sizes.with_context(|| {
        format!("the shape is ({shape}); it must be that of rows, as (N, 3), in whole numbers")
    })?;
    let narrow = |columns: u64| usize::try_from(columns).unwrap_or(usize::MAX);
    let (frames, rows, columns) = match sizes[..] {
        [] => (None, 1, None),
        [rows] => (None, rows, None),
        [rows, columns] => (None, rows, Some(narrow(columns))),
        [frames, rows, columns, ..] => (Some(frames), rows, Some(narrow(columns))),
    };
    let kept = None;
    Ok(Header { kind, descr, big, fortran, frames, rows, columns, sizes, kept })
}

/// Returns the number type of a `descr` such as `<f8`, and whether it is big-endian.
fn kind_of(descr: &str) -> Option<(Scalar, bool)> {
    let kind = Scalar::coded(descr.get(1..)?)?;
    match descr.as_bytes()[0] {
        // Single bytes have no byte order.
        b'<' | b'|' => Some((kind, false)),
        b'>' => Some((kind, true)),
        _ => None,
    }
}
