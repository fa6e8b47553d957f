//! The frames of particles and the contact lists that another code wrote for them, brought
//! together.

use anyhow::{bail, ensure};

use crate::io::pairs::{List, Lists};
use crate::io::{About, Frames, Particles};

/// Steps that are named in a message.
const NAMED: usize = 6;

/// Frames with their lists: by time steps where both files have them, else by number. One of each
/// is held at a time.
pub struct Paired<'a, 'b> {
    particles: Frames<'a>,
    lists: Lists<'b>,
    /// Of the particles, and of the lists.
    names: [&'a str; 2],
    /// The next list; none where there are no more.
    next: Option<List>,
    begun: bool,
    /// By time steps.
    by_step: bool,
    /// The steps of the first particle frames, and of the last.
    steps: (Vec<i64>, Option<i64>),
    /// Particle frames without a list.
    pub left_out: Vec<u64>,
    /// Frames of which no row of the list speaks: lists without pairs.
    pub without_rows: u64,
}

impl<'a, 'b> Paired<'a, 'b> {
    /// Two files by their names.
    pub fn new(particles: Frames<'a>, lists: Lists<'b>, names: [&'a str; 2]) -> Paired<'a, 'b> {
        Paired {
            particles,
            lists,
            names,
            next: None,
            begun: false,
            by_step: false,
            steps: (Vec::new(), None),
            left_out: Vec::new(),
            without_rows: 0,
        }
    }

    /// They are brought together by time steps.
    pub fn is_by_step(&self) -> bool {
        self.by_step
    }

    /// The next frame of the particles that has a list, and the list.
    ///
    /// # Errors
    /// A file is broken, or a list has no particles, or the other way round.
    pub fn next(&mut self) -> anyhow::Result<Option<(Particles, About, List)>> {
        loop {
            let Some((particles, about)) = self.particles.next().transpose()? else {
                let next = self.next.take();
                return next.map_or(Ok(None), |list| self.without_particles(&list));
            };
            if !self.begun {
                self.begin(&about)?;
            }
            if let Some(list) = self.list_of(&about)? {
                return Ok(Some((particles, about, list)));
            }
        }
    }

    fn begin(&mut self, about: &About) -> anyhow::Result<()> {
        self.begun = true;
        self.next = self.lists.next().transpose()?;
        let step = self.next.as_ref().and_then(|list| list.step);
        self.by_step = step.is_some() && about.step.is_some();
        ensure!(
            self.by_step || step.is_none() || !self.lists.is_sparse(),
            "{}: the rows say their step, and {} has no steps; give the rows a column frame, \
             numbered from 0",
            self.names[1],
            self.names[0]
        );
        Ok(())
    }

    /// The list of a frame; none where it is left out.
    fn list_of(&mut self, about: &About) -> anyhow::Result<Option<List>> {
        let [particles, lists] = self.names;
        let at = if self.by_step { self.step(about)? } else { about.frame as i64 };
        let of = |list: &List| match (self.by_step, list.step, list.frame) {
            (true, Some(step), _) => Ok(step),
            (true, None, frame) => bail!(
                "{lists}: list {} has no time step, and those before it have; mend the file",
                frame.unwrap_or_default()
            ),
            (false, _, frame) => Ok(frame.unwrap_or_default() as i64),
        };
        let next = match &self.next {
            Some(list) => Some(of(list)?),
            None => None,
        };
        match next {
            Some(next) if next == at => {
                let list = self.next.take();
                self.next = self.lists.next().transpose()?;
                if let (Some(list), Some(next)) = (&list, &self.next) {
                    let [a, b] = [of(list)?, of(next)?];
                    ensure!(a < b, "{lists}: step {b} stands after step {a}; write them in order");
                }
                Ok(list)
            }
            Some(next) if next < at => match self.next.take() {
                Some(list) => self.without_particles(&list),
                None => Ok(None),
            },
            _ if self.lists.is_sparse() => {
                self.without_rows += 1;
                let (frame, step) = (Some(about.frame), about.step);
                Ok(Some(List { format: "rows", frame, step, ..List::default() }))
            }
            _ if self.by_step => {
                self.left_out.push(about.frame);
                Ok(None)
            }
            _ => bail!(
                "{lists} has no list for {} of {particles}, and not both have time steps by which \
                 to bring them together; write a list for each frame, or give --frame K for the \
                 one that was listed",
                about.which()
            ),
        }
    }

    /// The step of a frame of the particles, which is larger than that before.
    fn step(&mut self, about: &About) -> anyhow::Result<i64> {
        let name = self.names[0];
        let Some(step) = about.step else {
            bail!("{name}: {} has no time step, and those before it have; mend it", about.which())
        };
        if let Some(last) = self.steps.1.replace(step) {
            ensure!(
                last < step,
                "{name}: step {step} stands after step {last}; write the frames in order"
            );
        }
        if self.steps.0.len() < NAMED {
            self.steps.0.push(step);
        }
        Ok(step)
    }

    /// Refuses a list.
    fn without_particles<T>(&self, list: &List) -> anyhow::Result<T> {
        let [particles, lists] = self.names;
        match list.step.filter(|_| self.by_step) {
            Some(step) => {
                let (first, last) = &self.steps;
                let mut there: Vec<String> = first.iter().map(i64::to_string).collect();
                if let Some(last) = last.filter(|last| !first.contains(last)) {
                    there.push(format!("… {last}"));
                }
                bail!(
                    "{lists}: the list of step {step} has no particles: {particles} has the steps \
                     {}; write both at the same steps",
                    there.join(" ")
                )
            }
            None => bail!(
                "{lists}: the list of frame {} (from 0) has no particles: {particles} ends before \
                 it; write as many frames as lists",
                list.frame.unwrap_or_default()
            ),
        }
    }
}
