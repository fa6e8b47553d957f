use super::{Block, Text};
use contactbench_terms::text::html as escape;

/// Returns the blocks as HTML. The page contains its figures.
pub fn html(blocks: &[Block]) -> String {
    blocks.iter().map(block_text).collect()
}

fn block_text(block: &Block) -> String {
    match block {
        Block::Heading(level, text) => {
            let level = level.clamp(&1, &6);
            format!("<h{level}>{}</h{level}>\n", words(text))
        }
        Block::Paragraph(text) => format!("<p>{}</p>\n", words(text)),
        Block::Warning(text) => format!("<p class=\"warning\">{}</p>\n", words(text)),
        Block::List(items) => {
            let items: String =
                items.iter().map(|item| format!("<li>{}</li>\n", words(item))).collect();
            format!("<ul>\n{items}</ul>\n")
        }
        Block::Code(text) => format!("<pre tabindex=\"0\">{}</pre>\n", escape(text)),
        Block::Table(table) => table.html(""),
        Block::Figure { title, path } => {
            let (title, svg) = (escape(title), std::fs::read_to_string(path).unwrap_or_default());
            let svg = svg.replacen("<svg", &format!("<svg role=\"img\" aria-label=\"{title}\""), 1);
            format!("<figure>{svg}<figcaption>{title}</figcaption></figure>\n")
        }
    }
}

fn words(text: &Text) -> String {
    let around = [["<strong>", "</strong>"], ["<em>", "</em>"], ["<code>", "</code>"]];
    text.written(around, |_, text| escape(text))
}
