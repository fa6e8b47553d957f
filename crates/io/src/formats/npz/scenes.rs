//! The particles of an npz archive, in one frame or several.

use anyhow::{Context, bail, ensure};

use super::boxes::Cell;
use super::members;
use crate::columns::Column;
use crate::columns::chosen::Chosen;
use crate::formats::Indexed;
use crate::formats::npy::{self, Header};
use crate::frames::{Choice, Reader, Step};
use crate::options::{Opened, Options};
use crate::particles::sizes::{Ids, Size, one_of};
use crate::particles::{Loaded, Particles, loaded, unused_sizes};
use crate::raw::lines::{Source, short};
use crate::raw::room::{room, room_for};
use crate::raw::scalars::Kind;
use crate::types::{About, Notice, RadiusSource};

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Indexed::<Scenes>::new(source, options))
}

struct Points {
    values: Vec<f64>,
    frames: u64,
    rows: usize,
    columns: usize,
    label: String,
}

#[derive(Default)]
struct Scenes {
    axes: [Option<Vec<f64>>; 3],
    /// The array of points without frames, the source of its radii, and its name.
    whole: Option<(Particles, RadiusSource, String)>,
    frames: Option<Points>,
    sizes: Vec<(Size, Vec<u64>)>,
    around: Cell,
    ids: Vec<Ids>,
    names: Vec<String>,
    others: Vec<String>,
    /// Notices about arrays of sizes that are unused because the options give a radius.
    unused: Vec<Notice>,
}

impl Reader<Loaded> for Indexed<'_, Scenes> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<Loaded>> {
        let Indexed { source, options, index, next } = self;
        let name = source.name;
        let scenes = match index {
            Some(scenes) => scenes,
            None => {
                let mut read = Scenes::default();
                members(source, |member, file| read.member(member, file, *options))?;
                read.settle(name, *options)?;
                index.insert(read)
            }
        };
        let Some(count) = scenes.frames.as_ref().map(|points| points.frames) else {
            let first = std::mem::replace(next, 1) == 0;
            return first.then(|| scenes.frame(None, name, *options)).transpose();
        };
        while *next < count {
            let k = *next;
            let step = choice.begin(|| format!("{name}: frame {k}"))?;
            if step == Step::Stop {
                return Ok(None);
            }
            *next += 1;
            if step == Step::Keep {
                let frame = scenes.frame(Some(k), name, *options);
                return frame.with_context(|| format!("frame {k}")).map(Some);
            }
        }
        Ok(None)
    }
}

impl Scenes {
    fn member(
        &mut self,
        mut source: Source<'_>,
        file: &str,
        options: Options,
    ) -> anyhow::Result<()> {
        let Some(label) = file.strip_suffix(".npy") else { return Ok(()) };
        room(&mut self.names)?;
        self.names.push(label.to_string());
        let column = Chosen::meaning(options.columns, label);
        let is_box = matches!(column, Column::Other) && Cell::is_named(label);
        let header = match npy::any_header(&mut source) {
            Ok(header) => header,
            Err(_) if matches!(column, Column::Other | Column::Id) && !is_box => {
                self.others.push(label.to_string());
                return Ok(());
            }
            Err(error) => return Err(error),
        };
        let source = &mut source;
        match (&header.sizes[..], column) {
            _ if is_box => return self.around.take(source, &header, label, options),
            _ if !header.fields.is_empty() => {
                let read = npy::records(source, &header, options)?;
                self.alone(label, source.name)?;
                let radius = read.columns.radius();
                self.whole = Some((read.particles, radius, label.to_string()));
            }
            (&[_], _) if options.ids && Ids::is_named(label, column) => {
                let mut ids = Ids::new(label, column);
                header.values(source, header.count(), |_, value| ids.push(value))?;
                self.ids.push(ids);
            }
            (_, Column::Radius | Column::Diameter) if is_size(&header, label, options) => {
                ensure!(
                    !header.fortran || header.sizes.len() < 2 || header.sizes.contains(&1),
                    "{}: '{}' is {}; write it in C order, with numpy.ascontiguousarray",
                    source.name,
                    short(label),
                    header.words()
                );
                // Diameters are not halved yet, because they may turn out to be coordinates.
                let values = npy::list(source, &header, label, Column::Axis(0))?;
                let (label, of_cells) = (label.to_string(), false);
                self.sizes.push((Size { values, column, label, of_cells }, header.sizes.clone()));
            }
            (&[_, 2..=4], _) if header.is_real() => {
                let (particles, radius) = npy::particles(source, &header, options)?;
                self.alone(label, source.name)?;
                self.whole = Some((particles, radius, label.to_string()));
            }
            (&[frames, rows, 2..=4], _) if header.is_real() && frames.min(rows) > 0 => {
                return self.take_frames(source, &header, label);
            }
            (&[_] | &[_, 1], Column::Axis(k)) => {
                self.axes[k] = Some(npy::list(source, &header, label, column)?);
            }
            (_, Column::Axis(_)) => bail!(
                "{}: '{}' is {}; x, y and z have one number for each particle, shape (N,); frames \
                 are one array of shape (frames, N, 3): numpy.stack([x, y, z], axis=-1)",
                source.name,
                short(label),
                header.words()
            ),
            _ => self.others.push(label.to_string()),
        }
        Ok(())
    }

