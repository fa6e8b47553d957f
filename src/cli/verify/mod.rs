//! `contactbench verify`.

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

/// So many pairs are shown of each kind.
const SHOWN: usize = 5;

#[derive(clap::Args)]
pub struct Verify {
    /// The particles
    file: PathBuf,
    /// The contact list of the other code: CSV or blanks (i,j), npy, MercuryDPM .fstat, LAMMPS dump
    /// local
    #[arg(long)]
    pairs: PathBuf,
    #[command(flatten)]
    input: Input,
    /// The list numbers the particles in file order, from 0 or from 1 (default: 0; LAMMPS: ids,
    /// else 1)
    #[arg(long, conflicts_with = "ids")]
    base: Option<i64>,
    /// The list names particles by the column 'id' of the particle file
    #[arg(long)]
    ids: bool,
    /// The list has each pair twice, as i,j and as j,i: it is taken once
    #[arg(long)]
    both_sides: bool,
    /// Pairs that are apart by no more than this length may be listed (a neighbour list with a
    /// skin)
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, allow_negative_numbers = true)]
    skin: f64,
    /// Contacts that are left out, by a column of the particles: those of type 2 with type=2, those
    /// between types 1 and 2 with type=1:2, several as in type=2:2,type=3
    #[arg(long, value_name = "COLUMN=VALUE[:VALUE]")]
    without: Option<Without>,
    /// The columns of the list, by name or by number from 1: those of the two particles, as in
    /// c_pair[1],c_pair[2], and those of the image; no others are looked at
    #[arg(long, value_name = "I,J[,SX,SY[,SZ]]")]
    pairs_columns: Option<String>,
    /// Which frame of the list, where it is not that of --frame
    #[arg(long)]
    pairs_frame: Option<Frame>,
    /// How contacts are decided; the default is the exact sign for the numbers in the file
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    #[command(flatten)]
    limit: Limit,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// What there is to print.
struct Verified<'a> {
    options: &'a Verify,
    list: List,
    naming: Meaning,
    /// The particles as given, in their box.
    periodic: Periodic<'static>,
    /// The file says that its box repeats.
    repeats: bool,
    found: Verification,
    /// A better way to read the list, if there is one.
    reading: Option<Reading>,
    /// The frame of the particles that the list is of, if it is another one.
    other: Option<other::Other>,
}

/// Compares, prints the result, and says by the exit code whether the lists are the same.
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

fn words(meaning: Meaning) -> String {
    match meaning {
        Meaning::Base(base) => format!("places in the file, from {base}"),
        Meaning::Ids => "the column 'id' of the particles".into(),
    }
}

fn numbers(numbers: &[i32], between: &str) -> String {
    numbers.iter().map(i32::to_string).collect::<Vec<_>>().join(between)
}

