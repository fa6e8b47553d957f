//! Regression files: a scene as CSV or, in a box, as extended XYZ. A comment in a CSV file states
//! where the scene was found and how to reproduce the error.

use std::path::Path;

use crate::check::Failure;
use contactbench_ground::scene::AnyScene;
use contactbench_io::Given;
use contactbench_io::write::{self, SceneFormat};

pub const KEPT: [(&str, &str); 5] = crate::files! { "/tests/regressions/", "":
    "far-apart.csv" "subnormal.csv" "tangent-3-4-5.csv" "three-discs.csv" "twice-around.xyz"
};

/// Returns a scene as CSV with a header; the numbers read back to the same bits.
pub fn as_csv(scene: &AnyScene<'static>) -> String {
    text(SceneFormat::Csv, &scene.clone().into())
}

fn text(format: SceneFormat, given: &Given) -> String {
    let mut text = Vec::new();
    let _ = write::scene_to(&mut text, format, given);
    String::from_utf8_lossy(&text).into_owned()
}

/// Returns the text of the regression file of a failure. `path` is its path, `who` the option of
/// `check` that selects the subject.
pub fn file(failure: &Failure, path: &Path, who: &str) -> String {
    let Failure { detector, arithmetic, found_on, smallest, .. } = failure;
    let arithmetic = arithmetic.name();
    let how = match &failure.wrong {
        Some(wrong) => wrong.to_string(),
        None => format!(
            "wrong only after earlier scenes, something is left in its buffers: {}",
            failure.found
        ),
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let comment = format!(
        "{detector}, {arithmetic} arithmetic: {how}\nfound on {found_on}\ncontactbench check \
         --scene {name} {who}"
    );
    if smallest.lattice.is_some() {
        // Extended XYZ cannot hold the comment.
        return text(SceneFormat::Xyz, smallest);
    }
    let comment: String = comment.lines().map(|line| format!("# {line}\n")).collect();
    comment + &as_csv(&smallest.scene)
}

pub fn ending(failure: &Failure) -> &'static str {
    if failure.smallest.lattice.is_some() { ".xyz" } else { ".csv" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_regression_is_kept() {
        let folder =
            Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/regressions");
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(name).collect();
        names.sort();
        assert!(names.iter().eq(KEPT.map(|(name, _)| name).iter()), "{names:?}");
    }
}
