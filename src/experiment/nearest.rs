//! The nearest name to one that is not known, for messages.

/// `; did you mean x?` for the name with the fewest letters to insert, remove or replace; empty if
/// that is half of them or more.
pub fn hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let distance = |known: &str| strsim::levenshtein(known, name);
    match known.into_iter().min_by_key(|known| distance(known)) {
        Some(near) if 2 * distance(near) < name.chars().count() => {
            format!("; did you mean {near}?")
        }
        _ => String::new(),
    }
}
