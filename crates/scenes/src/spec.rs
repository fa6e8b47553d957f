//! A description of a scene: generator, parameters, number of particles, seed and order.

use std::collections::BTreeMap;

use anyhow::{Context, anyhow, ensure};
use serde_json::Value;

pub use crate::generate::table::{GENERATORS, Generator, Parameter, ParameterKind};
use crate::generate::{Inputs, file, hard, table};
use crate::motion::{self, Frames, Motion};
use crate::neighbours::{NEIGHBOURS, scaled};
pub use crate::order::Order;
use crate::order::{morton, shuffled};
use contactbench_ground::scene::AnyScene;
use contactbench_io::Given;
use contactbench_terms::grammar;

#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    pub name: String,
    /// Dimension, 2 or 3. Unused for a file, which has its own dimension.
    pub dim: u32,
    /// Number of particles; 0 if the generator decides ([`Generator::own_n`]) and has not run yet.
    pub n: u64,
    pub seed: u64,
    pub order: Order,
    /// All parameters with the values used, including defaults.
    pub params: BTreeMap<String, Value>,
    pub trajectory: Option<Trajectory>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trajectory {
    pub motion: Motion,
    /// Number of frames, including the scene itself.
    pub frames: u64,
}

impl Trajectory {
    /// Removes `motion`, `speed`, `motion-seed` and `frames` from the parameters of a scene and
    /// parses them. Without `motion` it returns `None` and keeps the other parameters.
    pub fn take(params: &mut BTreeMap<String, toml::Value>) -> anyhow::Result<Option<Trajectory>> {
        let Some(kind) = params.remove("motion") else { return Ok(None) };
        let bare = |value: &toml::Value| match value {
            toml::Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        let mut text = bare(&kind);
        ensure!(
            !text.contains(':'),
            "motion = \"{text}\": give speed and motion-seed as separate parameters"
        );
        for (name, key, mark) in [("speed", "speed", ':'), ("motion-seed", "seed", ',')] {
            if let Some(value) = params.remove(name) {
                let mark = if text.contains(':') { mark } else { ':' };
                text += &format!("{mark}{key}={}", bare(&value));
            }
        }
        let motion = text.parse()?;
        let frames = params.remove("frames").map_or(Ok(FRAMES), |frames| {
            let whole = frames.as_integer().and_then(|frames| u64::try_from(frames).ok());
            whole.filter(|frames| (2..=MOST_FRAMES).contains(frames)).with_context(|| {
                format!("frames = {frames}: it must be a whole number from 2 to {MOST_FRAMES}")
            })
        })?;
        Ok(Some(Trajectory { motion, frames }))
    }

    fn axes(&self) -> impl Iterator<Item = (String, Value)> {
        let Motion { kind, speed, seed } = self.motion;
        let moves = kind != motion::MotionKind::Rest;
        let axes: [(&str, Value, bool); 4] = [
            ("motion", kind.name().into(), true),
            ("frames", self.frames.into(), true),
            ("speed", speed.into(), moves),
            // Only a seed other than the default is recorded.
            ("motion-seed", seed.into(), moves && seed != motion::SEED),
        ];
        let said = axes.into_iter().filter(|(.., said)| *said);
        said.map(|(name, value, _)| (name.to_string(), value))
    }
}

const FRAMES: u64 = 100;
/// Maximum number of frames. A measurement writes each frame to a file, and the runner's reply, one
/// line of at most 1 MiB, has about 60 bytes per frame.
const MOST_FRAMES: u64 = 10_000;

impl Spec {
    pub fn new(
        name: &str,
        dim: u32,
        n: u64,
        seed: u64,
        order: Order,
        params: &BTreeMap<String, toml::Value>,
    ) -> anyhow::Result<Spec> {
        let params: BTreeMap<String, Value> =
            params.iter().map(|(name, value)| (name.clone(), json(value))).collect();
        let params = table::find(name)?.check(dim, n, &params)?;
        Ok(Spec { name: name.to_string(), dim, n, seed, order, params, trajectory: None })
    }

    /// Returns all parameters, including those of the motion.
    pub fn axes(&self) -> BTreeMap<String, Value> {
        let trajectory = self.trajectory.iter().flat_map(Trajectory::axes);
        self.params.clone().into_iter().chain(trajectory).collect()
    }

    /// Parses a scene as named on the command line:
    /// `packed:dim=3,n=1000,seed=2,order=morton,spacing=0.98`.
    ///
    /// The keys are `dim` (default 2), `n` (1000), `seed` (1), `order` (shuffled) and the
    /// generator's parameters. Text after a comma that holds no `=` belongs to the value before it,
    /// so that a path may hold commas. For `file`, `dim` sets the parameter `file-dim`; `file` and
    /// `hard` decide n themselves.
    pub fn parse(text: &str) -> anyhow::Result<Spec> {
        let given = grammar::Spec::parse(text);
        given.form("write it as in packed:dim=3,n=1000,spacing=0.98")?;
        let name = given.name;
        let is_file = name == file::NAME;
        let generator = table::find(name).ok();
        let own_n = generator.is_some_and(|generator| generator.own_n);
        let mut dim = 2;
        let mut n = if own_n { 0 } else { 1000 };
        let mut seed = 1;
        let mut order = Order::default();
        let mut params = BTreeMap::new();
        for (key, value) in &given.params {
            let whole = || {
                contactbench_terms::number::whole(value).with_context(|| {
                    format!("'{text}': {key} is '{value}'; it must be a whole number")
                })
            };
            match *key {
                "dim" if !is_file => dim = u32::try_from(whole()?).unwrap_or(u32::MAX),
                "n" => n = whole()?,
                "seed" => seed = whole()?,
                "order" => {
                    order = value.parse().map_err(|words| anyhow!("'{text}': {words}"))?;
                }
                _ => {
                    let key = if *key == "dim" { "file-dim" } else { key };
                    let is_text = generator.is_some_and(|generator| generator.is_text(key));
                    params.insert(key.to_string(), scalar(is_text, value));
                }
            }
        }
        Spec::new(name, dim, n, seed, order, &params)
    }

