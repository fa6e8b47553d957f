//! The verdicts that answer the question of an experiment.

use crate::document::{Block, Text};
use crate::sections::claims::{evidence, score};
use contactbench_record::findings::claim::{Status, Verdict};

/// Maximum number of claims that are listed one by one if none has `answers`.
const FEW: usize = 3;

pub fn blocks(verdicts: &[Verdict], with_evidence: bool) -> Vec<Block> {
    let listed = listed(verdicts);
    let mut out = Vec::new();
    if listed.len() < verdicts.len() && !listed.iter().any(|it| !it.claim.answers.is_empty()) {
        let details = if with_evidence { " The table of claims has the numbers." } else { "" };
        out.push(Block::paragraph(format!("{}.{details}", score(verdicts))));
    }
    let item = |verdict: &&Verdict| {
        let text = Text::default().strong(format!("{}:", word(verdict)));
        let text = text.plain(format!(" {}", verdict.claim.name));
        if with_evidence {
            let words = evidence(verdict);
            text.plain(match words.strip_prefix("on this machine: ") {
                Some(words) => format!(". Measured on this machine: {words}."),
                None => format!(". Measured: {words}."),
            })
        } else {
            text
        }
    };
    if !listed.is_empty() {
        out.push(Block::List(listed.iter().map(item).collect()));
    }
    out
}

/// Returns the claims that answer the question. If none is marked with `answers`, returns all if
/// they are few, else those that do not hold.
fn listed(verdicts: &[Verdict]) -> Vec<&Verdict> {
    let answers = |verdict: &&Verdict| !verdict.claim.answers.is_empty();
    let open = |verdict: &&Verdict| verdict.evidence.status != Status::Holds;
    if verdicts.iter().any(|verdict| answers(&verdict)) {
        return verdicts.iter().filter(answers).collect();
    }
    match verdicts.len() <= FEW {
        true => verdicts.iter().collect(),
        false => verdicts.iter().filter(open).collect(),
    }
}

/// Returns the experiment's answer if the claim holds, else the verdict.
fn word(verdict: &Verdict) -> String {
    let word = match verdict.evidence.status {
        Status::Holds if verdict.claim.answers.is_empty() => "holds",
        Status::Holds => &verdict.claim.answers,
        Status::Fails => "fails",
        Status::NotCovered => "not covered",
        Status::NotShown => "not shown",
    };
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
