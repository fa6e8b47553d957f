//! What a scene is asked to be: the generator, its parameters, the number of elements, the seed and the order.

use std::collections::BTreeMap;

use anyhow::{Context, bail, ensure};
use rand::seq::SliceRandom;
use serde_json::Value;

use super::AnyScene;
use super::generate::draw::shuffler;
use super::generate::{Inputs, file, table};
use crate::contact::{Real, array};
use crate::with_scene;

pub use super::generate::table::{GENERATORS, Generator, Kind, Parameter, Preset};

/// The order of the elements in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// A seeded random permutation.
    #[default]
    Shuffled,
    /// As the generator makes them, or as they stand in the file.
    Generated,
    /// Along a Morton curve.
    Morton,
}

/// A scene to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// The generator's name.
    pub name: String,
    /// 2 or 3. A file decides its own: ask the scene made.
    pub dim: u32,
    /// Elements; 0 where the generator decides ([`Generator::own_n`]) and was not asked yet.
    pub n: u64,
    /// Seed of the generator and of the shuffle.
    pub seed: u64,
    /// Order of the elements.
    pub order: Order,
    /// All parameters with the values used, defaults included.
    pub params: BTreeMap<String, Value>,
}

impl Spec {
    /// Checks the parameters and fills in the defaults.
    pub fn new(name: &str, dim: u32, n: u64, seed: u64, order: Order, params: &BTreeMap<String, toml::Value>) -> anyhow::Result<Spec> {
        let params: BTreeMap<String, Value> = params.iter().map(|(name, value)| (name.clone(), json(value))).collect();
        let params = table::find(name)?.check(dim, n, &params)?;
        Ok(Spec { name: name.to_string(), dim, n, seed, order, params })
    }

    /// A scene as named on the command line: `packed:dim=3,n=1000,seed=2,order=morton,spacing=0.98`.
    ///
    /// The keys are `dim` (2), `n` (1000), `seed` (1), `order` (shuffled) and the generator's parameters. A piece without `=` belongs
    /// to the value before it, so that a path may hold commas. For `file`, `dim` is the parameter `file-dim`; `file` and `hard` bring
    /// their own n.
    pub fn parse(text: &str) -> anyhow::Result<Spec> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let (name, is_file) = (name.trim(), name.trim() == file::NAME);
        let mut pairs: Vec<(String, String)> = Vec::new();
        for piece in rest.split(',') {
            match (piece.split_once('='), pairs.last_mut()) {
                (Some((key, value)), _) => pairs.push((key.trim().to_string(), value.trim().to_string())),
                (None, Some((_, value))) => *value = format!("{value},{piece}"),
                (None, None) if piece.trim().is_empty() => {}
                (None, None) => bail!("'{text}': '{piece}' is not of the form key=value, as in packed:dim=3,n=1000,spacing=0.98"),
            }
        }
        let own_n = table::find(name).is_ok_and(|generator| generator.own_n);
        let (mut dim, mut n, mut seed, mut order) = (2, if own_n { 0 } else { 1000 }, 1, Order::default());
        let mut params = BTreeMap::new();
        for (k, (key, value)) in pairs.iter().enumerate() {
            ensure!(pairs[..k].iter().all(|(other, _)| other != key), "'{text}': {key} is given twice; leave one out");
            let whole = || value.parse::<u64>().with_context(|| format!("'{text}': {key} is '{value}'; it must be a whole number"));
            match key.as_str() {
                "dim" if !is_file => dim = u32::try_from(whole()?).unwrap_or(u32::MAX),
                "n" => n = whole()?,
                "seed" => seed = whole()?,
                "order" => {
                    order = <Order as clap::ValueEnum>::from_str(value, true)
                        .map_err(|_| anyhow::anyhow!("'{text}': order is '{value}'; it must be shuffled, generated or morton"))?;
                }
                _ => {
                    let key = if key == "dim" { "file-dim" } else { key };
                    params.insert(key.to_string(), scalar(key, value));
                }
            }
        }
        Spec::new(name, dim, n, seed, order, &params)
    }

    /// Makes the scene.
    pub fn make(&self) -> anyhow::Result<AnyScene<'static>> {
        Ok(self.ordered(self.given(|generator, inputs| (generator.make)(inputs))?))
    }

    /// Makes the scenes that a detector is to be given before the one of [`Spec::make`], in order: none, but for hard cases of several
    /// steps. A detector may refuse them.
    pub fn history(&self) -> anyhow::Result<Vec<AnyScene<'static>>> {
        Ok(self.given(|generator, inputs| (generator.history)(inputs))?.into_iter().map(|scene| self.ordered(scene)).collect())
    }

    fn given<O>(&self, then: impl FnOnce(&Generator, &Inputs<'_>) -> anyhow::Result<O>) -> anyhow::Result<O> {
        // The fields are public: what was changed since `new` is checked here.
        let generator = table::find(&self.name)?;
        let params = generator.check(self.dim, self.n, &self.params)?;
        let inputs = Inputs { dim: self.dim, n: self.n, seed: self.seed, params: &params };
        then(generator, &inputs).with_context(|| format!("cannot make the scene '{}'", self.name))
    }

    fn ordered(&self, scene: AnyScene<'static>) -> AnyScene<'static> {
        match self.order {
            Order::Generated => scene,
            Order::Shuffled => scene.reordered(&shuffled(scene.len(), self.seed)),
            Order::Morton => scene.reordered(&morton(&scene)),
        }
    }
}

/// NaN and infinities have no number in JSON; as text they are refused by name.
fn json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Integer(k) => (*k).into(),
        toml::Value::Float(x) if x.is_finite() => (*x).into(),
        toml::Value::Boolean(yes) => (*yes).into(),
        toml::Value::String(text) => text.as_str().into(),
        other => other.to_string().into(),
    }
}

