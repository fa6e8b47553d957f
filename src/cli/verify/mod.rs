mod compare;
mod frames;
mod hint;
mod other;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::ensure;
use serde_json::{Value, json};

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::input::{self, Input};
use crate::cli::shared::limit::Limit;
use crate::cli::shared::terminal;
use contactbench_core::contact::Arithmetic;
use contactbench_core::oracle::Errors;
use contactbench_core::periodic::{ImagePair, Periodic};
use contactbench_core::scene::{AnyScene, Lattice};
use contactbench_io as io;
use contactbench_io::boxes::along;
use contactbench_io::pairs::{self, List};
use contactbench_io::{Frame, Place, Without};
use contactbench_report::table::Table;
use contactbench_run::check::verify::{Meaning, Reading, Taken, Verification, WORST};
use contactbench_scenes as scene;
use contactbench_scenes::touching::particle;
use contactbench_terms::number::{mean_radii, number, plural, wrap};

/// Maximum number of pairs printed of each kind of error.
const SHOWN: usize = 5;

#[derive(clap::Args)]
pub struct Verify {
    /// Particle file
    file: PathBuf,
    /// Contact list: i,j as text, .npy, .fstat or dump
    #[arg(long, value_name = "FILE")]
    pairs: PathBuf,
    #[command(flatten)]
    input: Input,
    /// First number, 0 or 1 [default: 0; LAMMPS: ids, 1]
    #[arg(long, value_name = "BASE", conflicts_with = "ids")]
    base: Option<i64>,
    /// The list names particles by id
    #[arg(long)]
    ids: bool,
    /// The list has each pair twice, as i,j and as j,i
    #[arg(long)]
    both_sides: bool,
    /// Largest gap of a listed pair
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, allow_negative_numbers = true)]
    skin: f64,
    /// Leave out contacts, as in type=2 or type=1:2
    #[arg(long, value_name = "FILTER")]
    without: Option<Without>,
    /// Columns of pairs and images: I,J[,SX,SY[,SZ]]
    #[arg(long, value_name = "I,J")]
    pairs_columns: Option<String>,
    /// Frame of the list [default: that of --frame]
    #[arg(long, value_name = "FRAME")]
    pairs_frame: Option<Frame>,
    /// f64, f32, f32-cell, textbook
    #[arg(long, value_name = "NAME", value_parser = arithmetic(), default_value_t)]
    #[arg(hide_possible_values = true)]
    arithmetic: Arithmetic,
    #[command(flatten)]
    limit: Limit,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// A comparison of a list with the truth.
struct Verified<'a> {
    options: &'a Verify,
    list: List,
    naming: Meaning,
    /// The particles, in their box if there is one.
    periodic: Periodic<'static>,
    /// Whether the file declares its box periodic.
    repeats: bool,
    found: Verification,
    /// A better way to read the list, if there is one.
    reading: Option<Reading>,
    /// Another frame of the particles that fits the list better.
    other: Option<other::Other>,
}

/// Compares the lists and prints the result; exit code 1 if they differ.
pub fn verify(options: &Verify) -> anyhow::Result<ExitCode> {
    ensure!(
        matches!(options.base, None | Some(0 | 1)),
        "--base {}: it must be 0 or 1",
        options.base.unwrap_or_default()
    );
    ensure!(
        options.skin >= 0.0 && options.skin.is_finite(),
        "--skin {}: it must be a finite length of at least 0",
        options.skin
    );
    let columns = options.pairs_columns.as_deref().map(|text| text.split(',').map(str::trim));
    let columns: Vec<&str> = columns.into_iter().flatten().collect();
    ensure!(
        options.pairs_frame != Some(Frame::All),
        "--pairs-frame names the list of one frame; for all give --frame all"
    );
    if options.input.frame == Some(Frame::All) {
        return frames::verify(options, &columns);
    }
    let frame = options.pairs_frame.or(options.input.frame).unwrap_or(Frame::Last);
    let list = pairs::read(&options.pairs, &columns, frame)?;
    input::tell(&options.pairs.display().to_string(), &list.notices, Place::Argument);
    let (particles, about) = input::load(
        &options.file,
        &options.input,
        io::Options { ids: true, without: options.without, ..options.input.options() },
    )?;
    compare::same_time(options, &list, &about)?;
    if about.frames > 1 && options.input.frame.is_none() && list.frame.is_some() {
        say!("{}: --frame all compares each of them", options.file.display());
    }
    input::tell(&options.file.display().to_string(), &particles.notices, Place::Argument);
    let (frame, source) = (about.frame, particles.source.clone());
    let mut verified = Verified::new(options, list, particles, about, WORST, true)?;
    verified.look_at_others(frame);
    let (file, touching) = (options.file.display().to_string(), verified.looks());
    let (scene, arithmetic) = (verified.scene(), options.arithmetic);
    input::doubt(&file, scene, source.as_ref(), arithmetic, Some(&touching));
    let mut out = terminal::out();
    if options.json {
        terminal::json(&verified.json())?
    } else {
        verified.print(&mut out)?
    }
    Ok(ExitCode::from(u8::from(!verified.found.is_same())))
}

