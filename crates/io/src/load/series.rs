//! A pattern such as `run_*.csv`: one frame per file, ordered by the numbers in the names.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use anyhow::ensure;

use super::opened;
use crate::frames::{Choice, Reader, Step};
use crate::options::Options;
use crate::particles::Loaded;
use crate::raw::lines::short;
use crate::types::{About, Frame, Notice, assumed};

/// The files that match a pattern; each is one frame.
pub struct Series {
    files: Vec<PathBuf>,
    next: usize,
    notice: Option<Notice>,
    options: Options,
}

/// Whether the file exists, or a file matches the pattern.
pub fn exists(path: &Path) -> bool {
    path.exists() || pattern(path).is_some_and(|files| !files.is_empty())
}

/// Returns the files that `path` stands for; `None` if it is one file.
pub fn of(path: &Path, options: Options) -> anyhow::Result<Option<Series>> {
    let series = |(files, notice)| Series { files, next: 0, notice, options };
    Ok(matching(path)?.map(series))
}

/// Returns the files that match a pattern, and a notice if there are several; `None` if `path` is
/// not a pattern.
pub(crate) fn matching(path: &Path) -> anyhow::Result<Option<(Vec<PathBuf>, Option<Notice>)>> {
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
    Ok(Some((files, notice)))
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
    let parts = |text: &str| {
        let mut parts: Vec<(String, usize, String)> = vec![Default::default()];
        for c in text.chars() {
            let last = parts.len() - 1;
            if c.is_ascii_digit() {
                parts[last].2.push(c);
            } else if parts[last].2.is_empty() {
                parts[last].0.push(c);
            } else {
                parts.push((c.to_string(), 0, String::new()));
            }
        }
        for (_, figures, digits) in &mut parts {
            *digits = digits.trim_start_matches('0').to_string();
            *figures = digits.len();
        }
        parts
    };
    parts(a).cmp(&parts(b)).then_with(|| a.cmp(b))
}

impl Reader<Loaded> for Series {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<Loaded>> {
        // Files before the wanted one are not opened.
        self.next = self.next.max(choice.first_of(self.files.len()));
        while let Some(file) = self.files.get(self.next) {
            let (index, name) = (self.next as u64, file.display().to_string());
            let step = choice.begin_at(index, || name.clone())?;
            if step == Step::Stop {
                return Ok(None);
            }
            self.next += 1;
            if step == Step::Keep {
                let options = Options { frame: Frame::Only, survey: false, ..self.options };
                let (mut particles, about) = opened(file, options, |frames| frames.raw())?;
                particles.notices.extend(self.notice.clone());
                return Ok(Some((particles, About { file: Some(name), ..about })));
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
