//! What findings look like: tables, reports, pages, figures, pictures of scenes.

pub mod csv;
pub mod document;
pub mod figure;
pub mod page;
pub mod report;
pub mod sections;
pub mod table;
