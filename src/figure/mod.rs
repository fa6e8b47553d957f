//! Figures from the record: one image per figure of an experiment, as SVG (its text stays text) and PNG.
//!
//! `data` turns cells into lines and marks, `layout` places panels and legend, `panel` draws one of them; `tradeoff` and `tradeoff_sheet`
//! do the same for speed against error. `axis` chooses ranges and ticks, `style` fixes colour and marker per detector, `canvas` is the
//! thin layer over the plotters backends.

pub mod axis;
pub mod canvas;
pub mod data;
pub mod layout;
mod panel;
pub mod style;
pub mod tradeoff;
mod tradeoff_sheet;

use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::analyse::machine::Machine;
use crate::analyse::value::Cell;
use crate::harness::experiment::{Experiment, Figure, FigureKind};

/// Draws a figure into `folder` as NAME.svg and NAME.png and gives their paths; none if no cell has anything to show.
pub fn draw(
    folder: &Path,
    experiment: &Experiment,
    figure: &Figure,
    cells: &[Cell],
    style: &style::Styles,
    machine: &Machine,
) -> anyhow::Result<Vec<PathBuf>> {
    canvas::register_fonts()?;
    let own: Vec<Cell> = cells.iter().filter(|cell| cell.key.experiment == experiment.name).cloned().collect();
    let scenes: Vec<&str> = experiment.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let stem = folder.join(file_stem(&experiment.name, &figure.name));
    match figure.kind {
        FigureKind::Lines => {
            let Some(plot) = data::Plot::new(figure, &scenes, &own)? else { return Ok(Vec::new()) };
            let sheet = layout::Sheet::new(experiment, figure, &plot, style, machine);
            write(&stem, sheet.size, |canvas| sheet.draw(canvas))
        }
        FigureKind::SpeedError => {
            let Some(plot) = tradeoff::Plot::new(figure, &scenes, &own)? else { return Ok(Vec::new()) };
            let sheet = tradeoff_sheet::Sheet::new(experiment, figure, &plot, style);
            write(&stem, sheet.size, |canvas| sheet.draw(canvas))
        }
    }
}

fn write(stem: &Path, size: (u32, u32), draw: impl Fn(&mut dyn canvas::Canvas) -> anyhow::Result<()>) -> anyhow::Result<Vec<PathBuf>> {
    let (svg, png) = (stem.with_extension("svg"), stem.with_extension("png"));
    std::fs::write(&svg, canvas::svg(size, &draw)?).with_context(|| format!("cannot write the figure {}", svg.display()))?;
    canvas::png(&png, size, draw).with_context(|| format!("cannot write the figure {}", png.display()))?;
    Ok(vec![svg, png])
}

/// `experiment-figure`, of letters that are safe in file names and links.
fn file_stem(experiment: &str, figure: &str) -> String {
    let name = if figure.starts_with(experiment) { figure.to_string() } else { format!("{experiment}-{figure}") };
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests;
