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
pub enum Answer {
    Right,
    /// The detector is defective: its answer is not that of its own arithmetic.
    Defect(Option<Errors>),
    /// The arithmetic, or storing the scene in it, changed the pairs.
    Wrong(Errors),
    Lossy(Errors),
    Refused(String),
    Without(Outcome, String),
}

impl Answer {
    pub fn new(cell: &Cell) -> Answer {
        let (outcome, reason) = cell.overall();
        match (outcome, cell.errors) {
            (Outcome::Wrong, errors) => Answer::Defect(errors),
            (Outcome::Refused, _) => Answer::Refused(reason.into()),
            (Outcome::Lossy, Some(errors)) => Answer::Lossy(errors),
            (Outcome::Ok, Some(errors)) if errors.wrong() == 0 => Answer::Right,
            (Outcome::Ok, Some(errors)) => Answer::Wrong(errors),
            _ => Answer::Without(outcome, reason.into()),
        }
    }

    pub fn word(&self) -> &'static str {
        match self {
            Answer::Right => "right",
            Answer::Defect(_) | Answer::Wrong(_) => "wrong",
            Answer::Lossy(_) => "lossy",
            Answer::Refused(_) => "refused",
            Answer::Without(..) => "no answer",
        }
    }

    /// Orders answers of several seeds; the one with the largest weight is shown.
    fn weight(&self) -> (u8, u64) {
        match self {
            Answer::Right => (0, 0),
            Answer::Refused(_) => (1, 0),
            Answer::Lossy(errors) => (2, errors.wrong()),
            Answer::Wrong(errors) => (3, errors.wrong()),
            Answer::Without(..) => (4, 0),
            Answer::Defect(errors) => (5, errors.map_or(0, |errors| errors.wrong())),
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
    let some = all
        .iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, before, behind)| format!("{before}{count}{behind}"));
    some.collect::<Vec<_>>().join(" ")
}

/// Numbered reasons. Reasons that differ only in numbers, axes and detector share one number.
#[derive(Default)]
struct Reasons(Vec<(String, String)>);

impl Reasons {
    fn number(&mut self, detector: &str, reason: &str) -> usize {
        let mut form: Vec<&str> = Vec::new();
        for word in reason.split_whitespace() {
            let bare = word.trim_matches(|c: char| !c.is_alphanumeric() && c != '-');
            let word = if bare.parse::<f64>().is_ok() { "#" } else { word };
            let same = word == "#" && form.last() == Some(&"#");
            if !same && bare != detector && !["x", "y", "z"].contains(&bare) {
                form.push(word);
            }
        }
        let form = form.join(" ");
        self.0.iter().position(|(known, _)| *known == form).unwrap_or_else(|| {
            self.0.push((form, reason.into()));
            self.0.len() - 1
        }) + 1
    }
}

pub type Case = (String, Vec<(String, AxisValue)>);
type Answers<'a> = BTreeMap<&'a str, Answer>;

