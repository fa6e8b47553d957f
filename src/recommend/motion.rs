//! Which tracker for these frames: a race of safe ones, and what popular settings would miss.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};

use crate::contact::Arithmetic;
use crate::detect::table;
use crate::moving::{self, Moved, Tracked, follow};
use crate::recommend::race::{self, Ground, Question};
use crate::recommend::standing::{Contender, Race, Standing};
use crate::run::judge::Judge;
use crate::run::trajectory::Trajectory;
use crate::run::{contender, disk};
use crate::scene::Given;
use crate::track::{self, TrackerSpec};

/// A setting that people use, in diameters of the largest body.
pub struct Popular {
    /// Rule and skin, as a tracker has them.
    pub setting: &'static str,
    /// Whose it is.
    pub origin: &'static str,
}

/// Settings that are not proved to miss nothing. LAMMPS adds its skin to the cutoff, here the
/// diameter, in which its units `lj` measure; `in.chute` and `in.lj` are in its folder `bench`.
/// GROMACS takes its buffer from a tolerance, if none is given; a tenth is ours.
pub const POPULAR: [Popular; 5] = [
    Popular { setting: "rule=lammps-0-1-yes,skin=0.3", origin: "LAMMPS's default" },
    Popular { setting: "rule=lammps-10-1-yes,skin=0.3", origin: "its default in 2021" },
    Popular { setting: "rule=lammps-0-1-yes,skin=0.1", origin: "LAMMPS's bench in.chute" },
    Popular { setting: "rule=lammps-0-20-no,skin=0.3", origin: "LAMMPS's bench in.lj" },
    Popular { setting: "rule=every-10,skin=0.1", origin: "GROMACS's nstlist=10" },
];
/// Who builds their lists, of which what they miss does not depend.
const OVER: &str = table::DEFAULT;
/// Of the time, for the race of detectors on the first frame.
const AT_REST: f64 = 0.2;
/// Skins beside the one that is found while steps go on.
const SKINS: [&str; 4] = ["auto", "0.05", "0.1", "0.2"];

/// What is asked.
pub struct Frames<'a> {
    /// Gives the frame of each number in turn, and none after the last.
    pub next: &'a mut dyn FnMut(u64) -> anyhow::Result<Option<Given>>,
    /// Frames at most.
    pub count: u64,
    /// They are those of a file, of which there may be fewer.
    pub recorded: bool,
    /// How contacts are decided.
    pub arithmetic: Arithmetic,
    /// For detectors that can use several.
    pub threads: usize,
    /// For a detector's arrays, in bytes, and for a tracker's lists.
    pub memory_limit: u64,
    /// For the race.
    pub time: Duration,
    /// This program and its first arguments, to be started as runner.
    pub program: Vec<String>,
}

/// What was found.
pub struct Found {
    /// What the motion is like.
    pub moved: Moved,
    /// Of discs or spheres.
    pub dim: usize,
    /// What popular settings did, in the order of [`POPULAR`].
    pub popular: Vec<Tracked>,
    /// The race of trackers; that of detectors on the first frame, if none of those gave a right
    /// answer.
    pub race: Race,
    /// The one that the others are compared with: its detector in every frame.
    pub plain: Option<String>,
}

