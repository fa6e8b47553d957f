//! LAMMPS and LIGGGHTS dumps: frames of `ITEM:` sections, columns named by `ITEM: ATOMS`, in any
//! order.
//!
//! * Coordinates are `x y z`, else unwrapped `xu yu zu`, else scaled `xs ys zs` or `xsu ysu zsu`,
//!   which the box bounds turn into lengths: lo + s (hi - lo), rounded three times. Scaled
//!   coordinates of a tilted (triclinic) box are refused.
//! * The size is a column `radius` or `diameter` (or `r`, `d`). Particles keep the order of the
//!   file, whatever their ids are.
//! * Boundaries are open here, whatever the box says.
//!
//! Format: <https://docs.lammps.org/dump.html>.

use anyhow::{Context, bail, ensure};

use crate::io::frames::{Frames, Step};
use crate::io::lines::{Lines, Separator, Source, number, short, shown, words};
use crate::io::particles::{Centres, Column, Columns, Particles, loaded};
use crate::io::{About, Options};

pub(crate) fn read(source: Source<'_>, options: Options) -> anyhow::Result<(Particles, About)> {
    let mut lines = Lines::new(source);
    let mut frames = Frames::new(options);
    let mut result = None;
    let (mut n, mut bounds) = (None, None);
    // The header of a frame has begun, and its atoms have not come.
    let mut open = false;
    while lines.advance_over_blanks()? {
        let text = lines.text();
        let Some(item) = text.strip_prefix("ITEM:").map(str::trim) else {
            bail!(
                "{}: '{}' stands where a line 'ITEM: ...' is expected; mend the file",
                lines.place(),
                short(&text)
            );
        };
        open = !item.starts_with("ATOMS");
        if item == "NUMBER OF ATOMS" {
            next(&mut lines)?;
            n = Some(lines.count(lines.line(), "the number of atoms")?);
        } else if let Some(kind) = item.strip_prefix("BOX BOUNDS") {
            bounds = Some(Bounds::read(&mut lines, kind)?);
        } else if let Some(names) = item.strip_prefix("ATOMS") {
            let place = lines.place();
            let n = n.take().with_context(|| {
                format!("{place}: no 'ITEM: NUMBER OF ATOMS' stands before the atoms")
            })?;
            let step = frames.begin(|| lines.place())?;
            if step == Step::Stop {
                break;
            }
            // The box of a frame is for that frame only.
            let bounds = bounds.take();
            let atoms = if step == Step::Keep {
                Some(Atoms::new(names, bounds, &place, options)?)
            } else {
                None
            };
            let kept = section(&mut lines, n, atoms)?;
            result = kept.or(result);
        } else if item.starts_with("ENTRIES") || item.starts_with("NUMBER OF ENTRIES") {
            bail!(
                "{}: this is a dump of pairs or bonds, not of atoms; give it to verify --pairs",
                lines.place()
            );
        } else {
            // A time step, a time, units: one line each.
            next(&mut lines)?;
        }
    }
    let name = lines.source.name;
    let (particles, about) = match result {
        Some(result) => result,
        None => (Particles::new(3, false), About { format: "LAMMPS dump", ..About::default() }),
    };
    let about = frames.end(name, about)?;
    ensure!(about.frames > 0, "{name} ends before a section 'ITEM: ATOMS'; write it again");
    ensure!(
        !open,
        "{name} is cut off in the header of a frame; write it again, or take an earlier --frame"
    );
    Ok((particles, about))
}

fn next(lines: &mut Lines<'_>) -> anyhow::Result<()> {
    ensure!(lines.advance()?, "{} is cut off in a header; write it again", lines.source.name);
    Ok(())
}

/// The rows of one frame; none where they are passed over.
fn section(
    lines: &mut Lines<'_>,
    n: u64,
    atoms: Option<Atoms>,
) -> anyhow::Result<Option<(Particles, About)>> {
    let mut atoms = atoms;
    for k in 0..n {
        ensure!(
            lines.advance()?,
            "{} ends after {k} of the {n} atoms that its header announces; write it again, or \
             take an earlier --frame",
            lines.source.name
        );
        if let Some(atoms) = &mut atoms {
            let line = lines.line();
            ensure!(
                !line.starts_with(b"ITEM:"),
                "{}: a new section begins after {k} of the {n} atoms announced; mend the number",
                lines.place()
            );
            atoms.columns.push(
                &mut atoms.particles,
                Separator::Blanks.cells(line),
                || lines.place(),
                || " by ITEM: ATOMS".into(),
            )?;
            if let Some(bounds) = &atoms.scaled {
                bounds.scale_last(&mut atoms.particles);
            }
        }
    }
    let Some(mut atoms) = atoms else { return Ok(None) };
    atoms.finite(lines.source.name)?;
    let (particles, mut about) = loaded("LAMMPS dump", atoms.particles, atoms.columns.radius());
    about.notes = atoms.notes;
    about.bounds = atoms.bounds;
    Ok(Some((particles, about)))
}

/// The columns of one frame, and what they hold.
struct Atoms {
    columns: Columns,
    particles: Particles,
    scaled: Option<Bounds>,
    bounds: Option<Vec<[f64; 2]>>,
    notes: Vec<String>,
}

