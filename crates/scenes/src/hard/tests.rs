//! Tests that the catalogue is complete, its expectations hold, and every detector passes it.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::*;
use crate::spec::{Order, Spec};
use crate::stats::hash;
use contactbench_detectors::book::mask;
use contactbench_detectors::oracle;
use contactbench_detectors::oracle::NoTruth;
use contactbench_detectors::oracle::boxes;
use contactbench_detectors::table::{Entry, Role, TABLE};
use contactbench_ground::contact::{Arithmetic, Particles, WithParticles, with_particles};
use contactbench_ground::detect::Options;
use contactbench_ground::filter::cells::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::probe::{Silent, Tally};
use contactbench_ground::scene::{AnyScene, Real, SceneError, Stored};
use contactbench_lists::periodic::Finder;

/// Returns all valid cases in all their dimensions, with their scenes.
fn valid() -> impl Iterator<Item = (&'static Case, u32, Vec<Given>)> {
    cases()
        .filter(|case| case.expect != Expect::Invalid)
        .flat_map(|case| case.dims.iter().map(move |&dim| (case, dim, case.steps(dim).unwrap())))
}

fn groups() -> Vec<&'static str> {
    let mut groups: Vec<_> = cases().map(|case| case.group).collect();
    groups.dedup();
    groups
}

#[test]
fn the_catalogue_is_complete() {
    let names: HashSet<&str> = cases().map(|case| case.name).collect();
    assert_eq!(names.len(), cases().count(), "a name occurs twice");
    let rows = include_str!("cases.md").lines().filter(|line| line.starts_with("| "));
    assert_eq!(names.len(), rows.filter(|row| !row.starts_with("| case |")).count());
    assert_eq!(names.len(), MAKERS.into_iter().flatten().count());
    for group in groups() {
        let of_group = cases().filter(|case| case.group == group).count();
        assert!(of_group >= 4, "{group}");
    }
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    for case in cases() {
        assert!(case.name.chars().all(fits), "{}", case.name);
        assert!(case.reason.len() > 20 && !case.source.is_empty(), "{}", case.name);
    }
    for (case, dim, steps) in valid() {
        for Given { scene, lattice, .. } in &steps {
            assert!(scene.dim() == dim as usize && scene.len() <= 3000, "{}", case.name);
            assert_eq!(lattice.is_some(), case.group == "boxes", "{}", case.name);
        }
        assert_eq!(steps.len() > 1, case.group == "state", "{}", case.name);
        assert!(!steps.is_empty(), "{}", case.name);
    }
}

fn truth(steps: &[Given], arithmetic: Arithmetic) -> Result<Digest, NoTruth> {
    let last = &steps[steps.len() - 1];
    match last.periodic().unwrap() {
        None => oracle::truth(&last.scene, arithmetic).map(|truth| truth.digest),
        Some(last) => boxes::truth(&last, arithmetic, 1 << 30).map(|truth| truth.digest),
    }
}

#[test]
fn expected_contacts_agree_with_the_oracle() {
    for (case, dim, steps) in valid() {
        let truth = truth(&steps, Arithmetic::Exact).unwrap();
        if let Expect::Contacts(contacts) = case.expect {
            assert_eq!(truth.contacts, contacts[usize::from(dim == 3)], "{} in {dim}D", case.name);
        }
    }
}

fn spec(case: &Case, dim: u32) -> Spec {
    let params = [("case".to_string(), case.name.into())].into();
    Spec::new("hard", dim, 0, 1, Order::Generated, &params).unwrap()
}

#[test]
fn invalid_cases_name_the_particle() {
    for case in cases().filter(|case| case.expect == Expect::Invalid) {
        for &dim in case.dims {
            let error = spec(case, dim).make().unwrap_err();
            let found = error.chain().find_map(|cause| cause.downcast_ref::<SceneError>());
            let said = found.map(ToString::to_string).unwrap_or_default();
            assert!(said.starts_with("particle 3: "), "{}: {error:#}", case.name);
        }
    }
}