#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    pub arithmetics: Vec<String>,
    pub totals: Vec<(&'static str, Vec<u64>)>,
    pub lines: Vec<CaseLine>,
    pub right: Vec<String>,
    /// One example of each reason; lines refer to them by number, from 1.
    pub reasons: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CaseLine {
    pub case: String,
    pub dims: Vec<u32>,
    /// One entry per arithmetic: `right`, or the detectors with other answers and their errors;
    /// `None` if not measured.
    pub answers: Vec<Option<Vec<String>>>,
}

impl Matrix {
    pub fn new(cells: &[&Cell]) -> Option<Matrix> {
        let cells = judged(cells);
        let swept = label::swept(&cells);
        let mut cases: BTreeMap<Case, BTreeMap<u32, BTreeMap<&str, Answers>>> = BTreeMap::new();
        let mut totals: BTreeMap<&str, BTreeMap<&str, u64>> = BTreeMap::new();
        for cell in &cells {
            let answer = Answer::new(cell);
            *totals.entry(&cell.id.arithmetic).or_default().entry(answer.word()).or_default() += 1;
            let dims = cases.entry(case(&cell.id, &swept)).or_default();
            let answers =
                dims.entry(cell.id.dim).or_default().entry(&cell.id.arithmetic).or_default();
            let known = answers.entry(&cell.id.detector).or_insert(Answer::Right);
            if answer.weight() > known.weight() {
                *known = answer;
            }
        }
        let mut arithmetics: Vec<&str> = totals.keys().copied().collect();
        arithmetics
            .sort_by_key(|name| Arithmetic::ALL.iter().position(|known| known.name() == *name));
        let every: BTreeSet<u32> = cells.iter().map(|cell| cell.id.dim).collect();
        let (mut reasons, mut lines, mut right) = (Reasons::default(), Vec::new(), Vec::new());
        for ((case, _), dims) in &cases {
            for line in case_lines(case, dims, &arithmetics, &mut reasons) {
                let is_right = |answer: &Option<Vec<String>>| {
                    answer.as_ref().is_some_and(|answer| *answer == ["right"])
                };
                if !line.answers.iter().all(is_right) {
                    lines.push(line);
                } else if line.dims.len() == every.len() {
                    right.push(line.case);
                } else {
                    right.push(format!("{} ({})", line.case, line.shown_dims(", ")));
                }
            }
        }
        let total = |word: &'static str| {
            let counts = arithmetics.iter().map(|name| totals[name].get(word).copied());
            let counts: Vec<u64> = counts.map(Option::unwrap_or_default).collect();
            counts.iter().any(|count| *count > 0).then_some((word, counts))
        };
        (!cells.is_empty()).then(|| Matrix {
            arithmetics: arithmetics.iter().map(|name| name.to_string()).collect(),
            totals: WORDS.into_iter().filter_map(total).collect(),
            lines,
            right,
            reasons: reasons.0.into_iter().map(|(_, reason)| reason).collect(),
        })
    }
}

impl CaseLine {
    pub fn shown_dims(&self, between: &str) -> String {
        self.dims.iter().map(|dim| format!("{dim}D")).collect::<Vec<_>>().join(between)
    }
}

