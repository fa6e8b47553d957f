pub mod growth;
pub mod interval;
pub mod line;
pub mod unpaired;
