//! A sweep spread over the jobs of an array: shard k of n takes a part of the scenes. All detectors
//! of a scene stay together, because their times are compared block by block.

use std::cmp::Reverse;
use std::fmt;
use std::str::FromStr;

/// Part `k` of `n`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    k: usize,
    n: usize,
}

impl Shard {
    /// Which of the scenes with these numbers of particles are in this shard: every scene is in
    /// one, and in the same one on every machine. They are dealt out from the largest to the
    /// smallest, forwards and backwards in turn, so that shards take about equally long.
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
        match numbers {
            Some((k, n)) if 1 <= k && k <= n => Ok(Shard { k, n }),
            _ => Err("a shard is k/n with 1 <= k <= n: of four jobs the first is 1/4 and the \
                      last 4/4"
                .into()),
        }
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
    fn a_shard_is_k_of_n() {
        assert_eq!("2/4".parse(), Ok(Shard { k: 2, n: 4 }));
        for bad in [
            "",
            "1",
            "0/4",
            "5/4",
            "0/0",
            "-1/4",
            "1/4/2",
            "a/b",
            "1.5/4",
            "1/99999999999999999999999",
        ] {
            assert!(bad.parse::<Shard>().is_err_and(|e| e.contains("1/4")), "{bad}");
        }
    }
}
