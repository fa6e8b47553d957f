//! Frames of an array: one, or one for each index of the first dimension.

use anyhow::{Context, ensure};

use super::{Header, any_header, particles};
use crate::formats::Indexed;
use crate::frames::Framed;
use crate::options::{Opened, Options};
use crate::particles::{Loaded, loaded};
use crate::raw::lines::Source;

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Indexed::<Header>::new(source, options))
}

impl Framed for Indexed<'_, Header> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        let read = |source: &mut Source<'_>| {
            let header = any_header(source)?;
            header.of_rows(true).with_context(|| source.name.to_string())?;
            Ok(header)
        };
        self.next_of(read, |header| header.frames.unwrap_or(1))
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let Indexed { source, options, index: Some(header), next } = self else { return Ok(None) };
        let read = match keep {
            true => frame(source, header, *options).map(Some),
            false => header.values(source, header.frame_size(), |_, _| Ok(())).map(|()| None),
        };
        let read = match header.frames {
            Some(_) => read.with_context(|| format!("frame {}", *next - 1))?,
            None => read?,
        };
        if *next == header.frames.unwrap_or(1) {
            source.end(header)?;
        }
        Ok(read)
    }
}

fn frame(source: &mut Source<'_>, header: &mut Header, options: Options) -> anyhow::Result<Loaded> {
    let (name, unnamed) = (source.name, options.columns.is_none());
    ensure!(unnamed, "{name}: an array has x, y, z, radius in this order; leave out --columns");
    let (particles, radius) = particles(source, header, options)?;
    Ok(loaded("NumPy npy", particles, radius))
}
