//! The frames of a file, and the choice among them.

use anyhow::{anyhow, bail, ensure};

use crate::particles::{Loaded, Particles};
use crate::types::{FrameChoice, Notice, assumed};
use contactbench_terms::number::plural;

#[derive(Clone, Copy, PartialEq)]
pub enum Step {
    Keep,
    Skip,
    Stop,
}

#[derive(Default)]
pub struct Choice {
    frame: FrameChoice,
    /// Whether to read to the end of the file even if the chosen frame is found before.
    survey: bool,
    pub seen: u64,
    /// Whether a frame that is missing in the file has no particles or pairs.
    pub sparse: bool,
    /// Whether frames are identified by time step. Missing frames then have no number.
    pub by_step: bool,
    /// Whether later rows may still belong to an earlier frame, so that the file must be read to
    /// its end.
    pub through: bool,
    /// Number of frames that were read or skipped to their end.
    pub whole: u64,
    pub torn: Option<Notice>,
    pub gzip: bool,
}

impl Choice {
    pub fn new(frame: FrameChoice, survey: bool) -> Choice {
        Choice { frame, survey, ..Choice::default() }
    }

    /// Notes that a frame was read or skipped to its end. Programs end each frame with a line feed;
    /// if it is missing, the last number may be cut.
    pub fn done(&mut self, has_feed: bool, particles: Option<&mut Particles>) {
        self.whole = self.seen;
        if self.seen > 1 && !has_feed {
            let why = assumed!(
                "the last line of frame {} has no line feed: if the file is being written, its \
                 last number may be cut off",
                self.seen - 1
            );
            match particles {
                Some(particles) => particles.notices.push(why),
                None => self.torn = Some(why),
            }
        }
    }

    /// Adds to an error which frames before it can be read.
    pub fn with_whole(&self, error: anyhow::Error) -> anyhow::Error {
        // If only one frame is allowed, a second frame is an error but no damage.
        if self.whole == 0
            || self.through
            || self.frame == FrameChoice::Only && self.seen > self.whole
        {
            return error;
        }
        let last = self.whole - 1;
        anyhow!("{error:#}; frames before it are whole: take --frame {last}")
    }

    pub fn is_all(&self) -> bool {
        self.frame == FrameChoice::All
    }

    /// The first of `count` frames that must be read, for formats with random access.
    pub fn first_of(&self, count: usize) -> usize {
        match self.frame {
            FrameChoice::Last => count.saturating_sub(1),
            FrameChoice::Number(k) => {
                usize::try_from(k).unwrap_or(count).min(count.saturating_sub(1))
            }
            FrameChoice::Only | FrameChoice::All => 0,
        }
    }

    pub fn begin(&mut self, place: impl Fn() -> String) -> anyhow::Result<Step> {
        self.begin_at(self.seen, place)
    }

    /// Notes that frame `index` begins at `place`; frames before it may be missing.
    pub fn begin_at(&mut self, index: u64, place: impl Fn() -> String) -> anyhow::Result<Step> {
        let is_first = std::mem::replace(&mut self.seen, index + 1) == 0;
        Ok(match self.frame {
            FrameChoice::Only if !is_first => {
                bail!("{}: a second frame begins; choose one with --frame K", place())
            }
            FrameChoice::Only | FrameChoice::Last | FrameChoice::All => Step::Keep,
            FrameChoice::Number(k) if k == index => Step::Keep,
            FrameChoice::Number(k) if k < index && !self.survey => Step::Stop,
            FrameChoice::Number(_) => Step::Skip,
        })
    }

    /// Returns the number of the chosen frame; fails if the file does not have it.
    fn end(&self, name: &str) -> anyhow::Result<u64> {
        if let FrameChoice::Number(k) = self.frame
            && (self.seen > 0 || self.sparse)
        {
            let (sparse, all) = (self.sparse && !self.by_step, plural(self.seen as usize, "frame"));
            let held = k < self.seen || sparse;
            ensure!(held, "{name} holds {all}, numbered from 0; there is no frame {k}");
            return Ok(k);
        }
        Ok(self.seen.saturating_sub(1))
    }
}

pub trait Reader<T> {
    /// Returns the next wanted frame, or `None` after the last.
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<T>>;
}

pub trait Framed {
    /// Moves to the next frame and returns its place for messages, or `None` at the end.
    fn begin(&mut self) -> anyhow::Result<Option<String>>;

    /// Reads the frame that has begun, or skips it and returns `None`.
    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>>;

    /// Returns whether the text of the frame ends with a line feed.
    fn has_feed(&self) -> bool {
        true
    }
}

impl<F: Framed> Reader<Loaded> for F {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<Loaded>> {
        while let Some(place) = self.begin()? {
            let step = choice.begin(|| place.clone())?;
            if step == Step::Stop {
                return Ok(None);
            }
            let mut read = self.frame(step == Step::Keep)?;
            choice.done(self.has_feed(), read.as_mut().map(|(particles, _)| particles));
            if read.is_some() {
                return Ok(read);
            }
        }
        Ok(None)
    }
}

pub struct Once<F>(Option<F>);

impl<F> Once<F> {
    pub fn new(read: F) -> Once<F> {
        Once(Some(read))
    }
}

impl<T, F: FnOnce() -> anyhow::Result<T>> Reader<T> for Once<F> {
    fn next(&mut self, _: &mut Choice) -> anyhow::Result<Option<T>> {
        self.0.take().map(|read| read()).transpose()
    }
}

/// The frames of a file, of which only one is in memory at a time.
pub struct Stream<'a, T> {
    reader: Box<dyn Reader<T> + 'a>,
    pub choice: Choice,
    pub name: &'a str,
    pub ended: bool,
}

impl<'a, T> Stream<'a, T> {
    pub fn new(reader: Box<dyn Reader<T> + 'a>, choice: Choice, name: &'a str) -> Stream<'a, T> {
        Stream { reader, choice, name, ended: false }
    }

    /// Returns the chosen frame, and its number.
    pub fn one(&mut self) -> anyhow::Result<(Option<T>, u64)> {
        chosen(&mut *self.reader, &mut self.choice, self.name)
    }
}

impl<T> Iterator for Stream<'_, T> {
    type Item = anyhow::Result<T>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.reader.next(&mut self.choice).transpose()?;
        self.ended = next.is_err();
        Some(next.map_err(|error| self.choice.with_whole(error)))
    }
}

fn chosen<T>(
    reader: &mut dyn Reader<T>,
    choice: &mut Choice,
    name: &str,
) -> anyhow::Result<(Option<T>, u64)> {
    let one = choice.frame != FrameChoice::All;
    ensure!(one, "{name}: one frame is wanted here; give --frame a number from 0, or last");
    let mut kept = None;
    loop {
        match reader.next(choice) {
            Ok(Some(frame)) => kept = Some(frame),
            Ok(None) => break,
            // The chosen frame was complete before the error.
            Err(error)
                if kept.is_some()
                    && !choice.through
                    && matches!(choice.frame, FrameChoice::Number(_)) =>
            {
                let k = choice.end(name)?;
                let why = assumed!("frame {k} is whole, and a later one is not: {error:#}");
                choice.torn = Some(why);
                break;
            }
            Err(error) => return Err(choice.with_whole(error)),
        }
        // No later line can change the chosen frame.
        let is_last = !choice.survey && !choice.sparse && !choice.through;
        if matches!(choice.frame, FrameChoice::Number(_)) && is_last {
            break;
        }
    }
    Ok((kept, choice.end(name)?))
}
