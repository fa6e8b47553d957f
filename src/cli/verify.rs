//! `contactbench verify`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};
use serde_json::{Value, json};

use crate::check::listed::{Hint, Meaning, Naming, Verification, particle};
use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::input::Input;
use crate::cli::shared::terminal;
use crate::contact::Arithmetic;
use crate::io;
use crate::io::{Frame, pairs};
use crate::present::table::{Cell, Column, Table};
use crate::scene::AnyScene;

/// So many pairs are shown of each kind.
const SHOWN: usize = 5;

/// Options of `verify`.
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
    /// The two columns of the list that name the particles, as in --columns c_pair[1],c_pair[2]
    #[arg(long)]
    columns: Option<String>,
    /// Which frame of the list (default: as --frame)
    #[arg(long)]
    pairs_frame: Option<Frame>,
    /// How contacts are decided; the default is the exact sign for the numbers in the file
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// What there is to print.
struct Verified<'a> {
    options: &'a Verify,
    list: &'a pairs::List,
    naming: Meaning,
    scene: &'a AnyScene<'a>,
    found: Verification,
}

/// Compares, prints the result, and says by the exit code whether the lists are the same.
pub fn verify(options: &Verify) -> anyhow::Result<ExitCode> {
    ensure!(
        matches!(options.base, None | Some(0 | 1)),
        "--base {}: it must be 0 or 1",
        options.base.unwrap_or_default()
    );
    let columns = match options.columns.as_deref().map(|text| text.split_once(',')) {
        None => None,
        Some(Some((i, j))) => Some([i.trim(), j.trim()]),
        Some(None) => bail!("--columns takes two names with a comma between, as in --columns i,j"),
    };
    let frame = options.pairs_frame.or(options.input.frame).unwrap_or_default();
    let list = pairs::read(&options.pairs, columns, frame)?;
    let (particles, _) =
        io::load(&options.file, io::Options { ids: true, ..options.input.options() })?;
    let ids = particles.ids().map(Naming::by_id);
    let (naming, others) = match (options.base, ids) {
        (None, Some(ids)) if options.ids || list.ids => {
            let ids = ids.context("the ids of the particles cannot be used")?;
            (ids, vec![Naming::Base(0), Naming::Base(1)])
        }
        (None, None) if options.ids => bail!(
            "{} has no column 'id' of whole numbers; give --base 0 or --base 1",
            options.file.display()
        ),
        (base, ids) => {
            let base = base.unwrap_or(i64::from(list.ids));
            let ids = ids.and_then(Result::ok);
            (Naming::Base(base), [Naming::Base(1 - base)].into_iter().chain(ids).collect())
        }
    };
    let scene = particles.scene(&options.file.display().to_string(), options.input.radius)?;
    let found = Verification::new(&scene, &list.pairs, &naming, &others, options.arithmetic)?;
    let same = found.is_same();
    let naming = naming.meaning();
    let verified = Verified { options, list: &list, naming, scene: &scene, found };
    let mut out = std::io::stdout().lock();
    if options.json {
        writeln!(out, "{:#}", verified.json())?
    } else {
        verified.print(&mut out)?
    }
    Ok(ExitCode::from(u8::from(!same)))
}

fn words(meaning: Meaning) -> String {
    match meaning {
        Meaning::Base(base) => format!("places in the file, from {base}"),
        Meaning::Ids => "the column 'id' of the particles".into(),
    }
}

fn flag(meaning: Meaning) -> String {
    match meaning {
        Meaning::Base(base) => format!("--base {base}"),
        Meaning::Ids => "--ids".into(),
    }
}

