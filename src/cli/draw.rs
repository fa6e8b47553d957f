use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};

use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::cli::shared::{input, terminal};
use contactbench_detectors::near::contacts;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_io as io;
use contactbench_io::FrameChoice;
use contactbench_io::pairs::List;
use contactbench_run::verify::{Allowed, Job, Listed, Naming, Taken, Terms, Verification, verify};
use contactbench_scenes::touching::in_any_box;
use contactbench_terms::number::plural;
use contactbench_views::draw::{self, Look, Pairs, Slice};

#[derive(clap::Args)]
pub struct Draw {
    #[command(flatten)]
    source: Source,
    /// Picture (.svg)
    #[arg(short, long, value_name = "FILE", default_value = "scene.svg")]
    out: PathBuf,
    /// Plane, as in z=0.5 [default: mistake or middle]
    #[arg(long, value_name = "PLANE")]
    slice: Option<Slice>,
    /// Contact list whose mistakes are drawn
    #[arg(long, value_name = "FILE")]
    pairs: Option<PathBuf>,
    /// Draw the whole scene (for --pairs)
    #[arg(long)]
    whole: bool,
    #[command(flatten)]
    limit: Limit,
}

/// Draws the scene, and prints a summary on standard error.
pub fn draw(options: &Draw) -> anyhow::Result<()> {
    let place = options.out.display();
    let ending = options.out.extension().map(|it| it.to_ascii_lowercase());
    ensure!(
        ending.is_some_and(|it| it == "svg"),
        "{place}: the picture is SVG; give a name such as -o scene.svg"
    );
    let (name, given) = options.source.given()?;
    let periodic = in_any_box(&given)?;
    let (n, dim) = (periodic.scene().len(), periodic.scene().dim());
    let limit = options.limit.bytes(n);
    let pairs = match &options.pairs {
        None => {
            let contacts = contacts(&periodic, limit).with_context(|| name.clone())?;
            Pairs { contacts, ..Pairs::default() }
        }
        Some(path) => {
            let list = list(path, options.source.input.frame.unwrap_or_default())?;
            let pairs = compared(&periodic, &list, limit);
            pairs.with_context(|| path.display().to_string())?
        }
    };
    let Draw { slice, whole, .. } = *options;
    let look = Look { title: name.clone(), slice, whole };
    let picture = draw::svg(&periodic, &pairs, &look)?;
    terminal::save(&options.out, picture.as_bytes(), "-o")?;
    let size = crate::cli::bytes(picture.len() as u64);
    let touching = || pairs.contacts.iter().chain(&pairs.missed);
    let mut found = plural(touching().count(), "contact");
    if periodic.lattice().repeats() {
        let across = touching().filter(|pair| pair.image != [0; 3]).count();
        found += &format!(", {across} of them across the box");
    }
    if options.pairs.is_some() {
        let Pairs { missed, spurious, duplicates, .. } = &pairs;
        let [missed, spurious, repeated] = [missed, spurious, duplicates].map(Vec::len);
        found += &format!(", {missed} missed, {spurious} spurious, {repeated} repeated");
    }
    say!("{name}: N = {n}, {dim}D, {found}; {place} ({size})");
    Ok(())
}

/// Reads the contact list of the frame that is drawn.
fn list(path: &Path, frame: FrameChoice) -> anyhow::Result<List> {
    let list = io::pairs::read(path, &[], frame)?;
    let name = path.display().to_string();
    input::tell(&name, &list.notices);
    if let Some(frame) = list.frame {
        let step = list.step.map_or_else(String::new, |step| format!(" (step {step})"));
        say!("{name}: the list of frame {frame}{step} is drawn");
    }
    Ok(list)
}

/// Compares a list with the contacts as `verify` does.
fn compared(space: &Periodic<'_>, list: &List, memory_limit: u64) -> anyhow::Result<Pairs> {
    let scene = space.scene();
    if space.lattice().repeats() {
        list.understood(scene.dim(), space.lattice().periodic())?;
    } else if let Some(k) = list.images.iter().flatten().position(|image| *image != [0; 3]) {
        let [i, j] = list.pairs[k];
        bail!("the pair {i},{j} names an image, and boundaries are open here; give --box LX,LY,LZ");
    }
    let terms = Terms {
        arithmetic: Arithmetic::Exact,
        allowed: Allowed::default(),
        memory_limit,
        kept: usize::MAX,
        without: None,
    };
    let list = Listed { pairs: &list.pairs, images: list.images.as_deref() };
    let job = Job { space, list, naming: &Naming::Base(0), others: &[], terms };
    let Verification { truth, missed, spurious, repeated, selves, unknown, taken, .. } =
        verify(&job)?;
    if let Some([i, j]) = unknown.first() {
        let n = scene.len();
        bail!("the pair {i},{j}: the scene has {n} particles, numbered from 0; verify reads others")
    }
    let pairs = |all: Vec<(ImagePair, f64)>| all.into_iter().map(|(pair, _)| pair);
    let mut contacts = truth.sorted(scene.len(), memory_limit)?;
    let missed: BTreeSet<ImagePair> = pairs(missed).collect();
    // If a pair stands once for all its images, `missed` has one of them.
    let named: BTreeSet<[u32; 2]> = match taken {
        Taken::Once => missed.iter().map(|pair| [pair.i, pair.j]).collect(),
        _ => BTreeSet::new(),
    };
    let is_missed =
        |pair: &mut ImagePair| missed.contains(pair) || named.contains(&[pair.i, pair.j]);
    let missed = contacts.extract_if(.., is_missed).collect();
    let spurious = pairs(spurious).chain(selves).collect();
    Ok(Pairs { contacts, missed, spurious, duplicates: repeated })
}
