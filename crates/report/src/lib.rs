//! Findings as tables, reports, pages and figures.

pub mod csv;
pub mod document;
mod facts;
pub mod figure;
pub mod page;
pub mod report;
pub mod research_object;
pub mod sections;
pub mod site;
pub mod table;
