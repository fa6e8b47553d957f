//! Frames and scenes in several files, for all formats.
//!
//! * A pattern such as `run_*.vtp`: one frame per file, ordered by the numbers in the names.
//! * A list of files and times: `.pvd` and `.series` of ParaView.
//! * `.pvtu` and `.pvtp`: one scene in several pieces.

use std::cmp::Ordering;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};

use crate::formats::gzip::Unpacking;
use crate::formats::xml::{Tag, Xml};
use crate::frames::{Choice, Frame, Reader, Step};
use crate::raw::lines::{Source, number, short};
use crate::{About, Loaded, Notice, Options, opened, room};

struct Member {
    files: Vec<PathBuf>,
    time: Option<f64>,
}

pub struct Series {
    /// The list of files, or the pattern.
    path: PathBuf,
    members: Vec<Member>,
    next: usize,
    /// Whether the files are frames; otherwise they are parts of one scene.
    framed: bool,
    notice: Option<Notice>,
    options: Options,
}

const LONGEST: u64 = 1 << 26;

/// Whether the file exists, or a file matches the pattern.
pub fn exists(path: &Path) -> bool {
    path.exists() || pattern(path).is_some_and(|files| !files.is_empty())
}

/// Returns the files that `path` stands for; `None` if it is a file of particles.
pub fn of(path: &Path, options: Options) -> anyhow::Result<Option<Series>> {
    let name = path.display();
    let series = |members, framed, notice| Series {
        path: path.to_path_buf(),
        members,
        next: 0,
        framed,
        notice,
        options,
    };
    if path.exists() {
        let Some(framed) = lists(path)? else { return Ok(None) };
        let members = listed(path, framed).with_context(|| name.to_string())?;
        ensure!(!members.is_empty(), "{name} lists no files; write it again");
        return Ok(Some(series(members, framed, None)));
    }
    let Some((files, notice)) = matching(path)? else { return Ok(None) };
    let member = |file| Member { files: vec![file], time: None };
    Ok(Some(series(files.into_iter().map(member).collect(), true, notice)))
}

/// Returns the files that match a pattern, and a notice if there are several; `None` if `path` is
/// not a pattern.
pub(crate) fn matching(path: &Path) -> anyhow::Result<Option<(Vec<PathBuf>, Option<Notice>)>> {
    let Some(files) = pattern(path) else { return Ok(None) };
    ensure!(!files.is_empty(), "no file matches the pattern {}", path.display());
    let name = |path: &PathBuf| short(&path.file_name().unwrap_or_default().to_string_lossy());
    let notice = match &files[..] {
        [first, .., last] => Some(Notice::Assumed(format!(
            "{} files are taken as frames, in the order of the numbers in their names: {} to {}",
            files.len(),
            name(first),
            name(last)
        ))),
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

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("series"))
}

fn lists(path: &Path) -> anyhow::Result<Option<bool>> {
    if is_json(path) {
        return Ok(Some(true));
    }
    // A pipe can be read only once.
    if !path.is_file() {
        return Ok(None);
    }
    let (name, mut head) = (path.display().to_string(), Vec::new());
    let read = File::open(path).and_then(|file| file.take(4096).read_to_end(&mut head));
    read.with_context(|| format!("cannot read {name}"))?;
    if !head.trim_ascii_start().starts_with(b"<") {
        return Ok(None);
    }
    let (input, unpacking) = (&mut &head[..], &Unpacking::default());
    let mut xml = Xml { source: Source { input, name: &name, unpacking }, line: 1 };
    // A file that is not XML is left to its reader, which refuses it.
    let kind = xml.tag().ok().flatten().filter(|tag| tag.name == "VTKFile");
    Ok(kind.and_then(|tag| match tag.get("type") {
        Some("Collection") => Some(true),
        Some("PPolyData" | "PUnstructuredGrid") => Some(false),
        _ => None,
    }))
}

fn listed(path: &Path, framed: bool) -> anyhow::Result<Vec<Member>> {
    let file = File::open(path).context("cannot read it")?;
    ensure!(
        file.metadata().is_ok_and(|data| data.len() <= LONGEST),
        "a list of files has at most {LONGEST} bytes"
    );
    let folder = path.parent().unwrap_or(Path::new(""));
    if is_json(path) {
        return of_json(BufReader::new(file), folder);
    }
    let (name, unpacking) = (path.display().to_string(), &Unpacking::default());
    let input = &mut BufReader::new(file);
    let mut xml = Xml { source: Source { input, name: &name, unpacking }, line: 1 };
    let mut members: Vec<Member> = Vec::new();
    let mut ended = false;
    while let Some(tag) = xml.tag()? {
        let key = if framed { "DataSet" } else { "Piece" };
        ended |= tag.name == "VTKFile" && tag.closing;
        if tag.name != key || tag.closing {
            continue;
        }
        let place = xml.place();
        let source = tag.get(if framed { "file" } else { "Source" });
        let file = folder.join(source.with_context(|| format!("{place}: <{key}> names no file"))?);
        let time = time_of(&tag, framed).with_context(|| place)?;
        // Files with the same time are parts of one frame.
        match members.last_mut().filter(|last| !framed || time.is_some() && last.time == time) {
            Some(last) => last.files.push(file),
            None => {
                room(&mut members)?;
                members.push(Member { files: vec![file], time });
            }
        }
    }
    ensure!(ended, "it ends before </VTKFile>; write it again");
    if framed {
        in_order(&members)?;
    }
    Ok(members)
}

