//! Suggestions for misspelled names.

/// Returns ` (did you mean x?)` for the nearest known name, or an empty text if none is near.
pub fn hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    match nearest(name, known) {
        Some(near) => format!(" (did you mean {near}?)"),
        None => String::new(),
    }
}

/// Returns the known name that needs the fewest letters inserted, removed, replaced or swapped;
/// `None` if half of the letters or more would change. Case is ignored, and `_` counts as `-`.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |name: &str| name.trim().to_lowercase().replace('_', "-");
    let (name, letters) = (plain(name), name.trim().chars().count());
    let distance = |known: &str| strsim::osa_distance(&plain(known), &name);
    let nearest = known.into_iter().map(|known| (distance(known), known)).min_by_key(|it| it.0);
    nearest.filter(|(distance, _)| 2 * distance < letters).map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_forgiven_and_other_words_are_not() {
        let known = ["nbs", "sorting", "cell-grid", "list_push"];
        for (name, near) in [
            ("nsb", Some("nbs")),
            ("NBS", Some("nbs")),
            ("cell_grid", Some("cell-grid")),
            ("celgrid", Some("cell-grid")),
            ("list_pushs", Some("list_push")),
            ("quadtree", None),
            ("", None),
        ] {
            assert_eq!(nearest(name, known), near, "{name}");
        }
        assert_eq!(hint("srting", known), " (did you mean sorting?)");
        assert_eq!(hint("x", known), "");
    }
}
