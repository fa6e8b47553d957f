//! What radii and contacts say.

use std::collections::HashSet;

use serde_json::json;

use crate::cli::inspect::Line;
use contactbench_core::contact::depth::depth;
use contactbench_core::contact::{Arithmetic, Test};
use contactbench_core::crowd::Crowd;
use contactbench_core::detect::{Options, table};
use contactbench_core::pair_list::{Allowance, PairList};
use contactbench_core::periodic::{self, ImagePair, Periodic};
use contactbench_core::scene::{AnyScene, Radii, Real, Scene, Stored, array};
use contactbench_core::sink::{Sink, Visit, normalise};
use contactbench_core::{oracle, with_scene};
use contactbench_io::{Notice, Place, RadiusSource};
use contactbench_scenes::doubts::{Touching, doubts, f32_spacing};
use contactbench_scenes::touching;
use contactbench_terms::number::{number, plural};

/// Couples whose distance differs from the sum of their radii by less than this share of it are
/// near tangent.
const NEAR: f64 = 1e-9;
/// Where more contacts than this are to be expected, they are not looked for.
const MOST: f64 = 5e7;

/// The contacts of a scene.
pub(super) enum Contacts {
    Found {
        /// Where boundaries are open, in ascending order.
        open: Vec<[u32; 2]>,
        /// Those in a box that repeats.
        boxed: Vec<ImagePair>,
        /// Near tangent couples, those just apart included.
        near: u64,
        /// The sum of the overlaps in mean radii.
        overlap: f64,
    },
    /// Estimated contacts per particle: they are too many to be looked for.
    TooMany(f64),
    /// No detector takes the scene.
    Refused(String),
}

impl Contacts {
    pub fn new(scene: &AnyScene<'static>) -> Contacts {
        match scene {
            AnyScene::Plane(Stored::F64(scene)) => contacts(scene),
            AnyScene::Space(Stored::F64(scene)) => contacts(scene),
            // Readers give doubles.
            _ => Contacts::Refused("not in f64".into()),
        }
    }

    /// Those in a box that repeats.
    pub fn in_box(periodic: &Periodic<'_>) -> Contacts {
        // As `detect` has it, so that a box much smaller than the particles is refused at once.
        let limit = contactbench_core::memory::limit_for(periodic.scene().len());
        let pairs = match touching::contacts(periodic, limit) {
            Ok(pairs) => pairs,
            Err(error) => return Contacts::Refused(format!("{error:#}")),
        };
        let depths = pairs.iter().map(|&pair| periodic::depth(periodic, pair));
        let (near, overlap) = depths.fold((0, 0.0), |(near, sum), depth| {
            (near + u64::from(depth < 2.0 * NEAR), sum + depth)
        });
        let near = near + touching::nearly(periodic, 2.0 * NEAR, limit).len() as u64;
        Contacts::Found { open: Vec::new(), boxed: pairs, near, overlap }
    }

    /// Their number, where it is known.
    pub fn exact(&self) -> Option<u64> {
        match self {
            Contacts::Found { open, boxed, .. } => Some((open.len() + boxed.len()) as u64),
            _ => None,
        }
    }
}

fn contacts<const D: usize>(scene: &Scene<'static, f64, D>) -> Contacts
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let n = scene.len();
    let overlap = |i: usize, j: usize| {
        depth(
            array(&scene.centres()[i]),
            array(&scene.centres()[j]),
            scene.radius(i),
            scene.radius(j),
        )
    };
    let given = AnyScene::from(scene.clone());
    let each = Crowd::new(&given).mean;
    if 0.5 * each * n as f64 > MOST {
        return Contacts::TooMany(each);
    }
    // Bodies a little larger find those couples, too, that are just apart.
    let larger = |r: f64| (r * (1.0 + 2.0 * NEAR)).min(f64::MAX);
    let radii = match scene.radii() {
        Radii::Uniform(r) => Radii::Uniform(larger(*r)),
        Radii::Each(radii) => Radii::Each(radii.iter().map(|&r| larger(r)).collect()),
    };
    let swollen = match Scene::new(scene.centres().to_vec(), radii) {
        Ok(scene) => AnyScene::from(scene),
        Err(error) => return Contacts::Refused(error.to_string()),
    };
    let allowance = Allowance::new(Options::default().memory_limit);
    let (mut list, mut near, mut sum) = (PairList::new(&allowance), 0, 0.0);
    let mut sink = Visit(|i: u32, j: u32| {
        let depth = overlap(i as usize, j as usize);
        // In mean radii: twice the share of the sum.
        near += u64::from(depth.abs() < 2.0 * NEAR);
        if depth >= 0.0 {
            list.contact(i, j);
            sum += depth;
        }
    });
    let mut detector = table::robust(Options::default());
    if let Err(refusal) = detector.visit(&swollen, Test::Exact, &mut sink) {
        return Contacts::Refused(refusal.to_string());
    }
    let mut pairs = Vec::new();
    if let Err(refusal) = list.end(n, &mut pairs) {
        return Contacts::Refused(refusal.to_string());
    }
    normalise(&mut pairs);
    Contacts::Found { open: pairs, boxed: Vec::new(), near, overlap: sum }
}

