//! Boxes of files: what a file says of its box, what the options make of it, and what is left to
//! say.
//!
//! A file with a box that repeats is no open scene: its particles carry a [`Lattice`], and whoever
//! takes them for open without being told so is refused ([`Particles::scene`]).
//!
//! [`Particles::scene`]: crate::Particles::scene

use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use crate::Notice;
use crate::lines::{Lines, number, shown};
use contactbench_core::scene::Lattice;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Declared {
    /// Its vectors, one per row; none where the file says only that it repeats.
    pub vectors: Option<[[f64; 3]; 3]>,
    /// The corner from which they start.
    pub origin: [f64; 3],
    /// Along which of them the file says that it repeats; none where it does not say.
    pub periodic: Option<[bool; 3]>,
    /// The vectors are differences of what stands in the file, and were rounded.
    pub rounded: bool,
    /// Least and largest coordinate along each axis, if the edges of the box lie along the axes and
    /// the file states these coordinates.
    pub ranges: Option<Vec<[f64; 2]>>,
}

/// Returns the vectors of a box, by how many numbers there are: two or three edges along the axes,
/// three and the tilt of LAMMPS, or two or three vectors, one after the other.
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

/// The number in cell `k` of a line, which is a bound of the box.
pub fn bound(cell: &[u8], k: usize, lines: &Lines<'_>) -> anyhow::Result<f64> {
    number(cell).filter(|x| x.is_finite()).with_context(|| {
        format!(
            "{}: column {}: '{}' is not a finite number; a bound of the box is expected",
            lines.place(),
            k + 1,
            shown(cell)
        )
    })
}

/// Refuses bounds whose upper one is below the lower.
pub fn in_order(ranges: &[[f64; 2]], boundaries: Boundaries) -> anyhow::Result<()> {
    if boundaries.open || boundaries.edges.is_some() {
        return Ok(());
    }
    for ([low, high], axis) in ranges.iter().zip(["x", "y", "z"]) {
        ensure!(
            low <= high,
            "along {axis} the box goes from {low} to {high}; the lower bound stands first: mend \
             the file, or give --box or --open"
        );
    }
    Ok(())
}

impl Declared {
    /// A box between two bounds along each axis; axes without bounds have no length.
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

    /// The same box, sheared as LAMMPS says it, by xy, xz and yz.
    pub fn tilted(mut self, [xy, xz, yz]: [f64; 3]) -> Declared {
        if let Some([_, b, c]) = &mut self.vectors {
            (b[0], c[0], c[1]) = (xy, xz, yz);
        }
        self.ranges = None;
        self
    }

    /// A sheared box between the bounds of the box along the axes that encloses it, as in dumps of
    /// LAMMPS.
    pub(crate) fn enclosed(
        ranges: [[f64; 2]; 3],
        tilt: [f64; 3],
        periodic: Option<[bool; 3]>,
        boundaries: Boundaries,
    ) -> anyhow::Result<Declared> {
        in_order(&ranges, boundaries)?;
        let [xy, xz, yz] = tilt;
        let mut rounded = false;
        // xy + xz is rounded by LAMMPS, too, but nobody knows whether from the same numbers.
        let both = minus(xy, -xz, &mut rounded);
        let least = [xy, xz, both].into_iter().fold(0.0, f64::min);
        let most = [xy, xz, both].into_iter().fold(0.0, f64::max);
        let [x, y, z] = ranges;
        let x = [minus(x[0], least, &mut rounded), minus(x[1], most, &mut rounded)];
        let y = [minus(y[0], yz.min(0.0), &mut rounded), minus(y[1], yz.max(0.0), &mut rounded)];
        ensure!(
            in_order(&[x, y, z], boundaries).is_ok(),
            "the tilt {xy} {xz} {yz} is larger than the bounds, which are those of the box around \
             the tilted one: along {} nothing is left; mend the file, or give --box or --open",
            if x[0] > x[1] { "x" } else { "y" }
        );
        let inner = Declared::between(&[x, y, z], periodic);
        let rounded = rounded || inner.rounded;
        Ok(Declared { rounded, ..inner.tilted(tilt) })
    }
}

