//! `contactbench verify`: compares the contact lists of another program with the exact truth.

mod print;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::ensure;

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::input::{self, Input, Told};
use crate::cli::shared::limit::Limit;
use crate::cli::shared::progress::Counted;
use contactbench_ground::contact::Arithmetic;
use contactbench_io::pairs::{self, List};
use contactbench_io::{self as io, About, FrameChoice, Particles, Without};
use contactbench_run::verify::Allowed;
use contactbench_run::verify::frame::Asked;
use contactbench_run::verify::frames::All;
use contactbench_run::verify::paired::{Matched, Paired};

#[derive(clap::Args)]
pub struct Verify {
    /// Particle file
    file: PathBuf,
    /// Contact list: i,j as text, .npy or dump
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
    pairs_frame: Option<FrameChoice>,
    /// Arithmetic (see: list); exact-open decides by <
    #[arg(long, value_name = "NAME", value_parser = arithmetic(), default_value_t)]
    #[arg(hide_possible_values = true)]
    arithmetic: Arithmetic,
    #[command(flatten)]
    limit: Limit,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Compares the lists and prints the result; exit code 1 if they differ.
pub fn verify(options: &Verify) -> anyhow::Result<ExitCode> {
    let Verify { skin, both_sides, arithmetic, pairs_frame, .. } = *options;
    ensure!(
        matches!(options.base, None | Some(0 | 1)),
        "--base {}: it must be 0 or 1",
        options.base.unwrap_or_default()
    );
    ensure!(
        skin >= 0.0 && skin.is_finite(),
        "--skin {skin}: it must be a finite length of at least 0"
    );
    ensure!(
        pairs_frame != Some(FrameChoice::All),
        "--pairs-frame names the list of one frame; for all give --frame all"
    );
    let several = options.input.frame == Some(FrameChoice::All);
    ensure!(
        !several || pairs_frame.is_none(),
        "--pairs-frame and --frame all cannot be used together; leave one out"
    );
    let asked = Asked {
        file: &options.file,
        pairs: &options.pairs,
        input: io::Options { ids: true, without: options.without, ..options.input.options() },
        base: options.base,
        ids: options.ids,
        pairs_frame,
        arithmetic,
        allowed: Allowed { both_sides, skin },
        limit: &|particles| options.limit.bytes(particles),
    };
    let mut all = All { several, ..All::default() };
    let (progress, mut told, mut of_lists) = (Counted::new(None), Told::default(), Told::default());
    let [file, list_file] = [&options.file, &options.pairs].map(|it| it.display().to_string());
    all.matched = each(options, &asked, several, &mut |particles, about, list| {
        progress.frame(about.frame);
        let place = if several { input::place(&file, &about) } else { file.clone() };
        told.tell(&place, &particles.notices);
        of_lists.tell(&list_file, &list.notices);
        of_lists.tell(&list_file, asked.without_ids(&list, &particles).as_slice());
        all.compare(&asked, particles, &about, list)?;
        Ok(())
    })?;
    drop(progress);
    all.late.end();
    ensure!(!all.rows.is_empty(), "{list_file}: no frame has a list");
    ensure!(
        all.rows.iter().any(|row| row.particles > 0),
        "{file} has no particles: there is nothing to compare"
    );
    print::print(options, &all)?;
    Ok(ExitCode::from(u8::from(!all.is_same())))
}

/// Passes on each chosen frame of the particles, with its list.
fn each(
    options: &Verify,
    asked: &Asked<'_>,
    several: bool,
    body: &mut dyn FnMut(Particles, About, List) -> anyhow::Result<()>,
) -> anyhow::Result<Matched> {
    let columns = options.pairs_columns.as_deref().map(|text| text.split(',').map(str::trim));
    let columns: Vec<&str> = columns.into_iter().flatten().collect();
    let names = [&options.file, &options.pairs].map(|path| path.display().to_string());
    if several {
        return input::frames(&options.file, asked.input, |frames| {
            pairs::lists(&options.pairs, &columns, FrameChoice::All, |lists| {
                let mut paired = Paired::new(frames, lists, [&names[0], &names[1]]);
                while let Some((particles, about, list)) = paired.next_frame()? {
                    body(particles, about, list)?;
                }
                Ok(paired.matched)
            })
        });
    }
    let frame = options.pairs_frame.or(options.input.frame).unwrap_or(FrameChoice::Last);
    let list = pairs::read(&options.pairs, &columns, frame)?;
    let (particles, about) = input::load(&options.file, &options.input, asked.input)?;
    asked.same_time(&list, &about)?.into_iter().for_each(|note| say!("{note}"));
    if about.frames > 1 && options.input.frame.is_none() && list.frame.is_some() {
        say!("{}: --frame all compares each of them", names[0]);
    }
    body(particles, about, list)?;
    Ok(Matched::default())
}
