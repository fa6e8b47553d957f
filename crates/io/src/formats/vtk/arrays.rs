//! Points, sizes and cells collected from the named arrays of a file, in file order.

use anyhow::{anyhow, bail, ensure};
use nalgebra::Point;

use crate::columns::Column;
use crate::columns::chosen::Chosen;
use crate::options::Options;
use crate::particles::sizes::{Size, radii};
use crate::particles::{Centres, Loaded, Particles, loaded, unused_sizes};
use crate::raw::lines::{Source, exact, short};
use crate::raw::room::room;
use crate::raw::scalars::Scalar;
use crate::types::{Notice, assumed};
use contactbench_terms::number::plural;

#[derive(Clone, Copy, Default)]
pub struct Cells {
    pub lines: u64,
    /// Number of polygons and larger cells.
    pub faces: u64,
}

impl Cells {
    /// Counts a cell by its type in VTK.
    fn push(&mut self, kind: f64) {
        match kind as i64 {
            0..=2 => {}
            3 | 4 | 21 | 35 | 68 | 75 => self.lines += 1,
            _ => self.faces += 1,
        }
    }

    /// Refuses the corner points of a mesh unless the options give a radius. Lines between points
    /// only cause a notice, because they may be bonds between particles.
    fn check(&self, name: &str, options: Options, notices: &mut Vec<Notice>) -> anyhow::Result<()> {
        let Cells { lines, faces } = *self;
        if faces > 0 {
            let what = plural(faces as usize, "polygon or cell");
            let sized = options.radius.is_some() || options.sizes_chosen();
            ensure!(
                sized,
                "{name}: the points are corners of {what}; give --radius or --columns r=NAME"
            );
            notices.push(assumed!("the corners of {what} are taken as particles"));
        } else if lines > 0 {
            let what = plural(lines as usize, "line");
            notices.push(assumed!("{what} between the points: each point is taken as a particle"));
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

/// Where the numbers of an array go.
pub enum Target {
    Points(Vec<Point<f64, 3>>, [f64; 3], usize),
    Sizes(Size),
    /// The points of cells. Only whether cell k is point k alone is checked.
    Indices {
        seen: u64,
        in_order: bool,
        /// Whether each cell starts with its number of points.
        counted: bool,
    },
    Types(Cells),
    /// Number of points that are copies of other points.
    Ghosts(u64),
    /// Ids; `None` if a number is not whole or not exact in f64.
    Ids(Option<Vec<i64>>),
    Nothing,
}

impl Target {
    pub fn points() -> Target {
        Target::Points(Vec::new(), [0.0; 3], 0)
    }

    pub fn push(&mut self, value: f64) -> anyhow::Result<()> {
        match self {
            Target::Points(points, point, k) => {
                let n = points.len();
                ensure!(value.is_finite(), "point {n} (from 0): {value} is not a finite number");
                point[*k] = value;
                *k = (*k + 1) % 3;
                if *k == 0 {
                    room(points)?;
                    points.push(Point::from(*point));
                }
            }
            Target::Sizes(Size { values, column, .. }) => {
                let (n, size) = (values.len(), column.value(value));
                room(values)?;
                values.push(size.map_err(|why| anyhow!("size {n} (from 0): {value} {why}"))?);
            }
            Target::Indices { seen, in_order, counted } => {
                let expected = match (*counted, *seen % 2) {
                    (true, 0) => 1,
                    (true, _) => *seen / 2,
                    (false, _) => *seen,
                };
                *in_order &= value == expected as f64;
                *seen += 1;
            }
            Target::Types(cells) => cells.push(value),
            Target::Ghosts(ghosts) => *ghosts += u64::from(value != 0.0),
            Target::Ids(ids) => match (exact(value), &mut *ids) {
                (Some(id), Some(ids)) => {
                    room(ids)?;
                    ids.push(id);
                }
                _ => *ids = None,
            },
            Target::Nothing => {}
        }
        Ok(())
    }

    /// Takes big-endian numbers; returns false if the file is too short. They are read in blocks,
    /// so that a false header cannot reserve memory.
    pub fn take(
        &mut self,
        source: &mut Source<'_>,
        kind: Scalar,
        count: u64,
    ) -> anyhow::Result<bool> {
        let width = kind.width();
        if matches!(self, Target::Nothing) {
            return source.skip(count.saturating_mul(width as u64));
        }
        let mut piece = [0; 1 << 14];
        let mut left = count;
        while left > 0 {
            let bytes = left.min((piece.len() / width) as u64) as usize * width;
            if !source.fill(&mut piece[..bytes])? {
                return Ok(false);
            }
            for number in piece[..bytes].chunks_exact(width) {
                self.push(kind.get(number, true))?;
            }
            left -= (bytes / width) as u64;
        }
        Ok(true)
    }
}

#[derive(Default)]
pub struct Arrays {
    points: Option<Vec<Point<f64, 3>>>,
    pub cells: Cells,
    sizes: Vec<Size>,
    others: Vec<String>,
    /// Whether some cell is not exactly the point with the same number.
    out_of_order: bool,
    /// Number of cells of one point, if all are in the order of the points.
    vertices: u64,
    ghosts: u64,
    ids: Option<Vec<i64>>,
    /// Notices about arrays of sizes that are unused because the options give a radius.
    unused: Vec<Notice>,
}

/// Maximum number of names that are kept.
const NAMES: usize = 256;

impl Arrays {
    pub fn target(
        &mut self,
        of: Of,
        label: &str,
        components: u64,
        options: Options,
    ) -> anyhow::Result<Target> {
        let (column, of_points) = (Chosen::meaning(options.columns, label), of == Of::Points);
        let is_size = column.is_size();
        let one = components == 1 || of == Of::Nothing || !(is_size && options.sizes_chosen());
        ensure!(one, "'{}' has {components} numbers for each; a size is one number", short(label));
        Ok(match of {
            Of::Points if ["vtkGhostType", "vtkGhostLevels"].contains(&label) => Target::Ghosts(0),
            Of::Nothing => Target::Nothing,
            _ if components != 1 => {
                if is_size {
                    self.other(&format!("{label} ({components} numbers each, not one)"));
                }
                Target::Nothing
            }
            Of::Points if options.ids && column == Column::Id => Target::Ids(Some(Vec::new())),
            // Ids of VTK's own, if no others are chosen.
            Of::Points if options.ids && label == "GlobalIds" && options.columns.is_none() => {
                Target::Ids(Some(Vec::new()))
            }
            _ if is_size && options.radius.is_none() => {
                let (values, label) = (Vec::new(), label.to_string());
                Target::Sizes(Size { values, column, label, of_cells: !of_points })
            }
            _ => {
                match options.radius.filter(|_| is_size && of_points) {
                    Some(given) => self.unused.push(unused_sizes(label, given)),
                    None => self.other(label),
                }
                Target::Nothing
            }
        })
    }

    fn other(&mut self, label: &str) {
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
                let key = |size: &Size| (size.label.clone(), size.of_cells);
                let twice = self.sizes.iter().any(|known| key(known) == key(&size));
                ensure!(!twice, "{name}: '{}' is there twice; remove one", short(&size.label));
                self.sizes.push(size);
            }
            Target::Indices { seen, in_order, counted } => {
                self.out_of_order |= !in_order;
                self.vertices += seen / if counted { 2 } else { 1 };
            }
            Target::Types(Cells { lines, faces }) => {
                self.cells.lines += lines;
                self.cells.faces += faces;
            }
            Target::Ghosts(ghosts) => self.ghosts += ghosts,
            Target::Ids(ids) => self.ids = self.ids.take().or(ids),
            Target::Nothing => {}
        }
        Ok(())
    }

    pub fn particles(
        mut self,
        format: &'static str,
        name: &str,
        options: Options,
    ) -> anyhow::Result<Loaded> {
        let Some(points) = self.points.take() else { bail!("{name} holds no points") };
        let ghosts = self.ghosts;
        ensure!(ghosts == 0, "{name}: {ghosts} of the points are ghosts; save the data without");
        if let Some(chosen) = options.columns {
            ensure!(!chosen.axes(), "{name}: {format} has its own points; choose a size, r=NAME");
            let sizes = self.sizes.iter().map(|size| &size.label);
            let names: Vec<&String> = sizes.chain(&self.others).collect();
            chosen.among(&names, name)?;
        }
        let mut notices = std::mem::take(&mut self.unused);
        self.cells.check(name, options, &mut notices)?;
        let in_order = !self.out_of_order && self.vertices == points.len() as u64;
        self.usable(in_order && self.cells.lines + self.cells.faces == 0);
        let (radius, radii) = radii(self.sizes, name)?;
        let (n, sizes) = (points.len(), radii.as_ref().map_or(points.len(), Vec::len));
        ensure!(n == sizes, "{name} holds {n} points but {sizes} radii; write it again");
        let (ids, unused) = (self.ids.filter(|ids| ids.len() == n), self.others);
        let centres = Centres::Space(points);
        let particles = Particles { centres, radii, ids, notices, unused, ..Particles::default() };
        Ok(loaded(format, particles, radius))
    }

    /// Keeps the sizes of points, or of cells if each is the point with its number.
    fn usable(&mut self, cells_are_points: bool) {
        let of_points = self.sizes.iter().any(|size| !size.of_cells);
        let sizes = std::mem::take(&mut self.sizes);
        for size in sizes {
            if size.of_cells && (of_points || !cells_are_points) {
                self.other(&format!("{} (of cells)", size.label));
            } else {
                self.sizes.push(size);
            }
        }
    }
}
