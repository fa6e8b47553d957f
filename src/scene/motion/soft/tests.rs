use super::*;
use crate::scene::motion::{Frames, Kind, Motion};
use crate::scene::spec::Spec;
use crate::scene::{Radii, Real, Stored, array};
use crate::sink::splitmix64;
use crate::with_scene;

const PLAYS: [Play; 3] = [Play::Collapse, Play::Drum, Play::Penetration];

fn made(text: &str) -> AnyScene<'static> {
    Spec::parse(text).unwrap().make().unwrap()
}

fn plane(text: &str) -> Scene<'static, f64, 2> {
    let AnyScene::Plane(Stored::F64(scene)) = made(text) else { panic!("{text}: discs in f64") };
    scene
}

fn of<const D: usize>(centres: &[[f64; D]], radii: &[f64]) -> Scene<'static, f64, D> {
    let centres: Vec<_> = centres.iter().map(|&at| Point::from(at)).collect();
    Scene::new(centres, Radii::Each(radii.to_vec().into())).unwrap()
}

fn numbers(scene: &AnyScene<'_>) -> Vec<f64> {
    with_scene!(scene, scene => {
        scene.centres().iter().flat_map(|at| array(at).map(|x| x.wide())).collect()
    })
}

fn digest(numbers: &[f64]) -> u64 {
    numbers.iter().fold(0, |sum, x| splitmix64(sum ^ x.to_bits()))
}

fn momentum(bodies: &[Body<2>]) -> [f64; 2] {
    [0, 1].map(|k| bodies.iter().map(|body| body.mass * body.velocity[k]).sum())
}

/// The kinetic energy of these velocities.
fn kinetic<const D: usize>(bodies: &[Body<D>]) -> f64 {
    bodies.iter().map(|body| 0.5 * body.mass * body::dot(&body.velocity, &body.velocity)).sum()
}

/// Of the springs between bodies.
fn elastic(bodies: &[Body<2>], first: &[Couple]) -> f64 {
    let mut sum = 0.0;
    for (j, b) in bodies.iter().enumerate() {
        for (i, a) in bodies[..j].iter().enumerate() {
            let pair = [i as u32, j as u32];
            let given = first.iter().find(|couple| couple.pair == pair);
            let reach = given.map_or(a.radius + b.radius, |couple| couple.reach);
            let (x, y) = (a.at[0] - b.at[0], a.at[1] - b.at[1]);
            let depth = (reach - (x * x + y * y).sqrt()).max(0.0);
            assert!(depth < 0.1 * a.size.min(b.size), "the springs are linear here: {depth}");
            let stiffness = 2.0 * a.stiffness * b.stiffness / (a.stiffness + b.stiffness);
            sum += 0.5 * stiffness * depth * depth;
        }
    }
    sum
}

#[test]
fn bodies_that_meet_head_on_leave_with_seven_tenths_of_the_speed() {
    for radii in [[0.5, 0.5], [0.5, 0.1], [0.2, 0.5]] {
        let scene = of(&[[0.0, 0.0], [1.5, 0.0]], &radii);
        let mut soft = Soft::new(&scene, Play::Collapse, 0.01).unwrap();
        soft.stage.open();
        for (body, &particle) in soft.first.iter_mut().zip(&soft.order) {
            body.velocity[0] = if particle == 0 { 0.3 } else { -0.4 };
        }
        let before = momentum(&soft.first);
        soft.at(400).unwrap();
        let (_, bodies) = soft.last.as_ref().unwrap();
        let parting = (bodies[0].velocity[0] - bodies[1].velocity[0]).abs() / 0.7;
        assert!((parting - 0.7).abs() < 0.007, "{radii:?}: {parting}");
        assert!((momentum(bodies)[0] - before[0]).abs() < 1e-14 && bodies[0].velocity[1] == 0.0);
    }
}

#[test]
fn without_walls_momentum_stays_and_energy_only_falls() {
    let mut soft =
        Soft::new(&plane("settled:n=60,fraction=0.4,size-ratio=3"), Play::Collapse, 0.1).unwrap();
    soft.stage.open();
    let middle = soft.stage.fastest();
    for (k, body) in soft.first.iter_mut().enumerate() {
        // Towards the middle, and not in order.
        let noise = (splitmix64(k as u64) >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
        body.velocity = body.at.map(|x| 0.1 * (5.0 - x) + 0.1 * middle * noise);
    }
    let (before, mut bodies) = (momentum(&soft.first), soft.first.clone());
    soft.near.begin(&bodies).unwrap();
    let start = kinetic(&bodies);
    let mut least = start;
    for _ in 0..4000 {
        let last = bodies.clone();
        soft.step(&mut bodies).unwrap();
        // At the time of the places: velocities are between them.
        let mut now = bodies.clone();
        for (body, last) in now.iter_mut().zip(&last) {
            body.velocity = std::array::from_fn(|k| 0.5 * (body.velocity[k] + last.velocity[k]));
        }
        let energy = kinetic(&now) + elastic(&now, &soft.near.first);
        assert!(energy < least * 1.003, "{energy} after {least}");
        least = least.min(energy);
    }
    assert!(least < 0.8 * start, "they met: {least} of {start}");
    let after = momentum(&bodies);
    assert!((0..2).all(|k| (after[k] - before[k]).abs() < 1e-11), "{before:?} {after:?}");
}

#[test]
fn a_body_comes_to_rest_where_its_weight_is_borne() {
    fn rest<const D: usize>(radii: &[f64])
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let mut centres = vec![[0.0; D]; 2];
        centres[1][0] = 3.0;
        let mut soft = Soft::new(&of(&centres, radii), Play::Collapse, 0.5).unwrap();
        soft.first.iter_mut().for_each(|body| body.at[D - 1] += 0.3);
        soft.at(300).unwrap();
        for body in &soft.last.as_ref().unwrap().1 {
            let depth = body.radius - body.at[D - 1];
            // m g / k, where the scene is as high as the largest body: 250 · 2 of its springs.
            let weight = body.size * body.size / 500.0;
            assert!((depth - weight).abs() < 1e-6 * weight, "{D}D: {depth} {weight}");
        }
    }
    rest::<2>(&[0.5, 0.25]);
    rest::<3>(&[0.25, 0.5]);
}

