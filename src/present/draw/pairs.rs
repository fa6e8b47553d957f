//! The pairs of a picture: contacts, near misses, and what a list got wrong.

use anyhow::{Context, bail};

use crate::contact::Arithmetic;
use crate::contact::depth::depth;
use crate::crowd;
use crate::detect::{Options, table};
use crate::io::pairs::List;
use crate::scene::{AnyScene, Radii, Real, Scene, array};
use crate::sink::normalise;
use crate::with_scene;

/// Two particles are nearly tangent if the overlap or the gap is under this part of their mean
/// radius.
pub const NEAR: f64 = 1e-6;

/// Pairs of particles, each of its own look. Particles count from 0, the order within a pair does
/// not matter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highlighted {
    /// Pairs that touch, and were not missed.
    pub contacts: Vec<[u32; 2]>,
    /// Pairs that just do not touch.
    pub near: Vec<[u32; 2]>,
    /// Pairs that touch, and that a list lacks.
    pub missed: Vec<[u32; 2]>,
    /// Pairs that do not touch, and that a list has; also a particle with itself.
    pub spurious: Vec<[u32; 2]>,
    /// Pairs that a list has more than once, once for each time too many.
    pub duplicates: Vec<[u32; 2]>,
}

impl Highlighted {
    /// The contacts of a scene, decided exactly, and the pairs that just do not touch. A list of
    /// pairs may take `memory_limit` bytes.
    pub fn from_scene(scene: &AnyScene<'_>, memory_limit: u64) -> anyhow::Result<Highlighted> {
        let contacts = find(scene, memory_limit)?;
        let near = almost(scene, &contacts, memory_limit);
        Ok(Highlighted { contacts, near, ..Highlighted::default() })
    }

    /// The same, and what a list of pairs has missed or added.
    pub fn compare(
        scene: &AnyScene<'_>,
        mut reported: Vec<[u32; 2]>,
        memory_limit: u64,
    ) -> anyhow::Result<Highlighted> {
        let mut pairs = Highlighted::from_scene(scene, memory_limit)?;
        normalise(&mut reported);
        pairs.duplicates =
            reported.array_windows().filter(|[a, b]| a == b).map(|[a, _]| *a).collect();
        reported.dedup();
        let absent = |pair: &&[u32; 2], others: &[[u32; 2]]| others.binary_search(pair).is_err();
        let missed = pairs.contacts.iter().filter(|pair| absent(pair, &reported));
        pairs.missed = missed.copied().collect();
        let mut spurious = std::mem::take(&mut reported);
        spurious.retain(|pair| absent(&pair, &pairs.contacts));
        pairs.spurious = spurious;
        pairs.contacts.retain(|pair| absent(&pair, &pairs.missed));
        pairs.check(scene.len())?;
        Ok(pairs)
    }

    /// The pair that a list got wrong by most: the deepest that it missed, else the widest apart
    /// that it has, or one that it has twice.
    pub fn worst(&self, scene: &AnyScene<'_>) -> Option<[u32; 2]> {
        let depth = |pair: &&[u32; 2]| depth_of(scene, **pair).abs();
        let by_depth = |a: &&[u32; 2], b: &&[u32; 2]| depth(a).total_cmp(&depth(b));
        let missed = self.missed.iter().max_by(by_depth);
        let worst = missed.or_else(|| self.spurious.iter().max_by(by_depth));
        worst.or(self.duplicates.first()).copied()
    }

    /// Refuses particles that a scene of `n` does not have.
    pub fn check(&self, n: usize) -> anyhow::Result<()> {
        let all = [&self.contacts, &self.near, &self.missed, &self.spurious, &self.duplicates];
        match all.into_iter().flatten().find(|pair| pair.iter().any(|&k| k as usize >= n)) {
            None => Ok(()),
            Some([i, j]) => bail!(
                "the pair {i},{j}: the scene has {n} particles, numbered from 0; the list belongs \
                 to another scene"
            ),
        }
    }
}

/// The touching pairs of a scene, decided exactly, in ascending order; they may take
/// `memory_limit` bytes.
pub fn find(scene: &AnyScene<'_>, memory_limit: u64) -> anyhow::Result<Vec<[u32; 2]>> {
    crowd::within(scene, memory_limit)?;
    let options = Options { memory_limit, ..Options::default() };
    let mut refused = None;
    // Cells first; a tree where the scene is too wide for them.
    for mut detector in [table::fast(options), table::robust(options)] {
        let mut pairs = Vec::new();
        match detector.list(scene, Arithmetic::Exact.test(), &mut pairs) {
            Ok(()) => {
                normalise(&mut pairs);
                return Ok(pairs);
            }
            Err(refusal) if refusal.is_of_scene() => return Err(refusal.into()),
            Err(refusal) => refused = refused.or(Some(refusal)),
        }
    }
    match refused {
        Some(refusal) => Err(refusal.into()),
        None => bail!("no detector can take this scene"),
    }
}

