//! Sizes of particles in arrays of their own.

use anyhow::bail;

use crate::columns::Column;
use crate::raw::lines::short;
use crate::types::RadiusSource;

pub struct Size {
    pub values: Vec<f64>,
    pub column: Column,
    pub label: String,
    /// Whether there is one value per cell instead of one per point.
    pub of_cells: bool,
}

/// Returns the radii and their source; several arrays of sizes are refused.
pub fn radii(mut sizes: Vec<Size>, name: &str) -> anyhow::Result<(RadiusSource, Option<Vec<f64>>)> {
    if let [a, b, ..] = &sizes[..] {
        let [a, b] = [a, b].map(|size| short(&size.label));
        bail!("{name}: '{a}' and '{b}' are both sizes; choose one: --columns r={a} or d={b}");
    }
    let Some(Size { values, column, label, .. }) = sizes.pop() else {
        return Ok((RadiusSource::Missing, None));
    };
    let source = match column {
        Column::Diameter => RadiusSource::Halved(label),
        _ => RadiusSource::Column(label),
    };
    Ok((source, Some(values)))
}
