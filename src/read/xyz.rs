//! XYZ and extended XYZ: the number of particles, a comment line, then one particle per line; one frame.
//!
//! * Extended: the comment holds `Properties=species:S:1:pos:R:3:radius:R:1` (the value may be quoted): names, types and numbers of
//!   columns. `pos` gives two or three coordinates; `r`, `radius`, `d` or `diameter` the size; the rest is skipped, as are `Lattice` and
//!   `pbc`: boundaries are open here.
//! * Plain: `species x y z`. What further columns mean, nobody knows: it may be a radius, a charge or a velocity. So a plain file with
//!   more columns is refused, unless the options give the radius: then the columns are skipped.

use std::io::BufRead;

use anyhow::{Context, bail, ensure};

use super::csv::meaning;
use super::{Column, Columns, Lines, Options, Particles, short};

const MOST_COLUMNS: usize = 10_000;

pub(super) fn read(reader: impl BufRead, name: &str, options: Options) -> anyhow::Result<Particles> {
    let mut lines = Lines::new(reader, name);
    let (first, place) = lines.next()?.with_context(|| format!("{name} is empty"))?;
    let n: u64 = match first.trim().parse() {
        Ok(n) => n,
        Err(_) => bail!("{place}: '{}' is not the number of particles, which is the first line of an XYZ file", short(first.trim())),
    };
    ensure!(n <= u64::from(u32::MAX), "{place}: {n} particles; at most 2^32 - 1 = {} can be numbered: split the file", u32::MAX);
    // A file of no particles may end before its comment line.
    let (comment, place) = lines.next()?.unwrap_or((String::new(), place));
    let extended =
        properties(&comment).map(|text| columns(&text).with_context(|| format!("{place}: Properties={}", short(&text)))).transpose()?;
    let plain = extended.is_none();
    let columns = extended.unwrap_or_else(|| Columns {
        meaning: vec![Column::Other, Column::Axis(0), Column::Axis(1), Column::Axis(2)],
        names: ["species", "x", "y", "z"].map(String::from).to_vec(),
    });
    let mut particles = columns.particles(&place)?;
    let wanted = columns.meaning.len();
    for k in 0..n {
        let Some((line, place)) = lines.next()? else {
            bail!("{name} ends after {k} of the {n} particles that its first line announces; mend the number or the file");
        };
        let count = line.split_whitespace().count();
        if plain && count > wanted {
            ensure!(
                options.radius.is_some(),
                "{place}: {count} columns in a plain XYZ file: it is not known whether the others are radii; \
                 give --radius R to skip them, or name them in line 2 as in Properties=species:S:1:pos:R:3:radius:R:1"
            );
        } else {
            ensure!(count == wanted, "{place}: {count} columns where {wanted} are expected ({})", columns.names.join(" "));
        }
        columns.push(&mut particles, line.split_whitespace(), &place)?;
    }
    while let Some((line, place)) = lines.next()? {
        ensure!(
            line.trim().is_empty(),
            "{place}: there is more after the {n} particles announced; only one frame is read: remove the others"
        );
    }
    Ok(particles)
}

/// The value of `Properties` in a comment of `key=value` and `key="some value"` pairs.
fn properties(comment: &str) -> Option<String> {
    let mut rest = comment.trim_start();
    while !rest.is_empty() {
        let end = rest.find(|c: char| c == '=' || c.is_whitespace()).unwrap_or(rest.len());
        let (key, after) = rest.split_at(end);
        rest = after;
        if let Some(value) = after.strip_prefix('=') {
            let quote = value.chars().next().filter(|c| ['"', '\''].contains(c));
            let value = quote.map_or(value, |_| &value[1..]);
            let end = value.find(|c: char| quote.map_or(c.is_whitespace(), |quote| c == quote)).unwrap_or(value.len());
            if key.eq_ignore_ascii_case("properties") {
                return Some(value[..end].to_string());
            }
            rest = &value[end..];
            rest = quote.and_then(|quote| rest.strip_prefix(quote)).unwrap_or(rest);
        }
        rest = rest.trim_start();
    }
    None
}

/// The columns that `name:type:number` triples announce.
fn columns(properties: &str) -> anyhow::Result<Columns> {
    let parts: Vec<&str> = properties.split(':').map(str::trim).collect();
    let mut columns = Columns { meaning: Vec::new(), names: Vec::new() };
    ensure!(parts.len().is_multiple_of(3), "it must be triples name:type:number, as in species:S:1:pos:R:3:radius:R:1");
    for triple in parts.chunks_exact(3) {
        let (name, count) = (triple[0], triple[2].parse::<usize>().ok().filter(|count| (1..=1000).contains(count)));
        let count = count.with_context(|| format!("'{}' is not a number of columns from 1 to 1000", short(triple[2])))?;
        // Else a line of a million letters could ask for gigabytes of columns.
        ensure!(columns.names.len() + count <= MOST_COLUMNS, "it announces more than {MOST_COLUMNS} columns; remove what is not needed");
        for k in 0..count {
            let (meaning, name) = match (name.to_ascii_lowercase().as_str(), meaning(name)) {
                ("pos", _) => {
                    ensure!(count == 2 || count == 3, "pos has {count} columns; it must have 2 or 3");
                    (Column::Axis(k), ["x", "y", "z"][k].to_string())
                }
                (_, Column::Radius | Column::Diameter) if count == 1 => (meaning(name), name.to_string()),
                _ => (Column::Other, name.to_string()),
            };
            columns.meaning.push(meaning);
            columns.names.push(name);
        }
    }
    ensure!(columns.meaning.contains(&Column::Axis(0)), "there is no pos; the positions must be named pos:R:3");
    Ok(columns)
}
