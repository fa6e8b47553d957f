//! A run: what can be known to go wrong is said first, then scene after scene is measured.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Context;
use tempfile::TempDir;

use crate::run::origins::Origins;
use crate::run::plan::{self, Job, describe};
use crate::run::stage::{Log, Progress, Stage};
use contactbench_record::experiment::Experiment;
use contactbench_record::record::done::{Index, TooSlow};
use contactbench_record::record::row::Writer;
use contactbench_scenes::spec::Spec;

/// A job that can begin.
pub struct Ready<'a> {
    job: &'a Job<'a>,
    scenes: Vec<(&'a Experiment, Spec)>,
    temporary: TempDir,
}

/// Plans a job, and says what can be known to go wrong before anything is measured.
pub fn prepare<'a>(job: &'a Job<'a>) -> anyhow::Result<Ready<'a>> {
    let scenes = plan::plan(job)?;
    let temporary = tempfile::tempdir()
        .context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
    Ok(Ready { job, scenes, temporary })
}

impl Ready<'_> {
    /// How many scenes there are: a shard may have none.
    pub fn scenes(&self) -> usize {
        self.scenes.len()
    }

    /// An error unless files can be written into the result folder, and there is room for what will
    /// be.
    pub fn room(&self, folder: &Path) -> anyhow::Result<()> {
        plan::room(self.job, &self.scenes, folder, self.temporary.path())
    }

    /// Runs the experiments into a record.
    pub fn run(
        &self,
        record: &mut Writer,
        origins: &mut Origins,
        progress: &mut dyn Progress,
    ) -> anyhow::Result<()> {
        let (job, folder, total) = (self.job, self.temporary.path(), self.scenes.len());
        let index = Index::new(job.done);
        let (too_slow, noted) = (TooSlow::new(job.done), BTreeSet::new());
        let mut log = Log { record, origins, progress, too_slow, noted, span: None };
        for (k, (experiment, spec)) in self.scenes.iter().enumerate() {
            log.progress.scene(k, total, &describe(experiment, spec));
            let index = &index;
            let mut stage = Stage { job, experiment, spec, index, folder, log: &mut log };
            stage.run().with_context(|| {
                format!("in experiment {}, scene {}", experiment.name, describe(experiment, spec))
            })?;
        }
        log.progress.scene(total, total, "done");
        Ok(())
    }
}