/// The difference; notes whether it was rounded.
fn minus(a: f64, b: f64, rounded: &mut bool) -> f64 {
    let difference = a - b;
    let back = a - difference;
    let error = (a - (difference + back)) + (back - b);
    // Also where it overflows, and the error is NaN.
    *rounded |= error != 0.0;
    difference
}

/// Vectors of a box as they are written on the command line: `LX,LY`, `LX,LY,LZ`,
/// `AX,AY,BX,BY`, `LX,LY,LZ,XY,XZ,YZ` (the tilt as in LAMMPS) or all nine numbers, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edges {
    vectors: [[f64; 3]; 3],
    /// The third vector is there.
    space: bool,
}

impl FromStr for Edges {
    type Err = String;

    fn from_str(text: &str) -> Result<Edges, String> {
        let form = "write LX,LY or LX,LY,LZ, with a tilt LX,LY,LZ,XY,XZ,YZ, or the vectors row by \
                    row, four numbers for discs and nine for spheres";
        let mut numbers = Vec::new();
        for word in text.split([',', ' ']).filter(|word| !word.is_empty()) {
            match number(word.as_bytes()).filter(|x| x.is_finite()) {
                Some(value) => numbers.push(value),
                None => return Err(format!("'{word}' is not a finite number; {form}")),
            }
        }
        let count = numbers.len();
        let vectors = vectors(&numbers).ok_or_else(|| match count {
            1 => format!("1 number is no box; {form}"),
            _ => format!("{count} numbers are no box; {form}"),
        })?;
        let space = !matches!(count, 2 | 4);
        // Vectors may point anywhere; edges along the axes have lengths.
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
            Axes::These(axes) => ["x", "y", "z"].into_iter().zip(*axes),
        };
        axes.filter(|(_, yes)| *yes).try_for_each(|(axis, _)| f.write_str(axis))
    }
}

/// Along which axes, or vectors, a box repeats: `xyz`, `xy`, `z`, `none`; or `true`, along all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// All that there are, in the dimension of the particles.
    All,
    These([bool; 3]),
}

impl Axes {
    pub const NONE: Axes = Axes::These([false; 3]);

    /// The axes for particles of so many dimensions.
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
        let counts = ["x", "y", "z"].map(|axis| text.matches(axis).count());
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

/// Refuses a list that names images along an axis that is open.
pub fn hold(axes: [bool; 3], images: Option<&[[i32; 3]]>) -> anyhow::Result<()> {
    let open = |image: &[i32; 3]| (0..3).any(|k| image[k] != 0 && !axes[k]);
    let images = images.unwrap_or_default();
    if let Some(k) = images.iter().position(open) {
        bail!(
            "pair {k} of the list (from 0) names the image {}, and the box repeats along {}; give \
             --periodic with all axes along which it repeats",
            images[k].map(|s| s.to_string()).join(","),
            along(axes)
        );
    }
    Ok(())
}

/// A particle is outside the box where it is farther out than this part of a vector: the corner
/// and the coordinates in units of the vectors are rounded.
const OUT: f64 = 1e-9;

/// The places in a list of the points that are beyond a face at which the box repeats.
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
    /// The vectors of the box, instead of the file's.
    pub edges: Option<Edges>,
    /// Along which of them it repeats, whatever the file says.
    pub periodic: Option<Axes>,
    /// Boundaries are open, whatever the file says.
    pub open: bool,
}

impl Boundaries {
    pub const AS_DECLARED: Boundaries = Boundaries { edges: None, periodic: None, open: false };

    /// Nobody asks along which axes the file's box repeats.
    pub(crate) fn overrule(&self) -> bool {
        self.open || self.periodic.is_some()
    }

    /// Is a box declared of which nobody says whether it repeats?
    pub fn unknown(&self, declared: Option<&Declared>) -> bool {
        let silent = |of: &Declared| of.vectors.is_some() && of.periodic.is_none();
        *self == Boundaries::AS_DECLARED && declared.is_some_and(silent)
    }