/// Prints radii, contacts, and what rounding would do.
pub(super) fn report(
    scene: &AnyScene<'_>,
    source: &RadiusSource,
    periodic: Option<&Periodic<'_>>,
    contacts: &Contacts,
    lines: &mut Vec<Line>,
    warnings: &mut Vec<String>,
) {
    let n = scene.len();
    if n == 0 {
        return;
    }
    let radius = |k: usize| with_scene!(scene, scene => scene.radius(k).wide());
    let (mut least, mut most, mut mean) = (f64::INFINITY, 0.0f64, 0.0);
    for r in (0..n).map(radius) {
        (least, most, mean) = (least.min(r), most.max(r), mean + r / n as f64);
    }
    // Where all are the same, their mean is not to show the rounding of a sum.
    mean = if least == most { least } else { mean };
    lines.push(Line(
        "radii",
        format!("smallest {}, mean {}, largest {}", number(least), number(mean), number(most)),
        vec![
            ("radius_min", json!(least)),
            ("radius_mean", json!(mean)),
            ("radius_max", json!(most)),
        ],
    ));
    let touching = match contacts {
        Contacts::Refused(reason) => {
            warnings.push(format!("contacts were not looked for: {reason}"));
            None
        }
        Contacts::TooMany(each) => {
            lines.push(Line(
                "contacts",
                format!("about {each:.0} per particle, too many to look for"),
                vec![("coordination", json!(each))],
            ));
            Some(Touching::estimated(*each))
        }
        Contacts::Found { open, boxed: pairs, near, overlap } => {
            let count = open.len() + pairs.len();
            let each = 2.0 * count as f64 / n as f64;
            let mean = if count == 0 { 0.0 } else { overlap / count as f64 };
            let across = pairs.iter().filter(|pair| pair.image != [0; 3]).count();
            let own = pairs.iter().filter(|pair| pair.i == pair.j).count();
            let boxed = match periodic {
                None => String::new(),
                Some(_) => format!(", {across} of them across the box, {own} of one with itself"),
            };
            let text = format!(
                "{count} (exact; bodies that just touch are in contact){boxed}, {} per particle, \
                 mean overlap {} radii",
                number(each),
                number(mean)
            );
            let boundaries = if periodic.is_some() { "periodic" } else { "open" };
            let mut values = vec![
                ("contacts", json!(count)),
                ("coordination", json!(each)),
                ("mean_overlap", json!(mean)),
                ("boundaries", json!(boundaries)),
            ];
            if periodic.is_some() {
                values.extend([("contacts_across", json!(across)), ("contacts_own", json!(own))]);
            }
            lines.push(Line("contacts", text, values));
            lines.push(Line(
                "near tangent",
                format!(
                    "{} whose distance is the sum of their radii to within 1e-9 of it",
                    plural(*near as usize, "couple")
                ),
                vec![("near_tangent", json!(near))],
            ));
            if *near > 0 && 10 * near > count as u64 {
                warnings.push(format!(
                    "{} within 1e-9 of just touching: codes that round in different ways will \
                     disagree about {}",
                    if *near == 1 { "1 couple is".into() } else { format!("{near} couples are") },
                    if *near == 1 { "it" } else { "them" }
                ));
            }
            Some(match periodic {
                Some(periodic) => Touching::boxed(periodic, pairs),
                None => Touching::open(scene, open),
            })
        }
    };
    let doubts = doubts(scene, source, Arithmetic::F32, touching.as_ref());
    // Those without radii are warned of as well: see `of_centres`.
    let doubts = doubts.iter().filter(|notice| !matches!(notice, Notice::Coincident(..)));
    warnings.extend(doubts.map(|notice| notice.words(Place::Argument)));
    if matches!(contacts, Contacts::Refused(_)) {
        return;
    }
    offset(scene, periodic, mean, contacts, lines);
}

/// How far from the origin the scene is, and what f32 would make of it.
fn offset(
    scene: &AnyScene<'_>,
    periodic: Option<&Periodic<'_>>,
    mean: f64,
    contacts: &Contacts,
    lines: &mut Vec<Line>,
) {
    let largest = with_scene!(scene, scene => {
        let coordinates = scene.centres().iter().flat_map(array);
        coordinates.fold(0.0f64, |most, x| most.max(x.wide().abs()))
    });
    let diameters = largest / (2.0 * mean);
    if !diameters.is_finite() {
        return;
    }
    // The spacing of f32 at that place, against the radius.
    let spacing = f32_spacing(scene);
    let mut text = format!(
        "{} mean diameters from the origin at most; numbers of f32 are up to {spacing:.1e} radii \
         apart there",
        number(diameters)
    );
    let mut values =
        vec![("offset_diameters", json!(diameters)), ("f32_spacing_radii", json!(spacing))];
    if let Some([missed, spurious]) = in_f32(scene, periodic, contacts) {
        text += &format!(
            "; f32 would miss {} and add {spurious}",
            plural(usize::try_from(missed).unwrap_or(usize::MAX), "contact")
        );
        values.extend([("f32_missed", json!(missed)), ("f32_spurious", json!(spurious))]);
    }
    lines.push(Line("offset", text, values));
}

/// How many contacts f32 would miss, and how many it would add.
fn in_f32(
    scene: &AnyScene<'_>,
    periodic: Option<&Periodic<'_>>,
    contacts: &Contacts,
) -> Option<[u64; 2]> {
    let Contacts::Found { open, boxed, .. } = contacts else { return None };
    let mut detector = table::robust(Options::default());
    if let Some(periodic) = periodic {
        let limit = Options::default().memory_limit;
        let rounded = periodic::contacts(periodic, &mut *detector, Arithmetic::F32, limit).ok()?;
        let known: HashSet<&ImagePair> = boxed.iter().collect();
        let both = rounded.iter().filter(|pair| known.contains(pair)).count();
        return Some([boxed.len() - both, rounded.len() - both].map(|count| count as u64));
    }
    let (stored, mut rounded) = (scene.stored(Arithmetic::F32).ok()?, Vec::new());
    detector.list(&stored, Test::Rounded, &mut rounded).ok()?;
    normalise(&mut rounded);
    let errors = oracle::compare(&rounded, open, scene);
    Some([errors.missed, errors.spurious])
}