/// How pairs in a box were compared: value in JSON, and description.
type Compared = [&'static str; 2];

fn words(meaning: Meaning) -> String {
    match meaning {
        Meaning::Base(base) => format!("particles numbered from {base}"),
        Meaning::Ids => "particles named by column id".into(),
    }
}

fn numbers(numbers: &[i32], between: &str) -> String {
    numbers.iter().map(i32::to_string).collect::<Vec<_>>().join(between)
}

impl Verified<'_> {
    fn scene(&self) -> &AnyScene<'static> {
        self.periodic.scene()
    }

    /// Returns the box; `None` in open space.
    fn lattice(&self) -> Option<&Lattice> {
        Some(self.periodic.lattice()).filter(|lattice| lattice.repeats())
    }

    fn looks(&self) -> scene::doubts::Touching {
        let truth = &self.found.truth;
        match self.lattice() {
            None => scene::doubts::Touching::open(self.scene(), &truth.plain),
            Some(_) => {
                let pairs: Vec<ImagePair> = truth.iter().collect();
                scene::doubts::Touching::boxed(&self.periodic, &pairs)
            }
        }
    }

    fn print(&self, out: &mut impl Write) -> anyhow::Result<()> {
        let Verified { options, list, found, .. } = self;
        writeln!(
            out,
            "{}: {}, {}{} ({} arithmetic)",
            options.file.display(),
            plural(self.scene().len(), "particle"),
            counted(found.truth.len(), "touching pair"),
            self.lattice().map_or(String::new(), |lattice| {
                format!(" in a box periodic along {}", along(lattice.periodic()))
            }),
            options.arithmetic.name()
        )?;
        let both = if list.both_sides { ", listed from both sides, counted once" } else { "" };
        let walls = match list.walls {
            0 => String::new(),
            walls => format!(", without {} with walls", counted(walls, "contact")),
        };
        let others: Vec<&str> = list.others.iter().map(|other| &*other.name).collect();
        let others = match others[..] {
            [] => String::new(),
            _ => format!("; ignored: {}", pairs::columns_of(&others)),
        };
        writeln!(
            out,
            "{}: {} ({}; {}{others}){both}{walls}",
            options.pairs.display(),
            plural(list.pairs.len(), "pair"),
            list.format,
            words(self.naming)
        )?;
        if let Some([_, compared]) = self.compared() {
            writeln!(out, "compared: {compared}")?;
        }
        if let Some(left_out) = left_out(found.left_out) {
            writeln!(out, "{left_out}")?;
        }
        if found.within_skin > 0 {
            writeln!(out, "allowed within the skin: {}", counted(found.within_skin, "pair"))?;
        }
        if found.is_same() {
            writeln!(out, "the same: no missed, spurious or repeated pairs")?;
            return Ok(());
        }
        writeln!(out, "\n{}", errors(found).plain(terminal::width()).trim_end())?;
        if found.left_out != [0; 2] && self.reading.is_none() {
            let none = "run without --without for a hint";
            writeln!(out, "\n{}", wrap(none, terminal::width()).join("\n"))?;
        }
        if let Some(hint) = self.hint() {
            writeln!(out, "\n{}", wrap(&format!("hint: {hint}"), terminal::width()).join("\n"))?;
        }
        if self.reading.as_ref().is_some_and(|reading| reading.wrong == 0) {
            return Ok(());
        }
        let Errors { missed, spurious, .. } = found.errors;
        self.print_pairs(out, "missed", "overlap", &found.missed, missed)?;
        self.print_pairs(out, "spurious", "gap", &found.spurious, spurious)?;
        Ok(())
    }

    /// Returns the options with which the list would agree.
    fn hint(&self) -> Option<String> {
        let reading = || self.reading.as_ref().map(|it| self.sentence(it));
        self.other.map(|other| self.other_sentence(other)).or_else(reading)
    }

    /// Returns how pairs in a box were compared; `None` in open space.
    fn compared(&self) -> Option<Compared> {
        self.lattice()?;
        Some(match self.found.taken {
            Taken::Pairs => ["pairs", "pairs; each pair touches through one image"],
            Taken::Images => ["images", "pairs with their images"],
            Taken::Each => ["each", "pairs without images, one for each image that touches"],
            Taken::Once => ["once", "pairs without images, one for all images that touch"],
        })
    }

    /// Prints the worst of `count` pairs of a kind, with their particles.
    fn print_pairs(
        &self,
        out: &mut impl Write,
        kind: &str,
        measure: &str,
        list: &[(ImagePair, f64)],
        count: u64,
    ) -> anyhow::Result<()> {
        if list.is_empty() {
            return Ok(());
        }
        let head =
            format!("{kind}, the worst first (particles numbered from 0; {measure} in mean radii)");
        writeln!(out, "\n{}", wrap(&head, terminal::width()).join("\n"))?;
        for (pair, depth) in list.iter().take(SHOWN) {
            let ImagePair { i, j, image } = pair;
            let across = match image {
                [0, 0, 0] => String::new(),
                _ => format!("  image {}", numbers(&image[..self.scene().dim()], ",")),
            };
            writeln!(out, "  {i},{j}{across}  {measure} {}", number(depth.abs()))?;
            for k in [*i, *j] {
                let (centre, radius) = particle(self.scene(), k);
                let centre = &centre[..self.scene().dim()];
                let centre: Vec<String> = centre.iter().map(|x| format!("{x:?}")).collect();
                let line = format!("{k}: {} r {radius:?}", centre.join(" "));
                for line in wrap(&line, terminal::width().saturating_sub(6)) {
                    writeln!(out, "    {line}")?;
                }
            }
        }
        if let Some(more @ 1..) = count.checked_sub(SHOWN as u64) {
            writeln!(out, "  and {more} more")?;
        }
        Ok(())
    }

    fn json(&self) -> Value {
        let Verified { options, list, found, .. } = self;
        let particle_of = |k: u32| {
            let (centre, radius) = particle(self.scene(), k);
            json!({ "index": k, "centre": centre[..self.scene().dim()], "radius": radius })
        };
        let pairs = |list: &[(ImagePair, f64)]| -> Vec<Value> {
            let finite = |depth: f64| depth.clamp(-f64::MAX, f64::MAX);
            let one = |(pair, depth): &(ImagePair, f64)| {
                let particles = [pair.i, pair.j].map(particle_of);
                let image = &pair.image[..self.scene().dim()];
                json!({ "particles": particles, "image": image, "depth": finite(*depth) })
            };
            list.iter().take(SHOWN).map(one).collect()
        };
        let flags = self.reading.as_ref().map(|it| self.flags(it).join(" "));
        let hint = self.other.map(|other| self.other_flags(other)).or(flags);
        let axes = |lattice: &Lattice| lattice.periodic()[..self.scene().dim()].to_vec();
        let periodic = self.lattice().map(axes);
        json!({
            "file": options.file.display().to_string(),
            "pairs": options.pairs.display().to_string(),
            "format": list.format,
            "numbers": words(self.naming),
            "arithmetic": options.arithmetic.name(),
            "n": self.scene().len(),
            "contacts": found.truth.len(),
            "periodic": periodic,
            "compared": self.compared().map(|[name, _]| name),
            "reported": list.pairs.len(),
            "walls": list.walls,
            "both_sides": list.both_sides,
            "left_out_pairs": found.left_out,
            "same": found.is_same(),
            "errors": found.errors,
            "unknown": found.unknown.len(),
            "missed": pairs(&found.missed),
            "spurious": pairs(&found.spurious),
            "within_skin": found.within_skin,
            "one_sided": found.one_sided.len(),
            "hint": hint.filter(|flags| !flags.is_empty()),
            "reading": self.hint(),
        })
    }
}

fn counted(count: u64, what: &str) -> String {
    plural(usize::try_from(count).unwrap_or(usize::MAX), what)
}

fn left_out([contacts, pairs]: [u64; 2]) -> Option<String> {
    let some = contacts + pairs > 0;
    let both = || {
        format!(
            "left out: {}, {} of the list",
            counted(contacts, "contact"),
            counted(pairs, "pair")
        )
    };
    some.then(both)
}

/// Returns the number of wrong pairs of each kind, and the largest error.
fn errors(found: &Verification) -> Table {
    let errors = &found.errors;
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
        rows.push(("unknown", found.unknown.len() as u64, example));
    }
    if let Some([i, j]) = found.one_sided.first() {
        let example = format!("for example {i},{j}, without {j},{i}");
        rows.push(("from one side", found.one_sided.len() as u64, example));
    }
    Table::of("", &rows)
        .left("", |row| row.0)
        .right("", |row| row.1)
        .left("", |row| row.2.as_str())
        .into()
}
