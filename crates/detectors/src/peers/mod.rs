//! Peers: neighbour search libraries that people use, wrapped as detectors and measured in the same
//! run (cargo feature `peers`).
//!
//! A peer is used as its documentation recommends, in f64 and on one thread, as a *filter*. It
//! finds all pairs within [`reach`](contactbench_ground::contact::Bodies::reach), and
//! [`touch`](contactbench_ground::contact::Bodies::touch) decides, so its result must equal the same truth. The
//! time covers the same work as for other detectors, from raw coordinates to the complete list of
//! pairs. It includes the construction of the library's structure. Scenes that a library cannot
//! handle are refused with the reason.
//!
//! Peers need not follow this project's rules about memory: they allocate freely and have no
//! formula.

#[cfg(feature = "peers")]
pub mod kd_tree;
#[cfg(feature = "peers")]
pub mod kiddo;
#[cfg(feature = "peers")]
pub mod library;
#[cfg(feature = "peers")]
pub mod parry;
#[cfg(feature = "peers")]
pub mod rstar;
#[cfg(feature = "peers")]
pub mod zelll;

/// Description of a peer, available even if the peer is not compiled in.
#[derive(Debug, PartialEq, Eq)]
pub struct Peer {
    /// Name in records, experiments and on the command line.
    pub name: &'static str,
    /// The algorithm in a few words.
    pub summary: &'static str,
    /// Growth of the run time with N, the number of particles.
    pub cost: &'static str,
    /// Scenes that the peer refuses or is slow on.
    pub limits: &'static str,
}

/// The crate [`kiddo`](https://docs.rs/kiddo).
pub const KIDDO: Peer = Peer {
    name: "kiddo",
    summary: "peer: k-d tree of the crate kiddo, one radius query per particle",
    cost: "N log N",
    limits: "refuses scenes where squares of distances overflow",
};

/// The crate [`kd-tree`](https://docs.rs/kd-tree).
pub const KD_TREE: Peer = Peer {
    name: "kd-tree-crate",
    summary: "peer: k-d tree of the crate kd-tree, one radius query per particle",
    cost: "N log N",
    limits: "a new list for every query; refuses scenes where squares of distances overflow",
};

/// The crate [`rstar`](https://docs.rs/rstar).
pub const RSTAR: Peer = Peer {
    name: "rstar",
    summary: "peer: R*-tree of the crate rstar, bulk-loaded, one radius query per particle",
    cost: "N log N",
    limits: "refuses scenes where squares of distances overflow",
};

/// The crates of [`parry`](https://parry.rs).
pub const PARRY: Peer = Peer {
    name: "parry",
    summary: "peer: bounding volume hierarchy of the crate parry, traversed against itself",
    cost: "N log N",
    limits: "refuses scenes where squares of distances overflow",
};

/// The crate [`zelll`](https://docs.rs/zelll).
pub const ZELLL: Peer = Peer {
    name: "zelll",
    summary: "peer: hashed cells of the crate zelll",
    cost: "N",
    limits: "32-bit cell numbers: cells grow with the domain, and with them the time",
};

/// All peers.
pub const PEERS: [&Peer; 5] = [&KIDDO, &KD_TREE, &RSTAR, &PARRY, &ZELLL];

/// Returns why this peer cannot run, or `None` unless `name` is a peer that was not compiled in.
pub fn missing(name: &str) -> Option<String> {
    let absent = !cfg!(feature = "peers") && PEERS.iter().any(|peer| peer.name == name);
    absent.then(|| {
        format!(
            "this program was built without the library behind {name}; run it with `cargo run \
             --release --features peers -- ...`"
        )
    })
}
