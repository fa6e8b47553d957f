//! XYZ and extended XYZ. Each frame has the number of particles, a comment line, and a line per
//! particle.
//!
//! * Extended: the comment has pairs `key=value` (see [`comment`]).
//!   `Properties=species:S:1:pos:R:3:radius:R:1` gives name, type and number of columns. `pos` has
//!   two or three coordinates; `r`, `radius`, `d` or `diameter` is the size; the rest is skipped.
//! * Box: `Lattice="ax ay az bx by bz cx cy cz"` from the corner `Origin`; three numbers are edges
//!   along the axes, four are the vectors of a 2D box. It is periodic along all vectors unless
//!   `pbc="T T F"` states otherwise, as in ASE and OVITO.
//! * Time: `step=100` (or `timestep`), `time=0.5`.
//! * Plain: `species x y z`. Further columns are refused, because they may be radii, charges or
//!   velocities. If the options give the radius, those behind the name of a species are skipped.

mod comment;

use anyhow::{Context, ensure};
use comment::{Comment, Pair};

use crate::boxes;
use crate::columns::advice::unclear;
use crate::columns::{Column, Columns};
use crate::doubts;
use crate::frames::Framed;
use crate::options::{Opened, Options};
use crate::particles::Loaded;
use crate::raw::lines::{Lines, Source, number, short, shown, step_of, words};
use crate::types::{About, Declared, assumed};

const MOST_COLUMNS: usize = 10_000;

/// Whether the first line is one whole number.
pub fn tells(head: &[u8]) -> bool {
    let first = head.split(|&b| b == b'\n').next().unwrap_or_default();
    let mut cells = words(first).map(number);
    let count = cells.next().flatten().filter(|n| *n >= 0.0 && n.fract() == 0.0);
    count.is_some() && cells.next().is_none() && !head.contains(&0)
}

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Xyz { lines: Lines::new(source), options, count: None })
}

struct Xyz<'a> {
    lines: Lines<'a>,
    options: Options,
    /// Number of particles of the current frame; `None` before the first.
    count: Option<u64>,
}

impl Framed for Xyz<'_> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        // The first line must be the number of particles, so blank lines are not skipped there.
        let more = match self.count {
            None => self.lines.advance().map(|_| true),
            Some(_) => self.lines.advance_over_blanks(),
        };
        if !more? {
            return Ok(None);
        }
        let what = "the number of particles, which is the first line of an XYZ file";
        self.count = Some(self.lines.count(self.lines.line(), what)?);
        Ok(Some(self.lines.place()))
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let n = self.count.unwrap_or_default();
        if keep {
            return frame(&mut self.lines, n, self.options).map(Some);
        }
        self.lines.advance()?;
        (0..n).try_for_each(|k| self.lines.row(k, n, ROWS)).map(|()| None)
    }

    fn has_feed(&self) -> bool {
        self.lines.ended()
    }
}

const ROWS: &str = "particles that the frame's first line announces: it is cut off, or still being \
                    written; fix the number or the file";

fn frame(lines: &mut Lines<'_>, n: u64, options: Options) -> anyhow::Result<Loaded> {
    // A file with 0 particles may end before its comment line.
    let line = if lines.advance()? { lines.text() } else { String::new() };
    let comment = Comment::read(&line).with_context(|| lines.place())?;
    let columns = columns(&comment).with_context(|| lines.place())?;
    let space = columns.meaning.contains(&Column::Axis(2));
    let declared = match declared(&comment, space, options) {
        // A faulty box does not matter if boundaries are open.
        Err(_) if options.boundaries.open => None,
        declared => declared.with_context(|| lines.place())?,
    };
    let mut rows = columns.rows(&lines.place(), options)?;
    let plain = rows.columns.or_more;
    let unsure = plain && options.columns.is_none();
    for k in 0..n {
        lines.row(k, n, ROWS)?;
        let line = lines.line();
        let first_cell = words(line).next().unwrap_or_default();
        let named = !unsure || number(first_cell).is_none_or(|value| value.fract() == 0.0);
        if !named {
            return Err(unclear!("{lines}: '{}' is not a species", shown(first_cell)));
        }
        let count = words(line).count();
        let many = unsure && count > rows.columns.names.len();
        // Coordinates follow the name of a species, but not always a number.
        if many && (options.radius.is_none() || number(first_cell).is_some()) {
            return Err(unclear!(
                "{lines}: {count} columns without Properties in line 2, and plain XYZ has 4"
            ));
        }
        if many && k == 0 {
            let notice = assumed!("x, y, z are columns 2 to 4 of {count}; --columns changes this");
            rows.particles.notices.push(notice);
        }
        rows.push(line, lines)?;
    }
    let is_number = |word: &[u8]| number(word).is_some();
    if plain
        && declared.is_none()
        && !options.boundaries.replace_box()
        && words(line.as_bytes()).all(is_number)
    {
        let doubt = doubts::of_comment(&line, &rows.particles);
        rows.particles.notices.extend(doubt);
    }
    let (particles, about) = rows.read(if plain { "XYZ" } else { "extended XYZ" });
    let first = |key: &str| comment.get(key)?.cells.first().map(String::as_bytes);
    let step = first("step").or(first("timestep")).and_then(step_of);
    let time = first("time").and_then(number);
    Ok((particles, About { declared, step, time, ..about }))
}

