//! The frames of a file, one after the other, and which of them are wanted.

use anyhow::{bail, ensure};

use crate::io::{About, Options, Particles};

/// A choice among the frames of a file, which are numbered from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// The only one; several are refused.
    #[default]
    Only,
    /// The one of that number.
    Number(u64),
    /// The last one.
    Last,
    /// Each of them: see [`Frames`].
    All,
}

impl std::str::FromStr for Frame {
    type Err = String;

    fn from_str(text: &str) -> Result<Frame, String> {
        match text {
            "last" => Ok(Frame::Last),
            "first" => Ok(Frame::Number(0)),
            "all" => Ok(Frame::All),
            _ => text
                .parse()
                .map(Frame::Number)
                .map_err(|_| "it must be a number from 0, or last, or all".into()),
        }
    }
}

/// What to do with the frame that begins.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Step {
    Keep,
    Skip,
    Stop,
}

/// Counts frames as they begin, and says which are wanted.
pub(crate) struct Choice {
    frame: Frame,
    /// To the end of the file, whatever is wanted.
    survey: bool,
    /// The number of the last that has begun, and one more.
    pub seen: u64,
    /// Frames that are not there hold nothing.
    pub sparse: bool,
    /// Frames say their time step, and those that are not there have no number.
    pub by_step: bool,
}

impl Choice {
    pub fn new(frame: Frame, survey: bool) -> Choice {
        Choice { frame, survey, seen: 0, sparse: false, by_step: false }
    }

    /// All are wanted.
    pub fn is_all(&self) -> bool {
        self.frame == Frame::All
    }

    /// The next frame begins at `place`.
    pub fn begin(&mut self, place: impl Fn() -> String) -> anyhow::Result<Step> {
        self.begin_at(self.seen, place)
    }

    /// The frame of this number begins at `place`; those between it and the last are not there.
    pub fn begin_at(&mut self, index: u64, place: impl Fn() -> String) -> anyhow::Result<Step> {
        let is_first = std::mem::replace(&mut self.seen, index + 1) == 0;
        Ok(match self.frame {
            Frame::Only if !is_first => bail!(
                "{}: a second frame begins; say which one is to be read, with --frame 0 (the \
                 first) to --frame last, or remove the others",
                place()
            ),
            Frame::Only | Frame::Last | Frame::All => Step::Keep,
            Frame::Number(k) if k == index => Step::Keep,
            Frame::Number(k) if k < index && !self.survey => Step::Stop,
            Frame::Number(_) => Step::Skip,
        })
    }

    /// The file has ended, or no more is wanted: the number of the frame that was kept last.
    fn end(&self, name: &str) -> anyhow::Result<u64> {
        if let Frame::Number(k) = self.frame
            && (self.seen > 0 || self.sparse)
        {
            ensure!(
                k < self.seen || self.sparse && !self.by_step,
                "{name} holds {} frames, numbered from 0; there is no frame {k}",
                self.seen
            );
            return Ok(k);
        }
        Ok(self.seen.saturating_sub(1))
    }
}

/// Reads the frames of a file of one format: of particles, or of contact lists.
pub(crate) trait Reader<T> {
    /// The next frame that is kept; none when the file has ended, or no more is wanted.
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<T>>;
}

/// A reader of a file that holds one frame.
pub(crate) struct Once<F>(Option<F>);

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

/// The one frame that was chosen, and its number.
pub(crate) fn chosen<T>(
    reader: &mut dyn Reader<T>,
    choice: &mut Choice,
    name: &str,
) -> anyhow::Result<(Option<T>, u64)> {
    ensure!(
        choice.frame != Frame::All,
        "{name}: one frame is wanted here; give --frame a number from 0, or last"
    );
    let mut kept = None;
    while let Some(frame) = reader.next(choice)? {
        kept = Some(frame);
    }
    Ok((kept, choice.end(name)?))
}

/// The frames of a particle file, one after the other: no more than one is held at a time.
///
/// Particles stand in the order of the file, frame by frame; see [`Particles::sort_by_id`] for one
/// that is the same in all. Each frame says its number and, where the format has one, its time step
/// ([`About`]). Numbers of particles, ids and boxes may change from one to the next.
pub struct Frames<'a> {
    pub(super) reader: Box<dyn Reader<(Particles, About)> + 'a>,
    pub(super) choice: Choice,
    pub(super) name: &'a str,
    pub(super) options: Options,
    pub(super) gzip: bool,
    pub(super) ended: bool,
}

impl Frames<'_> {
    /// The frame that was chosen.
    pub(super) fn chosen(mut self) -> anyhow::Result<(Particles, About)> {
        let Frames { reader, choice, name, .. } = &mut self;
        let (kept, frame) = chosen(&mut **reader, choice, name)?;
        let Some(kept) = kept else {
            bail!("{name} holds no frame of particles; is it of another format?")
        };
        self.finished(kept, frame)
    }

    fn finished(
        &self,
        (particles, about): (Particles, About),
        frame: u64,
    ) -> anyhow::Result<(Particles, About)> {
        let (gzip, frames) = (self.gzip, self.choice.seen.max(1));
        super::finished(particles, About { gzip, frames, frame, ..about }, self.name, self.options)
    }
}

/// An error ends them.
impl Iterator for Frames<'_> {
    type Item = anyhow::Result<(Particles, About)>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.reader.next(&mut self.choice).transpose()?;
        let frame = self.choice.seen.saturating_sub(1);
        let next = next.and_then(|read| self.finished(read, frame));
        self.ended = next.is_err();
        Some(next)
    }
}
