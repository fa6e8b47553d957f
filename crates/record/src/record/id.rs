//! The identity of a measurement. Its *axes* are the fields of [`CellId`] and the parameters in it,
//! under the names that filters and expressions use (`per_cluster` for `per-cluster`). If names
//! clash, the field takes precedence, then the scene's parameter, then the detector's;
//! `detector_level` is always the detector's.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::record::value::AxisValue;
use contactbench_terms::grammar::Spec;

/// A measured cell: experiment, scene, setting and detector. Reports sort by the fields in this
/// order.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct CellId {
    pub experiment: String,
    pub scene: String,
    pub dim: u32,
    /// Name of the machine; `None` in records of one machine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub machine: Option<String>,
    pub params: BTreeMap<String, AxisValue>,
    /// Order of the particles: shuffled, generated or morton.
    pub order: String,
    pub n: u64,
    pub seed: u64,
    /// Arithmetic: f32, textbook, f64 or exact.
    pub arithmetic: String,
    #[serde(default)]
    pub resources: Resources,
    pub detector: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub detector_params: BTreeMap<String, AxisValue>,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Resources {
    threads: u64,
}

impl Default for Resources {
    fn default() -> Resources {
        Resources { threads: 1 }
    }
}

pub const FIELDS: [&str; 9] =
    ["experiment", "scene", "dim", "order", "n", "seed", "arithmetic", THREADS, "detector"];
pub const MACHINE: &str = "machine";
pub const THREADS: &str = "threads";

pub fn variable(name: &str) -> String {
    name.replace('-', "_")
}

pub const OVER: &str = "over";

/// Splits `streamed-nbs:level=avx2` into name and parameters. Parameters of a tracker such as
/// `verlet(nbs:levels=auto,skin=0.1)` include its detector, named [`OVER`]. Any other text is a
/// name.
pub fn split_subject(spec: &str) -> (String, BTreeMap<String, AxisValue>) {
    let given = Spec::parse_tracker(spec);
    if given.form("").is_err() {
        return (spec.into(), BTreeMap::new());
    }
    let values = given.params.iter().map(|(key, value)| (*key, AxisValue::parse(value)));
    let over = given.over.as_deref().map(|over| (OVER, AxisValue::Text(over.into())));
    let params = values.chain(over).map(|(key, value)| (key.to_string(), value));
    (given.name.into(), params.collect())
}

impl CellId {
    pub fn threads(&self) -> u32 {
        self.resources.threads.try_into().unwrap_or(u32::MAX)
    }

    pub fn with_threads(mut self, threads: u32) -> CellId {
        self.resources.threads = threads.into();
        self
    }

    pub fn with_subject(mut self, spec: &str) -> CellId {
        let (name, params) = split_subject(spec);
        self.detector = name;
        self.detector_params = params;
        self
    }

    pub fn anywhere(mut self) -> CellId {
        self.machine = None;
        self
    }

    /// The detector with its parameters, as a normalised spec.
    pub fn subject(&self) -> String {
        self.subject_without(&[])
    }

    /// Like [`CellId::subject`], without the parameters that are these axes.
    pub fn subject_without(&self, axes: &[&str]) -> String {
        let is_kept = |name: &str| {
            let plain = variable(name);
            !axes.iter().any(|axis| *axis == plain || *axis == prefixed(&plain))
        };
        let mut kept: Vec<_> =
            self.detector_params.iter().filter(|(name, _)| is_kept(name)).collect();
        kept.sort_by_key(|(name, _)| *name != OVER);
        let piece = |(name, value): (&String, &AxisValue)| match &**name {
            OVER => value.to_string(),
            _ => format!("{name}={value}"),
        };
        let pieces: Vec<String> = kept.into_iter().map(piece).collect();
        let (name, pieces, empty) = (&self.detector, pieces.join(","), pieces.is_empty());
        match self.detector_params.contains_key(OVER) {
            _ if empty => name.clone(),
            true => format!("{name}({pieces})"),
            false => format!("{name}:{pieces}"),
        }
    }

