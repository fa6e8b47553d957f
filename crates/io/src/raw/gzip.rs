//! Streaming decompression, and the limit on how much a file may expand.
//!
//! **Decompression bombs.** Deflate shrinks repetitive data a thousandfold, but real coordinates to
//! a half or a tenth. A file is refused if it expands to more than [`FREE`] bytes and more than
//! [`MOST`] times its compressed bytes so far. So time and memory stay proportional to the file.

use std::cell::Cell;
use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
use std::io::{self, BufRead, Read};

use flate2::bufread::MultiGzDecoder;

pub(crate) const MAGIC: &[u8] = b"\x1f\x8b";
/// Maximum number of bytes unpacked per byte read.
const MOST: u64 = 200;
/// Bytes that are unpacked without a check.
const FREE: u64 = 64 << 20;

pub(crate) struct Unpacked<'a, R> {
    inner: MultiGzDecoder<R>,
    taken: &'a Cell<u64>,
    given: u64,
}

impl<'a, R: BufRead> Unpacked<'a, R> {
    pub fn new(reader: R, taken: &'a Cell<u64>) -> Unpacked<'a, R> {
        Unpacked { inner: MultiGzDecoder::new(reader), taken, given: 0 }
    }
}

impl<R: BufRead> Read for Unpacked<'_, R> {
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
        self.given += read as u64;
        if self.given > self.taken.get().saturating_mul(MOST).max(FREE) {
            let bomb = format!("it unpacks to more than {MOST} times its size; unpack it first");
            return Err(io::Error::other(bomb));
        }
        Ok(read)
    }
}

/// Counts the bytes that were taken from a file.
pub(crate) struct Counted<'a, R> {
    pub inner: R,
    pub taken: &'a Cell<u64>,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.taken.set(self.taken.get() + read as u64);
        Ok(read)
    }
}
