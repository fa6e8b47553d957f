//! Figures of speed against error: small panels with a mark per detector and arithmetic.

pub mod data;
mod panel;
mod sheet;

pub use data::Plot;
use sheet::Sheet;

use crate::figure::{About, canvas};
use contactbench_record::experiment::SpeedError;

/// The figure as SVG; none if no cell has time and errors.
pub fn svg(about: &About<'_>, options: &SpeedError) -> anyhow::Result<Option<String>> {
    let About { experiment, figure, style, .. } = about;
    let plot = Plot::new(options, &figure.filter, about.scenes, about.cells)?;
    let Some(plot) = plot else { return Ok(None) };
    let sheet = Sheet::new(experiment, &figure.title, options, &plot, style);
    canvas::svg(sheet.size, |canvas| sheet.draw(canvas)).map(Some)
}
