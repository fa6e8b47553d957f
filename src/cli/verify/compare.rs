//! Compares the contact list with one frame of the particles.

use std::sync::Once;

use anyhow::{Context, bail};

use crate::cli::verify::{Verified, Verify, numbers};
use contactbench_core::periodic::Periodic;
use contactbench_core::scene::Lattice;
use contactbench_io::Given;
use contactbench_io::boxes;
use contactbench_io::pairs::List;
use contactbench_io::{About, Particles};
use contactbench_run::check::verify::{self, Allowed, Job, Listed, Naming, Terms};

/// Whether the message about missing ids was printed.
static TOLD: Once = Once::new();

/// Fails if list and particles are from different times, unless options chose both.
pub(super) fn same_time(options: &Verify, list: &List, about: &About) -> anyhow::Result<()> {
    let of_list = match (list.step, about.step) {
        (Some(of_list), Some(step)) if of_list != step => format!("step {of_list}"),
        // A sparse table has no rows for a frame without contacts.
        (None, _) if list.sparse && list.frame.is_some_and(|frame| frame != about.frame) => {
            format!("frame {}", list.frame.unwrap_or_default())
        }
        (Some(step), None) => {
            say!("{}: the list of step {step} is read (--pairs-frame)", options.pairs.display());
            return Ok(());
        }
        _ => return Ok(()),
    };
    let (pairs, file) = (options.pairs.display(), options.file.display());
    let said = format!("{pairs}: the list is of {of_list}, the particles are of {}", about.which());
    if options.pairs_frame.is_some() {
        say!("{said}");
        return Ok(());
    }
    bail!(
        "{said} in {file}; give --frame all to compare all frames, or --pairs-frame K to choose a \
         list"
    )
}

impl<'a> Verified<'a> {
    /// Compares a list with the particles of a frame. Keeps the `kept` worst pairs of each kind;
    /// with `explain`, tries other ways to read the list.
    pub(super) fn new(
        options: &'a Verify,
        mut list: List,
        mut particles: Particles,
        about: About,
        kept: usize,
        explain: bool,
    ) -> anyhow::Result<Verified<'a>> {
        let file = options.file.display().to_string();
        let ids = particles.ids.as_deref().map(Naming::by_id);
        let (naming, others) = match (options.base, ids) {
            (None, Some(Ok(ids))) if list.named_ids => {
                (ids, vec![Naming::Base(0), Naming::Base(1)])
            }
            (None, Some(ids)) if options.ids || list.ids => {
                let ids = ids.context("cannot use the ids of the particles")?;
                (ids, vec![Naming::Base(0), Naming::Base(1)])
            }
            (None, None) if options.ids => {
                bail!("{file} has no column 'id' of whole numbers; give --base 0 or --base 1")
            }
            (base, ids) => {
                if base.is_none() && list.ids {
                    TOLD.call_once(|| {
                        say!(
                            "{}: the list names particles by id, but {file} has no column id; ids \
                             are taken as places in the file, from 1; write the ids (dump ... \
                             custom ... id x y z radius), or give --base 1 if the file is in their \
                             order",
                            options.pairs.display()
                        );
                    });
                }
                let base = base.unwrap_or(i64::from(list.ids));
                let ids = ids.and_then(Result::ok);
                (Naming::Base(base), [Naming::Base(1 - base)].into_iter().chain(ids).collect())
            }
        };
        let groups = particles.groups.take();
        let Given { scene, lattice, .. } = particles.given(&file, options.input.radius)?;
        let terms = Terms {
            arithmetic: options.arithmetic,
            allowed: Allowed { both_sides: options.both_sides, skin: options.skin },
            memory_limit: options.limit.bytes(scene.len()),
            kept,
            without: groups.as_ref(),
        };
        let (dim, declared) = (scene.dim(), about.declared.as_ref());
        let boundaries = options.input.options().boundaries;
        let (periodic, declared) = match lattice {
            Some(lattice) => {
                list.understood(dim, lattice.periodic())
                    .and_then(|()| boxes::hold(lattice.periodic(), list.images.as_deref()))
                    .with_context(|| options.pairs.display().to_string())?;
                (Periodic::new(scene, lattice)?, None)
            }
            None => {
                open(options, &mut list, declared.and_then(|of| of.vectors).is_some())?;
                (Periodic::new(scene, Lattice::OPEN)?, boundaries.left_out(dim, declared))
            }
        };
        let listed = Listed { pairs: &list.pairs, images: list.images.as_deref() };
        let job = Job { space: &periodic, list: listed, naming: &naming, others: &others, terms };
        let found = verify::verify(&job)?;
        let mut reading = None;
        if explain {
            let declared = declared.map(|lattice| Periodic::new(periodic.scene().clone(), lattice));
            reading = verify::explain(&job, &found, declared.transpose()?.as_ref())?;
        }
        let flags = about.declared.and_then(|declared| declared.periodic);
        let repeats = flags.is_some_and(|flags| flags.contains(&true));
        let naming = naming.meaning();
        Ok(Verified { options, list, naming, periodic, repeats, found, reading, other: None })
    }
}

/// Fails if the list has pairs with a shift although boundaries are open.
fn open(options: &Verify, list: &mut List, has_box: bool) -> anyhow::Result<()> {
    if !has_box {
        list.without_box();
    }
    let images = list.images.as_deref().unwrap_or_default();
    let Some(k) = images.iter().position(|image| *image != [0; 3]) else { return Ok(()) };
    let remedy = match has_box {
        _ if options.input.boundaries.open => "leave out --open",
        true if options.input.boundaries.periodic.is_some() => "leave out --periodic none",
        true => "give --periodic with the axes along which the box repeats",
        false => "give --box LX,LY,LZ, and --periodic where it is open along some axis",
    };
    bail!(
        "{}: pair {k} (from 0) names an image of a periodic box, {}, but boundaries are open here; \
         {remedy}, or --pairs-columns I,J if these columns are not images",
        options.pairs.display(),
        numbers(&images[k], ",")
    );
}
