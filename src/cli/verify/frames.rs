//! `verify --frame all`: compares the contact lists of all frames.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::io::Write;
use std::process::ExitCode;

use anyhow::{bail, ensure};
use serde_json::{Value, json};

use crate::cli::shared::input::{self, Told};
use crate::cli::shared::progress::Counted;
use crate::cli::shared::terminal;
use crate::cli::verify::other::Shift;
use crate::cli::verify::{Compared, Verified, Verify, counted, left_out, words};
use contactbench_core::oracle::Errors;
use contactbench_core::periodic::depth;
use contactbench_io as io;
use contactbench_io::{Frame, Place, pairs};
use contactbench_report::table::Table;
use contactbench_run::check::verify::paired::Paired;
use contactbench_run::check::verify::{Naming, Verification};
use contactbench_run::moving::Late;
use contactbench_terms::number::{mean_radii, plural, wrap};

/// Maximum number of frames in the table.
const SHOWN: usize = 12;
/// Bytes of memory for a missed pair while later frames are searched for it.
const FOLLOWED: u64 = 128;

/// The result for one frame.
struct Row {
    frame: u64,
    step: Option<i64>,
    particles: usize,
    contacts: u64,
    listed: usize,
    errors: Errors,
    /// Number of pairs with unknown particles, and of pairs listed from one side only.
    others: [u64; 2],
    within_skin: u64,
    same: bool,
}

impl Row {
    fn wrong(&self) -> u64 {
        self.errors.wrong() + self.others.iter().sum::<u64>()
    }

    fn name(&self) -> String {
        self.step.map_or(format!("frame {}", self.frame), |step| format!("step {step}"))
    }
}

