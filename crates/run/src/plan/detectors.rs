//! Names of detectors in experiments: expands groups, and normalises parameters.

use std::collections::BTreeSet;
use std::ops::Range;

use contactbench_detectors::table::{self, Group, TABLE};
use contactbench_detectors::tracker::{self, TrackerError};
use contactbench_record::experiment::twice;
use contactbench_record::record::role::Role;
use contactbench_terms::nearest::hint;

/// The group `@all`: its name, and the [`Group`]s of detectors that it contains.
const ALL: (&str, [Group; 3]) = ("@all", [Group::Book, Group::Modern, Group::Streamed]);

pub fn groups() -> impl Iterator<Item = &'static str> {
    Group::ALL.iter().map(|group| group.name()).chain([ALL.0])
}

/// Returns the detectors that `names` stand for, with groups expanded, in order. A detector that is
/// also in a group appears once; naming it twice is an error. If `is_copy` (the copy in a record),
/// names that only other versions of this program have are kept.
pub fn expand(names: &[String], is_copy: bool) -> Result<Vec<String>, String> {
    let (mut all, mut named) = (Vec::new(), Vec::new());
    for name in names {
        if name.starts_with('@') {
            all.extend(members(name)?);
            continue;
        }
        let name = match written(name) {
            Ok(name) => name,
            Err(_) if is_copy => name.clone(),
            Err(error) => return Err(error.to_string()),
        };
        if named.contains(&name) {
            return Err(twice(&name));
        }
        named.push(name.clone());
        all.push(name);
    }
    let mut seen = BTreeSet::new();
    all.retain(|name| seen.insert(name.clone()));
    Ok(all)
}

/// Returns the text of an experiment with its groups expanded. Records keep this text, because
/// groups may grow later. A text that cannot be read is left unchanged.
pub fn in_full(text: &str) -> String {
    #[derive(serde::Deserialize)]
    struct Named {
        detectors: toml::Spanned<Vec<String>>,
    }
    let Ok(Named { detectors }) = toml::from_str(text) else { return text.into() };
    let groups = detectors.get_ref().iter().any(|name| name.starts_with('@'));
    let Some(names) = groups.then(|| expand(detectors.get_ref(), false).ok()).flatten() else {
        return text.into();
    };
    let Range { start, end } = detectors.span();
    let names: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    format!("{}[{}]{}", &text[..start], names.join(", "), &text[end..])
}

pub fn members(group: &str) -> Result<Vec<String>, String> {
    let one = Group::ALL.iter().find(|known| known.name() == group);
    let groups = match one {
        Some(one) => std::slice::from_ref(one),
        None if group == ALL.0 => &ALL.1,
        None => {
            let hint = hint(group, self::groups());
            let list = self::groups().collect::<Vec<_>>().join(", ");
            return Err(format!("there is no group '{group}'{hint}; the groups are: {list}"));
        }
    };
    let names = TABLE.iter().filter(|entry| groups.contains(&entry.group)).map(|entry| entry.name);
    Ok(names.map(String::from).collect())
}

pub fn role(role: table::Role) -> Role {
    match role {
        table::Role::Detector => Role::Detector,
        table::Role::Nothing => Role::Nothing,
        table::Role::Twin(original) => Role::Twin(original.into()),
    }
}

/// Returns the normal form of the name of a detector or tracker; other names stay unchanged.
pub fn normal(name: &str) -> String {
    written(name).unwrap_or_else(|_| name.to_string())
}

/// Whether this program has no detector or tracker of this name.
pub fn is_lacking(name: &str) -> bool {
    written(name).is_err()
}

fn written(name: &str) -> Result<String, TrackerError> {
    let spec = tracker::parse(name)?;
    // A detector without a tracker is not renamed to `every-step(...)`, which does the same.
    Ok(if is_tracker(name) { spec.to_string() } else { spec.detector().to_string() })
}

pub fn is_tracker(name: &str) -> bool {
    name.contains('(')
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::record::id::CellId;

    fn expanded(names: &[&str]) -> Result<String, String> {
        let names: Vec<String> = names.iter().map(|name| name.to_string()).collect();
        expand(&names, false).map(|names| names.join(" "))
    }

    #[test]
    fn groups_stand_for_their_detectors_once() {
        assert_eq!(expanded(&["@book"]).unwrap(), "direct binary-tree screening sorting nbs");
        assert_eq!(
            expanded(&["nbs", "@book", "@book"]).unwrap(),
            "nbs direct binary-tree screening sorting"
        );
        assert_eq!(expanded(&["@controls"]).unwrap(), "nothing nbs-twin");
        let all = expanded(&["@all"]).unwrap();
        assert_eq!(all, expanded(&["@book", "@streamed", "@modern"]).unwrap());
        let searches = TABLE.iter().filter(|entry| entry.role == table::Role::Detector).count();
        assert_eq!(all.split(' ').count(), searches);
    }

    #[test]
    fn a_record_keeps_the_names_that_groups_stood_for() {
        let text =
            "name = \"a\" # @all\ndetectors = [ \"nbs:\", # first\n \"@controls\" ]\nx = 1\n";
        let full = "name = \"a\" # @all\ndetectors = [\"nbs\", \"nothing\", \"nbs-twin\"]\nx = 1\n";
        assert_eq!(in_full(text), full);
        for same in [full, "detectors = [\"nbs:\"]", "detectors = [\"@nobody\"]", "x ="] {
            assert_eq!(in_full(same), same);
        }
    }

    #[test]
    fn rows_have_the_normal_form_of_a_tracker() {
        for text in ["every-step(nbs)", "verlet(streamed-nbs:form=dense,level=portable,skin=1e-7)"]
        {
            let normal = normal(text);
            assert_eq!(CellId::default().with_subject(&normal).subject(), normal);
        }
    }

    #[test]
    fn unknown_names_and_repeated_ones_are_refused() {
        for (names, words) in [
            (&["@boks"][..], "there is no group '@boks' (did you mean @book?); the groups are: "),
            (&["nbs", "nbs"], "two runners are named 'nbs'"),
            (
                &[
                    "streamed-nbs:form=dense,level=portable",
                    "streamed-nbs:level=portable,form=dense",
                ],
                "two runners are named 'streamed-nbs:form=dense,level=portable'",
            ),
            (&["nsb"], "there is no detector 'nsb'"),
            (&["streamed-nbs:levle=avx2"], "levle"),
        ] {
            let error = expanded(names).unwrap_err();
            assert!(error.contains(words), "{names:?}: {error}");
        }
        assert_eq!(
            expanded(&["streamed-nbs", "streamed-nbs:level=portable"]).unwrap(),
            "streamed-nbs streamed-nbs:level=portable"
        );
    }
}
