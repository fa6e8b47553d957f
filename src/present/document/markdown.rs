use super::{Block, Span, Text};
use crate::present::escape;

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
        Block::Figure { title, paths } => {
            let name = |kind: &str| {
                let path = paths.iter().find(|it| it.extension().is_some_and(|it| it == kind))?;
                Some(path.file_name()?.to_string_lossy().into_owned())
            };
            match (name("png"), name("svg")) {
                (Some(png), Some(svg)) => format!(
                    "![{}](figures/{png})\n\n[as SVG](figures/{svg})\n",
                    escape::markdown(title)
                ),
                _ => escape::markdown(title) + "\n",
            }
        }
    }
}

fn words(text: &Text) -> String {
    let span = |span: &Span| match span {
        Span::Plain(text) => escape::markdown(text),
        Span::Strong(text) => format!("**{}**", escape::markdown(text)),
        Span::Emphasis(text) => format!("*{}*", escape::markdown(text)),
        Span::Code(text) => format!("`{}`", escape::one_line(text).replace('`', "'")),
        Span::Link { text, target } => format!("[{}]({target})", escape::markdown(text)),
    };
    text.0.iter().map(span).collect()
}
