//! Shards: shard k of n runs a part of the scenes of an experiment. All detectors of a scene stay
//! together, because their times are paired by block.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

/// Shard `k` of `n`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    k: usize,
    n: usize,
}

impl Shard {
    pub fn file_name(self) -> String {
        format!("{}-of-{}", self.k, self.n)
    }

    /// Whether each scene belongs to this shard, given the scenes' numbers of particles. Scenes are
    /// dealt from the largest to the smallest, alternately forwards and backwards, so that shards
    /// take about equally long. The result is the same on every machine.
    pub fn takes(self, sizes: &[u64]) -> Vec<bool> {
        let mut largest_first: Vec<usize> = (0..sizes.len()).collect();
        largest_first.sort_by_key(|&scene| Reverse(sizes[scene]));
        let mut taken = vec![false; sizes.len()];
        for (turn, scene) in largest_first.into_iter().enumerate() {
            let (round, place) = (turn / self.n, turn % self.n);
            let dealt = if round.is_multiple_of(2) { place } else { self.n - 1 - place };
            taken[scene] = dealt + 1 == self.k;
        }
        taken
    }

    /// Returns the number of missing shards and the first of them; `None` if none is missing, or if
    /// the present shards differ in `n`.
    pub fn missing(present: &BTreeSet<Shard>) -> Option<(usize, Shard)> {
        let n = present.first()?.n;
        let alike = present.iter().all(|shard| shard.n == n);
        let first = (1..=n).map(|k| Shard { k, n }).find(|shard| !present.contains(shard))?;
        alike.then_some((n - present.len(), first))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.k, self.n)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let numbers = text
            .split_once('/')
            .and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
        let shard = numbers.filter(|(k, n)| (1..=*n).contains(k)).map(|(k, n)| Shard { k, n });
        shard.ok_or_else(|| "give k/n with 1 <= k <= n, as in 1/4 for the first of 4 jobs".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_in_one_shard_and_large_ones_are_spread() {
        let sizes = [100, 1000, 10_000, 100, 1000, 10_000, 100, 1000, 10_000, 0];
        for n in 1..=12 {
            let shards: Vec<Vec<bool>> = (1..=n).map(|k| Shard { k, n }.takes(&sizes)).collect();
            for scene in 0..sizes.len() {
                assert_eq!(
                    shards.iter().filter(|taken| taken[scene]).count(),
                    1,
                    "{n} shards, scene {scene}"
                );
            }
        }
        let work = |k| -> u64 {
            Shard { k, n: 3 }
                .takes(&sizes)
                .iter()
                .zip(sizes)
                .filter(|(taken, _)| **taken)
                .map(|(_, n)| n)
                .sum()
        };
        assert_eq!([1, 2, 3].map(work), [11_100, 11_100, 11_100]);
    }

    #[test]
    fn parts_that_are_not_there_are_known() {
        let missing = |present: &[&str]| {
            let present = present.iter().map(|text| text.parse().unwrap()).collect();
            Shard::missing(&present).map(|(count, first)| (count, first.to_string()))
        };
        assert_eq!(missing(&["4/5", "1/5", "3/5"]), Some((2, "2/5".into())));
        assert_eq!(missing(&["1/99999999999"]), Some((99_999_999_998, "2/99999999999".into())));
        for complete in [&[][..], &["1/1"], &["2/2", "1/2"], &["1/3", "1/2"]] {
            assert_eq!(missing(complete), None);
        }
    }
}
