//! Columns of a text file: their meaning, and particles from their rows.

pub(super) mod chosen;
pub(super) mod counted;
mod doubts;
mod rows;
pub(super) mod units;

use anyhow::{Context, bail, ensure};

use crate::columns::units::shifted;
use crate::particles::{Particles, digits, unused_sizes};
use crate::raw::lines::{MINUS, decoded, number, short, shown, whole};
use crate::{Notice, Options, RadiusSource};
use contactbench_terms::number::plural;
pub use rows::Rows;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Axis 0, 1 or 2 for x, y or z.
    Axis(usize),
    Radius,
    Diameter,
    Id,
    Other,
}

impl Column {
    pub fn named(name: &str) -> Column {
        match units::split(name).0.to_ascii_lowercase().as_str() {
            "x" => Column::Axis(0),
            "y" => Column::Axis(1),
            "z" => Column::Axis(2),
            "r" | "radius" | "radii" => Column::Radius,
            "d" | "diameter" | "diameters" => Column::Diameter,
            "id" => Column::Id,
            _ => Column::Other,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Column::Axis(axis) => ["x", "y", "z"].get(axis).copied().unwrap_or("a coordinate"),
            Column::Radius => "the radius",
            Column::Diameter => "the diameter",
            Column::Id => "the id",
            Column::Other => "something else",
        }
    }

    pub fn size(self, value: f64) -> Result<f64, &'static str> {
        match value {
            _ if !value.is_finite() => Err("is not a finite number"),
            _ if value < 0.0 => Err("is negative"),
            _ if self == Column::Diameter => Ok(0.5 * value),
            _ => Ok(value),
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct Columns {
    pub meaning: Vec<Column>,
    pub names: Vec<String>,
    /// Whether lines may have more columns than the named ones.
    pub or_more: bool,
    /// Whether the user chose the column of sizes; then its name is trusted.
    pub sizes_chosen: bool,
    /// The power of ten that each column is multiplied by; empty if all are 0.
    pub powers: Vec<i32>,
    pub notices: Vec<Notice>,
}

impl Columns {
    pub fn named(names: impl IntoIterator<Item = impl Into<String>>) -> Columns {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let mut meaning: Vec<Column> = names.iter().map(|name| Column::named(name)).collect();
        let is_axis = |meaning: &Column| matches!(meaning, Column::Axis(_));
        // ParaView names coordinates Points:0, Points:1, Points:2.
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
        if !meaning.iter().any(is_axis) {
            for (meaning, name) in meaning.iter_mut().zip(&names) {
                match units::suffixed(name).map(|(name, _)| Column::named(name)) {
                    None | Some(Column::Id) => {}
                    Some(suffixed) => *meaning = suffixed,
                }
            }
        }
        Columns { meaning, names, ..Columns::default() }
    }

    pub fn has_places(&self) -> bool {
        (0..2).all(|axis| self.meaning.contains(&Column::Axis(axis)))
    }

    pub fn rows(self, place: &str, options: Options) -> anyhow::Result<Rows> {
        let mut columns = self.chosen(place, options)?;
        let particles = columns.particles(place, options)?;
        Ok(Rows { columns, particles })
    }

    pub fn chosen(self, place: &str, options: Options) -> anyhow::Result<Columns> {
        match options.columns {
            Some(chosen) => chosen.apply(self, place),
            None => Ok(self),
        }
    }

    /// Resolves the meaning of all columns, and returns an empty set of particles. A radius from
    /// the options replaces columns of sizes. Lengths in several units are converted to one unit.
    pub fn particles(&mut self, place: &str, options: Options) -> anyhow::Result<Particles> {
        self.leave_out_sizes(options.radius);
        self.leave_out_doubts();
        self.check(place)?;
        self.one_unit().with_context(|| place.to_string())?;
        let count = |column| self.meaning.iter().filter(|&&other| other == column).count();
        let sizes = count(Column::Radius) + count(Column::Diameter);
        let mut particles = Particles::new(2 + count(Column::Axis(2)), sizes == 1);
        particles.ids = (options.ids && count(Column::Id) == 1).then(Vec::new);
        particles.groups = options.without.map(|it| it.groups(self, place)).transpose()?;
        let unused = self.meaning.iter().zip(&self.names);
        let unused = unused.filter(|(meaning, _)| **meaning == Column::Other);
        particles.unused = unused.map(|(_, name)| name.clone()).collect();
        particles.notices.append(&mut self.notices);
        Ok(particles)
    }

    fn leave_out_sizes(&mut self, given: Option<f64>) {
        let Some(given) = given else { return };
        for (meaning, name) in self.meaning.iter_mut().zip(&self.names) {
            if let Column::Radius | Column::Diameter = meaning {
                *meaning = Column::Other;
                self.notices.push(unused_sizes(name, given));
            }
        }
    }

    fn leave_out_doubts(&mut self) {
        let doubt = |(meaning, name): (&Column, &String)| match meaning {
            Column::Radius | Column::Diameter => Some(doubts::of_size(name, &self.names).is_some()),
            _ => None,
        };
        let sizes: Vec<Option<bool>> = self.meaning.iter().zip(&self.names).map(doubt).collect();
        if self.sizes_chosen || !sizes.contains(&Some(false)) {
            return;
        }
        for (meaning, _) in self.meaning.iter_mut().zip(sizes).filter(|it| it.1 == Some(true)) {
            *meaning = Column::Other;
        }
    }

    fn check(&self, place: &str) -> anyhow::Result<()> {
        let named = |column: Column| {
            let all = self.meaning.iter().zip(&self.names);
            all.filter(move |(meaning, _)| **meaning == column).map(|(_, name)| short(name))
        };
        for column in self.meaning.iter().filter(|it| !matches!(it, Column::Other | Column::Id)) {
            if let [a, b, ..] = &named(*column).collect::<Vec<_>>()[..] {
                bail!(
                    "{place}: the columns '{a}' and '{b}' both mean {}; remove one, or choose one \
                     with --columns",
                    column.words()
                );
            }
        }
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            ensure!(
                named(Column::Axis(axis)).next().is_some(),
                "{place}: there is no column '{name}' among {}; name the columns x,y[,z][,r], \
                 with r, radius, d or diameter, or say which they are with --columns \
                 x=NAME,y=NAME{}",
                self.names
                    .iter()
                    .map(|name| format!("'{}'", short(name)))
                    .take(8)
                    .collect::<Vec<_>>()
                    .join(", "),
                if self.names.iter().any(|name| name.contains(['|', ':'])) {
                    SEPARATED
                } else {
                    ""
                }
            );
        }
        if let (Some(r), Some(d)) = (named(Column::Radius).next(), named(Column::Diameter).next()) {
            bail!(
                "{place}: there are a radius '{r}' and a diameter '{d}'; remove one, or choose \
                 one: --columns r={r} or --columns d={d}"
            );
        }
        for (meaning, name) in self.meaning.iter().zip(&self.names) {
            if let Column::Radius | Column::Diameter = meaning
                && !self.sizes_chosen
                && let Some(why) = doubts::of_size(name, &self.names)
            {
                bail!("{place}: {why}");
            }
        }
        Ok(())
    }

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

    fn value(&self, k: usize, cell: &[u8]) -> Option<f64> {
        match self.powers.get(k) {
            None | Some(0) => number(cell),
            Some(&power) => number(&shifted(cell, power)),
        }
    }

    /// Adds the particle of one line. `between` describes the separator, for messages.
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
                    match whole(cell) {
                        Some(value) => id = value,
                        // Faulty ids are dropped without an error because they may not be needed.
                        None => particles.ids = None,
                    }
                }
                Column::Axis(axis) => {
                    if particles.len() < digits::LOOKED_AT {
                        digits::count(&mut particles.digits, cell);
                    }
                    match self.value(k, cell) {
                        Some(value) if value.is_finite() => point[*axis] = value,
                        Some(_) => bad = Some((k, "is not a finite number")),
                        None => bad = Some((k, not_a_number(cell))),
                    }
                }
                Column::Radius | Column::Diameter => {
                    let value = self.value(k, cell).ok_or_else(|| not_a_number(cell));
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
                "{}: {} where {wanted} are expected{}{}",
                place(),
                plural(count, "column"),
                between(),
                match () {
                    () if count == 2 * wanted => DECIMAL_COMMAS,
                    () if count == wanted + 1 && particles.is_empty() => ROW_NAMES,
                    () => "",
                }
            );
            if let Some((k, why)) = bad {
                let cell = all.clone().nth(k).unwrap_or_default();
                let (place, name) = (place(), &self.names[k]);
                ensure!(
                    !all.map(decoded).eq(self.names.iter().cloned()),
                    "{place}: the header is there again, as where files are joined; remove the line"
                );
                bail!(
                    "{place}: column '{}': '{}' {why}; mend or remove the line",
                    short(name),
                    shown(cell)
                );
            }
        }
        if let Some(groups) = &mut particles.groups {
            groups.push(all.clone().nth(groups.column).unwrap_or_default())?;
        }
        particles.push(point, radius, id).with_context(place)
    }
}