/// The results for all frames.
#[derive(Default)]
struct All {
    rows: Vec<Row>,
    /// Late contacts, named by ids or else by the numbers in file order.
    late: Late<[i64; 2]>,
    by_step: bool,
    left_out: Vec<u64>,
    without_rows: u64,
    /// Format of the list, how it names particles, and how pairs were compared.
    read: Option<(&'static str, String, Option<Compared>)>,
    /// Number of contacts with walls.
    walls: u64,
    /// Numbers of contacts and of listed pairs left out by --without.
    left_out_pairs: [u64; 2],
    both_sides: bool,
    /// Names of ignored columns.
    others: Vec<String>,
    /// The first wrong frame and its hint.
    hint: Option<(String, String)>,
    shift: Shift,
}

pub(super) fn verify(options: &Verify, columns: &[&str]) -> anyhow::Result<ExitCode> {
    ensure!(
        options.pairs_frame.is_none(),
        "--pairs-frame and --frame all cannot be used together; leave one out"
    );
    let all = io::Options { ids: true, without: options.without, ..options.input.options() };
    let all = input::frames(&options.file, all, |frames| {
        pairs::lists(&options.pairs, columns, Frame::All, |lists| {
            let names = [&options.file, &options.pairs].map(|path| path.display().to_string());
            all_of(options, Paired::new(frames, lists, [&names[0], &names[1]]))
        })
    })?;
    let mut out = terminal::out();
    if options.json {
        terminal::json(&all.json(options))?;
    } else {
        all.print(options, &mut out)?;
    }
    Ok(ExitCode::from(u8::from(!all.is_same())))
}

fn all_of(options: &Verify, mut frames: Paired<'_, '_>) -> anyhow::Result<All> {
    let mut all = All::default();
    let (progress, mut told) = (Counted::new(None), Told::default());
    while let Some((particles, about, list)) = frames.next_frame()? {
        progress.frame(about.frame);
        let name = options.file.display().to_string();
        told.of_reader(&name, &particles, &about);
        let (source, place) = (particles.source.clone(), input::place(&name, &about));
        let (frame, step) = (about.frame, about.step);
        let list_frame = list.frame.unwrap_or(frame);
        input::tell(&options.pairs.display().to_string(), &list.notices, Place::Argument);
        // Ids are used only if no two particles share one.
        let ids = match particles.ids.as_deref().map(Naming::by_id) {
            Some(Ok(_)) => particles.ids_copied()?,
            _ => None,
        };
        let memory = options.limit.bytes(particles.len());
        let kept = usize::try_from(memory / FOLLOWED).unwrap_or(usize::MAX).max(1);
        let explain = all.hint.is_none() && all.is_same();
        let which = about.which();
        let verified = Verified::new(options, list, particles, about, kept, explain)
            .map_err(|error| error.context(which.clone()))?;
        let (arithmetic, touching) = (options.arithmetic, verified.looks());
        told.of_contacts(&place, verified.scene(), source.as_ref(), arithmetic, Some(&touching));
        let found = &verified.found;
        if found.errors.missed > kept as u64 {
            bail!(
                "{which}: the list misses {}, more than can be followed in {memory} bytes; look at \
                 that frame alone (--frame {frame} --pairs-frame {list_frame}), or give a larger \
                 --memory-limit",
                counted(found.errors.missed, "contact")
            );
        }
        all.note(&verified, ids.as_deref());
        if !found.is_same() || !all.is_same() {
            all.shift.note(&verified, ids.as_deref());
        }
        if let Some(reading) = &verified.reading {
            all.hint = Some((which, verified.sentence(reading)));
        }
        // The first list with pairs shows how lists are read; empty lists do not.
        if all.rows.iter().all(|row| row.listed == 0) {
            let compared = verified.compared();
            all.read = Some((verified.list.format, words(verified.naming), compared));
        }
        all.walls += verified.list.walls;
        let of_frame = found.left_out;
        all.left_out_pairs.iter_mut().zip(of_frame).for_each(|(all, of)| *all += of);
        all.both_sides |= verified.list.both_sides;
        let others = verified.list.others.iter().map(|other| other.name.clone());
        let others: Vec<String> = others.filter(|name| !all.others.contains(name)).collect();
        all.others.extend(others);
        all.rows.push(Row {
            frame,
            step,
            particles: verified.scene().len(),
            contacts: found.truth.len(),
            listed: verified.list.pairs.len(),
            errors: found.errors,
            others: [found.unknown.len() as u64, found.one_sided.len() as u64],
            within_skin: found.within_skin,
            same: found.is_same(),
        });
    }
    told.end(&options.file.display().to_string());
    all.late.end();
    if let Some(words) = all.shift.sentence() {
        all.hint = Some(("all frames".into(), words));
    }
    all.by_step = frames.is_by_step();
    all.left_out = frames.left_out;
    all.without_rows = frames.without_rows;
    ensure!(!all.rows.is_empty(), "{}: no frame has a list", options.pairs.display());
    Ok(all)
}

impl All {
    fn is_same(&self) -> bool {
        self.rows.iter().all(|row| row.same)
    }

    /// Records the missed contacts of a frame, to see which later frames report them.
    fn note(&mut self, verified: &Verified<'_>, ids: Option<&[i64]>) {
        let Verification { missed, truth, .. } = &verified.found;
        let name = |k: u32| ids.map_or(i64::from(k), |ids| ids[k as usize]);
        let pair = |[a, b]: [i64; 2]| [a.min(b), a.max(b)];
        let mut names: Vec<[i64; 2]> =
            missed.iter().map(|(it, _)| pair([name(it.i), name(it.j)])).collect();
        names.sort_unstable();
        names.dedup();
        let places: OnceCell<HashMap<i64, u32>> = OnceCell::new();
        let place = |name: i64| match ids {
            None => u32::try_from(name).ok().filter(|&k| (k as usize) < verified.scene().len()),
            Some(ids) => {
                let of = || ids.iter().zip(0..).map(|(&id, k)| (id, k)).collect();
                places.get_or_init(of).get(&name).copied()
            }
        };
        let depth_of = |names: &[i64; 2]| {
            let (i, j) = (place(names[0])?, place(names[1])?);
            truth
                .of([i.min(j), i.max(j)])
                .map(|contact| depth(&verified.periodic, contact))
                .reduce(f64::max)
        };
        self.late.note(self.rows.len() as u64, &names, depth_of);
    }

    /// Returns the first wrong frame and the worst frame; `None` if all are right.
    fn worst(&self) -> Option<(&Row, &Row)> {
        let first = self.rows.iter().find(|row| !row.same)?;
        let worst = self.rows.iter().reduce(|a, b| if b.wrong() > a.wrong() { b } else { a })?;
        Some((first, worst))
    }

