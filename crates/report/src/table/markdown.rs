use super::{Cell, Column, Table};
use crate::document::escaped;

impl Table {
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut out = match self.title.as_str() {
            "" => String::new(),
            title => format!("**{}**\n\n", escaped(title)),
        };
        let rule = |column: &Column| if column.right { "---:" } else { "---" }.to_string();
        out += &line(self.columns.iter().map(|it| escaped(&it.head())).collect());
        out += &line(self.columns.iter().map(rule).collect());
        let shown = |cell: &Cell| cell.shown(escaped(&cell.to_string()), ["**"; 2]);
        out.extend(self.rows.iter().map(|row| line(row.iter().map(shown).collect())));
        out
    }
}
