//! A short run of the campaign on bodies that move (`examples/moving`).

#[path = "../../examples/moving/campaign/mod.rs"]
pub mod campaign;