    pub fn axis(&self, name: &str) -> Option<AxisValue> {
        let of_detector = |name: &str| parameter(&self.detector_params, name);
        self.of_scene(name)
            .or_else(|| of_detector(name))
            .or_else(|| of_detector(name.strip_prefix(DETECTOR)?))
    }

    pub fn parameters(&self) -> Vec<(String, AxisValue)> {
        let machine = self.machine.iter().map(|name| (MACHINE.into(), name.as_str().into()));
        let params = self.params.iter().map(|(name, value)| (variable(name), value.clone()));
        machine.chain(params).collect()
    }

    pub fn detector_parameters(&self) -> impl Iterator<Item = (String, &AxisValue)> {
        self.detector_params.iter().map(|(name, value)| {
            let plain = variable(name);
            let taken = self.of_scene(&plain).is_some();
            (if taken { prefixed(&plain) } else { plain }, value)
        })
    }

    pub fn names(&self) -> impl Iterator<Item = String> {
        let detector = self.detector_parameters().map(|(name, _)| name).collect::<Vec<_>>();
        FIELDS
            .into_iter()
            .map(String::from)
            .chain(self.parameters().into_iter().map(|(name, _)| name))
            .chain(detector)
    }

    pub fn without(&self, axes: &[&str]) -> Projection {
        let field = |name: &&str| {
            let value = match *name {
                "detector" => self.subject_without(axes).as_str().into(),
                name => self.of_scene(name)?,
            };
            Some((name.to_string(), value))
        };
        let (first, last) = FIELDS.split_at(3);
        let first = first.iter().filter_map(field).chain(self.parameters());
        Projection(first.chain(last.iter().filter_map(field)).collect()).without(axes)
    }

    pub fn scene_id(&self) -> Projection {
        self.without(&["detector", "arithmetic", THREADS])
    }

    fn of_scene(&self, name: &str) -> Option<AxisValue> {
        let text = |value: &str| Some(AxisValue::from(value));
        match name {
            "experiment" => text(&self.experiment),
            "scene" => text(&self.scene),
            "order" => text(&self.order),
            "arithmetic" => text(&self.arithmetic),
            "detector" => text(&self.detector),
            "dim" => Some(u64::from(self.dim).into()),
            "n" => Some(self.n.into()),
            "seed" => Some(self.seed.into()),
            THREADS => Some(u64::from(self.threads()).into()),
            MACHINE => text(self.machine.as_deref()?),
            _ => parameter(&self.params, name),
        }
    }
}

fn parameter(params: &BTreeMap<String, AxisValue>, name: &str) -> Option<AxisValue> {
    let known = |param: &str| param == name || variable(param) == name;
    params.iter().find(|(param, _)| known(param)).map(|(_, value)| value.clone())
}

/// Prefix for a detector's parameter that would share its name with another axis.
const DETECTOR: &str = "detector_";

fn prefixed(name: &str) -> String {
    format!("{DETECTOR}{name}")
}

/// Some axes with their values, shared by a group of cells. The detector includes its parameters.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Projection(Vec<(String, AxisValue)>);

impl Projection {
    pub fn without(mut self, axes: &[&str]) -> Projection {
        self.0.retain(|(name, _)| !axes.contains(&name.as_str()));
        self
    }

    pub fn axis(&self, name: &str) -> Option<AxisValue> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone())
    }

    pub fn parameters(&self) -> impl Iterator<Item = &(String, AxisValue)> {
        self.0.iter().filter(|(name, _)| !FIELDS.contains(&name.as_str()))
    }
}

impl From<&CellId> for Projection {
    fn from(id: &CellId) -> Projection {
        id.without(&[])
    }
}

