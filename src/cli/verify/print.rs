//! Prints the result of `verify`: one frame with its worst pairs, several as a table.

use serde_json::{Value, json};

use crate::cli::shared::terminal;
use crate::cli::verify::Verify;
use contactbench_detectors::oracle::Errors;
use contactbench_ground::periodic::ImagePair;
use contactbench_io::boxes::along;
use contactbench_io::pairs;
use contactbench_report::table::Table;
use contactbench_run::moving::Late;
use contactbench_run::verify::frame::Verified;
use contactbench_run::verify::frames::{All, Row, counted};
use contactbench_run::verify::{Meaning, Taken};
use contactbench_scenes::touching::particle;
use contactbench_terms::number::{mean_radii, number, plural, wrap};

/// Maximum number of frames in the table.
const FRAMES: usize = 12;
/// Maximum number of pairs printed of each kind of error.
const PAIRS: usize = 5;

pub(super) struct Page<'a> {
    pub options: &'a Verify,
    pub all: &'a All,
}

impl Page<'_> {
    /// Returns the only frame; `None` with `--frame all`.
    fn one(&self) -> Option<(&Row, &Verified)> {
        let all = self.all;
        all.rows.first().zip(all.last.as_ref()).filter(|_| !all.several)
    }

    pub fn text(&self) -> String {
        let all = self.all;
        let mut lines = Lines(Vec::new());
        self.heads().iter().for_each(|head| lines.text(head));
        match self.one() {
            _ if all.is_same() && !all.several => {
                lines.text("the same: no missed, spurious or repeated pairs");
            }
            Some((row, one)) => self.errors(row, one, &mut lines),
            None => self.table(&mut lines),
        }
        if let Some((which, hint)) = &all.hint {
            let from = if all.several { format!(", from {which}") } else { String::new() };
            lines.part(&format!("hint{from}: {}", hint.sentence));
        }
        if let Some((_, one)) = self.one()
            && all.hint.as_ref().is_none_or(|(_, hint)| hint.wrong > 0)
        {
            let errors = one.found.errors;
            lines.pairs(one, "missed", "overlap", &one.found.missed, errors.missed);
            lines.pairs(one, "spurious", "gap", &one.found.spurious, errors.spurious);
        }
        lines.0.join("\n")
    }

    /// Returns what was compared, and how.
    fn heads(&self) -> Vec<String> {
        let Page { options, all } = self;
        let sum = |of: fn(&Row) -> u64| all.rows.iter().map(of).sum::<u64>();
        let sizes = || all.rows.iter().map(|row| row.particles);
        let particles = match (sizes().min(), sizes().max()) {
            (Some(least), Some(most)) if least < most => format!("{least} to {most} particles"),
            (_, most) => plural(most.unwrap_or_default(), "particle"),
        };
        let frames = match all.several {
            true => format!("{}, ", plural(all.rows.len(), "frame")),
            false => String::new(),
        };
        let axes = self.one().and_then(|(_, one)| one.lattice());
        let by = match all.several {
            true if all.matched.by_step => "; frames by time step",
            true => "; frames by number",
            false => "",
        };
        let (format, meaning, taken) = self.read();
        let mut said = vec![
            format!(
                "{}: {frames}{particles}, {}{} ({} arithmetic)",
                options.file.display(),
                counted(sum(|row| row.contacts), "touching pair"),
                axes.map_or(String::new(), |lattice| {
                    format!(" in a box periodic along {}", along(lattice.periodic()))
                }),
                options.arithmetic.name()
            ),
            format!(
                "{}: {} ({format}; {meaning}){by}",
                options.pairs.display(),
                counted(sum(|row| row.listed as u64), "pair")
            ),
        ];
        if !all.others.is_empty() {
            let others: Vec<&str> = all.others.iter().map(String::as_str).collect();
            said.push(format!("ignored: {}", pairs::columns_of(&others)));
        }
        if all.both_sides {
            said.push("pairs are listed from both sides and counted once".into());
        }
        if all.left_out_pairs != [0; 2] {
            let [contacts, pairs] = all.left_out_pairs;
            let (contacts, pairs) = (counted(contacts, "contact"), counted(pairs, "pair"));
            said.push(format!("left out: {contacts}, {pairs} of the list"));
        }
        if all.walls > 0 {
            said.push(format!("left out: {} with walls", counted(all.walls, "contact")));
        }
        said.extend(taken.map(|[_, taken]| format!("compared: {taken}")));
        let left_out = &all.matched.left_out;
        if !left_out.is_empty() {
            let frames: Vec<String> = left_out.iter().take(6).map(u64::to_string).collect();
            said.push(format!(
                "left out: {} without a list: {}{}",
                plural(left_out.len(), "frame"),
                frames.join(" "),
                if left_out.len() > frames.len() { " …" } else { "" }
            ));
        }
        if all.matched.without_rows > 0 {
            said.push(format!(
                "assumed to have no contacts, because the list has no rows: {}",
                counted(all.matched.without_rows, "frame")
            ));
        }
        let within = sum(|row| row.within_skin);
        if within > 0 {
            said.push(format!("allowed within the skin: {}", counted(within, "pair")));
        }
        said
    }

    /// Returns the format of the list, how it names particles, and how pairs were compared, as a
    /// value in JSON and as a description.
    fn read(&self) -> (&'static str, String, Option<[&'static str; 2]>) {
        let Some((format, naming, taken)) = self.all.read else { return Default::default() };
        let naming = match naming {
            Meaning::Base(base) => format!("particles numbered from {base}"),
            Meaning::Ids => "particles named by column id".into(),
        };
        let taken = taken.map(|taken| match taken {
            Taken::Pairs => ["pairs", "pairs; each pair touches through one image"],
            Taken::Images => ["images", "pairs with their images"],
            Taken::Each => ["each", "pairs without images, one for each image that touches"],
            Taken::Once => ["once", "pairs without images, one for all images that touch"],
        });
        (format, naming, taken)
    }

    /// Prints the number of wrong pairs of each kind, and the largest error.
    fn errors(&self, row: &Row, one: &Verified, lines: &mut Lines) {
        let (errors, found) = (&row.errors, &one.found);
        let worst = |pairs: u64, what: &str, size: f64| match pairs {
            0 => String::new(),
            _ => format!("{what} {}", mean_radii(size)),
        };
        let overlap = worst(errors.missed, "deepest overlap", errors.deepest_miss);
        let gap = worst(errors.spurious, "widest gap", errors.widest_false);
        let mut rows = vec![
            ("missed", errors.missed, overlap),
            ("spurious", errors.spurious, gap),
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
        lines.table(&table.into());
        if found.left_out != [0; 2] && self.all.hint.is_none() {
            lines.part("run without --without for a hint");
        }
    }

    /// Prints the frames that differ, and a summary of all frames.
    fn table(&self, lines: &mut Lines) {
        let all = self.all;
        let shown = all.shown(FRAMES);
        if !shown.is_empty() {
            lines.table(&table(&shown));
        }
        let wrong = all.rows.iter().filter(|row| !row.is_same()).count();
        if shown.len() < all.rows.len() && !shown.is_empty() {
            let which = match wrong == shown.len() {
                true => "all that differ".to_string(),
                false => format!("the first and the worst of {wrong} that differ"),
            };
            let of = all.rows.len();
            lines.text(&format!("({} of {of} frames: {which}; --json has all)", shown.len()));
        }
        let frames = plural(all.rows.len(), "frame");
        let Some([first, worst]) = all.worst() else {
            lines.part(&format!("the same in {frames}: no missed, spurious or repeated pairs"));
            return;
        };
        let name =
            |row: &Row| row.step.map_or(format!("frame {}", row.frame), |it| format!("step {it}"));
        let which = match first.frame == worst.frame {
            true => "the first and worst".to_string(),
            false => format!("the first {}; the worst", name(first)),
        };
        let (Errors { missed, spurious, .. }, worst) = (worst.errors, name(worst));
        lines.part(&format!(
            "{wrong} of {frames} differ, {which} {worst}: {missed} missed, {spurious} spurious."
        ));
        let (Late { frames, latest, deepest, never, .. }, errors) = (&all.late, all.errors());
        if errors.missed > 0 {
            lines.text(&format!(
                "missed in all frames: {} in {}; deepest overlap {}.",
                counted(errors.missed, "contact"),
                counted(*frames, "frame"),
                mean_radii(errors.deepest_miss)
            ));
            let late = match latest {
                0 => "None was listed in a later frame".into(),
                _ => format!(
                    "Latest: {} late, with an overlap of {}",
                    counted(*latest, "frame"),
                    mean_radii(*deepest)
                ),
            };
            lines.text(&format!("{late}; {} never listed.", counted(*never, "contact")));
        }
    }

    pub fn json(&self) -> Value {
        let Page { options, all } = self;
        let (format, numbers, compared) = self.read();
        let value = json!({
            "file": options.file.display().to_string(),
            "pairs": options.pairs.display().to_string(),
            "format": format,
            "numbers": numbers,
            "compared": compared.map(|[name, _]| name),
            "arithmetic": options.arithmetic.name(),
            "walls": all.walls,
            "left_out_pairs": all.left_out_pairs,
            "both_sides": all.both_sides,
            "same": all.is_same(),
            "errors": all.errors(),
        });
        let hint = all.hint.as_ref().map(|(_, hint)| hint);
        let more = match self.one() {
            Some((row, one)) => {
                let axes = one.lattice().map(|it| it.periodic()[..one.scene().dim()].to_vec());
                extended(
                    row_json(row),
                    json!({
                        "periodic": axes,
                        "missed": pairs_json(one, &one.found.missed),
                        "spurious": pairs_json(one, &one.found.spurious),
                        "hint": hint.map(|hint| &hint.flags).filter(|flags| !flags.is_empty()),
                        "reading": hint.map(|hint| &hint.sentence),
                    }),
                )
            }
            None => json!({
                "paired_by": if all.matched.by_step { "step" } else { "frame" },
                "left_out": all.matched.left_out,
                "without_rows": all.matched.without_rows,
                "frames_missed": all.late.frames,
                "never_reported": all.late.never,
                "latest": all.late.latest,
                "deepest_when_reported": all.late.deepest,
                "first_wrong_frame": all.worst().map(|[first, _]| first.frame),
                "worst_frame": all.worst().map(|[_, worst]| worst.frame),
                "hint": hint.map(|hint| &hint.sentence),
                "frames": all.rows.iter().map(row_json).collect::<Vec<_>>(),
            }),
        };
        extended(value, more)
    }
}