fn time_of(tag: &Tag, framed: bool) -> anyhow::Result<Option<f64>> {
    let Some(text) = tag.get("timestep").filter(|_| framed) else { return Ok(None) };
    let time = number(text.trim().as_bytes()).filter(|time| time.is_finite());
    time.map(Some).with_context(|| format!("timestep=\"{}\" is not a time", short(text)))
}

/// Reads `{"files": [{"name": "a.vtp", "time": 0}, ...]}`.
fn of_json(reader: impl Read, folder: &Path) -> anyhow::Result<Vec<Member>> {
    #[derive(serde::Deserialize)]
    struct List {
        files: Vec<Named>,
    }
    #[derive(serde::Deserialize)]
    struct Named {
        name: String,
        time: Option<f64>,
    }
    let list: List = serde_json::from_reader(reader).context(
        "a .series file is JSON such as {\"files\": [{\"name\": \"a.vtp\", \"time\": 0}]}",
    )?;
    let member = |it: Named| Member { files: vec![folder.join(it.name)], time: it.time };
    let members: Vec<Member> = list.files.into_iter().map(member).collect();
    in_order(&members)?;
    Ok(members)
}

fn in_order(members: &[Member]) -> anyhow::Result<()> {
    for (before, after) in members.iter().zip(members.iter().skip(1)) {
        let (Some(a), Some(b)) = (before.time, after.time) else { continue };
        let file = after.files[0].display();
        ensure!(a < b, "{file}: the time {b} stands behind {a}; sort the list by time");
    }
    Ok(())
}

impl Series {
    fn of_pieces(path: &Path, options: Options) -> anyhow::Result<Loaded> {
        let place = || path.display().to_string();
        let members = listed(path, false).with_context(place)?;
        let path = path.to_path_buf();
        let series = Series { path, members, next: 0, framed: false, notice: None, options };
        let member = series.members.first().context("it names no pieces").with_context(place)?;
        series.read(member)
    }

    fn read(&self, member: &Member) -> anyhow::Result<Loaded> {
        let options = Options { frame: Frame::Only, survey: false, ..self.options };
        let mut whole: Option<Loaded> = None;
        for file in &member.files {
            let name = file.display().to_string();
            let what = if self.framed { "file" } else { "piece" };
            ensure!(
                file.exists(),
                "{}: its {what} {name} is missing; put it there, or take its line out of the list",
                self.path.display()
            );
            let (particles, about) = match lists(file)? {
                None => opened(file, options, |frames| frames.raw())?,
                Some(false) if self.framed => Series::of_pieces(file, options)?,
                Some(_) => bail!("{name} is a list of files itself; name the files in it"),
            };
            match &mut whole {
                Some((all, first)) => {
                    ensure!(
                        about.declared.is_none() || about.declared == first.declared,
                        "{name}: its box is not that of the frame's first file; give --box"
                    );
                    all.append(particles, &name)?;
                }
                None => whole = Some((particles, about)),
            }
        }
        let (particles, about) = whole.context("a frame of no files")?;
        let time = member.time.or(about.time);
        let file = match &member.files[..] {
            [file] if self.framed => Some(file.display().to_string()),
            _ => None,
        };
        Ok((particles, About { time, file, ..about }))
    }
}

impl Reader<Loaded> for Series {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<Loaded>> {
        if self.next == 0 && self.framed {
            // Files before the wanted one are not opened.
            self.next = choice.first_of(self.members.len());
        }
        while let Some(member) = self.members.get(self.next) {
            let index = self.next as u64;
            let place = || member.files[0].display().to_string();
            let step = if self.framed { choice.begin_at(index, place)? } else { Step::Keep };
            if step == Step::Stop {
                return Ok(None);
            }
            let read = (step == Step::Keep).then(|| self.read(member)).transpose()?;
            self.next += 1;
            if let Some((mut particles, about)) = read {
                particles.notices.extend(self.notice.clone());
                return Ok(Some((particles, about)));
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
            ("run_*.vtp", "run_1.vtp.gz", false),
            ("**", "ab", true),
            ("a", "ab", false),
        ] {
            assert_eq!(matches(pattern.as_bytes(), name.as_bytes()), fits, "{pattern} {name}");
        }
    }
}
