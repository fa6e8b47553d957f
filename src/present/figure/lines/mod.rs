//! Figures of lines: a value against N or another parameter, a panel per scene and dimension.

pub mod data;
mod panel;
mod sheet;

pub use data::Plot;
pub use sheet::Sheet;
