//! The campaign.

pub mod couples;
#[path = "../../near_tangent/campaign/draw.rs"]
pub mod draw;
