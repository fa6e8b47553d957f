//! A pattern such as `run_*.csv`: one frame per file, ordered by the numbers in the names.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use anyhow::ensure;

use crate::frames::{Choice, Reader, Step};
use crate::raw::lines::short;
use crate::types::{Notice, assumed};

/// The files that match a pattern; each is one frame.
pub struct Series<F> {
    files: Vec<PathBuf>,
    next: usize,
    /// Reads a file, given its index and a notice about the order of the files.
    read: F,
    notice: Option<Notice>,
}

/// Whether the file exists, or a file matches the pattern.
pub fn exists(path: &Path) -> bool {
    path.exists() || pattern(path).is_some_and(|files| !files.is_empty())
}

/// Returns the files that match a pattern; `None` if `path` is one file.
pub fn of<T, F>(path: &Path, read: F) -> anyhow::Result<Option<Series<F>>>
where
    F: FnMut(&Path, u64, &Option<Notice>) -> anyhow::Result<T>,
{
    let Some(files) = pattern(path) else { return Ok(None) };
    ensure!(!files.is_empty(), "no file matches the pattern {}", path.display());
    let name = |path: &PathBuf| short(&path.file_name().unwrap_or_default().to_string_lossy());
    let notice = match &files[..] {
        [first, .., last] => Some(assumed!(
            "{} files are taken as frames, in the order of the numbers in their names: {} to {}",
            files.len(),
            name(first),
            name(last)
        )),
        _ => None,
    };
    Ok(Some(Series { files, next: 0, read, notice }))
}

/// Returns the files that match a name with `*` or `?`, in natural order; `None` without these
/// signs.
fn pattern(path: &Path) -> Option<Vec<PathBuf>> {
    let name = path.file_name()?.to_str()?;
    if path.exists() || !name.contains(['*', '?']) {
        return None;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten();
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> =
        names.filter(|file| matches(name.as_bytes(), file.as_bytes())).collect();
    names.sort_unstable_by(|a, b| natural(a, b));
    let file = |name| folder.map_or(PathBuf::from(&name), |folder| folder.join(&name));
    Some(names.into_iter().map(file).collect())
}

/// Whether a name matches a pattern: `*` is any text, `?` is one byte.
fn matches(pattern: &[u8], name: &[u8]) -> bool {
    // The last `*` and the end of the text that it matches: matching resumes only there.
    let (mut p, mut n, mut star) = (0, 0, None);
    while n < name.len() {
        match pattern.get(p) {
            Some(b'*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(&c) if c == b'?' || c == name[n] => (p, n) = (p + 1, n + 1),
            _ => {
                let Some((at, reached)) = star else { return false };
                star = Some((at, reached + 1));
                (p, n) = (at + 1, reached + 1);
            }
        }
    }
    pattern[p..].iter().all(|&c| c == b'*')
}

/// Compares names by texts and numbers, so that `b2` comes before `b10`.
fn natural(a: &str, b: &str) -> Ordering {
    // Numbers come before text, and are compared by their digits without zeros in front.
    let key = |text: &str| {
        let runs = text.as_bytes().chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit());
        let key = |run: &[u8]| {
            let zeros = run.iter().take_while(|c| **c == b'0').count();
            let is_number = run[0].is_ascii_digit();
            let run = run[if is_number { zeros } else { 0 }..].to_vec();
            (!is_number, if is_number { run.len() } else { 0 }, run)
        };
        runs.map(key).collect::<Vec<_>>()
    };
    key(a).cmp(&key(b)).then_with(|| a.cmp(b))
}

impl<T, F> Reader<T> for Series<F>
where
    F: FnMut(&Path, u64, &Option<Notice>) -> anyhow::Result<T>,
{
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<T>> {
        // Files before the wanted one are not opened.
        self.next = self.next.max(choice.first_of(self.files.len()));
        while let Some(file) = self.files.get(self.next) {
            let index = self.next as u64;
            let step = choice.begin_at(index, || file.display().to_string())?;
            if step == Step::Stop {
                return Ok(None);
            }
            self.next += 1;
            if step == Step::Keep {
                return (self.read)(file, index, &self.notice).map(Some);
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_by_their_numbers_and_match_patterns() {
        let mut names = ["b10.x", "b9.x", "b9.10", "b009.x", "a", "b.x", "b1_2", "b1_10"];
        names.sort_unstable_by(|a, b| natural(a, b));
        assert_eq!(names, ["a", "b1_2", "b1_10", "b9.10", "b009.x", "b9.x", "b10.x", "b.x"]);
        for (pattern, name, fits) in [
            ("*", "", true),
            ("a*b*c", "aXbbYbc", true),
            ("a*b*c", "aXbbYb", false),
            ("?x", "ax", true),
            ("?x", "x", false),
            ("run_*.csv", "run_1.csv.gz", false),
            ("**", "ab", true),
            ("a", "ab", false),
        ] {
            assert_eq!(matches(pattern.as_bytes(), name.as_bytes()), fits, "{pattern} {name}");
        }
    }
}
