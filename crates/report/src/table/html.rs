use std::fmt::Write as _;

use super::{Align, Cell, Table};
use crate::escape;

impl Table {
    /// A table that scrolls by itself where it is wider than the page; numbers have the class
    /// `number`.
    pub fn html(&self) -> String {
        self.html_with("", &|_, _| String::new())
    }

    /// The same with a class, and with markup before the value of a cell (a picture, say) by row
    /// and column; the row of the heads is none.
    pub fn html_with(
        &self,
        class: &str,
        before: &dyn Fn(Option<usize>, usize) -> String,
    ) -> String {
        let mut out = String::from("<div class=\"scroll\" tabindex=\"0\"><table");
        if !class.is_empty() {
            let _ = write!(out, " class=\"{}\"", escape::html(class));
        }
        out.push('>');
        if !self.title.is_empty() {
            let _ = write!(out, "<caption>{}</caption>", escape::html(&self.title));
        }
        out += "<thead><tr>";
        let side = |column: usize| match self.columns.get(column).map(|column| column.align) {
            Some(Align::Right) => " class=\"number\"",
            _ => "",
        };
        for (k, column) in self.columns.iter().enumerate() {
            let (side, before) = (side(k), before(None, k));
            let _ = write!(out, "<th{side}>{before}{}</th>", escape::html(&column.head()));
        }
        out += "</tr></thead><tbody>\n";
        for (j, row) in self.rows.iter().enumerate() {
            out += "<tr>";
            for (k, cell) in row.iter().enumerate() {
                let _ = write!(out, "<td{}>{}{}</td>", side(k), before(Some(j), k), shown(cell));
            }
            out += "</tr>\n";
        }
        out + "</tbody></table></div>\n"
    }
}

fn shown(cell: &Cell) -> String {
    let lines: Vec<String> = cell.value.lines().iter().map(|line| escape::html(line)).collect();
    let text = lines.join("<br>");
    if cell.strong && !text.is_empty() { format!("<strong>{text}</strong>") } else { text }
}
