//! The measurement of a scene, for experiments and recommendations: starts runners on the scene,
//! judges their answers, and runs blocks in random order.

use std::path::Path;

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::run::judge::{Judge, Judged, Said, Tracked};
use crate::run::runner::client::{Client, Failure, Start};
use crate::run::runner::protocol::{Hello, Reply, Request, Sample};
use crate::run::runner::trajectory::Trajectory;
use crate::run::stage::passes::astray;
use crate::tracking::Moved;
use contactbench_io::Given;
use contactbench_record::record::row::Outcome;
use contactbench_scenes::motion::Frames;

/// A scene in files that runners load, with the judge of the answers.
pub(crate) struct Bench<'a> {
    pub judge: Judge<'a>,
    /// The scenes that each process loads, one after the other.
    pub loads: Vec<Trajectory>,
    folder: &'a Path,
    pub is_moving: bool,
}

impl<'a> Bench<'a> {
    /// Writes `given`, a scene that does not move, and the scenes of `history`, which each process
    /// loads first, into `folder`.
    pub fn at_rest(
        given: &'a Given,
        history: &[Given],
        folder: &'a Path,
        memory_limit: u64,
    ) -> anyhow::Result<Bench<'a>> {
        let judge = Judge::new(given, memory_limit)?;
        let written =
            |(k, scene)| Trajectory::write_at_rest(&folder.join(format!("scene-{k}.npy")), scene);
        let loads = history.iter().chain([given]).enumerate().map(written);
        let loads = loads.collect::<anyhow::Result<_>>()?;
        Ok(Bench { judge, loads, folder, is_moving: false })
    }

    /// Writes the first `count` frames of a motion into `folder`.
    pub fn moving(
        frames: &mut Frames,
        count: u64,
        folder: &'a Path,
        memory_limit: u64,
    ) -> anyhow::Result<(Bench<'a>, Option<Moved>)> {
        let moving = Trajectory::write_moving(folder, frames, count)?;
        let (judge, moved) = Judge::moving(moving.clone(), memory_limit)?;
        Ok((Bench { judge, loads: vec![moving], folder, is_moving: true }, moved))
    }

    /// Starts a runner in a new process, on `processor` if given, and loads the scene. Fails if the
    /// runner's hello is not `hello`.
    pub fn fresh(
        &self,
        start: &Start,
        hello: Option<&Hello>,
        processor: Option<usize>,
    ) -> Result<Client, Failure> {
        let start = &Start { processor, ..start.clone() };
        // A failed start is repeated once, because the system may lack a resource for a moment.
        let mut client = Client::start(start).or_else(|_| Client::start(start))?;
        if hello.is_some_and(|hello| client.hello != *hello) {
            let reason = "the runner's hello differs from that of its first start".into();
            return Err(Failure { outcome: Outcome::Crashed, reason });
        }
        self.load(&mut client)?;
        Ok(client)
    }

    /// Loads several scenes one after the other, for hard cases with a history. Answers to scenes
    /// before the last are not judged; these scenes only leave traces in buffers.
    pub fn load(&self, client: &mut Client) -> Result<(), Failure> {
        let Some((last, history)) = self.loads.split_last() else { return Ok(()) };
        for trajectory in history {
            let loaded = load(client, trajectory);
            match loaded.and_then(|()| client.ask(&Request::Sample { min_ns: 1 })) {
                Err(failure) if failure.outcome != Outcome::Refused => return Err(failure),
                _ => {}
            }
        }
        load(client, last)
    }

    /// Judges an answer of a runner; pairs are read only if they are needed.
    pub fn judge(
        &mut self,
        subject: &str,
        said: Said<'_>,
        client: &mut Client,
    ) -> anyhow::Result<(Judged, Tracked)> {
        let (path, moving) = (self.folder.join("pairs.npy"), self.is_moving);
        let box_dim = self.loads.last().and_then(Trajectory::box_dim);
        let fetch = |frame: u64| client.pairs(&path, box_dim, moving.then_some(frame));
        self.judge.judge(subject, said, fetch)
    }

    /// Removes the files of a motion, which may be large.
    pub fn remove(&self) {
        if self.is_moving {
            // Files that cannot be removed now are removed with the temporary folder.
            let files = self.loads.iter().flat_map(|trajectory| &trajectory.frames);
            files.for_each(|path| drop(std::fs::remove_file(path)));
        }
    }
}

fn load(client: &mut Client, trajectory: &Trajectory) -> Result<(), Failure> {
    let request = Request::Load(trajectory.clone());
    match client.ask(&request)? {
        Reply::Loaded => Ok(()),
        other => Err(astray(&request, &other)),
    }
}

/// Takes a timed sample of at least this length, in nanoseconds.
pub(crate) fn sample(client: &mut Client, min_ns: u64) -> Result<Sample, Failure> {
    let request = Request::Sample { min_ns };
    match client.ask(&request)? {
        Reply::Sample(sample) => Ok(*sample),
        other => Err(astray(&request, &other)),
    }
}

/// Runs at most `most` blocks and returns how many. In each, `take` measures every subject once, in
/// a random order that `seed` and the number of the block decide; it returns the subject unless it
/// failed. Before each block, `goes_on` may change the subjects or end the race.
pub(crate) fn race<E>(
    mut subjects: Vec<E>,
    most: u32,
    seed: u64,
    mut goes_on: impl FnMut(u32, &mut Vec<E>) -> bool,
    mut take: impl FnMut(u32, E) -> anyhow::Result<Option<E>>,
) -> anyhow::Result<(u32, Vec<E>)> {
    for block in 1..=most {
        if !goes_on(block, &mut subjects) {
            return Ok((block - 1, subjects));
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_add(u64::from(block)));
        subjects.shuffle(&mut random);
        let taken = subjects.into_iter().map(|subject| take(block, subject));
        let still = taken.filter_map(Result::transpose);
        subjects = still.collect::<anyhow::Result<_>>()?;
    }
    Ok((most, subjects))
}
