//! Periodic boxes: the box that a file declares, the options that change it, and the notices about
//! it.
//!
//! Particles from a file with a periodic box carry a [`Lattice`]. [`Particles::scene`] refuses to
//! treat them as open unless the options allow it.
//!
//! [`Particles::scene`]: crate::Particles::scene

use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use crate::raw::lines::{Lines, number, shown};
use crate::types::{Declared, Notice, assumed};
use contactbench_ground::scene::Lattice;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns the vectors of a box from 2 to 9 numbers. 2 or 3 numbers are edges along the axes; 6 are
/// edges and the tilt of LAMMPS; 4 or 9 are whole vectors.
pub fn vectors(numbers: &[f64]) -> Option<[[f64; 3]; 3]> {
    Some(match *numbers {
        [x, y] => [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0; 3]],
        [x, y, z] => [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
        [ax, ay, bx, by] => [[ax, ay, 0.0], [bx, by, 0.0], [0.0; 3]],
        [x, y, z, xy, xz, yz] => [[x, 0.0, 0.0], [xy, y, 0.0], [xz, yz, z]],
        [ax, ay, az, bx, by, bz, cx, cy, cz] => [[ax, ay, az], [bx, by, bz], [cx, cy, cz]],
        _ => return None,
    })
}

/// Parses a bound of the box in cell `k` of the current line.
pub fn bound(cell: &[u8], k: usize, lines: &Lines<'_>) -> anyhow::Result<f64> {
    number(cell).filter(|x| x.is_finite()).with_context(|| {
        let (place, column) = (lines.place(), k + 1);
        format!("{place}: column {column}: '{}' is not a finite bound of the box", shown(cell))
    })
}

pub fn in_order(ranges: &[[f64; 2]], boundaries: Boundaries) -> anyhow::Result<()> {
    for [low, high] in ranges {
        let sound = low <= high || boundaries.replace_box();
        ensure!(sound, "the box goes from {low} to {high}; fix it, or give --box or --open");
    }
    Ok(())
}

impl Declared {
    /// Builds a box between two bounds along each axis. Axes without bounds have length 0.
    pub fn between(ranges: &[[f64; 2]], periodic: Option<[bool; 3]>) -> Declared {
        let mut declared =
            Declared { periodic, ranges: Some(ranges.to_vec()), ..Declared::default() };
        let mut vectors = [[0.0; 3]; 3];
        for (k, &[low, high]) in ranges.iter().take(3).enumerate() {
            declared.origin[k] = low;
            vectors[k][k] = minus(high, low, &mut declared.rounded);
        }
        declared.vectors = Some(vectors);
        declared
    }

    pub fn tilted(mut self, [xy, xz, yz]: [f64; 3]) -> Declared {
        if let Some([_, b, c]) = &mut self.vectors {
            (b[0], c[0], c[1]) = (xy, xz, yz);
        }
        self.ranges = None;
        self
    }

    pub(crate) fn enclosed(
        ranges: [[f64; 2]; 3],
        tilt: [f64; 3],
        periodic: Option<[bool; 3]>,
        boundaries: Boundaries,
    ) -> anyhow::Result<Declared> {
        in_order(&ranges, boundaries)?;
        let [xy, xz, yz] = tilt;
        let mut rounded = false;
        // LAMMPS rounds this sum, too, but its numbers may have more digits than the file.
        let both = minus(xy, -xz, &mut rounded);
        let least = [xy, xz, both].into_iter().fold(0.0, f64::min);
        let most = [xy, xz, both].into_iter().fold(0.0, f64::max);
        let [x, y, z] = ranges;
        let x = [minus(x[0], least, &mut rounded), minus(x[1], most, &mut rounded)];
        let y = [minus(y[0], yz.min(0.0), &mut rounded), minus(y[1], yz.max(0.0), &mut rounded)];
        in_order(&[x, y], boundaries)
            .with_context(|| format!("within its bounds, the tilt {xy} {xz} {yz} is too large"))?;
        let inner = Declared::between(&[x, y, z], periodic);
        let rounded = rounded || inner.rounded;
        Ok(Declared { rounded, ..inner.tilted(tilt) })
    }
}

/// Returns a - b, and sets `rounded` if the difference is not exact.
fn minus(a: f64, b: f64, rounded: &mut bool) -> f64 {
    let difference = a - b;
    let back = a - difference;
    let error = (a - (difference + back)) + (back - b);
    // On overflow the error is NaN, which also sets `rounded`.
    *rounded |= error != 0.0;
    difference
}

