//! Numbers of a VTK XML array: text, or blocks of bytes with or without zlib.

use std::io::{BufRead, BufReader, Read};

use anyhow::{Context, bail, ensure};
use flate2::bufread::ZlibDecoder;

use crate::formats::gzip::Unpacking;
use crate::formats::xml::Xml;
use crate::raw::lines::{number, short, shown};
use crate::raw::scalars::{Kind, Target};

#[derive(Default)]
pub(super) struct Layout {
    pub big: bool,
    /// Bytes of each integer that gives the length of an array.
    pub header: usize,
    /// Name of the compressor of binary arrays; text is never compressed.
    pub compressor: String,
}

pub(super) struct Array {
    pub target: Target,
    pub kind: Kind,
    /// Required number of values; `None` if any number is allowed.
    pub count: Option<u64>,
}

pub(super) fn text(xml: &mut Xml<'_>, array: Array) -> anyhow::Result<Target> {
    let Array { mut target, count, .. } = array;
    let mut word = Vec::new();
    for k in 0..count.unwrap_or(u64::MAX) {
        let Some(text) = xml.word(&mut word)? else {
            let Some(count) = count else { return Ok(target) };
            bail!(
                "{}: the array ends after {k} of its {count} numbers; write the file again",
                xml.place()
            )
        };
        let Some(value) = number(text) else {
            bail!(
                "{}: number {} of the array: '{}' is not a number",
                xml.place(),
                k + 1,
                shown(text)
            )
        };
        target.push(value).with_context(|| xml.place())?;
    }
    ensure!(
        xml.word(&mut word)?.is_none(),
        "{}: the array goes on after its {} numbers; write the file again",
        xml.place(),
        count.unwrap_or_default()
    );
    Ok(target)
}

pub(super) struct Counting<'a> {
    pub inner: &'a mut dyn BufRead,
    pub count: u64,
}

impl Read for Counting<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(bytes)?;
        self.count += count as u64;
        Ok(count)
    }
}

pub(super) fn numbers(
    bytes: &mut dyn Read,
    unpacking: &Unpacking,
    layout: &Layout,
    Array { mut target, kind, count }: Array,
) -> anyhow::Result<Target> {
    let width = kind.width() as u64;
    let wanted = count.map(|count| count.saturating_mul(width));
    let fits = |bytes: u64| wanted.unwrap_or(bytes - bytes % width) == bytes;
    let expected = count.map_or("whole".into(), |count| format!("{count}"));
    let zlib = match &layout.compressor[..] {
        "" => false,
        "vtkZLibDataCompressor" => true,
        other => bail!(
            "compressed by {}, which is not read; write it with zlib or without compression",
            short(other)
        ),
    };
    let length = |bytes: &mut dyn Read| -> anyhow::Result<u64> {
        let mut word = [0; 8];
        let word = &mut word[..layout.header];
        bytes.read_exact(word).context("its length is cut off; write the file again")?;
        Ok(if layout.big {
            word.iter().fold(0, |n, &b| n << 8 | u64::from(b))
        } else {
            word.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b))
        })
    };
    let first = length(bytes)?;
    if !zlib {
        ensure!(
            fits(first),
            "it has {first} bytes, but {expected} numbers of {width} bytes are expected; write the \
             file again"
        );
        feed(bytes, &mut target, kind, layout.big, first)?;
        return Ok(target);
    }
    let (blocks, size, last) = (first, length(bytes)?, length(bytes)?);
    let rest = if last == 0 { size } else { last };
    let all =
        blocks.checked_sub(1).map_or(Some(0), |full| full.checked_mul(size)?.checked_add(rest));
    ensure!(
        all.is_some_and(fits),
        "its blocks do not hold {expected} numbers of {width} bytes; write the file again"
    );
    ensure!(
        size % width == 0,
        "its blocks of {size} bytes cut through numbers; write the file again"
    );
    // The list grows as lengths are read, because the announced number may be false.
    let mut packed = Vec::new();
    for _ in 0..blocks {
        crate::raw::room::room(&mut packed)?;
        packed.push(length(bytes)?);
    }
    for (k, &packed) in packed.iter().enumerate() {
        let size = if k as u64 + 1 == blocks { rest } else { size };
        let mut block = BufReader::new(bytes.take(packed));
        feed(
            &mut unpacking.unpacked(ZlibDecoder::new(&mut block)),
            &mut target,
            kind,
            layout.big,
            size,
        )
        .with_context(|| format!("block {k}"))?;
        std::io::copy(&mut block, &mut std::io::sink()).context("cannot read it")?;
    }
    Ok(target)
}

fn feed(
    bytes: &mut dyn Read,
    target: &mut Target,
    kind: Kind,
    big: bool,
    mut left: u64,
) -> anyhow::Result<()> {
    let mut piece = [0; 1 << 13];
    while left > 0 {
        let count = left.min(piece.len() as u64) as usize;
        bytes
            .read_exact(&mut piece[..count])
            .context("it is cut off or damaged; write the file again")?;
        for number in piece[..count].chunks_exact(kind.width()) {
            target.push(kind.get(number, big))?;
        }
        left -= count as u64;
    }
    Ok(())
}