    /// Makes the scene; fails if it is periodic.
    pub fn make(&self) -> anyhow::Result<AnyScene<'static>> {
        self.given()?.open(&self.name)
    }

    /// Makes the scene with its periodic box, if it has one.
    pub fn given(&self) -> anyhow::Result<Given> {
        let given = self.by(|generator, inputs| {
            let given = (generator.make)(inputs)?;
            let wanted = inputs.params.get(NEIGHBOURS.name).and_then(Value::as_f64);
            if let Some(wanted) = wanted { scaled(given, wanted) } else { Ok(given) }
        })?;
        Ok(self.ordered(given))
    }

    /// Prepares the frames of a motion and returns them with their number, or `None` for a scene
    /// without motion. `given` must be the result of [`Spec::given`].
    pub fn frames(&self, given: &Given) -> anyhow::Result<Option<(Frames, u64)>> {
        let Some(Trajectory { motion, frames }) = self.trajectory else { return Ok(None) };
        let made = Frames::new(given, motion)
            .with_context(|| format!("cannot move the scene '{}'", self.name))?;
        Ok(Some((made, frames)))
    }

    /// Makes the scenes that a detector must see before the one of [`Spec::make`], in order. Only
    /// hard cases of several steps have any. A detector may refuse them.
    pub fn history(&self) -> anyhow::Result<Vec<Given>> {
        if self.name != hard::NAME {
            return Ok(Vec::new());
        }
        let mut steps = self.by(|_, inputs| hard::steps(inputs))?;
        steps.pop();
        Ok(steps.into_iter().map(|given| self.ordered(given)).collect())
    }

    fn by<O>(
        &self,
        then: impl FnOnce(&Generator, &Inputs<'_>) -> anyhow::Result<O>,
    ) -> anyhow::Result<O> {
        // The fields are public, so they may have changed since `new` checked them.
        let generator = table::find(&self.name)?;
        let params = generator.check(self.dim, self.n, &self.params)?;
        let inputs = Inputs { dim: self.dim, n: self.n, seed: self.seed, params: &params };
        then(generator, &inputs).with_context(|| format!("cannot make the scene '{}'", self.name))
    }

    fn ordered(&self, given: Given) -> Given {
        let scene = &given.scene;
        let order = match self.order {
            Order::Generated => return given,
            Order::Shuffled => shuffled(scene.len(), self.seed),
            Order::Morton => morton(scene),
        };
        Given { scene: scene.reordered(&order), ..given }
    }
}

/// JSON has no NaN or infinity; they become text, which the check of parameters refuses.
fn json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Integer(k) => (*k).into(),
        toml::Value::Float(x) if x.is_finite() => (*x).into(),
        toml::Value::Boolean(yes) => (*yes).into(),
        toml::Value::String(text) => text.as_str().into(),
        other => other.to_string().into(),
    }
}

/// Converts a value of the command line to text, a whole number or a floating-point number.
fn scalar(is_text: bool, value: &str) -> toml::Value {
    if is_text {
        value.into()
    } else if let Ok(whole) = value.parse::<i64>() {
        whole.into()
    } else if let Ok(number) = value.parse::<f64>() {
        number.into()
    } else {
        value.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_sets_every_value() {
        let spec = Spec::parse("packed:dim=3,n=27,seed=2,order=morton,spacing=1").unwrap();
        let Spec { name, dim, n, seed, order, params, .. } = spec;
        assert_eq!((&*name, dim, n, seed, order), ("packed", 3, 27, 2, Order::Morton));
        assert_eq!(
            serde_json::to_string(&params).unwrap(),
            "{\"diameter\":1.0,\"jitter\":0.05,\"lattice\":\"fcc\",\"offset\":0.0,\
             \"size-ratio\":1.0,\"spacing\":1.0}"
        );
        assert!(Spec::parse("file:path=a,b=1.csv,dim=2").is_err(), "b=1.csv is a parameter");
        assert!(Spec::parse("loose:periodic=true").unwrap().make().is_err(), "a box is no scene");
        let Spec { n, params, .. } = Spec::parse("file:path=a,b.csv,dim=2").unwrap();
        assert_eq!((n, &params["path"], &params["file-dim"]), (0, &"a,b.csv".into(), &2.into()));
        assert_eq!(Spec::parse("loose").unwrap().n, 1000);
        for (text, axes) in [("true", "xy"), ("xy", "xy"), ("y", "y"), ("false", "none")] {
            let spec = Spec::parse(&format!("packed:periodic={text}")).unwrap();
            assert_eq!(spec.params["periodic"], axes);
        }
        let exponents = Spec::parse("clustered:n=1e3,seed=2e0,per-cluster=1e1").unwrap();
        assert_eq!(exponents, Spec::parse("clustered:n=1000,seed=2,per-cluster=10").unwrap());
    }
}