/// Vectors of a box from the command line: `LX,LY`, `LX,LY,LZ`, `AX,AY,BX,BY`, `LX,LY,LZ,XY,XZ,YZ`
/// (the tilt of LAMMPS) or all nine numbers, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edges {
    vectors: [[f64; 3]; 3],
    space: bool,
}

impl FromStr for Edges {
    type Err = String;

    fn from_str(text: &str) -> Result<Edges, String> {
        let form = "write LX,LY or LX,LY,LZ, with a tilt LX,LY,LZ,XY,XZ,YZ, or the vectors row by \
                    row, four numbers for discs and nine for spheres";
        let words = text.split([',', ' ']).filter(|word| !word.is_empty());
        let finite = |word: &str| number(word.as_bytes()).filter(|x| x.is_finite());
        let numbers: Option<Vec<f64>> = words.map(finite).collect();
        let numbers = numbers.ok_or(format!("'{text}' are not finite numbers; {form}"))?;
        let count = numbers.len();
        let vectors = vectors(&numbers).ok_or(format!("{count} numbers are not a box; {form}"))?;
        let space = !matches!(count, 2 | 4);
        // Lengths of edges must not be negative; components of vectors may be.
        let edges = if matches!(count, 4 | 9) { 0 } else { count.min(3) };
        if let Some(edge) = numbers[..edges].iter().find(|edge| **edge < 0.0) {
            return Err(format!("an edge of {edge} is negative; {form}"));
        }
        Ok(Edges { vectors, space })
    }
}

impl std::fmt::Display for Axes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let axes = match self {
            Axes::All => return f.write_str("true"),
            Axes::These([false, false, false]) => return f.write_str("none"),
            Axes::These(axes) => AXES.into_iter().zip(*axes),
        };
        axes.filter(|(_, yes)| *yes).try_for_each(|(axis, _)| f.write_str(axis))
    }
}

/// Periodic axes or box vectors: `xyz`, `xy`, `z` or `none`; `true` stands for all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    All,
    These([bool; 3]),
}

impl Axes {
    pub const NONE: Axes = Axes::These([false; 3]);

    pub fn of(self, dim: usize) -> [bool; 3] {
        match self {
            Axes::All => [true, true, dim == 3],
            Axes::These(axes) => axes,
        }
    }
}

impl FromStr for Axes {
    type Err = String;

    fn from_str(text: &str) -> Result<Axes, String> {
        match text {
            "true" => return Ok(Axes::All),
            "none" | "false" => return Ok(Axes::NONE),
            _ => {}
        }
        let counts = AXES.map(|axis| text.matches(axis).count());
        let once = counts.iter().all(|count| *count <= 1);
        if !once || text.is_empty() || counts.iter().sum::<usize>() < text.len() {
            return Err("it must be the axes along which the box repeats, as in x, xy or xyz; \
                        or true for all, none or false for no axis"
                .into());
        }
        Ok(Axes::These(counts.map(|count| count == 1)))
    }
}

pub fn along(axes: [bool; 3]) -> String {
    let names = ["no axis", "x", "y", "x and y", "z", "x and z", "y and z", "x, y and z"];
    names[(0..3).map(|k| usize::from(axes[k]) << k).sum::<usize>()].into()
}

/// Refuses images across axes along which the box does not repeat.
pub fn hold(axes: [bool; 3], images: Option<&[[i32; 3]]>) -> anyhow::Result<()> {
    let open = |image: &[i32; 3]| (0..3).any(|k| image[k] != 0 && !axes[k]);
    let images = images.unwrap_or_default();
    if let Some(k) = images.iter().position(open) {
        let (image, axes) = (images[k].map(|s| s.to_string()).join(","), along(axes));
        bail!(
            "pair {k} (from 0) names the image {image}; the box repeats along {axes}: --periodic"
        );
    }
    Ok(())
}

/// Tolerance of the test whether a particle is outside the box, relative to a box vector, because
/// the corner and the relative coordinates are rounded.
const OUT: f64 = 1e-9;

