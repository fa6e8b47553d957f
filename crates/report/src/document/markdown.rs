use super::{Block, Style, Text};
use contactbench_terms::text::is_control;

pub fn markdown(blocks: &[Block]) -> String {
    blocks.iter().map(|block| block_text(block) + "\n").collect()
}

fn block_text(block: &Block) -> String {
    match block {
        Block::Heading(level, text) => {
            format!("{} {}\n", "#".repeat((*level).clamp(1, 6).into()), words(text))
        }
        Block::Paragraph(text) => words(text) + "\n",
        Block::Warning(text) => format!("> Warning: {}\n", words(text)),
        Block::List(items) => items.iter().map(|item| format!("* {}\n", words(item))).collect(),
        // The fence must be longer than any fence in the text.
        Block::Code(text) => format!("````text\n{}\n````\n", text.replace("````", "'")),
        Block::Table(table) => table.markdown(),
        Block::Figure { title, path } => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            format!("![{}](figures/{name})\n", escaped(title))
        }
    }
}

fn words(text: &Text) -> String {
    text.written([["**"; 2], ["*"; 2], ["`"; 2]], |style, text| match style {
        Style::Code => text.replace(is_control, " ").replace('`', "'"),
        _ => escaped(text),
    })
}

/// Escapes line breaks and characters that Markdown would read as markup.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '|' | '*' | '_' | '<' | '>' | '`' | '\\' | '[' | ']' | '#' => out.extend(['\\', c]),
            c if is_control(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn nothing_becomes_markup() {
        assert_eq!(escaped("a|b*c_d<e>\n`f`[g]#"), "a\\|b\\*c\\_d\\<e\\> \\`f\\`\\[g\\]\\#");
        assert_eq!(escaped("a\u{202e}b\u{1b}"), "a b ");
    }
}
