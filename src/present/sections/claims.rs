//! Claims and what came of them.

use crate::findings::claim::{Status, Verdict};
use crate::number::plural;
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};

/// `26 claims: 25 hold, 0 fail, 1 could not be shown`.
pub fn score(verdicts: &[Verdict]) -> String {
    let count = |status: Status| verdicts.iter().filter(|verdict| verdict.status == status).count();
    let (holds, fails, open) =
        (count(Status::Holds), count(Status::Fails), count(Status::NotShown));
    format!(
        "{}: {holds} hold, {fails} fail, {open} could not be shown",
        plural(verdicts.len(), "claim")
    )
}

/// For a report: the table, and how the claims are checked.
pub fn blocks(verdicts: &[Verdict]) -> Vec<Block> {
    if verdicts.is_empty() {
        return Vec::new();
    }
    let columns = ["claim", "verdict", "evidence", "source"].map(Column::left).into();
    let row = |verdict: &Verdict| -> Vec<Cell> {
        [&*verdict.claim, verdict.status.name(), &verdict.evidence, &verdict.source]
            .map(Cell::from)
            .into()
    };
    vec![
        Block::Table(Table::new("", columns).with(verdicts.iter().map(row))),
        Block::paragraph(
            "Claims are checked from counts, bytes and digests, which are the same on every \
             machine, except those marked \"of this machine\".",
        ),
    ]
}

/// For a terminal: the table and the score.
pub fn terminal(verdicts: &[Verdict]) -> Vec<Block> {
    let several = verdicts.iter().any(|verdict| verdict.experiment != verdicts[0].experiment);
    let named = |v: &Verdict| {
        if several { format!("{}: {}", v.experiment, v.claim) } else { v.claim.clone() }
    };
    let row = |v: &Verdict| -> Vec<Cell> {
        vec![v.status.name().into(), named(v).into(), v.evidence.as_str().into()]
    };
    let table = Table::new("", ["", "", ""].map(Column::left).into());
    let score = Block::Paragraph(Text::from(score(verdicts)));
    vec![Block::Table(table.with(verdicts.iter().map(row))), score]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::present::document::{markdown, plain};

    #[test]
    fn the_table_fits_a_terminal() {
        let verdict = Verdict {
            experiment: "e".into(),
            claim: "c".into(),
            source: String::new(),
            status: Status::Fails,
            machine_independent: true,
            evidence: "2 to 2.003 over n = 100..30000 (0.2%, allowed 0.01%); ".repeat(3),
        };
        let text = plain(&terminal(&[verdict.clone(), verdict.clone()]), 80);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.starts_with("FAILS  c  2 to 2.003"), "{text}");
        assert!(text.ends_with("2 claims: 0 hold, 2 fail, 0 could not be shown\n"), "{text}");
        assert!(markdown(&blocks(&[verdict])).contains("| c | FAILS | 2 to 2.003"));
    }
}
