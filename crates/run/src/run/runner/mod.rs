//! Runners: the protocol with its two sides, and the processes that speak it.

pub mod alloc;
pub mod client;
pub(super) mod family;
pub mod possible;
pub mod protocol;
pub mod server;
pub mod trajectory;
