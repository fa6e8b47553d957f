//! Particles from rows: lines with cells between blanks, and records of binary files.

use anyhow::{Context, ensure};

use super::{Column, Columns};
use crate::Loaded;
use crate::particles::{Particles, loaded};
use crate::raw::lines::{Lines, Separator, Source, listed, short};
use crate::raw::scalars::Kind;

pub struct Rows {
    pub columns: Columns,
    pub particles: Particles,
}

impl Rows {
    /// Returns a frame without rows whose columns are `names`, for a file that does not name them.
    pub fn none(names: &str, has_radii: bool) -> Rows {
        let columns = Columns::named(names.split(' '));
        Rows { columns, particles: Particles::new(3, has_radii) }
    }

    pub fn read(self, format: &'static str) -> Loaded {
        loaded(format, self.particles, self.columns.radius())
    }

    pub fn push(&mut self, line: &[u8], lines: &Lines<'_>) -> anyhow::Result<()> {
        let Rows { columns, particles } = self;
        let between = || format!(" ({})", listed(&columns.names));
        columns.push(particles, Separator::Blanks.cells(line), || lines.place(), between)
    }

    /// Adds the particles of the next `count` records of a binary file, and returns the number of
    /// records read. `what` names a record in messages, such as "vertex". `fields` are the type
    /// (`None` if not a number) and size in bytes of each column.
    pub fn push_records(
        &mut self,
        source: &mut Source<'_>,
        what: &str,
        count: u64,
        fields: &[(Option<(Kind, bool)>, usize)],
    ) -> anyhow::Result<u64> {
        let mut ends = vec![0];
        ends.extend(fields.iter().scan(0, |end, (_, width)| {
            *end += width;
            Some(*end)
        }));
        let mut record = vec![0; ends[fields.len()]];
        for k in 0..count {
            if !source.fill(&mut record)? {
                return Ok(k);
            }
            let value = |place: usize| {
                let (kind, big) = fields[place].0?;
                Some(kind.get(&record[ends[place]..], big))
            };
            self.push_values(|| format!("{}: {what} {k} (from 0)", source.name), k, value)?;
        }
        Ok(count)
    }

    /// Adds the particle of a record; `value(k)` is the number in column k, if there is one.
    fn push_values(
        &mut self,
        place: impl Fn() -> String,
        k: u64,
        value: impl Fn(usize) -> Option<f64>,
    ) -> anyhow::Result<()> {
        let Rows { columns, particles } = self;
        let (mut point, mut radius, mut id) = ([0.0; 3], 0.0, k as i64);
        for (at, (column, label)) in columns.meaning.iter().zip(&columns.names).enumerate() {
            if *column == Column::Other || *column == Column::Id && particles.ids.is_none() {
                continue;
            }
            let what = || format!("{}: '{}'", place(), short(label));
            let value = value(at).with_context(|| format!("{} is not a number", what()))?;
            match column {
                Column::Axis(axis) => {
                    ensure!(value.is_finite(), "{} is {value}; it must be finite", what());
                    point[*axis] = value;
                }
                Column::Id => {
                    let is_whole = value.fract() == 0.0 && value.abs() < 9e15;
                    ensure!(is_whole, "{}: {value} is not a whole number", what());
                    id = value as i64;
                }
                _ => {
                    let size = column.size(value);
                    radius = size.map_err(|why| anyhow::anyhow!("{}: {value} {why}", what()))?;
                }
            }
        }
        particles.push(point, radius, id)
    }
}
