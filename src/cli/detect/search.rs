//! The search for the contacts of one scene.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use anyhow::Context;

use crate::cli::detect::Detect;
use contactbench_detectors::spec::DetectorSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::crowd;
use contactbench_ground::pairs::normalise::normalise_by;
use contactbench_ground::pairs::pair_list::PAIR_BYTES;
use contactbench_ground::periodic::{ContactList, IMAGE_PAIR_BYTES, ImagePair, Periodic};
use contactbench_io::write::{self, Extra, Style};
use contactbench_io::{Given, Notice};
use contactbench_lists::periodic::Finder;
use contactbench_run::run::runner::alloc;
use contactbench_scenes::doubts::crowded;

/// A detector that keeps its buffers from scene to scene.
pub(super) struct Search {
    pub memory_limit: u64,
    arithmetic: Arithmetic,
    threads: usize,
    detector: Box<dyn AnyDetector>,
    finder: Finder,
}

/// Contacts in ascending order.
pub(super) enum Pairs {
    Open(Vec<[u32; 2]>),
    Boxed(Vec<ImagePair>),
}

pub(super) struct SearchResult {
    pub pairs: Pairs,
    /// Number of periodic images that the search made.
    pub images: usize,
    pub time: Duration,
    /// Bytes that the detector still holds after the search, if measured.
    pub memory: Option<u64>,
}

impl Pairs {
    pub fn iter(&self) -> Box<dyn ExactSizeIterator<Item = ImagePair> + '_> {
        match self {
            Pairs::Open(pairs) => {
                Box::new(pairs.iter().map(|&[i, j]| ImagePair { i, j, image: [0; 3] }))
            }
            Pairs::Boxed(pairs) => Box::new(pairs.iter().copied()),
        }
    }
}

pub(super) fn style<'a>(
    options: &'a Detect,
    given: &'a Given,
    periodic: Option<&'a Periodic<'a>>,
    ids: Option<&'a [i64]>,
    by_id: bool,
    counts: &'a [u32],
) -> Style<'a> {
    let scene = periodic.map_or(&given.scene, Periodic::scene);
    Style { scene, periodic, ids, by_id, extras: &options.extras, counts }
}

impl SearchResult {
    /// Returns the number of contacts of each particle, if the options need it.
    pub fn counts(&self, options: &Detect, n: usize) -> anyhow::Result<Vec<u32>> {
        let n = if options.extras.contains(&Extra::Count) { n } else { 0 };
        write::counts(n, self.pairs.iter())
    }

    /// Returns the doubt about the sizes of a file, if there are far too many contacts.
    pub fn doubt(&self, given: &Given) -> Option<Notice> {
        let each = 2.0 * self.pairs.iter().len() as f64 / given.scene.len().max(1) as f64;
        crowded(given.scene.dim(), each, given.source.as_ref()?)
    }
}

impl Search {
    pub fn new(options: &Detect, spec: &DetectorSpec, memory_limit: u64) -> Search {
        let Detect { arithmetic, threads, .. } = *options;
        let detector = spec.make(Options { memory_limit, threads });
        Search { memory_limit, arithmetic, threads, detector, finder: Finder::new(memory_limit) }
    }

    /// Finds the contacts of a scene, in its box if it has one.
    pub fn find(
        &mut self,
        given: &Given,
        periodic: Option<&Periodic<'_>>,
    ) -> anyhow::Result<SearchResult> {
        let Search { memory_limit, arithmetic, threads, ref mut detector, ref mut finder } = *self;
        let scene = match periodic {
            None => {
                let stored = given.scene.as_stored(arithmetic);
                stored.with_context(|| format!("in {}", arithmetic.name()))?
            }
            Some(periodic) => Cow::Borrowed(periodic.scene()),
        };
        crowd::within(&scene, memory_limit)?;
        let mut contacts = ContactList::default();
        let started = Instant::now();
        let (result, usage) = alloc::measure(|| match periodic {
            None => detector.list(&scene, arithmetic.test(), &mut contacts.plain),
            Some(periodic) => finder.list(periodic, &mut **detector, arithmetic, &mut contacts),
        });
        let time = started.elapsed();
        result?;
        // The live bytes include the lists of pairs, which do not count as memory of the detector.
        let lists = contacts.plain.capacity() as u64 * PAIR_BYTES
            + contacts.shifted.capacity() as u64 * IMAGE_PAIR_BYTES;
        let memory = usage.map(|usage| usage.live_bytes.saturating_sub(lists));
        let (pairs, images) = match periodic {
            None => {
                let mut pairs = contacts.plain;
                normalise_by(threads, &mut pairs);
                (Pairs::Open(pairs), 0)
            }
            Some(_) => {
                let pairs = contacts.sorted(scene.len(), memory_limit)?;
                (Pairs::Boxed(pairs), finder.images() as usize)
            }
        };
        Ok(SearchResult { pairs, images, time, memory })
    }
}
