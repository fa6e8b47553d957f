//! Text as outlines, so that whoever makes pixels of a picture needs no font.

use anyhow::Context;
use resvg::usvg::roxmltree::{Document, Node};

use crate::present::svg::font::Font;

/// The picture with a path in place of each text. Sizes, weights and anchors are read from
/// attributes, of the text or of what it is in, not from style sheets.
pub fn outlined(svg: &str) -> anyhow::Result<String> {
    let document = Document::parse(svg).context("the picture is not an SVG")?;
    let mut picture = String::with_capacity(4 * svg.len());
    let mut rest = 0;
    for text in document.descendants().filter(|node| node.tag_name().name() == "text") {
        let range = text.range();
        picture += &svg[rest..range.start];
        picture += &path(svg, text)?;
        rest = range.end;
    }
    picture += &svg[rest..];
    Ok(picture)
}

/// One text as a path; all that does not place the letters stays as it is written.
fn path(svg: &str, text: Node<'_, '_>) -> anyhow::Result<String> {
    let inherited = |name| text.ancestors().find_map(|node| node.attribute(name));
    let number = |value: Option<&str>| value.and_then(|value| value.parse::<f64>().ok());
    let size = number(inherited("font-size")).unwrap_or(16.0);
    let font = Font::new(size, inherited("font-weight") == Some("bold"))?;
    let words: Vec<&str> = text.text().unwrap_or_default().split_whitespace().collect();
    let words = words.join(" ");
    let width = font.width(&words);
    let before = match inherited("text-anchor") {
        Some("middle") => 0.5 * width,
        Some("end") => width,
        _ => 0.0,
    };
    let lower = match text.attribute("dy") {
        Some(dy) if dy.ends_with("ex") => {
            number(dy.strip_suffix("ex")).unwrap_or(0.0) * font.x_height()
        }
        dy => number(dy).unwrap_or(0.0),
    };
    let [x, y] = ["x", "y"].map(|name| number(text.attribute(name)).unwrap_or(0.0));
    let kept: Vec<&str> = text
        .attributes()
        .filter(|attribute| !PLACING.contains(&attribute.name()))
        .map(|attribute| &svg[attribute.range()])
        .collect();
    let data = font.outline(&words, x - before, y + lower);
    Ok(format!("<path {} d=\"{data}\"/>", kept.join(" ")))
}

/// The attributes that place letters.
const PLACING: [&str; 7] =
    ["x", "y", "dy", "text-anchor", "font-family", "font-size", "font-weight"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_becomes_a_path_at_its_place() {
        let picture = |text: &str| {
            outlined(&format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" font-size=\"20\"><g \
                 text-anchor=\"middle\"><text {text}</text></g><rect/></svg>"
            ))
            .unwrap()
        };
        let svg = picture("x=\"50\" y=\"30\" fill=\"&lt;\" transform=\"rotate(9)\">\n a&lt; b\n");
        assert!(svg.contains("<path fill=\"&lt;\" transform=\"rotate(9)\" d=\"M"), "{svg}");
        assert!(svg.ends_with("Z\"/></g><rect/></svg>") && !svg.contains("<text"), "{svg}");
        let font = Font::new(20.0, false).unwrap();
        let left = 50.0 - 0.5 * font.width("a< b");
        assert!(svg.contains(&format!("d=\"{}\"", font.outline("a< b", left, 30.0))), "{svg}");
        let low = picture("x=\"0\" y=\"30\" dy=\"0.5ex\" text-anchor=\"start\">b");
        let low_line = 30.0 + 0.5 * font.x_height();
        assert!(low.contains(&font.outline("b", 0.0, low_line)), "{low}");
        assert!(outlined("<svg").unwrap_err().to_string().contains("not an SVG"));
    }
}
