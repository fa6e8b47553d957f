//! Legacy VTK: `POINTS` of a POLYDATA, UNSTRUCTURED_GRID or STRUCTURED_GRID data set, as text or
//! big-endian binary.
//!
//! The size is a SCALARS or FIELD array named `radius`, `r`, `diameter` or `d`, of the points or of
//! cells that are one point each. Points joined by polygons or larger cells are refused. Format:
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>.

mod arrays;

use anyhow::{Context, bail, ensure};

use crate::options::Options;
use crate::particles::Loaded;
use crate::raw::lines::{Lines, Source, among, number, short, shown, texts, words};
use crate::raw::scalars::Scalar;
use arrays::{Arrays, Cells, Of, Target};

pub fn read(source: Source<'_>, options: Options) -> anyhow::Result<Loaded> {
    let mut file = Vtk {
        lines: Lines::new(source),
        options,
        arrays: Arrays::default(),
        binary: false,
        points: 0,
        of: Of::Nothing,
        tuples: 0,
    };
    for _ in 0..3 {
        file.lines.advance()?;
    }
    file.binary = match file.lines.line() {
        b"ASCII" => false,
        b"BINARY" => true,
        other => bail!("{}: '{}' is neither ASCII nor BINARY", file.lines.place(), shown(other)),
    };
    while file.lines.advance_over_blanks()? {
        let words = texts(file.lines.line());
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let Some((first, rest)) = words.split_first() else { continue };
        if !file.section(&first.to_ascii_uppercase(), rest)? {
            break;
        }
    }
    let format = if file.binary { "VTK legacy, binary" } else { "VTK legacy, text" };
    file.arrays.particles(format, file.lines.source.name, options)
}

struct Vtk<'a> {
    lines: Lines<'a>,
    options: Options,
    arrays: Arrays,
    binary: bool,
    points: u64,
    /// Whether the next arrays belong to points or cells; `tuples` is the length of these arrays.
    of: Of,
    tuples: u64,
}

