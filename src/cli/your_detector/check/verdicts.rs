//! Results of a check as cases for continuous integration and as JSON.

use serde_json::{Value, json};

use super::failing::{regression_file, rounding, worst};
use super::group::Group;
use super::{Check, Checked};
use crate::cli::shared::ci::{Case, Outcome};
use contactbench_run::check::{Failure, Verdict, Wrong};

/// Returns a case for every detector, arithmetic and scene.
pub(super) fn verdicts(reports: &[Checked<'_>], broken: &[Wrong], options: &Check) -> Vec<Case> {
    let case = |wrong: &Wrong| Case {
        outcome: Outcome::Failed,
        why: wrong.to_string(),
        ..Case::passed("protocol", "conversation")
    };
    let mut cases: Vec<Case> = broken.iter().map(case).collect();
    for Checked { group, report, path } in reports {
        let class = path.unwrap_or("generated");
        for arithmetic in &group.arithmetics {
            for name in group.names() {
                let wrong = |any: bool| {
                    let mut failures = report.failures.iter();
                    failures.find(|it| it.detector == name && (any || it.arithmetic == *arithmetic))
                };
                let compared = report.compared.contains_key(&(name.into(), arithmetic.name()));
                let nothing = || "nothing was compared, because every scene was refused".into();
                let (outcome, why) = match (wrong(false), wrong(true)) {
                    (Some(failure), _) => {
                        let Failure { found_on, found, .. } = failure;
                        let file = regression_file(failure, *path, options).display().to_string();
                        let why = format!("on {found_on}: {found}; smallest failing scene: {file}");
                        (Outcome::Failed, why)
                    }
                    (None, Some(other)) => {
                        let arithmetic = other.arithmetic.name();
                        (
                            Outcome::Skipped,
                            format!("not finished, because it is wrong in {arithmetic}"),
                        )
                    }
                    _ if compared => (Outcome::Passed, String::new()),
                    // This detector refused every scene: a failure only if all others did, too.
                    _ if report.verdict() == Verdict::Nothing => (Outcome::Failed, nothing()),
                    _ => (Outcome::Skipped, nothing()),
                };
                let name = format!("{name}, {} arithmetic", arithmetic.name());
                cases.push(Case { outcome, why, ..Case::passed(class, &name) });
            }
        }
    }
    cases
}

pub(super) fn as_json(
    reports: &[Checked<'_>],
    broken: &[Wrong],
    right: bool,
    options: &Check,
) -> Value {
    let failure = |failure: &Failure, path: &Option<&str>| {
        json!({
            "detector": failure.detector,
            "arithmetic": failure.arithmetic.name(),
            "found_on": failure.found_on,
            "found": failure.found.to_string(),
            "smallest": failure.wrong.as_ref().map(|wrong| wrong.to_string()),
            "particles": failure.smallest.scene.len(),
            "worst": worst(failure).map(|(pair, depth)| {
                json!({ "pair": [pair.i, pair.j], "image": pair.image, "depth": depth })
            }),
            "rounding": rounding(failure),
            "file": regression_file(failure, *path, options).display().to_string(),
        })
    };
    let of = |Checked { group, report, path }: &Checked<'_>| {
        let arithmetics: Vec<&str> = group.arithmetics.iter().map(|known| known.name()).collect();
        let failures: Vec<Value> =
            report.failures.iter().map(|found| failure(found, path)).collect();
        json!({
            "scene": path.unwrap_or("generated").to_string(),
            "detectors": group.names().collect::<Vec<_>>(),
            "arithmetics": arithmetics,
            "scenes": report.scenes,
            "detections": report.cases,
            "refused": report.refused,
            "failures": failures,
        })
    };
    let groups = || reports.iter().map(|checked| checked.group);
    let detectors = once(groups().flat_map(Group::names));
    let arithmetics = groups().flat_map(|group| &group.arithmetics);
    let arithmetics = once(arithmetics.map(|known| known.name()));
    let protocol: Vec<String> = broken.iter().map(Wrong::to_string).collect();
    let checks: Vec<Value> = reports.iter().map(of).collect();
    json!({
        "passed": right,
        "detectors": detectors,
        "arithmetics": arithmetics,
        "protocol": protocol,
        "checks": checks,
    })
}

/// Returns each name once, in the order of its first place.
fn once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = std::collections::BTreeSet::new();
    names.filter(|name| seen.insert(*name)).collect()
}
