//! Errors against exact decisions: their names in expressions and in `summary.csv`, and the report's table with the three causes apart.

use std::collections::{BTreeMap, BTreeSet};

use super::value::{Cell, Key, Param};
use super::{place, summary, text};
use crate::harness::record::{Causes, Errors, Outcome};

type OfCell = fn(&Cell) -> Option<Errors>;
type OfErrors = fn(&Errors) -> f64;

/// All causes together, and each: the prefix of its variables.
const CAUSES: [(&str, OfCell); 4] = [
    ("", |cell| cell.errors),
    ("input_", |cell| cell.causes.map(|causes| causes.input)),
    ("arithmetic_", |cell| cell.causes.map(|causes| causes.arithmetic)),
    ("algorithm_", |cell| cell.causes.map(|causes| causes.algorithm)),
];

const KINDS: [(&str, OfErrors); 7] = [
    ("missed", |errors| errors.missed as f64),
    ("spurious", |errors| errors.spurious as f64),
    ("duplicate", |errors| errors.duplicate as f64),
    ("self_pairs", |errors| errors.self_pairs as f64),
    ("deepest_miss", |errors| errors.deepest_miss),
    ("widest_false", |errors| errors.widest_false),
    ("wrong", |errors| errors.wrong() as f64),
];

/// The names of all variables that count errors, as `algorithm_missed`.
pub fn names() -> impl Iterator<Item = String> {
    CAUSES.iter().flat_map(|(cause, _)| KINDS.iter().map(move |(kind, _)| format!("{cause}{kind}")))
}

/// The value of such a variable; none where nothing was compared.
pub fn variable(cell: &Cell, name: &str) -> Option<f64> {
    let (of_cell, of_errors) = CAUSES.iter().find_map(|(cause, of_cell)| {
        let kind = name.strip_prefix(cause)?;
        Some((of_cell, KINDS.iter().find(|(known, _)| *known == kind)?.1))
    })?;
    Some(of_errors(&of_cell(cell)?))
}

/// Pairs that touch in exact arithmetic in the scene as given.
pub fn true_contacts(cell: &Cell) -> f64 {
    (cell.stats.coordination * cell.key.n as f64 / 2.0).round()
}

/// Wrong pairs per true contact, against the scene as given; without true contacts every wrong pair counts as one.
pub fn rate(cell: &Cell) -> Option<f64> {
    Some(cell.errors?.wrong() as f64 / true_contacts(cell).max(1.0))
}

/// The same against the scene as stored: what deciding and looking did wrong, per contact of that scene.
pub fn stored_rate(cell: &Cell) -> Option<f64> {
    let Causes { input, stored, .. } = cell.causes?;
    let contacts = true_contacts(cell) - input.missed as f64 + input.spurious as f64;
    Some(stored.wrong() as f64 / contacts.max(1.0))
}

/// Errors of several cells.
#[derive(Clone, Debug, Default, PartialEq)]
struct Sum {
    cells: usize,
    contacts: f64,
    errors: Errors,
    /// None as soon as one cell has none: a record of an earlier version.
    causes: Option<Causes>,
    outcomes: BTreeSet<Outcome>,
}

fn add(sum: &mut Errors, errors: &Errors) {
    sum.missed = sum.missed.saturating_add(errors.missed);
    sum.spurious = sum.spurious.saturating_add(errors.spurious);
    sum.duplicate = sum.duplicate.saturating_add(errors.duplicate);
    sum.self_pairs = sum.self_pairs.saturating_add(errors.self_pairs);
    sum.deepest_miss = sum.deepest_miss.max(errors.deepest_miss);
    sum.widest_false = sum.widest_false.max(errors.widest_false);
}

impl Sum {
    fn of(cells: &[&Cell]) -> Sum {
        let mut sum = Sum { causes: Some(Causes::default()), ..Sum::default() };
        for cell in cells {
            let Some(errors) = cell.errors else { continue };
            sum.cells += 1;
            sum.contacts += true_contacts(cell);
            add(&mut sum.errors, &errors);
            sum.causes = sum.causes.zip(cell.causes).map(|(mut all, one)| {
                add(&mut all.input, &one.input);
                add(&mut all.arithmetic, &one.arithmetic);
                add(&mut all.algorithm, &one.algorithm);
                all
            });
            sum.outcomes.insert(cell.overall().0);
        }
        sum
    }

    /// No error of any cause: errors of two causes can cancel.
    fn none(&self) -> bool {
        let causes = self.causes.unwrap_or_default();
        self.errors.wrong() + causes.input.wrong() + causes.arithmetic.wrong() + causes.algorithm.wrong() == 0
    }

    /// Detectors with the same errors share a line. Without any it is no matter how many cells each had an answer in.
    fn same(&self, other: &Sum) -> bool {
        let blind = |sum: &Sum| Sum { cells: 0, contacts: 0.0, ..sum.clone() };
        if self.none() && other.none() { blind(self) == blind(other) } else { self == other }
    }

