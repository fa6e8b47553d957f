//! Writes contacts of one or several frames to one file, one row per contact.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use anyhow::{bail, ensure};

use super::row::{Extra, Number, Style};
use super::{PairFormat, format, whole};
use crate::formats::npy;
use contactbench_ground::periodic::ImagePair;

pub struct Framed<'a> {
    out: &'a mut dyn Write,
    is_text: bool,
    numbered: bool,
    /// The columns; `None` before the first frame.
    names: Option<Vec<&'static str>>,
    form: Form,
    rows: usize,
}

impl Framed<'_> {
    fn new(out: &mut dyn Write, is_text: bool, numbered: bool) -> Framed<'_> {
        Framed { out, is_text, numbered, names: None, form: Form::U4, rows: 0 }
    }

    pub fn frame(
        &mut self,
        k: u64,
        style: &Style<'_>,
        contacts: impl Iterator<Item = ImagePair>,
    ) -> anyhow::Result<()> {
        let names = style.names();
        match &self.names {
            None if self.is_text => {
                let frame = if self.numbered { "frame," } else { "" };
                self.form = Form::Text;
                writeln!(self.out, "{frame}{}", names.join(","))?;
            }
            None => self.form = Form::of(style),
            Some(before) => {
                ensure!(
                    *before == names,
                    "frame {k}: the columns are {}, and {} in the frame before; give --open",
                    names.join(","),
                    before.join(",")
                );
            }
        }
        self.names = Some(names);
        let most = self.form.npy().1;
        ensure!(
            self.is_text || k <= most && style.scene.len() as u64 <= most,
            "frame {k}: npy files of pairs hold numbers to {most}; write .csv"
        );
        let mut row = Vec::new();
        let mut write = |contact: ImagePair| {
            row.clear();
            if self.numbered {
                put(&mut row, self.form, Number::Whole(k as i64));
            }
            style.row(contact, |number| put(&mut row, self.form, number));
            if self.is_text {
                // In place of the comma after the last column.
                row.pop();
                row.push(b'\n');
            }
            self.rows += 1;
            self.out.write_all(&row)
        };
        match style.by_id {
            true => style.directed(contacts)?.into_iter().try_for_each(write)?,
            false => contacts.into_iter().try_for_each(&mut write)?,
        }
        Ok(())
    }
}

/// How numbers are written: as text, or as a type of npy.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    U4,
    I4,
    I8,
    F8,
}

impl Form {
    fn of(style: &Style<'_>) -> Form {
        match style {
            _ if style.extras.iter().any(|it| matches!(it, Extra::Overlap | Extra::Normal)) => {
                Form::F8
            }
            _ if style.by_id || !style.extras.is_empty() => Form::I8,
            _ if style.images() > 0 => Form::I4,
            _ => Form::U4,
        }
    }

    /// The type in the header, and the largest whole number that it holds exactly in f64, too.
    fn npy(self) -> (&'static str, u64) {
        match self {
            Form::U4 => ("<u4", u32::MAX.into()),
            Form::I4 => ("<i4", i32::MAX as u64),
            Form::I8 => ("<i8", 1 << 53),
            Form::F8 | Form::Text => ("<f8", 1 << 53),
        }
    }
}

/// Appends a number; in text, with a comma after it.
#[inline]
fn put(out: &mut Vec<u8>, form: Form, number: Number) {
    match (form, number) {
        // Writing to a Vec cannot fail.
        (Form::Text, Number::Whole(whole)) => _ = write!(out, "{whole},"),
        (Form::Text, Number::Real(real)) => _ = write!(out, "{real:?},"),
        // The low 32 bits are the same for signed and unsigned numbers.
        (Form::U4 | Form::I4, Number::Whole(whole)) => out.extend((whole as u32).to_le_bytes()),
        (Form::I8, Number::Whole(whole)) => out.extend(whole.to_le_bytes()),
        (Form::F8, Number::Whole(whole)) => out.extend((whole as f64).to_le_bytes()),
        (_, Number::Real(real)) => out.extend(real.to_le_bytes()),
    }
}

/// Names the file in an error of writing.
pub fn of_file(error: anyhow::Error, path: &Path) -> anyhow::Error {
    match error.is::<io::Error>() {
        true => error.context(format!("cannot write {}", path.display())),
        false => error,
    }
}

/// Writes to a file whose ending gives the format, `.csv` or `.npy`; without a path, writes CSV to
/// standard output. Rows contain their frame if `numbered`. The file is replaced only when
/// complete; see [`whole`].
pub fn framed<T>(
    path: Option<&Path>,
    numbered: bool,
    body: impl FnOnce(&mut Framed<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let Some(path) = path else {
        let mut out = BufWriter::new(io::stdout().lock());
        let done = body(&mut Framed::new(&mut out, true, numbered));
        let done = done.and_then(|done| Ok(out.flush().map(|()| done)?));
        return done.map_err(|error| of_file(error, Path::new("the pairs to standard output")));
    };
    let done = match format(path)? {
        PairFormat::Csv => whole(path, |out| body(&mut Framed::new(out, true, numbered))),
        // The npy header contains the number of rows, so rows go to a temporary file first.
        PairFormat::Npy => whole(path, |out| {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let rows = tempfile::tempfile_in(folder.unwrap_or(Path::new(".")))?;
            let mut rows = BufWriter::with_capacity(1 << 16, rows);
            let mut framed = Framed::new(&mut rows, false, numbered);
            let done = body(&mut framed)?;
            let columns = framed.names.map_or(2, |names| names.len()) + usize::from(numbered);
            npy::write_header(out, framed.form.npy().0, framed.rows, columns)?;
            let mut rows: File = rows.into_inner().map_err(|error| error.into_error())?;
            rows.rewind()?;
            io::copy(&mut rows, out)?;
            Ok(done)
        }),
        PairFormat::Vtk => bail!("{}: give --frame K, or .csv or .npy", path.display()),
    };
    done.map_err(|error| of_file(error, path))
}