fn detectors() -> impl Iterator<Item = &'static Entry> {
    TABLE.iter().filter(|entry| entry.role == Role::Detector)
}

/// Returns the outcome of a new detector on the last step, and the digest of its contacts. Cases
/// need little memory, because detectors must refuse large domains.
fn last_answer(
    entry: &Entry,
    arithmetic: Arithmetic,
    steps: &[Given],
) -> Option<(Result<(), Refusal>, Digest)> {
    let mut detector = entry.make(Options::default());
    let mut last = None;
    for step in steps {
        let (mut counted, mut listed) = (ContactList::default(), ContactList::default());
        let answers = match step.periodic().unwrap() {
            Some(step) => {
                let mut finder = Finder::new(1 << 30);
                let tally = &mut Tally::default();
                [
                    finder.find(&step, &mut *detector, arithmetic, Some(tally), &mut counted),
                    finder.list(&step, &mut *detector, arithmetic, &mut listed),
                ]
            }
            None => {
                let (scene, test) = (step.scene.stored(arithmetic).ok()?, arithmetic.test());
                [
                    detector.visit(&scene, test, &mut counted.plain),
                    detector.list(&scene, test, &mut listed.plain),
                ]
            }
        };
        let [answer, again] = answers;
        let digest = counted.digest();
        assert_eq!(again, answer, "{}: listed and counted", entry.name);
        assert_eq!(listed.digest(), digest, "{}: listed and counted", entry.name);
        let (name, bytes) = (entry.name, detector.formula_bytes());
        assert!(answer.is_ok() || digest == Digest::default(), "{name} refused what it reported");
        assert!(answer.is_err() || bytes < 200 << 20, "{name}: {bytes} bytes");
        last = Some((answer, digest));
    }
    last
}

/// In exact arithmetic only the refusals that a case allows may occur; in others, any refusal.
#[test]
fn every_detector_is_right_in_every_safe_arithmetic() {
    let mut refused: BTreeSet<(&str, &str, bool)> = BTreeSet::new();
    for (case, dim, steps) in valid() {
        for arithmetic in Arithmetic::SAFE {
            let exact = arithmetic == Arithmetic::Exact;
            let Ok(truth) = truth(&steps, arithmetic) else {
                assert!(!exact, "{}: exact arithmetic holds every scene", case.name);
                continue;
            };
            for entry in detectors() {
                let Some((answer, digest)) = last_answer(entry, arithmetic, &steps) else {
                    continue;
                };
                let what =
                    format!("{} in {dim}D: {} in {}", case.name, entry.name, arithmetic.name());
                let Err(refusal) = answer else {
                    assert_eq!(digest, truth, "{what}");
                    continue;
                };
                if exact {
                    let allowed = match refusal {
                        Refusal::Domain { .. } | Refusal::Extent { .. } => {
                            case.allows.contains(&Allowed::Domain)
                        }
                        Refusal::Memory { .. } => case.allows.contains(&Allowed::Memory),
                        _ => false,
                    };
                    assert!(allowed && entry.name != "direct", "{what}: {refusal}");
                    refused.insert((case.name, entry.name, dim == 3));
                }
            }
        }
    }
    for case in cases().filter(|case| !case.allows.is_empty()) {
        let occurs = refused.iter().any(|(name, ..)| *name == case.name);
        assert!(occurs, "{}: nothing is refused", case.name);
    }
}

#[test]
fn a_spec_gives_last_step_and_history() {
    for case in cases().filter(|case| ["state", "keys", "boxes"].contains(&case.group)) {
        for &dim in case.dims {
            let spec = spec(case, dim);
            let mut steps = spec.history().unwrap();
            steps.push(spec.given().unwrap());
            assert!(steps == case.steps(dim).unwrap(), "{}", case.name);
        }
    }
    assert!(Spec::parse("packed:n=10").unwrap().history().unwrap().is_empty());
    assert_eq!(Spec::parse("hard:case=shrink-then-grow").unwrap().history().unwrap().len(), 2);
    assert!(cases().all(|case| find(case.name).is_ok_and(|found| std::ptr::eq(found, case))));
    assert!(cases().next().unwrap().steps(4).is_err());
}

