//! `contactbench inspect`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::{Value, json};

use crate::cli::shared::input::{self, Input};
use crate::cli::shared::terminal;
use contactbench_io as io;
use contactbench_io::{About, Frame, Notice, Particles, Place, RadiusSource};
use contactbench_scenes::doubts::is_scaled;
use contactbench_scenes::stats::stats;
use contactbench_terms::number::{number, wrap};

mod boxes;
mod contacts;
mod motion;
use contacts::Contacts;

/// Options of `inspect`.
#[derive(clap::Args)]
pub struct Inspect {
    /// The particles: CSV, XYZ, LAMMPS, MercuryDPM, YADE, NumPy, VTK, PLY or GSD, also compressed
    /// with gzip
    file: PathBuf,
    #[command(flatten)]
    input: Input,
    /// Print the same as JSON
    #[arg(long)]
    json: bool,
}

/// A label, its value for people, and its values for programs.
struct Line(&'static str, String, Vec<(&'static str, Value)>);

/// Reads the file, looks for contacts, prints what was found, and warns.
pub fn inspect(options: &Inspect) -> anyhow::Result<ExitCode> {
    // Of all frames the last is described, and then how they follow each other.
    let all = options.input.frame == Some(Frame::All);
    let frame = if all { Frame::Last } else { options.input.options().frame };
    let (particles, about) = input::load(
        &options.file,
        &options.input,
        io::Options { survey: true, frame, ..options.input.options() },
    )?;
    let of_all = [particles.len(), about.frames as usize];
    let (mut lines, mut warnings) = (Vec::new(), Vec::new());
    of_file(options, &particles, &about, &mut lines, &mut warnings);
    boxes::report(&particles, &about, &options.input, &mut lines);
    of_centres(&particles, &mut lines, &mut warnings);
    let scaled = || is_scaled(particles.len(), particles.dim(), |k| particles.centre(k));
    if about.radius == RadiusSource::Missing && scaled() {
        warnings.push(Notice::Scaled.words(Place::Argument));
    }
    if about.radius != RadiusSource::Missing {
        let source = about.radius.clone();
        let given = particles.given(&options.file.display().to_string(), options.input.radius)?;
        let (scene, periodic) = (&given.scene, given.periodic()?);
        let periodic = periodic.as_ref();
        let contacts = periodic.map_or_else(|| Contacts::new(scene), Contacts::in_box);
        contacts::report(scene, &source, periodic, &contacts, &mut lines, &mut warnings);
        if let Some(periodic) = periodic {
            boxes::reach(periodic, &mut lines, &mut warnings);
        }
        if let Some(count) = contacts.exact() {
            let stats = stats(&given, count);
            let of_box = periodic.is_some_and(|periodic| {
                periodic.lattice().periodic()[..scene.dim()].iter().all(|&repeats| repeats)
            });
            let (fraction, of) = (
                stats.packing_fraction,
                match of_box {
                    true => "the box that repeats, overlaps counted twice",
                    false => "the box around the bodies",
                },
            );
            lines.push(Line(
                "packing fraction",
                format!("{fraction:.4} of {of}"),
                vec![
                    ("packing_fraction", json!(fraction)),
                    ("packing_of", json!(if of_box { "box" } else { "bounds" })),
                ],
            ));
            lines.push(Line(
                "fingerprint",
                stats.scene_hash.clone(),
                vec![("scene_hash", json!(stats.scene_hash))],
            ));
        }
    }
    if all {
        motion::report(options, of_all, &mut lines, &mut warnings);
    }
    let mut out = terminal::out();
    if options.json {
        let mut all = serde_json::Map::new();
        for (key, value) in lines.into_iter().flat_map(|Line(_, _, values)| values) {
            all.insert(key.into(), value);
        }
        all.insert("warnings".into(), json!(warnings));
        terminal::json(&Value::Object(all))?;
    } else {
        let width = terminal::width();
        for Line(label, text, _) in &lines {
            hanging(&mut out, &format!("{label:<17} "), text, width)?;
        }
        for warning in &warnings {
            hanging(&mut out, "warning: ", warning, width)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The head, then the text wrapped beside it.
fn hanging(out: &mut impl Write, head: &str, text: &str, width: usize) -> std::io::Result<()> {
    let indent = head.chars().count();
    for (k, line) in wrap(text, width.saturating_sub(indent)).iter().enumerate() {
        writeln!(out, "{:indent$}{line}", if k == 0 { head } else { "" })?;
    }
    Ok(())
}

/// What the reader says.
fn of_file(
    options: &Inspect,
    particles: &Particles,
    about: &About,
    lines: &mut Vec<Line>,
    warnings: &mut Vec<String>,
) {
    let name = options.file.display().to_string();
    lines.push(Line("file", name.clone(), vec![("file", json!(name))]));
    let gzip = if about.gzip { ", compressed with gzip" } else { "" };
    lines.push(Line(
        "format",
        format!("{}{gzip}", about.format),
        vec![("format", json!(about.format)), ("gzip", json!(about.gzip))],
    ));
    let (n, dim) = (particles.len(), particles.dim());
    let what = if dim == 2 { "discs (2D)" } else { "spheres (3D)" };
    lines.push(Line(
        "particles",
        format!("{n} {what}"),
        vec![("n", json!(n)), ("dim", json!(dim))],
    ));
    let which = if about.frames == 1 {
        String::new()
    } else {
        format!("; read: frame {}, counted from 0", about.frame)
    };
    lines.push(Line(
        "frames",
        format!("{}{which}", about.frames),
        vec![("frames", json!(about.frames)), ("frame", json!(about.frame))],
    ));
    if about.frames > 1 && options.input.frame != Some(Frame::All) {
        warnings.push(format!(
            "the file has {} frames, numbered from 0; this is frame {}",
            about.frames, about.frame
        ));
    }
    let (text, kind, column) = match &about.radius {
        RadiusSource::Column(name) => {
            (format!("'{name}' in the file"), "column", Some(name.clone()))
        }
        RadiusSource::Halved(name) => {
            (format!("'{name}' in the file, a diameter, halved"), "diameter", Some(name.clone()))
        }
        RadiusSource::Given => ("the option --radius".into(), "option", None),
        RadiusSource::Missing => (
            "none in the file; contacts need --radius R (half the diameter)".into(),
            "missing",
            None,
        ),
    };
    lines.push(Line(
        "radius from",
        text,
        vec![("radius_source", json!(kind)), ("radius_column", json!(column))],
    ));
    warnings.extend(particles.notices.iter().map(|notice| notice.words(Place::Argument)));
}

/// What the centres say.
fn of_centres(particles: &Particles, lines: &mut Vec<Line>, warnings: &mut Vec<String>) {
    let (n, dim) = (particles.len(), particles.dim());
    if n == 0 {
        warnings.push("there are no particles".into());
        return;
    }
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for k in 0..n {
        for (axis, x) in particles.centre(k).into_iter().enumerate() {
            (low[axis], high[axis]) = (low[axis].min(x), high[axis].max(x));
        }
    }
    let text: Vec<String> = (0..dim)
        .map(|k| format!("{} {} to {}", ["x", "y", "z"][k], number(low[k]), number(high[k])))
        .collect();
    lines.push(Line(
        "centres",
        text.join(", "),
        vec![("low", json!(low[..dim])), ("high", json!(high[..dim]))],
    ));
    // -0 is where 0 is.
    let key = |k: u32| particles.centre(k as usize).map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.sort_unstable_by_key(|&k| key(k));
    let duplicates = order.windows(2).filter(|pair| key(pair[0]) == key(pair[1])).count();
    lines.push(Line(
        "coincident",
        format!("{duplicates} centres stand where another does"),
        vec![("coincident_centres", json!(duplicates))],
    ));
    if duplicates > 0 {
        let first =
            order.windows(2).find(|pair| key(pair[0]) == key(pair[1])).map_or(0, |pair| pair[0]);
        warnings.push(Notice::Coincident(duplicates as u64, first).words(Place::Argument));
    }
}
