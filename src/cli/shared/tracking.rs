//! Output of `track`: the motion, a table of trackers, and JSON.

use std::time::Duration;

use serde_json::{Value, json};

use contactbench_detectors::spec::DetectorSpec;
use contactbench_report::document::Block;
use contactbench_report::table::{Cell, Table};
use contactbench_run::tracking::{Check, Followed, Moved, SEED, Tracked};
use contactbench_terms::number::{number, percent, plural, radii};

/// Returns the median and the longest time of a frame, in nanoseconds per particle.
fn times(tracked: &Tracked, particles: u64) -> Option<[f64; 2]> {
    let mut times = tracked.times.clone();
    times.sort_unstable();
    let per = |time: &Duration| time.as_nanos() as f64 / particles.max(1) as f64;
    Some([per(times.get(times.len() / 2)?), per(times.last()?)])
}

/// Returns the mean time per particle and frame, in nanoseconds.
fn mean(tracked: &Tracked, particles: u64) -> Option<f64> {
    let all: Duration = tracked.times.iter().sum();
    let steps = tracked.times.len() as f64 * particles.max(1) as f64;
    (steps > 0.0).then(|| all.as_nanos() as f64 / steps)
}

/// Describes a motion from frame to frame; empty for a single frame.
pub fn motion(moved: &Moved, check: Check) -> String {
    let Moved { frames, contacts, born, ended, displacements, .. } = moved;
    if moved.steps() == 0 {
        return String::new();
    }
    let mut said = format!(
        "particles move {} diameters per frame, at most {}",
        number(moved.mean_way()),
        number(displacements.longest)
    );
    if displacements.at_rest > 0 {
        said += &format!("; {} stay in place", percent(moved.share_at_rest()));
    }
    let of = match check {
        Check::None => return said + ".",
        Check::All => String::new(),
        Check::Sample(count) => format!(" of {count} sampled particles"),
    };
    let each = |count: &u64, frames: u64| number(*count as f64 / frames as f64);
    let (steps, in_frame) = (moved.steps(), each(contacts, *frames));
    let (born, ended) = (each(born, steps), each(ended, steps));
    format!("{said}. Contacts{of} in a frame: {in_frame}; new: {born}; ended: {ended}.")
}

/// States what was checked, if that was not everything. A sample of K particles shows an error of a
/// share p of the particles with probability 1 - (1 - p)^K or more, above 95% if p is 3 / K.
fn checked(followed: &Followed) -> Option<String> {
    let Moved { particles, frames, .. } = followed.moved;
    match followed.check {
        Check::All => None,
        Check::Sample(count) => Some(format!(
            "Checked by sample: contacts of {count} random particles (seed {SEED}) of {particles}, \
             in {}. An error that affects {} of the particles shows in such a sample with 95% \
             probability; rarer errors may not show. --truth all checks all contacts.",
            plural(frames as usize, "frame"),
            percent(3.0 / count as f64),
        )),
        Check::None => Some(
            "Not checked: the contacts were not compared with the truth, so they may be wrong. \
             --truth sample or --truth all checks them."
                .into(),
        ),
    }
}

/// Returns the detector of all trackers, if they share one.
fn common(followed: &Followed) -> Option<&DetectorSpec> {
    let mut all = followed.trackers.iter().map(|it| it.spec.detector());
    let first = all.next()?;
    all.all(|other| other == first).then_some(first)
}

pub fn words(name: &str, of: &str, followed: &Followed) -> Vec<Block> {
    let moved = &followed.moved;
    let frames = plural(moved.frames as usize, "frame");
    let mut said = format!("{name}, {} particles, {of}, {frames}", moved.particles);
    match motion(moved, followed.check) {
        none if none.is_empty() => said += ".",
        motion => said += &format!(": {motion}"),
    }
    let mut blocks = vec![Block::paragraph(said)];
    blocks.extend(checked(followed).map(Block::paragraph));
    let sampled = match followed.check {
        Check::Sample(_) => " of sampled particles",
        _ => "",
    };
    if let Some(detector) = common(followed) {
        blocks.push(Block::paragraph(format!(
            "Detector: {detector}. The number after a rule is the skin, in diameters."
        )));
    }
    blocks.extend([
        Block::Table(table(followed)),
        Block::paragraph(format!(
            "ns: mean time per particle and frame; worst: slowest frame. built: frames in which \
             the list was built. listed: pairs in the list for each contact. missed: contacts\
             {sampled} not reported, summed over the frames; since: first such frame; late: most \
             frames until such a contact was reported; depth: its overlap then, in mean radii (r); \
             never: contacts never reported; dangerous: builds whose rule was broken before. Each \
             tracker ran once, so the times are rough.",
        )),
    ]);
    for it in followed.trackers.iter().filter(|it| it.is_wrong()) {
        blocks.push(Block::Warning(
            format!(
                "{} missed {} contacts{sampled} and reported {} pairs that do not touch. It \
                 promises neither, so this is a defect.",
                it.spec, it.late.missed, it.spurious
            )
            .into(),
        ));
    }
    for it in &followed.trackers {
        if let Some(refused) = &it.refused {
            blocks.push(Block::Warning(format!("{} ended at {refused}", it.spec).into()));
        }
    }
    blocks
}

