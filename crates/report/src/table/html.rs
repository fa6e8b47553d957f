use std::fmt::Write as _;

use super::{Cell, Table};
use contactbench_terms::text::html as escape;

impl Table {
    /// Formats a table that scrolls if it is wider than the page. Numbers have the class `number`.
    pub fn html(&self) -> String {
        self.html_with("", &|_, _| String::new())
    }

    /// Formats the table as [`Table::html`] does, with a class, and with markup (such as a picture)
    /// before the value of each cell. `before` gets row and column; `None` is the header row.
    pub fn html_with(
        &self,
        class: &str,
        before: &dyn Fn(Option<usize>, usize) -> String,
    ) -> String {
        let mut out = String::from("<div class=\"scroll\" tabindex=\"0\"><table");
        if !class.is_empty() {
            let _ = write!(out, " class=\"{class}\"");
        }
        out.push('>');
        if !self.title.is_empty() {
            let _ = write!(out, "<caption>{}</caption>", escape(&self.title));
        }
        let sides = self.columns.iter().map(|it| if it.right { " class=\"number\"" } else { "" });
        out += "<thead><tr>";
        for (k, (column, side)) in self.columns.iter().zip(sides.clone()).enumerate() {
            let head = escape(&column.head());
            let _ = write!(out, "<th{side}>{}{head}</th>", before(None, k));
        }
        out += "</tr></thead><tbody>\n";
        for (j, row) in self.rows.iter().enumerate() {
            out += "<tr>";
            for (k, (cell, side)) in row.iter().zip(sides.clone()).enumerate() {
                let lines: Vec<String> = cell.lines().iter().map(|it| escape(it)).collect();
                let text = match cell {
                    Cell::Link(_, to) => {
                        format!("<a href=\"{}\">{}</a>", escape(to), lines.join(""))
                    }
                    _ => cell.shown(lines.join("<br>"), ["<strong>", "</strong>"]),
                };
                let _ = write!(out, "<td{side}>{}{text}</td>", before(Some(j), k));
            }
            out += "</tr>\n";
        }
        out + "</tbody></table></div>\n"
    }
}
