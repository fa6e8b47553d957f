//! Prints the result of `verify`: one frame with its worst pairs, several as a table.

use serde_json::json;

use crate::cli::shared::output::Output;
use crate::cli::shared::scene::particle_line;
use crate::cli::verify::Verify;
use contactbench_ground::periodic::ImagePair;
use contactbench_io::boxes::along;
use contactbench_io::pairs;
use contactbench_report::table::Table;
use contactbench_run::tracking::Late;
use contactbench_run::verify::frame::Verified;
use contactbench_run::verify::frames::{All, FrameResult, counted};
use contactbench_run::verify::{Meaning, Reading, Taken};
use contactbench_scenes::touching::particle;
use contactbench_terms::number::{mean_radii, number, plural};

/// Maximum number of frames in the table.
const FRAMES: usize = 12;
/// Maximum number of pairs printed of each kind of error.
const PAIRS: usize = 5;

pub(super) fn print(options: &Verify, all: &All) -> std::io::Result<()> {
    let mut out = Output::new(options.json);
    let one = all.rows.first().zip(all.last.as_ref()).filter(|_| !all.several);
    files(&mut out, options, all, one.map(|(_, one)| one));
    conditions(&mut out, all);
    out.values(json!({ "same": all.is_same(), "errors": all.errors() }));
    match one {
        Some((row, one)) => frame(&mut out, row, one, all),
        None => frames(&mut out, all),
    }
    let hint = all.hint.as_ref().map(|(_, hint)| hint);
    if let Some((which, hint)) = &all.hint {
        let from = if all.several { format!(", from {which}") } else { String::new() };
        out.gap();
        out.text(format!("hint{from}: {}", hint.advice()));
    }
    if let Some((_, one)) = one {
        let flags = hint.map(|hint| hint.mistake.flags()).filter(|flags| !flags.is_empty());
        out.values(json!({ "hint": flags, "reading": hint.map(Reading::advice) }));
        let (errors, found) = (one.found.errors, &one.found);
        let shown = hint.is_none_or(|hint| hint.wrong > 0);
        worst(&mut out, one, ("missed", "overlap"), &found.missed, errors.missed, shown);
        worst(&mut out, one, ("spurious", "gap"), &found.spurious, errors.spurious, shown);
    } else {
        out.values(json!({ "hint": hint.map(Reading::advice) }));
    }
    out.print()
}

/// Prints which files were compared, and what they hold.
fn files(out: &mut Output, options: &Verify, all: &All, one: Option<&Verified>) {
    let sum = |of: fn(&FrameResult) -> u64| all.rows.iter().map(of).sum::<u64>();
    let sizes = || all.rows.iter().map(|row| row.particles);
    let particles = match (sizes().min(), sizes().max()) {
        (Some(least), Some(most)) if least < most => format!("{least} to {most} particles"),
        (_, most) => plural(most.unwrap_or_default(), "particle"),
    };
    let (frames, by) = match (all.several, all.matched.by_step) {
        (false, _) => (String::new(), ""),
        (true, true) => (plural(all.rows.len(), "frame") + ", ", "; frames by time step"),
        (true, false) => (plural(all.rows.len(), "frame") + ", ", "; frames by number"),
    };
    let axes = one.and_then(Verified::lattice).map(|lattice| lattice.periodic());
    let boxed =
        axes.map_or(String::new(), |axes| format!(" in a box periodic along {}", along(axes)));
    let file = options.file.display().to_string();
    let contacts = counted(sum(|row| row.contacts), "touching pair");
    let arithmetic = options.arithmetic.name();
    out.line(
        "",
        format!("{file}: {frames}{particles}, {contacts}{boxed} ({arithmetic} arithmetic)"),
        json!({ "file": file, "arithmetic": arithmetic }),
    );
    if let Some(one) = one {
        out.values(json!({ "periodic": axes.map(|axes| axes[..one.scene().dim()].to_vec()) }));
    }
    let (format, naming, taken) = all.read.unwrap_or(("", Meaning::Base(0), None));
    let naming = match naming {
        Meaning::Base(base) => format!("particles numbered from {base}"),
        Meaning::Ids => "particles named by column id".into(),
    };
    let (pairs, listed) = (options.pairs.display().to_string(), sum(|row| row.listed as u64));
    out.line(
        "",
        format!("{pairs}: {} ({format}; {naming}){by}", counted(listed, "pair")),
        json!({ "pairs": pairs, "format": format, "numbers": naming }),
    );
    let taken = taken.map(|taken| match taken {
        Taken::Pairs => ("pairs", "pairs; each pair touches through one image"),
        Taken::Images => ("images", "pairs with their images"),
        Taken::Each => ("each", "pairs without images, one for each image that touches"),
        Taken::Once => ("once", "pairs without images, one for all images that touch"),
    });
    out.values(json!({ "compared": taken.map(|(name, _)| name) }));
    if let Some((_, words)) = taken {
        out.text(format!("compared: {words}"));
    }
}

