//! Growth of operation counts with n: exponent and law, fitted to exact counts.

use std::collections::{BTreeMap, HashSet};

use crate::cells::{Cell, CellId, label};
use crate::record::id::Projection;
use crate::record::row::Pass;
use crate::stats::growth::{self, Choice};
use contactbench_terms::op::Op;

#[derive(Clone, Debug, PartialEq)]
pub struct Operations {
    pub scene: String,
    pub detector: String,
    pub choice: Choice,
}

pub fn operations(cells: &[&Cell]) -> Vec<Operations> {
    let mut series: BTreeMap<Projection, Vec<(f64, f64)>> = BTreeMap::new();
    // Operations are always counted with one thread.
    let single: HashSet<&CellId> =
        cells.iter().map(|cell| &cell.id).filter(|id| id.threads() == 1).collect();
    let again =
        |cell: &Cell| cell.id.threads() > 1 && single.contains(&cell.id.clone().with_threads(1));
    let counted = |cell: &&&Cell| {
        !cell.role.is_control() && cell.outcome(&[Pass::Count]).0.is_good() && !again(cell)
    };
    for cell in cells.iter().filter(counted) {
        let operations =
            Op::ALL.into_iter().map(|op| cell.variable(op.name(), None)).sum::<Option<f64>>();
        if let Some(operations) = operations.filter(|&operations| operations > 0.0) {
            let key = cell.id.without(&["n", "seed"]);
            series.entry(key).or_default().push((cell.id.n as f64, operations));
        }
    }
    series.retain(|_, points| points.iter().any(|point| point.0 != points[0].0));
    let more = label::varying(cells)
        .into_iter()
        .filter(|name| !["scene", "dim", "n", "seed", "detector"].contains(&name.as_str()));
    let fields: Vec<String> =
        ["scene".to_string(), "dim".to_string()].into_iter().chain(more).collect();
    let line = |(key, points): (&Projection, &Vec<(f64, f64)>)| Operations {
        scene: label::place(key, &fields),
        detector: key.axis("detector").map(|it| it.to_string()).unwrap_or_default(),
        choice: growth::choose(points),
    };
    series.iter().map(line).collect()
}