impl Atoms {
    fn new(
        names: &str,
        bounds: Option<Bounds>,
        place: &str,
        options: Options,
    ) -> anyhow::Result<Atoms> {
        let mut columns = Columns::named(names.split_whitespace()).chosen(place, options)?;
        let has = |name: &str| columns.names.iter().any(|other| other == name);
        let mut notes = Vec::new();
        // Whoever chooses xs has scaled coordinates, too.
        let chosen = |name: &str| {
            let k = columns.names.iter().position(|other| other == name);
            k.is_some_and(|k| columns.meaning[k] == Column::Axis(0))
        };
        let given = options.columns.is_some();
        let kind = ["", "u", "s", "su"]
            .into_iter()
            .map(|kind| (kind, format!("x{kind}")))
            .find(|(_, name)| if given { chosen(name) } else { has(name) })
            .map_or("", |(kind, _)| kind);
        let axes = ["x", "y", "z"].map(|axis| format!("{axis}{kind}"));
        let of_another_kind =
            ["z", "zu", "zs", "zsu"].into_iter().find(|z| !given && has(z) && !has(&axes[2]));
        if let Some(z) = of_another_kind {
            bail!(
                "{place}: the columns are '{}' and '{z}', which are not of one kind; write x y z",
                axes[0]
            );
        }
        for (meaning, name) in columns.meaning.iter_mut().zip(&columns.names).filter(|_| !given) {
            match axes.iter().position(|axis| axis == name) {
                Some(k) => *meaning = Column::Axis(k),
                None if matches!(meaning, Column::Axis(_)) => *meaning = Column::Other,
                None => {}
            }
        }
        let particles = columns.particles(place, options)?;
        let scaled = if kind.starts_with('s') {
            let bounds = bounds.clone().with_context(|| {
                format!(
                    "{place}: the coordinates are scaled by the box (xs), but there is no 'ITEM: \
                     BOX BOUNDS'; write x y z"
                )
            })?;
            ensure!(
                !bounds.tilted,
                "{place}: the coordinates are scaled (xs) by a tilted (triclinic) box, which is \
                 not read; write x y z instead of xs ys zs"
            );
            notes.push("coordinates scaled by the box (xs): turned into lengths".into());
            Some(bounds)
        } else {
            None
        };
        if kind.ends_with('u') {
            notes.push(
                "unwrapped coordinates: bodies that touch across a periodic boundary do not touch \
                 here"
                    .into(),
            );
        }
        if bounds.as_ref().is_some_and(|bounds| bounds.periodic) {
            notes.push(
                "the box is periodic; boundaries are open here, and contacts across them are not \
                 found"
                    .into(),
            );
        }
        Ok(Atoms {
            columns,
            particles,
            scaled,
            bounds: bounds.filter(|bounds| !bounds.tilted).map(|bounds| bounds.ranges.to_vec()),
            notes,
        })
    }

    fn finite(&mut self, name: &str) -> anyhow::Result<()> {
        if self.scaled.is_some() {
            let bad = (0..self.particles.len())
                .find(|&k| self.particles.centre(k).iter().any(|x| !x.is_finite()));
            ensure!(
                bad.is_none(),
                "{name}: atom {} (from 0) is not finite once it is scaled by the box",
                bad.unwrap_or_default()
            );
        }
        Ok(())
    }
}

/// The box of one frame.
#[derive(Clone)]
struct Bounds {
    ranges: [[f64; 2]; 3],
    tilted: bool,
    periodic: bool,
}

impl Bounds {
    fn read(lines: &mut Lines<'_>, kind: &str) -> anyhow::Result<Bounds> {
        let flags: Vec<&str> = kind.split_whitespace().collect();
        let tilted =
            flags.iter().any(|flag| matches!(*flag, "xy" | "xz" | "yz" | "abc" | "origin"));
        let periodic = flags.iter().any(|flag| flag.len() == 2 && flag.contains('p'));
        let mut ranges = [[0.0; 2]; 3];
        for range in &mut ranges {
            next(lines)?;
            for (k, cell) in words(lines.line()).take(2).enumerate() {
                range[k] = number(cell).filter(|x| x.is_finite()).with_context(|| {
                    format!(
                        "{}: column {}: '{}' is not a finite number; a bound of the box is \
                         expected",
                        lines.place(),
                        k + 1,
                        shown(cell)
                    )
                })?;
            }
            ensure!(
                words(lines.line()).count() >= 2,
                "{}: two bounds of the box are expected, lo and hi",
                lines.place()
            );
        }
        Ok(Bounds { ranges, tilted, periodic })
    }

    /// Turns the last particle's scaled coordinates into lengths.
    fn scale_last(&self, particles: &mut Particles) {
        let scale = |s: f64, [lo, hi]: [f64; 2]| lo + s * (hi - lo);
        match &mut particles.centres {
            Centres::Plane(points) => points
                .last_mut()
                .into_iter()
                .for_each(|p| (0..2).for_each(|k| p[k] = scale(p[k], self.ranges[k]))),
            Centres::Space(points) => points
                .last_mut()
                .into_iter()
                .for_each(|p| (0..3).for_each(|k| p[k] = scale(p[k], self.ranges[k]))),
        }
    }
}