/// Lines of text, wrapped to the width of the terminal.
struct Lines(Vec<String>);

impl Lines {
    fn text(&mut self, text: &str) {
        self.0.extend(wrap(text, terminal::width()));
    }

    /// Adds a text below an empty line.
    fn part(&mut self, text: &str) {
        self.0.push(String::new());
        self.text(text);
    }

    fn table(&mut self, table: &Table) {
        self.0.push(String::new());
        self.0.push(table.plain(terminal::width()).trim_end().to_string());
    }

    /// Adds the worst of `count` pairs of a kind, with their particles.
    fn pairs(
        &mut self,
        one: &Verified,
        kind: &str,
        measure: &str,
        pairs: &[(ImagePair, f64)],
        count: u64,
    ) {
        if pairs.is_empty() {
            return;
        }
        self.part(&format!(
            "{kind}, the worst first (particles numbered from 0; {measure} in mean radii)"
        ));
        let dim = one.scene().dim();
        for (ImagePair { i, j, image }, depth) in pairs.iter().take(PAIRS) {
            let across = match image {
                [0, 0, 0] => String::new(),
                _ => format!(
                    "  image {}",
                    image[..dim].iter().map(i32::to_string).collect::<Vec<_>>().join(",")
                ),
            };
            self.0.push(format!("  {i},{j}{across}  {measure} {}", number(depth.abs())));
            for k in [*i, *j] {
                let (centre, radius) = particle(one.scene(), k);
                let centre: Vec<String> = centre[..dim].iter().map(|x| format!("{x:?}")).collect();
                let line = format!("{k}: {} r {radius:?}", centre.join(" "));
                let lines = wrap(&line, terminal::width().saturating_sub(6));
                self.0.extend(lines.iter().map(|line| format!("    {line}")));
            }
        }
        if let Some(more @ 1..) = count.checked_sub(PAIRS as u64) {
            self.0.push(format!("  and {more} more"));
        }
    }
}

fn extended(mut value: Value, more: Value) -> Value {
    if let (Value::Object(value), Value::Object(more)) = (&mut value, more) {
        value.extend(more);
    }
    value
}

fn row_json(row: &Row) -> Value {
    json!({
        "frame": row.frame,
        "step": row.step,
        "n": row.particles,
        "contacts": row.contacts,
        "reported": row.listed,
        "same": row.is_same(),
        "errors": row.errors,
        "unknown": row.unknown,
        "one_sided": row.one_sided,
        "within_skin": row.within_skin,
    })
}

fn pairs_json(one: &Verified, pairs: &[(ImagePair, f64)]) -> Vec<Value> {
    let dim = one.scene().dim();
    let particle_of = |k: u32| {
        let (centre, radius) = particle(one.scene(), k);
        json!({ "index": k, "centre": centre[..dim], "radius": radius })
    };
    let pair = |(pair, depth): &(ImagePair, f64)| {
        let particles = [pair.i, pair.j].map(particle_of);
        let depth = depth.clamp(-f64::MAX, f64::MAX);
        json!({ "particles": particles, "image": pair.image[..dim], "depth": depth })
    };
    pairs.iter().take(PAIRS).map(pair).collect()
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
