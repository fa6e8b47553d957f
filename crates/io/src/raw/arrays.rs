//! Points, sizes and cells collected from the named arrays of a file, in file order.

use anyhow::{bail, ensure};
use nalgebra::Point;

use crate::particles::{Column, Particles, loaded, unused_sizes};
use crate::raw::lines::short;
use crate::raw::room::{room, room_for};
use crate::raw::scalars::{Ids, Kind, Size, Target};
use crate::{Chosen, Loaded, Notice, Options, RadiusSource};
use contactbench_terms::number::plural;

#[derive(Clone, Copy, Default)]
pub struct Cells {
    pub lines: u64,
    pub faces: u64,
    pub bodies: u64,
}

impl Cells {
    pub fn push(&mut self, kind: f64) {
        match kind as i64 {
            0..=2 => {}
            3 | 4 | 21 | 35 | 68 | 75 => self.lines += 1,
            5..=9 | 22 | 23 | 28 | 30 | 34 | 36 | 69 | 70 | 76 | 77 => self.faces += 1,
            _ => self.bodies += 1,
        }
    }

    fn add(&mut self, other: Cells) {
        self.lines += other.lines;
        self.faces += other.faces;
        self.bodies += other.bodies;
    }

    /// Refuses the corner points of a mesh unless the options give a radius. Lines between points
    /// only cause a notice, because they may be bonds between particles.
    pub fn check(
        &self,
        name: &str,
        options: Options,
        notices: &mut Vec<Notice>,
    ) -> anyhow::Result<()> {
        let Cells { lines, faces, bodies } = *self;
        if faces.saturating_add(bodies) > 0 {
            let mut what = vec![];
            what.extend((faces > 0).then(|| plural(faces as usize, "polygon")));
            what.extend((bodies > 0).then(|| plural(bodies as usize, "cell")));
            let what = what.join(" and ");
            let sized = options.radius.is_some() || options.columns.is_some_and(|it| it.sizes());
            ensure!(
                sized,
                "{name}: the points are the corners of {what}, as in a mesh or after a Glyph \
                 filter; save the particles before that filter, or give a size to take each corner \
                 as a particle: --radius R or --columns r=NAME"
            );
            notices.push(Notice::Assumed(format!(
                "the corners of {what} are taken as particles, since their size is given"
            )));
        } else if lines > 0 {
            notices.push(Notice::Assumed(format!(
                "{} between the points: each point is taken as a particle",
                plural(lines as usize, "line")
            )));
        }
        Ok(())
    }
}

#[derive(Clone, Copy, PartialEq)]
pub enum Of {
    Nothing,
    Points,
    Cells,
}

#[derive(Default)]
pub struct Arrays {
    pub points: Option<Vec<Point<f64, 3>>>,
    pub cells: Cells,
    sizes: Vec<Size>,
    others: Vec<String>,
    /// Whether some cell is not exactly the point with the same number.
    out_of_order: bool,
    /// Number of cells of one point, if all are in the order of the points.
    vertices: u64,
    ghosts: u64,
    ids: Vec<Ids>,
    /// Notices about arrays of sizes that are unused because the options give a radius.
    unused: Vec<Notice>,
}

const NAMES: usize = 256;

impl Arrays {
    pub fn of(cells: Cells) -> Arrays {
        Arrays { cells, ..Arrays::default() }
    }

