//! Particles as they are read: centres and radii that grow with the bytes of the file, never with
//! what it promises.

mod digits;
mod ids;

use anyhow::{Context, bail, ensure};
use nalgebra::Point;

use crate::io::boxes::{KNOWN_TO, along};
use crate::io::lines::{number, short, shown};
use crate::io::room::{room, room_for};
use crate::io::{About, Groups, Notice, Options, RadiusSource};
use crate::scene::{AnyScene, Given, Lattice, Radii, Scene};

/// Centres of either dimension, in file order.
#[derive(Debug, PartialEq)]
pub(crate) enum Centres {
    Plane(Vec<Point<f64, 2>>),
    Space(Vec<Point<f64, 3>>),
}

/// Particles as read.
#[derive(Debug, PartialEq)]
pub struct Particles {
    pub(crate) centres: Centres,
    pub(crate) radii: Option<Vec<f64>>,
    /// The file's own numbers of the particles, where they were asked for and are there.
    pub(crate) ids: Option<Vec<i64>>,
    /// Whose contacts are left out, where that was asked for.
    pub(crate) groups: Option<Groups>,
    /// The box, where it repeats.
    pub(crate) lattice: Option<Lattice>,
    /// The file has one, whether that repeats or not.
    pub(crate) has_box: bool,
    /// What the file leaves open.
    pub(crate) notices: Vec<Notice>,
    /// See [`Particles::first`].
    pub(crate) first: Option<u64>,
    /// How many of the coordinates looked at have how many significant digits.
    digits: digits::Counts,
}

impl Particles {
    pub(crate) fn new(dim: usize, has_radii: bool) -> Particles {
        let centres =
            if dim == 2 { Centres::Plane(Vec::new()) } else { Centres::Space(Vec::new()) };
        Particles::of(centres, has_radii.then(Vec::new))
    }

