//! Runs experiments and checks. It plans them, starts runners, judges answers, follows trackers,
//! and recommends detectors.

/// The names and texts of files in a folder of the workspace.
macro_rules! files {
    ($folder:literal, $ending:literal: $($name:literal)*) => {
        [$(($name, include_str!(concat!(env!("CONTACTBENCH_ROOT"), $folder, $name, $ending)))),*]
    };
}
pub(crate) use files;

pub mod check;
pub mod plan;
pub mod recommend;
pub mod run;
pub mod tracking;
pub mod verify;
