//! The pairs of a picture: contacts, near misses, and what a list got wrong.

use std::io::{BufRead, BufReader};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use crate::contact::Arithmetic;
use crate::contact::depth::depth;
use crate::detect::{Options, table};
use crate::io::LONGEST_LINE;
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
    /// The contacts of a scene, decided exactly, and the pairs that just do not touch.
    pub fn from_scene(scene: &AnyScene<'_>) -> anyhow::Result<Highlighted> {
        let contacts = find(scene)?;
        let near = almost(scene, &contacts);
        Ok(Highlighted { contacts, near, ..Highlighted::default() })
    }

    /// The same, and what a list of pairs has missed or added.
    pub fn compare(scene: &AnyScene<'_>, reported: &[[u32; 2]]) -> anyhow::Result<Highlighted> {
        let mut pairs = Highlighted::from_scene(scene)?;
        let mut reported = reported.to_vec();
        normalise(&mut reported);
        pairs.duplicates =
            reported.array_windows().filter(|[a, b]| a == b).map(|[a, _]| *a).collect();
        reported.dedup();
        let (found, missed) =
            pairs.contacts.iter().partition(|pair| reported.binary_search(pair).is_ok());
        pairs.spurious = reported
            .into_iter()
            .filter(|pair| pairs.contacts.binary_search(pair).is_err())
            .collect();
        pairs.contacts = found;
        pairs.missed = missed;
        pairs.check(scene.len())?;
        Ok(pairs)
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

/// The touching pairs of a scene, decided exactly, in ascending order.
pub fn find(scene: &AnyScene<'_>) -> anyhow::Result<Vec<[u32; 2]>> {
    let mut refused = None;
    // Cells first; a tree where the scene is too wide for them.
    for name in ["nbs", "kd-tree", "direct"] {
        let Some(entry) = table::find(name).filter(|_| name != "direct" || scene.len() <= 20_000)
        else {
            continue;
        };
        let mut pairs = Vec::new();
        match entry.make(Options::default()).list(scene, Arithmetic::Exact.test(), &mut pairs) {
            Ok(()) => {
                normalise(&mut pairs);
                return Ok(pairs);
            }
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
fn almost(scene: &AnyScene<'_>, contacts: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let larger = with_scene!(scene, scene => {
        let wide = |centre| array(centre).map(Real::wide).to_vec();
        let points: Vec<Vec<f64>> = scene.centres().iter().map(wide).collect();
        let larger = |k| scene.radius(k).wide() * (1.0 + NEAR);
        grown(&points, (0..scene.len()).map(larger).collect())
    });
    let Some(Ok(mut pairs)) = larger.map(|larger| find(&larger)) else { return Vec::new() };
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

/// Reads a list of pairs: CSV of two columns of particle numbers, from 0, with or without a header
/// such as `i,j`; further columns are skipped.
pub fn read(path: &Path) -> anyhow::Result<Vec<[u32; 2]>> {
    let name = path.display();
    let file = std::fs::File::open(path).with_context(|| format!("cannot read {name}"))?;
    let (mut reader, mut pairs, mut line) = (BufReader::new(file), Vec::new(), String::new());
    for number in 1.. {
        line.clear();
        let mut most = std::io::Read::take(&mut reader, LONGEST_LINE as u64);
        if most.read_line(&mut line).with_context(|| {
            format!("cannot read {name}, line {number}; pairs are CSV with a header i,j")
        })? == 0
        {
            break;
        }
        ensure!(
            line.len() < LONGEST_LINE,
            "{name}:{number}: the line is longer than 1 MiB; pairs are CSV with a header i,j"
        );
        let text = line.trim();
        let mut cells = text
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|cell| !cell.is_empty());
        let pair =
            [cells.next(), cells.next()].map(|cell| cell.and_then(|cell| cell.parse::<u32>().ok()));
        match pair {
            _ if text.is_empty() || text.starts_with('#') => {}
            [Some(i), Some(j)] => pairs.push([i, j]),
            _ if pairs.is_empty()
                && !text.starts_with(|c: char| c.is_ascii_digit() || c == '-') => {}
            _ => bail!(
                "{name}:{number}: '{}' is no pair of particle numbers; write two whole numbers, as \
                 in 0,1",
                excerpt(text)
            ),
        }
    }
    Ok(pairs)
}

fn excerpt(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let pairs = Highlighted::compare(&scene, &[[2, 1], [1, 2], [3, 0], [0, 0]]).unwrap();
        assert_eq!(pairs.contacts, [[1, 2]]);
        assert_eq!(pairs.missed, [[0, 1]]);
        assert_eq!(pairs.near, [[2, 3]]);
        assert_eq!(pairs.spurious, [[0, 0], [0, 3]]);
        assert_eq!(pairs.duplicates, [[1, 2]]);
        let error = Highlighted::compare(&scene, &[[0, 4]]).unwrap_err().to_string();
        assert!(error.contains("the pair 0,4: the scene has 4 particles"), "{error}");
    }

    #[test]
    fn lists_are_read_or_refused_with_the_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.csv");
        for text in
            ["i,j\n0,1\n2,3\n", "0,1\n\n# more\n2,3,0.25", "0 1\n2\t3\n", "i;j\r\n0;1\r\n2;3\r\n"]
        {
            std::fs::write(&path, text).unwrap();
            assert_eq!(read(&path).unwrap(), [[0, 1], [2, 3]], "{text:?}");
        }
        for text in
            ["i,j\n0,1\n2,x\n", "i,j\n\n-1,2\n", "0,1\n2,3\n4294967296,1\n", "0,1\n0,2\n5\n"]
        {
            std::fs::write(&path, text).unwrap();
            let error = read(&path).unwrap_err().to_string();
            assert!(
                error.contains("pairs.csv:3: '") && error.contains("no pair of particle numbers"),
                "{error}"
            );
        }
        std::fs::write(&path, vec![b'7'; LONGEST_LINE + 5]).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("pairs.csv:1: the line is longer"));
    }
}
