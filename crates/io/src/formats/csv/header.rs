//! The start of a table: comments, a box, and the names of the columns.

use anyhow::{Context, bail};

use super::repeats::Repeats;
use super::split::{self, Split};
use crate::columns::Columns;
use crate::columns::advice::unclear;
use crate::columns::chosen::Chosen;
use crate::options::Options;
use crate::raw::lines::{Lines, Separator, decoded, header_of, is_comment, number, words};
use crate::types::Declared;

#[derive(Default)]
pub(super) struct Header {
    pub columns: Columns,
    pub place: String,
    pub separator: Separator,
    /// Whether unnamed columns were given their usual meaning.
    pub assumed: bool,
    /// Whether the current line is a row of the table, or stands between rows.
    pub is_row: bool,
    pub format: &'static str,
    pub split: Option<Split>,
    pub repeats: Option<Repeats>,
    pub declared: Option<Declared>,
    /// Comments above the table.
    pub comments: Vec<String>,
}

const MOST_COMMENTS: usize = 16;
const LONGEST_COMMENT: usize = 1000;

#[derive(Default)]
struct Comments {
    columns: Option<Columns>,
    format: bool,
    edges: Option<[f64; 3]>,
    /// The first comments that name no columns.
    others: Vec<String>,
}

pub(super) fn read(lines: &mut Lines<'_>, options: Options) -> anyhow::Result<Header> {
    let mut comments = Comments::default();
    let more = loop {
        if !lines.advance_over_blanks()? {
            break false;
        }
        if !is_comment(lines.line()) {
            break true;
        }
        comments.take(lines, options)?;
    };
    let mut table = if more {
        named_by(lines, &mut comments, options)?
    } else {
        // A comment that names columns is the header of a table without rows.
        let columns = comments.columns.take();
        let columns = columns.with_context(|| {
            format!("{} has neither a header nor rows; give another file", lines.source.name)
        })?;
        Header { columns, ..Header::default() }
    };
    table.format = if comments.format || comments.edges.is_some() { "YADE text" } else { "CSV" };
    table.place = lines.place();
    let columns = &mut table.columns;
    let by = Chosen::frame(options.columns, columns, &table.place, split::by_name)?;
    let split = by.map(|by| Split::new(by, columns, options)).transpose();
    table.split = split.with_context(|| table.place.clone())?;
    let asked = options.columns.is_some_and(|chosen| chosen.one_scene());
    let named = !table.assumed && table.split.is_none() && !asked;
    table.repeats = named.then(|| Repeats::new(&table.columns)).flatten();
    table.declared = comments.edges.map(|edges| {
        let periodic = Some(edges.map(|edge| edge > 0.0));
        Declared::between(&edges.map(|edge| [0.0, edge]), periodic)
    });
    table.comments = comments.others;
    table.is_row = more && (table.is_row || lines.advance()?);
    Ok(table)
}

impl Comments {
    fn take(&mut self, lines: &Lines<'_>, options: Options) -> anyhow::Result<()> {
        let text = lines.text();
        if let Some(edges) = text.strip_prefix("##PERIODIC::") {
            self.edges = edges_of(edges, options).with_context(|| lines.place())?;
            return Ok(());
        }
        let text = text.trim_start_matches(['#', '%', '!', '/']).trim();
        let (columns, is_format) = match text.strip_prefix("format ") {
            Some(format) => {
                let names = format.trim().split('_').take_while(|name| *name != "attrs");
                let or_more = format.ends_with("attrs");
                (Columns { or_more, ..Columns::named(names) }, true)
            }
            None => (named(text.as_bytes()), false),
        };
        let chosen = columns.chosen("", options.columns).ok().filter(Columns::has_places);
        if chosen.is_some() && (is_format || !self.format) {
            self.columns = chosen;
        } else if self.others.len() < MOST_COMMENTS {
            self.others.push(text.chars().take(LONGEST_COMMENT).collect());
        }
        self.format |= is_format;
        Ok(())
    }
}

fn edges_of(text: &str, options: Options) -> anyhow::Result<Option<[f64; 3]>> {
    let boundaries = options.boundaries;
    let numbers: Option<Vec<f64>> = words(text.as_bytes()).map(number).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|edge| edge.is_finite() && *edge >= 0.0) => {
            Ok(Some([x, y, z]))
        }
        _ if boundaries.replace_box() => Ok(None),
        _ => bail!("the three edges of the box are expected; fix them, or give --box or --open"),
    }
}

fn named(header: &[u8]) -> Columns {
    let cells = Separator::guess(header).cells(header);
    Columns::named(cells.map(decoded))
}

fn named_by(
    lines: &Lines<'_>,
    comments: &mut Comments,
    options: Options,
) -> anyhow::Result<Header> {
    let (place, line) = (lines.place(), header_of(lines.line()));
    let separator = Separator::guess(line);
    let table = Header { separator, ..Header::default() };
    let count = separator.cells(line).count();
    let is_number = |cell: &[u8]| number(cell).is_some();
    let numeric = separator.cells(line).all(is_number);
    let of_comment = comments.columns.take().filter(|columns| {
        let names = columns.meaning.len();
        names == count || columns.or_more && names < count
    });
    if let Some(columns) = of_comment.filter(|_| numeric || comments.format) {
        // YADE writes names of materials next to the numbers.
        return Ok(Header { columns, is_row: true, ..table });
    }
    let at = |k: usize| separator.cells(line).nth(k).is_some_and(is_number);
    let by_numbers = options.columns.and_then(|chosen| chosen.numbers());
    if numeric || by_numbers.is_some_and(|places| places.into_iter().all(at)) {
        let columns = unnamed(count, options, comments.edges.is_some(), &place)?;
        let assumed = !options.axes_chosen() && comments.edges.is_none();
        return Ok(Header { columns, assumed, is_row: true, ..table });
    }
    let header = named(line);
    let numbers = separator.cells(line).filter(|cell| is_number(cell)).count();
    let sound_names = header.has_places() || numbers < 2;
    if !sound_names {
        return Err(unclear!("{place}: numbers stand where the columns are named"));
    }
    let columns = Columns {
        or_fewer: separator != Separator::Blanks,
        ..header.chosen(&place, options.columns)?
    };
    Ok(Header { columns, ..table })
}

fn unnamed(
    count: usize,
    options: Options,
    is_packing: bool,
    place: &str,
) -> anyhow::Result<Columns> {
    if options.axes_chosen() {
        return Columns::numbered(count).chosen(place, options.columns);
    }
    let names = match (count, options) {
        (2, _) => "x y",
        (3, Options { dim: Some(2), .. }) => "x y r",
        (3, Options { dim: Some(3), .. } | Options { radius: Some(_), .. }) => "x y z",
        (4, _) => "x y z r",
        (5, _) if is_packing => "x y z r clumpId",
        _ => return Err(unclear!("{place}: {count} columns without a header such as x,y,z,r")),
    };
    Columns::of(names).chosen(place, options.columns)
}