impl Vtk<'_> {
    /// Reads the section that starts with the words of this line. Returns false if the rest of the
    /// file is not needed.
    fn section(&mut self, first: &str, rest: &[&str]) -> anyhow::Result<bool> {
        let place = self.lines.place();
        match (first, rest) {
            ("DATASET", [kind, ..]) => {
                let kinds = "POLYDATA UNSTRUCTURED_GRID STRUCTURED_GRID";
                let (has_points, kind) = (among(kinds, &kind.to_ascii_uppercase()), short(kind));
                ensure!(has_points, "{place}: a {kind} has no points of its own; write POLYDATA");
            }
            ("POINTS", [n, kind, ..]) => {
                let n = self.count(n, "the number of points")?;
                let kind = self.kind(kind)?;
                (self.points, self.tuples) = (n, n);
                self.array(Target::points(), kind, 3 * n, "POINTS")?;
            }
            ("POINT_DATA", [n, ..]) => {
                let (n, points) = (self.count(n, "the number of points")?, self.points);
                ensure!(n == points, "{place}: data of {n} points, but there are {points} POINTS");
                (self.of, self.tuples) = (Of::Points, points);
            }
            ("CELL_DATA", [n, ..]) => {
                // Cell data are not needed if the points have sizes.
                if self.of == Of::Points && !self.arrays.wants_cells(self.options) {
                    return Ok(false);
                }
                (self.of, self.tuples) = (Of::Cells, self.count(n, "the number of cells")?);
            }
            ("METADATA", _) => while self.lines.advance()? && !self.lines.line().is_empty() {},
            ("OFFSETS" | "CONNECTIVITY", [kind, ..]) => {
                bail!("{place}: {first} {} without CELLS before it", short(kind))
            }
            // A grid of points counts as one face or body, unless it is a single row of points.
            ("DIMENSIONS", sizes) => {
                let long = |text: &&&str| text.parse::<u64>().is_ok_and(|n| n > 1);
                self.arrays.cells.faces += u64::from(sizes.iter().filter(long).count() > 1);
            }
            ("CELL_TYPES", [n, ..]) => {
                let n = self.count(n, "the number of cells")?;
                self.array(Target::Types(Cells::default()), Scalar::I32, n, "CELL_TYPES")?;
            }
            ("CELLS" | "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS", [n, size]) => {
                self.cells(n, size, first)?
            }
            _ => self.attributes(first, rest)?,
        }
        Ok(true)
    }

    fn attributes(&mut self, first: &str, rest: &[&str]) -> anyhow::Result<()> {
        match (first, rest) {
            ("GLOBAL_IDS", [name, kind]) => {
                let kind = self.kind(kind)?;
                let target = self.arrays.target(self.of, "GlobalIds", 1, self.options)?;
                self.array(target, kind, self.tuples, name)?;
            }
            ("SCALARS", [name, kind, rest @ ..]) => self.scalars(name, kind, rest.first())?,
            ("PEDIGREE_IDS", [name, kind]) => self.skip(kind, 1, name)?,
            ("VECTORS" | "NORMALS", [name, kind, ..]) => {
                self.arrays.target(self.of, name, 3, self.options)?;
                self.skip(kind, 3, name)?;
            }
            ("TENSORS", [name, kind, ..]) => self.skip(kind, 9, name)?,
            ("TEXTURE_COORDINATES", [name, k, kind, ..]) => {
                self.skip(kind, k.parse().unwrap_or(0), name)?;
            }
            ("COLOR_SCALARS", [name, k]) => {
                let kind = if self.binary { "uchar" } else { "float" };
                self.skip(kind, k.parse().unwrap_or(0), name)?;
            }
            ("FIELD", [_, count, ..]) => {
                for _ in 0..self.count(count, "a number of arrays")? {
                    self.field()?;
                }
            }
            ("LOOKUP_TABLE", [_, n]) => {
                let n = self.count(n, "the size of a table")?;
                let kind = if self.binary { Scalar::U8 } else { Scalar::F64 };
                self.array(Target::Nothing, kind, 4 * n, "LOOKUP_TABLE")?;
            }
            _ => bail!("{}: '{}' is no part of a VTK file", self.lines.place(), short(first)),
        }
        Ok(())
    }

    fn scalars(&mut self, name: &str, kind: &str, components: Option<&&str>) -> anyhow::Result<()> {
        let (kind, place) = (self.kind(kind)?, self.lines.place());
        let components: u64 = components.map_or(Ok(1), |text| text.parse()).unwrap_or(0);
        ensure!((1..=4).contains(&components), "{place}: SCALARS have 1 to 4 components");
        let target = self.arrays.target(self.of, name, components, self.options);
        let target = target.with_context(|| place.clone())?;
        self.lines.advance()?;
        let is_table = self.lines.line().to_ascii_uppercase().starts_with(b"LOOKUP_TABLE");
        ensure!(is_table, "{place}: a line LOOKUP_TABLE is expected behind SCALARS");
        self.array(target, kind, components.saturating_mul(self.tuples), name)
    }

    fn count(&self, text: &str, what: &str) -> anyhow::Result<u64> {
        self.lines.count(text.as_bytes(), what)
    }

    fn kind(&self, name: &str) -> anyhow::Result<Scalar> {
        Scalar::named(name).with_context(|| {
            let (place, name) = (self.lines.place(), short(name));
            format!("{place}: numbers of type '{name}' are not read; write float or double")
        })
    }

    fn array(
        &mut self,
        mut target: Target,
        kind: Scalar,
        count: u64,
        what: &str,
    ) -> anyhow::Result<()> {
        let (what, name) = (short(what), self.lines.source.name);
        if self.binary {
            let place = self.lines.place();
            let whole = target.take(&mut self.lines.source, kind, count);
            let whole = whole.with_context(|| format!("{place}: {what}"))?;
            ensure!(whole, "{name} ends before the {count} numbers of {what} that it announces");
            return self.arrays.keep(target, name);
        }
        let mut left = count;
        while left > 0 {
            let lines = &mut self.lines;
            ensure!(lines.advance()?, "{name} ends before the {count} numbers of {what}");
            for word in words(lines.line()) {
                let shown = || format!("{lines}: {what}: '{}'", shown(word));
                let value = number(word).with_context(|| format!("{} is not a number", shown()))?;
                ensure!(left > 0, "{} stands behind the {count} numbers", shown());
                target.push(value).with_context(shown)?;
                left -= 1;
            }
        }
        self.arrays.keep(target, name)
    }

    fn next_line(&mut self, what: &str) -> anyhow::Result<()> {
        let more = self.lines.advance_over_blanks()?;
        ensure!(more, "{} is cut off in {what}; write it again", self.lines.source.name);
        Ok(())
    }

    fn skip(&mut self, kind: &str, components: u64, what: &str) -> anyhow::Result<()> {
        let kind = self.kind(kind)?;
        self.array(Target::Nothing, kind, components.saturating_mul(self.tuples), what)
    }

    fn field(&mut self) -> anyhow::Result<()> {
        loop {
            self.next_line("a FIELD")?;
            // METADATA belongs to the array before it and is skipped.
            if !self.lines.line().starts_with(b"METADATA") {
                break;
            }
            while self.lines.advance()? && !self.lines.line().is_empty() {}
        }
        let place = self.lines.place();
        let words = texts(self.lines.line());
        let [label, components, tuples, kind] = &words[..] else {
            bail!("{place}: an array begins with a line 'name components tuples type'")
        };
        let components = self.count(components, "a number of components")?;
        let tuples = self.count(tuples, "a number of tuples")?;
        let kind = self.kind(kind)?;
        let of = if tuples == self.tuples { self.of } else { Of::Nothing };
        let target = self.arrays.target(of, label, components, self.options);
        let target = target.with_context(|| place)?;
        self.array(target, kind, components.saturating_mul(tuples), label)
    }

    /// Reads cells: before version 5 as `size` numbers, since then as offsets and connectivity.
    fn cells(&mut self, n: &str, size: &str, what: &str) -> anyhow::Result<()> {
        let n = self.count(n, "the number of cells")?;
        let size = self.count(size, "a number of indices")?;
        let old = self.old_cells()?;
        let cells = if old { n } else { n.saturating_sub(1) };
        let joining = match what {
            "LINES" => &mut self.arrays.cells.lines,
            "POLYGONS" | "TRIANGLE_STRIPS" => &mut self.arrays.cells.faces,
            _ => &mut 0,
        };
        *joining = joining.saturating_add(cells);
        let target = match what {
            "VERTICES" | "CELLS" => Target::Indices { seen: 0, in_order: true, counted: old },
            _ => Target::Nothing,
        };
        if old {
            return self.array(target, Scalar::I32, size, what);
        }
        for (label, count, target) in
            [("OFFSETS", n, Target::Nothing), ("CONNECTIVITY", size, target)]
        {
            self.next_line(what)?;
            let words = texts(self.lines.line());
            let kind = match &words[..] {
                [found, kind] if found == label => self.kind(kind)?,
                _ => bail!("{}: a line '{label} type' is expected", self.lines.place()),
            };
            self.array(target, kind, count, label)?;
        }
        Ok(())
    }

    /// Whether the cells are written as before version 5, judged by the next bytes. In text, blank
    /// lines may come first; in binary, the next byte belongs to a number or is the O of OFFSETS.
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