    /// Returns at most `SHOWN` frames: all, else all wrong ones, else the first wrong one and the
    /// worst.
    fn shown(&self) -> Vec<&Row> {
        let mut rows: Vec<&Row> = self.rows.iter().collect();
        if rows.len() <= SHOWN {
            return rows;
        }
        rows.retain(|row| !row.same);
        let first = rows.first().copied();
        rows.sort_by_key(|row| std::cmp::Reverse(row.wrong()));
        rows.truncate(SHOWN);
        if let Some(first) = first.filter(|first| rows.iter().all(|row| row.frame != first.frame)) {
            rows.truncate(SHOWN - 1);
            rows.push(first);
        }
        rows.sort_by_key(|row| row.frame);
        rows
    }

    fn print(&self, options: &Verify, out: &mut impl Write) -> anyhow::Result<()> {
        let width = terminal::width();
        let shown = self.shown();
        let wrapped = |texts: Vec<String>| -> Vec<String> {
            texts.iter().flat_map(|text| wrap(text, width)).collect()
        };
        let mut lines = wrapped(self.heads(options));
        if !shown.is_empty() {
            lines.push(String::new());
            lines.push(table(&shown).plain(width).trim_end().to_string());
        }
        if shown.len() < self.rows.len() && !shown.is_empty() {
            let wrong = self.rows.iter().filter(|row| !row.same).count();
            let which = match wrong == shown.len() {
                true => "all that differ".to_string(),
                false => format!("the first and the worst of {wrong} that differ"),
            };
            let of = self.rows.len();
            let said = format!("({} of {of} frames: {which}; --json has all)", shown.len());
            lines.extend(wrapped(vec![said]));
        }
        lines.push(String::new());
        lines.extend(wrapped(self.sentences()));
        if let Some((which, hint)) = &self.hint {
            lines.push(String::new());
            lines.extend(wrapped(vec![format!("hint, from {which}: {hint}")]));
        }
        writeln!(out, "{}", lines.join("\n"))?;
        Ok(())
    }

    fn heads(&self, options: &Verify) -> Vec<String> {
        let sum = |of: fn(&Row) -> u64| self.rows.iter().map(of).sum::<u64>();
        let sizes = || self.rows.iter().map(|row| row.particles);
        let particles = match (sizes().min(), sizes().max()) {
            (Some(least), Some(most)) if least < most => format!("{least} to {most} particles"),
            (_, most) => plural(most.unwrap_or_default(), "particle"),
        };
        let (format, meaning, compared) = self.read.clone().unwrap_or_default();
        let by = if self.by_step { "time step" } else { "number" };
        let mut said = vec![
            format!(
                "{}: {}, {particles}, {} ({} arithmetic)",
                options.file.display(),
                plural(self.rows.len(), "frame"),
                counted(sum(|row| row.contacts), "touching pair"),
                options.arithmetic.name()
            ),
            format!(
                "{}: {} ({format}; {meaning}); frames by {by}",
                options.pairs.display(),
                counted(sum(|row| row.listed as u64), "pair")
            ),
        ];
        if !self.others.is_empty() {
            let others: Vec<&str> = self.others.iter().map(String::as_str).collect();
            said.push(format!("ignored: {}", pairs::columns_of(&others)));
        }
        if self.both_sides {
            said.push("pairs are listed from both sides and counted once".into());
        }
        said.extend(left_out(self.left_out_pairs));
        if self.walls > 0 {
            said.push(format!("left out: {} with walls", counted(self.walls, "contact")));
        }
        said.extend(compared.map(|[_, compared]| format!("compared: {compared}")));
        if !self.left_out.is_empty() {
            let frames: Vec<String> = self.left_out.iter().take(6).map(u64::to_string).collect();
            said.push(format!(
                "left out: {} without a list: {}{}",
                plural(self.left_out.len(), "frame"),
                frames.join(" "),
                if self.left_out.len() > frames.len() { " …" } else { "" }
            ));
        }
        if self.without_rows > 0 {
            said.push(format!(
                "taken as without contacts, because the list has no row: {}",
                counted(self.without_rows, "frame")
            ));
        }
        let within = sum(|row| row.within_skin);
        if within > 0 {
            said.push(format!("allowed within the skin: {}", counted(within, "pair")));
        }
        said
    }

