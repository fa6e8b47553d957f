//! Output of a verb, written once for people and for programs.

use std::io::Write;

use serde_json::{Map, Value};

use crate::cli::shared::terminal;
use contactbench_report::document::indented;
use contactbench_report::table::Table;

/// Text and JSON of a verb. Each call adds to both, so that neither can lack a result.
pub struct Output {
    json: bool,
    width: usize,
    text: String,
    values: Map<String, Value>,
}

impl Output {
    /// Starts an empty output, printed as JSON or as text.
    pub fn new(json: bool) -> Output {
        Output { json, width: terminal::width(), text: String::new(), values: Map::new() }
    }

    /// Adds a line of text, and the values of a JSON object (`Value::Null` adds none). A label
    /// stands in a column of its own; long text is wrapped beside it. Without a label, long text
    /// keeps its indentation.
    pub fn line(&mut self, label: &str, text: impl AsRef<str>, values: Value) {
        let (text, labelled) = (text.as_ref(), !label.is_empty());
        let indent = text.len() - text.trim_start().len();
        self.hanging(&if labelled { format!("{label:<17} ") } else { " ".repeat(indent) }, text);
        self.values(values);
    }

    /// Adds a line of text without a label.
    pub fn text(&mut self, text: impl AsRef<str>) {
        self.line("", text, Value::Null);
    }

    /// Adds an empty line to the text.
    pub fn gap(&mut self) {
        self.text.push('\n');
    }

    /// Adds a table to the text, below an empty line.
    pub fn table(&mut self, table: &Table) {
        self.gap();
        self.text += table.plain(self.width).trim_end();
        self.gap();
    }

    /// Adds the values of a JSON object.
    pub fn values(&mut self, values: Value) {
        self.values.extend(values.as_object().cloned().into_iter().flatten());
    }

    /// Adds a warning: one of the array `warnings`, and a last line of the text.
    pub fn warn(&mut self, text: impl AsRef<str>) {
        let warnings = self.values.entry("warnings").or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(warnings) = warnings {
            warnings.push(text.as_ref().into());
        }
    }

    /// Prints the text, or one JSON object.
    pub fn print(self) -> std::io::Result<()> {
        match self.json {
            true => terminal::json(&Value::Object(self.values)),
            false => terminal::out().write_all(self.whole().as_bytes()),
        }
    }

    /// Returns the text with its warnings.
    fn whole(mut self) -> String {
        let warnings = self.values.remove("warnings");
        for warning in warnings.iter().flat_map(Value::as_array).flatten() {
            self.hanging("warning: ", warning.as_str().unwrap_or_default());
        }
        self.text
    }

    /// Adds `head`, and beside it `text`, wrapped and indented.
    fn hanging(&mut self, head: &str, text: &str) {
        for line in indented(head, text, self.width).lines() {
            self.text += line.trim_end();
            self.gap();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn text_is_wrapped_beside_its_label_and_values_are_collected() {
        let mut out = Output { width: 30, ..Output::new(true) };
        out.warn("the box is small");
        out.line("contacts", "12 of 34 pairs", json!({ "contacts": 12, "pairs": 34 }));
        out.line("", "  an indented line, which is wrapped", Value::Null);
        let values = json!({ "contacts": 12, "pairs": 34, "warnings": ["the box is small"] });
        assert_eq!(Value::Object(out.values.clone()), values);
        let lines = [
            "contacts          12 of 34",
            "                  pairs",
            "  an indented line, which is",
            "  wrapped",
            "warning: the box is small",
        ];
        assert_eq!(out.whole().lines().collect::<Vec<_>>(), lines);
    }
}
