//! Text files and the expected result of reading them: `*.txt` in this folder.
//!
//! A line `>>> ENDING` starts a file. `>>> list` starts a contact list, `>>> any` a file that is
//! read with several endings and as a list, and `>>> file NAME` names a file in tests/data. A line
//! `<<< NAME=VALUE ...` reads the file with these options. The lines after it are the expected
//! result:
//!
//! | line | content |
//! |---|---|
//! | `= FORMAT SOURCE:` | source of the radii; of each particle `#id`, coordinates, radius |
//! | `@` | frame, step and time, unless it is frame 0 without these |
//! | `+` or `-` | a periodic or other box: vectors, flags, corner |
//! | `~` | parts of a notice, separated by … |
//! | `!` | parts of the error, separated by … |
//!
//! In a file, `\t`, `\r`, `\0`, `\\` and `\xff` stand for bytes; `\` at the end of a line removes
//! the line feed. A line `% <f8 (2,) 1 2` is an npy array, in Fortran order if its type ends in F.
//! Lines `%NAME <f8 (2,) 1 2` are arrays of an archive. Each file is read a second time, compressed
//! with gzip.

use std::fmt::Write;

use super::*;
use crate::formats::unread;
use crate::pairs;

macro_rules! files {
    ($($name:literal),*) => { [$(($name, include_str!(concat!($name, ".txt")))),*] };
}
const FILES: [(&str, &str); 14] = files![
    "arrays", "boxes", "codes", "columns", "formats", "frames", "lists", "poscar", "programs",
    "refused", "tables", "unread", "vtk", "xyz"
];

fn number(kind: &str, x: f64) -> Vec<u8> {
    let mut bytes = match kind.split_at(1).1 {
        "f4" => (x as f32).to_le_bytes().to_vec(),
        "f8" => x.to_le_bytes().to_vec(),
        kind => (x as i64).to_le_bytes()[..kind[1..].parse().unwrap()].to_vec(),
    };
    if kind.starts_with('>') {
        bytes.reverse();
    }
    bytes
}

fn array(line: &str) -> Option<(&str, Vec<u8>)> {
    let (name, rest) = line.strip_prefix('%')?.split_once(' ')?;
    let (kind, rest) = rest.split_once(" (")?;
    let (shape, numbers) = rest.split_once(')')?;
    let fortran = if kind.ends_with('F') { "True" } else { "False" };
    let kind = kind.trim_end_matches('F');
    let words = numbers.split_whitespace().map(|word| word.parse().unwrap());
    let data: Vec<u8> = words.flat_map(|x| number(kind, x)).collect();
    Some((name, npy_file(kind, fortran, &format!("({shape})"), &data)))
}

fn archive(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = Vec::new();
    for (name, file) in files {
        let (size, length) = ((file.len() as u32).to_le_bytes(), name.len() as u16 + 4);
        archive.extend([b"PK\x03\x04", &[0; 14][..], &size, &size].concat());
        archive.extend([&length.to_le_bytes(), &[0, 0], name.as_bytes(), b".npy", file].concat());
    }
    [&archive, &b"PK\x05\x06"[..], &[0; 18]].concat()
}

fn bytes(lines: &[&str]) -> Vec<u8> {
    let arrays: Vec<(&str, Vec<u8>)> = lines.iter().filter_map(|line| array(line)).collect();
    match &arrays[..] {
        [] => {}
        [("", array)] => return array.clone(),
        files => return archive(files),
    }
    let mut bytes = Vec::new();
    for line in lines {
        let mut rest = line.bytes();
        let mut ended = true;
        while let Some(byte) = rest.next() {
            let escape = if byte == b'\\' { rest.next() } else { None };
            match (byte, escape) {
                (b'\\', None) => ended = false,
                (_, Some(b'x')) => {
                    let digits: String = rest.by_ref().take(2).map(char::from).collect();
                    bytes.push(u8::from_str_radix(&digits, 16).unwrap());
                }
                (_, Some(letter)) => {
                    let of = |(from, to): (u8, u8)| (from == letter).then_some(to);
                    let all = [(b't', b'\t'), (b'r', b'\r'), (b'0', 0), (b'\\', b'\\')];
                    bytes.push(all.into_iter().find_map(of).unwrap());
                }
                _ => bytes.push(byte),
            }
        }
        bytes.extend(ended.then_some(b'\n'));
    }
    bytes
}