impl From<&Projection> for Projection {
    fn from(same: &Projection) -> Projection {
        same.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id() -> CellId {
        CellId {
            experiment: "e".into(),
            scene: "packed".into(),
            dim: 2,
            params: [("per-cluster".to_string(), 8u64.into())].into(),
            order: "shuffled".into(),
            n: 100,
            seed: u64::MAX,
            arithmetic: "exact".into(),
            ..CellId::default()
        }
        .with_threads(2)
        .with_subject("streamed-nbs:level=avx2,skin=0.3")
    }

    #[test]
    fn a_spec_has_a_normal_form() {
        for (spec, normal) in [
            ("streamed-nbs:level=avx2,skin=0.3", "streamed-nbs:level=avx2,skin=0.3"),
            ("v:skin = 0.30 ,level=avx2", "v:level=avx2,skin=0.3"),
            ("nbs", "nbs"),
        ] {
            assert_eq!(id().with_subject(spec).subject(), normal);
        }
        assert_eq!(id().subject_without(&["level"]), "streamed-nbs:skin=0.3");
    }

    fn shown(id: &CellId, name: &str) -> Option<String> {
        id.axis(name).map(|value| value.to_string())
    }

    #[test]
    fn a_tracker_has_its_detector_and_its_rule_as_axes() {
        let text = "verlet(nbs:levels=auto,form=a,rule=every-5,skin=1e-3)";
        let tracker = id().with_subject(text);
        for (name, value) in [
            ("detector", "verlet"),
            ("over", "nbs:levels=auto,form=a"),
            ("rule", "every-5"),
            ("skin", "0.001"),
        ] {
            assert_eq!(shown(&tracker, name).as_deref(), Some(value), "{name}");
        }
        for (axes, left) in [
            (&[][..], "verlet(nbs:levels=auto,form=a,rule=every-5,skin=0.001)"),
            (&["skin"], "verlet(nbs:levels=auto,form=a,rule=every-5)"),
            (&["over", "rule"], "verlet(skin=0.001)"),
            (&["over", "rule", "skin"], "verlet"),
        ] {
            assert_eq!(tracker.subject_without(axes), left);
        }
    }

    #[test]
    fn every_axis_has_a_name_and_the_scene_goes_before_the_detector() {
        let mut id = id();
        for (name, value) in [
            ("per_cluster", Some("8")),
            ("threads", Some("2")),
            ("seed", Some("18446744073709551615")),
            ("detector", Some("streamed-nbs")),
            ("level", Some("avx2")),
            ("detector_level", Some("avx2")),
            ("machine", None),
        ] {
            assert_eq!(shown(&id, name).as_deref(), value, "{name}");
        }
        let all: Vec<String> = id.names().collect();
        assert!(all.iter().all(|name| id.axis(name).is_some()), "{all:?}");
        assert!(all.contains(&"level".into()) && all.contains(&"per_cluster".into()), "{all:?}");
        id.params.insert("level".into(), 3u64.into());
        assert_eq!(shown(&id, "level").as_deref(), Some("3"));
        assert_eq!(shown(&id, "detector_level").as_deref(), Some("avx2"));
        assert!(id.names().any(|name| name == "detector_level"));
    }

    #[test]
    fn a_projection_keeps_the_other_axes() {
        let scene = id().scene_id();
        for kept in ["experiment", "scene", "dim", "order", "n", "seed", "per_cluster"] {
            assert_eq!(scene.axis(kept), id().axis(kept), "{kept}");
        }
        assert_eq!(scene, id().with_subject("nbs").with_threads(1).scene_id());
        let series = id().without(&["n", "seed"]);
        assert_eq!(series.axis("detector"), Some("streamed-nbs:level=avx2,skin=0.3".into()));
        assert_ne!(series, id().with_subject("streamed-nbs:level=avx2").without(&["n", "seed"]));
        assert_eq!(series, CellId { n: 7, ..id() }.without(&["n", "seed"]));
    }
}
