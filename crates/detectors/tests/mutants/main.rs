//! The hard cases find every mutant of a detector, and accept every right detector.
//!
//! A small reference detector is made wrong in one way at a time ([`ways::Way`]) and tested on
//! every hard case, in both dimensions and every safe arithmetic; [`boxes`] does the same for
//! periodic boxes. If no case finds a mutant, a case is missing. A refusal does not count as wrong.
//! Changes that look wrong but are not ([`ways::right`]) must pass.
//!
//! Cases of more work than [`LIGHT`] run only on mutants that no lighter case finds, and on
//! unchanged detectors.
//!
//! `cargo test --test mutants -- --nocapture` prints the table of mutants.

/// Declares the mistakes and, after a semicolon, changes that are not mistakes. Values of a
/// parameter come after `in`.
macro_rules! ways {
    (
        $($(#[doc = $wrong:literal])* $mutant:ident $(($of:ty) in $each:expr)?,)*;
        $($(#[doc = $none:literal])* $right:ident $(($by:ty) in $all:expr)?,)*
    ) => {
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Way {
            $($(#[doc = $wrong])* $mutant $(($of))?,)*
            $($(#[doc = $none])* $right $(($by))?,)*
        }

        pub fn mutants() -> Vec<Way> {
            let mut all = Vec::new();
            $(all.extend(ways!(@ $mutant $($each)?));)*
            all
        }

        pub fn right() -> Vec<Way> {
            let mut all = Vec::new();
            $(all.extend(ways!(@ $right $($all)?));)*
            all
        }
    };
    (@ $way:ident) => { [Way::$way] };
    (@ $way:ident $each:expr) => { $each.into_iter().map(Way::$way) };
}

mod boxes;
mod reference;
mod ways;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::LazyLock;

use contactbench_detectors::oracle;
use contactbench_ground::contact::{Arithmetic, Test, any_particles};
use contactbench_ground::detect::Detector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::probe::Silent;
use contactbench_ground::scene::{AnyScene, Real};
use contactbench_ground::{with_scene, with_stored};
use contactbench_scenes::hard::{Case, Expect, cases};
use rayon::prelude::*;
use reference::Reference;
use ways::Way;

/// A hard case in 2D or 3D, in one arithmetic.
struct Trial {
    name: &'static str,
    dim: usize,
    arithmetic: Arithmetic,
    steps: Vec<AnyScene<'static>>,
    truth: Digest,
    /// Number of particles in all steps, plus contacts in the last step.
    work: u64,
}

/// Maximum work of a light case.
const LIGHT: u64 = 12_000;

#[derive(Debug, PartialEq)]
enum Verdict {
    Right,
    Refused,
    Wrong,
    Panics,
}

/// All trials, those of least work first, so that the simplest case that finds a mutant is named.
static TRIALS: LazyLock<Vec<Trial>> = LazyLock::new(|| {
    let mut trials = Vec::new();
    let open = |case: &&Case| case.expect != Expect::Invalid && case.group != "boxes";
    for case in cases().filter(open) {
        for &dim in case.dims {
            let steps = case.steps(dim).unwrap();
            for arithmetic in Arithmetic::SAFE {
                let Ok(truth) = oracle::truth(&steps[steps.len() - 1].scene, arithmetic) else {
                    continue;
                };
                // A step that cannot be stored in this arithmetic is left out.
                let steps: Vec<_> =
                    steps.iter().filter_map(|step| step.scene.stored(arithmetic).ok()).collect();
                let work = steps.iter().map(|scene| scene.len() as u64).sum::<u64>()
                    + truth.digest.contacts;
                trials.push(Trial {
                    name: case.name,
                    dim: dim as usize,
                    arithmetic,
                    steps,
                    truth: truth.digest,
                    work,
                });
            }
        }
    }
    trials.sort_by_key(|trial| trial.work);
    trials
});

/// Runs all steps of a trial in order, and judges the result of the last.
fn judge(way: Way, trial: &Trial) -> Verdict {
    let (mut plane, mut space) = (Reference::<2>::new(way), Reference::<3>::new(way));
    let mut last = (Ok(()), Digest::default());
    let ended = catch_unwind(AssertUnwindSafe(|| {
        for scene in &trial.steps {
            last.1 = Digest::default();
            last.0 = detect(&mut plane, &mut space, scene, trial.arithmetic.test(), &mut last.1);
        }
    }));
    match last {
        _ if ended.is_err() => Verdict::Panics,
        (Err(_), _) => Verdict::Refused,
        (Ok(()), digest) if digest == trial.truth => Verdict::Right,
        _ => Verdict::Wrong,
    }
}

fn detect(
    plane: &mut Reference<2>,
    space: &mut Reference<3>,
    scene: &AnyScene<'_>,
    test: Test,
    digest: &mut Digest,
) -> Result<(), Refusal> {
    let radii: Vec<f64> =
        with_scene!(scene, scene => (0..scene.len()).map(|k| scene.radius(k).wide()).collect());
    plane.radii.clone_from(&radii);
    space.radii = radii;
    match scene {
        AnyScene::Plane(scene) => with_stored!(scene, scene => {
            plane.detect(any_particles(scene, test)?, &mut Silent, digest)
        }),
        AnyScene::Space(scene) => with_stored!(scene, scene => {
            space.detect(any_particles(scene, test)?, &mut Silent, digest)
        }),
    }
}

#[test]
fn the_catalogue_finds_out_every_mutant() {
    let mutants = ways::mutants();
    let rows: Vec<(usize, String)> = mutants.par_iter().map(|&way| row(way)).collect();
    println!("| mutant | found out first by | in |\n|---|---|---|");
    rows.iter().for_each(|(_, row)| println!("{row}"));
    let survivors: Vec<&Way> = mutants
        .iter()
        .zip(&rows)
        .filter(|(_, (killers, _))| *killers == 0)
        .map(|(way, _)| way)
        .collect();
    assert!(survivors.is_empty(), "no hard case finds out {survivors:?}: a case is missing");
}

/// Returns the number of cases that find a mutant, counted up to three, and its line of the table.
fn row(way: Way) -> (usize, String) {
    let (mut killers, mut names): (Vec<&Trial>, Vec<&str>) = (Vec::new(), Vec::new());
    for trial in TRIALS.iter().filter(|trial| way.dim().is_none_or(|dim| dim == trial.dim)) {
        if trial.work > LIGHT && !killers.is_empty() || names.len() == 3 {
            break;
        }
        if matches!(judge(way, trial), Verdict::Wrong | Verdict::Panics) {
            killers.push(trial);
            if !names.contains(&trial.name) {
                names.push(trial.name);
            }
        }
    }
    let arithmetics = Arithmetic::SAFE
        .iter()
        .filter(|&&a| killers.iter().any(|trial| trial.arithmetic == a))
        .map(|a| a.name());
    let first = names.join(", ");
    (names.len(), format!("| {way:?} | {first} | {} |", arithmetics.collect::<Vec<_>>().join(", ")))
}

#[test]
fn the_catalogue_finds_no_fault_with_what_is_right() {
    ways::right().par_iter().for_each(|&way| {
        let (mut right, mut tried) = (0, 0);
        for trial in TRIALS.iter().filter(|trial| {
            way == way.algorithm()
                || trial.work <= LIGHT && way.dim().is_none_or(|dim| dim == trial.dim)
        }) {
            tried += 1;
            match judge(way, trial) {
                Verdict::Right => right += 1,
                Verdict::Refused => {}
                verdict => panic!(
                    "{way:?}: {verdict:?} on {} in {}D, {}",
                    trial.name,
                    trial.dim,
                    trial.arithmetic.name()
                ),
            }
        }
        assert!(right > tried * 9 / 10, "{way:?} refuses too much: {right} of {tried}");
    });
}
