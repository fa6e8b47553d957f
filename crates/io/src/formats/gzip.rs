//! gzip, as people compress dumps with it: unpacked while it is read. And what holds for everything
//! that is unpacked.
//!
//! **Bombs.** Deflate makes a thousand times less of what repeats itself. Coordinates do not: real
//! files shrink to a half or a tenth. Where more than [`MOST`] times the bytes that the file had so
//! far are made of it, beyond [`FREE`] bytes, it is refused, so that time and memory stay in
//! proportion to the file. What is unpacked within something unpacked counts as well, and all parts
//! of a file count together: neither layers nor many small parts make more of it.

use std::cell::Cell;
use std::io::{self, BufRead, Read};

use flate2::bufread::MultiGzDecoder;

pub(crate) const MAGIC: &[u8] = b"\x1f\x8b";
/// Most bytes unpacked for each byte read.
const MOST: u64 = 200;
/// Bytes unpacked before anybody asks.
const FREE: u64 = 64 << 20;

/// How much was read of a file, and how much was unpacked from it.
#[derive(Debug, Default)]
pub(crate) struct Unpacking {
    taken: Cell<u64>,
    given: Cell<u64>,
}

impl Unpacking {
    /// The file itself, whose bytes are counted.
    pub fn file<R>(&self, inner: R) -> Counted<'_, R> {
        Counted { inner, unpacking: self }
    }

    /// What a decoder makes of it, held to the number of bytes that the file had.
    pub fn unpacked<R>(&self, inner: R) -> Unpacked<'_, R> {
        Unpacked { inner, unpacking: self }
    }

    /// The bytes of a stream compressed with gzip.
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
        let read = self.inner.read(bytes)?;
        let Unpacking { taken, given } = self.unpacking;
        given.set(given.get() + read as u64);
        if given.get() > taken.get().saturating_mul(MOST).max(FREE) {
            return Err(io::Error::other(format!(
                "it unpacks to more than {MOST} times its size, which coordinates do not; if it \
                 is a particle file, unpack it first"
            )));
        }
        Ok(read)
    }
}

pub struct Counted<'a, R> {
    inner: R,
    unpacking: &'a Unpacking,
}

impl<R> Counted<'_, R> {
    fn count(&self, bytes: usize) {
        self.unpacking.taken.set(self.unpacking.taken.get() + bytes as u64);
    }
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.count(read);
        Ok(read)
    }
}

impl<R: BufRead> BufRead for Counted<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.count(amount);
        self.inner.consume(amount);
    }
}
