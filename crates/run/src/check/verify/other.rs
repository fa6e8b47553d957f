//! Checks whether a list that differs matches another frame of the particles.

use crate::check::verify::Meaning;
use crate::check::verify::frame::{Asked, Hint, Verified};
use crate::check::verify::frames::counted;
use contactbench_io as io;

/// Maximum number of pairs that are compared for a hint, and of particles in all tried frames
/// together.
const MOST: u64 = 2_000_000;
/// Number of frames that must confirm a shift by one frame.
const ENOUGH: u32 = 8;

/// Finds the frame near `given` that fits the list best, if no other hint explains the list. It
/// must have less than half of the errors.
pub(super) fn look(asked: &Asked<'_>, verified: &mut Verified, given: u64) {
    let Verified { list, found, hint, .. } = verified;
    let least = hint.as_ref().map_or(u64::MAX, |hint| hint.wrong);
    let pairs = list.pairs.len() as u64;
    // A pipe can only be read once.
    let is_file = std::fs::metadata(asked.file).is_ok_and(|file| file.is_file());
    if found.is_same() || least == 0 || !is_file || !(1..=MOST).contains(&pairs) {
        return;
    }
    let all = io::Options { frame: io::Frame::All, ..asked.input };
    // The frame, and the number of pairs that still differ.
    let mut best: Option<(u64, u64)> = None;
    let _ = io::frames(asked.file, all, |frames| {
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
            let other = Verified::new(asked, list.clone(), particles, &about, 1, false);
            let Ok(other) = other else { continue };
            let wrong = other.found.wrong();
            if best.is_none_or(|(_, least)| wrong < least) {
                best = Some((frame, wrong));
            }
            if wrong == 0 {
                break;
            }
        }
        Ok(())
    });
    let half = found.wrong().div_ceil(2).min(least);
    let Some((frame, wrong)) = best.filter(|&(_, wrong)| wrong < half) else { return };
    let of_list = list.frame.filter(|_| asked.pairs_frame.is_none());
    let of_list = of_list.map_or(String::new(), |frame| format!(" --pairs-frame {frame}"));
    let flags = format!("--frame {frame}{of_list}");
    let (fits, agree) = match (wrong, pairs) {
        (0, 1) => ("fits", "the one pair agrees".into()),
        (0, _) => ("fits", format!("all {} agree", counted(pairs, "pair"))),
        _ => ("is closest to", format!("all but {} agree", counted(wrong, "pair"))),
    };
    let sentence = format!("the list {fits} frame {frame} of the particles: {agree}; give {flags}");
    *hint = Some(Hint { sentence, flags, wrong });
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
    pub(super) fn note(&mut self, verified: &Verified) {
        let pairs = verified.list.pairs.len() as u64 + verified.found.truth.len();
        if self.compared >= ENOUGH || self.refuted == [true; 2] || pairs > MOST {
            return;
        }
        let name = |k: u32| match verified.naming {
            Meaning::Base(base) => i64::from(k) + base,
            Meaning::Ids => {
                verified.ids.as_ref().and_then(|ids| ids.get(k as usize)).copied().unwrap_or(-1)
            }
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