/// Follows the frames with the popular settings, and runs the race. `note` hears what is being
/// done.
pub fn run(frames: Frames<'_>, note: &mut dyn FnMut(&str)) -> anyhow::Result<Found> {
    let Frames { next, count, recorded, arithmetic, threads, memory_limit, time, program } = frames;
    let folder = tempfile::tempdir()
        .context("cannot make a temporary folder for frames; set TMPDIR to a writable place")?;
    let popular: Vec<TrackerSpec> = POPULAR
        .iter()
        .map(|popular| track::parse(&format!("verlet({OVER},{})", popular.setting)))
        .collect::<Result<_, _>>()?;
    // Of a file nobody knows how many will come.
    let ahead = if recorded { 1 } else { count };
    let mut files = Files { folder: folder.path(), ahead, trajectory: None, first: None };
    let frame = |k| {
        note(&format!("frame {k}"));
        let frame = next(k)?;
        ensure!(
            arithmetic == Arithmetic::Exact || frame.as_ref().is_none_or(|it| it.lattice.is_none()),
            "in a periodic box lists are kept in exact arithmetic alone, not in {arithmetic}; take \
             --arithmetic exact"
        );
        frame.as_ref().map_or(Ok(()), |frame| files.write(k, frame))?;
        Ok(frame)
    };
    let question = moving::Question { trackers: &popular, arithmetic, frames: count, memory_limit };
    let followed = follow(frame, &question)?;
    let (Some(trajectory), Some(first)) = (files.trajectory, files.first) else {
        bail!("there is no frame")
    };
    let n = followed.moved.particles;
    ensure!(n > 0, "the frames have no particles; there is nothing to recommend");
    ensure!(
        followed.moved.frames > 1,
        "there is one frame, and trackers need several; leave out --motion, or take --frames 100"
    );
    let at_rest = Question {
        given: &first,
        history: &[],
        arithmetic,
        threads,
        memory_limit,
        time: time.mul_f64(AT_REST),
        program: program.clone(),
    };
    let dim = first.scene.dim();
    let race = race::run(&at_rest, note)?;
    let trackers = trackers(&best(&race.standings), threads)?;
    let (moved, popular) = (followed.moved, followed.trackers);
    let Some(plain) = trackers.first().map(|plain| plain.name.clone()) else {
        return Ok(Found { moved, dim, popular, race, plain: None });
    };
    let most = followed.truths.iter().map(|truth| truth.contacts).max().unwrap_or(0);
    let judge = Judge::knowing(trajectory.clone(), memory_limit, arithmetic, followed.truths);
    let ground = Ground {
        judge,
        loads: vec![trajectory],
        folder: folder.path(),
        arithmetic,
        memory_limit,
        room: contender::room(n, most),
        time: time.mul_f64(1.0 - AT_REST),
        program: &program,
        started: Instant::now(),
    };
    let race = ground.race(trackers, moved.contacts, note)?;
    Ok(Found { moved, dim, popular, race, plain: Some(plain) })
}

/// The frames on their way to files, for runners.
struct Files<'a> {
    folder: &'a Path,
    /// Frames to come for which there is to be room.
    ahead: u64,
    trajectory: Option<Trajectory>,
    first: Option<Given>,
}

impl Files<'_> {
    fn write(&mut self, k: u64, given: &Given) -> anyhow::Result<()> {
        if k == 0 {
            self.first = Some(given.clone());
        }
        if k == 0 || self.ahead == 1 {
            let bytes = 8 * (given.scene.dim() as u64 + 1) * given.scene.len() as u64;
            let remedy = "take fewer --frames, or set TMPDIR to another folder";
            disk::ensure(self.folder, bytes.saturating_mul(self.ahead), "the frames", remedy)?;
        }
        let path = self.folder.join(format!("frame-{k}.npy"));
        let next = Trajectory::write_at_rest(&path, given)?;
        let before = self.trajectory.as_ref();
        ensure!(
            before.is_none_or(|all| all.radius == next.radius),
            "frame {k}: the bodies have other radii than in the first frame; a motion is of the \
             same bodies: take the frames before (--frames)"
        );
        Trajectory::append(&mut self.trajectory, next)
    }
}

/// The two detectors that are fastest at rest, or as many as there are.
fn best(standings: &[Standing]) -> Vec<&Standing> {
    let good = |standing: &&Standing| standing.outcome.is_good() && standing.probe_ns.is_some();
    let mut best: Vec<&Standing> = standings.iter().filter(good).collect();
    best.sort_by(|a, b| a.typical().total_cmp(&b.typical()));
    best.truncate(2);
    best
}

/// Trackers that miss nothing, the first of them the plain one.
fn trackers(best: &[&Standing], threads: usize) -> anyhow::Result<Vec<Contender>> {
    let mut names = Vec::new();
    for (k, standing) in best.iter().enumerate() {
        let over = &standing.who.name;
        names.push(format!("every-step({over})"));
        let skins = if k == 0 { &SKINS[..] } else { &SKINS[..1] };
        names.extend(skins.iter().map(|skin| format!("verlet({over},skin={skin})")));
    }
    let contender = |(k, name): (usize, String)| {
        let spec = track::parse(&name)?;
        Ok(Contender { name, stays: k == 0, ..Contender::of(spec.detector().entry, threads) })
    };
    names.into_iter().enumerate().map(contender).collect()
}
