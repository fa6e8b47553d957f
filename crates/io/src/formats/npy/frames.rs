//! Frames of an array: one, or one for each index of the first dimension.

use anyhow::{Context, bail, ensure};

use super::{Header, any_header, particles, records};
use crate::formats::Indexed;
use crate::frames::{Choice, Reader, Step};
use crate::options::{Opened, Options};
use crate::particles::{Loaded, loaded};
use crate::raw::lines::Source;

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Indexed::<Header>::new(source, options))
}

impl Reader<Loaded> for Indexed<'_, Header> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<Loaded>> {
        let Indexed { source, options, index, next } = self;
        let header = match index {
            Some(header) => header,
            None => {
                let read = any_header(source)?;
                if read.fields.is_empty() {
                    read.of_rows(true).with_context(|| source.name.to_string())?;
                }
                index.insert(read)
            }
        };
        while *next < header.frames.unwrap_or(1) {
            let k = *next;
            let step = match header.frames {
                None => Step::Keep,
                Some(_) => choice.begin(|| format!("{}: frame {k}", source.name))?,
            };
            if step == Step::Stop {
                return Ok(None);
            }
            *next += 1;
            if step == Step::Keep {
                let frame = frame(source, header, *options);
                if header.frames.is_none() {
                    return frame.map(Some);
                }
                let read = frame.with_context(|| format!("frame {k}"))?;
                choice.done(None, None);
                return Ok(Some(read));
            }
            let numbers = header.rows.saturating_mul(header.columns.unwrap_or(1) as u64);
            let bytes = numbers.saturating_mul(header.kind.width() as u64);
            ensure!(
                source.skip(bytes)?,
                "{} ends in frame {k} of the {} that its header announces; write it again",
                source.name,
                header.frames.unwrap_or(1)
            );
            choice.done(None, None);
        }
        source.end(header)?;
        Ok(None)
    }
}

fn frame(source: &mut Source<'_>, header: &Header, options: Options) -> anyhow::Result<Loaded> {
    if !header.fields.is_empty() {
        return Ok(records(source, header, options)?.read("NumPy npy"));
    }
    ensure!(
        options.columns.is_none(),
        "{}: the columns of an array have no names; leave out --columns, and save them in the \
         order x, y, z, radius",
        source.name
    );
    let (particles, radius) = particles(source, header, options)?;
    // If the user gives the dimension, columns that count the particles are accepted.
    if let Some(which) = particles.numbered_column().filter(|_| options.dim.is_none()) {
        let name = source.name;
        bail!("{name}: the {which} column counts the particles; leave it out, or give --dim 3");
    }
    Ok(loaded("NumPy npy", particles, radius))
}