    pub fn target(
        &mut self,
        of: Of,
        label: &str,
        kind: Kind,
        components: u64,
        options: Options,
    ) -> anyhow::Result<Target> {
        if of == Of::Nothing {
            return Ok(Target::Nothing);
        }
        if of == Of::Points && matches!(label, "vtkGhostType" | "vtkGhostLevels") {
            return Ok(Target::Ghosts(0));
        }
        let column = Chosen::meaning(options.columns, label);
        if of == Of::Points && options.ids && components == 1 && Ids::is_named(label, column) {
            return Ok(Target::Ids(Ids::new(label, column)));
        }
        let is_size = matches!(column, Column::Radius | Column::Diameter);
        let sure = options.columns.is_some_and(|chosen| chosen.sizes());
        if components != 1 {
            ensure!(
                !(is_size && sure),
                "'{}' has {components} numbers for each; a size is one number",
                short(label)
            );
            return Ok(Target::Nothing);
        }
        // Bytes named r are colours (red), not radii.
        let red = label.eq_ignore_ascii_case("r") && kind == Kind::U8 && !sure;
        if let (true, Some(given)) = (is_size && !red && of == Of::Points, options.radius) {
            self.unused.push(unused_sizes(label, given));
        } else if !is_size || red || options.radius.is_some() {
            self.other(label);
        } else {
            let (values, label, of_cells) = (Vec::new(), label.to_string(), of == Of::Cells);
            return Ok(Target::Sizes(Size { values, column, label, of_cells }));
        }
        Ok(Target::Nothing)
    }

    pub fn other(&mut self, label: &str) {
        if self.others.len() < NAMES && !self.others.iter().any(|known| known == label) {
            self.others.push(label.to_string());
        }
    }

    pub fn wants_cells(&self, options: Options) -> bool {
        options.radius.is_none() && self.sizes.iter().all(|size| size.of_cells)
    }

    pub fn keep(&mut self, target: Target, name: &str) -> anyhow::Result<()> {
        match target {
            Target::Points(points, ..) => {
                ensure!(self.points.is_none(), "{name} holds points twice; write one data set");
                self.points = Some(points);
            }
            Target::Sizes(size) => {
                let same =
                    |known: &Size| (&known.label, known.of_cells) == (&size.label, size.of_cells);
                ensure!(
                    !self.sizes.iter().any(same),
                    "{name} holds two arrays named '{}'; remove one",
                    short(&size.label)
                );
                self.sizes.push(size);
            }
            Target::Indices(indices) => {
                self.out_of_order |= !indices.in_order;
                self.vertices += indices.seen / if indices.counted { 2 } else { 1 };
            }
            Target::Types(cells) => self.cells.add(cells),
            Target::Ghosts(ghosts) => self.ghosts += ghosts,
            Target::Ids(ids) => self.ids.push(ids),
            Target::Nothing => {}
        }
        Ok(())
    }

    pub fn append(&mut self, piece: Arrays) -> anyhow::Result<()> {
        let count = |arrays: &Arrays| arrays.points.as_ref().map_or(0, Vec::len) as u64;
        if count(&piece) > 0 {
            self.out_of_order |= piece.out_of_order || piece.vertices != count(&piece);
        }
        self.vertices += piece.vertices;
        self.cells.add(piece.cells);
        self.ghosts += piece.ghosts;
        let new = piece.unused.into_iter().filter(|notice| !self.unused.contains(notice));
        let new: Vec<Notice> = new.collect();
        self.unused.extend(new);
        piece.others.iter().for_each(|label| self.other(label));
        match (&mut self.points, piece.points) {
            (Some(all), Some(more)) => {
                room_for(all, more.len())?;
                all.extend(more);
            }
            (all, more) => *all = all.take().or(more),
        }
        for more in piece.ids {
            match self.ids.iter_mut().find(|ids| ids.label == more.label) {
                Some(ids) => ids.append(more)?,
                None => self.ids.push(more),
            }
        }
        for size in piece.sizes {
            let same =
                |known: &&mut Size| (&known.label, known.of_cells) == (&size.label, size.of_cells);
            match self.sizes.iter_mut().find(same) {
                Some(known) => {
                    room_for(&mut known.values, size.values.len())?;
                    known.values.extend(size.values);
                }
                None => {
                    room(&mut self.sizes)?;
                    self.sizes.push(size);
                }
            }
        }
        Ok(())
    }