pub fn table(followed: &Followed) -> Table {
    let particles = followed.moved.particles;
    let common = common(followed).is_some();
    let late = |it: &Tracked| it.late.latest > 0;
    let any = |such: &dyn Fn(&Tracked) -> bool| followed.trackers.iter().any(such);
    Table::of("", &followed.trackers)
        .left("tracker", |it| if common { it.spec.setting() } else { it.spec.to_string() })
        .right("ns", |it| mean(it, particles))
        .right("worst", |it| times(it, particles).map(|[_, worst]| worst))
        .right("built", |it| it.builds.built)
        .right("listed", |it| (it.reported > 0).then(|| it.listed as f64 / it.reported as f64))
        .right("missed", |it| {
            let missed = (followed.check != Check::None).then_some(Cell::Count(it.late.missed));
            missed.map(|missed| if it.is_wrong() { missed.wrong() } else { missed })
        })
        .right("since", |it| it.late.first.filter(|_| it.late.missed > 0).map(|it| it.to_string()))
        .right("late", |it| late(it).then(|| it.late.latest.to_string()))
        .right("depth", |it| late(it).then(|| radii(it.late.deepest)))
        .when(any(&|it| it.late.never > 0), |table| table.right("never", |it| it.late.never))
        .when(any(&|it| it.builds.dangerous > 0), |table| {
            table.right("dangerous", |it| it.builds.dangerous)
        })
        .into()
}

pub fn as_json(name: &str, motion: &str, followed: &Followed) -> Value {
    let particles = &followed.moved.particles;
    let known = |count: u64| (followed.check != Check::None).then_some(count);
    let trackers = followed.trackers.iter().map(|it| {
        let late = &it.late;
        json!({
            "tracker": it.spec.to_string(),
            "safe": it.is_safe,
            "frames": it.times.len(),
            "ns_per_particle": mean(it, *particles),
            "median_ns_per_particle": times(it, *particles).map(|[median, _]| median),
            "worst_ns_per_particle": times(it, *particles).map(|[_, worst]| worst),
            "building_ns": it.building.as_nanos() as u64,
            "built": it.builds.built,
            "dangerous": it.builds.dangerous,
            "dangerous_rightly": known(it.builds.rightly),
            "missing_builds": known(it.builds.missing),
            "listed": it.listed,
            "reported": it.reported,
            "spurious": known(it.spurious),
            "missed": known(late.missed),
            "worst_missed": known(late.worst),
            "first_missed_frame": late.first,
            "frames_missed": known(late.frames),
            "never_reported": known(late.never),
            "latest": known(late.latest),
            "deepest": known(1).map(|_| late.deepest),
            "formula_bytes": it.bytes,
            "refused": it.refused,
        })
    });
    let mut all = moved_as_json(&followed.moved, followed.check);
    let sampled = match followed.check {
        Check::All => json!({ "checked": "all" }),
        Check::Sample(count) => json!({ "checked": "sample", "particles": count, "seed": SEED }),
        Check::None => json!({ "checked": "none" }),
    };
    all["truth"] = sampled;
    all["scene"] = json!(name);
    all["motion"] = json!(motion);
    all["trackers"] = trackers.collect();
    all
}

pub fn moved_as_json(moved: &Moved, check: Check) -> Value {
    let known = |count: &u64| (check != Check::None).then_some(*count);
    let Moved { particles, frames, contacts, born, ended, displacements } = moved;
    json!({
        "particles": particles,
        "frames": frames,
        "contacts": known(contacts),
        "born": known(born),
        "ended": known(ended),
        "mean_way": moved.mean_way(),
        "longest_way": displacements.longest,
        "at_rest": displacements.at_rest,
    })
}
