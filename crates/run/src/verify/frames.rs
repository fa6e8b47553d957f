//! Compares the contact lists of all chosen frames, one frame after the other.

use std::collections::HashMap;

use anyhow::bail;

use crate::tracking::Late;
use crate::verify::frame::{Asked, Verified};
use crate::verify::paired::Matched;
use crate::verify::{Meaning, Reading, Taken, Verification, WORST};
use contactbench_detectors::oracle::Errors;
use contactbench_ground::periodic::depth;
use contactbench_io::pairs::List;
use contactbench_io::{About, Particles};
use contactbench_terms::number::plural;

/// Bytes of memory for a missed pair while later frames are searched for it.
const FOLLOWED: u64 = 128;

/// The result for one frame, with the names of its JSON.
#[derive(serde::Serialize)]
pub struct FrameResult {
    pub frame: u64,
    pub step: Option<i64>,
    #[serde(rename = "n")]
    pub particles: usize,
    pub contacts: u64,
    #[serde(rename = "reported")]
    pub listed: usize,
    pub same: bool,
    #[serde(skip)]
    pub wrong: u64,
    pub errors: Errors,
    /// Number of pairs with unknown particles.
    pub unknown: usize,
    /// Number of pairs listed from one side only.
    pub one_sided: usize,
    pub within_skin: u64,
}

/// The results for all frames.
#[derive(Default)]
pub struct All {
    /// Whether contacts are followed from frame to frame. If not, there is one frame.
    pub several: bool,
    pub rows: Vec<FrameResult>,
    /// The frame compared last.
    pub last: Option<Verified>,
    /// Late contacts, named by ids or else by the numbers in file order.
    pub late: Late<[i64; 2]>,
    pub matched: Matched,
    /// Format of the list, how it names particles, and how pairs in a box were compared.
    pub read: Option<(&'static str, Meaning, Option<Taken>)>,
    /// Numbers of contacts and of listed pairs left out by `--without`.
    pub left_out_pairs: [u64; 2],
    /// Number of pairs of a particle with itself that were left out.
    pub selves_left_out: u64,
    /// Names of ignored columns.
    pub others: Vec<String>,
    /// The first wrong frame and its hint.
    pub hint: Option<(String, Reading)>,
}

impl All {
    /// Compares a frame with its list.
    ///
    /// # Errors
    /// Fails if the list does not fit the particles, or without memory to follow missed contacts.
    pub fn compare(
        &mut self,
        asked: &Asked<'_>,
        particles: Particles,
        about: &About,
        list: List,
    ) -> anyhow::Result<&Verified> {
        let (which, list_frame) = (about.which(), list.frame.unwrap_or(about.frame));
        let memory = (asked.limit)(particles.len());
        let kept = match self.several {
            true => usize::try_from(memory / FOLLOWED).unwrap_or(usize::MAX).max(1),
            false => WORST,
        };
        let explain = self.hint.is_none() && self.is_same();
        let mut verified = Verified::new(asked, list, particles, about, kept, explain)
            .map_err(|error| if self.several { error.context(which.clone()) } else { error })?;
        if self.several && verified.found.errors.missed > kept as u64 {
            bail!(
                "{which}: the list misses {}, more than can be followed in {memory} bytes; look at \
                 that frame alone (--frame {} --pairs-frame {list_frame}), or give a larger \
                 --memory-limit",
                counted(verified.found.errors.missed, "contact"),
                about.frame
            );
        }
        if self.several {
            self.follow(&verified);
        }
        if let Some(hint) = verified.hint.take() {
            self.hint = Some((which, hint));
        }
        self.add(&verified, about);
        Ok(self.last.insert(verified))
    }

    fn add(&mut self, verified: &Verified, about: &About) {
        let Verified { list, found, .. } = verified;
        // The first list with pairs shows how lists are read; empty lists do not.
        if self.rows.iter().all(|row| row.listed == 0) {
            let taken = verified.lattice().map(|_| found.taken);
            self.read = Some((list.format, verified.naming, taken));
        }
        self.selves_left_out += found.selves_left_out;
        self.left_out_pairs.iter_mut().zip(found.left_out).for_each(|(all, of)| *all += of);
        for other in &list.others {
            if !self.others.contains(other) {
                self.others.push(other.clone());
            }
        }
        self.rows.push(FrameResult {
            frame: about.frame,
            step: about.step,
            particles: verified.scene().len(),
            contacts: found.truth.len(),
            listed: list.pairs.len(),
            same: found.is_same(),
            wrong: found.wrong(),
            errors: found.errors,
            unknown: found.unknown.len(),
            one_sided: found.one_sided.len(),
            within_skin: found.within_skin,
        });
    }

    /// Records the missed contacts of a frame, to see which later frames report them.
    fn follow(&mut self, verified: &Verified) {
        let Verification { missed, truth, .. } = &verified.found;
        if missed.is_empty() && !self.late.is_open() {
            return;
        }
        let numbers = || (0..verified.scene().len() as i64).collect();
        let ids = verified.ids.clone().unwrap_or_else(numbers);
        let places: HashMap<i64, u32> = ids.iter().copied().zip(0..).collect();
        let name = |k: u32| ids[k as usize];
        let pair = |[a, b]: [i64; 2]| [a.min(b), a.max(b)];
        let mut names: Vec<[i64; 2]> =
            missed.iter().map(|(it, _)| pair([name(it.i), name(it.j)])).collect();
        names.sort_unstable();
        names.dedup();
        let depth_of = |names: &[i64; 2]| {
            let (i, j) = (places.get(&names[0])?, places.get(&names[1])?);
            let images = truth.of([*i.min(j), *i.max(j)]);
            images.map(|contact| depth(&verified.space, contact)).reduce(f64::max)
        };
        self.late.note(self.rows.len() as u64, &names, depth_of);
    }

    pub fn is_same(&self) -> bool {
        self.rows.iter().all(|row| row.same)
    }

    pub fn errors(&self) -> Errors {
        let mut errors = Errors::default();
        self.rows.iter().for_each(|row| errors.add(&row.errors));
        errors
    }

    /// Returns the first wrong frame and the worst frame; `None` if all are right.
    pub fn worst(&self) -> Option<[&FrameResult; 2]> {
        let first = self.rows.iter().find(|row| !row.same)?;
        let worst = self.rows.iter().reduce(|a, b| if b.wrong > a.wrong { b } else { a })?;
        Some([first, worst])
    }

    /// Returns at most `most` frames: all, else all wrong ones, else the first wrong one and the
    /// worst.
    pub fn shown(&self, most: usize) -> Vec<&FrameResult> {
        let mut rows: Vec<&FrameResult> = self.rows.iter().collect();
        if rows.len() <= most {
            return rows;
        }
        rows.retain(|row| !row.same);
        let first = rows.first().copied();
        rows.sort_by_key(|row| std::cmp::Reverse(row.wrong));
        rows.truncate(most);
        if let Some(first) = first.filter(|first| rows.iter().all(|row| row.frame != first.frame)) {
            rows.truncate(most - 1);
            rows.push(first);
        }
        rows.sort_by_key(|row| row.frame);
        rows
    }
}

/// Returns a count with its noun.
pub fn counted(count: u64, what: &str) -> String {
    plural(usize::try_from(count).unwrap_or(usize::MAX), what)
}
