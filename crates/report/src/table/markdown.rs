use super::{Align, Cell, Table};
use crate::escape;

impl Table {
    /// The title in bold, and the table.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut out = match self.title.as_str() {
            "" => String::new(),
            title => format!("**{}**\n\n", escape::markdown(title)),
        };
        out += &line(self.columns.iter().map(|it| escape::markdown(&it.head())).collect());
        let rule = |align| if align == Align::Right { "---:" } else { "---" };
        out += &line(self.columns.iter().map(|column| rule(column.align).into()).collect());
        for row in &self.rows {
            out += &line(row.iter().map(shown).collect());
        }
        out
    }
}

fn shown(cell: &Cell) -> String {
    let text = escape::markdown(&cell.value.to_string());
    if cell.strong && !text.is_empty() { format!("**{text}**") } else { text }
}
