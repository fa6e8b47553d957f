//! PLY, as text or binary in either byte order: the element `vertex` with properties x, y, z and
//! `radius`, `r`, `diameter` or `d`.
//!
//! The prefix `scalar_` of CloudCompare is ignored. Elements before the vertices must not contain
//! lists; later elements are not read. Format: <http://paulbourke.net/dataformats/ply/>.

use anyhow::{Context, bail, ensure};

use crate::particles::{Column, Columns, Rows};
use crate::raw::arrays::Cells;
use crate::raw::lines::{Lines, Source, short, texts};
use crate::raw::scalars::Kind;
use crate::{Loaded, Options};

struct Element {
    name: String,
    count: u64,
    kinds: Vec<Kind>,
    names: Vec<String>,
    lists: bool,
}

pub fn read(source: Source<'_>, options: Options) -> anyhow::Result<Loaded> {
    let mut lines = Lines::new(source);
    let (layout, elements) = header(&mut lines)?;
    let name = lines.source.name;
    let Some(at) = elements.iter().position(|element| element.name == "vertex") else {
        bail!("{name} has no element vertex")
    };
    let (before, vertex) = (&elements[..at], &elements[at]);
    ensure!(
        !vertex.lists && (layout.is_none() || before.iter().all(|element| !element.lists)),
        "{name}: lists before or among the vertices are not read; write the vertices first, and \
         without lists"
    );
    let place = format!("{name}: the properties of vertex");
    let mut columns = named(vertex).chosen(&place, options)?;
    for ((meaning, kind), label) in columns.meaning.iter_mut().zip(&vertex.kinds).zip(&vertex.names)
    {
        // Bytes named r are colours (red), not radii.
        if *kind == Kind::U8 && label.eq_ignore_ascii_case("r") && !columns.sizes_chosen {
            *meaning = Column::Other;
        }
    }
    let particles = columns.particles(&place, options)?;
    let mut rows = Rows { columns, particles };
    joined(&elements).check(name, options, &mut rows.particles.notices)?;
    let torn = |k: u64| {
        anyhow::anyhow!(
            "{name} ends after {k} of the {} vertices that its header announces; write it again",
            vertex.count
        )
    };
    let Some(big) = layout else {
        let skipped: u64 = before.iter().fold(0, |sum, element| sum.saturating_add(element.count));
        for k in 0..skipped.saturating_add(vertex.count) {
            if !lines.advance()? {
                return Err(torn(k.saturating_sub(skipped)));
            }
            if k >= skipped {
                rows.push(lines.line(), &lines)?;
            }
        }
        return Ok(rows.read("PLY, text"));
    };
    for element in before {
        let width: usize = element.kinds.iter().map(|kind| kind.width()).sum();
        if !lines.source.skip(element.count.saturating_mul(width as u64))? {
            return Err(torn(0));
        }
    }
    let kinds = vertex.kinds.iter();
    let fields: Vec<_> = kinds.map(|kind| (Some((*kind, big)), kind.width())).collect();
    let read = rows.push_records(&mut lines.source, "vertex", vertex.count, &fields)?;
    if read < vertex.count {
        return Err(torn(read));
    }
    Ok(rows.read("PLY, binary"))
}

fn named(vertex: &Element) -> Columns {
    Columns::named(vertex.names.iter().map(|name| match name.strip_prefix("scalar_") {
        Some(inner) if Column::named(inner) != Column::Other => inner,
        _ => name,
    }))
}

fn joined(elements: &[Element]) -> Cells {
    let mut cells = Cells::default();
    for Element { name, count, lists, .. } in elements {
        match name.as_str() {
            "vertex" => {}
            "edge" => cells.lines = cells.lines.saturating_add(*count),
            "face" | "tristrips" => cells.faces = cells.faces.saturating_add(*count),
            _ if *lists => cells.bodies = cells.bodies.saturating_add(*count),
            _ => {}
        }
    }
    cells
}

/// Returns whether numbers are big-endian (`None` for text), and the elements.
fn header(lines: &mut Lines<'_>) -> anyhow::Result<(Option<bool>, Vec<Element>)> {
    let (mut layout, mut elements): (_, Vec<Element>) = (None, Vec::new());
    lines.advance()?;
    ensure!(lines.line() == b"ply", "{}: a PLY file begins with the line 'ply'", lines.place());
    for _ in 0..10_000 {
        ensure!(lines.advance()?, "{} ends in its header; write it again", lines.source.name);
        let (place, words) = (lines.place(), texts(lines.line()));
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        match words[..] {
            ["end_header"] => {
                let layout =
                    layout.with_context(|| format!("{place}: the header has no line 'format'"))?;
                return Ok((layout, elements));
            }
            ["format", "ascii", ..] => layout = Some(None),
            ["format", "binary_little_endian", ..] => layout = Some(Some(false)),
            ["format", "binary_big_endian", ..] => layout = Some(Some(true)),
            ["element", name, n] => {
                let count = lines.count(n.as_bytes(), "a number of elements")?;
                elements.push(Element {
                    name: name.to_string(),
                    count,
                    kinds: Vec::new(),
                    names: Vec::new(),
                    lists: false,
                });
            }
            ["property", "list", ..] => {
                elements
                    .last_mut()
                    .with_context(|| format!("{place}: a property of no element"))?
                    .lists = true
            }
            ["property", kind, name] => {
                let element = elements
                    .last_mut()
                    .with_context(|| format!("{place}: a property of no element"))?;
                let kind = Kind::named(kind).with_context(|| {
                    format!("{place}: '{}' is not a type of number", short(kind))
                })?;
                element.kinds.push(kind);
                element.names.push(name.to_string());
            }
            [] | ["comment" | "obj_info", ..] => {}
            _ => bail!("{place}: '{}' is not a line of a PLY header", short(&words.join(" "))),
        }
    }
    bail!("{}: the header has more than 10000 lines", lines.source.name)
}
