use super::{Block, Text};
use contactbench_terms::number::wrap;

/// Formats blocks for a terminal of this many columns, separated by empty lines. Figures are left
/// out.
pub fn plain(blocks: &[Block], width: usize) -> String {
    let texts: Vec<String> =
        blocks.iter().map(|block| block_text(block, width)).filter(|it| !it.is_empty()).collect();
    texts.join("\n")
}

fn block_text(block: &Block, width: usize) -> String {
    match block {
        Block::Heading(_, text) | Block::Paragraph(text) => indented("", &words(text), width),
        Block::Warning(text) => indented("warning: ", &words(text), width),
        Block::List(items) => {
            items.iter().map(|item| indented("* ", &words(item), width)).collect()
        }
        Block::Code(text) => format!("{text}\n"),
        Block::Table(table) => table.plain(width),
        Block::Figure { .. } => String::new(),
    }
}

/// Wraps text after a head; further lines are indented by the width of the head.
pub fn indented(head: &str, text: &str, width: usize) -> String {
    let indent = head.chars().count();
    let lines = wrap(text, width.saturating_sub(indent));
    format!("{head}{}\n", lines.join(&format!("\n{:indent$}", "")))
}

/// Returns the words without their style.
fn words(text: &Text) -> String {
    text.written([[""; 2]; 3], |_, text| text.into())
}
