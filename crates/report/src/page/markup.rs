use std::fmt::Write as _;

/// Escapes JSON for a `script` element: no character can end the element or begin a comment.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_becomes_markup() {
        let evil = "</script><!--<img src=x onerror=alert(1)>\u{2028}'\"&";
        let json = script_safe(&serde_json::json!([evil]).to_string());
        assert!(!json.contains(['<', '>', '&', '\u{2028}']), "{json}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&json).unwrap(), [evil]);
    }

    #[test]
    fn images_are_addresses_without_quotes_and_tags() {
        let uri = data_uri("<svg a=\"#1%\">\n</svg>");
        assert_eq!(uri, "data:image/svg+xml;charset=utf-8,%3Csvg a=%22%231%25%22%3E%0A%3C/svg%3E");
    }
}
