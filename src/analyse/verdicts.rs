//! Right or not, case by case: the table of an experiment that asks no times, `table = "verdicts"`.
//!
//! A line per scene (or hard case) and dimension, a column per arithmetic. A cell names only who is not right, and how. An answer is right
//! if it has exactly the pairs that touch in exact arithmetic in the scene as given, whatever its arithmetic. Every answer stands
//! in `verdicts.csv`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::value::{Cell, Key, Param};
use super::{errors, place, summary, text};
use crate::contact::Arithmetic;
use crate::harness::record::{Errors, Outcome};

/// What became of one question.
#[derive(Clone, Debug, PartialEq)]
enum Answer {
    Right,
    /// The detector is: its answer is not that of its own arithmetic.
    Defect(Option<Errors>),
    /// The arithmetic is, or the way it stores the scene.
    Wrong(Errors),
    /// The filters of a textbook lost contacts.
    Lossy(Errors),
    Refused(String),
    /// No answer for another reason, or none that could be compared.
    Without(Outcome, String),
}

impl Answer {
    fn of(cell: &Cell) -> Answer {
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

    /// One of [`WORDS`].
    fn word(&self) -> &'static str {
        match self {
            Answer::Right => "right",
            Answer::Defect(_) | Answer::Wrong(_) => "wrong",
            Answer::Lossy(_) => "lossy",
            Answer::Refused(_) => "refused",
            Answer::Without(..) => "no answer",
        }
    }

    /// Which of the answers to one question (from several seeds) speaks for all.
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

/// `-3 +1` for three missed and one spurious pair.
fn said(errors: &Errors) -> String {
    let all = [(errors.missed, "-", ""), (errors.spurious, "+", ""), (errors.duplicate, "", " twice"), (errors.self_pairs, "", " self")];
    let some = all.iter().filter(|(count, ..)| *count > 0).map(|(count, before, behind)| format!("{before}{count}{behind}"));
    some.collect::<Vec<_>>().join(" ")
}

/// Reasons, numbered. Those that differ only in numbers, axes and the detector's name are one.
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

/// Scene and parameters, and what to call them.
type Case = (String, Vec<(String, Param)>);
/// The answers of all detectors in one arithmetic.
type Answers<'a> = BTreeMap<&'a str, Answer>;

/// The table of one experiment.
pub struct Matrix {
    heads: Vec<String>,
    lines: Vec<Vec<String>>,
    /// Cases with nothing but right answers.
    right: Vec<String>,
    reasons: Vec<String>,
    totals: Vec<Vec<String>>,
}

impl Matrix {
    /// Puts the answers together; none without any.
    pub fn new(cells: &[&Cell]) -> Option<Matrix> {
        let cells = judged(cells);
        let swept = place::swept(&cells);
        let mut cases: BTreeMap<Case, BTreeMap<u32, BTreeMap<&str, Answers>>> = BTreeMap::new();
        let mut totals: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
        for cell in &cells {
            let answer = Answer::of(cell);
            *totals.entry(&cell.key.arithmetic).or_default().entry(answer.word()).or_default() += 1;
            let dims = cases.entry(case(&cell.key, &swept)).or_default();
            let answers = dims.entry(cell.key.dim).or_default().entry(&cell.key.arithmetic).or_default();
            let known = answers.entry(&cell.key.detector).or_insert(Answer::Right);
            if answer.weight() > known.weight() {
                *known = answer;
            }
        }
        let mut arithmetics: Vec<&str> = totals.keys().copied().collect();
        arithmetics.sort_by_key(|name| Arithmetic::ALL.iter().position(|known| known.name() == *name));
        let every: BTreeSet<u32> = cells.iter().map(|cell| cell.key.dim).collect();
        let (mut reasons, mut lines, mut right) = (Reasons::default(), Vec::<Vec<String>>::new(), Vec::new());
        for ((name, _), dims) in &cases {
            let mut found: Vec<(Vec<u32>, Vec<String>)> = Vec::new();
            for (dim, columns) in dims {
                let column = |name: &&str| columns.get(name).map_or("–".into(), |answers| cell_text(answers, &mut reasons));
                let line: Vec<String> = arithmetics.iter().map(column).collect();
                match found.iter_mut().find(|(_, known)| *known == line) {
                    Some((dims, _)) => dims.push(*dim),
                    None => found.push((vec![*dim], line)),
                }
            }
            for (dims, line) in found {
                let everywhere = dims.len() == every.len();
                let dims: Vec<String> = dims.iter().map(|dim| format!("{dim}D")).collect();
                if line.iter().all(|cell| cell == "right") {
                    right.push(if everywhere { name.clone() } else { format!("{name} ({})", dims.join(", ")) });
                } else {
                    lines.push([name.clone(), dims.join(" ")].into_iter().chain(line).collect());
                }
            }
        }
        let used: Vec<&str> = WORDS.into_iter().filter(|word| totals.values().any(|counts| counts.contains_key(word))).collect();
        let total = |word: &str| {
            let counts = arithmetics.iter().map(|name| totals[name].get(word).copied().unwrap_or(0).to_string());
            [word.to_string(), String::new()].into_iter().chain(counts).collect()
        };
        let heads = ["case", "dim"].into_iter().chain(arithmetics.iter().copied()).map(String::from).collect();
        let reasons = reasons.0.into_iter().map(|(_, reason)| reason).collect();
        (!cells.is_empty()).then(|| Matrix { heads, lines, right, reasons, totals: used.into_iter().map(total).collect() })
    }