/// Walls give way by a tenth at most.
fn all_inside<const D: usize>(bodies: &[Body<D>], low: [f64; D], high: [f64; D]) {
    for body in bodies {
        for k in 0..D {
            let far = body.radius - 0.1 * body.size;
            let inside = body.at[k] >= low[k] + far && body.at[k] <= high[k] - far;
            assert!(inside, "{:?} is not within {low:?} and {high:?}", body.at);
        }
    }
}

#[test]
fn a_column_collapses_spreads_and_settles() {
    let scene = plane("packed:n=100,seed=3");
    let mut soft = Soft::new(&scene, Play::Collapse, 1.0).unwrap();
    let extent: [f64; 2] =
        [0, 1].map(|k| soft.first.iter().map(|body| body.at[k]).fold(0.0, f64::max) + 0.5);
    let mut most = 0.0f64;
    for k in (0..=70).step_by(2) {
        soft.at(k).unwrap();
        let (_, bodies) = soft.last.as_ref().unwrap();
        all_inside(bodies, [0.0; 2], [extent[0] + 3.0 * extent[1] + 1e-9, f64::INFINITY]);
        most = most.max(kinetic(bodies));
    }
    let (_, bodies) = soft.last.as_ref().unwrap();
    let end = kinetic(bodies);
    assert!(end < 0.1 * most, "at rest: {end} of {most}");
    let widest = bodies.iter().map(|body| body.at[0]).fold(0.0, f64::max);
    assert!(widest > 1.5 * extent[0], "{widest} of {extent:?}");
    let height = |bodies: &[Body<2>]| bodies.iter().map(|body| body.at[1]).sum::<f64>() / 100.0;
    assert!(height(bodies) < 0.85 * height(&soft.first));
}

#[test]
fn a_drum_turns_its_filling_and_keeps_it() {
    let mut soft = Soft::new(&plane("packed:n=60"), Play::Drum, 1.0).unwrap();
    let ([x, y], radius) = soft.stage.circle().unwrap();
    soft.at(12).unwrap();
    let (_, bodies) = soft.last.as_ref().unwrap();
    for body in bodies {
        let far = ((body.at[0] - x).powi(2) + (body.at[1] - y).powi(2)).sqrt();
        assert!(far + body.radius <= radius + 0.1, "{far} of {radius}");
    }
    // The wall turns against the clock, and takes the filling up to the right.
    let right = bodies.iter().map(|body| body.at[0] - x).sum::<f64>() / 60.0;
    assert!(right > 0.05 * radius, "{right} of {radius}");
}

#[test]
fn the_drum_is_around_a_half_filled_one() {
    let centres: Vec<[f64; 2]> = (0..400)
        .map(|k| [f64::from(k % 20) - 9.5, -f64::from(k / 20)])
        .filter(|at| at[0] * at[0] + at[1] * at[1] < 91.0)
        .collect();
    let soft = Soft::new(&of(&centres, &vec![0.5; centres.len()]), Play::Drum, 0.1).unwrap();
    let ([_, y], radius) = soft.stage.circle().unwrap();
    let high = soft.first.iter().map(|body| body.at[1]).fold(0.0, f64::max);
    assert!((9.99..10.1).contains(&radius) && (y - high).abs() < 0.5, "{radius} {y} {high}");
}