    fn row(&self, detectors: String, arithmetic: &str, scene: String) -> Vec<String> {
        let cause = |of: fn(&Causes) -> &Errors| self.causes.as_ref().map_or("–".into(), |causes| counts(of(causes)));
        let depth = |there: u64, depth: f64| if there == 0 { "–".into() } else { format!("{} r", text::number(depth)) };
        let named = |outcome: &&Outcome| !matches!(outcome, Outcome::Ok);
        let outcomes: Vec<&str> = self.outcomes.iter().filter(named).map(|outcome| outcome.name()).collect();
        vec![
            detectors,
            arithmetic.into(),
            scene,
            text::number(self.contacts),
            cause(|causes| &causes.input),
            cause(|causes| &causes.arithmetic),
            cause(|causes| &causes.algorithm),
            counts(&self.errors),
            text::percent(self.errors.wrong() as f64 / self.contacts.max(1.0)),
            depth(self.errors.missed, self.errors.deepest_miss),
            depth(self.errors.spurious, self.errors.widest_false),
            outcomes.join(", "),
        ]
    }
}

/// `3 / 2` for three missed and two spurious, with pairs repeated or of one element where there are any; `0` for none.
fn counts(errors: &Errors) -> String {
    if errors.wrong() == 0 {
        return "0".into();
    }
    let mut out = format!("{} / {}", errors.missed, errors.spurious);
    for (count, noun) in [(errors.duplicate, "twice"), (errors.self_pairs, "self")] {
        if count > 0 {
            out += &format!(" / {count} {noun}");
        }
    }
    out
}

/// Errors by cause: a line per scene (with the parameters that are swept), arithmetic and group of detectors with the same errors.
/// Numbers of elements, seeds and orders are summed, and so are all parameters where nothing is wrong. None if nothing was compared.
pub fn table(cells: &[&Cell]) -> Option<String> {
    let compared = |cell: &&&Cell| cell.errors.is_some() && cell.overall().0 != Outcome::Control;
    let cells: Vec<&Cell> = cells.iter().filter(compared).copied().collect();
    let swept = place::swept(&cells);
    type Place<'a> = (String, u32, &'a str);
    type Params = Vec<(String, Param)>;
    let mut scenes: BTreeMap<Place, BTreeMap<Params, Vec<&Cell>>> = BTreeMap::new();
    for &cell in &cells {
        let Key { dim, arithmetic, params, .. } = &cell.key;
        let params = params.iter().filter(|(name, _)| swept.contains(name) && name != "path").cloned().collect();
        scenes.entry((place::scene(&cell.key), *dim, arithmetic)).or_default().entry(params).or_default().push(cell);
    }
    let mut rows = Vec::new();
    for ((scene, dim, arithmetic), places) in &scenes {
        let mut lines: Vec<(String, Vec<&Cell>)> = Vec::new();
        let all: Vec<&Cell> = places.values().flatten().copied().collect();
        if Sum::of(&all).none() {
            lines.push((format!("{scene} {dim}D"), all));
        } else {
            for (params, cells) in places {
                let params: String = params.iter().map(|(name, value)| format!(", {name} = {value}")).collect();
                lines.push((format!("{scene} {dim}D{params}"), cells.clone()));
            }
        }
        for (place, cells) in lines {
            for (detectors, sum) in folded(&cells) {
                rows.push(sum.row(detectors, arithmetic, place.clone()));
            }
        }
    }
    let heads = [
        "detectors",
        "arithmetic",
        "scene",
        ">true contacts",
        ">storing",
        ">deciding",
        ">looking",
        ">together",
        ">error rate",
        ">deepest miss",
        ">widest false",
        "outcome",
    ];
    (!rows.is_empty()).then(|| text::markdown_table(&heads, &rows))
}

