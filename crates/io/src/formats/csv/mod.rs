//! CSV and other tables, including the text files of YADE and Woo: one particle per line.
//!
//! * The header names the columns: `x,y[,z][,r]`, with `r`, `radius`, `d` or `diameter`, in any
//!   order and case. Units of length may follow the names. Other columns are skipped.
//! * The separator is found in the first line: semicolon, else comma, else tab, else blanks. Quoted
//!   text may contain separators and doubled quotes, but no line breaks.
//! * A column of frames, steps or times splits rows into frames; see [`split`] and [`repeats`].
//! * Blank lines and lines that start with `#`, `%`, `!` or `//` are skipped. If the rows have no
//!   header, such a line is the header if it names as many columns as the rows have.
//! * `#` or `%` after a blank starts a comment, unless the line has the right number of columns
//!   only with it.
//! * `#format x_y_z_r` of YADE names the columns; `#format x_y_z_r_attrs` allows further ones.
//!   `##PERIODIC:: 10 10 10` of YADE and Woo is the box; then unnamed columns are x y z r clumpId.
//! * Without a header, two numeric columns are x,y and four are x,y,z,r. Three are x,y,z if the
//!   options give a radius or three dimensions, and x,y,r if they give two dimensions. Other
//!   numbers of columns are refused.

mod header;
mod repeats;
mod split;

use anyhow::{Context, ensure};

use crate::columns::Columns;
use crate::doubts;
use crate::formats::csv::header::Header;
use crate::formats::csv::repeats::Repeats;
use crate::frames::{Choice, Reader, Step};
use crate::options::{Opened, Options};
use crate::particles::{Loaded, Particles, loaded};
use crate::raw::lines::{Lines, Separator, Source, among, is_comment, listed, uncommented};
use crate::types::{RadiusSource, assumed};

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Csv { lines: Lines::new(source), options, table: None })
}

struct Csv<'a> {
    lines: Lines<'a>,
    options: Options,
    /// The table as its first lines describe it; `None` before they are read.
    table: Option<Header>,
}

impl Reader<Loaded> for Csv<'_> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<Loaded>> {
        let Csv { lines, options, table } = self;
        let table = match table {
            Some(table) => table,
            None => table.insert(header::read(lines, *options)?),
        };
        // Later rows may belong to an earlier frame, so all rows are read to check this.
        choice.through = table.split.is_some();
        while choice.seen == 0 || table.is_row {
            let step = choice.begin(|| lines.place())?;
            let mut columns = table.columns.clone();
            let mut kept = columns.particles(&table.place, *options)?;
            let is_kept = step == Step::Keep;
            let read = table.rows(lines, &columns, Some(&mut kept).filter(|_| is_kept));
            // The last line may still be written, so an error there does not mean that frames are
            // out of order.
            choice.through &= read.is_ok() || lines.ended();
            read?;
            let frame = || table.frame(kept, columns.radius(), *options);
            let mut read = is_kept.then(frame).transpose()?;
            match table.is_row {
                true => choice.whole = choice.seen,
                false => choice.done(lines.ended(), read.as_mut().map(|(kept, _)| kept)),
            }
            if read.is_some() {
                return Ok(read);
            }
        }
        Ok(None)
    }
}

impl Header {
    fn rows(
        &mut self,
        lines: &mut Lines<'_>,
        columns: &Columns,
        mut kept: Option<&mut Particles>,
    ) -> anyhow::Result<()> {
        let mut first = true;
        while self.is_row {
            let line = lines.line();
            if !line.is_empty() && !is_comment(line) {
                if let Some(split) = &mut self.split {
                    let mut cells = self.separator.cells(line);
                    let lacks = |wanted: usize| cells.clone().count() < wanted;
                    if !lines.ended() && lacks(columns.names.len()) {
                        if kept.is_none() {
                            self.is_row = false;
                            return Ok(());
                        }
                        // The cell that splits frames is only complete if another cell follows.
                        let whole = !lacks(split.column + 2);
                        ensure!(whole, "{lines}: the line is cut off, or still being written");
                    }
                    if split.is_next(&mut cells, first, || lines.place())? {
                        return Ok(());
                    }
                    first = false;
                }
                if let Some(repeats) = &mut self.repeats {
                    repeats.row(self.separator.cells(line));
                }
                if let Some(kept) = kept.as_deref_mut() {
                    row(columns, kept, self.separator, lines)?;
                }
            }
            self.is_row = lines.advance()?;
        }
        let end = |repeats: &Repeats| repeats.end(columns).with_context(|| self.place.clone());
        self.repeats.as_ref().map_or(Ok(()), end)
    }

