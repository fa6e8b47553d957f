//! `contactbench verify`.

use std::collections::HashMap;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};

use super::input::Input;
use crate::contact::depth::depth;
use crate::contact::{Arithmetic, Real, array};
use crate::harness::record::Errors;
use crate::oracle;
use crate::read::{self, Frame, pairs};
use crate::scene::AnyScene;
use crate::sink::normalise;
use crate::with_scene;

/// So many couples are shown of each kind.
const SHOWN: usize = 5;

/// Options of `verify`.
#[derive(clap::Args)]
pub struct Verify {
    /// The particles
    file: PathBuf,
    /// The contact list of the other code: CSV or blanks (i,j), npy, MercuryDPM .fstat, LAMMPS dump local
    #[arg(long)]
    pairs: PathBuf,
    #[command(flatten)]
    input: Input,
    /// The list numbers the particles in file order, from 0 or from 1 (default: 0; LAMMPS: ids, else 1)
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
    #[arg(long, value_enum, default_value_t)]
    arithmetic: Arithmetic,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// What the numbers of a list mean.
enum Naming {
    Base(i64),
    Ids(HashMap<i64, u32>),
}

impl Naming {
    fn words(&self) -> String {
        match self {
            Naming::Base(base) => format!("places in the file, from {base}"),
            Naming::Ids(_) => "the column 'id' of the particles".into(),
        }
    }

    /// Couples of places in the file, and the couples that name nobody.
    fn apply(&self, list: &[[i64; 2]], n: usize) -> (Vec<[u32; 2]>, Vec<[i64; 2]>) {
        let place = |name: i64| match self {
            Naming::Base(base) => name.checked_sub(*base).and_then(|k| u32::try_from(k).ok()).filter(|&k| (k as usize) < n),
            Naming::Ids(ids) => ids.get(&name).copied(),
        };
        let (mut known, mut unknown) = (Vec::with_capacity(list.len()), Vec::new());
        for &[i, j] in list {
            match (place(i), place(j)) {
                (Some(i), Some(j)) => known.push([i, j]),
                _ => unknown.push([i, j]),
            }
        }
        (known, unknown)
    }
}

/// Compares, prints the result, and says by the exit code whether the lists are the same.
pub fn verify(options: &Verify) -> anyhow::Result<ExitCode> {
    ensure!(matches!(options.base, None | Some(0 | 1)), "--base {}: it must be 0 or 1", options.base.unwrap_or_default());
    let columns = match options.columns.as_deref().map(|text| text.split_once(',')) {
        None => None,
        Some(Some((i, j))) => Some([i.trim(), j.trim()]),
        Some(None) => bail!("--columns takes two names with a comma between, as in --columns i,j"),
    };
    let frame = options.pairs_frame.or(options.input.frame).unwrap_or_default();
    let list = pairs::read(&options.pairs, columns, frame)?;
    let (particles, _) = read::load(&options.file, read::Options { ids: true, ..options.input.options() })?;
    let ids = particles.ids().map(by_id);
    let naming = match (options.base, ids) {
        (Some(base), _) => Naming::Base(base),
        (None, Some(ids)) if options.ids || list.ids => Naming::Ids(ids.context("the ids of the particles cannot be used")?),
        (None, None) if options.ids => bail!("{} has no column 'id' of whole numbers; give --base 0 or --base 1", options.file.display()),
        (None, _) => Naming::Base(i64::from(list.ids)),
    };
    let other_ids = particles.ids().and_then(|ids| by_id(ids).ok()).filter(|_| matches!(naming, Naming::Base(_)));
    let scene = particles.scene(&options.file.display().to_string(), options.input.radius)?;
    let truth = oracle::truth(&scene, options.arithmetic)?;
    let (reported, unknown) = naming.apply(&list.pairs, scene.len());
    let errors = oracle::compare(&reported, &truth.pairs, &scene);
    let same = errors == Errors::default() && unknown.is_empty();
    // What the other meanings of the numbers would give.
    let mut hint = None;
    if !same {
        let others = match naming {
            Naming::Base(base) => vec![(Naming::Base(1 - base), format!("--base {}", 1 - base))],
            Naming::Ids(_) => vec![(Naming::Base(0), "--base 0".into()), (Naming::Base(1), "--base 1".into())],
        };
        let wrong = count(&errors) + unknown.len() as u64;
        let others = others.into_iter().chain(other_ids.map(|ids| (Naming::Ids(ids), "--ids".to_string())));
        hint = others
            .map(|(naming, flag)| {
                let (reported, unknown) = naming.apply(&list.pairs, scene.len());
                (count(&oracle::compare(&reported, &truth.pairs, &scene)) + unknown.len() as u64, flag)
            })
            .filter(|(fewer, _)| *fewer < wrong / 2)
            .min();
    }
    let result = Outcome { options, list: &list, naming, scene: &scene, truth: &truth.pairs, reported, unknown, errors, hint, same };
    let mut out = std::io::stdout().lock();
    if options.json {
        writeln!(out, "{:#}", result.json())?
    } else {
        result.print(&mut out)?
    }
    Ok(ExitCode::from(u8::from(!same)))
}

fn by_id(ids: &[i64]) -> anyhow::Result<HashMap<i64, u32>> {
    let mut places = HashMap::with_capacity(ids.len());
    for (k, &id) in ids.iter().enumerate() {
        if let Some(earlier) = places.insert(id, k as u32) {
            bail!("the id {id} stands twice in the file, at particles {earlier} and {k} (from 0); mend it, or give --base");
        }
    }
    Ok(places)
}

fn count(errors: &Errors) -> u64 {
    errors.missed + errors.spurious + errors.duplicate + errors.self_pairs
}

struct Outcome<'a> {
    options: &'a Verify,
    list: &'a pairs::List,
    naming: Naming,
    scene: &'a AnyScene<'a>,
    truth: &'a [[u32; 2]],
    reported: Vec<[u32; 2]>,
    unknown: Vec<[i64; 2]>,
    errors: Errors,
    hint: Option<(u64, String)>,
    same: bool,
}

