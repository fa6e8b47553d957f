//! What the project says of itself: pages, protocol, runners, templates, walls.

mod codes;
mod help;
mod new_detector;
mod peers;
mod protocol;
mod readme;
mod satellites;
mod walls;
