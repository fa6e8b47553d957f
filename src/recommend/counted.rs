//! Which detector for a scene, without a clock: its operations are counted once, and priced by a
//! cost model that was fitted to the times of other scenes ([`crate::findings::cost`]).

use crate::cells::{Cell, CellId};
use crate::contact::{Arithmetic, Test};
use crate::detect::{Options, table};
use crate::findings::cost::Fit;
use crate::probe::Tally;
use crate::scene::AnyScene;
use crate::sink::Count;

/// The order of particles whose costs are taken where those of several are known.
const ORDER: &str = "shuffled";
/// A detector that tests every pair is not asked to count among more particles.
const MOST_DIRECT: usize = 20_000;

/// The detectors of a cost model with the nanoseconds foretold for one detection in exact
/// arithmetic, the fastest first. Those that refuse the scene are left out, as are fits of
/// detectors with parameters, and of orders besides the first that is known.
pub fn foretold(scene: &AnyScene<'_>, fits: &[Fit], memory_limit: u64) -> Vec<(String, f64)> {
    let exact = fits.iter().filter(|fit| fit.line.arithmetic == Arithmetic::Exact.name());
    let mut exact: Vec<&Fit> = exact.filter(|fit| fit.line.threads == 1).collect();
    exact.sort_by_key(|fit| fit.order != ORDER);
    let mut found: Vec<(String, f64)> = Vec::new();
    for fit in exact {
        let name = fit.line.detector.as_str();
        let known = found.iter().any(|(known, _)| known == name);
        let slow = table::find(name).is_some_and(|entry| entry.memory == "0");
        let hopeless = slow && scene.len() > MOST_DIRECT;
        if !known
            && !hopeless
            && let Some(cell) = counted(scene, name, memory_limit)
        {
            found.push((name.into(), fit.at(&cell)));
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found
}

/// The cell that a pass of counts would make.
fn counted(scene: &AnyScene<'_>, name: &str, memory_limit: u64) -> Option<Cell> {
    let mut detector = table::find(name)?.make(Options { memory_limit, threads: 1 });
    let (mut tally, mut contacts) = (Tally::default(), Count::default());
    detector.count(scene, Test::Exact, &mut tally, &mut contacts).ok()?;
    let id = CellId {
        dim: scene.dim() as u32,
        n: scene.len() as u64,
        arithmetic: Arithmetic::Exact.name().into(),
        ..CellId::default()
    };
    let mut cell = Cell { id: id.with_contender(name).with_threads(1), ..Cell::default() };
    cell.values.extend(tally.iter().map(|(op, count)| (op.name(), count as f64)));
    cell.values.insert("contacts", contacts.0 as f64);
    // As many as the memory pass finds, for detectors whose formula is exact.
    cell.values.insert("peak_bytes", detector.formula_bytes() as f64);
    Some(cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::findings::crossover::CostModel;
    use crate::scene::spec::Spec;

    #[test]
    fn counts_times_costs_name_the_fastest() {
        // Two nanoseconds for a test of direct, a thousand for a particle of nbs.
        let mut lab = Lab::new("e", "packed");
        for n in [50_u64, 70, 100, 140, 200, 280, 400, 560, 800, 1120] {
            let tests = n * (n - 1) / 2;
            lab.n(n).detector("direct").time(&[2 * tests; 5]).count(&[("contact_test", tests)]);
            lab.detector("nbs").time(&[1000 * n; 5]).count(&[("list_push", n)]);
        }
        let cells = cells::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let model = CostModel::new(&all, &[]).unwrap();
        let first = |spec: &str| {
            let scene = Spec::parse(spec).unwrap().make().unwrap();
            let found = foretold(&scene, &model.fits, 1 << 30);
            assert_eq!(found.len(), if scene.len() > MOST_DIRECT { 1 } else { 2 });
            found[0].0.clone()
        };
        assert_eq!(first("loose:n=300,fraction=0.01"), "direct");
        assert_eq!(first("loose:n=9000,fraction=0.01"), "nbs");
        assert_eq!(first("loose:n=30000,fraction=0.01"), "nbs");
    }
}
