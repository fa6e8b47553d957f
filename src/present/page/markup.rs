//! Text into HTML: nothing that a record says can become markup.

use std::fmt::Write as _;

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd, html};

/// JSON inside a `script` element: no character of it can end the element or begin a comment. It is
/// JSON still, and means the same.
pub fn script_safe(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}

/// Markdown into HTML. HTML in it is shown, not obeyed; images are left out; links lead to files
/// beside the page or to a section of it, else they are only text.
pub fn markdown(text: &str) -> String {
    let (mut image, mut link) = (0_u32, Vec::new());
    let events = Parser::new_ext(text, Options::ENABLE_TABLES).filter_map(|event| match event {
        Event::Start(Tag::Image { .. }) => {
            image += 1;
            None
        }
        Event::End(TagEnd::Image) => {
            image = image.saturating_sub(1);
            None
        }
        _ if image > 0 => None,
        Event::Html(html) | Event::InlineHtml(html) => Some(Event::Text(html)),
        Event::Start(Tag::HtmlBlock) | Event::End(TagEnd::HtmlBlock) => None,
        Event::Start(Tag::Link { ref dest_url, .. }) => {
            link.push(is_beside(dest_url));
            link.last().is_some_and(|known| *known).then_some(event)
        }
        Event::End(TagEnd::Link) => link.pop().is_some_and(|known| known).then_some(event),
        event => Some(event),
    });
    let mut out = String::new();
    html::push_html(&mut out, events);
    // Wide tables scroll by themselves, not the page.
    out.replace("<table>", "<div class=\"scroll\" tabindex=\"0\"><table>")
        .replace("</table>", "</table></div>")
}

fn is_beside(target: &str) -> bool {
    target.chars().all(|c| c.is_ascii_alphanumeric() || "-_./".contains(c))
        && !target.starts_with('/')
        && !target.contains("..")
}

/// An SVG as the address of an image.
pub fn data_uri(svg: &str) -> String {
    let mut out = String::from("data:image/svg+xml;charset=utf-8,");
    for c in svg.chars() {
        match c {
            '%' | '#' | '"' | '<' | '>' | '&' | '\'' | '\t' | '\r' | '\n' => {
                let _ = write!(out, "%{:02X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}

/// Puts values in the places `{{name}}` of a template; nothing inside a value is replaced. Places
/// without a value are left out.
pub fn fill(template: &str, values: &[(&str, &str)]) -> String {
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
    fn nothing_becomes_markup() {
        let evil = "</script><!--<img src=x onerror=alert(1)>\u{2028}'\"&";
        let json = script_safe(&serde_json::json!([evil]).to_string());
        assert!(!json.contains(['<', '>', '&', '\u{2028}']), "{json}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&json).unwrap(), [evil]);
        for text in [
            evil.to_string(),
            format!("| a |\n| --- |\n| {evil} |\n"),
            format!("x {evil}\n\n<div onclick='x'>\n"),
            "<b>".into(),
        ] {
            let html = markdown(&text);
            assert!(
                !["<img", "<script", "<div on", "<b>", "<!--"].iter().any(|tag| html.contains(tag)),
                "{html}"
            );
        }
        let link = markdown(
            "[a](javascript:alert(1)) [b](https://example.org) [c](figures/x.svg) \
             ![d](https://example.org/x.png) [e](../x)",
        );
        assert_eq!(link, "<p>a b <a href=\"figures/x.svg\">c</a>  e</p>\n");
    }

    #[test]
    fn templates_are_filled_once() {
        assert_eq!(fill("<{{a}}{{b}}{{none}}>", &[("a", "{{b}}"), ("b", "2")]), "<{{b}}2>");
    }

    #[test]
    fn images_are_addresses_without_quotes_and_tags() {
        let uri = data_uri("<svg a=\"#1%\">\n</svg>");
        assert_eq!(uri, "data:image/svg+xml;charset=utf-8,%3Csvg a=%22%231%25%22%3E%0A%3C/svg%3E");
    }
}
