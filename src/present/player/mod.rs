//! What pages that step share: buttons, keys, swipes, the address, light and dark. A page puts both
//! into itself, so that it needs nothing else.

pub mod palette;

/// The rules of how such a page looks.
pub const STYLE: &str = include_str!("player.css");
/// What such a page does.
pub const SCRIPT: &str = include_str!("player.js");