    fn frame(
        &self,
        mut particles: Particles,
        radius: RadiusSource,
        options: Options,
    ) -> anyhow::Result<Loaded> {
        let place = &self.place;
        if self.assumed {
            self.not_kinds(&particles)?;
            particles.notices.push(assumed!(
                "the columns have no names and are read as {}; if that is wrong, give --columns",
                self.columns.names.join(", ")
            ));
        } else {
            let size = if matches!(radius, RadiusSource::Halved(_)) { 2.0 } else { 1.0 };
            ensure!(
                options.sizes_chosen() || !is_radial(&particles, size),
                "{place}: each size is the distance from the origin; give --columns with r=NAME or \
                 d=NAME if they are sizes, or --radius R"
            );
        }
        let is_edge = |name: &&String| {
            let name = name.to_ascii_lowercase().replace(['_', ' '], "");
            among("lx ly lz boxx boxy boxz boxlx boxly boxlz", &name)
        };
        let edges: Vec<String> = self.columns.names.iter().filter(is_edge).cloned().collect();
        let no_box = self.declared.is_none() && !options.boundaries.replace_box();
        let comments = self.comments.iter().filter(|_| no_box);
        let doubts: Vec<_> =
            comments.filter_map(|it| doubts::of_comment(it, &particles)).take(1).collect();
        particles.notices.extend(doubts);
        if edges.len() > 1 && no_box {
            particles.notices.push(assumed!(
                "{} are not read; give --box LX,LY,LZ if they are a box, otherwise --open",
                listed(&edges)
            ));
        }
        let (particles, mut about) = loaded(self.format, particles, radius);
        if let Some(split) = &self.split {
            (about.step, about.time) = (split.step(), split.time());
        }
        about.declared = self.declared.clone();
        Ok((particles, about))
    }

    /// Refuses unnamed columns whose last one holds several whole numbers.
    fn not_kinds(&self, particles: &Particles) -> anyhow::Result<()> {
        let radii = particles.radii.as_deref().unwrap_or_default();
        let whole = radii.iter().all(|r| r.fract() == 0.0);
        let kinds = whole && radii.windows(2).any(|pair| pair[0] != pair[1]);
        let all = self.columns.names.iter().zip(1..).map(|(name, k)| format!("{name}={k}"));
        let (all, place) = (all.collect::<Vec<_>>(), &self.place);
        let places = &all[..all.len().saturating_sub(1)];
        ensure!(
            !kinds,
            "{place}: the last unnamed column has only whole numbers, as of kinds; give \
             --columns {} if they are radii, or --columns {} --radius R",
            all.join(","),
            places.join(",")
        );
        Ok(())
    }
}

/// Whether each radius, times `size`, is the distance of the centre from the origin or from the z
/// axis.
fn is_radial(particles: &Particles, size: f64) -> bool {
    let radii = particles.radii.as_deref().unwrap_or_default();
    let is_it = |axes: usize| {
        radii.iter().enumerate().all(|(k, r)| {
            let far = particles.centre(k)[..axes].iter().fold(0.0, |far: f64, x| far.hypot(*x));
            (size * r - far).abs() <= 1e-3 * far
        })
    };
    radii.iter().filter(|r| **r > 0.0).count() > 2 && (is_it(2) || is_it(3))
}

/// Adds the particle of a row, whose end may be a comment.
fn row(
    columns: &Columns,
    particles: &mut Particles,
    separator: Separator,
    lines: &Lines<'_>,
) -> anyhow::Result<()> {
    let (whole, bare) = (lines.line(), uncommented(lines.line()));
    let mut push = |line: &[u8]| columns.push(particles, separator.cells(line), || lines.place());
    match push(bare) {
        Err(_) if bare.len() != whole.len() && push(whole).is_ok() => Ok(()),
        done => done,
    }
}