/// The sums of all detectors of these cells, those with the same errors together.
fn folded(cells: &[&Cell]) -> Vec<(String, Sum)> {
    let mut detectors: BTreeMap<&str, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells {
        detectors.entry(&cell.key.detector).or_default().push(cell);
    }
    let mut groups: Vec<(Vec<&str>, Sum)> = Vec::new();
    for (&detector, cells) in &detectors {
        let sum = Sum::of(cells);
        match groups.iter_mut().find(|(_, known)| known.same(&sum)) {
            Some((names, known)) => {
                names.push(detector);
                if sum.contacts > known.contacts {
                    *known = sum;
                }
            }
            None => groups.push((vec![detector], sum)),
        }
    }
    let all: Vec<&str> = detectors.into_keys().collect();
    groups.into_iter().map(|(names, sum)| (summary::group(&names, &all), sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;

    fn errors(missed: u64, spurious: u64) -> Errors {
        Errors { missed, spurious, deepest_miss: if missed > 0 { 0.25 } else { 0.0 }, ..Errors::default() }
    }

    /// 250 true contacts per scene; in f32 storing loses 20 and adds 5, in textbook only nbs loses one.
    fn lab() -> Lab {
        let mut lab = Lab::new("e", "packed");
        for offset in [0, 1000] {
            lab.param("offset", offset);
            for detector in ["nbs", "sorting"] {
                lab.detector(detector);
                let input = if offset == 1000 { errors(20, 5) } else { Errors::default() };
                let causes = Causes { input, arithmetic: errors(1, 0), algorithm: Errors::default(), stored: errors(1, 0) };
                lab.arithmetic("f32").count(&[]).errors(Errors { self_pairs: 2, ..errors(input.missed + 1, input.spurious) }, causes);
                let algorithm = if detector == "nbs" { errors(1, 0) } else { Errors::default() };
                lab.arithmetic("textbook").count(&[]).errors(algorithm, Causes { algorithm, stored: algorithm, ..Causes::default() });
                if detector == "nbs" {
                    lab.edit(|row| row.outcome = Outcome::Lossy);
                }
                lab.arithmetic("exact").count(&[]).errors(Errors::default(), Causes::default());
            }
        }
        lab
    }

    #[test]
    fn every_error_has_a_variable() {
        let cells = value::cells(&lab().rows());
        let find = |arithmetic: &str, offset: f64| {
            cells.iter().find(|cell| cell.key.arithmetic == arithmetic && cell.variable("offset", None) == Some(offset)).unwrap()
        };
        let cell = find("f32", 1000.0);
        for (name, expected) in [
            ("missed", 21.0),
            ("self_pairs", 2.0),
            ("wrong", 28.0),
            ("deepest_miss", 0.25),
            ("input_missed", 20.0),
            ("input_spurious", 5.0),
            ("input_wrong", 25.0),
            ("arithmetic_missed", 1.0),
            ("arithmetic_wrong", 1.0),
            ("algorithm_wrong", 0.0),
            ("algorithm_widest_false", 0.0),
            ("true_contacts", 250.0),
        ] {
            assert_eq!(cell.variable(name, None), Some(expected), "{name}");
            assert!(value::variables(&cells).contains(name), "{name}");
        }
        assert_eq!(names().count(), 28);
        assert!(names().all(|name| cell.variable(&name, None).is_some()));
        assert_eq!(cell.variable("storage_missed", None), None);
        assert_eq!((rate(cell), stored_rate(cell)), (Some(28.0 / 250.0), Some(1.0 / 235.0)));
        assert_eq!(rate(find("exact", 0.0)), Some(0.0));
    }

    #[test]
    fn the_table_tells_causes_apart_and_folds_what_is_the_same() {
        let cells = value::cells(&lab().rows());
        let table = table(&cells.iter().collect::<Vec<_>>()).unwrap();
        let lines: Vec<&str> = table.lines().skip(2).collect();
        assert_eq!(
            lines,
            [
                "| all | exact | packed 2D | 500 | 0 | 0 | 0 | 0 | 0% | – | – |  |",
                "| all | f32 | packed 2D, offset = 0 | 250 | 0 | 1 / 0 | 0 | 1 / 0 / 2 self | 1.2% | 0.2500 r | – |  |",
                "| all | f32 | packed 2D, offset = 1000 | 250 | 20 / 5 | 1 / 0 | 0 | 21 / 5 / 2 self | 11% | 0.2500 r | 0 r |  |",
                "| nbs | textbook | packed 2D, offset = 0 | 250 | 0 | 0 | 1 / 0 | 1 / 0 | 0.4% | 0.2500 r | – | lossy |",
                "| sorting | textbook | packed 2D, offset = 0 | 250 | 0 | 0 | 0 | 0 | 0% | – | – |  |",
                "| nbs | textbook | packed 2D, offset = 1000 | 250 | 0 | 0 | 1 / 0 | 1 / 0 | 0.4% | 0.2500 r | – | lossy |",
                "| sorting | textbook | packed 2D, offset = 1000 | 250 | 0 | 0 | 0 | 0 | 0% | – | – |  |",
            ]
        );
    }

    #[test]
    fn a_record_without_causes_still_has_its_errors() {
        let mut lab = Lab::new("e", "packed");
        lab.count(&[]).edit(|row| row.errors = Some(errors(3, 0)));
        let cells = value::cells(&lab.rows());
        assert_eq!((cells[0].variable("missed", None), cells[0].variable("input_missed", None)), (Some(3.0), None));
        let table = table(&[&cells[0]]).unwrap();
        assert!(table.contains("| all | exact | packed 2D | 250 | – | – | – | 3 / 0 | 1.2% |"), "{table}");
    }
}
