//! Contacts of one frame or of several in one file: a row for each, with the number of the frame
//! before it where there are several.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use super::row::{Directed, Extra, Number, Style};
use super::{PairFormat, format, whole};
use crate::formats::npy;
use contactbench_core::periodic::ImagePair;

/// Takes the contacts of one frame after the other.
pub struct Framed<'a> {
    out: &'a mut dyn Write,
    format: PairFormat,
    /// The number of the frame stands before each row.
    numbered: bool,
    /// The columns, from the first frame on.
    names: Option<Vec<&'static str>>,
    /// The type of the numbers of npy.
    kind: &'static str,
    rows: u64,
    row: Vec<Number>,
}

impl Framed<'_> {
    fn new(out: &mut dyn Write, format: PairFormat, numbered: bool) -> Framed<'_> {
        Framed { out, format, numbered, names: None, kind: "<u4", rows: 0, row: Vec::new() }
    }

    /// Writes the contacts of a frame.
    ///
    /// # Errors
    /// Other columns than in the frame before; numbers too large for npy; those of the system.
    pub fn frame(
        &mut self,
        k: u64,
        style: &Style<'_>,
        contacts: impl Iterator<Item = ImagePair>,
    ) -> anyhow::Result<()> {
        let names = style.names();
        match &self.names {
            None => self.begin(style, &names).context("cannot write the pairs")?,
            Some(before) => ensure!(
                *before == names,
                "frame {k}: the columns are {}, and {} in the frame before: the box, or the \
                 dimension, comes and goes; give --open, or write frame by frame",
                names.join(","),
                before.join(",")
            ),
        }
        self.names = Some(names);
        let most = match self.kind {
            "<u4" => u64::from(u32::MAX),
            "<i4" => i32::MAX as u64,
            _ => 1 << 53,
        };
        ensure!(
            self.format != PairFormat::Npy || k <= most && style.len() as u64 <= most,
            "frame {k}: npy files of pairs hold numbers to {most}, and there are more frames or \
             particles; write .csv"
        );
        let before = self.numbered.then_some(Number::Whole(k as i64));
        let mut write = |contact: Directed| {
            self.row.clear();
            self.row.extend(before);
            style.row(contact, &mut self.row);
            self.rows += 1;
            row(self.out, self.format, self.kind, &self.row).context("cannot write the pairs")
        };
        if style.by_id {
            style.directed(contacts)?.into_iter().try_for_each(write)
        } else {
            contacts.map(Directed::of).try_for_each(&mut write)
        }
    }

    fn begin(&mut self, style: &Style<'_>, names: &[&str]) -> io::Result<()> {
        self.kind = match style {
            _ if style.extras.iter().any(|extra| *extra != Extra::Ids) => "<f8",
            _ if style.by_id || style.has(Extra::Ids) => "<i8",
            _ if style.images() > 0 => "<i4",
            _ => "<u4",
        };
        match self.format {
            PairFormat::Npy => Ok(()),
            _ => {
                let frame = if self.numbered { "frame," } else { "" };
                writeln!(self.out, "{frame}{}", names.join(","))
            }
        }
    }
}

/// Writes the numbers of one contact.
fn row(out: &mut dyn Write, format: PairFormat, kind: &str, row: &[Number]) -> io::Result<()> {
    for (k, &number) in row.iter().enumerate() {
        match (format, number) {
            (PairFormat::Npy, number) => match (kind, number) {
                ("<f8", Number::Whole(whole)) => out.write_all(&(whole as f64).to_le_bytes())?,
                ("<f8", Number::Real(real)) => out.write_all(&real.to_le_bytes())?,
                ("<i8", Number::Whole(whole)) => out.write_all(&whole.to_le_bytes())?,
                // The low bits are those of i32 and of u32.
                (_, Number::Whole(whole)) => out.write_all(&(whole as u32).to_le_bytes())?,
                (_, Number::Real(_)) => {}
            },
            (_, number) => {
                let comma = if k == 0 { "" } else { "," };
                match number {
                    Number::Whole(whole) => write!(out, "{comma}{whole}")?,
                    Number::Real(real) => write!(out, "{comma}{real:?}")?,
                }
            }
        }
    }
    if format == PairFormat::Npy { Ok(()) } else { out.write_all(b"\n") }
}

/// An error of the system, with the file.
pub fn of_file(error: anyhow::Error, path: &Path) -> anyhow::Error {
    match error.is::<io::Error>() {
        true => error.context(format!("cannot write {}", path.display())),
        false => error,
    }
}

/// Writes to a file whose ending, `.csv` or `.npy`, gives the format; without one CSV to standard
/// output. Rows say their frame if they are `numbered`. The file is there as a whole or not at all:
/// see [`whole`].
pub fn framed<T>(
    path: Option<&Path>,
    numbered: bool,
    body: impl FnOnce(&mut Framed<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let Some(path) = path else {
        let mut out = BufWriter::new(io::stdout().lock());
        let done = body(&mut Framed::new(&mut out, PairFormat::Csv, numbered))?;
        out.flush().context("cannot write the pairs to standard output")?;
        return Ok(done);
    };
    let cannot = || format!("cannot write {}", path.display());
    match format(path)? {
        PairFormat::Csv => {
            whole(path, |out| body(&mut Framed::new(out, PairFormat::Csv, numbered)))
                .map_err(|error| of_file(error, path))
        }
        // Its header says how many rows there are.
        PairFormat::Npy => {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let rows = tempfile::tempfile_in(folder.unwrap_or(Path::new(".")));
            let mut rows = BufWriter::with_capacity(1 << 16, rows.with_context(cannot)?);
            let mut framed = Framed::new(&mut rows, PairFormat::Npy, numbered);
            let done = body(&mut framed)?;
            let (count, kind) = (framed.rows as usize, framed.kind);
            let columns = framed.names.map_or(2, |names| names.len()) + usize::from(numbered);
            let write = |out: &mut dyn Write| -> io::Result<()> {
                let mut rows: File = rows.into_inner().map_err(|error| error.into_error())?;
                rows.rewind()?;
                npy::write_header(out, kind, count, columns)?;
                io::copy(&mut rows, out).map(drop)
            };
            whole(path, write).with_context(cannot)?;
            Ok(done)
        }
        PairFormat::Vtk => bail!(
            "{}: lines of several frames are written one by one: give --frame K, or .csv or .npy",
            path.display()
        ),
    }
}
