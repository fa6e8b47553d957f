//! Writes contacts of one or several frames to one file, one row per contact.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use super::row::{Extra, Number, Style};
use super::{PairFormat, format, whole};
use crate::formats::npy;
use contactbench_ground::periodic::ImagePair;

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
    text: Vec<u8>,
}

impl Framed<'_> {
    fn new(
        out: &mut dyn Write,
        format: PairFormat,
        numbered: bool,
        count: Option<usize>,
    ) -> Framed<'_> {
        let (names, kind, rows, text) = (None, "<u4", 0, Vec::new());
        let cannot = "cannot write the pairs";
        Framed { out, format, numbered, names, kind, cannot, count, rows, text }
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
        let form = match (self.format, self.kind) {
            (PairFormat::Npy, "<f8") => Form::F8,
            (PairFormat::Npy, "<i8") => Form::I8,
            (PairFormat::Npy, _) => Form::I4,
            _ => Form::Text,
        };
        let mut write = |contact: ImagePair| {
            before.into_iter().for_each(|frame| put(&mut self.text, form, frame));
            style.row(contact, |number| put(&mut self.text, form, number));
            if form == Form::Text {
                // In place of the comma after the last column.
                self.text.pop();
                self.text.push(b'\n');
            }
            self.rows += 1;
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

/// How a number is written.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    F8,
    I8,
    /// The low 32 bits, which are the same for signed and unsigned numbers.
    I4,
}

/// Appends a number; in text, with a comma after it.
#[inline]
fn put(out: &mut Vec<u8>, form: Form, number: Number) {
    match (form, number) {
        (Form::I4, Number::Whole(whole)) => out.extend_from_slice(&(whole as u32).to_le_bytes()),
        (Form::I8, Number::Whole(whole)) => out.extend_from_slice(&whole.to_le_bytes()),
        (Form::F8, Number::Whole(whole)) => out.extend_from_slice(&(whole as f64).to_le_bytes()),
        (Form::Text, Number::Whole(whole)) => {
            out.extend_from_slice(itoa::Buffer::new().format(whole).as_bytes());
            out.push(b',');
        }
        (Form::Text, Number::Real(real)) => out.extend(format!("{real:?},").bytes()),
        (_, Number::Real(real)) => out.extend_from_slice(&real.to_le_bytes()),
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
