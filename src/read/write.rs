//! Pairs of touching particles as files: CSV with the header `i,j`, and npy of shape (pairs, 2) in u32.
//!
//! Written as given: see [`crate::sink::normalise`] for the order in which lists are published.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use anyhow::{Context, bail};

type Format = fn(&mut dyn Write, &[[u32; 2]]) -> io::Result<()>;

/// Writes pairs to a file whose ending, `.csv` or `.npy`, gives the format.
pub fn pairs(path: &Path, pairs: &[[u32; 2]]) -> anyhow::Result<()> {
    let write = format(path)?;
    let create = || -> io::Result<()> {
        let mut file = BufWriter::new(File::create(path)?);
        write(&mut file, pairs)?;
        file.flush()
    };
    create().with_context(|| format!("cannot write {}", path.display()))
}

/// The format of a file of pairs, by its ending; asked before the work is done.
pub fn format(path: &Path) -> anyhow::Result<Format> {
    match path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).as_deref() {
        Some("csv") => Ok(csv),
        Some("npy") => Ok(npy),
        _ => bail!("{}: the ending of a file of pairs must be .csv or .npy", path.display()),
    }
}

/// The header `i,j`, then one pair per line.
pub fn csv(out: &mut dyn Write, pairs: &[[u32; 2]]) -> io::Result<()> {
    out.write_all(b"i,j\n")?;
    for [i, j] in pairs {
        writeln!(out, "{i},{j}")?;
    }
    Ok(())
}

/// NumPy version 1.0, '<u4', C order.
pub fn npy(out: &mut dyn Write, pairs: &[[u32; 2]]) -> io::Result<()> {
    let header = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 2), }}", pairs.len());
    // NumPy aligns the data to 64 bytes: magic, version, length and header, which blanks fill up and a newline ends.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    out.write_all(super::npy::MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(length as u16).to_le_bytes())?;
    writeln!(out, "{header:width$}", width = length - 1)?;
    for &pair in pairs {
        let [i, j] = pair.map(u32::to_le_bytes);
        out.write_all(&[i[0], i[1], i[2], i[3], j[0], j[1], j[2], j[3]])?;
    }
    Ok(())
}