fn case_lines(
    case: &str,
    dims: &BTreeMap<u32, BTreeMap<&str, Answers>>,
    arithmetics: &[&str],
    reasons: &mut Reasons,
) -> Vec<CaseLine> {
    let mut found: Vec<CaseLine> = Vec::new();
    for (dim, columns) in dims {
        let answers: Vec<Option<Vec<String>>> = arithmetics
            .iter()
            .map(|name| columns.get(name).map(|answers| who(answers, reasons)))
            .collect();
        match found.iter_mut().find(|known| known.answers == answers) {
            Some(known) => known.dims.push(*dim),
            None => found.push(CaseLine { case: case.into(), dims: vec![*dim], answers }),
        }
    }
    found
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
/// direct: refused (1)`. An entry without names means all detectors.
fn who(answers: &Answers, reasons: &mut Reasons) -> Vec<String> {
    let all: Vec<&str> = answers.keys().copied().collect();
    let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
    for (&detector, answer) in answers {
        let words = match answer {
            Answer::Right => continue,
            Answer::Defect(Some(errors)) if errors.wrong() > 0 => {
                format!("DEFECT {}", said(errors))
            }
            // Numbers would mislead: errors of the detector and of the arithmetic may cancel.
            Answer::Defect(_) => "DEFECT".into(),
            Answer::Wrong(errors) => said(errors),
            // A pair that the filter lost need not touch in exact arithmetic.
            Answer::Lossy(errors) => format!("lossy {}", said(errors)).trim_end().into(),
            Answer::Refused(reason) => format!("refused ({})", reasons.number(detector, reason)),
            Answer::Without(outcome, reason) if outcome.is_good() || reason.is_empty() => {
                "not compared".into()
            }
            Answer::Without(outcome, reason) => {
                format!("{} ({})", outcome.name(), reasons.number(detector, reason))
            }
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

#[doc(hidden)]
pub mod testing {
    use crate::cells::testing::Lab;
    use crate::record::row::{Outcome, Pass};
    use contactbench_terms::errors::{Causes, Errors};

    /// Three cases: right everywhere; wrong in f32 and lossy in textbook; refused by all but
    /// direct.
    pub fn lab() -> Lab {
        let mut lab = Lab::new("e", "hard");
        for (case, dims) in [("calm", vec![2, 3]), ("tangent", vec![2]), ("far", vec![2, 3])] {
            for dim in dims {
                lab.scene("hard", dim).param("case", case);
                for arithmetic in ["exact", "f32", "textbook"] {
                    for detector in ["direct", "nbs", "sorting", "nothing"] {
                        lab.arithmetic(arithmetic).detector(detector);
                        if case == "far" && detector != "direct" {
                            let reason =
                                format!("{detector} would need 5.{dim}e11 cells; use direct");
                            lab.fail(Pass::Count, Outcome::Refused, &reason);
                            continue;
                        }
                        let (missed, outcome) = match (case, arithmetic, detector) {
                            ("tangent", "f32", _) => (3, Outcome::Ok),
                            ("tangent", "textbook", "nbs" | "sorting") => (2, Outcome::Lossy),
                            _ => (0, Outcome::Ok),
                        };
                        let errors = Errors { missed, ..Errors::default() };
                        lab.count(&[])
                            .errors(errors, Causes::default())
                            .edit(|row| row.outcome = outcome);
                    }
                }
            }
        }
        lab
    }
}

#[cfg(test)]
mod tests {
    use super::testing::lab;
    use super::*;
    use crate::cells::testing::Lab;
    use crate::record::row::Pass;

    fn matrix(lab: &Lab) -> Matrix {
        lab.find(Matrix::new).unwrap()
    }

    fn lines(matrix: &Matrix) -> Vec<String> {
        let answer = |it: &Option<Vec<String>>| it.as_ref().unwrap().join("; ");
        let line = |line: &CaseLine| {
            let answers: Vec<String> = line.answers.iter().map(answer).collect();
            format!("{} {}: {}", line.case, line.shown_dims("+"), answers.join(" | "))
        };
        matrix.lines.iter().map(line).collect()
    }

    #[test]
    fn a_cell_names_who_is_not_right_and_how() {
        let matrix = matrix(&lab());
        assert_eq!(matrix.arithmetics, ["f32", "textbook", "exact"]);
        let refused = "nbs, sorting: refused (1)";
        assert_eq!(
            lines(&matrix),
            [
                format!("far 2D+3D: {refused} | {refused} | {refused}"),
                "tangent 2D: -3 | nbs, sorting: lossy -2 | right".into()
            ]
        );
        assert_eq!(matrix.right, ["calm"]);
        assert_eq!(matrix.reasons, ["nbs would need 5.2e11 cells; use direct"]);
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
        assert_eq!(found.right, ["calm (3D)"]);
        assert_eq!(lines(&found)[0], "calm 2D: right | right | nbs: DEFECT");
    }

    #[test]
    fn reasons_of_one_kind_are_one() {
        let mut reasons = Reasons::default();
        for (detector, reason, number) in [
            ("nbs", "nbs needs 80 bytes (82 particles, 2002 x 17 cells)", 1),
            ("screening", "screening needs 9e14 bytes (7 particles, 20 x 20 x 1 cells)", 1),
            ("nbs", "particle 3: y is NaN; mend it", 2),
            ("nbs", "particle 0: x is -inf; mend it", 2),
            ("nbs", "particle 0: the radius is -3; mend it", 3),
        ] {
            assert_eq!(reasons.number(detector, reason), number, "{reason}");
        }
    }
}
