use serde_json::Value;

use crate::document::{self, Block, Text};
use crate::facts::Origin;
use crate::sections::trust::conditions;
use contactbench_terms::text::html as escape;

impl Origin {
    pub fn machine(&self) -> impl Iterator<Item = Block> {
        conditions::machine(&self.conditions).into_iter().map(Block::paragraph)
    }

    pub fn programs(&self, level: u8) -> Vec<Block> {
        match conditions::programs(&self.ledger) {
            none if none.is_empty() => Vec::new(),
            all => {
                let all = Block::List(all.into_iter().map(Text::from).collect());
                vec![Block::heading(level, "Programs"), all]
            }
        }
    }

    pub(super) fn method(&self) -> String {
        let Some(Value::Object(fields)) = &self.provenance else {
            return "<p>This folder has no provenance.json: nothing is known.</p>".into();
        };
        let line = |(name, value): (&String, &Value)| {
            let (name, value) = (escape(&name.replace('_', " ")), escape(&shown(value)));
            format!("<dt>{name}</dt><dd>{value}</dd>\n")
        };
        let fields: String = fields.iter().map(line).collect();
        let load = document::html(&self.machine().collect::<Vec<_>>());
        format!("{load}<dl>\n{fields}</dl>\n{}", document::html(&self.programs(3)))
    }

    pub(super) fn commands(&self) -> String {
        let revision = self.provenance.as_ref().and_then(|fields| fields.get("revision")?.as_str());
        let mut lines: Vec<String> =
            revision.iter().map(|revision| format!("git checkout {revision}")).collect();
        lines.push("cargo install --path .".into());
        lines.extend(self.provenance.iter().chain(&self.resumed).filter_map(command));
        let note = "contactbench report FOLDER   # makes this page again, from the record alone";
        lines.push(note.into());
        let note = match self.conditions.dirty {
            Some(true) => "<p>The checkout had changes that were not committed.</p>",
            _ => "",
        };
        format!("<pre tabindex=\"0\">{}</pre>{note}", escape(&lines.join("\n")))
    }
}

/// Returns the command of a run as it was typed.
pub fn command(provenance: &Value) -> Option<String> {
    provenance.get("command").map(shown)
}

pub fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), String::from)
}