fn columns(comment: &Comment) -> anyhow::Result<Columns> {
    match comment.get("Properties") {
        Some(Pair { text, .. }) => {
            announced(text).with_context(|| format!("Properties={}", short(text)))
        }
        None => Ok(Columns { or_more: true, ..Columns::of("species x y z") }),
    }
}

/// Returns the box of the comment line; without `pbc` a lattice is periodic along all vectors.
fn declared(comment: &Comment, space: bool, options: Options) -> anyhow::Result<Option<Declared>> {
    let boundaries = options.boundaries;
    let dim = if space { 3 } else { 2 };
    let mut vectors = None;
    if boundaries.edges.is_none() {
        let what = match space {
            true => "nine finite numbers, or three edges (four are vectors of discs, with pos:R:2)",
            false => "nine finite numbers, one vector after the other, or four for discs",
        };
        let counts: &[usize] = if space { &[9, 3] } else { &[9, 3, 4] };
        let lattice = comment.get("Lattice").map(|pair| pair.numbers(counts, what)).transpose()?;
        vectors = lattice.and_then(|numbers| boxes::vectors(&numbers));
    }
    let counts: &[usize] = if space { &[3] } else { &[3, 2] };
    let origin = comment.get("Origin").map(|pair| pair.numbers(counts, "three finite numbers"));
    let origin = origin.transpose()?;
    let mut periodic = vectors.map(|_| [true; 3]);
    if boundaries.periodic.is_none()
        && let Some(pair) = comment.get("pbc")
    {
        periodic = Some(pair.flags(dim)?);
    }
    let declared = vectors.is_some() || periodic.is_some() || origin.is_some();
    let origin = origin.map_or([0.0; 3], |n| [n[0], n[1], n.get(2).copied().unwrap_or(0.0)]);
    Ok(declared.then_some(Declared { vectors, origin, periodic, ..Declared::default() }))
}

fn announced(properties: &str) -> anyhow::Result<Columns> {
    let parts: Vec<&str> = properties.split(':').map(str::trim).collect();
    let mut columns = Columns::default();
    let triples = parts.len().is_multiple_of(3);
    ensure!(triples, "it must be triples name:type:number, as in species:S:1:pos:R:3:radius:R:1");
    for triple in parts.chunks_exact(3) {
        let name = triple[0];
        let count = triple[2].parse().ok().filter(|count: &usize| (1..=1000).contains(count));
        let of_columns =
            || format!("'{}' is not a number of columns from 1 to 1000", short(triple[2]));
        let count = count.with_context(of_columns)?;
        // Without this limit, a line of a million letters could reserve gigabytes for columns.
        let fits = columns.names.len() + count <= MOST_COLUMNS;
        ensure!(fits, "it announces more than {MOST_COLUMNS} columns; remove what is not needed");
        for k in 0..count {
            let (meaning, name) = match (name.to_ascii_lowercase().as_str(), Column::named(name)) {
                ("pos", _) => {
                    let fits = matches!(count, 2 | 3);
                    ensure!(fits, "pos has {count} columns; it must have 2 or 3");
                    (Column::Axis(k), ["x", "y", "z"][k].to_string())
                }
                (_, meaning @ (Column::Radius | Column::Diameter | Column::Id)) if count == 1 => {
                    (meaning, name.to_string())
                }
                _ => (Column::Other, name.to_string()),
            };
            columns.meaning.push(meaning);
            columns.names.push(name);
        }
    }
    let has_places = columns.has_places();
    ensure!(has_places, "there is no pos; the positions must be named pos:R:3");
    Ok(columns)
}
