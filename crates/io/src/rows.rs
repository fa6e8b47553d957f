//! Particles from the rows of a table.

use anyhow::{Context, anyhow, bail};

use crate::columns::shapes::Clump;
use crate::columns::{Column, Columns};
use crate::options::Options;
use crate::particles::{Loaded, Particles, loaded, unused_sizes};
use crate::raw::lines::{Lines, Separator, listed, number, short, shown, whole};
use contactbench_terms::number::plural;

/// Doubtful columns, and the columns that make them so: colours, bands of telescopes, errors of a
/// redshift.
const DOUBTS: [(&str, &str, &str); 2] = [
    ("r", "g+b g+i", "--columns r=r if it is, or --radius R"),
    ("z", "zerr z_err g+i", "--columns x=x,y=y,z=z if it is, or x=x,y=y"),
];

pub struct Rows {
    pub columns: Columns,
    pub particles: Particles,
}

impl Columns {
    pub fn rows(self, place: &str, options: Options) -> anyhow::Result<Rows> {
        let mut columns = self.chosen(place, options.columns)?;
        let particles = columns.particles(place, options)?;
        Ok(Rows { columns, particles })
    }

    /// Resolves the meaning of all columns, and returns an empty set of particles. A radius from
    /// the options replaces columns of sizes.
    pub fn particles(&mut self, place: &str, options: Options) -> anyhow::Result<Particles> {
        let mut notices = Vec::new();
        if let Some(given) = options.radius {
            let sizes = self.meaning.iter_mut().zip(&self.names).filter(|(it, _)| it.is_size());
            notices.extend(sizes.map(|(meaning, name)| {
                *meaning = Column::Other;
                unused_sizes(name, given)
            }));
        }
        self.check(place)?;
        self.doubts(place, options)?;
        let has_radii = self.meaning.iter().any(|column| column.is_size());
        let mut particles = Particles::new(2 + usize::from(self.has(Column::Axis(2))), has_radii);
        let ids = self.meaning.iter().filter(|column| **column == Column::Id).count();
        particles.ids = (options.ids && ids == 1).then(Vec::new);
        particles.groups = options.without.map(|it| it.groups(self, place)).transpose()?;
        particles.clump = Clump::of(&self.names);
        let unused = self.meaning.iter().zip(&self.names);
        let unused = unused.filter(|(meaning, _)| **meaning == Column::Other);
        particles.unused = unused.map(|(_, name)| name.clone()).collect();
        particles.notices = notices;
        Ok(particles)
    }

    /// Refuses a radius or a coordinate beside columns that show that it may be something else.
    fn doubts(&self, place: &str, options: Options) -> anyhow::Result<()> {
        let has = |wanted: &str| self.names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
        for (doubted, companions, ways) in DOUBTS {
            let column = Column::named(doubted);
            let chosen = options.axes_chosen() || column.is_size() && options.sizes_chosen();
            let beside = companions.split(' ').find(|it| it.split('+').all(has));
            if let Some(beside) = beside.filter(|_| !chosen && self.has(column) && has(doubted)) {
                let (what, beside) = (column.words(), beside.replace('+', "' and '"));
                bail!("{place}: '{doubted}' beside '{beside}' may not be {what}; give {ways}");
            }
        }
        Ok(())
    }

    /// Adds the particle of one line.
    pub fn push<'a>(
        &self,
        particles: &mut Particles,
        mut cells: impl Iterator<Item = &'a [u8]> + Clone,
        place: impl Fn() -> String,
    ) -> anyhow::Result<()> {
        let (mut point, mut radius, mut id, mut bad) = ([0.0; 3], 0.0, 0, None);
        let all = cells.clone();
        for (k, &column) in self.meaning.iter().enumerate() {
            let Some(cell) = cells.next() else {
                // A number that ends the line may be cut off, so an unused cell follows the used.
                let unused =
                    self.meaning[k.saturating_sub(1)..].iter().all(|it| *it == Column::Other);
                bad = (!self.or_fewer || !unused).then_some((k, ""));
                break;
            };
            match column {
                Column::Other => continue,
                Column::Id if particles.ids.is_none() => continue,
                // Faulty ids are dropped without an error because they may not be needed.
                Column::Id => match whole(cell) {
                    Some(value) => id = value,
                    None => particles.ids = None,
                },
                _ => match (value(column, cell), column) {
                    (Ok(value), Column::Axis(axis)) => point[axis] = value,
                    (Ok(value), _) => radius = value,
                    (Err(why), _) => {
                        bad = Some((k, why));
                        break;
                    }
                },
            }
        }
        if bad.is_some() || !self.or_more && cells.any(|cell| !cell.is_empty()) {
            return Err(self.fault(all, bad).context(place()));
        }
        if let Some(groups) = &mut particles.groups {
            groups.push(all.clone().nth(groups.column).unwrap_or_default())?;
        }
        if let Some(clump) = &mut particles.clump {
            clump.see(all.clone().nth(clump.column).unwrap_or_default());
        }
        particles.push(point, radius, id).with_context(place)
    }

    /// Returns why a line is not a particle: its number of cells, or else that of the `bad` one.
    fn fault<'a>(
        &self,
        mut cells: impl Iterator<Item = &'a [u8]> + Clone,
        bad: Option<(usize, &str)>,
    ) -> anyhow::Error {
        let (count, wanted) = (cells.clone().count(), self.meaning.len());
        if let Some((k, why)) = bad.filter(|_| count == wanted || self.or_more && count > wanted) {
            let cell = shown(cells.nth(k).unwrap_or_default());
            let name = short(&self.names[k]);
            return anyhow!("column '{name}': '{cell}' {why}; fix or remove the line");
        }
        let (count, names) = (plural(count, "column"), listed(&self.names));
        anyhow!("{count} where {wanted} are expected ({names}); fix or remove the line")
    }
}

fn value(column: Column, cell: &[u8]) -> Result<f64, &'static str> {
    match number(cell) {
        Some(value) => column.value(value),
        None => Err("is not a number"),
    }
}

impl Rows {
    /// Returns a frame without rows whose columns are `names`, for a file that does not name them.
    pub fn none(names: &str) -> Rows {
        Rows { columns: Columns::of(names), particles: Particles::new(3, false) }
    }

    pub fn read(self, format: &'static str) -> Loaded {
        loaded(format, self.particles, self.columns.radius())
    }

    pub fn push(&mut self, line: &[u8], lines: &Lines<'_>) -> anyhow::Result<()> {
        let Rows { columns, particles } = self;
        columns.push(particles, Separator::Blanks.cells(line), || lines.place())
    }
}
