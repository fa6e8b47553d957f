//! The particles of an npz archive, in one frame or several.

use anyhow::{Context, anyhow, bail, ensure};

use super::boxes::Cell;
use super::members;
use crate::columns::Column;
use crate::columns::chosen::Chosen;
use crate::formats::Indexed;
use crate::formats::npy::{self, Header};
use crate::frames::Framed;
use crate::options::{Opened, Options};
use crate::particles::sizes::{Size, radii};
use crate::particles::{Loaded, Particles, loaded, unused_sizes};
use crate::raw::lines::{Source, among, exact, short};
use crate::raw::room::{room, room_for};
use crate::types::{About, Notice, RadiusSource, assumed};

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Indexed::<Scenes>::new(source, options))
}

/// Names of arrays that are taken for points before others, in lower case.
const POINTS: &str = "points positions position pos coords coordinates xyz r centers centres";

/// An array of sizes, which is in memory while frames are read.
struct Array {
    header: Header,
    label: String,
    column: Column,
}

#[derive(Default)]
struct Scenes {
    axes: [Option<Vec<f64>>; 3],
    /// Particles of an archive without frames, and the source of their radii.
    whole: Option<anyhow::Result<(Particles, RadiusSource)>>,
    frames: Option<Header>,
    /// Arrays that may hold the points, any read one first; whether each is chosen or usual.
    points: Vec<(bool, String)>,
    sizes: Vec<Array>,
    around: Cell,
    /// Ids; `None` if there are none, or if a number is not whole.
    ids: Option<Vec<i64>>,
    names: Vec<String>,
    others: Vec<String>,
    /// Notices about arrays of sizes that are unused because the options give a radius.
    unused: Vec<Notice>,
}

impl Framed for Indexed<'_, Scenes> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        let options = self.options;
        let read = |source: &mut Source<'_>| {
            let mut read = Scenes::default();
            members(source, |mut member, file| read.member(&mut member, file, options))?;
            read.settle(source.name, options)?;
            Ok(read)
        };
        self.next_of(read, |scenes| scenes.count().unwrap_or(1))
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let Indexed { source, options, index: Some(scenes), next } = self else { return Ok(None) };
        let k = *next - 1;
        let read = keep.then(|| scenes.frame(k, source, *options)).transpose();
        if scenes.count().is_some() { read.with_context(|| format!("frame {k}")) } else { read }
    }
}

impl Scenes {
    fn count(&self) -> Option<u64> {
        self.frames.as_ref()?.frames
    }

    fn member(
        &mut self,
        source: &mut Source<'_>,
        file: &str,
        options: Options,
    ) -> anyhow::Result<()> {
        let Some(label) = file.strip_suffix(".npy") else { return Ok(()) };
        room(&mut self.names)?;
        self.names.push(label.to_string());
        let column = Chosen::meaning(options.columns, label);
        let is_box = column == Column::Other && Cell::is_named(label);
        let mut header = match npy::any_header(source) {
            Ok(header) => header,
            Err(_) if matches!(column, Column::Other | Column::Id) && !is_box => {
                self.others.push(label.to_string());
                return Ok(());
            }
            Err(error) => return Err(error),
        };
        match (&header.sizes[..], column) {
            _ if is_box => self.around.take(source, &mut header, label, options)?,
            (&[_], Column::Id) if options.ids => {
                let ids = npy::list(source, &mut header, label, column)?;
                self.ids = ids.into_iter().map(exact).collect();
            }
            (sizes, Column::Radius | Column::Diameter) if sizes.len() < 3 => {
                header.keep(source)?;
                self.sizes.push(Array { header, label: label.to_string(), column });
            }
            (&[_, 2..=4], _) if header.is_real() && self.takes(label, column, options) => {
                // A later array may replace this one.
                self.whole = Some(npy::particles(source, &mut header, options));
            }
            (&[frames, rows, 2..=4], _)
                if header.is_real()
                    && frames.min(rows) > 0
                    && self.takes(label, column, options) =>
            {
                header.keep(source)?;
                self.frames = Some(header);
            }
            (&[_, 2..=4] | &[_, _, 2..=4], _) if header.is_real() => {
                self.others.push(label.to_string());
            }
            (&[_] | &[_, 1], Column::Axis(k)) => {
                self.axes[k] = Some(npy::list(source, &mut header, label, column)?);
            }
            (_, Column::Axis(_)) => {
                bail!("{}: x, y, z have the shape (N,); frames are one (frames, N, 3)", source.name)
            }
            _ => self.others.push(label.to_string()),
        }
        Ok(())
    }

    /// Whether an array of points replaces the one found before: it is the chosen one, or its name
    /// is more [usual](POINTS).
    fn takes(&mut self, label: &str, column: Column, options: Options) -> bool {
        let chosen = options.columns.is_some_and(|chosen| chosen.points());
        let usual = !chosen && among(POINTS, &label.to_ascii_lowercase());
        let array = (column == Column::Points || usual, label.to_string());
        let first = !options.axes_chosen() && (!chosen || array.0);
        let first = first && self.points.iter().all(|(usual, _)| !usual && array.0);
        if first {
            (self.whole, self.frames) = (None, None);
            self.points.insert(0, array);
        } else {
            self.points.push(array);
        }
        first
    }