/// A value of the command line: whole number, number or text; paths and names of cases are text whatever they look like.
fn scalar(key: &str, value: &str) -> toml::Value {
    match (key, value.parse::<i64>(), value.parse::<f64>()) {
        ("path" | "case" | "frame" | "format", ..) => value.into(),
        (_, Ok(whole), _) => whole.into(),
        (_, _, Ok(number)) => number.into(),
        _ => value.into(),
    }
}

fn shuffled(n: usize, seed: u64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.shuffle(&mut shuffler(seed));
    order
}

/// The order along a Morton curve through 2^32 cells per axis in 2D and 2^21 in 3D, of one cube around all centres; elements in one
/// cell stay as they were.
fn morton(scene: &AnyScene<'_>) -> Vec<u32> {
    let mut keys: Vec<(u64, u32)> = with_scene!(scene, scene => {
        let points = || scene.centres().iter().map(|centre| array(centre).map(Real::wide));
        codes(points()).zip(0..).collect()
    });
    keys.sort_unstable();
    keys.into_iter().map(|(_, k)| k).collect()
}

fn codes<const D: usize>(points: impl Iterator<Item = [f64; D]> + Clone) -> impl Iterator<Item = u64> {
    // Halved, so that differences of the largest doubles do not overflow.
    let points = points.map(|point| point.map(|x| 0.5 * x));
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for point in points.clone() {
        for k in 0..D {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
    }
    let edge = (0..D).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let bits = if D == 2 { 32 } else { 21 };
    let cells = (1u64 << bits) as f64;
    points.map(move |point| {
        let mut code = 0;
        for (k, x) in point.into_iter().enumerate() {
            // A float-to-integer cast saturates and takes the NaN of 0/0 to 0.
            let cell = (((x - low[k]) / edge * cells) as u64).min((1 << bits) - 1);
            code |= (0..bits).map(|bit| (cell >> bit & 1) << (bit * D + k)).sum::<u64>();
        }
        code
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        match Spec::parse(text).and_then(|spec| spec.make()) {
            Ok(_) => panic!("'{text}' was accepted"),
            Err(error) => format!("{error:#}"),
        }
    }

    #[test]
    fn the_command_line_form_gives_every_value_used() {
        let spec = Spec::parse("packed:dim=3,n=27,seed=2,order=morton,spacing=1").unwrap();
        assert_eq!((spec.name.as_str(), spec.dim, spec.n, spec.seed, spec.order), ("packed", 3, 27, 2, Order::Morton));
        let params = serde_json::to_string(&spec.params).unwrap();
        assert_eq!(params, r#"{"diameter":1.0,"jitter":0.05,"lattice":"fcc","offset":0.0,"size-ratio":1.0,"spacing":1.0}"#);
        let spec = Spec::parse("file:path=a,b=1.csv,dim=2");
        assert!(spec.is_err(), "a piece with '=' is a parameter");
        let spec = Spec::parse("file:path=a,b.csv,dim=2").unwrap();
        assert_eq!((spec.n, &spec.params["path"], &spec.params["file-dim"]), (0, &"a,b.csv".into(), &2.into()));
        assert_eq!(Spec::parse("loose").unwrap().n, 1000);
    }

    #[test]
    fn bad_requests_are_refused_by_name() {
        for (text, message) in [
            (
                "packd",
                "there is no scene 'packd'; the scenes are: packed, loose, clustered, couples, pack-a, pack-b, pack-c, pack-d, file, hard",
            ),
            ("packed:dim=4", "packed: dim = 4; it is made in 2 dimensions and 3 dimensions only"),
            ("pack-b:dim=3", "pack-b: dim = 3; it is made in 2 dimensions only"),
            ("loose:n=4294967296", "loose: n = 4294967296; at most 2^32 - 1 = 4294967295 elements can be numbered: make n smaller"),
            ("loose:spacing=1", "loose: there is no parameter 'spacing'; the parameters are: diameter, offset, size-ratio, fraction"),
            ("loose:fraction=0", "loose: fraction is 0; it must be a finite number over 0"),
            ("loose:fraction=nan", "loose: fraction is \"nan\"; it must be a finite number over 0"),
            ("loose:fraction=-inf", "loose: fraction is \"-inf\"; it must be a finite number over 0"),
            ("loose:diameter=-1", "loose: diameter is -1; it must be a finite number over 0"),
            ("loose:diameter=big", "loose: diameter is \"big\"; it must be a finite number over 0"),
            ("packed:jitter=-0.1", "packed: jitter is -0.1; it must be a finite number of at least 0"),
            ("packed:size-ratio=0.5", "packed: size-ratio is 0.5; it must be a finite number of at least 1"),
            ("packed:lattice=fcc", "packed: lattice is \"fcc\"; it must be hexagonal or square in 2 dimensions"),
            ("packed:dim=3,lattice=7", "packed: lattice is 7; it must be fcc or cubic in 3 dimensions"),
            ("clustered:per-cluster=0", "clustered: per-cluster is 0; it must be a whole number of at least 1"),
            ("clustered:per-cluster=1.5", "clustered: per-cluster is 1.5; it must be a whole number of at least 1"),
            ("clustered:background=1.1", "clustered: background is 1.1; it must be a number from 0 to 1"),
            ("pack-c:s=-1", "pack-c: s is -1; it must be a finite number of at least 0"),
            ("file", "file: the parameter 'path' is missing (the file's name)"),
            ("file:path=", "file: path is \"\"; it must be a text that is not empty"),
            ("file:path=a,dim=4", "file: file-dim is 4; it must be 2 or 3"),
            ("hard", "hard: the parameter 'case' is missing (the name of the case)"),
            (
                "hard:case=tangent-1-2-2-3",
                "hard: case is \"tangent-1-2-2-3\"; it must be the name of a hard case in 2 dimensions: see contactbench list hard-cases",
            ),
            (
                "hard:case=every-neighbour,n=5",
                "cannot make the scene 'hard': the case has 17 elements, but n = 5 was asked for; leave n out",
            ),
            ("packed:n=-1", "'packed:n=-1': n is '-1'; it must be a whole number: invalid digit found in string"),
            ("packed:order=up", "'packed:order=up': order is 'up'; it must be shuffled, generated or morton"),
            ("packed:3", "'packed:3': '3' is not of the form key=value, as in packed:dim=3,n=1000,spacing=0.98"),
            ("pack-c:s=1,s=2", "'pack-c:s=1,s=2': s is given twice; leave one out"),
            ("pack-c:n=1,n=2", "'pack-c:n=1,n=2': n is given twice; leave one out"),
        ] {
            assert_eq!(refusal(text), message);
        }
        for (name, text) in
            [("pack-c", "pack-c:s=1e308,n=100"), ("loose", "loose:fraction=1e-320"), ("packed", "packed:jitter=1e308,diameter=1e9")]
        {
            let beyond = "coordinates or radii leave the range of f64; take parameters nearer to 1";
            assert_eq!(refusal(text), format!("cannot make the scene '{name}': {beyond}"));
        }
        let message = refusal("hard:case=every-neighbor");
        assert!(
            message.contains("the nearest names are every-neighbour, ") && message.contains("contactbench list hard-cases"),
            "{message}"
        );
        assert!(refusal("file:path=/nowhere/at-all.csv").contains("/nowhere/at-all.csv"));
    }

    #[test]
    fn orders_are_permutations_and_morton_is_local() {
        let make = |order| Spec { order, ..Spec::parse("packed:n=1000,lattice=square,jitter=0,spacing=1").unwrap() }.make().unwrap();
        let sorted = |scene: &AnyScene<'_>| {
            let AnyScene::PlaneF64(scene) = scene else { panic!("made in the plane") };
            let mut bits: Vec<[u64; 2]> = scene.centres().iter().map(|p| array(p).map(f64::to_bits)).collect();
            bits.sort_unstable();
            bits
        };
        let path = |scene: &AnyScene<'_>| -> f64 {
            let AnyScene::PlaneF64(scene) = scene else { panic!("made in the plane") };
            scene.centres().windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>() / 999.0
        };
        let (generated, shuffled, morton) = (make(Order::Generated), make(Order::Shuffled), make(Order::Morton));
        assert_ne!(generated, shuffled);
        assert_eq!(sorted(&generated), sorted(&shuffled));
        assert_eq!(sorted(&generated), sorted(&morton));
        assert!(path(&morton) < 2.0 && path(&shuffled) > 10.0, "{} {}", path(&morton), path(&shuffled));
        let AnyScene::PlaneF64(scene) = &morton else { panic!("made in the plane") };
        let first: Vec<[f64; 2]> = scene.centres()[..4].iter().map(|p| *array(p)).collect();
        assert_eq!(first, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    }

    #[test]
    fn morton_order_survives_huge_and_equal_coordinates() {
        let cases = [
            (vec![[-1.7e308, 1.7e308], [1.7e308, -1.7e308], [-1.7e308; 2]], vec![2, 1, 0]),
            (vec![[5.0, 5.0]; 3], vec![0, 1, 2]),
            (vec![], vec![]),
        ];
        for (points, order) in cases {
            let points: Vec<_> = points.into_iter().map(nalgebra::Point::from).collect();
            let scene = AnyScene::from(crate::scene::Scene::<f64, 2>::new(points, crate::scene::Radii::Uniform(1.0)).unwrap());
            assert_eq!(morton(&scene), order);
        }
    }
}
