//! Checks whether a list that differs matches another frame of the particles.

use crate::cli::shared::input;
use crate::cli::verify::{Verified, Verify, counted};
use contactbench_io as io;
use contactbench_run::check::verify::Meaning;

/// Maximum number of pairs compared for a hint, and of particles summed over the frames tried.
const MOST: u64 = 2_000_000;
/// Number of frames that must confirm a shift by one frame.
const ENOUGH: u32 = 8;

/// Another frame of the particles that fits the list.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    frame: u64,
    /// Number of pairs that still differ.
    wrong: u64,
}

impl Verified<'_> {
    /// Finds the frame near `given` that fits the list best, if no other reading explains the list.
    /// It must have less than half of the errors.
    pub(super) fn look_at_others(&mut self, given: u64) {
        let Verify { file, .. } = self.options;
        let explained = self.reading.as_ref().is_some_and(|reading| reading.wrong == 0);
        let pairs = self.list.pairs.len() as u64;
        // A pipe can only be read once.
        let is_file = std::fs::metadata(file).is_ok_and(|file| file.is_file());
        if self.found.is_same() || explained || !is_file || !(1..=MOST).contains(&pairs) {
            return;
        }
        let options = self.options;
        let without = options.without;
        let all = io::Options { ids: true, without, ..options.input.options() };
        let mut best: Option<Other> = None;
        let _ = input::frames(file, all, |frames| {
            for frame in frames {
                let (particles, about) = frame?;
                let span = (MOST / (particles.len() as u64).max(1) / 2).max(1);
                let frame = about.frame;
                if frame > given.saturating_add(span) {
                    break;
                }
                if frame == given || frame.saturating_add(span) < given {
                    continue;
                }
                let Ok(other) =
                    Verified::new(options, self.list.clone(), particles, about, 1, false)
                else {
                    continue;
                };
                let wrong = other.found.wrong();
                if best.is_none_or(|best| wrong < best.wrong) {
                    best = Some(Other { frame, wrong });
                }
                if wrong == 0 {
                    break;
                }
            }
            Ok(())
        });
        let least = self.reading.as_ref().map_or(u64::MAX, |reading| reading.wrong);
        let half = self.found.wrong().div_ceil(2).min(least);
        self.other = best.filter(|best| best.wrong < half);
    }

    pub(super) fn other_flags(&self, other: Other) -> String {
        let list = self.list.frame.filter(|_| self.options.pairs_frame.is_none());
        let of_list = list.map_or(String::new(), |frame| format!(" --pairs-frame {frame}"));
        format!("--frame {}{of_list}", other.frame)
    }

    pub(super) fn other_sentence(&self, other: Other) -> String {
        let Other { frame, wrong } = other;
        let pairs = self.list.pairs.len() as u64;
        let flags = self.other_flags(other);
        let all = match pairs {
            1 => "the one pair agrees".into(),
            _ => format!("all {} agree", counted(pairs, "pair")),
        };
        match wrong {
            0 => format!("the list fits frame {frame} of the particles: {all}; give {flags}"),
            _ => format!(
                "the list is closest to frame {frame} of the particles: all but {} agree; give \
                 {flags}",
                counted(wrong, "pair")
            ),
        }
    }
}

/// Tests whether all lists belong to the frame before, or all to the frame after.
#[derive(Default)]
pub(super) struct Shift {
    /// Listed and true pairs of the previous frame, named as in the list.
    last: Option<[Vec<[i64; 2]>; 2]>,
    compared: u32,
    /// Whether some list differs from the frame before, and whether some differs from the frame
    /// after.
    refuted: [bool; 2],
}

impl Shift {
    /// Compares a frame with the one added before. The caller adds all frames from the first wrong
    /// one.
    pub(super) fn note(&mut self, verified: &Verified<'_>, ids: Option<&[i64]>) {
        let pairs = verified.list.pairs.len() as u64 + verified.found.truth.len();
        if self.compared >= ENOUGH || self.refuted == [true; 2] || pairs > MOST {
            return;
        }
        let name = |k: u32| match verified.naming {
            Meaning::Base(base) => i64::from(k) + base,
            Meaning::Ids => ids.and_then(|ids| ids.get(k as usize)).copied().unwrap_or(-1),
        };
        let plain = |pairs: &mut Vec<[i64; 2]>| {
            pairs.iter_mut().for_each(|pair| pair.sort_unstable());
            pairs.sort_unstable();
            pairs.dedup();
        };
        let mut list = verified.list.pairs.clone();
        let truth = verified.found.truth.iter();
        let mut truth: Vec<[i64; 2]> = truth.map(|pair| [pair.i, pair.j].map(name)).collect();
        plain(&mut list);
        plain(&mut truth);
        if let Some([last_list, last_truth]) = &self.last {
            // Frames without contacts decide nothing.
            self.compared += u32::from(!list.is_empty() && !truth.is_empty());
            self.refuted[0] |= list != *last_truth;
            self.refuted[1] |= truth != *last_list;
        }
        self.last = Some([list, truth]);
    }

    /// Returns the hint, if all lists are shifted by one frame.
    pub(super) fn sentence(&self) -> Option<String> {
        let which = match self.refuted {
            _ if self.compared == 0 => return None,
            [false, true] => "before",
            [true, false] => "after",
            _ => return None,
        };
        Some(format!(
            "each list fits the particles one frame {which}; write both at the same step, after \
             the list was built"
        ))
    }
}
