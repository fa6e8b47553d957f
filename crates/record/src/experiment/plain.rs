use contactbench_terms::nearest::hint;

/// Translates a type error of serde to plain words; other messages stay unchanged.
pub fn plain(message: &str) -> String {
    let typed = ["invalid type: ", "invalid value: "];
    let typed = typed.iter().find_map(|head| message.strip_prefix(head));
    if let Some((found, expected)) = typed.and_then(|rest| rest.rsplit_once(", expected ")) {
        return format!("{} stands where {} is expected", value(found), wanted(expected));
    }
    for (head, between, what) in [
        ("unknown variant ", ", expected ", "value"),
        ("unknown field ", ", expected ", "key"),
        ("unexpected keys in table: ", ", available keys: ", "key"),
    ] {
        let parts = message.strip_prefix(head).and_then(|rest| rest.split_once(between));
        if let Some((name, known)) = parts {
            let (name, known) = (name.replace('`', ""), known.replace('`', ""));
            let known = known.trim_start_matches("one of ").replace(" or ", ", ");
            let hint = hint(&name, known.split(", "));
            return format!("there is no {what} '{name}' here{hint}; there are: {known}");
        }
    }
    if let Some(name) = message.strip_prefix("missing field ") {
        return format!("the key '{}' is missing", name.trim_matches('`'));
    }
    message.to_string()
}

fn value(found: &str) -> String {
    let bare = |text: &str| text.trim_matches('`').to_string();
    match found.split_once(' ') {
        Some(("integer" | "boolean", value)) => bare(value),
        Some(("floating", rest)) => bare(rest.trim_start_matches("point ")),
        Some(("string", text)) => format!("the text {text}"),
        _ if found == "map" => "a table".into(),
        _ if found == "sequence" => "a list".into(),
        _ => found.to_string(),
    }
}

fn wanted(expected: &str) -> String {
    match expected {
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of at least 0".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "f32" | "f64" => "a number".into(),
        "a string" | "string or table" => "a text in quotes".into(),
        "a boolean" => "true or false".into(),
        "a sequence" => "a list in brackets, as in [1, 2],".into(),
        _ if expected == "a map" || expected.starts_with("struct ") => {
            "a table, as in { key = 1 },".into()
        }
        _ => expected.to_string(),
    }
}