pub fn outside(points: impl Iterator<Item = [f64; 3]>, lattice: &Lattice) -> Vec<usize> {
    let is_outside = |point: [f64; 3]| {
        (0..3).filter(|&vector| lattice.periodic()[vector]).any(|vector| {
            let (dual, origin) = (lattice.dual(vector), lattice.origin());
            let at: f64 = (0..3).map(|k| dual[k] * (point[k] - origin[k])).sum();
            !(-OUT..=1.0 + OUT).contains(&at)
        })
    };
    points.enumerate().filter(|(_, point)| is_outside(*point)).map(|(k, _)| k).collect()
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Boundaries {
    pub edges: Option<Edges>,
    pub periodic: Option<Axes>,
    /// Whether all boundaries are open, even if the file declares a periodic box.
    pub open: bool,
}

impl Boundaries {
    pub const AS_DECLARED: Boundaries = Boundaries { edges: None, periodic: None, open: false };

    /// Whether the options decide which axes are periodic, so that the file need not.
    pub(crate) fn overrule(&self) -> bool {
        self.open || self.periodic.is_some()
    }

    /// Whether a box is declared, but neither file nor options state which axes are periodic.
    pub fn unknown(&self, declared: Option<&Declared>) -> bool {
        let silent = |of: &Declared| of.vectors.is_some() && of.periodic.is_none();
        *self == Boundaries::AS_DECLARED && declared.is_some_and(silent)
    }

    pub fn check(&self) -> anyhow::Result<()> {
        let (boxed, periodic) = (self.edges.is_some(), self.periodic.is_some());
        for (both, a, b) in [
            (self.open && boxed, "--open", "--box"),
            (self.open && periodic, "--open", "--periodic"),
            (boxed && self.periodic == Some(Axes::NONE), "--periodic none", "--box"),
        ] {
            ensure!(!both, "{a} cannot be used with {b}; leave one out");
        }
        Ok(())
    }

    /// Whether the box in the file does not matter.
    pub fn replace_box(&self) -> bool {
        self.open || self.edges.is_some()
    }

    /// Returns the box of the particles, or `None` if it is not periodic; adds notices about
    /// assumptions.
    pub fn lattice(
        &self,
        name: &str,
        dim: usize,
        declared: Option<&Declared>,
        notices: &mut Vec<Notice>,
    ) -> anyhow::Result<Option<Lattice>> {
        self.check()?;
        let periodic = self.axes(dim, declared).with_context(|| name.to_string())?;
        if !periodic.contains(&true) {
            return Ok(None);
        }
        let vectors = declared.and_then(|declared| declared.vectors);
        let vectors = self.edges.map(|edges| edges.vectors).or(vectors).with_context(|| {
            let axes = along(periodic);
            format!("{name} repeats along {axes}, and has no box; give --box LX,LY,LZ, or --open")
        })?;
        if let Some(k) = (0..3).find(|&k| periodic[k] && vectors[k] == [0.0; 3]) {
            let axis = AXES[k];
            bail!("{name}: the box repeats along {axis}, and has no length there {OPTIONS}");
        }
        if self.edges.is_none() && declared.is_some_and(|declared| declared.rounded) {
            notices.push(assumed!(
                "the box vectors are rounded differences of bounds; --box gives all digits"
            ));
        }
        let origin = declared.map_or([0.0; 3], |declared| declared.origin);
        Lattice::new(vectors, periodic, origin)
            .and_then(|lattice| if dim == 2 { lattice.flat() } else { Ok(lattice) })
            .map(Some)
            .map_err(|error| anyhow::anyhow!("{name}: {error} {OPTIONS}"))
    }

    /// Returns the periodic axes, by the options or else by the file.
    fn axes(&self, dim: usize, declared: Option<&Declared>) -> anyhow::Result<[bool; 3]> {
        let of_discs = |axes: [bool; 3]| [axes[0], axes[1], axes[2] && dim == 3];
        let flags = declared.and_then(|declared| declared.periodic).map(of_discs);
        let axes = match (self.periodic, self.edges) {
            _ if self.open => [false; 3],
            (Some(axes), _) => axes.of(dim),
            (None, Some(edges)) => flags.unwrap_or(of_discs([true, true, edges.space])),
            (None, None) => flags.unwrap_or_default(),
        };
        ensure!(axes == of_discs(axes), "discs repeat along x and y; leave z out of --periodic");
        ensure!(
            self.open || self.edges.is_none() || axes.contains(&true),
            "the file declares its box open; give the axes of --box: --periodic xyz"
        );
        Ok(axes)
    }
}

const OPTIONS: &str = "(fix it, or give --box, --periodic or --open)";
