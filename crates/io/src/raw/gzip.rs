//! Streaming decompression, and the limit on how much a file may expand.
//!
//! **Decompression bombs.** Deflate shrinks repetitive data a thousandfold, but real coordinates to
//! a half or a tenth. A file is refused if it expands to more than [`FREE`] bytes and more than
//! [`MOST`] times its compressed bytes so far. So time and memory stay proportional to the file.
//! Nested compression and all parts of a file count together.

use std::cell::Cell;
use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
use std::io::{self, BufRead, Read};

use flate2::bufread::MultiGzDecoder;

pub(crate) const MAGIC: &[u8] = b"\x1f\x8b";
/// Maximum number of bytes unpacked per byte read.
const MOST: u64 = 200;
/// Bytes that are unpacked without a check.
const FREE: u64 = 64 << 20;

#[derive(Debug, Default)]
pub(crate) struct Unpacking {
    taken: Cell<u64>,
    given: Cell<u64>,
}

impl Unpacking {
    pub fn file<R>(&self, inner: R) -> Counted<'_, R> {
        Counted { inner, unpacking: self }
    }

    pub fn unpacked<R>(&self, inner: R) -> Unpacked<'_, R> {
        Unpacked { inner, unpacking: self }
    }

    pub fn gzip<R: BufRead>(&self, reader: R) -> Unpacked<'_, MultiGzDecoder<R>> {
        self.unpacked(MultiGzDecoder::new(reader))
    }
}

pub(crate) struct Unpacked<'a, R> {
    inner: R,
    unpacking: &'a Unpacking,
}

impl<R: Read> Read for Unpacked<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes).map_err(|error| match error.kind() {
            UnexpectedEof | InvalidInput | InvalidData => io::Error::new(
                error.kind(),
                format!(
                    "its compressed data are cut off or damaged, or other bytes follow them \
                     ({error}); copy it again, or unpack it with gunzip"
                ),
            ),
            _ => error,
        })?;
        let Unpacking { taken, given } = self.unpacking;
        given.set(given.get() + read as u64);
        if given.get() > taken.get().saturating_mul(MOST).max(FREE) {
            let bomb = format!("it unpacks to more than {MOST} times its size; unpack it first");
            return Err(io::Error::other(bomb));
        }
        Ok(read)
    }
}

pub struct Counted<'a, R> {
    inner: R,
    unpacking: &'a Unpacking,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.unpacking.taken.set(self.unpacking.taken.get() + read as u64);
        Ok(read)
    }
}
