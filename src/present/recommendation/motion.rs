//! What `recommend` says of frames: which tracker, and what popular settings would miss.

use serde_json::{Value, json};

use crate::contact::Arithmetic;
use crate::moving::Tracked;
use crate::number::{number, percent, plural, radii, with_interval};
use crate::present::document::Block;
use crate::present::recommendation::{all, measured, ranked, why_out, words};
use crate::present::table::Table;
use crate::present::tracking;
use crate::recommend::motion::{Found, POPULAR};
use crate::recommend::standing::Standing;
use crate::recommend::verdict::Verdict;
use crate::stats::interval::ratio;

pub struct Head<'a> {
    /// The name of the scene or the file.
    pub name: &'a str,
    pub motion: &'a str,
    /// The frames are those of a file, which may be steps apart.
    pub recorded: bool,
    /// The file has further frames.
    pub more: bool,
    pub arithmetic: Arithmetic,
    /// For detectors that can use several.
    pub threads: usize,
}

fn particles(found: &Found) -> usize {
    found.moved.particles as usize
}

/// The recommendation in a sentence.
pub fn sentence(verdict: &Verdict, found: &Found) -> String {
    let (race, n) = (&found.race, particles(found));
    let choice = &race.standings[verdict.choice];
    let mut own = Vec::new();
    if let Some(bytes) = choice.formula_bytes {
        own.push(format!("{} by its formula", number(bytes as f64 / n.max(1) as f64)));
    }
    own.extend(built(choice, found));
    // Who is compared with the choice anyway is not told twice.
    let tied = verdict.tied.iter().map(|(k, _)| *k);
    let mut told = verdict.next.iter().map(|(k, _)| *k).chain(tied).chain([verdict.choice]);
    let is_plain = |standing: &Standing| Some(&standing.who.name) == found.plain.as_ref();
    let plain = race.standings.iter().position(is_plain);
    if let Some(plain) = plain.filter(|plain| told.all(|k| k != *plain))
        && let Some(ratio) = ratio(&race.standings[plain].times, &choice.times)
    {
        let plain = &race.standings[plain];
        let (name, takes) = (&plain.who.name, with_interval(&ratio));
        own.push(format!("{name} takes {takes} times as long"));
    }
    words(verdict, race, n, "per particle and frame", own)
}

/// How often it asked its detector, or made all anew.
fn built(standing: &Standing, found: &Found) -> Option<String> {
    let frames = plural(found.moved.frames as usize, "frame");
    standing.builds.map(|builds| format!("builds in {} of {frames}", builds.built))
}

/// What is said before the recommendation, and after it.
pub fn blocks(head: &Head<'_>, verdict: Option<&Verdict>, found: &Found) -> [Vec<Block>; 2] {
    let Head { name, motion, arithmetic, threads, .. } = head;
    let n = particles(found);
    let bodies = if found.dim == 2 { "discs" } else { "spheres" };
    let (frames, threads) =
        (plural(found.moved.frames as usize, "frame"), plural(*threads, "thread"));
    let first = if head.more { "the first " } else { "" };
    let blocks = plural(found.race.blocks as usize, "block");
    let said = format!(
        "{name}: {n} {bodies}, {motion}, {first}{frames}, {} arithmetic, {threads}, {blocks}: {}",
        arithmetic.name(),
        tracking::motion(&found.moved)
    );
    let above = match arithmetic.is_safe() {
        true => "the trackers above miss none, whatever moves",
        false => "the rules of the trackers above cost none, whatever moves; filters may",
    };
    let popular = format!(
        "What popular settings would miss on these frames, of {} contacts (a contact that is not \
         reported in ten frames counts ten times):",
        found.moved.contacts
    );
    let mut before = vec![Block::paragraph(said), Block::Table(table(verdict, found))];
    before.extend(out(found));
    let mut after = vec![
        Block::paragraph(popular),
        Block::Table(missed(found)),
        Block::paragraph(format!(
            "Skins are in diameters of the largest body. since: the first frame with a missed \
             contact; depth: of those that were reported late, the largest overlap, in mean \
             radii (r). \
             What missed nothing here may miss contacts elsewhere; {above}. contactbench track \
             follows any of these settings frame by frame.",
        )),
    ];
    if head.recorded {
        after.push(Block::paragraph(
            "Rules count frames: where the file has not every step of time, a code that looks in \
             each misses less, and takes more steps to a build.",
        ));
    }
    for it in &found.popular {
        if let Some(refused) = &it.refused {
            after.push(Block::Warning(format!("{} ended at {refused}", it.spec).into()));
        }
    }
    [before, after]
}

