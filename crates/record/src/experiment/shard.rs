//! Shards: shard k of n runs a part of the scenes of an experiment. All detectors of a scene stay
//! together, because their times are paired by block.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

use contactbench_terms::must;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub shard: Shard,
    /// Whether the shard was given as `auto`, so that all processes have the same command line.
    pub told: bool,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Part, String> {
        Ok(Part { shard: text.parse()?, told: text.starts_with("auto") })
    }
}

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

    /// Finds the shard of this process by the environment variables of a job array, an MPI job or
    /// both. If there are both, the ranks of each job divide its part. `of` is the length of the
    /// array if no variable gives it, as with PBS.
    fn of_environment(
        of: Option<usize>,
        variable: &dyn Fn(&str) -> Option<String>,
    ) -> Result<Shard, String> {
        let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
        // LSF sets index 0 for a job outside of an array, and counts array jobs from 1.
        let lone = |name: &str, index| name == "LSB_JOBINDEX" && index == 0;
        let index = |array: Array| number(array[0]).filter(|&index| !lone(array[0], index));
        let job = ARRAYS.into_iter().find_map(|array| Some((array, index(array)?)));
        let rank = rank_of(variable);
        let job = job.map(|(array, index)| in_array(array, index, of, &number)).transpose()?;
        let (job, (rank, size)) = match (job, rank) {
            (None, None) => return Err(NO_JOB.into()),
            (job, rank) => (job.unwrap_or(Shard { k: 1, n: 1 }), rank.unwrap_or((0, 1))),
        };
        let n = job.n.checked_mul(size).filter(|_| rank < size);
        let shard = n.map(|n| Shard { k: (job.k - 1) * size + rank + 1, n });
        shard.ok_or_else(|| format!("rank {rank} of {size} is not valid; give --shard k/n"))
    }
}

