use super::{Block, Span, Text};
use crate::escape;

/// The blocks in Markdown, an empty line after each.
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
        // A fence longer than any in the text.
        Block::Code(text) => format!("````text\n{}\n````\n", text.replace("````", "'")),
        Block::Table(table) => table.markdown(),
        Block::Figure { title, path } => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            format!("![{}](figures/{name})\n", escape::markdown(title))
        }
    }
}

fn words(text: &Text) -> String {
    let span = |span: &Span| match span {
        Span::Plain(text) => escape::markdown(text),
        Span::Strong(text) => format!("**{}**", escape::markdown(text)),
        Span::Emphasis(text) => format!("*{}*", escape::markdown(text)),
        Span::Code(text) => format!("`{}`", escape::one_line(text).replace('`', "'")),
    };
    text.0.iter().map(span).collect()
}
