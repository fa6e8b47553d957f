//! POSCAR and CONTCAR of VASP: a title, a scale factor, three box vectors, the species and their
//! numbers, `Direct` or `Cartesian`, and a line per particle.
//!
//! * The scale factor multiplies vectors and Cartesian coordinates. A negative one is the volume of
//!   the box; three factors belong to x, y and z.
//! * Direct coordinates are fractions of the vectors. The box is periodic along all of them.
//! * Lines behind the particles, such as velocities, are not read, with a notice.
//!
//! Format: <https://www.vasp.at/wiki/index.php/POSCAR>.

use anyhow::{Context, ensure};

use crate::boxes;
use crate::columns::Columns;
use crate::formats::dump::scale_last;
use crate::options::Options;
use crate::particles::Loaded;
use crate::raw::lines::{Lines, Separator, Source, number, shown, texts, words};
use crate::raw::room::numbered;
use crate::types::{About, Declared, assumed};

/// Whether the head of a file has a scale factor, three vectors, numbers of particles and a mode.
pub fn tells(head: &[u8]) -> bool {
    let lines: Vec<&[u8]> = head.split(|&b| b == b'\n').skip(1).take(7).collect();
    let numbers = |k: usize| lines.get(k).map_or(0, |line| words(line).map_while(number).count());
    let counts = if numbers(4) > 0 { 4 } else { 5 };
    let mode = lines.get(counts + 1).and_then(|line| line.trim_ascii().first());
    matches!(numbers(0), 1 | 3)
        && (1..4).all(|k| numbers(k) == 3)
        && numbers(counts) > 0
        && mode.is_some_and(|letter| b"sSdDcCkK".contains(letter))
}

const ROWS: &str = "particles that it announces; complete it";

pub fn read(source: Source<'_>, options: Options) -> anyhow::Result<Loaded> {
    let mut lines = Lines::new(source);
    lines.advance()?;
    let (vectors, scale) = cell(&mut lines)?;
    let (names, counts) = species(&mut lines)?;
    let direct = is_direct(&mut lines)?;
    let mut rows = Columns::of("x y z species").rows(&lines.place(), options)?;
    let of_box = |vectors| Declared { vectors, ..Declared::default() };
    let declared = Declared { periodic: Some([true; 3]), ..of_box(Some(vectors)) };
    let axes = of_box(boxes::vectors(&scale));
    let n = counts.iter().sum();
    for (name, count) in names.iter().zip(counts) {
        for _ in 0..count {
            lines.row(rows.particles.len() as u64, n, ROWS)?;
            let cells = Separator::Blanks.cells(lines.line()).take(3).chain([name.as_bytes()]);
            rows.columns.push(&mut rows.particles, cells, || lines.place())?;
            let basis = if direct { &declared } else { &axes };
            scale_last(basis, &mut rows.particles).with_context(|| lines.place())?;
        }
    }
    let behind = lines.advance_over_blanks()?;
    ensure!(
        !behind || !lines.text().to_ascii_lowercase().contains("configuration"),
        "{lines}: this is an XDATCAR, and one configuration is read; write its frames as POSCAR or XYZ"
    );
    let notices = [
        (direct, "coordinates are fractions of the box: turned into lengths, which are rounded"),
        (scale != [1.0; 3], "the scale factor multiplies all lengths, which are rounded"),
        (behind, "lines behind the particles, such as velocities, are not read"),
    ];
    let notices = notices.into_iter().filter(|(holds, _)| *holds);
    rows.particles.notices.extend(notices.map(|(_, words)| assumed!("{words}")));
    let (particles, about) = rows.read("POSCAR");
    Ok((particles, About { declared: Some(declared), ..about }))
}

/// Returns the box vectors, and the factor of each axis.
fn cell(lines: &mut Lines<'_>) -> anyhow::Result<([[f64; 3]; 3], [f64; 3])> {
    let mut numbers = |least, what| {
        lines.advance()?;
        let numbers: Vec<f64> = words(lines.line()).map_while(number).collect();
        let sound = numbers.len() >= least && numbers.iter().all(|x| x.is_finite());
        ensure!(sound, "{lines}: '{}' is not {what}; fix the line", shown(lines.line()));
        anyhow::Ok(numbers)
    };
    let factors = numbers(1, "a scale factor")?;
    let mut vectors = [[0.0; 3]; 3];
    for vector in &mut vectors {
        vector.copy_from_slice(&numbers(3, "a box vector of three numbers")?[..3]);
    }
    let volume = nalgebra::Matrix3::from(vectors).determinant().abs();
    let scale = match factors[..] {
        [wanted] if wanted < 0.0 => [(-wanted / volume).cbrt(); 3],
        [factor] => [factor; 3],
        [x, y, z] => [x, y, z],
        _ => [0.0; 3],
    };
    let sound = scale.iter().all(|factor| factor.is_finite() && *factor > 0.0);
    let name = lines.source.name;
    ensure!(sound, "{name}:2: the scale must be a factor, a volume below 0, or three factors");
    vectors.iter_mut().flat_map(|it| it.iter_mut().zip(scale)).for_each(|(x, by)| *x *= by);
    Ok((vectors, scale))
}

/// Returns the names of the species and their numbers of particles. VASP 4 writes no names.
fn species(lines: &mut Lines<'_>) -> anyhow::Result<(Vec<String>, Vec<u64>)> {
    lines.advance()?;
    let mut names = texts(lines.line());
    if names.first().is_some_and(|name| number(name.as_bytes()).is_some()) {
        names = (1..=names.len()).map(|k| k.to_string()).collect();
    } else {
        lines.advance()?;
    }
    let cells = words(lines.line()).take(names.len());
    let counts = cells.map(|cell| lines.count(cell, "a number of particles"));
    let counts = counts.collect::<anyhow::Result<Vec<u64>>>()?;
    let fits = !counts.is_empty() && counts.len() == names.len();
    ensure!(fits, "{lines}: each of the {} species needs a number of particles", names.len());
    numbered(counts.iter().sum(), "particles").with_context(|| lines.place())?;
    Ok((names, counts))
}

/// Whether the coordinates are fractions of the box.
fn is_direct(lines: &mut Lines<'_>) -> anyhow::Result<bool> {
    lines.advance()?;
    if lines.line().first().is_some_and(|letter| b"sS".contains(letter)) {
        lines.advance()?;
    }
    let mode = lines.line().first().map(u8::to_ascii_lowercase);
    let sound = matches!(mode, Some(b'd' | b'c' | b'k'));
    ensure!(sound, "{lines}: '{}' is neither Direct nor Cartesian", shown(lines.line()));
    Ok(mode == Some(b'd'))
}
