//! Compares the contact list of one frame with the particles of that frame.

use std::path::Path;

use anyhow::{Context, bail, ensure};

use crate::verify::{self, Allowed, Job, Listed, Meaning, Naming, Reading, Terms, Verification};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::Periodic;
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_io::pairs::List;
use contactbench_io::{self as io, About, Given, Notice, Particles, boxes};

/// The two files to compare, and how to read them.
pub struct Asked<'a> {
    pub file: &'a Path,
    pub pairs: &'a Path,
    pub input: io::Options,
    pub base: Option<i64>,
    /// Whether the list names particles by id.
    pub ids: bool,
    /// The frame of the list, if it was chosen.
    pub pairs_frame: Option<io::FrameChoice>,
    pub arithmetic: Arithmetic,
    pub allowed: Allowed,
    /// Returns the bytes that a list of contacts may use, for a number of particles.
    pub limit: &'a dyn Fn(usize) -> u64,
}

impl Asked<'_> {
    /// Fails if list and particles are from different times, unless options chose both. Returns a
    /// note about the time of the list, if it needs one.
    pub fn same_time(&self, list: &List, about: &About) -> anyhow::Result<Option<String>> {
        let pairs = self.pairs.display();
        let of_list = match (list.step, about.step) {
            (Some(of_list), Some(step)) if of_list != step => format!("step {of_list}"),
            // A sparse table has no rows for a frame without contacts.
            (None, _) if list.sparse && list.frame.is_some_and(|frame| frame != about.frame) => {
                format!("frame {}", list.frame.unwrap_or_default())
            }
            (Some(step), None) => {
                return Ok(Some(format!(
                    "{pairs}: the list of step {step} is read (--pairs-frame)"
                )));
            }
            _ => return Ok(None),
        };
        let said =
            format!("{pairs}: the list is of {of_list}, the particles are of {}", about.which());
        ensure!(
            self.pairs_frame.is_some(),
            "{said} in {}; give --frame all to compare all frames, or --pairs-frame K to choose a \
             list",
            self.file.display()
        );
        Ok(Some(said))
    }

    /// Returns a notice if the list names particles by id, and the particles have none.
    pub fn without_ids(&self, list: &List, particles: &Particles) -> Option<Notice> {
        let taken = list.ids && particles.ids.is_none() && self.base.is_none();
        taken.then(|| {
            Notice::Assumed(format!(
                "the list names particles by id, but {} has no column id; ids are taken as places \
                 in the file, from 1; write the ids (dump ... custom ... id x y z radius), or give \
                 --base 1 if the file is in their order",
                self.file.display()
            ))
        })
    }
}

/// One frame of the particles, compared with its list.
pub struct Verified {
    pub list: List,
    pub naming: Meaning,
    /// The ids of the particles, if no two are equal.
    pub ids: Option<Vec<i64>>,
    /// The particles, in their box if there is one.
    pub space: Periodic<'static>,
    pub found: Verification,
    /// A way to read the files so that fewer pairs differ.
    pub hint: Option<Reading>,
}

impl Verified {
    /// Compares a list with the particles of a frame. Keeps the `kept` worst pairs of each kind;
    /// with `explain`, tries other ways to read the list.
    pub(super) fn new(
        asked: &Asked<'_>,
        list: List,
        mut particles: Particles,
        about: &About,
        kept: usize,
        explain: bool,
    ) -> anyhow::Result<Verified> {
        let file = asked.file.display().to_string();
        let ids = particles.ids.take();
        let by_id = ids.as_deref().map(Naming::by_id);
        let ids = ids.filter(|_| by_id.as_ref().is_some_and(Result::is_ok));
        let (naming, others) = namings(asked, &list, by_id)?;
        let groups = particles.groups.take();
        let Given { scene, lattice, .. } = particles.given(&file, asked.input.radius)?;
        let terms = Terms {
            arithmetic: asked.arithmetic,
            allowed: asked.allowed,
            memory_limit: (asked.limit)(scene.len()),
            kept,
            without: groups.as_ref(),
        };
        let dim = scene.dim();
        let space = match lattice {
            Some(lattice) => {
                list.understood(dim, lattice.periodic())
                    .and_then(|()| boxes::hold(lattice.periodic(), list.images.as_deref()))
                    .with_context(|| asked.pairs.display().to_string())?;
                Periodic::new(scene, lattice)?
            }
            None => {
                let of_file = about.declared.as_ref();
                open(asked, &list, of_file.and_then(|of| of.vectors).is_some())?;
                Periodic::new(scene, Lattice::OPEN)?
            }
        };
        let listed = Listed { pairs: &list.pairs, images: list.images.as_deref() };
        let job = Job { space: &space, list: listed, naming: &naming, others: &others, terms };
        let found = verify::verify(&job)?;
        let hint = if explain { verify::explain(&job, &found)? } else { None };
        Ok(Verified { list, naming: naming.meaning(), ids, space, found, hint })
    }

    pub fn scene(&self) -> &AnyScene<'static> {
        self.space.scene()
    }

    /// Returns the box; `None` in open space.
    pub fn lattice(&self) -> Option<&Lattice> {
        Some(self.space.lattice()).filter(|lattice| lattice.repeats())
    }
}

/// Returns how the list names particles, and other ways to try. `by_id` is the naming by the ids of
/// the particles, if there are any.
fn namings(
    asked: &Asked<'_>,
    list: &List,
    by_id: Option<anyhow::Result<Naming>>,
) -> anyhow::Result<(Naming, Vec<Naming>)> {
    let by_place = || vec![Naming::Base(0), Naming::Base(1)];
    Ok(match (asked.base, by_id) {
        (None, Some(Ok(ids))) if list.named_ids => (ids, by_place()),
        (None, Some(ids)) if asked.ids || list.ids => {
            (ids.context("cannot use the ids of the particles")?, by_place())
        }
        (None, None) if asked.ids => bail!(
            "{} has no column 'id' of whole numbers; give --base 0 or --base 1",
            asked.file.display()
        ),
        (base, ids) => {
            let base = base.unwrap_or(i64::from(list.ids));
            let ids = ids.and_then(Result::ok);
            (Naming::Base(base), [Naming::Base(1 - base)].into_iter().chain(ids).collect())
        }
    })
}

/// Fails if the list has pairs with a shift although boundaries are open.
fn open(asked: &Asked<'_>, list: &List, has_box: bool) -> anyhow::Result<()> {
    let images = list.images.as_deref().unwrap_or_default();
    let Some(k) = images.iter().position(|image| *image != [0; 3]) else { return Ok(()) };
    let remedy = match has_box {
        true => "leave out --open, or give --periodic with the axes along which the box repeats",
        false => "give --box LX,LY,LZ, and --periodic where it is open along some axis",
    };
    let [x, y, z] = images[k];
    bail!(
        "{}: pair {k} (from 0) names an image of a periodic box, {x},{y},{z}, but boundaries are \
         open here; {remedy}, or --pairs-columns I,J if these columns are not images",
        asked.pairs.display()
    );
}
