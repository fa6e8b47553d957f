//! What findings look like: tables, reports, pages, figures, pictures of scenes.

pub mod csv;
pub mod document;
pub mod escape;
pub mod figure;
pub mod page;
pub mod recommendation;
pub mod report;
pub mod sections;
pub mod svg;
pub mod table;
pub mod tracking;
