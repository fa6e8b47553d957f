//! The help screens: verbs in groups, and examples.

use std::fmt::Write;

use clap::builder::{StyledStr, Styles};
use clap::{Command, Subcommand};
use contactbench_terms::number::wrap;

use crate::cli::shared::terminal;
use crate::cli::{GROUPS, Verb};

/// Formats the help of the program: its verbs by group, one line each.
pub fn template() -> StyledStr {
    let verbs = Verb::augment_subcommands(Command::new(""));
    let mut verbs = verbs.get_subcommands();
    let styles = Styles::styled();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let mut text = String::from("{about-with-newline}\n{usage-heading} {usage}\n");
    for (title, count) in GROUPS {
        let _ = writeln!(text, "\n{header}{title}:{header:#}");
        for verb in verbs.by_ref().take(*count) {
            let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
            let name = verb.get_name();
            let lines = wrap(&about, terminal::width().saturating_sub(16));
            let _ = writeln!(text, "  {literal}{name:14}{literal:#}{}", lines.join(INDENT));
        }
    }
    let _ = write!(text, "\n{header}Options:{header:#}\n{{options}}{{after-help}}");
    text.into()
}

/// A line break, and the indentation of continued descriptions of verbs.
const INDENT: &str = "\n                ";

/// Formats the end of a verb's help: its examples, and where to read more.
pub fn examples(examples: &[&str], more: &str) -> String {
    let mut text = String::from("Examples:\n");
    for example in examples {
        let _ = writeln!(text, "  contactbench {example}");
    }
    let _ = write!(text, "\nMore: {more}");
    text
}
