//! Peers: libraries that people use to find neighbours, as detectors, measured in the same run as
//! ours (cargo feature `peers`).
//!
//! A peer is used as its documentation recommends, in f64 and on one thread, as a *filter*: it is
//! asked for all pairs within [`reach`](crate::contact::Bodies::reach), and
//! [`touch`](crate::contact::Bodies::touch) decides, so that its answers are held to the same
//! truth. The clock is ours, too: from raw coordinates to the complete list of pairs, building the
//! library's structure included. What a library cannot be trusted with is refused, with the reason.
//!
//! Peers are not held to our rules about memory: they allocate as they please and declare no
//! formula.

#[cfg(feature = "peers")]
pub mod kd_tree;
#[cfg(feature = "peers")]
pub mod kiddo;
#[cfg(feature = "peers")]
pub mod parry;
#[cfg(feature = "peers")]
pub mod rstar;
#[cfg(feature = "peers")]
pub mod zelll;

#[cfg(feature = "peers")]
use super::Refusal;
#[cfg(feature = "peers")]
use crate::contact::Bodies;
#[cfg(feature = "peers")]
use crate::scene::Real;

/// What is known of a peer also where it is not compiled.
#[derive(Debug, PartialEq, Eq)]
pub struct Peer {
    /// The name in records, experiments and on the command line.
    pub name: &'static str,
    /// What it does, in a few words.
    pub summary: &'static str,
    /// Cost for N particles.
    pub cost: &'static str,
    /// What it refuses or does badly.
    pub limits: &'static str,
}

/// See [`kiddo`](https://docs.rs/kiddo).
pub const KIDDO: Peer = Peer {
    name: "kiddo",
    summary: "peer: k-d tree of the crate kiddo, one radius query per particle",
    cost: "N log N",
    limits: "refuses scenes where squares of distances overflow",
};

/// See [`kd-tree`](https://docs.rs/kd-tree).
pub const KD_TREE: Peer = Peer {
    name: "kd-tree-crate",
    summary: "peer: k-d tree of the crate kd-tree, one radius query per particle",
    cost: "N log N",
    limits: "a new list for every query; refuses scenes where squares of distances overflow",
};

/// See [`rstar`](https://docs.rs/rstar).
pub const RSTAR: Peer = Peer {
    name: "rstar",
    summary: "peer: R*-tree of the crate rstar, bulk-loaded, one radius query per particle",
    cost: "N log N",
    limits: "refuses scenes where squares of distances overflow",
};

/// See [`parry`](https://parry.rs).
pub const PARRY: Peer = Peer {
    name: "parry",
    summary: "peer: bounding volume hierarchy of the crate parry, traversed against itself",
    cost: "N log N",
    limits: "refuses scenes where squares of distances overflow",
};

/// See [`zelll`](https://docs.rs/zelll).
pub const ZELLL: Peer = Peer {
    name: "zelll",
    summary: "peer: hashed cells of the crate zelll",
    cost: "N",
    limits: "32-bit cell numbers: cells grow with the domain, and with them the time",
};

/// All peers.
pub const PEERS: [&Peer; 5] = [&KIDDO, &KD_TREE, &RSTAR, &PARRY, &ZELLL];

/// Why a peer cannot be run, if it is one that this program was built without.
pub fn missing(name: &str) -> Option<String> {
    let absent = !cfg!(feature = "peers") && PEERS.iter().any(|peer| peer.name == name);
    absent.then(|| {
        format!(
            "this program was built without the library behind {name}; run it with `cargo run \
             --release --features peers -- ...`"
        )
    })
}

/// The centres of all particles, in a buffer that is kept.
#[cfg(feature = "peers")]
fn positions<T: Real, const D: usize>(bodies: &impl Bodies<T, D>, points: &mut Vec<[f64; D]>) {
    points.clear();
    points.extend((0..bodies.len() as u32).map(|i| bodies.position(i)));
}

/// The box around points; one point at the origin if there are none.
#[cfg(feature = "peers")]
fn bounds<const D: usize>(points: &[[f64; D]]) -> [[f64; D]; 2] {
    let first = points.first().copied().unwrap_or([0.0; D]);
    points.iter().fold([first; 2], |[low, high], p| {
        [std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k]))]
    })
}

/// The square of the distance to search, for libraries that prune and decide by squares: no pair
/// that `touch` accepts is farther apart as they compute it.
///
/// A square computed in one go is off by 6u (see [`crate::filter`], section 5); trees that update
/// the distance to a box at every level may be off by some u for each. 2^-40 covers thousands of
/// levels and costs nothing; the term beside it covers underflow. Where squares overflow, trees may
/// compute infinity less infinity, and the scene is refused.
#[cfg(feature = "peers")]
fn squared_reach<T: Real, const D: usize>(
    detector: &'static str,
    bodies: &impl Bodies<T, D>,
    points: &[[f64; D]],
) -> Result<f64, Refusal> {
    const PART: f64 = 1.0 / (1u64 << 40) as f64;
    // 2^-960, by its bits.
    let least = f64::from_bits((1023 - 960) << 52);
    let [low, high] = bounds(points);
    let farthest: f64 = (0..D).map(|k| (high[k] - low[k]) * (high[k] - low[k])).sum();
    let square = bodies.reach() * bodies.reach() * (1.0 + PART) + least;
    if (farthest + square) * 16.0 < f64::INFINITY {
        return Ok(square);
    }
    let reason = "squares of distances in this scene overflow; scale it down, or use direct".into();
    Err(Refusal::Library { detector, reason })
}