    fn right(&self) -> String {
        format!("right by every detector in every arithmetic, {}: {}", text::plural(self.right.len(), "case"), self.right.join(", "))
    }

    /// For a terminal.
    pub fn plain(&self) -> String {
        let columns = self.heads.len().saturating_sub(2).max(1);
        let mut widths = vec![28, 5];
        // 110 columns, two blanks between
        widths.resize(self.heads.len(), 77_usize.saturating_sub(2 * columns) / columns);
        let rows: Vec<Vec<String>> = [self.heads.clone()].into_iter().chain(self.lines.clone()).chain(self.totals.clone()).collect();
        let mut out = text::plain_table(&widths, &rows);
        out += "\n-: pairs missed, +: pairs added; in brackets: the reason below, one example of its kind\n";
        if !self.right.is_empty() {
            out += "\n";
            for line in text::wrap(&self.right(), 110) {
                let _ = writeln!(out, "{line}");
            }
        }
        for (k, reason) in self.reasons.iter().enumerate() {
            for (line, piece) in text::wrap(reason, 104).iter().enumerate() {
                let number = if line == 0 { format!("({})", k + 1) } else { String::new() };
                let _ = writeln!(out, "{number:<5} {piece}");
            }
        }
        out
    }

    /// For the report.
    pub fn markdown(&self) -> String {
        let heads: Vec<&str> = self.heads.iter().map(String::as_str).collect();
        let totals = self.totals.iter().map(|line| line.iter().map(|cell| cell.to_string()).collect());
        let mut out = text::markdown_table(&heads, &totals.collect::<Vec<_>>());
        if !self.lines.is_empty() {
            let _ = write!(out, "\n{}", text::markdown_table(&heads, &self.lines));
        }
        if !self.right.is_empty() {
            let _ = write!(out, "\n{}.\n", text::escape(&self.right()));
        }
        for (k, reason) in self.reasons.iter().enumerate() {
            let _ = write!(out, "\n({}) {}\n", k + 1, text::escape(reason));
        }
        out
    }
}

/// All but controls, which are not asked to be right.
fn judged<'a>(cells: &[&'a Cell]) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| !summary::is_control(&cell.key.detector)).copied().collect()
}

