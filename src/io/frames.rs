//! Which of a file's frames is read.

use anyhow::{bail, ensure};

use crate::io::{About, Options};

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
}

impl std::str::FromStr for Frame {
    type Err = String;

    fn from_str(text: &str) -> Result<Frame, String> {
        match text {
            "last" => Ok(Frame::Last),
            "first" => Ok(Frame::Number(0)),
            _ => text
                .parse()
                .map(Frame::Number)
                .map_err(|_| "it must be a number from 0, or last".into()),
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

/// Counts frames as they begin.
pub(crate) struct Frames {
    options: Options,
    seen: u64,
}

impl Frames {
    pub fn new(options: Options) -> Frames {
        Frames { options, seen: 0 }
    }

    /// A frame begins at `place`.
    pub fn begin(&mut self, place: impl Fn() -> String) -> anyhow::Result<Step> {
        let index = self.seen;
        self.seen += 1;
        Ok(match self.options.frame {
            Frame::Only if index > 0 => bail!(
                "{}: a second frame begins; say which one is to be read, with --frame 0 (the \
                 first) to --frame last, or remove the others",
                place()
            ),
            Frame::Only | Frame::Last => Step::Keep,
            Frame::Number(k) if k == index => Step::Keep,
            Frame::Number(k) if k < index && !self.options.survey => Step::Stop,
            Frame::Number(_) => Step::Skip,
        })
    }

    /// The file has ended, or no more is wanted.
    pub fn end(self, name: &str, mut about: About) -> anyhow::Result<About> {
        about.frames = self.seen;
        about.frame = match self.options.frame {
            Frame::Number(k) => {
                ensure!(
                    k < self.seen,
                    "{name} holds {} frames, numbered from 0; there is no frame {k}",
                    self.seen
                );
                k
            }
            Frame::Only | Frame::Last => self.seen.saturating_sub(1),
        };
        Ok(about)
    }
}