fn options(text: &str) -> Result<(Options, Vec<&str>), String> {
    let (mut options, mut columns) = (NONE, Vec::new());
    for word in text.split_whitespace() {
        let (name, value) = word.split_once('=').unwrap_or((word, "true"));
        match name {
            "ids" => options.ids = true,
            "pairs-columns" => columns = value.split(',').collect(),
            _ => {
                let option = OPTIONS.iter().find(|option| option.name == name).expect(word);
                option.set(&mut options, value)?;
            }
        }
    }
    Ok((options, columns))
}

fn numbers(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn notices(notices: &[Notice], out: &mut String) {
    notices.iter().for_each(|it| writeln!(out, "~ {it}").unwrap());
}

fn frame(particles: Particles, about: &About, options: Options, out: &mut String) {
    if (about.frame, about.step, about.time) != (0, None, None) {
        let About { frame, step, time, .. } = about;
        writeln!(out, "@ {frame} {step:?} {time:?}").unwrap();
    }
    if let Some(lattice) = &particles.lattice {
        let (vectors, periodic) = (lattice.vectors().map(|it| numbers(&it)), lattice.periodic());
        let flags = periodic.map(|yes| if yes { 'T' } else { 'F' });
        let flags: String = flags.into_iter().collect();
        let corner = numbers(&lattice.origin());
        writeln!(out, "+ {}, {flags}, {corner}", vectors.join(" / ")).unwrap();
    } else if let Some(Declared { vectors, periodic, .. }) = &about.declared {
        let vectors = vectors.map(|it| it.map(|it| numbers(&it)).join(" / "));
        writeln!(out, "- {} {periodic:?}", vectors.unwrap_or_default()).unwrap();
    }
    notices(&particles.notices, out);
    let row = |k: usize| {
        let id = particles.ids.as_ref().map(|ids| format!("#{} ", ids[k])).unwrap_or_default();
        let radius = particles.radii.as_ref().map_or(options.radius, |radii| Some(radii[k]));
        let centre = particles.centre(k)[..particles.dim()].to_vec();
        id + &numbers(&centre.into_iter().chain(radius).collect::<Vec<_>>())
    };
    let source = match &about.radius {
        RadiusSource::Column(name) => format!("r {name}"),
        RadiusSource::Halved(name) => format!("d {name}"),
        RadiusSource::Given => "given".into(),
        RadiusSource::Missing => "none".into(),
    };
    let rows: Vec<String> = (0..particles.len()).map(row).collect();
    writeln!(out, "= {} {source}: {}", about.format, rows.join(" | ")).unwrap();
    if let Err(error) = particles.given("p", options.radius) {
        writeln!(out, "! {error:#}").unwrap();
    }
}

fn particles(bytes: &[u8], ending: &str, options: Options) -> String {
    let mut out = String::new();
    let read = if options.frame == FrameChoice::All {
        frames_from(bytes, "p", ending, options, |frames| {
            for next in frames {
                let (particles, about) = next?;
                frame(particles, &about, options, &mut out);
            }
            Ok(())
        })
    } else {
        load_from(bytes, "p", ending, options)
            .map(|(particles, about)| frame(particles, &about, options, &mut out))
    };
    read.unwrap_or_else(|error| writeln!(out, "! {error:#}").unwrap());
    out
}

fn lists(bytes: &[u8], columns: &[&str], frame: FrameChoice) -> String {
    let mut out = String::new();
    let list = |list: pairs::List, out: &mut String| {
        if list.frame.is_some() {
            writeln!(out, "@ {:?} {:?}", list.frame, list.step).unwrap();
        }
        notices(&list.notices, out);
        let images = list.images.as_deref();
        let row = |(k, [i, j]): (usize, &[i64; 2])| match images.map(|images| images[k]) {
            None => format!("{i} {j}"),
            Some([x, y, z]) => format!("{i} {j} ({x} {y} {z})"),
        };
        let rows: Vec<String> = list.pairs.iter().enumerate().map(row).collect();
        writeln!(out, "= {}: {}", list.format, rows.join(" | ")).unwrap();
    };
    let read = pairs::lists_from(bytes, "p", columns, frame, |lists| {
        if frame != FrameChoice::All {
            return lists.chosen().map(|it| list(it, &mut out));
        }
        for next in lists {
            list(next?, &mut out);
        }
        Ok(())
    });
    read.unwrap_or_else(|error| writeln!(out, "! {error:#}").unwrap());
    out
}

fn outcome(bytes: &[u8], ending: &str, text: &str) -> String {
    match options(text) {
        Err(why) => format!("! {why}\n"),
        Ok((options, columns)) if ending == "list" => lists(bytes, &columns, options.frame),
        Ok((options, _)) if ending == "any" => {
            let mut all = ["", "csv", "xyz", "dump", "dat"].map(|it| particles(bytes, it, options));
            let list = [lists(bytes, &[], options.frame)];
            all.sort_unstable();
            let mut all: Vec<String> = all.into_iter().chain(list).collect();
            all.dedup();
            all.concat()
        }
        Ok((options, _)) => particles(bytes, ending, options),
    }
}

/// Whether a line is as expected; parts of notices and errors are separated by `…`.
fn says(line: &str, expected: &str) -> bool {
    let mut rest = line.split_at(1).1;
    match expected.split_at(1) {
        (sign @ ("~" | "!"), words) if line.starts_with(sign) => words.split('…').all(|words| {
            let at = rest.find(words.trim());
            rest = &rest[at.unwrap_or_default()..];
            at.is_some()
        }),
        _ => line == expected,
    }
}

#[test]
fn files_of_text_give_particles_lists_or_words() {
    let (mut count, mut wrong) = (0, String::new());
    for (file, text) in FILES {
        for case in text.split("\n>>> ").skip(1) {
            let mut reads = case.split("\n<<<");
            let mut lines = reads.next().unwrap().split('\n');
            let ending = lines.next().unwrap().trim();
            let bytes = match ending.strip_prefix("file ") {
                Some(name) => data(name),
                None => bytes(&lines.collect::<Vec<_>>()),
            };
            for read in reads {
                let (options, expected) = read.split_once('\n').unwrap();
                let is_said = |line: &&str| line.starts_with(['=', '@', '+', '-', '~', '!']);
                let expected: Vec<&str> = expected.lines().filter(is_said).collect();
                let found = outcome(&bytes, ending, options);
                let lines: Vec<&str> = found.lines().collect();
                let is_plain = |line: &&str| !line.contains(char::is_control);
                assert!(lines.iter().all(is_plain), "{found:?}");
                if !found.contains("! ") {
                    assert_eq!(outcome(&packed(&bytes), ending, options), found, "in gzip");
                }
                let said = || lines.iter().zip(&expected).all(|(line, words)| says(line, words));
                if lines.len() != expected.len() || !said() {
                    writeln!(wrong, "{file}: {case}\n--- {options}: {found}").unwrap();
                }
                count += 1;
            }
        }
    }
    assert!(wrong.is_empty() && count > 550, "{count} cases; wrong are\n{wrong}");
}

/// Rows of numbers and words are not taken for a format that is not read.
#[test]
fn texts_are_not_taken_for_unread_formats() {
    for text in ["x,y,z,r\n1,2,3,4\n", "2\ncomment\nC 0 0 0\n", "[1] x y\n", "# x y\n", "plain\n"] {
        assert!(unread::refuse(text.as_bytes(), "p").is_ok(), "{text}");
    }
}