/// Counts contacts by the cell of the second particle minus that of the first, in input order.
struct ByOffset<const D: usize>(Vec<[u32; 2]>);

impl<T: Real, const D: usize> WithParticles<T, D> for ByOffset<D> {
    type Output = Result<HashMap<[i64; D], usize>, Refusal>;
    fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
        let cells = Cells::new(&particles)?;
        let cell = |i: u32| {
            let position = particles.position(i);
            std::array::from_fn::<i64, D, _>(|k| {
                i64::from(cells.index(position[k], k, &mut Silent))
            })
        };
        let mut found = HashMap::new();
        for [i, j] in self.0 {
            let (a, b) = (cell(i), cell(j));
            *found.entry(std::array::from_fn(|k| b[k] - a[k])).or_default() += 1;
        }
        Ok(found)
    }
}

/// A detector that omits one cell of its mask, half or full, misses a contact of `every-neighbour`.
#[test]
fn every_cell_of_the_mask_is_needed() {
    let case = find("every-neighbour").unwrap();
    let pairs = |scene: &AnyScene<'_>| oracle::truth(scene, Arithmetic::Exact).unwrap().pairs;
    macro_rules! needed {
        ($dim:literal, $space:ident, $mask:expr, $cells:literal) => {
            let scene = case.steps($dim).unwrap().remove(0).scene;
            let AnyScene::$space(Stored::F64(stored)) = &scene else { panic!("cases are in f64") };
            let by_offset = ByOffset::<$dim>(pairs(&scene));
            let found = with_particles(stored, Arithmetic::Exact.test(), by_offset).unwrap();
            let both = |v: &[i32; $dim]| [v.map(i64::from), v.map(|x| -i64::from(x))];
            assert!($mask.iter().flat_map(both).all(|v| found[&v] == 1) && found.len() == $cells);
        };
    }
    needed!(2, Plane, mask::PLANE, 8);
    needed!(3, Space, mask::SPACE, 26);
}

/// The book's filters as printed miss contacts on cases about borders.
#[test]
fn textbook_filters_fail_on_border_cases() {
    let mut wrong: BTreeSet<(&str, &str)> = BTreeSet::new();
    for (case, _, steps) in valid() {
        let Ok(truth) = truth(&steps, Arithmetic::Textbook) else {
            continue;
        };
        for entry in detectors() {
            if let Some((Ok(()), digest)) = last_answer(entry, Arithmetic::Textbook, &steps)
                && digest != truth
            {
                wrong.insert((case.name, entry.name));
            }
        }
    }
    // Only built-in detectors are checked; one that a user adds need not have the book's filters.
    let textbook =
        ["binary-tree", "screening", "sorting", "nbs", "cell-grid", "hash-grid", "hgrid"];
    for Entry { name, .. } in detectors().filter(|entry| textbook.contains(&entry.name)) {
        let far = ["screening", "cell-grid"].contains(name);
        for case in ["three-across-a-border", "couples-from-minus-one", "couples-below-zero"] {
            assert!(wrong.contains(&(case, *name)), "{case}: {name}");
        }
        assert!(far || wrong.contains(&("couples-far-from-xmin", *name)), "{name}");
    }
}

/// Hashes all steps of a group's cases, so that published scenes never change.
#[test]
fn the_bits_of_every_case_are_fixed() {
    let of_group = |group: &str| {
        let steps = valid().filter(|(case, ..)| case.group == group);
        let text: String = steps
            .map(|(case, dim, steps)| {
                let hashes: Vec<String> = steps.iter().map(|step| hash(step).to_string()).collect();
                format!("{} {dim} {}\n", case.name, hashes.join(" "))
            })
            .collect();
        // FNV-1a hash.
        text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        })
    };
    let found: String =
        groups().iter().map(|group| format!("{group} {:#018x}\n", of_group(group))).collect();
    assert_eq!(found, include_str!("hashes.txt"));
}