/// Prints what was ignored, left out or allowed.
fn conditions(out: &mut Output, all: &All) {
    let ([contacts, pairs], matched) = (all.left_out_pairs, &all.matched);
    let within = all.rows.iter().map(|row| row.within_skin).sum();
    let first: Vec<String> = matched.left_out.iter().take(6).map(u64::to_string).collect();
    let more = if matched.left_out.len() > first.len() { " …" } else { "" };
    let left_out = counted(contacts, "contact");
    let left_out = format!("left out: {left_out}, {} of the list", counted(pairs, "pair"));
    let assumed = String::from("assumed to have no contacts, because the list has no rows: ");
    let without = plural(matched.left_out.len(), "frame");
    for (count, words) in [
        (all.others.len() as u64, format!("ignored: {}", pairs::columns_of(&all.others))),
        (contacts + pairs, left_out),
        (
            all.selves_left_out,
            format!(
                "left out: each particle with itself, {}",
                counted(all.selves_left_out, "pair")
            ),
        ),
        (
            first.len() as u64,
            format!("left out: {without} without a list: {}{more}", first.join(" ")),
        ),
        (matched.without_rows, assumed + &counted(matched.without_rows, "frame")),
        (within, format!("allowed within the skin: {}", counted(within, "pair"))),
    ] {
        if count > 0 {
            out.text(words);
        }
    }
    out.values(json!({
        "left_out_pairs": all.left_out_pairs,
        "selves_left_out": all.selves_left_out,
    }));
}

/// Prints the number of wrong pairs of each kind, and the largest error.
fn frame(out: &mut Output, row: &FrameResult, one: &Verified, all: &All) {
    out.values(json!(row));
    if all.is_same() {
        return out.text("the same: no missed, spurious or repeated pairs");
    }
    let (errors, found) = (&row.errors, &one.found);
    let worst = |pairs: u64, what: &str, size: f64| match pairs {
        0 => String::new(),
        _ => format!("{what} {}", mean_radii(size)),
    };
    let mut rows = vec![
        ("missed", errors.missed, worst(errors.missed, "deepest overlap", errors.deepest_miss)),
        ("spurious", errors.spurious, worst(errors.spurious, "widest gap", errors.widest_false)),
        ("duplicate", errors.duplicate, String::new()),
        ("with itself", errors.self_pairs, String::new()),
    ];
    if let Some([i, j]) = found.unknown.first() {
        let example = format!("for example {i},{j}: no such particle in the file");
        rows.push(("unknown", row.unknown as u64, example));
    }
    if let Some([i, j]) = found.one_sided.first() {
        let example = format!("for example {i},{j}, without {j},{i}");
        rows.push(("from one side", row.one_sided as u64, example));
    }
    let table = Table::of("", &rows)
        .left("", |row| row.0)
        .right("", |row| row.1)
        .left("", |row| row.2.as_str());
    out.table(&table.into());
    if found.left_out != [0; 2] && all.hint.is_none() {
        out.gap();
        out.text("run without --without for a hint");
    }
}