impl Verified<'_> {
    fn scene(&self) -> &AnyScene<'static> {
        self.periodic.scene()
    }

    /// The box; none in open space.
    fn lattice(&self) -> Option<&Lattice> {
        Some(self.periodic.lattice()).filter(|lattice| lattice.repeats())
    }

    /// What the contacts look like.
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
                format!(" in a box that repeats along {}", along(lattice.periodic()))
            }),
            options.arithmetic.name()
        )?;
        let both = if list.both_sides { ", each there from both sides and taken once" } else { "" };
        let walls = match list.walls {
            0 => String::new(),
            walls => format!(", {} with walls left out", counted(walls, "contact")),
        };
        let others: Vec<&str> = list.others.iter().map(|other| &*other.name).collect();
        let others = match others[..] {
            [] => String::new(),
            _ => format!("; not looked at: {}", pairs::columns_of(&others)),
        };
        writeln!(
            out,
            "{}: {} ({}; {}{others}){both}{walls}",
            options.pairs.display(),
            plural(list.pairs.len(), "pair"),
            list.format,
            words(self.naming)
        )?;
        if let Some(compared) = self.compared() {
            writeln!(out, "compared: {compared}")?;
        }
        if let Some(left_out) = left_out(found.left_out) {
            writeln!(out, "{left_out}")?;
        }
        if found.within_skin > 0 {
            writeln!(out, "{} apart within the skin, allowed", counted(found.within_skin, "pair"))?;
        }
        if found.is_same() {
            writeln!(out, "the same: no pair is missed, spurious or repeated")?;
            return Ok(());
        }
        writeln!(out, "\n{}", errors(found).plain(terminal::width()).trim_end())?;
        if found.left_out != [0; 2] && self.reading.is_none() {
            let none = "hints are not given with --without: leave it out to have them";
            writeln!(out, "\n{}", wrap(none, terminal::width()).join("\n"))?;
        }
        if let Some(hint) = self.hint() {
            writeln!(out, "\n{}", wrap(&format!("hint: {hint}"), terminal::width()).join("\n"))?;
        }
        if self.reading.as_ref().is_some_and(|reading| reading.wrong == 0) {
            return Ok(());
        }
        let Errors { missed, spurious, .. } = found.errors;
        self.couples(out, "missed", "overlap", &found.missed, missed)?;
        self.couples(out, "spurious", "gap", &found.spurious, spurious)?;
        Ok(())
    }

    /// How the list would agree.
    fn hint(&self) -> Option<String> {
        let reading = || self.reading.as_ref().map(|it| self.sentence(it));
        self.other.map(|other| self.other_sentence(other)).or_else(reading)
    }

    /// What was compared, where it is not pairs as they are.
    fn compared(&self) -> Option<&'static str> {
        self.lattice()?;
        Some(match self.found.taken {
            Taken::Pairs => "pairs; each touches through one image",
            Taken::Images => "pairs with their images",
            Taken::Each => "pairs without images, each as often as images of it touch",
            Taken::Once => "pairs without images, each once, through how many it touches",
        })
    }

    /// The worst of `count` pairs of a kind, with their particles.
    fn couples(
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
            format!("{kind}, the worst first (places in the file from 0; {measure} in mean radii)");
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
        let body = |k: u32| {
            let (centre, radius) = particle(self.scene(), k);
            json!({ "index": k, "centre": centre[..self.scene().dim()], "radius": radius })
        };
        let couples = |list: &[(ImagePair, f64)]| -> Vec<Value> {
            let finite = |depth: f64| depth.clamp(-f64::MAX, f64::MAX);
            let couple = |(pair, depth): &(ImagePair, f64)| {
                let bodies = [pair.i, pair.j].map(body);
                let image = &pair.image[..self.scene().dim()];
                json!({ "bodies": bodies, "image": image, "depth": finite(*depth) })
            };
            list.iter().take(SHOWN).map(couple).collect()
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
            "compared": self.compared(),
            "reported": list.pairs.len(),
            "walls": list.walls,
            "both_sides": list.both_sides,
            "left_out_pairs": found.left_out,
            "same": found.is_same(),
            "errors": found.errors,
            "unknown": found.unknown.len(),
            "missed": couples(&found.missed),
            "spurious": couples(&found.spurious),
            "within_skin": found.within_skin,
            "one_sided": found.one_sided.len(),
            "hint": hint.filter(|flags| !flags.is_empty()),
            "reading": self.hint(),
        })
    }
}

/// A number of things.
fn counted(count: u64, what: &str) -> String {
    plural(usize::try_from(count).unwrap_or(usize::MAX), what)
}

/// What --without has left out, if anything.
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

/// How many pairs are wrong in which way, and by how much at most.
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
        let example = format!("such as {i},{j}: the file has no such particle");
        rows.push(("unknown", found.unknown.len() as u64, example));
    }
    if let Some([i, j]) = found.one_sided.first() {
        let example = format!("such as {i},{j}: not there as {j},{i}");
        rows.push(("from one side", found.one_sided.len() as u64, example));
    }
    Table::of("", &rows)
        .left("", |row| row.0)
        .right("", |row| row.1)
        .left("", |row| row.2.as_str())
        .into()
}
