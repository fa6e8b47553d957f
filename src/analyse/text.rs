//! Words and numbers for reports: figures with four digits, wrapped text, tables for terminals and for Markdown.

/// A number with about four significant digits; whole numbers below 10^7 in full.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        return value.to_string();
    }
    if value == value.round() && size < 1e7 {
        return format!("{value:.0}");
    }
    match size {
        s if !(1e-3..1e7).contains(&s) => {
            let text = format!("{value:.3e}");
            match text.split_once('e') {
                Some((mantissa, power)) if mantissa.ends_with(".000") => format!("{}e{power}", mantissa.trim_end_matches(".000")),
                _ => text,
            }
        }
        s if s < 1.0 => format!("{value:.4}"),
        s if s < 10.0 => format!("{value:.3}"),
        s if s < 100.0 => format!("{value:.2}"),
        s if s < 1000.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// A fraction as a percentage.
pub fn percent(fraction: f64) -> String {
    let value = 100.0 * fraction;
    if value == 0.0 {
        "0%".into()
    } else if value.abs() < 1e-3 {
        "< 0.001%".into()
    } else if value.abs() < 0.1 {
        format!("{value:.3}%")
    } else if value.abs() < 10.0 {
        format!("{value:.1}%")
    } else {
        format!("{value:.0}%")
    }
}

/// `1 cell`, `2 cells`.
pub fn plural(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// Breaks text into lines of at most `width` characters; longer words are cut.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let (mut lines, mut line, mut length) = (Vec::new(), String::new(), 0);
    for word in text.split_whitespace() {
        let mut word: Vec<char> = word.chars().collect();
        if length > 0 && length + 1 + word.len() > width {
            lines.push(std::mem::take(&mut line));
            length = 0;
        }
        while word.len() > width {
            let rest = word.split_off(width);
            lines.push(std::mem::replace(&mut word, rest).into_iter().collect());
        }
        if length > 0 {
            line.push(' ');
            length += 1;
        }
        length += word.len();
        line.extend(word);
    }
    if !line.is_empty() || lines.is_empty() {
        lines.push(line);
    }
    lines
}

/// A table for terminals: columns with the given greatest widths, cells wrapped, two spaces between.
pub fn plain_table(widths: &[usize], rows: &[Vec<String>]) -> String {
    let width = |column: usize, limit: usize| {
        let longest = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0);
        longest.min(limit)
    };
    let widths: Vec<usize> = widths.iter().enumerate().map(|(column, &limit)| width(column, limit)).collect();
    let mut out = String::new();
    for row in rows {
        let cells: Vec<Vec<String>> = row.iter().zip(&widths).map(|(cell, &width)| wrap(cell, width)).collect();
        for line in 0..cells.iter().map(Vec::len).max().unwrap_or(0) {
            let mut text = String::new();
            for (cell, &width) in cells.iter().zip(&widths) {
                let piece = cell.get(line).map_or("", String::as_str);
                text.push_str(piece);
                text.extend(std::iter::repeat_n(' ', width - piece.chars().count().min(width) + 2));
            }
            out.push_str(text.trim_end());
            out.push('\n');
        }
    }
    out
}

/// A field of a CSV file, in quotes where it needs them.
pub fn quote(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

/// A cell of a Markdown table: no line breaks, no bars, nothing that Markdown would take for markup.
pub fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '|' | '*' | '_' | '<' | '>' | '`' | '\\' | '[' | ']' | '#' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A Markdown table; columns named with a leading `>` are aligned to the right.
pub fn markdown_table(heads: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut out = line(heads.iter().map(|head| head.trim_start_matches('>').to_string()).collect());
    out += &line(heads.iter().map(|head| if head.starts_with('>') { "---:" } else { "---" }.to_string()).collect());
    for row in rows {
        out += &line(row.iter().map(|cell| escape(cell)).collect());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (4.0004, "4.000"),
            (12.0, "12"),
            (499_500.0, "499500"),
            (1e8, "1e8"),
            (1.25e9, "1.250e9"),
            (0.5, "0.5000"),
            (1e-9, "1e-9"),
            (-3.25, "-3.250"),
            (123_456.7, "123457"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!((percent(0.003), percent(0.5), percent(1e-7)), ("0.3%".into(), "50%".into(), "< 0.001%".into()));
    }

    #[test]
    fn tables_keep_their_width() {
        assert_eq!(wrap("one two abcdefgh", 5), ["one", "two", "abcde", "fgh"]);
        assert_eq!(wrap("", 5), [""]);
        let table = plain_table(&[5, 9], &[vec!["a".into(), "one two three".into()], vec!["bb".into(), "four".into()]]);
        assert_eq!(table, "a   one two\n    three\nbb  four\n");
        assert_eq!(markdown_table(&["a", ">b"], &[vec!["x|y".into(), "1".into()]]), "| a | b |\n| --- | ---: |\n| x\\|y | 1 |\n");
    }
}
