//! MercuryDPM `.data`. Each frame has a header `N time xmin ymin zmin xmax ymax zmax` and N lines.
//! In 2D, zmin and zmax may be missing.
//!
//! Spheres have at least 14 columns: position, velocity, radius, orientation, angular velocity,
//! species. Discs have 8: x y vx vy radius angle angular-velocity species. Format: the MercuryDPM
//! documentation, "data file".

use anyhow::{Context, bail, ensure};

use crate::boxes::in_order;
use crate::formats::Opened;
use crate::frames::Framed;
use crate::particles::{Columns, Particles, Rows};
use crate::raw::lines::{Lines, Source, number, words};
use crate::{About, Declared, Loaded, Options};

const SPACE: &str = "x y z vx vy vz radius qx qy qz wx wy wz species";
const PLANE: &str = "x y vx vy radius angle omega species";

/// Recognises six or eight numbers, the first of them whole, before a line of 8 or 14 to 16
/// numbers.
pub fn tells(head: &[u8]) -> bool {
    let mut lines = head.split(|&b| b == b'\n').filter(|line| !line.trim_ascii().is_empty());
    let (first, second) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    let numbers = |line| words(line).all(|word| number(word).is_some());
    header(first) && matches!(words(second).count(), 8 | 14..=16) && numbers(second)
}

fn header(line: &[u8]) -> bool {
    let whole = words(line).next().is_some_and(|word| word.iter().all(u8::is_ascii_digit));
    whole && matches!(words(line).count(), 6 | 8) && words(line).all(|word| number(word).is_some())
}

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Data { lines: Lines::new(source), options, header: Header::default() })
}

struct Data<'a> {
    lines: Lines<'a>,
    options: Options,
    header: Header,
}

#[derive(Default)]
struct Header {
    n: u64,
    time: Option<f64>,
    bounds: Vec<f64>,
}

impl Framed for Data<'_> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        let lines = &mut self.lines;
        if !lines.advance_over_blanks()? {
            return Ok(None);
        }
        ensure!(
            header(lines.line()),
            "{}: a line 'N time xmin ymin zmin xmax ymax zmax' is expected; is the number of \
             particles before it right?",
            lines.place()
        );
        let mut numbers = words(lines.line());
        let n = lines.count(numbers.next().unwrap_or_default(), "the number of particles")?;
        let time = numbers.next().and_then(number);
        self.header = Header { n, time, bounds: numbers.filter_map(number).collect() };
        Ok(Some(lines.place()))
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let Data { lines, options, header: Header { n, time, bounds } } = self;
        let mut rows: Option<Rows> = None;
        let of = "particles that the frame's first line announces: it is cut off, or still being \
                  written";
        for k in 0..*n {
            lines.row(k, *n, of)?;
            if keep && rows.is_none() {
                rows = Some(columns(lines)?.rows(&lines.place(), *options)?);
            }
            if let Some(rows) = &mut rows {
                rows.push(lines.line(), lines)?;
            }
        }
        if !keep {
            return Ok(None);
        }
        let rows = rows.unwrap_or_else(|| Rows::none(SPACE, true));
        let declared = domain(lines, bounds, &rows.particles, *options)?;
        let (particles, about) = rows.read("MercuryDPM data");
        Ok(Some((particles, About { time: *time, declared, ..about })))
    }

    fn end(&self) -> Option<(u64, bool)> {
        Some(self.lines.end())
    }
}

fn columns(lines: &Lines<'_>) -> anyhow::Result<Columns> {
    Ok(match words(lines.line()).count() {
        8 => Columns::named(PLANE.split(' ')),
        14.. => Columns { or_more: true, ..Columns::named(SPACE.split(' ')) },
        count => {
            bail!("{}: {count} columns; 8 (discs) or 14 (spheres) are expected", lines.place())
        }
    })
}

fn domain(
    lines: &Lines<'_>,
    bounds: &[f64],
    particles: &Particles,
    options: Options,
) -> anyhow::Result<Option<Declared>> {
    let half = bounds.len() / 2;
    let bounds: Vec<[f64; 2]> =
        (0..particles.dim().min(half)).map(|k| [bounds[k], bounds[k + half]]).collect();
    let bounds = Some(bounds).filter(|bounds| bounds.iter().flatten().all(|x| x.is_finite()));
    in_order(bounds.as_deref().unwrap_or_default(), options.boundaries)
        .with_context(|| lines.source.name.to_string())?;
    // The format does not state whether the domain is periodic.
    Ok(bounds.map(|bounds| Declared::between(&bounds, None)))
}
