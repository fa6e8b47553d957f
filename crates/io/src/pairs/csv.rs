//! Contact lists in tables: two columns of whole numbers, and optional image and frame columns.
//!
//! The columns are named by a header, which may be a comment, or are the first ones. Comments start
//! with `#` or, as in MATLAB, with `%`, and may follow a row.

use anyhow::{Context, bail, ensure};

use super::Rows;
use super::columns::Columns;
use super::list::List;
use crate::frames::Choice;
use crate::raw::lines::{
    Lines, Separator, decoded, header_of, is_comment, number, shown, uncommented, whole,
};

pub(super) struct Csv<'a> {
    lines: Lines<'a>,
    chosen: &'a [&'a str],
    layout: Layout,
    columns: Option<Columns>,
    ahead: bool,
}

fn is_header(names: &[String]) -> bool {
    let named = |name: &String| name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    names.iter().all(|name| named(name) && number(name.as_bytes()).is_none())
}

fn is_pair(names: &[String]) -> bool {
    matches!(Columns::named(names, &[], String::new), Ok(Some(_)))
}

#[derive(Default)]
struct Layout {
    separator: Separator,
    /// Columns of the table; `None` if the file has no rows.
    columns: Option<Columns>,
    label: Option<Label>,
}

#[derive(Clone, Copy)]
struct Label {
    column: usize,
    /// Whether the column has time steps instead of frame numbers.
    is_step: bool,
}

impl Label {
    fn named(names: &[String]) -> Option<Label> {
        let at = |names_of: &[&str]| {
            names.iter().position(|name| names_of.iter().any(|it| it.eq_ignore_ascii_case(name)))
        };
        let of = |is_step: bool| move |column: usize| Label { column, is_step };
        at(&["frame"]).map(of(false)).or_else(|| at(&["step", "timestep"]).map(of(true)))
    }

    fn of(self, cells: &[&[u8]], lines: &Lines<'_>) -> anyhow::Result<i64> {
        let cell = cells.get(self.column).copied().unwrap_or_default();
        let label = whole(cell).filter(|&label| self.is_step || label >= 0);
        label.with_context(|| {
            let (place, found, column) = (lines.place(), shown(cell), self.column + 1);
            let name = if self.is_step { "step" } else { "frame" };
            format!("{place}: column {column}: '{found}' is not a {name}")
        })
    }
}

impl<'a> Csv<'a> {
    pub fn new(lines: Lines<'a>, chosen: &'a [&'a str]) -> Csv<'a> {
        let layout = Layout::default();
        Csv { lines, chosen, layout, columns: None, ahead: false }
    }

    fn header(&mut self) -> anyhow::Result<()> {
        let Csv { lines, chosen, .. } = self;
        while self.layout.columns.is_none() && lines.advance()? {
            let line = lines.line();
            if line.is_empty() {
                continue;
            }
            let comment = is_comment(line);
            let line = header_of(if comment { line[1..].trim_ascii() } else { line });
            let separator = Separator::guess(line);
            let cells: Vec<&[u8]> = separator.cells(line).collect();
            let names: Vec<String> = cells.iter().map(|cell| decoded(cell)).collect();
            let place = || lines.place();
            let header = is_header(&names) || is_pair(&names);
            let label = if header { Label::named(&names) } else { None };
            if comment {
                let named = Columns::named(&names, chosen, place).ok().flatten();
                if let Some(columns) = named.filter(|_| header) {
                    self.layout = Layout { separator, columns: Some(columns), label };
                }
                continue;
            }
            ensure!(cells.len() >= 2, "{}: a pair needs two columns; write i,j", place());
            let numbers = || (1..=cells.len()).map(|k| k.to_string()).collect();
            let names = if header { names } else { numbers() };
            let named = Columns::named(&names, chosen, place)?;
            let columns = match named {
                None if header => {
                    bail!("{lines}: which columns hold the pair? --pairs-columns I,J")
                }
                named => named.unwrap_or_else(|| Columns::bare(names.len())),
            };
            self.layout = Layout { separator, columns: Some(columns), label };
            self.ahead = !header;
        }
        if let Layout { columns: Some(columns), label: Some(label), .. } = &mut self.layout {
            columns.known(label.column);
        }
        Ok(())
    }
}

impl Rows for Csv<'_> {
    fn begin(&mut self, choice: &mut Choice) -> anyhow::Result<()> {
        self.header()?;
        choice.sparse = self.layout.label.is_some();
        choice.by_step = self.layout.label.is_some_and(|label| label.is_step);
        Ok(())
    }

    fn advance(&mut self) -> anyhow::Result<Option<i64>> {
        let Csv { lines, layout: Layout { separator, columns, label }, .. } = self;
        while columns.is_some() && (std::mem::take(&mut self.ahead) || lines.advance()?) {
            let line = uncommented(lines.line());
            if !line.is_empty() && !is_comment(line) {
                let cells: Vec<&[u8]> = separator.cells(line).collect();
                return label.map_or(Ok(0), |label| label.of(&cells, lines)).map(Some);
            }
        }
        Ok(None)
    }

    fn place(&self) -> String {
        self.lines.place()
    }

    fn take(&mut self, list: &mut List) -> anyhow::Result<()> {
        let Some(columns) = &mut self.columns else { return Ok(()) };
        let cells: Vec<&[u8]> =
            self.layout.separator.cells(uncommented(self.lines.line())).collect();
        columns.push(&self.lines, &cells, list)
    }

    fn list(&mut self) -> List {
        self.columns = self.layout.columns.clone();
        List { format: "CSV", ..List::default() }
    }

    fn end(&mut self, list: &mut List) {
        self.columns.take().into_iter().for_each(|columns| columns.end(list));
    }
}