    pub(crate) fn of(centres: Centres, radii: Option<Vec<f64>>) -> Particles {
        let (ids, groups, lattice, notices) = (None, None, None, Vec::new());
        let digits = digits::Counts::default();
        let (has_box, first) = (false, None);
        Particles { centres, radii, ids, groups, lattice, has_box, notices, first, digits }
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        match &self.centres {
            Centres::Plane(points) => points.len(),
            Centres::Space(points) => points.len(),
        }
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// 2 or 3.
    pub fn dim(&self) -> usize {
        if matches!(self.centres, Centres::Plane(_)) { 2 } else { 3 }
    }

    /// Has the file a radius for each?
    pub fn has_radii(&self) -> bool {
        self.radii.is_some()
    }

    /// The file's own numbers of the particles, if they were asked for and are there.
    pub fn ids(&self) -> Option<&[i64]> {
        self.ids.as_deref()
    }

    /// The box that repeats; none where boundaries are open, or taken as open.
    pub fn lattice(&self) -> Option<&Lattice> {
        self.lattice.as_ref()
    }

    /// What the file leaves open, to be said to whoever named it.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }

    /// The number of the first particle in the file, if these are the part that was asked for; none
    /// if they are all.
    pub fn first(&self) -> Option<u64> {
        self.first
    }

    /// Spheres of which all have the same z, 0?
    pub fn is_flat(&self) -> bool {
        matches!(&self.centres, Centres::Space(points)
            if points.len() > 1 && points.iter().all(|point| point[2] == 0.0))
    }

    /// Coordinates of particle `k`; z is 0 in the plane.
    pub fn centre(&self, k: usize) -> [f64; 3] {
        match &self.centres {
            Centres::Plane(points) => [points[k][0], points[k][1], 0.0],
            Centres::Space(points) => [points[k][0], points[k][1], points[k][2]],
        }
    }

    pub(crate) fn push(&mut self, point: [f64; 3], radius: f64, id: i64) -> anyhow::Result<()> {
        ensure!(
            self.len() < u32::MAX as usize,
            "more than 2^32 - 1 = {} particles; split the file",
            u32::MAX
        );
        match &mut self.centres {
            Centres::Plane(points) => {
                room(points)?;
                points.push(Point::from([point[0], point[1]]));
            }
            Centres::Space(points) => {
                room(points)?;
                points.push(Point::from(point));
            }
        }
        if let Some(radii) = &mut self.radii {
            room(radii)?;
            radii.push(radius);
        }
        if let Some(ids) = &mut self.ids {
            room(ids)?;
            ids.push(id);
        }
        Ok(())
    }

    /// Adds rows of coordinates, and of radii behind them if there are any.
    pub(crate) fn extend(&mut self, numbers: &[f64], columns: usize) -> anyhow::Result<()> {
        let (rows, dim) = (numbers.chunks_exact(columns), self.dim());
        match &mut self.centres {
            Centres::Plane(points) => {
                room_for(points, rows.len())?;
                points.extend(rows.clone().map(|row| Point::from([row[0], row[1]])));
            }
            Centres::Space(points) => {
                room_for(points, rows.len())?;
                points.extend(rows.clone().map(|row| Point::from([row[0], row[1], row[2]])));
            }
        }
        if let Some(radii) = &mut self.radii {
            room_for(radii, rows.len())?;
            radii.extend(rows.map(|row| row[dim]));
        }
        Ok(())
    }

    /// Particles of which coordinates and sizes came one after the other; `name` stands in
    /// messages.
    pub(crate) fn from_columns(
        points: Vec<Point<f64, 3>>,
        radii: Option<Vec<f64>>,
        name: &str,
    ) -> anyhow::Result<Particles> {
        if let Some(radii) = &radii {
            ensure!(
                radii.len() == points.len(),
                "{name} holds {} points but {} radii; write it again",
                points.len(),
                radii.len()
            );
        }
        Ok(Particles::of(Centres::Space(points), radii))
    }

    /// Turns spheres with z = 0 into discs, if that is asked for; refuses what cannot be had.
    pub(crate) fn as_asked(&mut self, name: &str, options: Options) -> anyhow::Result<()> {
        ensure!(
            !(self.has_radii() && options.radius.is_some()),
            "{name} holds radii, but the radius {} was given too; leave one out",
            options.radius.unwrap_or_default()
        );
        ensure!(
            options.dim != Some(3) || self.dim() == 3,
            "{name} holds plane points (x and y only); it cannot be read as 3D: add a column z"
        );
        if let (Some(2), Centres::Space(points)) = (options.dim, &mut self.centres) {
            if let Some(k) = points.iter().position(|point| point[2] != 0.0) {
                bail!(
                    "{name}: particle {k} has z = {}; only particles with z = 0 can be read as 2D",
                    points[k][2]
                );
            }
            self.centres = Centres::Plane(
                std::mem::take(points).into_iter().map(|p| Point::from([p[0], p[1]])).collect(),
            );
        }
        Ok(())
    }

    /// The scene with open boundaries. Radii must be in the file or given.
    ///
    /// # Errors
    /// A box that repeats, among others: whoever wants the particles without it says so in the
    /// options ([`crate::io::Boundaries::open`]).
    pub fn scene(self, name: &str, radius: Option<f64>) -> anyhow::Result<AnyScene<'static>> {
        if let Some(lattice) = &self.lattice {
            bail!(
                "{name}: the box repeats along {}, and here boundaries are open; give --open to \
                 leave out contacts across it, or take one of {KNOWN_TO}",
                along(lattice.periodic())
            );
        }
        self.given(name, radius).map(|given| given.scene)
    }

    /// The particles, and the box in which they repeat: none where boundaries are open. Radii must
    /// be in the file or given.
    pub fn given(self, name: &str, radius: Option<f64>) -> anyhow::Result<Given> {
        let radii = match (self.radii, radius) {
            (None, None) => bail!(
                "{name} holds no radii; give --radius R (half the diameter; in an experiment \
                 radius = R), or add a column named r"
            ),
            (None, Some(radius)) => Radii::Uniform(radius),
            (Some(radii), _) => match radii.first() {
                Some(&first) if radii.iter().all(|&r| r == first) => Radii::Uniform(first),
                _ => Radii::Each(radii.into()),
            },
        };
        let scene = match self.centres {
            Centres::Plane(points) => AnyScene::from(
                Scene::<f64, 2>::new(points, radii).with_context(|| name.to_string())?,
            ),
            Centres::Space(points) => AnyScene::from(
                Scene::<f64, 3>::new(points, radii).with_context(|| name.to_string())?,
            ),
        };
        let Particles { lattice, has_box, notices, .. } = self;
        Ok(Given { scene, lattice, has_box, notices })
    }
}

