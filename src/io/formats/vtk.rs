//! VTK legacy: `POINTS` of a POLYDATA, UNSTRUCTURED_GRID or STRUCTURED_GRID data set, text or
//! binary (big-endian).
//!
//! The size is a SCALARS or FIELD array of the points named `radius`, `r`, `diameter` or `d`. Cells
//! and other arrays are passed over. Format:
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>.

use anyhow::{Context, bail, ensure};

use crate::io::lines::{Lines, Source, short, shown, texts};
use crate::io::particles::{Particles, loaded};
use crate::io::scalars::{Arrays, Kind, Target};
use crate::io::{About, Options};

pub(crate) fn read(source: Source<'_>, _: Options) -> anyhow::Result<(Particles, About)> {
    let mut file = Vtk { lines: Lines::new(source), binary: false, points: 0, tuples: 0 };
    let mut arrays = Arrays::default();
    file.lines.advance()?;
    // A title, whatever it says.
    file.lines.advance()?;
    ensure!(
        file.lines.advance()?,
        "{} is cut off in its header; write it again",
        file.lines.source.name
    );
    file.binary = match file.lines.line() {
        b"ASCII" => false,
        b"BINARY" => true,
        _ => bail!(
            "{}: '{}' is neither ASCII nor BINARY",
            file.lines.place(),
            short(&file.lines.text())
        ),
    };
    // Arrays belong to the points from POINT_DATA on, up to CELL_DATA.
    let mut of_points = false;
    while file.lines.advance_over_blanks()? {
        let words = texts(file.lines.line());
        let (first, rest) = (words[0].to_ascii_uppercase(), &words[1..]);
        match (first.as_str(), rest) {
            ("DATASET", [kind, ..]) => ensure!(
                matches!(
                    kind.to_ascii_uppercase().as_str(),
                    "POLYDATA" | "UNSTRUCTURED_GRID" | "STRUCTURED_GRID"
                ),
                "{}: a data set of kind {} has no points of its own; write POLYDATA",
                file.lines.place(),
                short(kind)
            ),
            ("POINTS", [n, kind, ..]) => {
                let n = file.lines.count(n.as_bytes(), "the number of points")?;
                let kind = file.kind(kind)?;
                (file.points, file.tuples) = (n, n);
                let points = file.array(Target::points(), kind, 3 * n, "POINTS")?;
                arrays.keep(points, file.lines.source.name)?;
            }
            ("POINT_DATA", [n, ..]) => {
                of_points = true;
                file.same_number(n)?;
                file.tuples = file.points;
            }
            // VTK writes it before POINT_DATA; behind that, nothing of it is needed.
            ("CELL_DATA", _) if of_points => break,
            ("CELL_DATA", [n, ..]) => {
                file.tuples = file.lines.count(n.as_bytes(), "the number of cells")?
            }
            ("GLOBAL_IDS" | "PEDIGREE_IDS", [name, kind]) => file.skip(kind, 1, name)?,
            ("SCALARS", [name, kind, rest @ ..]) => {
                let components = rest
                    .first()
                    .map_or(Some(1), |text| text.parse().ok().filter(|k| (1..=4).contains(k)));
                let components = components.with_context(|| {
                    format!("{}: SCALARS have 1 to 4 components", file.lines.place())
                })?;
                let kind = file.kind(kind)?;
                let target =
                    if of_points { Target::named(name, components) } else { Target::Nothing };
                // The line LOOKUP_TABLE is part of it.
                ensure!(
                    file.lines.advance()?
                        && file.lines.line().to_ascii_uppercase().starts_with(b"LOOKUP_TABLE"),
                    "{}: a line LOOKUP_TABLE is expected behind SCALARS",
                    file.lines.place()
                );
                let sizes =
                    file.array(target, kind, components.saturating_mul(file.tuples), name)?;
                arrays.keep(sizes, file.lines.source.name)?;
            }
            ("VECTORS" | "NORMALS", [name, kind, ..]) => file.skip(kind, 3, name)?,
            ("TENSORS", [name, kind, ..]) => file.skip(kind, 9, name)?,
            ("TEXTURE_COORDINATES", [name, k, kind, ..]) => {
                file.skip(kind, k.parse().unwrap_or(0), name)?;
            }
            ("COLOR_SCALARS", [name, k]) => file.skip(
                if file.binary { "uchar" } else { "float" },
                k.parse().unwrap_or(0),
                name,
            )?,
            ("FIELD", [_, count, ..]) => {
                for _ in 0..file.lines.count(count.as_bytes(), "a number of arrays")? {
                    file.field(of_points, &mut arrays)?;
                }
            }
            ("METADATA", _) => while file.lines.advance()? && !file.lines.line().is_empty() {},
            ("OFFSETS" | "CONNECTIVITY", [kind, ..]) => {
                bail!("{}: {first} {} without CELLS before it", file.lines.place(), short(kind))
            }
            ("LOOKUP_TABLE", [_, n]) => {
                let n = file.lines.count(n.as_bytes(), "the size of a table")?;
                drop(file.array(
                    Target::Nothing,
                    if file.binary { Kind::U8 } else { Kind::F64 },
                    4 * n,
                    "LOOKUP_TABLE",
                )?);
            }
            ("DIMENSIONS", _) => {}
            ("CELL_TYPES", [n, ..]) => {
                let n = file.lines.count(n.as_bytes(), "the number of cells")?;
                drop(file.array(Target::Nothing, Kind::I32, n, "CELL_TYPES")?);
            }
            ("CELLS" | "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS", [n, size]) => {
                file.cells(n, size, &first)?
            }
            _ => bail!(
                "{}: '{}' is no part of a VTK file that is known here; is an array before it too \
                 long or too short?",
                file.lines.place(),
                short(&file.lines.text())
            ),
        }
    }
    let (particles, radius) = arrays.particles(file.lines.source.name)?;
    Ok(loaded(
        if file.binary { "VTK legacy, binary" } else { "VTK legacy, text" },
        particles,
        radius,
    ))
}