/// A hard case has a name; any other scene is named after its parameters.
fn case(key: &Key, swept: &[String]) -> Case {
    let params: Vec<(String, Param)> = key.params.iter().filter(|(name, _)| swept.contains(name)).cloned().collect();
    if let Some(Param::Text(name)) = key.field("case") {
        return (name, Vec::new());
    }
    let text: String = params.iter().map(|(name, value)| format!(", {name} = {value}")).collect();
    (format!("{}, N = {}{text}", key.scene, key.n), params)
}

/// `right`, or who is not and how: `nbs, sorting: -3 +1; all but direct: refused (1)`; without names it is all.
fn cell_text(answers: &Answers, reasons: &mut Reasons) -> String {
    let all: Vec<&str> = answers.keys().copied().collect();
    let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
    for (&detector, answer) in answers {
        let words = match answer {
            Answer::Right => continue,
            Answer::Defect(Some(errors)) if errors.wrong() > 0 => format!("DEFECT {}", said(errors)),
            // against the scene as given its error and the arithmetic's may cancel
            Answer::Defect(_) => "DEFECT".into(),
            Answer::Wrong(errors) => said(errors),
            // what the filter lost need not touch in exact arithmetic
            Answer::Lossy(errors) => format!("lossy {}", said(errors)).trim_end().into(),
            Answer::Refused(reason) => format!("refused ({})", reasons.number(detector, reason)),
            Answer::Without(outcome, reason) if outcome.is_good() || reason.is_empty() => "not compared".into(),
            Answer::Without(outcome, reason) => format!("{} ({})", outcome.name(), reasons.number(detector, reason)),
        };
        match groups.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(detector),
            None => groups.push((words, vec![detector])),
        }
    }
    if groups.is_empty() {
        return "right".into();
    }
    let named = |(words, names): (String, Vec<&str>)| match summary::group(&names, &all).as_str() {
        "all" => words,
        names => format!("{names}: {words}"),
    };
    groups.into_iter().map(named).collect::<Vec<_>>().join("; ")
}

