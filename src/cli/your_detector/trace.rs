use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;

use crate::cli::shared::scene::Source;
use contactbench_io::write;
use contactbench_views::trace::{Algorithm, example, page, still, trace as run};

#[derive(clap::Args)]
#[command(mut_arg("box", |arg| arg.hide(true)), mut_arg("periodic", |arg| arg.hide(true)))]
pub struct Trace {
    /// nbs, screening, sorting or binary-tree
    #[arg(value_enum, hide_possible_values = true)]
    detector: Algorithm,
    #[command(flatten)]
    source: Source,
    /// Folder for the page and the pictures
    #[arg(short, long, value_name = "FOLDER", default_value = "trace")]
    out: PathBuf,
    /// Write the page only, without a picture of each step
    #[arg(long)]
    page_only: bool,
}

/// Writes the page and the pictures, and prints their paths on standard error.
pub fn trace(options: &Trace) -> anyhow::Result<ExitCode> {
    let algorithm = options.detector;
    let (name, scene) = match options.source.get()? {
        Some((name, scene)) => (name, Some(scene)),
        None => (example::example(algorithm).name.to_string(), None),
    };
    let trace = run(algorithm, scene.as_ref())?;
    let folder = &options.out;
    let failed = || format!("cannot write to {}; choose another folder with -o", folder.display());
    std::fs::create_dir_all(folder).with_context(failed)?;
    let page = folder.join(format!("{}.html", algorithm.name()));
    let text = page::html(&trace, &name);
    write::whole(&page, |out| out.write_all(text.as_bytes())).with_context(failed)?;
    let last = trace.steps.len() - 1;
    let mut pictures = String::new();
    if !options.page_only {
        let stills = still::Stills::new(&trace, &name);
        let digits = last.to_string().len().max(3);
        for (k, svg) in (0..=last).filter_map(|k| Some((k, stills.svg(k)?))) {
            let path = folder.join(format!("{}-{k:0digits$}.svg", algorithm.name()));
            write::whole(&path, |out| out.write_all(svg.as_bytes())).with_context(failed)?;
        }
        pictures = format!(" and {} pictures", last + 1);
    }
    let contacts = trace.contacts.len();
    say!(
        "{name}: N = {}, {contacts} contacts, {last} steps of {}; {}{pictures}",
        trace.discs.len(),
        algorithm.name(),
        page.display()
    );
    Ok(ExitCode::SUCCESS)
}
