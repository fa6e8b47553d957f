//! gzip, as people compress dumps with it: unpacked while it is read.
//!
//! **Bombs.** Deflate makes a thousand times less of what repeats itself. Coordinates do not: real
//! files shrink to a half or a tenth. What grows to more than [`MOST`] times its size, beyond
//! [`FREE`] bytes, is refused, so that time and memory stay in proportion to the file.

use std::cell::Cell;
use std::io::{self, BufRead, Read};
use std::rc::Rc;

use flate2::bufread::MultiGzDecoder;

/// The first bytes.
pub(crate) const MAGIC: &[u8] = b"\x1f\x8b";
/// Most bytes unpacked for each byte read.
const MOST: u64 = 200;
/// Bytes unpacked before anybody asks.
const FREE: u64 = 64 << 20;

/// Refuses what grows out of proportion.
pub(crate) fn in_proportion(packed: u64, unpacked: u64) -> anyhow::Result<()> {
    let most = packed.saturating_mul(MOST).max(FREE);
    anyhow::ensure!(
        unpacked <= most,
        "it unpacks to more than {MOST} times its size, which coordinates do not; if it is a \
         particle file, unpack it first"
    );
    Ok(())
}

/// The bytes of a compressed stream.
pub(crate) fn expand(reader: impl BufRead) -> impl Read {
    inflate(reader, MultiGzDecoder::new)
}

/// The bytes of any other compressed stream.
pub(crate) fn inflate<R: BufRead, D: Read>(
    reader: R,
    decoder: impl FnOnce(Counted<R>) -> D,
) -> impl Read {
    let taken = Rc::new(Cell::new(0));
    Bounded { inner: decoder(Counted { inner: reader, taken: taken.clone() }), taken, given: 0 }
}

/// Something unpacked, held to the number of bytes it was made from.
pub(crate) struct Bounded<R> {
    inner: R,
    taken: Rc<Cell<u64>>,
    given: u64,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.given += read as u64;
        in_proportion(self.taken.get(), self.given).map_err(io::Error::other)?;
        Ok(read)
    }
}

/// Counts what is read.
pub(crate) struct Counted<R> {
    inner: R,
    taken: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.taken.set(self.taken.get() + read as u64);
        Ok(read)
    }
}

impl<R: BufRead> BufRead for Counted<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.taken.set(self.taken.get() + amount as u64);
        self.inner.consume(amount);
    }
}
