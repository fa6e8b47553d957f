//! Reads the frames of a file as one motion of the same particles.

use anyhow::{Context, bail, ensure};

use contactbench_ground::scene::Lattice;
use contactbench_io::boxes::along;
use contactbench_io::{About, Given, Particles};

/// Frames of the same particles, with the same periodic axes. Particles are identified and sorted
/// by their ids; a file without ids must keep their order.
pub struct Recorded<'a, I> {
    frames: I,
    name: &'a str,
    radius: Option<f64>,
    first: Option<First>,
}

struct First {
    len: usize,
    dim: usize,
    ids: Option<Vec<i64>>,
    repeats: [bool; 3],
}

fn repeats(particles: &Particles) -> [bool; 3] {
    let [x, y, z] = particles.lattice.as_ref().map_or([false; 3], Lattice::periodic);
    [x, y, z && particles.dim() == 3]
}

impl<'a, I: Iterator<Item = anyhow::Result<(Particles, About)>>> Recorded<'a, I> {
    /// `radius` is the radius of all particles if the file has no radii.
    pub fn new(frames: I, name: &'a str, radius: Option<f64>) -> Recorded<'a, I> {
        Recorded { frames, name, radius, first: None }
    }

    /// Returns the next frame, or `None` after the last. Fails if the file is broken, or particles
    /// or periodic axes differ from the first frame.
    pub fn next_frame(&mut self) -> anyhow::Result<Option<Given>> {
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
        let ids = particles.ids_copied()?;
        Ok(First { len: particles.len(), dim: particles.dim(), ids, repeats: repeats(particles) })
    }

    fn same(&self, particles: &Particles) -> anyhow::Result<()> {
        let remedy = "a motion needs the same particles: write all of them in every frame, or use \
                      only the frames before (--frames)";
        let (n, dim, First { len, dim: first, .. }) = (particles.len(), particles.dim(), self);
        ensure!(
            n == *len && dim == *first,
            "{n} particles in {dim}D, and {len} in {first}D in the first frame; {remedy}"
        );
        let repeats = repeats(particles);
        ensure!(
            repeats == self.repeats,
            "the box is periodic along {}, but along {} in the first frame; give the axes of all \
             frames (--periodic), or --open",
            along(repeats),
            along(self.repeats)
        );
        let (ids, before) = (particles.ids.as_deref(), self.ids.as_deref());
        ensure!(
            ids.is_some() == before.is_some(),
            "particles have ids in some frames alone; write the column in all, or in none"
        );
        let (ids, before) = (ids.unwrap_or_default(), before.unwrap_or_default());
        if let Some((new, old)) = ids.iter().zip(before).find(|(new, old)| new != old) {
            let (what, id) = if new < old { ("a new", new) } else { ("no", old) };
            bail!("there is {what} particle of id {id}; {remedy}");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_io::{FrameChoice, Options, frames_from};

    /// Returns the coordinates by frame of a dump with rows `id x`, and the error at its end.
    fn read(frames: &[&[(i64, f64)]]) -> (Vec<Vec<f64>>, String) {
        let frame = |(k, rows): (usize, &&[(i64, f64)])| {
            let n = rows.len();
            let rows: String = rows.iter().map(|(id, x)| format!("{id} {x} 0 0\n")).collect();
            format!(
                "ITEM: TIMESTEP\n{k}0\nITEM: NUMBER OF ATOMS\n{n}\nITEM: ATOMS id x y z\n{rows}"
            )
        };
        let text: String = frames.iter().enumerate().map(frame).collect();
        let options =
            Options { ids: true, frame: FrameChoice::All, radius: Some(1.0), ..Options::default() };
        let mut places = Vec::new();
        let end = frames_from(text.as_bytes(), "p", "", options, |frames| {
            let mut recorded = Recorded::new(frames, "p", Some(1.0));
            while let Some(given) = recorded.next_frame()? {
                let scene = given.scene;
                let x = |k| contactbench_scenes::touching::particle(&scene, k).0[0];
                places.push((0..scene.len() as u32).map(x).collect());
            }
            Ok(())
        });
        (places, end.map_or_else(|error| format!("{error:#}"), |()| String::new()))
    }

    #[test]
    fn particles_are_the_same_whatever_their_order_in_the_file() {
        let frames = [&[(4, 0.0), (2, 1.0), (9, 2.0)][..], &[(9, 5.0), (4, 3.0), (2, 4.0)]];
        assert_eq!(read(&frames), (vec![vec![1.0, 0.0, 2.0], vec![4.0, 3.0, 5.0]], String::new()));
    }

    #[test]
    fn other_particles_are_refused_with_the_frame() {
        let two = &[(1, 0.0), (2, 1.0)][..];
        for (frame, words) in [
            (&[(1, 0.0)][..], "p: frame 1 (step 10): 1 particles in 3D, and 2 in 3D in the first"),
            (&[(1, 0.0), (3, 1.0)], "p: frame 1 (step 10): there is no particle of id 2; a motion"),
            (&[(0, 0.0), (2, 1.0)], "p: frame 1 (step 10): there is a new particle of id 0; a mo"),
            (&[(2, 0.0), (2, 1.0)], "p: frame 1 (step 10): the id 2 stands twice"),
        ] {
            let (places, end) = read(&[two, frame, two]);
            assert_eq!(places.len(), 1);
            assert!(end.starts_with(words), "{end}");
        }
    }
}
