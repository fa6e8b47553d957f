//! The protocol: requests and replies, one JSON object a line.

use std::io::{self, BufRead, Write};
use std::time::Instant;

use serde::Deserialize;
use serde_json::{Value, json};

use crate::scene::{self, Scene};

/// A library that finds pairs of points in `D` dimensions.
pub trait Library<const D: usize> {
    /// Calls `near` once for each pair of particles that may touch. A refusal is one sentence.
    fn pairs(scene: &Scene<D>, near: impl FnMut(u32, u32)) -> Result<(), String>;
}

#[derive(Deserialize)]
#[serde(tag = "request", rename_all = "lowercase")]
enum Request {
    Load {
        frames: Vec<String>,
        dim: usize,
        n: usize,
        radius: Option<f64>,
        #[serde(rename = "box")]
        one_box: Option<Value>,
        boxes: Option<Value>,
    },
    Count,
    Memory,
    Sample {
        min_ns: u64,
    },
    Pairs {
        path: String,
    },
    Quit,
}

enum Loaded {
    Plane(Scene<2>),
    Space(Scene<3>),
}

/// A loaded scene with the buffer of its pairs.
struct Session {
    scene: Loaded,
    pairs: Vec<[u32; 2]>,
    /// Detections of a sample, once they are calibrated.
    calls: Option<u64>,
}

enum Failure {
    Refused(String),
    Error(String),
}

pub fn unavailable(reason: &str) -> io::Result<()> {
    writeln!(io::stdout(), "{}", json!({"reply": "unavailable", "reason": reason}))
}

/// Answers requests until `quit`.
pub fn serve<L: Library<2> + Library<3>>(name: &str, package: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let lock = include_str!("../Cargo.lock");
    let version = lock.split_once(&format!("name = \"{package}\"\nversion = \""));
    let version = version.and_then(|(_, rest)| rest.split('"').next());
    let level = match () {
        () if cfg!(target_feature = "avx512f") => "avx512",
        () if cfg!(target_feature = "avx2") => "avx2",
        () => "portable",
    };
    let simd = if cfg!(feature = "simd") { "intrinsics" } else { "none" };
    let build = json!({"level": level, "simd": simd});
    let hello = json!({"reply": "hello", "protocol": 4, "detector": name, "arithmetic": "exact",
        "version": version, "build": build, "at_rest": true});
    writeln!(out, "{hello}")?;
    out.flush()?;
    let mut session = None;
    for line in io::stdin().lock().lines() {
        let request = serde_json::from_str(&line?);
        if matches!(request, Ok(Request::Quit)) {
            break;
        }
        let reply = request
            .map_err(|error| Failure::Error(format!("this is not a request: {error}")))
            .and_then(|request| answer::<L>(&mut session, request));
        let reply = reply.unwrap_or_else(|failure| match failure {
            Failure::Refused(reason) => json!({"reply": "refused", "reason": reason}),
            Failure::Error(reason) => json!({"reply": "error", "reason": reason}),
        });
        writeln!(out, "{reply}")?;
        out.flush()?;
    }
    Ok(())
}

fn answer<L: Library<2> + Library<3>>(
    session: &mut Option<Session>,
    request: Request,
) -> Result<Value, Failure> {
    if let Request::Load { frames, dim, n, radius, one_box, boxes } = request {
        *session = None;
        if frames.len() != 1 || one_box.is_some() || boxes.is_some() {
            let reason = "this runner supports scenes at rest in open space only";
            return Err(Failure::Refused(reason.into()));
        }
        let count = n.saturating_mul(dim + usize::from(radius.is_none()));
        let rows = scene::numbers(&frames[0], count).map_err(Failure::Error)?;
        let scene = match dim {
            2 => Scene::new(&rows, radius).map(Loaded::Plane),
            _ => Scene::new(&rows, radius).map(Loaded::Space),
        };
        let scene = scene.map_err(Failure::Refused)?;
        *session = Some(Session { scene, pairs: Vec::new(), calls: None });
        return Ok(json!({"reply": "loaded"}));
    }
    let Some(session) = session else {
        return Err(Failure::Error("no scene is loaded; send load first".into()));
    };
    match request {
        Request::Sample { min_ns } => session.sample::<L>(min_ns).map_err(Failure::Refused),
        Request::Pairs { path } => {
            session.timed::<L>(1).map_err(Failure::Refused)?;
            scene::write(&path, &session.pairs).map_err(Failure::Error)?;
            Ok(json!({"reply": "pairs", "contacts": session.pairs.len()}))
        }
        Request::Count | Request::Memory | Request::Load { .. } | Request::Quit => {
            Ok(json!({"reply": "unsupported"}))
        }
    }
}

impl Session {
    /// Returns the nanoseconds of this many detections.
    fn timed<L: Library<2> + Library<3>>(&mut self, calls: u64) -> Result<u64, String> {
        let start = Instant::now();
        for _ in 0..calls {
            self.pairs.clear();
            match &self.scene {
                Loaded::Plane(scene) => detect::<L, 2>(scene, &mut self.pairs)?,
                Loaded::Space(scene) => detect::<L, 3>(scene, &mut self.pairs)?,
            }
        }
        Ok((start.elapsed().as_nanos() as u64).max(1))
    }

    fn sample<L: Library<2> + Library<3>>(&mut self, min_ns: u64) -> Result<Value, String> {
        let first = self.timed::<L>(1)?;
        let fresh = self.calls.is_none();
        let mut calls = self.calls.unwrap_or(1);
        let mut elapsed = self.timed::<L>(calls)?;
        // The first sample finds the number of detections; an eighth is added for noise.
        while fresh && elapsed < min_ns {
            let wanted = u128::from(min_ns) * u128::from(calls) * 9 / 8 / u128::from(elapsed);
            calls = (wanted as u64).clamp(calls + 1, calls.saturating_mul(10));
            elapsed = self.timed::<L>(calls)?;
        }
        self.calls = Some(calls);
        let time = (elapsed + calls / 2) / calls;
        Ok(json!({"reply": "sample", "time_ns": time, "calls": calls, "elapsed_ns": elapsed,
            "step_ns": [time], "first_ns": first, "contacts": self.pairs.len(),
            "digest": format!("{:#018x}", digest(&self.pairs))}))
    }
}

fn detect<L: Library<D>, const D: usize>(
    scene: &Scene<D>,
    pairs: &mut Vec<[u32; 2]>,
) -> Result<(), String> {
    // Some libraries fail without particles.
    if scene.centres.is_empty() {
        return Ok(());
    }
    L::pairs(scene, |i, j| {
        if scene.touch(i, j) {
            pairs.push([i, j]);
        }
    })
}

fn digest(pairs: &[[u32; 2]]) -> u64 {
    let mix = |&[i, j]: &[u32; 2]| {
        let z = (u64::from(i.min(j)) << 32 | u64::from(i.max(j))).wrapping_add(0x9e3779b97f4a7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        z ^ (z >> 31)
    };
    pairs.iter().map(mix).fold(0, u64::wrapping_add)
}

#[cfg(test)]
mod tests {
    use super::digest;

    #[test]
    fn digests_are_those_of_the_protocol() {
        assert_eq!(digest(&[]), 0);
        assert_eq!(digest(&[[2, 1], [0, 1]]), 0x447a68c51d52cce3);
        assert_eq!(digest(&[[0, 1], [0, 1]]), 0x22145bd91204b982);
        assert_eq!(digest(&[[3, 70000]]), 0xc6c81c857eb9259a);
    }
}
