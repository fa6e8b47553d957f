//! Structured arrays, whose rows are records of named numbers.

use anyhow::{Context, bail, ensure};

use super::Header;
use crate::columns::{Column, Columns};
use crate::options::Options;
use crate::raw::lines::{Source, short};
use crate::raw::scalars::Scalar;
use crate::rows::Rows;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    pub name: String,
    /// Number type, and whether it is big-endian; `None` if the field is not a supported number.
    number: Option<(Scalar, bool)>,
    width: usize,
}

const WIDEST: usize = 1 << 20;

/// Parses a type such as `[('x', '<f8'), ('v', '<f4', (3,))]`.
pub(super) fn parse(text: &str) -> anyhow::Result<Vec<Field>> {
    let bad = || format!("the type {} is not read; save one plain array", short(text));
    let mut fields = Vec::new();
    let mut rest = text.strip_prefix('[').with_context(bad)?.trim_start();
    while !rest.starts_with(']') {
        rest = rest.strip_prefix('(').with_context(bad)?;
        let (name, after) = quoted(rest).with_context(bad)?;
        let (kind, after) = quoted(after.strip_prefix(',').with_context(bad)?).with_context(bad)?;
        let (mut count, mut after) = (1_usize, after);
        let single = !after.starts_with(',');
        if !single {
            let shape = after[1..].trim_start().strip_prefix('(').with_context(bad)?;
            let (shape, behind) = shape.split_once(')').with_context(bad)?;
            for size in shape.split(',').map(str::trim).filter(|size| !size.is_empty()) {
                let size: usize = size.parse().ok().with_context(bad)?;
                count = count.checked_mul(size).with_context(bad)?;
            }
            after = behind.trim_start();
        }
        let (number, width) = width(kind).with_context(bad)?;
        let width = width.checked_mul(count).filter(|&width| width <= WIDEST).with_context(bad)?;
        fields.push(Field { name: name.into(), number: number.filter(|_| single), width });
        ensure!(fields.len() <= 10_000, bad());
        rest = after.strip_prefix(')').with_context(bad)?.trim_start();
        rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
    }
    let row = fields.iter().map(|field| field.width).fold(0, usize::saturating_add);
    ensure!((1..=WIDEST).contains(&row), bad());
    Ok(fields)
}

fn quoted(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    let (inner, rest) = text[1..].split_once(quote)?;
    Some((inner, rest.trim_start()))
}

/// Returns how a field of this type is read (`None` if it is not a number), and its size in bytes.
fn width(kind: &str) -> Option<(Option<(Scalar, bool)>, usize)> {
    let number = super::header::kind_of(kind);
    if let Some((kind, _)) = number {
        return Some((number, kind.width()));
    }
    let letter = kind.trim_start_matches(['<', '>', '|', '=']);
    let bytes = letter.get(1..)?.split('[').next()?.parse::<usize>().ok()?;
    match letter.as_bytes()[0] {
        b'U' => Some((None, bytes.checked_mul(4)?)),
        b'S' | b'V' | b'f' | b'c' | b'M' | b'm' => Some((None, bytes)),
        // Python objects are pickled, not stored as numbers.
        _ => None,
    }
}

pub fn records(source: &mut Source<'_>, header: &Header, options: Options) -> anyhow::Result<Rows> {
    let (name, fields) = (source.name, &header.fields);
    let &[rows] = &header.sizes[..] else {
        bail!(
            "{name} is an array with fields of the shape {}; (N,) is read",
            super::shape(&header.sizes)
        )
    };
    ensure!(rows <= u64::from(u32::MAX), "{name}: {rows} particles; split the file");
    let mut columns = Columns::named(fields.iter().map(|field| field.name.as_str()));
    for (meaning, field) in columns.meaning.iter_mut().zip(fields) {
        // Three numbers named r are coordinates, not a radius.
        if field.number.is_none() {
            *meaning = Column::Other;
        }
    }
    let mut columns = columns.chosen(name, options.columns)?;
    let particles = columns.particles(name, options)?;
    let mut all = Rows { columns, particles };
    let fields: Vec<_> = fields.iter().map(|field| (field.number, field.width)).collect();
    all.push_records(source, rows, &fields)?;
    Ok(all)
}
