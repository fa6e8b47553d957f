//! Escaping of text that comes from outside (file names, messages of runners, names of columns,
//! lines of files) before it is printed.
//!
//! Terminals obey escape sequences. Logs of continuous integration obey commands: `::error::` or
//! `::add-mask::` at the start of a line, and `##[error]` anywhere.

use std::borrow::Cow;

/// Escapes one line of text: control characters and line breaks become U+FFFD, and workflow
/// commands are broken up.
pub fn line(text: &str) -> Cow<'_, str> {
    if text.chars().any(is_control) || commands(text) {
        Cow::Owned(apart(&text.replace(is_control, "\u{fffd}")))
    } else {
        Cow::Borrowed(text)
    }
}

/// Escapes several lines of text like [`line()`], but keeps line feeds and tabs.
pub fn lines(text: &str) -> Cow<'_, str> {
    let harmful = |c: char| is_control(c) && !matches!(c, '\n' | '\t');
    if text.chars().any(harmful) || text.split('\n').any(commands) {
        let clean = text.replace(harmful, "\u{fffd}");
        Cow::Owned(clean.split('\n').map(apart).collect::<Vec<_>>().join("\n"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Escapes text for a cell of a CSV file. Control characters become U+FFFD. An apostrophe is put in
/// front of text that a spreadsheet would take for a formula: it begins with `=`, `+`, `-` or `@`
/// and is not a number.
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    let formula = text.starts_with(['=', '+', '-', '@']) && text.parse::<f64>().is_err();
    match (formula, text.contains(is_control)) {
        (false, false) => Cow::Borrowed(text),
        (formula, _) => Cow::Owned(
            ["", "'"][usize::from(formula)].to_string() + &text.replace(is_control, "\u{fffd}"),
        ),
    }
}

/// Cuts the middle out of a text of over 4,000 characters.
pub fn shortened(text: &str) -> Cow<'_, str> {
    let Some((cut, _)) = text.char_indices().nth(LONGEST) else { return Cow::Borrowed(text) };
    let (head, tail) = (text.floor_char_boundary(cut / 2), text.len() - cut / 2);
    let tail = text.ceil_char_boundary(tail);
    Cow::Owned(format!("{} ... {}", &text[..head], &text[tail..]))
}

/// Longest line that is printed whole, in characters.
const LONGEST: usize = 4000;

/// Whether the character controls a terminal, or changes the order or the end of a line.
pub fn is_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn commands(line: &str) -> bool {
    line.trim_start().starts_with("::") || line.contains("##[")
}

fn apart(line: &str) -> String {
    let line = line.replace("##[", "# #[");
    let start = line.len() - line.trim_start().len();
    match line[start..].strip_prefix("::") {
        Some(rest) => format!("{}: :{rest}", &line[..start]),
        None => line,
    }
}

/// Escapes text for HTML and XML, between tags or in a quoted attribute. Characters that are
/// invalid in both become U+FFFD.
pub fn html(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            '\t' | '\n' | '\r' => out.push(c),
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c if is_control(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Replaces each `{{name}}` of a template by its value, or by empty text if the value is missing.
/// Values are not searched for further names.
pub fn fill(template: &str, values: &[(&str, String)]) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        out += before;
        let Some((name, after)) = after.split_once("}}") else { break };
        out += values.iter().find(|(known, _)| *known == name).map_or("", |(_, value)| value);
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_becomes_markup() {
        let marked = html("<a href=\"x\">&'\u{1}\u{202e}");
        assert_eq!(marked, "&lt;a href=&quot;x&quot;&gt;&amp;&#39;\u{fffd}\u{fffd}");
    }

    #[test]
    fn terminals_and_logs_get_no_commands() {
        for (text, one, several) in [
            ("plain, é 三 …", "plain, é 三 …", "plain, é 三 …"),
            ("a\x1b[31mb\x07", "a\u{fffd}[31mb\u{fffd}", "a\u{fffd}[31mb\u{fffd}"),
            ("a\n::error::b", "a\u{fffd}::error::b", "a\n: :error::b"),
            (" \t::add-mask::x", " \u{fffd}::add-mask::x", " \t: :add-mask::x"),
            ("::stop-commands::x", ": :stop-commands::x", ": :stop-commands::x"),
            ("a ##[error]b", "a # #[error]b", "a # #[error]b"),
            (
                "a\u{9b}2J\u{202e}b\r",
                "a\u{fffd}2J\u{fffd}b\u{fffd}",
                "a\u{fffd}2J\u{fffd}b\u{fffd}",
            ),
        ] {
            assert_eq!((&*line(text), &*lines(text)), (one, several));
        }
    }

    #[test]
    fn cells_hold_no_formulas_and_numbers_stay() {
        for text in ["=1+1", "+a", "-a", "@a", "=", "-1-1"] {
            assert_eq!(csv_cell(text), format!("'{text}"));
        }
        assert_eq!(csv_cell("\ta\u{1b}[31m"), "\u{fffd}a\u{fffd}[31m");
        for text in ["", "-1", "+1e5", "-inf", "a=b", "nbs", "1-1"] {
            assert_eq!(csv_cell(text), text);
        }
    }

    #[test]
    fn a_long_text_is_cut_in_its_middle() {
        let [whole, long] = [LONGEST, 100_000].map(|length| "\u{e9}".repeat(length) + "b");
        assert_eq!(shortened(&whole[..2 * LONGEST]), whole[..2 * LONGEST]);
        let cut = shortened(&long);
        assert!(cut.len() < 3 * LONGEST && cut.ends_with('b') && cut.contains(" ... "), "{cut}");
    }

    #[test]
    fn templates_are_filled_once() {
        let values = [("a", "{{b}}".to_string()), ("b", "2".to_string())];
        assert_eq!(fill("<{{a}}{{b}}{{none}}>", &values), "<{{b}}2>");
    }
}
