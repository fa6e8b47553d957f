//! Draws the figures of an experiment from the record, each as an SVG that keeps its text as text.
//!
//! The modules `lines`, `bars` and `speed_error` each draw one kind of figure: they turn
//! cells into data, and lay them out. `axis` chooses ranges and ticks, `style` defines colour and
//! marker of each detector, and `canvas` calls plotters.

mod axis;
mod bars;
mod canvas;
mod lines;
mod speed_error;
pub mod style;

use std::path::{Path, PathBuf};

use anyhow::Context;

use contactbench_record::cells::Cell;
use contactbench_record::experiment::{Experiment, Figure, FigureKind};

pub struct About<'a> {
    pub experiment: &'a Experiment,
    pub figure: &'a Figure,
    pub cells: &'a [Cell],
    pub styles: &'a style::Styles,
    pub caches: &'a [(String, u64)],
}

impl About<'_> {
    /// Draws the figure into a folder and returns its path; `None` if no cell has anything to show.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<Option<PathBuf>> {
        let Some(picture) = self.svg()? else { return Ok(None) };
        let path = folder.join(self.file());
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        std::fs::write(&path, picture)
            .with_context(|| format!("cannot write the figure {}", path.display()))?;
        Ok(Some(path))
    }

    /// Returns the figure as SVG; `None` if no cell has anything to show. Fails if the record lacks
    /// a variable or value that the figure needs.
    fn svg(&self) -> anyhow::Result<Option<String>> {
        match &self.figure.kind {
            FigureKind::Lines(options) => lines::svg(self, options),
            FigureKind::Bars(options) => bars::svg(self, options),
            FigureKind::SpeedError(options) => speed_error::svg(self, options),
        }
    }

    /// Returns the file name `experiment-figure.svg`. Letters that are unsafe in file names and
    /// links are replaced.
    fn file(&self) -> String {
        let (experiment, figure) = (&*self.experiment.name, &*self.figure.name);
        let experiment = match figure.starts_with(experiment) {
            true => String::new(),
            false => format!("{experiment}-"),
        };
        let safe = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        format!("{experiment}{figure}").replace(|c| !safe(c), "-") + ".svg"
    }

    fn place(&self, cell: &Cell) -> usize {
        let scenes = &self.experiment.scenes;
        scenes.iter().position(|scene| scene.name == cell.id.scene).unwrap_or(scenes.len())
    }
}

#[cfg(test)]
mod tests;
