//! Figures of lines, a panel per scene and dimension.

pub mod data;
mod panel;
mod sheet;

pub use data::Plot;
use sheet::Sheet;

use crate::figure::{About, canvas};
use contactbench_record::experiment::Lines;

/// The figure as SVG; none if there is nothing to show.
pub fn svg(about: &About<'_>, options: &Lines) -> anyhow::Result<Option<String>> {
    let About { experiment, figure, style, machine, .. } = about;
    let plot = Plot::new(options, &figure.filter, about.scenes, about.cells)?;
    let Some(plot) = plot else { return Ok(None) };
    let sheet = Sheet::new(experiment, &figure.title, options, &plot, style, machine)?;
    canvas::svg(sheet.size, |canvas| sheet.draw(canvas)).map(Some)
}
