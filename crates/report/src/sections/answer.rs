//! What the claims of an experiment answer to its question, in short: the verdicts that stand under
//! the question, before the fastest detectors.

use crate::document::{Block, Text};
use crate::sections::claims::{evidence, score};
use contactbench_record::findings::claim::{Status, Verdict};

/// Claims without `answers` are listed one by one up to this many.
const FEW: usize = 3;

/// The verdicts with their evidence, or without it.
pub fn blocks(verdicts: &[Verdict], with_evidence: bool) -> Vec<Block> {
    let listed = listed(verdicts);
    let mut out = Vec::new();
    if listed.len() < verdicts.len() && !listed.iter().any(|it| !it.answers.is_empty()) {
        out.push(Block::paragraph(score(verdicts) + "."));
    }
    let item = |verdict: &&Verdict| {
        let text = Text::new().strong(format!("{}:", word(verdict)));
        let text = text.plain(format!(" {}", verdict.claim));
        if with_evidence { text.plain(format!(": {}", evidence(&verdict.evidence))) } else { text }
    };
    if !listed.is_empty() {
        out.push(Block::List(listed.iter().map(item).collect()));
    }
    out
}

/// The claims that answer the question; without such all if they are few, else those that do not
/// hold.
fn listed(verdicts: &[Verdict]) -> Vec<&Verdict> {
    let answers = |verdict: &&Verdict| !verdict.answers.is_empty();
    let open = |verdict: &&Verdict| verdict.status != Status::Holds;
    if verdicts.iter().any(|verdict| answers(&verdict)) {
        return verdicts.iter().filter(answers).collect();
    }
    match verdicts.len() <= FEW {
        true => verdicts.iter().collect(),
        false => verdicts.iter().filter(open).collect(),
    }
}

/// The answer if the claim holds and the experiment gives one, else the verdict.
fn word(verdict: &Verdict) -> String {
    let word = match verdict.status {
        Status::Holds if verdict.answers.is_empty() => "holds",
        Status::Holds => &verdict.answers,
        Status::Fails => "fails",
        Status::NotCovered => "not covered",
        Status::NotShown => "not shown",
    };
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The verdicts in a few words; `None` without claims.
pub fn brief(verdicts: &[Verdict]) -> Option<Text> {
    let listed: Vec<String> = listed(verdicts).iter().map(|it| word(it).to_lowercase()).collect();
    let answered = verdicts.iter().any(|verdict| !verdict.answers.is_empty());
    let held = verdicts.iter().filter(|verdict| verdict.status == Status::Holds).count();
    match verdicts.len() {
        0 => None,
        _ if answered => Some(Text::new().strong(listed.join(", "))),
        all => Some(Text::new().strong(format!("{held} of {all}")).plain(match all {
            1 => " claim holds",
            _ => " claims hold",
        })),
    }
}
