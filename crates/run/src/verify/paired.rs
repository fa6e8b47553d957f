//! Matches frames of particles with the contact lists that another program wrote for them.

use std::cmp::Ordering;

use anyhow::{bail, ensure};

use contactbench_io::pairs::{List, Lists};
use contactbench_io::{About, Frames, Particles};

/// Frames with their lists, matched by time step if both files have steps, otherwise by number.
/// Only one frame and one list are in memory at a time.
pub struct Paired<'a, 'b> {
    particles: Frames<'a>,
    lists: Lists<'b>,
    names: [&'a str; 2],
    next: Option<List>,
    begun: bool,
    stepless: bool,
    renumbered: bool,
    /// Step of the last frame read.
    last: Option<i64>,
    pub matched: Matched,
}

/// How frames and lists were matched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matched {
    pub by_step: bool,
    /// Frames without a list, which are not compared.
    pub left_out: Vec<u64>,
    /// Number of frames for which the list has no rows; they have no contacts.
    pub without_rows: u64,
}

impl<'a, 'b> Paired<'a, 'b> {
    pub fn new(particles: Frames<'a>, lists: Lists<'b>, names: [&'a str; 2]) -> Paired<'a, 'b> {
        Paired {
            particles,
            lists,
            names,
            next: None,
            begun: false,
            stepless: false,
            renumbered: false,
            last: None,
            matched: Matched::default(),
        }
    }

    /// Returns the next frame that has a list, with the list. Fails if a file is broken, a list has
    /// no frame, or a frame has no list although lists are matched by number.
    pub fn next_frame(&mut self) -> anyhow::Result<Option<(Particles, About, List)>> {
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
        ensure!(
            about.step.is_some() || step.is_none() || !self.lists.is_sparse(),
            "{}: the rows have steps, but {} has none; give the rows a column frame, numbered from \
             0",
            self.names[1],
            self.names[0]
        );
        Ok(())
    }

    fn list_of(&mut self, about: &About) -> anyhow::Result<Option<List>> {
        let [particles, lists] = self.names;
        let listed = self.next.as_ref().and_then(|list| list.step);
        self.matched.by_step |= listed.is_some() && about.step.is_some();
        let at = if self.matched.by_step { Some(self.step(about)?) } else { None };
        let order = self.next.as_ref().map(|list| match list.step.zip(at) {
            Some((step, at)) => step.cmp(&at),
            None => list.frame.unwrap_or_default().cmp(&about.frame),
        });
        match (order, self.next.take()) {
            (Some(Ordering::Equal), Some(list)) => {
                self.next = self.lists.next().transpose()?;
                let next = self.next.as_ref().and_then(|next| next.step);
                if let (true, Some(a), Some(b)) = (self.matched.by_step, list.step, next) {
                    ensure!(a < b, "{lists}: step {b} stands after step {a}; write them in order");
                }
                self.stepless |= list.step.is_none();
                self.hold_numbers(list.frame == Some(about.frame))?;
                Ok(Some(list))
            }
            (Some(Ordering::Less), Some(list)) => {
                self.stepless |= list.step.is_none();
                self.hold_numbers(true)?;
                self.without_particles(&list)
            }
            (_, next) if self.lists.is_sparse() => {
                self.next = next;
                self.matched.without_rows += 1;
                let (frame, step) = (Some(about.frame), about.step);
                Ok(Some(List { format: "rows", frame, step, sparse: true, ..List::default() }))
            }
            (_, next) if self.matched.by_step => {
                self.next = next;
                self.matched.left_out.push(about.frame);
                self.hold_numbers(false)?;
                Ok(None)
            }
            _ => bail!(
                "{lists} has no list for {} of {particles}, and not both have time steps to match \
                 them by; write a list for each frame, or give --frame K for the one that was \
                 listed",
                about.which()
            ),
        }
    }

    /// Lists without rows have no step, so they can be matched only if lists are numbered like the
    /// frames.
    fn hold_numbers(&mut self, same: bool) -> anyhow::Result<()> {
        let [particles, lists] = self.names;
        self.renumbered |= !same;
        ensure!(
            !(self.matched.by_step && self.stepless && self.renumbered),
            "{lists}: a list without rows has no step, and lists cannot be matched by number, \
             because not every frame of {particles} has one; write a list for each frame"
        );
        Ok(())
    }

    /// Returns the step of a frame; fails unless it is larger than the step before.
    fn step(&mut self, about: &About) -> anyhow::Result<i64> {
        let name = self.names[0];
        let Some(step) = about.step else {
            bail!("{name}: {} has no time step, and those before it have; fix it", about.which())
        };
        if let Some(last) = self.last.replace(step) {
            ensure!(
                last < step,
                "{name}: step {step} stands after step {last}; write the frames in order"
            );
        }
        Ok(step)
    }

    fn without_particles<T>(&self, list: &List) -> anyhow::Result<T> {
        let [particles, lists] = self.names;
        match list.step.filter(|_| self.matched.by_step) {
            Some(step) => bail!(
                "{lists}: the list of step {step} has no particles in {particles}; write both at \
                 the same steps"
            ),
            None => bail!(
                "{lists}: the list of frame {} (from 0) has no particles: {particles} ends before \
                 it; write as many frames as lists",
                list.frame.unwrap_or_default()
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_io::pairs::{self, lists_from};
    use contactbench_io::{FrameChoice, Options, frames_from};

    /// Returns these rows for each step; `K` stands for the step.
    fn each(steps: &[i64], rows: &str) -> String {
        let frame =
            |step: &i64| format!("ITEM: TIMESTEP\nK\n{rows}").replace('K', &step.to_string());
        steps.iter().map(frame).collect()
    }

    fn dump(steps: &[i64]) -> String {
        each(steps, "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS id x y z\n1 0 0 0\n")
    }

    fn local(steps: &[i64]) -> String {
        each(steps, "ITEM: NUMBER OF ENTRIES\n1\nITEM: ENTRIES i j\nK 0\n")
    }

    /// Matched frames with the first number in their list (-1 if empty), numbers of frames left
    /// out, and number of frames without rows.
    type Told = (Vec<(u64, i64)>, Vec<u64>, u64);

    fn told(frames: Frames<'_>, lists: Lists<'_>) -> anyhow::Result<Told> {
        let (mut paired, mut told) = (Paired::new(frames, lists, ["p", "l"]), vec![]);
        while let Some((_, about, list)) = paired.next_frame()? {
            told.push((about.frame, list.pairs.first().map_or(-1, |pair| pair[0])));
        }
        Ok((told, paired.matched.left_out, paired.matched.without_rows))
    }

    const ALL: FrameChoice = FrameChoice::All;

    fn options() -> Options {
        Options { frame: ALL, radius: Some(1.0), ..Options::default() }
    }

    /// Here each list is a file of its own; a file without rows is a list without a step.
    #[test]
    fn files_without_rows_are_lists_of_the_frames_of_their_number() {
        let of = |particles: &[i64], lists: &[Option<i64>]| {
            let folder = tempfile::tempdir().unwrap();
            for (k, step) in lists.iter().enumerate() {
                let row = step.map_or_else(String::new, |step| format!("{step},{step},9\n"));
                let path = folder.path().join(format!("l_{k}.csv"));
                std::fs::write(path, format!("step,i,j\n{row}")).unwrap();
            }
            let found = frames_from(dump(particles).as_bytes(), "p", "", options(), |frames| {
                let path = folder.path().join("l_*.csv");
                pairs::lists(&path, &[], ALL, |lists| told(frames, lists))
            });
            found.map_err(|error| format!("{error:#}"))
        };
        let steps = [0, 10, 20, 30];
        for (lists, firsts) in [
            ([Some(0), None, Some(20), None], [0, -1, 20, -1]),
            ([None, Some(10), None, Some(30)], [-1, 10, -1, 30]),
        ] {
            let expected = (0..).zip(firsts).collect();
            assert_eq!(of(&steps, &lists), Ok((expected, vec![], 0)));
        }
        let fewer = of(&steps, &[Some(10), Some(30)]);
        assert_eq!(fewer, Ok((vec![(1, 10), (3, 30)], vec![0, 2], 0)));
        for lists in [
            &[None, Some(20), Some(30)][..],
            &[Some(0), None, Some(30)],
            &[Some(0), Some(10), None],
            &[Some(10), None],
        ] {
            let error = of(&steps, lists).unwrap_err();
            assert!(error.contains("l: a list without rows has no step"), "{error}");
        }
        let more = of(&[0], &[Some(0), None]).unwrap_err();
        assert!(more.contains("l: the list of frame 1 (from 0) has no particles: p"), "{more}");
    }

    #[test]
    fn frames_are_brought_together_by_steps_or_else_by_number() {
        let (five, xyz) = (&*dump(&[0, 10, 20, 30, 40]), |n: usize| "1\n\nA 0 0 0\n".repeat(n));
        for (particles, lists, expected) in [
            (five, &*local(&[0, 20, 40]), "([(0, 0), (2, 20), (4, 40)], [1, 3], 0)"),
            (five, &local(&[10]), "([(1, 10)], [0, 2, 3, 4], 0)"),
            (five, &local(&[0, 15, 20]), "l: the list of step 15 has no particles in p; "),
            (five, &local(&[0, 20, 50]), "l: the list of step 50 has no particles in p; "),
            (&dump(&[0, 10, 10]), &local(&[0, 10]), "p: step 10 stands after step 10"),
            (five, &local(&[0, 10, 10]), "l: step 10 stands after step 10"),
            (&xyz(2), &local(&[0, 20]), "([(0, 0), (1, 20)], [], 0)"),
            (&xyz(3), &local(&[0, 20]), "l has no list for frame 2 of p, and not both have"),
            (&xyz(1), &local(&[0, 20]), "l: the list of frame 1 (from 0) has no particles: p"),
            (&xyz(1), "i,j\n7,8\n", "([(0, 7)], [], 0)"),
            (&xyz(2), "i,j\n7,8\n", "l has no list for frame 1 of p"),
            // Frames of which no row speaks have no contacts.
            (five, "frame,i,j\n1,7,8\n", "([(0, -1), (1, 7), (2, -1), (3, -1), (4, -1)], [], 4)"),
            (five, "step,i,j\n40,9,8\n", "([(0, -1), (1, -1), (2, -1), (3, -1), (4, 9)], [], 4)"),
            (&dump(&[0]), "frame,i,j\n", "([(0, -1)], [], 1)"),
            (five, "step,i,j\n5,7,8\n", "l: the list of step 5"),
            (five, "frame,i,j\n5,7,8\n", "l: the list of frame 5"),
            (&xyz(1), "step,i,j\n5,7,8\n", "l: the rows have steps, but p has none"),
        ] {
            let found = frames_from(particles.as_bytes(), "p", "", options(), |frames| {
                lists_from(lists.as_bytes(), "l", &[], ALL, |lists| told(frames, lists))
            });
            let found = found.map_or_else(|error| format!("{error:#}"), |told| format!("{told:?}"));
            assert!(found.starts_with(expected), "{found}");
        }
    }
}
