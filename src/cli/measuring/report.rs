//! `contactbench report`: writes the report of a record, also at the end of every run.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};

use crate::cli::shared::ci::{self, Case, Outputs};
use crate::cli::shared::terminal;
use contactbench_record::experiment::Experiment;
use contactbench_record::findings::claim;
use contactbench_record::findings::trust::failures::Culprit;
use contactbench_record::record::faults::Damaged;
use contactbench_record::record::folder;
use contactbench_record::record::merge::Part;
use contactbench_record::record::row::{Outcome, Record};
use contactbench_report::sections::claims::evidence;
use contactbench_report::sections::trust::failures;
use contactbench_report::{document, report};
use contactbench_run::plan;

#[derive(clap::Args)]
pub struct Report {
    /// Result folder
    folder: PathBuf,
    #[command(flatten)]
    ci: Outputs,
}

pub fn report(options: &Report) -> anyhow::Result<ExitCode> {
    finish(&options.folder, &options.ci)
}

/// Reads the record of a result folder, and its experiments.
pub(super) fn read(folder: &Path) -> anyhow::Result<(Record, Vec<Experiment>)> {
    let part = Part::read(folder)?;
    ensure!(
        !part.rows.is_empty(),
        "the record in {} has no rows; run the experiment first",
        folder.display()
    );
    // Sorts the experiments in the order in which they ran.
    let listed = part.provenance.as_ref().and_then(|fields| fields.get("experiments")?.as_array());
    let place = |name: &str| listed.and_then(|all| all.iter().position(|known| known == name));
    let mut copies: Vec<(&String, &String)> = part.experiments.iter().collect();
    copies.sort_by_key(|(name, _)| (place(name).unwrap_or(usize::MAX), *name));
    let parse = |(name, text): (&String, &String)| {
        let path = folder.join(folder::EXPERIMENTS).join(format!("{name}.toml"));
        let experiment =
            plan::parse_copy(text).with_context(|| format!("in {}", path.display()))?;
        let other = || Damaged::new(&path, format!("its experiment is {}", experiment.name));
        ensure!(experiment.name == *name, other());
        Ok(experiment)
    };
    let experiments = copies.into_iter().map(parse).collect::<anyhow::Result<Vec<_>>>()?;
    let unknown = part.rows.iter().find(|row| !part.experiments.contains_key(&row.id.experiment));
    if let Some(row) = unknown {
        bail!(
            "{} lacks the experiment {}, which has rows in the record",
            folder.join(folder::EXPERIMENTS).display(),
            row.id.experiment
        );
    }
    let Part { rows, warnings, bytes, .. } = part;
    Ok((Record { rows, warnings, bytes }, experiments))
}

pub(super) fn finish(folder: &Path, ci: &Outputs) -> anyhow::Result<ExitCode> {
    let (record, experiments) = read(folder)?;
    let quoted = folder.display().to_string();
    let quoted = shlex::try_quote(&quoted)?;
    let again = || {
        let then = "solve the problem below, then run contactbench report";
        format!("the record is whole; {then} {quoted}")
    };
    let report =
        report::write(folder, &experiments, &record.rows, &record.warnings).with_context(again)?;
    let mut out = terminal::out();
    writeln!(out, "{}", document::plain(&report.terminal, terminal::width()))?;
    for warning in &report.warnings {
        writeln!(out, "note:    {warning}")?;
    }
    let (drawn, place) = (report.figures.len(), folder.join("figures"));
    writeln!(out, "figures: {drawn} in {}", place.display())?;
    writeln!(out, "report:  {}", report.path.display())?;
    writeln!(out, "page:    {}", report.page.display())?;
    if record.rows.iter().any(|row| row.role.base_of().is_some()) {
        writeln!(out, "builds:  contactbench compare {quoted}")?;
    }
    // Detectors that were wrong, crashed or not started come before the claims.
    let mut cases: Vec<Case> = report.culprits.iter().map(culprit).collect();
    if cases.is_empty() {
        cases.push(Case::passed("record", "every answer is right"));
    }
    cases.extend(report.verdicts.iter().map(case));
    ci.write("run", &cases)?;
    let failed = !report.culprits.is_empty() || claim::any_failed(&report.verdicts);
    Ok(ExitCode::from(u8::from(failed)))
}

fn culprit(found: &Culprit) -> Case {
    let is = if found.outcome == Outcome::Unavailable { "was started" } else { "is right" };
    Case {
        outcome: ci::Outcome::Failed,
        why: failures::culprit(found),
        ..Case::passed("record", &format!("{} {is}", found.name))
    }
}

/// A claim about times does not fail the run.
fn case(verdict: &claim::Verdict) -> Case {
    let passed = Case::passed(&verdict.experiment, &verdict.claim.name);
    let status = verdict.evidence.status;
    let outcome = match status {
        claim::Status::Holds => return passed,
        claim::Status::Fails if verdict.claim.is_check() => ci::Outcome::Failed,
        claim::Status::Fails => ci::Outcome::Noted,
        claim::Status::NotCovered | claim::Status::NotShown => ci::Outcome::Skipped,
    };
    Case { outcome, why: format!("{}: {}", status.name(), evidence(verdict)), ..passed }
}