    fn alone(&self, label: &str, place: &str) -> anyhow::Result<()> {
        if let Some(other) = self.points() {
            bail!(
                "{place}: both '{}' and '{}' could hold the particles; keep one array of points",
                short(other),
                short(label)
            );
        }
        Ok(())
    }

    fn points(&self) -> Option<&String> {
        let whole = self.whole.as_ref().map(|(.., label)| label);
        whole.or(self.frames.as_ref().map(|points| &points.label))
    }

    fn take_frames(
        &mut self,
        source: &mut Source<'_>,
        header: &Header,
        label: &str,
    ) -> anyhow::Result<()> {
        self.alone(label, source.name)?;
        ensure!(
            !header.fortran,
            "{}: '{}' is {}; write frames in C order, with numpy.ascontiguousarray",
            source.name,
            short(label),
            header.words()
        );
        let &[frames, rows, columns] = &header.sizes[..] else { return Ok(()) };
        let values = npy::list(source, header, label, Column::Axis(0))?;
        let label = label.to_string();
        let (rows, columns) = (rows as usize, columns as usize);
        self.frames = Some(Points { values, frames, rows, columns, label });
        Ok(())
    }

    /// Decides which array holds the points of all frames, and which holds their sizes.
    fn settle(&mut self, name: &str, options: Options) -> anyhow::Result<()> {
        if let Some(chosen) = options.columns {
            chosen.among(&self.names, name)?;
        }
        let has = |label: &str| self.others.iter().any(|other| other.eq_ignore_ascii_case(label));
        let sure = options.columns.is_some_and(|chosen| chosen.sizes());
        if !sure && has("g") && has("b") {
            let red = |(size, _): &mut (Size, Vec<u64>)| size.label.eq_ignore_ascii_case("r");
            let red: Vec<_> = self.sizes.extract_if(.., red).collect();
            self.others.extend(red.into_iter().map(|(size, _)| size.label));
        }
        self.places(name, options)?;
        if let Some(given) = options.radius {
            let unused = self.sizes.drain(..).map(|(size, _)| unused_sizes(&size.label, given));
            self.unused.extend(unused);
        }
        match (self.points(), &self.axes) {
            (Some(_), [None, None, None]) | (None, [Some(_), Some(_), _]) => Ok(()),
            (Some(label), _) => bail!(
                "{name} holds points in '{}' and in x, y, z, too; keep one of them",
                short(label)
            ),
            (None, _) => bail!(
                "{name} holds neither arrays x and y nor one of shape (N, 2) to (N, 4), or \
                 (frames, N, 2) to (frames, N, 4), in f8 or f4"
            ),
        }
    }

    /// If no other array holds points, uses an array of sizes with 2 to 4 columns as points.
    fn places(&mut self, name: &str, options: Options) -> anyhow::Result<()> {
        if self.points().is_some() || self.axes.iter().any(Option::is_some) {
            return Ok(());
        }
        let rows = |(_, shape): &(Size, Vec<u64>)| matches!(shape[..], [_, 2..=4]);
        if let Some(k) = self.sizes.iter().position(rows) {
            let (size, shape) = self.sizes.swap_remove(k);
            let (particles, radius) = of_rows(&size.values, shape[1] as usize, name, options)?;
            self.whole = Some((particles, radius, size.label));
        }
        Ok(())
    }