struct Vtk<'a> {
    lines: Lines<'a>,
    binary: bool,
    points: u64,
    /// What arrays have a tuple for: points, or cells.
    tuples: u64,
}

impl Vtk<'_> {
    fn kind(&self, name: &str) -> anyhow::Result<Kind> {
        Kind::named(name).with_context(|| {
            format!(
                "{}: numbers of type '{}' are not read; write float or double",
                self.lines.place(),
                short(name)
            )
        })
    }

    fn same_number(&self, n: &str) -> anyhow::Result<()> {
        let n = self.lines.count(n.as_bytes(), "the number of points")?;
        ensure!(
            n == self.points,
            "{}: data of {n} points, but there are {} POINTS; write it again",
            self.lines.place(),
            self.points
        );
        Ok(())
    }

    /// The numbers of an array, which begin on the next line.
    fn array(
        &mut self,
        mut target: Target,
        kind: Kind,
        count: u64,
        what: &str,
    ) -> anyhow::Result<Target> {
        let what = short(what);
        if self.binary {
            let place = self.lines.place();
            let whole = target
                .take(&mut self.lines.source, kind, true, count)
                .with_context(|| format!("{place}: {what}"))?;
            ensure!(
                whole,
                "{} ends before the {count} numbers of {what} that it announces; write it again",
                self.lines.source.name
            );
            return Ok(target);
        }
        self.lines.end_line();
        for _ in 0..count {
            let value = self.lines.number(&what)?;
            if let Err(error) = target.push(value) {
                return Err(error.context(format!("{}: {what}", self.lines.place_of_word())));
            }
        }
        let rest = shown(self.lines.rest());
        ensure!(
            rest.is_empty(),
            "{}: '{rest}' stands behind the {count} numbers of {what}",
            self.lines.place()
        );
        Ok(target)
    }

    fn skip(&mut self, kind: &str, components: u64, what: &str) -> anyhow::Result<()> {
        let kind = self.kind(kind)?;
        self.array(Target::Nothing, kind, components.saturating_mul(self.points), what).map(drop)
    }

    /// One array of a FIELD: `name components tuples type`.
    fn field(&mut self, of_points: bool, arrays: &mut Arrays) -> anyhow::Result<()> {
        let name = self.lines.source.name;
        loop {
            ensure!(
                self.lines.advance_over_blanks()?,
                "{name} is cut off in a FIELD; write it again"
            );
            // What describes the array before may stand between two.
            if !self.lines.line().starts_with(b"METADATA") {
                break;
            }
            while self.lines.advance()? && !self.lines.line().is_empty() {}
        }
        let place = self.lines.place();
        let words = texts(self.lines.line());
        let [label, components, tuples, kind] = &words[..] else {
            bail!(
                "{place}: '{}' is not of the form 'name components tuples type'",
                short(&self.lines.text())
            )
        };
        let components = self.lines.count(components.as_bytes(), "a number of components")?;
        let tuples = self.lines.count(tuples.as_bytes(), "a number of tuples")?;
        ensure!(
            kind != "string",
            "{place}: texts in a FIELD are not read; remove the array '{}'",
            short(label)
        );
        let kind = self.kind(kind)?;
        let target = if of_points && tuples == self.points {
            Target::named(label, components)
        } else {
            Target::Nothing
        };
        let target = self.array(target, kind, components.saturating_mul(tuples), label)?;
        arrays.keep(target, name)
    }

    /// Cells: before version 5 `size` numbers, since then offsets and connectivity.
    fn cells(&mut self, n: &str, size: &str, what: &str) -> anyhow::Result<()> {
        let n = self.lines.count(n.as_bytes(), "the number of cells")?;
        let size = self.lines.count(size.as_bytes(), "a number of indices")?;
        if self.old_cells()? {
            return self.array(Target::Nothing, Kind::I32, size, what).map(drop);
        }
        for (label, count) in [("OFFSETS", n), ("CONNECTIVITY", size)] {
            ensure!(
                self.lines.advance_over_blanks()?,
                "{} is cut off in {what}; write it again",
                self.lines.source.name
            );
            let words = texts(self.lines.line());
            let [found, kind] = &words[..] else {
                bail!("{}: a line '{label} type' is expected", self.lines.place())
            };
            ensure!(found == label, "{}: a line '{label} type' is expected", self.lines.place());
            let kind = self.kind(kind)?;
            self.array(Target::Nothing, kind, count, label)?;
        }
        Ok(())
    }

    /// Do the indices follow at once? Nobody but the next bytes can tell. Blank lines may stand
    /// before them in text; in a binary file the next byte is of a number, or the O of OFFSETS.
    fn old_cells(&mut self) -> anyhow::Result<bool> {
        loop {
            let Source { input, name, .. } = &mut self.lines.source;
            let next = input.fill_buf().with_context(|| format!("cannot read {name}"))?;
            match next.first() {
                Some(b'\n' | b'\r' | b' ' | b'\t') if !self.binary => input.consume(1),
                first => return Ok(first != Some(&b'O')),
            }
        }
    }
}
