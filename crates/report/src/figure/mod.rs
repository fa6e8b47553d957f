//! Figures from the record: one SVG per figure of an experiment, whose text stays text.
//!
//! `lines`, `bars`, `speed_error` and `map` are the kinds: each turns cells into data, and lays
//! them out. `axis` chooses ranges and ticks, `style` fixes colour and marker per detector,
//! `outcome` marks what has no value, `canvas` is the thin layer over plotters.

pub mod axis;
pub mod bars;
pub mod canvas;
pub mod lines;
pub mod map;
pub mod outcome;
pub mod speed_error;
pub mod style;

use std::path::{Path, PathBuf};

use anyhow::Context;

use contactbench_record::cells::Cell;
use contactbench_record::cells::machine::Machine;
use contactbench_record::experiment::{Experiment, Figure, FigureKind};

/// Draws a figure into `folder` as NAME.svg and returns its path; none if no cell has anything to
/// show.
pub fn draw(
    folder: &Path,
    experiment: &Experiment,
    figure: &Figure,
    cells: &[Cell],
    style: &style::Styles,
    machine: &Machine,
) -> anyhow::Result<Option<PathBuf>> {
    let Some(picture) = svg(experiment, figure, cells, style, machine)? else {
        return Ok(None);
    };
    let path = folder.join(file_stem(&experiment.name, &figure.name)).with_extension("svg");
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    std::fs::write(&path, &picture)
        .with_context(|| format!("cannot write the figure {}", path.display()))?;
    Ok(Some(path))
}

/// A figure as SVG; none if no cell has anything to show.
fn svg(
    experiment: &Experiment,
    figure: &Figure,
    cells: &[Cell],
    style: &style::Styles,
    machine: &Machine,
) -> anyhow::Result<Option<String>> {
    let own: Vec<Cell> =
        cells.iter().filter(|cell| cell.id.experiment == experiment.name).cloned().collect();
    let scenes: Vec<&str> = experiment.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let about = About { experiment, figure, scenes: &scenes, cells: &own, style, machine };
    match &figure.kind {
        FigureKind::Lines(options) => lines::svg(&about, options),
        FigureKind::Bars(options) => bars::svg(&about, options),
        FigureKind::SpeedError(options) => speed_error::svg(&about, options),
        FigureKind::Map(axes) => map::svg(&about, axes),
    }
}

/// What a figure is drawn from.
pub struct About<'a> {
    experiment: &'a Experiment,
    figure: &'a Figure,
    /// The names of the experiment's scenes, in their order.
    scenes: &'a [&'a str],
    /// The cells of the experiment.
    cells: &'a [Cell],
    style: &'a style::Styles,
    machine: &'a Machine,
}

/// `experiment-figure`, of letters that are safe in file names and links.
fn file_stem(experiment: &str, figure: &str) -> String {
    let name = if figure.starts_with(experiment) {
        figure.to_string()
    } else {
        format!("{experiment}-{figure}")
    };
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' })
        .collect()
}

#[cfg(test)]
mod tests;