    fn frame(&mut self, k: Option<u64>, name: &str, options: Options) -> anyhow::Result<Loaded> {
        let frame = k.zip(self.frames.as_ref()).map(|(k, points)| [k, points.frames]);
        let (mut particles, mut radius) = match (&self.frames, self.whole.take()) {
            (Some(Points { values, rows, columns, .. }), _) => {
                let values = &values[k.unwrap_or(0) as usize * rows * columns..][..rows * columns];
                of_rows(values, *columns, name, options)?
            }
            (None, Some((particles, radius, _))) => (particles, radius),
            (None, None) => {
                (npy::zip(std::mem::take(&mut self.axes), name)?, RadiusSource::Missing)
            }
        };
        let n = particles.len();
        particles.ids = particles.ids.or_else(|| Ids::of(self.ids.clone(), n));
        particles.notices.extend(self.unused.iter().cloned());
        let mut sizes = Vec::new();
        for (size, shape) in &self.sizes {
            let values = of_frame(size, shape, n, frame).with_context(|| name.to_string())?;
            let (column, label) = (size.column, size.label.clone());
            sizes.push(Size { values, column, label, of_cells: false });
        }
        if let Some(size) = one_of(sizes, name, &mut particles.notices)? {
            ensure!(
                !particles.has_radii(),
                "{name} holds radii in the array of points and in '{}', too; keep one of them",
                short(&size.label)
            );
            (radius, particles.radii) = size.radii();
        }
        particles.unused.extend(self.others.iter().take(256).cloned());
        let declared = self.around.declared(frame, name, options, &mut particles.notices)?;
        let (particles, about) = loaded("NumPy npz", particles, radius);
        Ok((particles, About { declared, ..about }))
    }
}

fn of_rows(
    values: &[f64],
    columns: usize,
    name: &str,
    options: Options,
) -> anyhow::Result<(Particles, RadiusSource)> {
    let (mut particles, radius) = npy::of_rows(columns, options);
    particles.extend(values, columns)?;
    let bad = particles.radii.iter().flatten().position(|r| *r < 0.0);
    ensure!(bad.is_none(), "{name}: the radius of particle {} is negative", bad.unwrap_or(0));
    Ok((particles, radius))
}

/// Whether the array has sizes. Bytes named r are colours (red), unless they are chosen.
fn is_size(header: &Header, label: &str, options: Options) -> bool {
    let chosen = options.columns.is_some_and(|chosen| chosen.sizes());
    chosen || header.kind != Kind::U8 || !label.eq_ignore_ascii_case("r")
}

/// Returns the radii of one frame; the array may hold one for all, one per particle, or one per
/// particle and frame.
fn of_frame(
    size: &Size,
    shape: &[u64],
    n: usize,
    frame: Option<[u64; 2]>,
) -> anyhow::Result<Vec<f64>> {
    let (values, one) = (&size.values, shape.iter().all(|&length| length == 1));
    let mut radii = Vec::new();
    room_for(&mut radii, n)?;
    match (shape, frame) {
        (&[length] | &[length, 1], _) if length == n as u64 => radii.extend(values),
        (&[frames, length], Some([k, of])) if (frames, length) == (of, n as u64) => {
            radii.extend(&values[k as usize * n..][..n]);
        }
        _ if one && values.len() == 1 => radii.resize(n, values[0]),
        _ => bail!(
            "{n} points, but '{}' has the shape {}; write one number for all, or one for each \
             particle, shape ({n},)",
            short(&size.label),
            npy::shape(shape)
        ),
    }
    for (k, radius) in radii.iter_mut().enumerate() {
        let of = size.column.value(*radius);
        *radius = of.map_err(|why| {
            anyhow::anyhow!("particle {k} (from 0): '{}': {radius} {why}", short(&size.label))
        })?;
    }
    Ok(radii)
}
