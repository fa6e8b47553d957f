use crate::document::{Block, Text};
use crate::table::Table;
use contactbench_record::cells::{Cell as Measured, label};
use contactbench_record::findings::claim::verdicts::{CaseLine, CellAnswer, Matrix, case, judged};
use contactbench_record::record::column;
use contactbench_terms::number::plural;

pub fn blocks(found: &Matrix) -> Vec<Block> {
    let how = Text::marked(
        "An answer is right if it has exactly the pairs that touch in exact arithmetic in the \
         scene as given. The first table counts the answers of each kind. The second lists the \
         cases with an answer that is not right: -3 +1 means three pairs missed and one added (by \
         the predicate, or by the representation of the scene), *lossy* (a textbook filter lost \
         contacts), *refused*, *DEFECT* (not the answer of the detector's own arithmetic). \
         Detectors that are not named are right. Every answer, and each reason, is in \
         `verdicts.csv`.",
    );
    let lines = (!found.lines.is_empty()).then(|| Block::Table(lines(found)));
    let right = (!found.right.is_empty()).then(|| {
        let cases = plural(found.right.len(), "case");
        let right = found.right.join(", ");
        let words = "Right by every detector in every arithmetic";
        Block::paragraph(format!("{words}, {cases}: {right}."))
    });
    let first = [Block::Paragraph(how), Block::Table(totals(found))];
    first.into_iter().chain(lines).chain(right).collect()
}

fn totals(found: &Matrix) -> Table {
    let table = Table::of("", &found.totals).left("answers", |(word, _)| *word);
    let arithmetics = found.arithmetics.iter().enumerate();
    table.each(arithmetics, |table, (k, name)| table.right(name, |(_, counts)| counts[k])).into()
}

fn lines(found: &Matrix) -> Table {
    let table = Table::of("", &found.lines)
        .left("case", |line| &*line.case)
        .left("dim", |line| format!("{}D", line.dim));
    let answer = |line: &CaseLine, k: usize| line.answers[k].clone();
    let arithmetics = found.arithmetics.iter().enumerate();
    table.each(arithmetics, |table, (k, name)| table.left(name, |line| answer(line, k))).into()
}

pub fn rows(cells: &[&Measured]) -> Table {
    let cells = judged(cells);
    let swept = label::swept(&cells);
    let errors = column::errors().map(|error| &*error.name);
    Table::of("", cells)
        .left("experiment", |cell| &*cell.id.experiment)
        .left("case", |cell| case(&cell.id, &swept).0)
        .left("dim", |cell| u64::from(cell.id.dim))
        .left("n", |cell| cell.id.n)
        .left("seed", |cell| cell.id.seed)
        .left("detector", |cell| &*cell.id.detector)
        .left("arithmetic", |cell| &*cell.id.arithmetic)
        .left("answer", |cell| CellAnswer::new(cell).word())
        .left("outcome", |cell| cell.overall().0.name())
        .left("reason", |cell| cell.overall().1)
        .each(["contacts", "true_contacts"].into_iter().chain(errors), |table, name| {
            table.left(name, |cell| cell.variable(name, None))
        })
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::markdown;
    use crate::table::csv;
    use contactbench_record::cells::testing::hard_lab as lab;

    #[test]
    fn report_and_file_agree() {
        let report = markdown(&blocks(&lab().find(Matrix::new).unwrap()));
        for part in ["Right by every detector", "2 cases: calm 2D, calm 3D", "refused"] {
            assert!(report.contains(part), "{part}: {report}");
        }
        let line = "| tangent | 2D | -3 | nbs, sorting: lossy -2 | right |";
        assert!(report.contains(line), "{report}");
        let csv = csv(&[lab().find(rows)]);
        assert_eq!(csv.lines().count(), 1 + 5 * 3 * 3);
        for line in [
            "e,tangent,2,100,1,nbs,textbook,lossy,lossy,,250,250,2,0,0,0,0,0,2,",
            "e,far,3,100,1,nbs,exact,refused,refused,nbs would need 5.3e11 cells; use direct,,",
        ] {
            assert!(csv.contains(line), "{line} is not in {csv}");
        }
    }
}