impl Outcome<'_> {
    /// The pairs of `these` that are not among `those`, the deepest overlap first, or the widest gap.
    fn only(&self, these: &[[u32; 2]], those: &[[u32; 2]]) -> Vec<([u32; 2], f64)> {
        let (mut these, mut those) = (these.to_vec(), those.to_vec());
        normalise(&mut these);
        normalise(&mut those);
        these.dedup();
        these.retain(|pair| pair[0] != pair[1] && those.binary_search(pair).is_err());
        let mut list: Vec<_> = these.into_iter().map(|pair| (pair, self.depth(pair))).collect();
        list.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
        list
    }

    fn depth(&self, [i, j]: [u32; 2]) -> f64 {
        let (i, j) = (i as usize, j as usize);
        with_scene!(self.scene, scene => {
            let (a, b) = (array(&scene.centres()[i]).map(Real::wide), array(&scene.centres()[j]).map(Real::wide));
            depth(&a, &b, scene.radius(i).wide(), scene.radius(j).wide())
        })
    }

    fn body(&self, k: u32) -> (Vec<f64>, f64) {
        let k = k as usize;
        with_scene!(self.scene, scene => (array(&scene.centres()[k]).iter().map(|x| x.wide()).collect(), scene.radius(k).wide()))
    }

    fn print(&self, out: &mut impl Write) -> anyhow::Result<()> {
        let Outcome { options, list, errors, .. } = self;
        writeln!(
            out,
            "{}: {} particles, {} touching pairs ({} arithmetic)",
            options.file.display(),
            self.scene.len(),
            self.truth.len(),
            options.arithmetic.name()
        )?;
        write!(out, "{}: {} pairs ({}; {})", options.pairs.display(), list.pairs.len(), list.format, self.naming.words())?;
        if list.both_sides {
            write!(out, ", each there from both sides and taken once")?;
        }
        if list.walls > 0 {
            write!(out, ", {} contacts with walls left out", list.walls)?;
        }
        writeln!(out)?;
        if self.same {
            writeln!(out, "the same: no pair is missed, spurious or repeated")?;
            return Ok(());
        }
        writeln!(out)?;
        writeln!(out, "missed      {:>10}{}", errors.missed, self.worst(errors.missed, "deepest overlap", errors.deepest_miss))?;
        writeln!(out, "spurious    {:>10}{}", errors.spurious, self.worst(errors.spurious, "widest gap", errors.widest_false))?;
        writeln!(out, "duplicate   {:>10}", errors.duplicate)?;
        writeln!(out, "with itself {:>10}", errors.self_pairs)?;
        if let Some([i, j]) = self.unknown.first() {
            writeln!(out, "unknown     {:>10}   such as {i},{j}: the file has no such particle", self.unknown.len())?;
        }
        for (what, list, measure) in
            [("missed", self.only(self.truth, &self.reported), "overlap"), ("spurious", self.only(&self.reported, self.truth), "gap")]
        {
            if !list.is_empty() {
                writeln!(out, "\n{what}, the worst first (places in the file from 0; {measure} in mean radii)")?;
            }
            for (pair, depth) in list.iter().take(SHOWN) {
                writeln!(out, "  {},{}  {measure} {:.3e}", pair[0], pair[1], depth.abs())?;
                for k in pair {
                    let (centre, radius) = self.body(*k);
                    let centre: Vec<String> = centre.iter().map(|x| format!("{x:?}")).collect();
                    writeln!(out, "    {k}: {}  r {radius:?}", centre.join(" "))?;
                }
            }
            if list.len() > SHOWN {
                writeln!(out, "  and {} more", list.len() - SHOWN)?;
            }
        }
        if let Some((wrong, flag)) = &self.hint {
            writeln!(
                out,
                "\nhint: with {flag}, {}",
                if *wrong == 0 { "the lists are the same".to_string() } else { format!("only {wrong} pairs differ") }
            )?;
        }
        Ok(())
    }

    fn worst(&self, pairs: u64, what: &str, size: f64) -> String {
        if pairs == 0 { String::new() } else { format!("   {what} {size:.3e} mean radii") }
    }

    fn json(&self) -> serde_json::Value {
        let couples = |list: Vec<([u32; 2], f64)>| -> Vec<serde_json::Value> {
            let body = |k: u32| serde_json::json!({ "index": k, "centre": self.body(k).0, "radius": self.body(k).1 });
            let finite = |depth: f64| depth.clamp(-f64::MAX, f64::MAX);
            list.iter()
                .take(SHOWN)
                .map(|([i, j], depth)| serde_json::json!({ "bodies": [body(*i), body(*j)], "depth": finite(*depth) }))
                .collect()
        };
        serde_json::json!({
            "file": self.options.file.display().to_string(),
            "pairs": self.options.pairs.display().to_string(),
            "format": self.list.format,
            "numbers": self.naming.words(),
            "arithmetic": self.options.arithmetic.name(),
            "n": self.scene.len(),
            "contacts": self.truth.len(),
            "reported": self.list.pairs.len(),
            "walls": self.list.walls,
            "both_sides": self.list.both_sides,
            "same": self.same,
            "errors": self.errors,
            "unknown": self.unknown.len(),
            "missed": couples(self.only(self.truth, &self.reported)),
            "spurious": couples(self.only(&self.reported, self.truth)),
            "hint": self.hint.as_ref().map(|(_, flag)| flag),
        })
    }
}