/// The trackers that have times, fastest first.
fn table(verdict: Option<&Verdict>, found: &Found) -> Table {
    let kind = ["tracker", "ns / particle, frame"];
    let timed = |standing: &Standing| why_out(standing).is_none();
    measured(kind, &found.race, verdict, particles(found), timed)
        .right("built", |standing| standing.builds.map(|builds| builds.built))
        .into()
}

/// Those without a time: who was too slow in one paragraph, all others by their reasons.
fn out(found: &Found) -> Vec<Block> {
    let ranked = ranked(&found.race, particles(found));
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for standing in ranked {
        let Some(why) = why_out(standing) else { continue };
        let name = standing.who.name.clone();
        let (why, name) = match standing.behind {
            Some(times) => {
                let why = "out early, so many times slower than the fastest".into();
                (why, format!("{name} ({times:.0})"))
            }
            _ => (why, name),
        };
        match groups.iter_mut().find(|(known, _)| *known == why) {
            Some((_, names)) => names.push(name),
            None => groups.push((why, vec![name])),
        }
    }
    let said = |(why, names): (String, Vec<String>)| format!("{why}: {}", names.join(", "));
    groups.into_iter().map(|group| Block::paragraph(said(group))).collect()
}

/// Of the contacts, how many were missed.
fn share(it: &Tracked, found: &Found) -> f64 {
    it.late.missed as f64 / (found.moved.contacts.max(1)) as f64
}

/// One row for each popular setting.
fn missed(found: &Found) -> Table {
    // A setting that has not seen all frames has not missed so few.
    let whole = |it: &Tracked| it.refused.is_none();
    Table::of("", POPULAR.iter().zip(&found.popular))
        .left("rule, skin", |(it, _)| it.setting.replace("rule=", "").replace(",skin=", ", "))
        .left("from", |(it, _)| it.origin)
        .right("missed", |(_, it)| whole(it).then(|| it.late.missed.to_string()))
        .right("share", |(_, it)| whole(it).then(|| percent(share(it, found))))
        .right("since", |(_, it)| {
            it.late.first.filter(|_| it.late.missed > 0).map(|first| first.to_string())
        })
        .right("depth", |(_, it)| (it.late.latest > 0).then(|| radii(it.late.deepest)))
        .into()
}

/// All of it for programs.
pub fn as_json(head: &Head<'_>, verdict: Option<&Verdict>, found: &Found) -> Value {
    let kinds = ["tracker", "trackers"];
    let n = particles(found);
    let mut value = all(verdict, &found.race, n, kinds, |verdict| sentence(verdict, found));
    let popular = POPULAR.iter().zip(&found.popular).map(|(popular, it)| {
        json!({
            "tracker": it.spec.to_string(),
            "origin": popular.origin,
            "built": it.builds.built,
            "missed": it.late.missed,
            "share": it.refused.is_none().then(|| share(it, found)),
            "first_missed_frame": it.late.first,
            "frames_missed": it.late.frames,
            "never_reported": it.late.never,
            "latest": it.late.latest,
            "deepest": it.late.deepest,
            "refused": it.refused,
        })
    });
    value["popular"] = popular.collect();
    value["moved"] = tracking::moved_as_json(&found.moved);
    value["compared_with"] = json!(found.plain);
    value["recorded"] = json!(head.recorded);
    value["more_frames"] = json!(head.more);
    value["scene"] = json!(head.name);
    value["motion"] = json!(head.motion);
    value["dim"] = json!(found.dim);
    value["n"] = json!(n);
    value["arithmetic"] = json!(head.arithmetic.name());
    value["threads"] = json!(head.threads);
    value
}