/// Every answer, as CSV.
pub fn csv<'a>(cells: impl Iterator<Item = &'a Cell>) -> String {
    let cells: Vec<&Cell> = cells.collect();
    let (cells, names) = (judged(&cells), errors::names().collect::<Vec<_>>());
    let mut swept: BTreeMap<&str, Vec<&Cell>> = BTreeMap::new();
    for &cell in &cells {
        swept.entry(&cell.key.experiment).or_default().push(cell);
    }
    let swept: BTreeMap<&str, Vec<String>> = swept.into_iter().map(|(experiment, cells)| (experiment, place::swept(&cells))).collect();
    let heads =
        ["experiment", "case", "dim", "n", "seed", "detector", "arithmetic", "answer", "outcome", "reason", "contacts", "true_contacts"];
    let mut out = heads.into_iter().chain(names.iter().map(String::as_str)).collect::<Vec<_>>().join(",") + "\n";
    for cell in &cells {
        let (key, (outcome, reason)) = (&cell.key, cell.overall());
        let number = |name: &str| cell.variable(name, None).map_or(String::new(), |value| value.to_string());
        let mut line = vec![key.experiment.clone(), case(key, &swept[&*key.experiment]).0];
        line.extend([u64::from(key.dim), key.n, key.seed].map(|value| value.to_string()));
        line.extend([&key.detector, &key.arithmetic, Answer::of(cell).word(), outcome.name(), reason].map(String::from));
        line.extend(["contacts", "true_contacts"].into_iter().chain(names.iter().map(String::as_str)).map(number));
        out += &line.iter().map(|field| text::quote(field)).collect::<Vec<_>>().join(",");
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;
    use crate::harness::record::{Causes, Pass};

    /// Three cases: right everywhere; wrong in f32 and lossy in textbook; refused by all but direct.
    fn lab() -> Lab {
        let mut lab = Lab::new("e", "hard");
        for (case, dims) in [("calm", vec![2, 3]), ("tangent", vec![2]), ("far", vec![2, 3])] {
            for dim in dims {
                lab.scene("hard", dim).param("case", case);
                for arithmetic in ["exact", "f32", "textbook"] {
                    for detector in ["direct", "nbs", "sorting", "nothing"] {
                        lab.arithmetic(arithmetic).detector(detector);
                        if case == "far" && detector != "direct" {
                            let reason = format!("{detector} would need 5.{dim}e11 cells; use direct");
                            lab.fail(Pass::Count, Outcome::Refused, &reason);
                            continue;
                        }
                        let (missed, outcome) = match (case, arithmetic, detector) {
                            ("tangent", "f32", _) => (3, Outcome::Ok),
                            ("tangent", "textbook", "nbs" | "sorting") => (2, Outcome::Lossy),
                            _ => (0, Outcome::Ok),
                        };
                        let errors = Errors { missed, ..Errors::default() };
                        lab.count(&[]).errors(errors, Causes::default()).edit(|row| row.outcome = outcome);
                    }
                }
            }
        }
        lab
    }

    fn matrix(lab: &Lab) -> Matrix {
        let cells = value::cells(&lab.rows());
        Matrix::new(&cells.iter().collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_cell_names_who_is_not_right_and_how() {
        let matrix = matrix(&lab());
        assert_eq!(matrix.heads, ["case", "dim", "f32", "textbook", "exact"]);
        let refused = "nbs, sorting: refused (1)";
        assert_eq!(
            matrix.lines,
            [vec!["far", "2D 3D", refused, refused, refused], vec!["tangent", "2D", "-3", "nbs, sorting: lossy -2", "right"]]
        );
        assert_eq!(matrix.right, ["calm"]);
        assert_eq!(matrix.reasons, ["nbs would need 5.2e11 cells; use direct"]);
        let totals =
            [["right", "", "8", "9", "11"], ["wrong", "", "3", "0", "0"], ["lossy", "", "0", "2", "0"], ["refused", "", "4", "4", "4"]];
        assert_eq!(matrix.totals, totals);
        let (plain, markdown) = (matrix.plain(), matrix.markdown());
        assert!(plain.lines().all(|line| line.chars().count() <= 110), "{plain}");
        for part in ["right by every detector", "1 case: calm", "(1)", "nbs would need"] {
            assert!(plain.contains(part) && markdown.contains(part), "{part}: {plain}\n{markdown}");
        }
    }

    #[test]
    fn a_defect_outshouts_everything_and_controls_are_not_asked() {
        let mut lab = lab();
        lab.scene("hard", 2).param("case", "calm").arithmetic("exact").detector("nbs");
        lab.fail(Pass::Memory, Outcome::Wrong, "1 missed");
        let found = matrix(&lab);
        assert_eq!(found.right, ["calm (3D)"]);
        assert_eq!(found.lines[0], ["calm", "2D", "right", "right", "nbs: DEFECT"]);
        assert!(!found.plain().contains("nothing"));
    }

    #[test]
    fn reasons_of_one_kind_are_one() {
        let mut reasons = Reasons::default();
        for (detector, reason, number) in [
            ("nbs", "nbs needs 80 bytes (82 elements, 2002 x 17 cells)", 1),
            ("screening", "screening needs 9e14 bytes (7 elements, 20 x 20 x 1 cells)", 1),
            ("nbs", "particle 3: y is NaN; mend it", 2),
            ("nbs", "particle 0: x is -inf; mend it", 2),
            ("nbs", "particle 0: the radius is -3; mend it", 3),
        ] {
            assert_eq!(reasons.number(detector, reason), number, "{reason}");
        }
    }

    #[test]
    fn every_answer_is_a_line_of_the_csv() {
        let cells = value::cells(&lab().rows());
        let csv = csv(cells.iter());
        assert_eq!(csv.lines().count(), 1 + 5 * 3 * 3);
        assert!(csv.contains("e,tangent,2,100,1,nbs,textbook,lossy,lossy,,250,250,2,0,0,0,0,0,2,"), "{csv}");
        assert!(csv.contains("e,far,3,100,1,nbs,exact,refused,refused,nbs would need 5.3e11 cells; use direct,,"), "{csv}");
    }
}
