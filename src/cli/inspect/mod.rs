use std::path::PathBuf;

use serde_json::json;

use crate::cli::shared::input::{self, Input};
use crate::cli::shared::output::Output;
use contactbench_ground::limits::memory::limit_for;
use contactbench_io as io;
use contactbench_io::{About, FrameChoice, Particles, RadiusSource};
use contactbench_scenes::stats::stats;
use contactbench_scenes::touching::in_any_box;
use contactbench_terms::number::number;

mod boxes;
mod contacts;
mod motion;
use contacts::Contacts;

#[derive(clap::Args)]
pub struct Inspect {
    /// Particles: CSV, XYZ, LAMMPS, YADE, NumPy, VTK or GSD
    file: PathBuf,
    #[command(flatten)]
    input: Input,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Reads the file, finds the contacts, prints both, and warns.
pub fn inspect(options: &Inspect) -> anyhow::Result<()> {
    // If --frame all is given, `inspect` describes the last frame, and then the motion.
    let all = options.input.frame == Some(FrameChoice::All);
    let frame = if all { FrameChoice::Last } else { options.input.options().frame };
    let (particles, about) = input::load(
        &options.file,
        &options.input,
        io::Options { survey: true, frame, ..options.input.options() },
    )?;
    let of_all = [particles.len(), about.frames as usize];
    let mut out = Output::new(options.json);
    out.values(json!({ "warnings": [] }));
    of_file(options, &particles, &about, &mut out);
    boxes::report(&particles, &about, &options.input, &mut out);
    of_centres(&particles, &mut out);
    if about.radius != RadiusSource::Missing {
        of_scene(options, particles, &about, &mut out)?;
    }
    if all {
        motion::report(options, of_all, &mut out);
    }
    Ok(out.print()?)
}

fn of_file(options: &Inspect, particles: &Particles, about: &About, out: &mut Output) {
    let name = options.file.display().to_string();
    out.line("file", name.clone(), json!({ "file": name }));
    let gzip = if about.gzip { ", compressed with gzip" } else { "" };
    let values = json!({ "format": about.format, "gzip": about.gzip });
    out.line("format", format!("{}{gzip}", about.format), values);
    let (n, dim) = (particles.len(), particles.dim());
    let what = if dim == 2 { "discs (2D)" } else { "spheres (3D)" };
    out.line("particles", format!("{n} {what}"), json!({ "n": n, "dim": dim }));
    let About { frames, frame, .. } = *about;
    let read = format!("; read: frame {frame} (numbered from 0)");
    let which = if frames == 1 { "" } else { &read };
    out.line("frames", format!("{frames}{which}"), json!({ "frames": frames, "frame": frame }));
    if frames > 1 && options.input.frame != Some(FrameChoice::All) {
        out.warn(format!(
            "the file has {frames} frames, numbered from 0; only frame {frame} is described"
        ));
    }
    let (text, kind, column) = match &about.radius {
        RadiusSource::Column(name) => (format!("'{name}' in the file"), "column", Some(name)),
        RadiusSource::Halved(name) => {
            (format!("half of the diameter '{name}' in the file"), "diameter", Some(name))
        }
        RadiusSource::Given => ("the option --radius".into(), "option", None),
        RadiusSource::Missing => {
            let none = "none in the file; add --radius R (half the diameter) to find contacts";
            (none.into(), "missing", None)
        }
    };
    out.line("radius from", text, json!({ "radius_source": kind, "radius_column": column }));
    particles.notices.iter().for_each(|notice| out.warn(notice.to_string()));
}

fn of_centres(particles: &Particles, out: &mut Output) {
    let (n, dim) = (particles.len(), particles.dim());
    if n == 0 {
        out.warn("there are no particles");
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
    out.line("centres", text.join(", "), json!({ "low": low[..dim], "high": high[..dim] }));
    // Adding 0 turns -0 into 0, so that both have one key.
    let key = |k: u32| particles.centre(k as usize).map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.sort_unstable_by_key(|&k| key(k));
    let count = order.windows(2).filter(|pair| key(pair[0]) == key(pair[1])).count();
    let text = format!("{count} centres at the place of another");
    out.line("coincident", text, json!({ "coincident_centres": count }));
}

fn of_scene(
    options: &Inspect,
    particles: Particles,
    about: &About,
    out: &mut Output,
) -> anyhow::Result<()> {
    let given = particles.given(&options.file.display().to_string(), options.input.radius)?;
    let periodic = in_any_box(&given)?;
    // This is the limit of `detect`, at which a box much smaller than the particles is refused at
    // once.
    let contacts = Contacts::new(&periodic, limit_for(given.scene.len()));
    contacts::report(&periodic, &about.radius, &contacts, out);
    let axes = periodic.lattice().periodic();
    if axes.contains(&true) {
        boxes::reach(&periodic, out);
    }
    let Some(count) = contacts.exact() else { return Ok(()) };
    let stats = stats(&given, count);
    let (of, place) = match axes[..given.scene.dim()].iter().all(|&repeats| repeats) {
        true => ("box", "the periodic box (overlaps counted twice)"),
        false => ("bounds", "the box around the particles"),
    };
    let fraction = stats.packing_fraction;
    out.line(
        "packing fraction",
        format!("{fraction:.4} of {place}"),
        json!({ "packing_fraction": fraction, "packing_of": of }),
    );
    out.line("fingerprint", stats.scene_hash.clone(), json!({ "scene_hash": stats.scene_hash }));
    Ok(())
}
