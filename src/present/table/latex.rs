use std::fmt::Write as _;

use super::{Align, Cell, Table, Value};
use crate::present::escape;

impl Table {
    /// A `tabular` with the lines of the package booktabs. A thin line stands before each row that
    /// begins a group: one whose first cell is not empty, where others are.
    pub fn latex(&self) -> String {
        let sides = self.columns.iter().map(|column| match column.align {
            Align::Left => 'l',
            Align::Right => 'r',
        });
        let mut out = format!("\\begin{{tabular}}{{{}}}\n\\toprule\n", sides.collect::<String>());
        if !self.title.is_empty() {
            let (count, title) = (self.columns.len(), escape::latex(&self.title));
            let _ = writeln!(out, "\\multicolumn{{{count}}}{{l}}{{{title}}} \\\\\n\\midrule");
        }
        let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
        let name = |name: &str| {
            let text = escape::latex(name);
            if text == "N" { "$N$".into() } else { text.replace("/ N", "/ $N$") }
        };
        out += &line(self.columns.iter().map(|column| name(&column.name)).collect());
        if self.columns.iter().any(|column| !column.unit.is_empty()) {
            let unit = |unit: &str| match unit {
                "" => String::new(),
                unit => format!("({})", escape::latex(unit)),
            };
            out += &line(self.columns.iter().map(|column| unit(column.unit)).collect());
        }
        let empty = |row: &Vec<Cell>| row.first().is_some_and(|cell| cell.value.is_empty());
        let grouped = self.rows.iter().any(empty);
        for (k, row) in self.rows.iter().enumerate() {
            if k == 0 || grouped && !empty(row) {
                out += "\\midrule\n";
            }
            out += &line(row.iter().map(shown).collect());
        }
        out + "\\bottomrule\n\\end{tabular}\n"
    }
}

impl Value {
    fn is_empty(&self) -> bool {
        matches!(self, Value::Text(text) if text.is_empty())
    }
}

fn shown(cell: &Cell) -> String {
    let text = printed(&cell.value);
    if cell.strong && !text.is_empty() { format!("\\textbf{{{text}}}") } else { text }
}

fn printed(value: &Value) -> String {
    match value {
        Value::Text(_) | Value::Lines(_) => escape::latex(&value.to_string()),
        Value::Wrong(value) => format!("wrong ({})", printed(value)),
        value => numbers(&value.to_string()),
    }
}

/// Numbers of a cell: `3.2e8` as a power of ten, ranges with a dash.
fn numbers(text: &str) -> String {
    let word = |word: &str| match word.split_once('e') {
        Some((mantissa, power))
            if mantissa.parse::<f64>().is_ok() && power.parse::<i32>().is_ok() =>
        {
            format!("${mantissa}\\times10^{{{power}}}$")
        }
        _ => escape::latex(word),
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ").replace(" to ", "--")
}
