//! Where a record is from: its machine, and the commands that made it.

use serde_json::Value;

use super::Page;
use crate::escape::html as escape;
use crate::sections::conditions;

impl Page<'_> {
    pub(super) fn machine(&self) -> String {
        let Some(Value::Object(fields)) = self.origin.provenance else {
            return "<p>This folder has no provenance.json: nothing is known.</p>".into();
        };
        let line = |(name, value): (&String, &Value)| {
            format!(
                "<dt>{}</dt><dd>{}</dd>\n",
                escape(&name.replace('_', " ")),
                escape(&shown(value))
            )
        };
        let fields = fields.iter().map(line).collect::<String>();
        let machine = conditions::machine(self.origin.conditions).into_iter();
        let load = machine.map(|said| format!("<p>{}</p>\n", escape(&said))).collect::<String>();
        let programs = conditions::programs(self.origin.ledger);
        let programs = programs.iter().map(|said| format!("<li>{}</li>\n", escape(said)));
        let programs = match programs.collect::<String>() {
            none if none.is_empty() => none,
            items => format!("<h3>Programs</h3>\n<ul>\n{items}</ul>\n"),
        };
        format!("{load}<dl>\n{fields}</dl>\n{programs}")
    }

    /// The commands that made the record and this page.
    pub(super) fn commands(&self) -> String {
        let made = self.origin.provenance.into_iter().chain(&self.resumed);
        let mut lines: Vec<String> =
            made.filter_map(|fields| fields.get("command")).map(command).collect();
        lines.push("contactbench report FOLDER".into());
        let comments = ["# makes this page again, from the record alone"];
        let revision = self
            .origin
            .provenance
            .and_then(|fields| fields.get("revision")?.as_str())
            .map(|revision| format!("git checkout {revision}"));
        let dirty = self.origin.conditions.dirty == Some(true);
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
