//! Writes contacts of one or several frames to one file, one row per contact.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use super::row::{Extra, Number, Style};
use super::{PairFormat, format, whole};
use crate::formats::npy;
use contactbench_core::periodic::ImagePair;

pub struct Framed<'a> {
    out: &'a mut dyn Write,
    format: PairFormat,
    numbered: bool,
    /// The columns; `None` before the first frame.
    names: Option<Vec<&'static str>>,
    kind: &'static str,
    cannot: &'static str,
    /// Number of rows, if known in advance.
    count: Option<usize>,
    rows: usize,
    row: Vec<Number>,
    text: Vec<u8>,
}

impl Framed<'_> {
    fn new(
        out: &mut dyn Write,
        format: PairFormat,
        numbered: bool,
        count: Option<usize>,
    ) -> Framed<'_> {
        let (names, kind, rows, row, text) = (None, "<u4", 0, Vec::new(), Vec::new());
        let cannot = "cannot write the pairs";
        Framed { out, format, numbered, names, kind, cannot, count, rows, row, text }
    }

    pub fn frame(
        &mut self,
        k: u64,
        style: &Style<'_>,
        contacts: impl Iterator<Item = ImagePair>,
    ) -> anyhow::Result<()> {
        let names = style.names();
        match &self.names {
            None => self.begin(style, &names).context(self.cannot)?,
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
            self.format != PairFormat::Npy || k <= most && style.scene.len() as u64 <= most,
            "frame {k}: npy files of pairs hold numbers to {most}, and there are more frames or \
             particles; write .csv"
        );
        let before = self.numbered.then_some(Number::Whole(k as i64));
        let mut write = |contact: ImagePair| {
            self.row.clear();
            self.row.extend(before);
            style.row(contact, &mut self.row);
            self.rows += 1;
            row(&mut self.text, self.format, self.kind, &self.row);
            if self.text.len() < 1 << 16 {
                return Ok(());
            }
            let written = self.out.write_all(&self.text);
            self.text.clear();
            written.context(self.cannot)
        };
        match style.by_id {
            true => style.directed(contacts)?.into_iter().try_for_each(write)?,
            false => contacts.into_iter().try_for_each(&mut write)?,
        }
        let written = self.out.write_all(&self.text);
        self.text.clear();
        written.context(self.cannot)
    }

    fn begin(&mut self, style: &Style<'_>, names: &[&str]) -> io::Result<()> {
        self.kind = match style {
            _ if style.extras.iter().any(|extra| *extra != Extra::Ids) => "<f8",
            _ if style.by_id || style.has(Extra::Ids) => "<i8",
            _ if style.images() > 0 => "<i4",
            _ => "<u4",
        };
        let frame = if self.numbered { "frame," } else { "" };
        match (self.format, self.count) {
            (PairFormat::Npy, None) => Ok(()),
            (PairFormat::Npy, Some(count)) => {
                npy::write_header(self.out, self.kind, count, names.len())
            }
            _ => writeln!(self.out, "{frame}{}", names.join(",")),
        }
    }
}

fn row(out: &mut Vec<u8>, format: PairFormat, kind: &str, row: &[Number]) {
    for (k, &number) in row.iter().enumerate() {
        match (format, kind, number) {
            (PairFormat::Npy, "<f8", Number::Whole(whole)) => {
                out.extend((whole as f64).to_le_bytes())
            }
            (PairFormat::Npy, _, Number::Real(real)) => out.extend(real.to_le_bytes()),
            (PairFormat::Npy, "<i8", Number::Whole(whole)) => out.extend(whole.to_le_bytes()),
            // The low 32 bits are the same for i32 and u32.
            (PairFormat::Npy, _, Number::Whole(whole)) => out.extend((whole as u32).to_le_bytes()),
            (_, _, number) => {
                out.extend((k > 0).then_some(b','));
                match number {
                    Number::Whole(whole) => {
                        out.extend_from_slice(itoa::Buffer::new().format(whole).as_bytes());
                    }
                    Number::Real(real) => out.extend(format!("{real:?}").bytes()),
                }
            }
        }
    }
    if format != PairFormat::Npy {
        out.push(b'\n');
    }
}

pub fn of_file(error: anyhow::Error, path: &Path) -> anyhow::Error {
    match error.is::<io::Error>() {
        true => error.context(format!("cannot write {}", path.display())),
        false => error,
    }
}

/// Writes to a file whose ending gives the format, `.csv` or `.npy`; without a path, writes CSV to
/// standard output. Rows contain their frame if `numbered`; `count` is the number of rows, if
/// known. The file is replaced only when complete; see [`whole`].
pub fn framed<T>(
    path: Option<&Path>,
    numbered: bool,
    count: Option<usize>,
    body: impl FnOnce(&mut Framed<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let Some(path) = path else {
        let mut out = BufWriter::new(io::stdout().lock());
        let mut framed = Framed::new(&mut out, PairFormat::Csv, numbered, None);
        framed.cannot = "cannot write the pairs to standard output";
        let (done, cannot) = (body(&mut framed)?, framed.cannot);
        out.flush().context(cannot)?;
        return Ok(done);
    };
    let cannot = || format!("cannot write {}", path.display());
    match format(path)? {
        format if format == PairFormat::Csv || count.is_some() && format == PairFormat::Npy => {
            whole(path, |out| body(&mut Framed::new(out, format, numbered, count)))
                .map_err(|error| of_file(error, path))
        }
        // The npy header contains the number of rows, so rows go to a temporary file first.
        PairFormat::Csv | PairFormat::Npy => {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let rows = tempfile::tempfile_in(folder.unwrap_or(Path::new(".")));
            let mut rows = BufWriter::with_capacity(1 << 16, rows.with_context(cannot)?);
            let mut framed = Framed::new(&mut rows, PairFormat::Npy, numbered, None);
            let done = body(&mut framed)?;
            let (count, kind) = (framed.rows, framed.kind);
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