    /// Returns the summary of all frames.
    fn sentences(&self) -> Vec<String> {
        let frames = plural(self.rows.len(), "frame");
        let Some((first, worst)) = self.worst() else {
            return vec![format!("the same in {frames}: no missed, spurious or repeated pairs")];
        };
        let Late { frames: with, latest, deepest, never, .. } = self.late;
        let errors = self.errors();
        let wrong = self.rows.iter().filter(|row| !row.same).count();
        let which = match first.frame == worst.frame {
            true => "the first and worst".to_string(),
            false => format!("the first {}; the worst", first.name()),
        };
        let mut said = vec![format!(
            "{wrong} of {frames} differ, {which} {}: {} missed, {} spurious.",
            worst.name(),
            worst.errors.missed,
            worst.errors.spurious
        )];
        if errors.missed > 0 {
            said.push(format!(
                "missed in all frames: {} in {}; deepest overlap {}.",
                counted(errors.missed, "contact"),
                counted(with, "frame"),
                mean_radii(errors.deepest_miss)
            ));
            let late = match latest {
                0 => "None was listed in a later frame".into(),
                _ => format!(
                    "Latest: {} late, with an overlap of {}",
                    counted(latest, "frame"),
                    mean_radii(deepest)
                ),
            };
            said.push(format!("{late}; {} never listed.", counted(never, "contact")));
        }
        said
    }

    fn errors(&self) -> Errors {
        let mut errors = Errors::default();
        self.rows.iter().for_each(|row| errors.add(&row.errors));
        errors
    }

    fn json(&self, options: &Verify) -> Value {
        let (format, numbers, compared) = self.read.clone().unwrap_or_default();
        let rows = self.rows.iter().map(|row| {
            json!({
                "frame": row.frame,
                "step": row.step,
                "n": row.particles,
                "contacts": row.contacts,
                "reported": row.listed,
                "same": row.same,
                "errors": row.errors,
                "unknown": row.others[0],
                "one_sided": row.others[1],
                "within_skin": row.within_skin,
            })
        });
        let late = &self.late;
        json!({
            "file": options.file.display().to_string(),
            "pairs": options.pairs.display().to_string(),
            "format": format,
            "numbers": numbers,
            "compared": compared.map(|[name, _]| name),
            "arithmetic": options.arithmetic.name(),
            "paired_by": if self.by_step { "step" } else { "frame" },
            "walls": self.walls,
            "left_out_pairs": self.left_out_pairs,
            "both_sides": self.both_sides,
            "left_out": self.left_out,
            "without_rows": self.without_rows,
            "same": self.is_same(),
            "errors": self.errors(),
            "frames_missed": late.frames,
            "never_reported": late.never,
            "latest": late.latest,
            "deepest_when_reported": late.deepest,
            "first_wrong_frame": self.worst().map(|(first, _)| first.frame),
            "worst_frame": self.worst().map(|(_, worst)| worst.frame),
            "hint": self.hint.as_ref().map(|(_, hint)| hint),
            "frames": rows.collect::<Vec<_>>(),
        })
    }
}

fn table(rows: &[&Row]) -> Table {
    let steps = rows.iter().any(|row| row.step.is_some());
    let others = rows.iter().any(|row| row.wrong() > row.errors.missed + row.errors.spurious);
    Table::of("", rows.iter().copied())
        .right(if steps { "step" } else { "frame" }, |row| {
            row.step.map_or(row.frame.to_string(), |step| step.to_string())
        })
        .right("touching", |row| row.contacts)
        .right("listed", |row| row.listed)
        .right("missed", |row| row.errors.missed)
        .right("spurious", |row| row.errors.spurious)
        .when(others, |table| {
            table.right("other", |row| row.wrong() - row.errors.missed - row.errors.spurious)
        })
        .unit("deepest missed", "mean radii", |row| {
            (row.errors.missed > 0).then_some(row.errors.deepest_miss)
        })
        .into()
}