/// What a column of a file means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// x, y or z, as 0, 1 or 2.
    Axis(usize),
    Radius,
    Diameter,
    /// The file's own number of the particle.
    Id,
    /// Something else, which is skipped.
    Other,
}

impl Column {
    /// What a column of that name holds.
    pub fn named(name: &str) -> Column {
        // A unit may follow, as in x [m] or radius (mm).
        let name = name.split(['[', '(']).next().unwrap_or_default().trim_end();
        match name.to_ascii_lowercase().as_str() {
            "x" => Column::Axis(0),
            "y" => Column::Axis(1),
            "z" => Column::Axis(2),
            "r" | "radius" | "radii" => Column::Radius,
            "d" | "diameter" | "diameters" => Column::Diameter,
            "id" => Column::Id,
            _ => Column::Other,
        }
    }

    /// A size must be finite and not negative; a diameter is halved.
    pub fn size(self, value: f64) -> Result<f64, &'static str> {
        match value {
            _ if !value.is_finite() => Err("is not a finite number"),
            _ if value < 0.0 => Err("is negative"),
            _ if self == Column::Diameter => Ok(0.5 * value),
            _ => Ok(value),
        }
    }
}

/// The columns of a file of text, by meaning, and their names for messages.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    pub meaning: Vec<Column>,
    pub names: Vec<String>,
    /// Lines may have more columns than these.
    pub or_more: bool,
}

impl Columns {
    /// Columns that mean what their names say.
    pub fn named(names: impl IntoIterator<Item = impl Into<String>>) -> Columns {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let mut meaning: Vec<Column> = names.iter().map(|name| Column::named(name)).collect();
        // ParaView calls the places Points:0, Points:1, Points:2, where nothing else is called so.
        if !meaning.contains(&Column::Axis(0)) {
            for (meaning, name) in meaning.iter_mut().zip(&names) {
                let name = name.to_ascii_lowercase().replace('_', ":");
                if let Some(k) =
                    ["points:0", "points:1", "points:2"].iter().position(|p| *p == name)
                {
                    *meaning = Column::Axis(k);
                }
            }
        }
        Columns { meaning, names, or_more: false }
    }

    /// With the meaning that the options give them, if they do.
    pub fn chosen(self, place: &str, options: Options) -> anyhow::Result<Columns> {
        match options.columns {
            Some(chosen) => chosen.apply(self, place),
            None => Ok(self),
        }
    }