/// Environment variables of a job array: index, first index, last index, step and number of
/// indices. The name is empty if the scheduler does not set that variable.
type Array = [&'static str; 5];

/// Slurm, PBS Pro, Torque, Grid Engine, LSF. Indices begin at 1 unless a variable holds the first.
const ARRAYS: [Array; 5] = [
    [
        "SLURM_ARRAY_TASK_ID",
        "SLURM_ARRAY_TASK_MIN",
        "SLURM_ARRAY_TASK_MAX",
        "SLURM_ARRAY_TASK_STEP",
        "SLURM_ARRAY_TASK_COUNT",
    ],
    ["PBS_ARRAY_INDEX", "", "", "", ""],
    ["PBS_ARRAYID", "", "", "", ""],
    ["SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_LAST", "SGE_TASK_STEPSIZE", ""],
    ["LSB_JOBINDEX", "", "", "LSB_JOBINDEX_STEP", "LSB_JOBINDEX_END"],
];

const RANKS: [[&str; 2]; 3] = [
    ["OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"],
    ["PMI_RANK", "PMI_SIZE"],
    ["SLURM_PROCID", "SLURM_STEP_NUM_TASKS"],
];

pub fn rank() -> Option<(usize, usize)> {
    rank_of(&|name| std::env::var(name).ok())
}

fn rank_of(variable: &dyn Fn(&str) -> Option<String>) -> Option<(usize, usize)> {
    let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
    RANKS.iter().find_map(|[rank, size]| Some((number(rank)?, number(size)?)))
}

const NO_JOB: &str = "there is neither a job array (Slurm, PBS, Grid Engine, LSF) nor an MPI job \
                      here; give --shard k/n";

fn in_array(
    [name, first, last, step, count]: Array,
    index: usize,
    of: Option<usize>,
    number: &dyn Fn(&str) -> Option<usize>,
) -> Result<Shard, String> {
    let range = number(first).zip(number(last));
    let (step, count) = (number(step).unwrap_or(1).max(1), number(count));
    let length = range.map(|(first, last)| last.saturating_sub(first) / step + 1);
    let (first, known) = (range.map_or(1, |(first, _)| first), length.or(count));
    let spaced = range.is_some() || step == 1;
    must!(spaced, "the indices of the job array are {step} apart; give --shard k/n");
    let even = length.is_none_or(|length| count.is_none_or(|count| count == length));
    must!(even, "the indices of the job array are not evenly spaced; give --shard k/n");
    if let Some((of, jobs)) = of.zip(known) {
        must!(of == jobs, "auto/{of} was given to {jobs} jobs; give --shard auto or k/{of}");
    }
    let n = of.or(known).ok_or_else(|| {
        format!("{name}={index} does not give the length of the job array; give --shard auto/n")
    })?;
    let k = index.checked_sub(first).map(|k| k / step + 1).filter(|&k| k <= n);
    k.map(|k| Shard { k, n }).ok_or_else(|| {
        format!("{name}={index} is not one of {n} indices from {first} on; give --shard k/n")
    })
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.k, self.n)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        if let Some(of) = text.strip_prefix("auto") {
            let of = match of.strip_prefix('/').map(|n| n.parse()) {
                None if of.is_empty() => None,
                Some(Ok(n @ 1..)) => Some(n),
                _ => return Err(format!("'{text}' is neither auto nor auto/n with n >= 1")),
            };
            return Shard::of_environment(of, &|name| std::env::var(name).ok());
        }
        let numbers = text
            .split_once('/')
            .and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
        match numbers {
            Some((k, n)) if 1 <= k && k <= n => Ok(Shard { k, n }),
            _ => Err("give k/n with 1 <= k <= n, as in 1/4 for the first of 4 jobs, or auto in a \
                      job array or under MPI"
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

    #[test]
    fn a_job_knows_its_part() {
        type Variables<'a> = &'a [(&'a str, &'a str)];
        let of = |of: Option<usize>, variables: Variables<'_>| {
            let found = |name: &str| {
                let found = variables.iter().find(|(known, _)| *known == name);
                found.map(|(_, value)| value.to_string())
            };
            Shard::of_environment(of, &found).map_or_else(|error| error, |it| it.to_string())
        };
        let slurm = |id, [min, max, step, count]: [&'static str; 4]| {
            let names = ARRAYS[0];
            [(names[0], id), (names[1], min), (names[2], max), (names[3], step), (names[4], count)]
        };
        let sge = [("SGE_TASK_ID", "4"), ("SGE_TASK_FIRST", "2"), ("SGE_TASK_LAST", "6")];
        let lsf = [("LSB_JOBINDEX", "2"), ("LSB_JOBINDEX_END", "6")];
        let mpi = [("OMPI_COMM_WORLD_RANK", "2"), ("OMPI_COMM_WORLD_SIZE", "4")];
        let pbs = [("PBS_ARRAY_INDEX", "5")];
        for (n, variables, words) in [
            (None, &slurm("3", ["1", "8", "1", "8"])[..], "3/8"),
            (None, &slurm("0", ["0", "7", "1", "8"]), "1/8"),
            (None, &slurm("14", ["2", "20", "4", "5"]), "4/5"),
            (None, &slurm("3", ["1", "9", "1", "3"]), "not evenly spaced"),
            // A lost job of an array, submitted again alone.
            (Some(16), &slurm("5", ["5", "5", "1", "1"]), "k/16"),
            // PBS does not set the number of jobs.
            (Some(8), &pbs, "5/8"),
            (None, &pbs, "auto/n"),
            (Some(4), &pbs, "from 1 on"),
            (Some(4), &[("PBS_ARRAYID", "0")], "from 1 on"),
            (None, &sge, "3/5"),
            (None, &lsf, "2/6"),
            (None, &[&lsf[..], &[("LSB_JOBINDEX_STEP", "2")]].concat(), "2 apart"),
            (None, &[("LSB_JOBINDEX", "0")], "neither a job array"),
            // Ranks count from 0, and divide the part of their job.
            (None, &mpi, "3/4"),
            (None, &[&slurm("2", ["1", "3", "1", "3"])[..], &mpi].concat(), "7/12"),
            (None, &[("PMI_RANK", "0"), ("PMI_SIZE", "2")], "1/2"),
            (None, &[("PMI_RANK", "3"), ("PMI_SIZE", "2")], "rank 3 of 2 is not valid"),
            // A batch script is not a job step: its process is alone.
            (None, &[("SLURM_PROCID", "0"), ("SLURM_NTASKS", "8")], "neither a job array"),
            (None, &[("SLURM_PROCID", "7"), ("SLURM_STEP_NUM_TASKS", "8")], "8/8"),
        ] {
            assert!(of(n, variables).contains(words), "{variables:?}: {}", of(n, variables));
        }
    }
}
