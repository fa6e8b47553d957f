//! The table `verdicts` of an experiment without times: which answers are right.
//!
//! It has a line per scene (or hard case) and dimension, and a column per arithmetic. An entry
//! names only the detectors that are not right. An answer is right if it has exactly the pairs that
//! touch in exact arithmetic in the given scene. `verdicts.csv` has every answer.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::{AxisValue, Cell, CellId, label};
use crate::record::row::Outcome;
use contactbench_terms::arithmetic::Arithmetic;
use contactbench_terms::errors::Errors;

#[derive(Clone, Debug, PartialEq)]
pub enum CellAnswer {
    Right,
    /// The detector is defective: its answer is not that of its own arithmetic.
    Defect(Option<Errors>),
    /// The arithmetic, or storing the scene in it, changed the pairs.
    Wrong(Errors),
    Lossy(Errors),
    Refused,
    Without(Outcome),
}

impl CellAnswer {
    pub fn new(cell: &Cell) -> CellAnswer {
        match (cell.overall().0, cell.errors) {
            (Outcome::Wrong, errors) => CellAnswer::Defect(errors),
            (Outcome::Refused, _) => CellAnswer::Refused,
            (Outcome::Lossy, Some(errors)) => CellAnswer::Lossy(errors),
            (Outcome::Ok, Some(errors)) if errors.wrong() == 0 => CellAnswer::Right,
            (Outcome::Ok, Some(errors)) => CellAnswer::Wrong(errors),
            (outcome, _) => CellAnswer::Without(outcome),
        }
    }

    pub fn word(&self) -> &'static str {
        self.ranked().1
    }

    /// Weight, word, and number of wrong pairs. Of several seeds, the answer with the largest
    /// weight is shown.
    fn ranked(&self) -> (u8, &'static str, u64) {
        match self {
            CellAnswer::Right => (0, "right", 0),
            CellAnswer::Refused => (1, "refused", 0),
            CellAnswer::Lossy(errors) => (2, "lossy", errors.wrong()),
            CellAnswer::Wrong(errors) => (3, "wrong", errors.wrong()),
            CellAnswer::Without(_) => (4, "no answer", 0),
            CellAnswer::Defect(errors) => (5, "wrong", errors.map_or(0, |errors| errors.wrong())),
        }
    }
}

const WORDS: [&str; 5] = ["right", "wrong", "lossy", "refused", "no answer"];

/// Formats errors, such as `-3 +1` for three missed pairs and one spurious pair.
fn said(errors: &Errors) -> String {
    let all = [
        (errors.missed, "-", ""),
        (errors.spurious, "+", ""),
        (errors.duplicate, "", " twice"),
        (errors.self_pairs, "", " self"),
    ];
    let some = all.iter().filter(|(count, ..)| *count > 0);
    let some = some.map(|(count, before, behind)| format!("{before}{count}{behind}"));
    some.collect::<Vec<_>>().join(" ")
}

pub type Case = (String, Vec<(String, AxisValue)>);
/// Case, dimension, arithmetic and detector of an answer.
type Place<'a> = (Case, u32, &'a str, &'a str);

#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    pub arithmetics: Vec<String>,
    pub totals: Vec<(&'static str, Vec<u64>)>,
    pub lines: Vec<CaseLine>,
    pub right: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CaseLine {
    pub case: String,
    pub dim: u32,
    /// One entry per arithmetic: `right`, or the detectors with other answers and their errors;
    /// `None` if not measured.
    pub answers: Vec<Option<Vec<String>>>,
}

impl Matrix {
    pub fn new(cells: &[&Cell]) -> Option<Matrix> {
        let cells = judged(cells);
        let swept = label::swept(&cells);
        // Of several seeds, the answer with the largest weight counts.
        let mut answers: BTreeMap<Place<'_>, CellAnswer> = BTreeMap::new();
        let mut totals: BTreeMap<(&str, &str), u64> = BTreeMap::new();
        for cell in &cells {
            let (id, answer) = (&cell.id, CellAnswer::new(cell));
            *totals.entry((&id.arithmetic, answer.word())).or_default() += 1;
            let place = (case(id, &swept), id.dim, &*id.arithmetic, &*id.detector);
            let known = answers.entry(place).or_insert(CellAnswer::Right);
            if answer.ranked() > known.ranked() {
                *known = answer;
            }
        }
        let all: BTreeSet<&str> = totals.keys().map(|(name, _)| *name).collect();
        let mut arithmetics = Vec::from_iter(all);
        let place = |name: &str| Arithmetic::ALL.iter().position(|it| it.name() == name);
        arithmetics.sort_by_key(|name| place(name));
        let (mut lines, mut right) = (Vec::new(), Vec::new());
        let answers = Vec::from_iter(&answers);
        for own in answers.chunk_by(|(a, _), (b, _)| a.0 == b.0 && a.1 == b.1) {
            let line = CaseLine::new(own, &arithmetics);
            if line.answers.iter().all(|answer| *answer == Some(vec!["right".into()])) {
                right.push(format!("{} {}D", line.case, line.dim));
            } else {
                lines.push(line);
            }
        }
        let total = |word: &'static str| {
            let count = |name: &&str| totals.get(&(*name, word)).copied().unwrap_or(0);
            let counts: Vec<u64> = arithmetics.iter().map(count).collect();
            counts.iter().any(|count| *count > 0).then_some((word, counts))
        };
        (!cells.is_empty()).then(|| Matrix {
            arithmetics: arithmetics.iter().map(|name| name.to_string()).collect(),
            totals: WORDS.into_iter().filter_map(total).collect(),
            lines,
            right,
        })
    }
}