#[test]
fn the_ball_is_the_largest_or_the_topmost_and_digs_in() {
    let ball = |centres: &[[f64; 2]], radii: &[f64]| {
        let soft = Soft::new(&of(centres, radii), Play::Penetration, 0.1).unwrap();
        let falls = |body: &&Body<2>| body.velocity[1] < 0.0;
        assert_eq!(soft.first.iter().filter(falls).count(), 1);
        soft.order[soft.first.iter().position(|body| body.velocity[1] < 0.0).unwrap()]
    };
    let row = [[5.0, 0.0], [0.0, 4.0], [3.0, 4.0]];
    assert_eq!(ball(&row, &[1.0; 3]), 1);
    assert_eq!(ball(&row, &[1.0, 0.5, 1.0]), 0);
    assert_eq!(ball(&row, &[0.5, 0.6, 1.0]), 2);
    let mut centres: Vec<[f64; 2]> =
        (0..100).map(|k| [f64::from(k % 20), f64::from(k / 20)]).collect();
    centres.push([9.5, 8.0]);
    let radii: Vec<f64> = (0..101).map(|k| if k == 100 { 2.0 } else { 0.5 }).collect();
    let mut soft = Soft::new(&of(&centres, &radii), Play::Penetration, 0.05).unwrap();
    let heights = (0..40).map(|k| soft.at(k).unwrap()[100][1]);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    assert!((1.5..6.3).contains(&lowest), "on the bed it would be at 6.5: {lowest}");
}

/// Golden: a change of these bits changes what records say of the same names.
#[test]
fn frames_have_the_same_bits_whoever_finds_the_couples() {
    let found = ["packed:dim=2,n=40,size-ratio=2", "packed:dim=3,n=40,size-ratio=2"].map(|text| {
        let scene = made(text);
        let given = scene.clone().into();
        PLAYS.map(|play| {
            let motion = Motion { kind: Kind::Soft(play), speed: 0.05, seed: 1 };
            let frame = Frames::new(&given, motion).unwrap().at(20).unwrap();
            let frame = digest(&numbers(&frame.scene));
            for detector in ["direct", "streamed-nbs:level=portable"] {
                let others = match &scene {
                    AnyScene::Plane(Stored::F64(scene)) => by(scene, play, detector),
                    AnyScene::Space(Stored::F64(scene)) => by(scene, play, detector),
                    _ => panic!("scenes are made in f64"),
                };
                assert_eq!(others, frame, "{text} {play:?} {detector}");
            }
            frame
        })
    });
    assert_eq!(found, GOLDEN, "{found:#x?}");
}

fn by<const D: usize>(scene: &Scene<'_, f64, D>, play: Play, detector: &str) -> u64
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let mut soft = Soft::new(scene, play, 0.05).unwrap();
    let detector = crate::detect::spec::parse(detector).unwrap().make(Options::default());
    let smallest = soft.first.iter().fold(1.0f64, |least, body| least.min(body.size));
    soft.near = Near::new(detector, smallest);
    digest(&soft.at(20).unwrap().iter().flat_map(|at| *array(at)).collect::<Vec<_>>())
}

const GOLDEN: [[u64; 3]; 2] = [
    [0x798dcf73f8128ecd, 0x3b275c6ff09eb023, 0xba5f20e9401cb9c6],
    [0x4fff5b3a44b1b02e, 0x8a1514da426822fe, 0x32102d6b91715e25],
];

#[test]
fn scenes_that_begin_in_each_other_neither_burst_nor_stop() {
    let crowd: Vec<[f64; 2]> = (0..30).map(|k| [0.01 * f64::from(k % 6), 0.0]).collect();
    let one_place = vec![[1e8, -1e8]; 20];
    let dust: Vec<f64> = (0..30).map(|k| if k == 7 { 1.0 } else { 1e-6 * f64::from(k) }).collect();
    for play in PLAYS {
        for (centres, radii) in [
            (&crowd[..], &vec![0.5; 30][..]),
            (&crowd, &dust),
            (&one_place, &[0.5; 20]),
            (&[[0.0, 0.0]], &[3e-300]),
            (&[[0.0, 0.0], [1.0, 0.0]], &[0.0, 1e-7]),
        ] {
            let mut soft = Soft::new(&of(centres, radii), play, 0.1).unwrap();
            let fastest = soft.stage.fastest();
            let far = soft.at(6).unwrap();
            assert!(far.iter().all(|at| at.iter().all(|x| x.is_finite())), "{play:?}");
            for body in &soft.last.as_ref().unwrap().1 {
                let speed = body::dot(&body.velocity, &body.velocity).sqrt();
                assert!(speed <= 1.1 * fastest, "{play:?}: {speed} of {fastest}");
            }
        }
    }
}

#[test]
fn what_cannot_be_simulated_is_refused_in_a_sentence() {
    let refused = |scene: &Scene<'_, f64, 2>, speed: f64| {
        Soft::new(scene, Play::Collapse, speed).err().unwrap().to_string()
    };
    let wide = of(&[[0.0, 0.0], [1e12, 0.0]], &[0.5, 0.5]);
    assert!(refused(&wide, 0.1).contains("wider than 1e9 diameters"));
    let beyond = of(&[[-1.7e308, 0.0], [1.7e308, 0.0]], &[1e300, 1e300]);
    assert!(refused(&beyond, 0.1).contains("wider than 1e9 diameters"));
    let away = of(&[[1e17, 1e17]], &[0.5]);
    assert!(refused(&away, 0.1).contains("or as far from the origin"));
    let fast = refused(&plane("packed:n=20"), 1e4);
    assert!(fast.contains("take a smaller speed") && fast.contains("steps of time"), "{fast}");
}
