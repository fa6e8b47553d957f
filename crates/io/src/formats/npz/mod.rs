//! NumPy npz: a zip archive of arrays, as `numpy.savez` and `numpy.savez_compressed` write it, read
//! from front to back.
//!
//! The particles are given in one of these forms, with or without an array of radii and a
//! [box](boxes):
//!
//! * one-dimensional arrays `x`, `y`, `z`, and `r`, `radius`, `radii`, `d`, `diameter` or
//!   `diameters`;
//! * one array of shape (N, 2) to (N, 4), or (frames, N, 2) to (frames, N, 4), as in
//!   [`crate::formats::npy`].
//!
//! Other arrays are skipped.

mod boxes;
mod scenes;

use std::io::{BufRead, BufReader, Read};

use anyhow::{Context, bail, ensure};
use flate2::bufread::DeflateDecoder;

use crate::raw::lines::{Source, short};
pub use scenes::frames;

struct Local {
    name: String,
    method: u16,
    /// Size in the archive, in bytes; `None` if it follows the data.
    size: Option<u64>,
    wide: bool,
}

pub fn members(
    source: &mut Source<'_>,
    mut member: impl FnMut(Source<'_>, &str) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    while let Some(local) = local(source)? {
        let name = format!("{}: {}", source.name, short(&local.name));
        let mut input: Box<dyn BufRead + '_> = match (local.method, local.size) {
            (0, Some(size)) => Box::new(Read::take(&mut *source.input, size)),
            (8, _) => {
                let unpacked = DeflateDecoder::new(&mut *source.input);
                Box::new(BufReader::with_capacity(1 << 16, source.unpacking.unpacked(unpacked)))
            }
            (0, None) => {
                bail!("{name}: stored without its size; write the archive to a file, not to a pipe")
            }
            (method, _) => {
                bail!("{name}: compressed by method {method}; write it with numpy.savez")
            }
        };
        let of_member = Source { input: &mut input, name: &name, unpacking: source.unpacking };
        member(of_member, &local.name)?;
        let rest = std::io::copy(&mut input, &mut std::io::sink());
        rest.with_context(|| format!("cannot read {name}"))?;
        drop(input);
        if local.size.is_none() {
            descriptor(source, local.wide)?;
        }
    }
    Ok(())
}

fn local(source: &mut Source<'_>) -> anyhow::Result<Option<Local>> {
    let name = source.name;
    let torn = || format!("{name}: the zip archive is cut off; write it again");
    let mut start = [0; 4];
    // The central directory follows the files. Without it the archive is cut off, and arrays may be
    // missing.
    ensure!(source.fill(&mut start)?, torn());
    if matches!(&start, b"PK\x01\x02" | b"PK\x05\x06" | b"PK\x06\x06") {
        return Ok(None);
    }
    ensure!(&start == b"PK\x03\x04", "{name}: no file begins where the zip archive has one");
    let mut fixed = [0; 26];
    ensure!(source.fill(&mut fixed)?, torn());
    let short_at = |k: usize| u16::from_le_bytes([fixed[k], fixed[k + 1]]);
    let long_at = |k: usize| {
        u64::from(u32::from_le_bytes([fixed[k], fixed[k + 1], fixed[k + 2], fixed[k + 3]]))
    };
    let (flags, method, mut size) = (short_at(2), short_at(4), long_at(14));
    ensure!(flags & 1 == 0, "{name}: the zip archive is encrypted; write it without a password");
    let mut label = vec![0; usize::from(short_at(22))];
    let mut extra = vec![0; usize::from(short_at(24))];
    ensure!(source.fill(&mut label)? && source.fill(&mut extra)?, torn());
    let mut wide = false;
    let mut rest = &extra[..];
    while let Some((&[a, b, c, d], after)) = rest.split_first_chunk() {
        let (id, length) = (u16::from_le_bytes([a, b]), usize::from(u16::from_le_bytes([c, d])));
        let Some(field) = after.get(..length) else { break };
        if id == 1 {
            wide = true;
            // The field has the uncompressed size, then the compressed size.
            if let (true, Some(&bytes)) =
                (size == u64::from(u32::MAX), field.get(8..).and_then(|field| field.first_chunk()))
            {
                size = u64::from_le_bytes(bytes);
            }
        }
        rest = &after[length..];
    }
    let size = (flags & 8 == 0).then_some(size);
    Ok(Some(Local { name: String::from_utf8_lossy(&label).into_owned(), method, size, wide }))
}

fn descriptor(source: &mut Source<'_>, wide: bool) -> anyhow::Result<()> {
    let mut start = [0; 4];
    let whole = source.fill(&mut start)?;
    let signed = &start == b"PK\x07\x08";
    let length = if wide { 20 } else { 12 } - if signed { 0 } else { 4 };
    let whole = whole && source.skip(length)?;
    ensure!(whole, "{}: the zip archive is cut off; write it again", source.name);
    Ok(())
}