/// Prints the frames that differ, and a summary of all frames.
fn frames(out: &mut Output, all: &All) {
    let Late { frames, latest, deepest, never, .. } = &all.late;
    let ends = all.worst();
    out.values(json!({
        "paired_by": if all.matched.by_step { "step" } else { "frame" },
        "left_out": all.matched.left_out,
        "without_rows": all.matched.without_rows,
        "frames_missed": frames,
        "never_reported": never,
        "latest": latest,
        "deepest_when_reported": deepest,
        "first_wrong_frame": ends.map(|[first, _]| first.frame),
        "worst_frame": ends.map(|[_, worst]| worst.frame),
        "frames": all.rows,
    }));
    let (shown, of) = (all.shown(FRAMES), all.rows.len());
    let wrong = all.rows.iter().filter(|row| !row.same).count();
    if !shown.is_empty() {
        out.table(&table(&shown));
    }
    if shown.len() < of && !shown.is_empty() {
        let shown = shown.len();
        out.text(format!("({shown} of {of} frames, of {wrong} that differ; --json has all)"));
    }
    out.gap();
    let Some([first, worst]) = ends else {
        let count = plural(of, "frame");
        return out.text(format!("the same in {count}: no missed, spurious or repeated pairs"));
    };
    let name = |row: &FrameResult| match row.step {
        Some(step) => format!("step {step}"),
        None => format!("frame {}", row.frame),
    };
    let (first, worst, errors) = (name(first), name(worst), all.errors());
    out.text(format!("{wrong} of {of} frames differ; the first: {first}; the worst: {worst}"));
    if errors.missed > 0 {
        let [most, late] = [errors.deepest_miss, *deepest].map(mean_radii);
        let (contacts, frames) = (counted(errors.missed, "contact"), counted(*frames, "frame"));
        out.text(format!("missed in all frames: {contacts} in {frames}; deepest overlap {most}"));
        let latest = match latest {
            0 => "none".into(),
            _ => format!("at most {} late, with an overlap of {late}", counted(*latest, "frame")),
        };
        out.text(format!("listed later: {latest}; {} never listed", counted(*never, "contact")));
    }
}

/// Adds the worst of `count` pairs of a kind to the values and, if `shown`, to the text.
fn worst(
    out: &mut Output,
    one: &Verified,
    (kind, measure): (&str, &str),
    pairs: &[(ImagePair, f64)],
    count: u64,
    shown: bool,
) {
    let (dim, kept) = (one.scene().dim(), &pairs[..pairs.len().min(PAIRS)]);
    let value = |(pair, depth): &(ImagePair, f64)| {
        let particles = [pair.i, pair.j].map(|k| {
            let (centre, radius) = particle(one.scene(), k);
            json!({ "index": k, "centre": centre[..dim], "radius": radius })
        });
        let depth = depth.clamp(-f64::MAX, f64::MAX);
        json!({ "particles": particles, "image": pair.image[..dim], "depth": depth })
    };
    out.values(json!({ kind: kept.iter().map(value).collect::<Vec<_>>() }));
    if kept.is_empty() || !shown {
        return;
    }
    out.gap();
    out.text(format!(
        "{kind}, the worst first (particles numbered from 0; {measure} in mean radii)"
    ));
    let joined = |numbers: &[i32]| numbers.iter().map(i32::to_string).collect::<Vec<_>>().join(",");
    for (ImagePair { i, j, image }, depth) in kept {
        let across = match image {
            [0, 0, 0] => String::new(),
            _ => format!("  image {}", joined(&image[..dim])),
        };
        out.text(format!("  {i},{j}{across}  {measure} {}", number(depth.abs())));
        for k in [*i, *j] {
            out.text(format!("    {}", particle_line(one.scene(), k)));
        }
    }
    if let Some(more @ 1..) = count.checked_sub(PAIRS as u64) {
        out.text(format!("  and {more} more"));
    }
}

fn table(rows: &[&FrameResult]) -> Table {
    let steps = rows.iter().any(|row| row.step.is_some());
    let others = rows.iter().any(|row| row.wrong > row.errors.missed + row.errors.spurious);
    Table::of("", rows.iter().copied())
        .right(if steps { "step" } else { "frame" }, |row| {
            row.step.map_or(row.frame.to_string(), |step| step.to_string())
        })
        .right("touching", |row| row.contacts)
        .right("listed", |row| row.listed)
        .right("missed", |row| row.errors.missed)
        .right("spurious", |row| row.errors.spurious)
        .when(others, |table| {
            table.right("other", |row| row.wrong - row.errors.missed - row.errors.spurious)
        })
        .unit("deepest missed", "mean radii", |row| {
            (row.errors.missed > 0).then_some(row.errors.deepest_miss)
        })
        .into()
}