pub(crate) const DECIMAL_COMMAS: &str = "; if the commas are decimal commas, write points";

/// Remedy for row names, which R's write.table writes without a header.
const ROW_NAMES: &str = "; if the first column has the names of rows and no header, as R's \
                         write.table writes it, give row.names = FALSE there, or col.names = NA";

/// Separators of columns, for messages.
const SEPARATED: &str = "; columns are separated by commas, semicolons, tabs or blanks";

fn not_a_number(cell: &[u8]) -> &'static str {
    let text = decoded(cell);
    if cell.is_empty() {
        "is empty, not a number"
    } else if is_decimal_comma(cell) {
        "has a decimal comma, which is not read: write a point"
    } else if number(&without(cell, b',')).is_some() {
        "has commas between thousands, which are not read: write it without"
    } else if text.contains(MINUS) {
        "has a dash for a minus sign: write '-'"
    } else if number(text.trim().as_bytes()).is_some() {
        "has a blank that is not plain: remove it"
    } else if units::known(text.trim_matches(['[', ']', '(', ')'])).is_some() {
        "is a unit: write it behind the name, as in 'x [mm]', before the line is removed"
    } else {
        "is not a number"
    }
}

fn without(cell: &[u8], sign: u8) -> Vec<u8> {
    cell.iter().copied().filter(|&b| b != sign).collect()
}

pub(crate) fn is_decimal_comma(cell: &[u8]) -> bool {
    let point = |&b: &u8| if b == b',' { b'.' } else { b };
    let pointed: Vec<u8> = cell.iter().map(point).collect();
    cell.contains(&b',') && number(&pointed).is_some()
}
