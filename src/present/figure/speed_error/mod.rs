//! Figures of speed against error: small panels with a mark per detector and arithmetic.

pub mod data;
mod panel;
mod sheet;

pub use data::Plot;
pub use sheet::Sheet;
