//! Text that comes from outside, made harmless: one function per language that is written.

pub use contactbench_terms::text::html;

/// Text for Markdown: nothing that Markdown would take for markup, no line breaks.
pub fn markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '|' | '*' | '_' | '<' | '>' | '`' | '\\' | '[' | ']' | '#' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// One line of text, as a comment needs it.
pub fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() || c == '\u{2028}' || c == '\u{2029}' { ' ' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_becomes_markup() {
        assert_eq!(markdown("a|b*c_d<e>\n`f`[g]#"), "a\\|b\\*c\\_d\\<e\\> \\`f\\`\\[g\\]\\#");
        assert_eq!(one_line("a\nb\u{2028}c"), "a b c");
    }
}