impl Verified<'_> {
    fn print(&self, out: &mut impl Write) -> anyhow::Result<()> {
        let Verified { options, list, found, .. } = self;
        writeln!(
            out,
            "{}: {} particles, {} touching pairs ({} arithmetic)",
            options.file.display(),
            self.scene.len(),
            found.contacts,
            options.arithmetic.name()
        )?;
        let both = if list.both_sides { ", each there from both sides and taken once" } else { "" };
        let walls = match list.walls {
            0 => String::new(),
            walls => format!(", {walls} contacts with walls left out"),
        };
        writeln!(
            out,
            "{}: {} pairs ({}; {}){both}{walls}",
            options.pairs.display(),
            list.pairs.len(),
            list.format,
            words(self.naming)
        )?;
        if found.is_same() {
            writeln!(out, "the same: no pair is missed, spurious or repeated")?;
            return Ok(());
        }
        writeln!(out, "\n{}", errors(found).plain(terminal::width()).trim_end())?;
        self.couples(out, "missed", "overlap", &found.missed)?;
        self.couples(out, "spurious", "gap", &found.spurious)?;
        if let Some(Hint { wrong, meaning }) = found.hint {
            let words = match wrong {
                0 => "the lists are the same".to_string(),
                wrong => format!("only {wrong} pairs differ"),
            };
            writeln!(out, "\nhint: with {}, {words}", flag(meaning))?;
        }
        Ok(())
    }

    /// The worst pairs of a kind, with their particles.
    fn couples(
        &self,
        out: &mut impl Write,
        kind: &str,
        measure: &str,
        list: &[([u32; 2], f64)],
    ) -> anyhow::Result<()> {
        if list.is_empty() {
            return Ok(());
        }
        writeln!(
            out,
            "\n{kind}, the worst first (places in the file from 0; {measure} in mean radii)"
        )?;
        for (pair, depth) in list.iter().take(SHOWN) {
            writeln!(out, "  {},{}  {measure} {:.3e}", pair[0], pair[1], depth.abs())?;
            for &k in pair {
                let (centre, radius) = particle(self.scene, k);
                let centre: Vec<String> = centre.iter().map(|x| format!("{x:?}")).collect();
                writeln!(out, "    {k}: {}  r {radius:?}", centre.join(" "))?;
            }
        }
        if list.len() > SHOWN {
            writeln!(out, "  and {} more", list.len() - SHOWN)?;
        }
        Ok(())
    }

    fn json(&self) -> Value {
        let Verified { options, list, found, .. } = self;
        let body = |k: u32| {
            let (centre, radius) = particle(self.scene, k);
            json!({ "index": k, "centre": centre, "radius": radius })
        };
        let couples = |list: &[([u32; 2], f64)]| -> Vec<Value> {
            let finite = |depth: f64| depth.clamp(-f64::MAX, f64::MAX);
            list.iter()
                .take(SHOWN)
                .map(|(pair, depth)| json!({ "bodies": pair.map(body), "depth": finite(*depth) }))
                .collect()
        };
        json!({
            "file": options.file.display().to_string(),
            "pairs": options.pairs.display().to_string(),
            "format": list.format,
            "numbers": words(self.naming),
            "arithmetic": options.arithmetic.name(),
            "n": self.scene.len(),
            "contacts": found.contacts,
            "reported": list.pairs.len(),
            "walls": list.walls,
            "both_sides": list.both_sides,
            "same": found.is_same(),
            "errors": found.errors,
            "unknown": found.unknown.len(),
            "missed": couples(&found.missed),
            "spurious": couples(&found.spurious),
            "hint": found.hint.map(|hint| flag(hint.meaning)),
        })
    }
}

/// How many pairs are wrong in which way, and by how much at most.
fn errors(found: &Verification) -> Table {
    let errors = &found.errors;
    let worst = |pairs: u64, what: &str, size: f64| match pairs {
        0 => String::new(),
        _ => format!("{what} {size:.3e} mean radii"),
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
    let columns = vec![Column::left(""), Column::right("", ""), Column::left("")];
    let row = |(kind, count, remark): (&str, u64, String)| {
        vec![kind.into(), Cell::count(count), remark.into()]
    };
    Table::new("", columns).with(rows.into_iter().map(row))
}
