//! Where a record is from: its machine, and the commands that made it.

use serde_json::Value;

use super::Page;
use crate::present::escape::html as escape;

impl Page<'_> {
    pub(super) fn machine(&self) -> String {
        let Some(Value::Object(fields)) = self.provenance else {
            return "<p>This folder has no provenance.json: nothing is known.</p>".into();
        };
        let line = |(name, value): (&String, &Value)| {
            format!(
                "<dt>{}</dt><dd>{}</dd>\n",
                escape(&name.replace('_', " ")),
                escape(&shown(value))
            )
        };
        format!("<dl>\n{}</dl>", fields.iter().map(line).collect::<String>())
    }

    /// The commands that made the record and this page.
    pub(super) fn commands(&self) -> String {
        let made = self.provenance.into_iter().chain(&self.resumed);
        let mut lines: Vec<String> =
            made.filter_map(|fields| fields.get("command")).map(command).collect();
        lines.push("contactbench report FOLDER".into());
        let comments = ["# makes this page again, from the record alone"];
        let revision = self
            .provenance
            .and_then(|fields| fields.get("revision")?.as_str())
            .map(|revision| format!("git checkout {revision}"));
        let dirty =
            self.provenance.is_some_and(|fields| fields.get("dirty") == Some(&Value::Bool(true)));
        let last = lines.pop().map(|line| format!("{line}   {}", comments[0]));
        let text: Vec<String> = revision
            .into_iter()
            .chain(["cargo install --path .".into()])
            .chain(lines)
            .chain(last)
            .collect();
        let note =
            if dirty { "<p>The checkout had changes that were not committed.</p>" } else { "" };
        format!("<pre tabindex=\"0\">{}</pre>{note}", escape(&text.join("\n")))
    }
}

/// A command as it was typed; older records hold a list of words.
pub fn command(value: &Value) -> String {
    match value {
        Value::Array(words) => words.iter().map(shown).collect::<Vec<_>>().join(" "),
        word => shown(word),
    }
}

/// Text as it is, anything else as JSON.
pub fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), String::from)
}