    pub fn particles(
        mut self,
        format: &'static str,
        name: &str,
        options: Options,
    ) -> anyhow::Result<Loaded> {
        let Some(points) = self.points.take() else {
            bail!("{name} holds no points; write them as POINTS, or as CSV with a header x,y,z,r")
        };
        ensure!(
            self.ghosts == 0,
            "{name}: {} of the points are ghosts, copies of points of other pieces; save the data \
             without ghosts",
            self.ghosts
        );
        if let Some(chosen) = options.columns {
            ensure!(
                !chosen.axes(),
                "{name}: {format} has its own points; choose in --columns only the array of sizes: \
                 r=NAME or d=NAME"
            );
            let sizes = self.sizes.iter().map(|size| &size.label);
            let ids = self.ids.iter().map(|ids| &ids.label);
            let names: Vec<&String> = sizes.chain(ids).chain(&self.others).collect();
            chosen.among(&names, name)?;
        }
        let mut notices = std::mem::take(&mut self.unused);
        self.cells.check(name, options, &mut notices)?;
        let in_order = !self.out_of_order && self.vertices == points.len() as u64;
        let Cells { lines, faces, bodies } = self.cells;
        self.usable(in_order && lines + faces + bodies == 0, options);
        let size = one_of(self.sizes, name, &mut notices)?;
        let (radius, radii) = size.map_or((RadiusSource::Missing, None), Size::radii);
        let mut particles = Particles::from_columns(points, radii, name)?;
        particles.ids = Ids::of(self.ids, particles.len());
        particles.notices = notices;
        particles.unused = self.others;
        Ok(loaded(format, particles, radius))
    }

    fn usable(&mut self, cells_are_points: bool, options: Options) {
        let has = |name: &str| self.others.iter().any(|label| label.eq_ignore_ascii_case(name));
        let sure = options.columns.is_some_and(|chosen| chosen.sizes());
        let red = !sure && has("g") && has("b");
        let of_points = self.sizes.iter().any(|size| !size.of_cells);
        for size in std::mem::take(&mut self.sizes) {
            let is_red = red && size.label.eq_ignore_ascii_case("r");
            if is_red || size.of_cells && (of_points || !cells_are_points) {
                let of = if size.of_cells { " (of cells)" } else { "" };
                self.other(&format!("{}{of}", size.label));
            } else {
                self.sizes.push(size);
            }
        }
    }
}

impl Size {
    pub fn radii(self) -> (RadiusSource, Option<Vec<f64>>) {
        let source = match self.column {
            Column::Diameter => RadiusSource::Halved(self.label),
            _ => RadiusSource::Column(self.label),
        };
        (source, Some(self.values))
    }
}

const ALIKE: f64 = 1e-6;

pub(crate) fn one_of(
    sizes: Vec<Size>,
    name: &str,
    notices: &mut Vec<Notice>,
) -> anyhow::Result<Option<Size>> {
    let first = sizes.iter().position(|size| size.column == Column::Radius).unwrap_or(0);
    for other in sizes.iter().skip(1).chain(sizes.first()) {
        let taken = &sizes[first];
        if std::ptr::eq(taken, other) {
            continue;
        }
        let (a, b) = (short(&taken.label), short(&other.label));
        let same = |(x, y): (&f64, &f64)| (x - y).abs() <= ALIKE * x.max(*y);
        let differs = taken.values.iter().zip(&other.values).position(|pair| !same(pair));
        ensure!(
            differs.is_none() && taken.values.len() == other.values.len(),
            "{name} holds two arrays of sizes that differ{}, '{a}' and '{b}'; choose one: \
             --columns r={a}, or d={b} for a diameter",
            differs.map_or(String::new(), |k| format!(" at point {k} (from 0)"))
        );
        notices.push(Notice::Assumed(format!(
            "the sizes in '{a}' and '{b}' agree; '{a}' is taken (--columns r={b} or d={b} takes \
             the other)"
        )));
    }
    Ok(sizes.into_iter().nth(first))
}