/// Pairs that do not touch, with a gap under [`NEAR`]. None where larger radii leave the range of
/// doubles.
fn almost(scene: &AnyScene<'_>, contacts: &[[u32; 2]], memory_limit: u64) -> Vec<[u32; 2]> {
    let larger = with_scene!(scene, scene => {
        let wide = |centre| array(centre).map(Real::wide).to_vec();
        let points: Vec<Vec<f64>> = scene.centres().iter().map(wide).collect();
        let larger = |k| scene.radius(k).wide() * (1.0 + NEAR);
        grown(&points, (0..scene.len()).map(larger).collect())
    });
    let Some(Ok(mut pairs)) = larger.map(|larger| find(&larger, memory_limit)) else {
        return Vec::new();
    };
    pairs.retain(|pair| {
        contacts.binary_search(pair).is_err() && depth_of(scene, *pair).abs() < NEAR
    });
    pairs
}

fn grown(points: &[Vec<f64>], radii: Vec<f64>) -> Option<AnyScene<'static>> {
    fn scene<const D: usize>(
        points: &[Vec<f64>],
        radii: Vec<f64>,
    ) -> Option<Scene<'static, f64, D>> {
        let points: Option<Vec<_>> = points
            .iter()
            .map(|p| p.first_chunk::<D>().map(|&p| nalgebra::Point::from(p)))
            .collect();
        Scene::new(points?, Radii::Each(radii.into())).ok()
    }
    if points.first()?.len() == 2 {
        scene::<2>(points, radii).map(AnyScene::from)
    } else {
        scene::<3>(points, radii).map(AnyScene::from)
    }
}

/// See [`depth`]; of particles that the scene has.
pub fn depth_of(scene: &AnyScene<'_>, [i, j]: [u32; 2]) -> f64 {
    let (i, j) = (i as usize, j as usize);
    with_scene!(scene, scene => {
        let [a, b] = [i, j].map(|k| array(&scene.centres()[k]).map(Real::wide));
        depth(&a, &b, scene.radius(i).wide(), scene.radius(j).wide())
    })
}

/// The pairs of a list whose numbers are places in the file, from 0; images are refused, also those
/// without a name if the file of the scene has a box.
pub fn without_images(mut list: List, has_box: bool) -> anyhow::Result<Vec<[u32; 2]>> {
    if !has_box {
        list.without_box();
    }
    if let Some(k) = list.images.iter().flatten().position(|image| *image != [0; 3]) {
        let [i, j] = list.pairs[k];
        bail!(
            "the pair {i},{j} names an image in a box that repeats, and boundaries are open here; \
             give --box LX,LY,LZ"
        );
    }
    places(&list.pairs)
}

/// Numbers of particles, from 0.
pub(super) fn places(list: &[[i64; 2]]) -> anyhow::Result<Vec<[u32; 2]>> {
    let mut pairs = Vec::new();
    let room = pairs.try_reserve_exact(list.len());
    room.with_context(|| format!("no memory for {} pairs", list.len()))?;
    for &[i, j] in list {
        let (Ok(a), Ok(b)) = (u32::try_from(i), u32::try_from(j)) else {
            bail!(
                "the pair {i},{j}: particles are numbered from 0; contactbench verify reads other \
                 numbers"
            )
        };
        pairs.push([a, b]);
    }
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Frame, pairs};

    fn read(path: &std::path::Path, has_box: bool) -> anyhow::Result<Vec<[u32; 2]>> {
        without_images(pairs::read(path, &[], Frame::Only)?, has_box)
    }

    fn discs(centres: &[[f64; 2]], r: f64) -> AnyScene<'static> {
        Scene::new(
            centres.iter().copied().map(nalgebra::Point::from).collect::<Vec<_>>(),
            Radii::Uniform(r),
        )
        .unwrap()
        .into()
    }

    #[test]
    fn a_list_is_taken_apart() {
        let scene = discs(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0000001, 0.0]], 0.5);
        let pairs =
            Highlighted::compare(&scene, vec![[2, 1], [1, 2], [3, 0], [0, 0]], 1 << 20).unwrap();
        assert_eq!(pairs.contacts, [[1, 2]]);
        assert_eq!(pairs.missed, [[0, 1]]);
        assert_eq!(pairs.near, [[2, 3]]);
        assert_eq!(pairs.spurious, [[0, 0], [0, 3]]);
        assert_eq!(pairs.duplicates, [[1, 2]]);
        let error = Highlighted::compare(&scene, vec![[0, 4]], 1 << 20).unwrap_err().to_string();
        assert!(error.contains("the pair 0,4: the scene has 4 particles"), "{error}");
    }

    #[test]
    fn lists_are_read_or_refused_with_the_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.csv");
        for text in [
            "i,j\n0,1\n2,3\n",
            "0,1\n\n# more\n2,3,0.25",
            "0 1\n2\t3\n",
            "i;j\r\n0;1\r\n2;3\r\n",
            "0 1 1 2\n2 3 1 1\n",
        ] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(read(&path, false).unwrap(), [[0, 1], [2, 3]], "{text:?}");
        }
        for (text, words) in [
            ("i,j\n0,1\n2,x\n", "pairs.csv:3: column 2: 'x' is not the number of a particle"),
            ("i,j\n\n-1,2\n", "the pair -1,2: particles are numbered from 0"),
            ("0,1\n2,3\n4294967296,1\n", "the pair 4294967296,1: particles"),
            ("0,1\n0,2\n5\n", "pairs.csv:3: column 2: '' is not the number"),
            ("i,j\r0,1\r2,3\r", "pairs.csv:1: a line ends in a carriage return alone"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = format!("{:#}", read(&path, false).unwrap_err());
            assert!(error.contains(words), "{text:?}: {error}");
        }
    }
}