impl CaseLine {
    fn new(own: &[(&Place<'_>, &CellAnswer)], arithmetics: &[&str]) -> CaseLine {
        let answer = |name: &&str| {
            let of = own.iter().filter(|(place, _)| place.2 == *name);
            let of: Vec<_> = of.map(|(place, answer)| (place.3, *answer)).collect();
            (!of.is_empty()).then(|| who(&of))
        };
        let ((case, _), dim, ..) = own[0].0;
        let answers = arithmetics.iter().map(answer).collect();
        CaseLine { case: case.clone(), dim: *dim, answers }
    }
}

pub fn judged<'a>(cells: &[&'a Cell]) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| !cell.role.is_control()).copied().collect()
}

pub fn case(key: &CellId, swept: &[String]) -> Case {
    let params: Vec<(String, AxisValue)> =
        key.parameters().into_iter().filter(|(name, _)| swept.contains(name)).collect();
    if let Some(AxisValue::Text(name)) = key.axis("case") {
        return (name, Vec::new());
    }
    let text: String = params.iter().map(|(name, value)| format!(", {name} = {value}")).collect();
    (format!("{}, N = {}{text}", key.scene, key.n), params)
}

/// Returns `right`, or detectors with their errors, such as `nbs, sorting: -3 +1` and `all but
/// direct: refused`. An entry without names means all detectors.
fn who(answers: &[(&str, &CellAnswer)]) -> Vec<String> {
    let all: Vec<&str> = answers.iter().map(|(name, _)| *name).collect();
    let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
    for (detector, answer) in answers {
        let words = match answer {
            CellAnswer::Right => continue,
            CellAnswer::Defect(Some(errors)) if errors.wrong() > 0 => {
                format!("DEFECT {}", said(errors))
            }
            // Numbers would mislead: errors of the detector and of the arithmetic may cancel.
            CellAnswer::Defect(_) => "DEFECT".into(),
            CellAnswer::Wrong(errors) => said(errors),
            // A pair that the filter lost need not touch in exact arithmetic.
            CellAnswer::Lossy(errors) => format!("lossy {}", said(errors)).trim_end().into(),
            CellAnswer::Refused => "refused".into(),
            CellAnswer::Without(outcome) if outcome.is_good() => "not compared".into(),
            CellAnswer::Without(outcome) => outcome.name().into(),
        };
        match groups.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(detector),
            None => groups.push((words, vec![detector])),
        }
    }
    if groups.is_empty() {
        return vec!["right".into()];
    }
    let named = |(words, names): (String, Vec<&str>)| match label::group(&names, &all).as_str() {
        "all" => words,
        names => format!("{names}: {words}"),
    };
    groups.into_iter().map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::{Lab, hard_lab as lab};
    use crate::record::row::Pass;

    fn matrix(lab: &Lab) -> Matrix {
        lab.find(Matrix::new).unwrap()
    }

    fn lines(matrix: &Matrix) -> Vec<String> {
        let answer = |it: &Option<Vec<String>>| it.as_ref().unwrap().join("; ");
        let line = |line: &CaseLine| {
            let answers: Vec<String> = line.answers.iter().map(answer).collect();
            format!("{} {}D: {}", line.case, line.dim, answers.join(" | "))
        };
        matrix.lines.iter().map(line).collect()
    }

    #[test]
    fn a_cell_names_who_is_not_right_and_how() {
        let matrix = matrix(&lab());
        assert_eq!(matrix.arithmetics, ["f32", "textbook", "exact"]);
        let refused = "nbs, sorting: refused";
        assert_eq!(
            lines(&matrix),
            [
                format!("far 2D: {refused} | {refused} | {refused}"),
                format!("far 3D: {refused} | {refused} | {refused}"),
                "tangent 2D: -3 | nbs, sorting: lossy -2 | right".into()
            ]
        );
        assert_eq!(matrix.right, ["calm 2D", "calm 3D"]);
        let totals = [
            ("right", vec![8, 9, 11]),
            ("wrong", vec![3, 0, 0]),
            ("lossy", vec![0, 2, 0]),
            ("refused", vec![4, 4, 4]),
        ];
        assert_eq!(matrix.totals, totals);
    }

    #[test]
    fn a_defect_outshouts_everything_and_controls_are_not_asked() {
        let mut lab = lab();
        lab.scene("hard", 2).param("case", "calm").arithmetic("exact").detector("nbs");
        lab.fail(Pass::Memory, Outcome::Wrong, "1 missed");
        let found = matrix(&lab);
        assert_eq!(found.right, ["calm 3D"]);
        assert_eq!(lines(&found)[0], "calm 2D: right | right | nbs: DEFECT");
    }
}
