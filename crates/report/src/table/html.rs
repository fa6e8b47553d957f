use std::fmt::Write as _;

use super::{Cell, Column, Table};
use contactbench_terms::text::html as escape;

impl Table {
    /// Formats a table of this class, or of none if it is empty; it scrolls if it is wider than the
    /// page. Numbers have the class `number`.
    pub fn html(&self, class: &str) -> String {
        let side = |column: &Column| if column.right { " class=\"number\"" } else { "" };
        let mut out = format!("<div class=\"scroll\" tabindex=\"0\"><table class=\"{class}\">");
        if !self.title.is_empty() {
            let _ = write!(out, "<caption>{}</caption>", escape(&self.title));
        }
        out += "<thead><tr>";
        for column in &self.columns {
            let _ = write!(out, "<th{}>{}</th>", side(column), escape(&column.head()));
        }
        out += "</tr></thead><tbody>\n";
        for row in &self.rows {
            out += "<tr>";
            for (cell, column) in row.iter().zip(&self.columns) {
                let lines: Vec<String> = cell.lines().iter().map(|it| escape(it)).collect();
                let text = cell.shown(lines.join("<br>"), ["<strong>", "</strong>"]);
                let text = match cell {
                    Cell::Link(_, to) => format!("<a href=\"{}\">{text}</a>", escape(to)),
                    _ => text,
                };
                let _ = write!(out, "<td{}>{text}</td>", side(column));
            }
            out += "</tr>\n";
        }
        out + "</tbody></table></div>\n"
    }
}