    /// The box that the file declares, repeating as the file says or else along all vectors, where
    /// these boundaries leave it out.
    pub fn left_out(&self, dim: usize, declared: Option<&Declared>) -> Option<Lattice> {
        let declared = declared.filter(|_| self.edges.is_none())?;
        let flags = declared.periodic.filter(|flags| flags.contains(&true)).unwrap_or([true; 3]);
        let periodic = [flags[0], flags[1], flags[2] && dim == 3];
        let lattice = Lattice::new(declared.vectors?, periodic, declared.origin).ok()?;
        if dim == 2 { lattice.flat().ok() } else { Some(lattice) }
    }

    pub fn check(&self) -> anyhow::Result<()> {
        let given = [(self.edges.is_some(), "--box"), (self.periodic.is_some(), "--periodic")];
        if let Some((_, name)) = given.iter().find(|(given, _)| self.open && *given) {
            bail!("--open takes boundaries as open, and {name} says otherwise; leave one out");
        }
        let none = self.periodic == Some(Axes::NONE);
        ensure!(
            !(none && self.edges.is_some()),
            "--periodic none takes boundaries as open, and --box says otherwise; leave one out"
        );
        Ok(())
    }

    /// The box of a file's particles; none where it does not repeat. What is worth saying is added
    /// to `notices`.
    pub fn lattice(
        &self,
        name: &str,
        dim: usize,
        declared: Option<&Declared>,
        notices: &mut Vec<Notice>,
    ) -> anyhow::Result<Option<Lattice>> {
        self.check()?;
        let of_discs = |axes: [bool; 3]| [axes[0], axes[1], axes[2] && dim == 3];
        let flags = declared.and_then(|declared| declared.periodic).map(of_discs);
        let repeats = flags.filter(|flags| flags.contains(&true));
        let vectors = declared.and_then(|declared| declared.vectors);
        let periodic = match (self.periodic, self.edges, flags) {
            _ if self.open => [false; 3],
            (Some(axes), ..) => {
                let axes = axes.of(dim);
                ensure!(
                    axes == of_discs(axes),
                    "{name} holds discs, whose box repeats along x and y at most; leave z out of \
                     --periodic"
                );
                axes
            }
            (None, Some(_), Some(flags)) => {
                ensure!(
                    repeats.is_some(),
                    "{name} says that its box is open along all axes; say with --periodic along \
                     which that of --box repeats, as in --periodic xyz"
                );
                flags
            }
            (None, Some(edges), None) => of_discs([true, true, edges.space]),
            (None, None, Some(flags)) => flags,
            (None, None, None) => [false; 3],
        };
        if !periodic.contains(&true) {
            return Ok(None);
        }
        let Some(vectors) = self.edges.map(|edges| edges.vectors).or(vectors) else {
            let what = match self.periodic {
                Some(_) => format!("--periodic needs a box, and {name} declares none"),
                None => {
                    format!("{name} says that it repeats along {}, but not the box's vectors", {
                        along(periodic)
                    })
                }
            };
            bail!("{what}; give --box LX,LY,LZ, or --open");
        };
        if let Some(k) = (0..3).find(|&k| periodic[k] && vectors[k] == [0.0; 3]) {
            bail!(
                "{name}: the box has no length along {}, and cannot repeat there: mend it, or make \
                 that axis open (--box, --periodic, --open)",
                ["x", "y", "z"][k]
            );
        }
        let origin = declared.map_or([0.0; 3], |declared| declared.origin);
        let lattice = Lattice::new(vectors, periodic, origin)
            .and_then(|lattice| if dim == 2 { lattice.flat() } else { Ok(lattice) });
        if self.edges.is_none() && declared.is_some_and(|declared| declared.rounded) {
            notices.push(Notice::Assumed(
                "the vectors of the box are differences of its bounds, and rounded; --box gives \
                 them to the last digit"
                    .into(),
            ));
        }
        match lattice {
            Ok(lattice) => Ok(Some(lattice)),
            Err(error) => bail!("{name}: {error} (--box, --periodic, --open)"),
        }
    }
}
