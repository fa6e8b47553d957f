//! Figures from the record: one image per figure of an experiment, as SVG (its text stays text) and
//! as PNG, made from it.
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

use crate::cells::machine::Machine;
use crate::cells::{Cell, select};
use crate::experiment::{Experiment, Figure, FigureKind, MapAxes};
use crate::findings::map::Map;

/// Draws a figure into `folder` as NAME.svg and NAME.png and gives their paths; none if no cell has
/// anything to show.
pub fn draw(
    folder: &Path,
    experiment: &Experiment,
    figure: &Figure,
    cells: &[Cell],
    style: &style::Styles,
    machine: &Machine,
) -> anyhow::Result<Vec<PathBuf>> {
    let Some(picture) = svg(experiment, figure, cells, style, machine)? else {
        return Ok(Vec::new());
    };
    let stem = folder.join(file_stem(&experiment.name, &figure.name));
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let failed = |path: &Path| format!("cannot write the figure {}", path.display());
    let (svg, png) = (stem.with_extension("svg"), stem.with_extension("png"));
    std::fs::write(&svg, &picture).with_context(|| failed(&svg))?;
    let pixels = crate::present::svg::png(&picture).with_context(|| failed(&png))?;
    std::fs::write(&png, pixels).with_context(|| failed(&png))?;
    Ok(vec![svg, png])
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
    match &figure.kind {
        FigureKind::Lines(options) => {
            let Some(plot) = lines::Plot::new(options, &figure.filter, &scenes, &own)? else {
                return Ok(None);
            };
            let title = &figure.title;
            let sheet = lines::Sheet::new(experiment, title, options, &plot, style, machine)?;
            canvas::svg(sheet.size, |canvas| sheet.draw(canvas)).map(Some)
        }
        FigureKind::Bars(options) => {
            let Some(plot) = bars::Plot::new(options, &figure.filter, &own)? else {
                return Ok(None);
            };
            let sheet = bars::Sheet::new(experiment, &figure.title, &plot, style)?;
            canvas::svg(sheet.size, |canvas| sheet.draw(canvas)).map(Some)
        }
        FigureKind::SpeedError(options) => {
            let Some(plot) = speed_error::Plot::new(options, &figure.filter, &scenes, &own)? else {
                return Ok(None);
            };
            let sheet = speed_error::Sheet::new(experiment, &figure.title, options, &plot, style);
            canvas::svg(sheet.size, |canvas| sheet.draw(canvas)).map(Some)
        }
        FigureKind::Map(axes) => {
            // Of a shard, say, there may be nothing to see.
            if select::select(&own, &figure.filter)?.iter().all(|cell| cell.time().is_none()) {
                return Ok(None);
            }
            let found = Map::new(axes, &figure.filter, &own)?;
            of_map(&figure.title, axes, &found, style).map(Some)
        }
    }
}

/// A map as SVG.
pub fn of_map(
    title: &str,
    axes: &MapAxes,
    found: &Map,
    style: &style::Styles,
) -> anyhow::Result<String> {
    let sheet = map::Sheet::new(title, axes, found, style)?;
    canvas::svg(sheet.size, |canvas| sheet.draw(canvas))
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
