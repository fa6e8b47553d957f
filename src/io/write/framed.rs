//! Contacts of several frames in one file: rows as of one frame, with the number of the frame
//! before them.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use super::{PairFormat, format, whole};
use crate::io::formats::npy;
use crate::periodic::ImagePair;

/// Takes the contacts of one frame after the other.
pub struct Framed<'a> {
    out: &'a mut dyn Write,
    format: PairFormat,
    /// Numbers of an image in each row: none, or as many as there are dimensions.
    images: Option<usize>,
    rows: u64,
}

impl Framed<'_> {
    fn new(out: &mut dyn Write, format: PairFormat) -> Framed<'_> {
        Framed { out, format, images: None, rows: 0 }
    }

    /// Writes the contacts of a frame of so many particles. Images have as many numbers as there
    /// are dimensions, and none where boundaries are open.
    ///
    /// # Errors
    /// They have not as many as in the frame before; numbers too large for npy; those of the
    /// system.
    pub fn frame(
        &mut self,
        k: u64,
        particles: usize,
        images: usize,
        contacts: impl Iterator<Item = ImagePair>,
    ) -> anyhow::Result<()> {
        match self.images {
            None => self.begin(images).context("cannot write the pairs")?,
            Some(before) => ensure!(
                before == images,
                "frame {k}: images have {images} numbers, and {before} in the frame before: the \
                 box, or the dimension, comes and goes; give --open, or write frame by frame"
            ),
        }
        self.images = Some(images);
        let most = if images == 0 { u64::from(u32::MAX) } else { i32::MAX as u64 };
        ensure!(
            self.format != PairFormat::Npy || k <= most && particles as u64 <= most,
            "frame {k}: npy files of pairs hold numbers to {most}, and there are more frames or \
             particles; write .csv"
        );
        for contact in contacts {
            self.row(k, contact, images).context("cannot write the pairs")?;
            self.rows += 1;
        }
        Ok(())
    }

    fn begin(&mut self, images: usize) -> io::Result<()> {
        match self.format {
            PairFormat::Npy => Ok(()),
            _ => writeln!(self.out, "frame,i,j{}", &",sx,sy,sz"[..3 * images]),
        }
    }

    fn row(&mut self, k: u64, contact: ImagePair, images: usize) -> io::Result<()> {
        let ImagePair { i, j, image } = contact;
        if self.format == PairFormat::Npy {
            for number in [k as u32, i, j] {
                self.out.write_all(&number.to_le_bytes())?;
            }
            return image[..images].iter().try_for_each(|s| self.out.write_all(&s.to_le_bytes()));
        }
        write!(self.out, "{k},{i},{j}")?;
        image[..images].iter().try_for_each(|s| write!(self.out, ",{s}"))?;
        writeln!(self.out)
    }
}

/// An error of the system, with the file.
pub fn of_file(error: anyhow::Error, path: &Path) -> anyhow::Error {
    match error.is::<io::Error>() {
        true => error.context(format!("cannot write {}", path.display())),
        false => error,
    }
}

/// Writes to a file whose ending, `.csv` or `.npy`, gives the format; without one CSV to standard
/// output. The file is there as a whole or not at all: see [`whole`].
pub fn framed<T>(
    path: Option<&Path>,
    body: impl FnOnce(&mut Framed<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let Some(path) = path else {
        let mut out = BufWriter::new(io::stdout().lock());
        let done = body(&mut Framed::new(&mut out, PairFormat::Csv))?;
        out.flush().context("cannot write the pairs to standard output")?;
        return Ok(done);
    };
    let cannot = || format!("cannot write {}", path.display());
    match format(path)? {
        PairFormat::Csv => whole(path, |out| body(&mut Framed::new(out, PairFormat::Csv)))
            .map_err(|error| of_file(error, path)),
        // Its header says how many rows there are.
        PairFormat::Npy => {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let rows = tempfile::tempfile_in(folder.unwrap_or(Path::new(".")));
            let mut rows = BufWriter::with_capacity(1 << 16, rows.with_context(cannot)?);
            let mut framed = Framed::new(&mut rows, PairFormat::Npy);
            let done = body(&mut framed)?;
            let (count, images) = (framed.rows as usize, framed.images.unwrap_or(0));
            let write = |out: &mut dyn Write| -> io::Result<()> {
                let mut rows: File = rows.into_inner().map_err(|error| error.into_error())?;
                rows.rewind()?;
                let kind = if images == 0 { "<u4" } else { "<i4" };
                npy::write_header(out, kind, count, 3 + images)?;
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
