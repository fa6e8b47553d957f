//! Campaigns: contacts made from integers that are nearly tangent, and bodies that move, in any
//! number, against every detector and every rule that promises to miss nothing.

pub mod draw;
pub mod moving;
pub mod near_tangent;
