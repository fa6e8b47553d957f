//! A list against a frame of the particles.

use std::sync::Once;

use anyhow::{Context, bail};

use crate::check::imaged::Listed;
use crate::check::listed::{Allowed, Naming, Terms, Verification};
use crate::cli::verify::{Verified, Verify, numbers};
use crate::io::pairs::List;
use crate::io::{About, Particles};
use crate::periodic::Periodic;
use crate::scene::{AnyScene, Given};

/// That ids are missed.
static TOLD: Once = Once::new();

/// Refuses a list of another time than the particles, unless it was asked for.
pub(super) fn same_time(options: &Verify, list: &List, about: &About) -> anyhow::Result<()> {
    let of_list = match (list.step, about.step) {
        (Some(of_list), Some(step)) if of_list != step => format!("step {of_list}"),
        // Where frames have no rows, the last that has may be any.
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
    let said = format!("{pairs}: the list is of {of_list}, the particles of {}", about.which());
    if options.pairs_frame.is_some() {
        say!("{said}");
        return Ok(());
    }
    bail!(
        "{said} in {file}; give --frame all, which brings them together, or --pairs-frame K for \
         the list that is meant"
    )
}

impl<'a> Verified<'a> {
    /// A list against a frame of the particles. So many pairs of a kind are kept; other ways to
    /// read the list are tried if that is asked for.
    pub(super) fn new(
        options: &'a Verify,
        mut list: List,
        mut particles: Particles,
        about: About,
        kept: usize,
        explain: bool,
    ) -> anyhow::Result<Verified<'a>> {
        let file = options.file.display().to_string();
        let ids = particles.ids().map(Naming::by_id);
        let (naming, others) = match (options.base, ids) {
            (None, Some(Ok(ids))) if list.named_ids => {
                (ids, vec![Naming::Base(0), Naming::Base(1)])
            }
            (None, Some(ids)) if options.ids || list.ids => {
                let ids = ids.context("the ids of the particles cannot be used")?;
                (ids, vec![Naming::Base(0), Naming::Base(1)])
            }
            (None, None) if options.ids => {
                bail!("{file} has no column 'id' of whole numbers; give --base 0 or --base 1")
            }
            (base, ids) => {
                if base.is_none() && list.ids {
                    // Once, in however many frames.
                    TOLD.call_once(|| {
                        say!(
                            "{}: the list names particles by id, and {file} has no column id: ids \
                             are taken as places in the file, from 1, which holds where it is in \
                             their order; write the id too (dump ... custom ... id x y z radius), \
                             or say --base 1",
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
            explain,
            without: groups.as_ref(),
        };
        let (scene, lattice, found) = match lattice {
            Some(lattice) => {
                let periodic = Periodic::new(scene, lattice)?;
                list.understood(periodic.scene().dim(), periodic.lattice().periodic())
                    .with_context(|| options.pairs.display().to_string())?;
                let listed = Listed { pairs: &list.pairs, images: list.images.as_deref() };
                let found = Verification::in_box(&periodic, listed, &naming, &others, terms)
                    .with_context(|| options.pairs.display().to_string())?;
                let (scene, lattice) = periodic.into_parts();
                (scene, Some(lattice), found)
            }
            None => {
                let found = open(options, &mut list, &scene, &about, (&naming, &others), terms)?;
                (scene, None, found)
            }
        };
        let boxed = about.bounds.is_some() && options.input.boundaries.edges.is_none();
        let flags = about.declared.and_then(|declared| declared.periodic);
        let repeats = flags.is_some_and(|flags| flags.contains(&true));
        let naming = naming.meaning();
        Ok(Verified { options, list, naming, scene, lattice, boxed, repeats, found, other: None })
    }
}

/// The comparison where boundaries are open.
fn open(
    options: &Verify,
    list: &mut List,
    scene: &AnyScene<'static>,
    about: &About,
    (naming, others): (&Naming, &[Naming]),
    terms: Terms,
) -> anyhow::Result<Verification> {
    let vectors = about.declared.as_ref().and_then(|of| of.vectors);
    if vectors.is_none() {
        list.without_box();
    }
    let images = list.images.as_deref().unwrap_or_default();
    if let Some(k) = images.iter().position(|image| *image != [0; 3]) {
        let remedy = match vectors {
            _ if options.input.boundaries.open => "leave out --open",
            Some(_) if options.input.boundaries.periodic.is_some() => "leave out --periodic none",
            Some(_) => "give --periodic with the axes along which the box repeats",
            None => "give --box LX,LY,LZ, and --periodic where it is open along some axis",
        };
        bail!(
            "{}: pair {k} (from 0) names an image in a box that repeats, {}, and boundaries are \
             open here; {remedy}, or --pairs-columns I,J if it is something else",
            options.pairs.display(),
            numbers(&images[k], ",")
        );
    }
    let bounds = about.bounds.as_deref();
    let mut found = Verification::new(scene, &list.pairs, naming, others, terms, bounds)?;
    let boundaries = options.input.options().boundaries;
    let left_out = boundaries.left_out(scene.dim(), about.declared.as_ref());
    if let (true, false, Some(lattice)) = (terms.explain, found.is_same(), left_out) {
        let periodic = Periodic::new(scene.clone(), lattice)?;
        found.try_declared(&periodic, &list.pairs, naming, others, terms);
    }
    Ok(found)
}