    /// Decides which array holds the points of all frames, and which holds their sizes.
    fn settle(&mut self, name: &str, options: Options) -> anyhow::Result<()> {
        if let Some(chosen) = options.columns {
            chosen.among(&self.names, name)?;
        }
        if let Some(given) = options.radius {
            let unused = self.sizes.drain(..).map(|size| unused_sizes(&size.label, given));
            self.unused.extend(unused);
        }
        let chosen = options.columns.is_some_and(|chosen| chosen.points());
        let by_axes = matches!(self.axes, [Some(_), Some(_), _]);
        let has_points = self.whole.is_some() || self.frames.is_some();
        let Some((usual, label)) = self.points.first().filter(|_| has_points) else {
            ensure!(by_axes, "{name} has no arrays x and y, and none ([frames,] N, 2 to 4)");
            return Ok(());
        };
        let label = short(label);
        let other = self.points.get(1);
        // Beside discs z may be the third coordinate, beside spheres it is another number.
        let axes = by_axes || self.is_flat() && self.axes.iter().any(Option::is_some);
        let doubt = other.filter(|it| it.0 == *usual).map(|it| format!("'{}'", short(&it.1)));
        let doubt = doubt.or((axes && (*usual || !by_axes)).then(|| "x, y, z".into()));
        if let Some(other) = doubt.filter(|_| !chosen) {
            bail!(
                "{name}: '{label}' and {other} could both hold the particles; give --columns \
                 points=NAME, or x=x,y=y,z=z"
            );
        }
        let (taken, left) = match other {
            _ if axes && !chosen => ("x, y, z".to_string(), label),
            Some((_, other)) if !chosen => (format!("'{label}'"), short(other)),
            _ => return Ok(()),
        };
        if axes {
            (self.whole, self.frames) = (None, None);
        }
        self.unused.push(assumed!(
            "the particles are read from {taken}, not from '{left}'; --columns points=NAME changes \
             this"
        ));
        Ok(())
    }

    fn is_flat(&self) -> bool {
        self.whole.iter().flatten().any(|whole| whole.0.dim() == 2)
            || self.frames.iter().any(|frames| frames.sizes.last() == Some(&2))
    }

    fn frame(
        &mut self,
        k: u64,
        source: &mut Source<'_>,
        options: Options,
    ) -> anyhow::Result<Loaded> {
        let (name, frame) = (source.name, self.count().map(|frames| [k, frames]));
        let (mut particles, mut radius) = match (&mut self.frames, self.whole.take()) {
            (Some(points), _) => {
                points.kept(k);
                npy::particles(source, points, options)?
            }
            (None, Some(whole)) => whole?,
            (None, None) => {
                (npy::zip(std::mem::take(&mut self.axes), name)?, RadiusSource::Missing)
            }
        };
        let n = particles.len();
        particles.ids = self.ids.clone().filter(|ids| ids.len() == n);
        particles.notices.extend(self.unused.iter().cloned());
        let of_frame = |size| of_frame(size, n, frame).with_context(|| name.to_string());
        let sizes = self.sizes.iter_mut().map(of_frame).collect::<anyhow::Result<_>>()?;
        let (source, radii) = radii(sizes, name)?;
        if radii.is_some() {
            let twice = particles.has_radii();
            ensure!(!twice, "{name} holds radii in the array of points and in another; keep one");
            (radius, particles.radii) = (source, radii);
        }
        particles.unused.extend(self.others.iter().take(256).cloned());
        let declared = self.around.declared(frame, name, options)?;
        let (particles, about) = loaded("NumPy npz", particles, radius);
        Ok((particles, About { declared, ..about }))
    }
}

/// Returns the sizes of one frame. The array has one size in all, one per particle, or one per
/// particle and frame.
fn of_frame(size: &mut Array, n: usize, frame: Option<[u64; 2]>) -> anyhow::Result<Size> {
    let Array { header, label, column } = size;
    let (shape, mut values) = (header.sizes.clone(), Vec::new());
    let all = header.kept(0);
    room_for(&mut values, n)?;
    match (&shape[..], frame) {
        (&[length] | &[length, 1], _) if length == n as u64 => values.extend(all),
        (&[frames, length], Some([k, of])) if (frames, length) == (of, n as u64) => {
            values.extend(&all[k as usize * n..][..n]);
        }
        _ if all.len() == 1 => values.resize(n, all[0]),
        _ => bail!(
            "'{}' has the shape {}; for {n} particles give it one number, or the shape ({n},)",
            short(label),
            npy::shape(&shape)
        ),
    }
    for (k, value) in values.iter_mut().enumerate() {
        let of = column.value(*value);
        *value =
            of.map_err(|why| anyhow!("particle {k} (from 0): '{}': {value} {why}", short(label)))?;
    }
    Ok(Size { values, column: *column, label: label.clone(), of_cells: false })
}