    /// Checks that there are x and y, and nothing twice; gives an empty set of particles of that
    /// kind.
    pub fn particles(&self, place: &str, options: Options) -> anyhow::Result<Particles> {
        let count = |column| self.meaning.iter().filter(|&&other| other == column).count();
        for (k, column) in self.meaning.iter().enumerate() {
            let single = matches!(column, Column::Other | Column::Id) || count(*column) == 1;
            ensure!(
                single,
                "{place}: the column '{}' stands twice; remove one",
                short(&self.names[k])
            );
        }
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            ensure!(
                count(Column::Axis(axis)) == 1,
                "{place}: there is no column '{name}' among {}; name the columns x,y[,z][,r], \
                 with r, radius, d or diameter",
                self.names
                    .iter()
                    .map(|name| format!("'{}'", short(name)))
                    .take(8)
                    .collect::<Vec<_>>()
                    .join(", ")
            );
        }
        let sizes = count(Column::Radius) + count(Column::Diameter);
        ensure!(sizes <= 1, "{place}: there are a radius and a diameter column; remove one");
        let mut particles = Particles::new(2 + count(Column::Axis(2)), sizes == 1);
        particles.ids = (options.ids && count(Column::Id) == 1).then(Vec::new);
        particles.groups = options.without.map(|it| it.groups(self, place)).transpose()?;
        Ok(particles)
    }

    /// Where the radius comes from.
    pub fn radius(&self) -> RadiusSource {
        let named = |column| {
            self.meaning.iter().position(|&other| other == column).map(|k| self.names[k].clone())
        };
        match (named(Column::Radius), named(Column::Diameter)) {
            (Some(name), _) => RadiusSource::Column(name),
            (_, Some(name)) => RadiusSource::Halved(name),
            _ => RadiusSource::Missing,
        }
    }

    /// Adds the particle of one line. `between` says what separates the cells.
    pub fn push<'a>(
        &self,
        particles: &mut Particles,
        mut cells: impl Iterator<Item = &'a [u8]> + Clone,
        place: impl Fn() -> String,
        between: impl Fn() -> String,
    ) -> anyhow::Result<()> {
        let (mut point, mut radius, mut id, mut bad) = ([0.0; 3], 0.0, 0, None);
        let all = cells.clone();
        for (k, column) in self.meaning.iter().enumerate() {
            let Some(cell) = cells.next() else {
                bad = Some((k, ""));
                break;
            };
            match column {
                Column::Other => continue,
                Column::Id if particles.ids.is_none() => continue,
                Column::Id => {
                    match std::str::from_utf8(cell).ok().and_then(|cell| cell.parse().ok()) {
                        Some(value) => id = value,
                        // Nobody may need them; whoever does is told that there are none.
                        None => particles.ids = None,
                    }
                }
                Column::Axis(axis) => {
                    if particles.len() < digits::LOOKED_AT {
                        digits::count(&mut particles.digits, cell);
                    }
                    match number(cell) {
                        Some(value) if value.is_finite() => point[*axis] = value,
                        Some(_) => bad = Some((k, "is not a finite number")),
                        None => bad = Some((k, not_a_number(cell))),
                    }
                }
                Column::Radius | Column::Diameter => {
                    let value = number(cell).ok_or_else(|| not_a_number(cell));
                    match value.and_then(|value| column.size(value)) {
                        Ok(value) => radius = value,
                        Err(why) => bad = Some((k, why)),
                    }
                }
            }
            if bad.is_some() {
                break;
            }
        }
        if bad.is_some() || !self.or_more && cells.next().is_some() {
            let (count, wanted) = (all.clone().count(), self.meaning.len());
            ensure!(
                count == wanted || self.or_more && count > wanted,
                "{}: {count} columns where {wanted} are expected{}{}",
                place(),
                between(),
                if count == 2 * wanted { DECIMAL_COMMAS } else { "" }
            );
            if let Some((k, why)) = bad {
                let cell = all.clone().nth(k).unwrap_or_default();
                bail!(
                    "{}: column '{}': '{}' {why}; mend or remove the line",
                    place(),
                    short(&self.names[k]),
                    shown(cell)
                );
            }
        }
        if let Some(groups) = &mut particles.groups {
            // As many cells as columns: looked at above.
            groups.push(all.clone().nth(groups.column).unwrap_or_default())?;
        }
        particles.push(point, radius, id).with_context(place)
    }
}

/// What to do about 1,5 for 1.5.
pub(crate) const DECIMAL_COMMAS: &str = "; if the commas are decimal commas, write points";

fn not_a_number(cell: &[u8]) -> &'static str {
    if is_decimal_comma(cell) {
        "has a decimal comma, which is not read: write a point"
    } else {
        "is not a number"
    }
}

/// Is it 1,5 for 1.5?
pub(crate) fn is_decimal_comma(cell: &[u8]) -> bool {
    let point = |&b: &u8| if b == b',' { b'.' } else { b };
    let pointed: Vec<u8> = cell.iter().map(point).collect();
    cell.contains(&b',') && number(&pointed).is_some()
}

/// Particles of columns, and what was understood.
pub(crate) fn loaded(
    format: &'static str,
    particles: Particles,
    radius: RadiusSource,
) -> (Particles, About) {
    (particles, About { format, radius, ..About::default() })
}
