//! The frames of a file as those of one motion: of the same particles.

use anyhow::{Context, ensure};

use crate::io::{About, Particles};
use crate::scene::Given;

/// Frames of the same particles: told apart by the ids of the file, where it has such, and then in
/// their order; else by their places.
pub struct Recorded<'a, I> {
    frames: I,
    name: &'a str,
    radius: Option<f64>,
    /// Of the first frame.
    first: Option<First>,
}

struct First {
    len: usize,
    dim: usize,
    /// In order.
    ids: Option<Vec<i64>>,
}

impl<'a, I: Iterator<Item = anyhow::Result<(Particles, About)>>> Recorded<'a, I> {
    /// Of [`Frames`](crate::io::Frames); the radius is that of all, for files that hold none.
    pub fn new(frames: I, name: &'a str, radius: Option<f64>) -> Recorded<'a, I> {
        Recorded { frames, name, radius, first: None }
    }

    /// The next frame, none after the last.
    ///
    /// # Errors
    /// The file is broken, or the frame holds other particles than the first.
    pub fn next(&mut self) -> anyhow::Result<Option<Given>> {
        let Some((mut particles, about)) = self.frames.next().transpose()? else {
            return Ok(None);
        };
        particles.sort_by_id().with_context(|| self.place(&about))?;
        match &self.first {
            None => self.first = Some(First::new(&particles)?),
            Some(first) => first.same(&particles).with_context(|| self.place(&about))?,
        }
        particles.given(self.name, self.radius).with_context(|| about.which()).map(Some)
    }

    fn place(&self, about: &About) -> String {
        format!("{}: {}", self.name, about.which())
    }
}

impl First {
    fn new(particles: &Particles) -> anyhow::Result<First> {
        let ids = match particles.ids() {
            None => None,
            Some(ids) => {
                let mut copy = Vec::new();
                let room = copy.try_reserve_exact(ids.len());
                room.with_context(|| format!("no memory for {} ids", ids.len()))?;
                copy.extend_from_slice(ids);
                Some(copy)
            }
        };
        Ok(First { len: particles.len(), dim: particles.dim(), ids })
    }

    fn same(&self, particles: &Particles) -> anyhow::Result<()> {
        let remedy = "a motion is of the same particles: write all of them in every frame, or take \
                      those before (--frames)";
        ensure!(
            particles.len() == self.len && particles.dim() == self.dim,
            "{} particles in {}D, and {} in {}D in the first frame; {remedy}",
            particles.len(),
            particles.dim(),
            self.len,
            self.dim
        );
        let (ids, before) = (particles.ids(), self.ids.as_deref());
        ensure!(
            ids.is_some() == before.is_some(),
            "particles have ids in some frames alone; write the column in all, or in none"
        );
        let (ids, before) = (ids.unwrap_or_default(), before.unwrap_or_default());
        if let Some((new, old)) = ids.iter().zip(before).find(|(new, old)| new != old) {
            let [what, id] =
                if new < old { ["a new", &new.to_string()] } else { ["no", &old.to_string()] };
            anyhow::bail!("there is {what} particle of id {id}; {remedy}");
        }
        Ok(())
    }
}
