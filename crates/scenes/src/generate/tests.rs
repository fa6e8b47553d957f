use crate::spec::{GENERATORS, Spec};
use crate::stats::{hash, stats};
use crate::touching::in_any_box;
use contactbench_detectors::near::contacts;
use contactbench_detectors::oracle;
use contactbench_detectors::oracle::boxes;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic;
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Radii, Real, Stored, array};
use contactbench_ground::with_scene;
use contactbench_io::Given;

fn given(text: &str) -> Given {
    let given = Spec::parse(text).and_then(|spec| spec.given());
    given.unwrap_or_else(|error| panic!("{text}: {error:#}"))
}

pub(super) fn make(text: &str) -> AnyScene<'static> {
    given(text).open(text).unwrap()
}

fn in_box(text: &str) -> (Periodic<'static>, Vec<ImagePair>) {
    let periodic = given(text).periodic().unwrap().unwrap();
    let truth = boxes::truth(&periodic, Arithmetic::Exact, 1 << 30).unwrap();
    (periodic, truth.pairs)
}

/// Returns the squared distance and the squared sum of radii of each pair.
fn pairs(scene: &AnyScene<'_>) -> Vec<[f64; 2]> {
    let scene = scene.stored(Arithmetic::F64).unwrap();
    with_scene!(&scene, scene => {
        let mut pairs = Vec::new();
        for i in 0..scene.len() {
            for j in 0..i {
                let (a, b) = (array(&scene.centres()[i]), array(&scene.centres()[j]));
                let difference = a.iter().zip(b).map(|(p, q)| p.wide() - q.wide());
                let square: f64 = difference.map(|x| x * x).sum();
                let reach = scene.radius(i).wide() + scene.radius(j).wide();
                pairs.push([square, reach * reach]);
            }
        }
        pairs
    })
}

fn coordination(scene: &AnyScene<'static>) -> f64 {
    let contacts = pairs(scene).iter().filter(|[d, r]| d <= r).count() as u64;
    stats(&scene.clone().into(), contacts).coordination
}

// Hashes computed once, on x86-64 Linux. If one changes, a published scene has changed and new
// results must not be compared with old ones: this needs a new major version.
#[test]
fn the_bits_of_every_generator_are_fixed() {
    for line in include_str!("hashes.txt").lines() {
        let (text, expected) = line.split_once(' ').unwrap();
        assert_eq!(hash(&given(text)), expected, "{text}");
    }
}

#[test]
fn every_generator_makes_exactly_n() {
    for generator in GENERATORS.iter().filter(|generator| !generator.own_n) {
        let (name, sizes) = (generator.name, [0, 1, 2, 3, 4, 7, 8, 9, 26, 27, 28, 99, 100, 1000]);
        for (dim, n) in generator.dims.iter().flat_map(|dim| sizes.map(|n| (*dim, n))) {
            for order in ["shuffled", "generated", "morton"] {
                let scene = make(&format!("{name}:dim={dim},n={n},order={order}"));
                assert_eq!((scene.len(), scene.dim()), (n, dim as usize), "{name}");
                assert!(scene.largest_radius() == 0.5 && scene.uniform(), "{name}");
            }
        }
    }
}

fn plane(text: &str) -> Vec<[f64; 2]> {
    let AnyScene::Plane(Stored::F64(scene)) = make(text) else { panic!("made in the plane") };
    scene.centres().iter().map(|p| *array(p)).collect()
}

fn space(text: &str) -> Vec<[f64; 3]> {
    let AnyScene::Space(Stored::F64(scene)) = make(text) else { panic!("made in space") };
    scene.centres().iter().map(|p| *array(p)).collect()
}

#[test]
fn orders_are_permutations_and_morton_is_local() {
    assert_ne!(make("loose:seed=1,order=generated"), make("loose:seed=2,order=generated"));
    let sorted = |points: &[[f64; 2]]| {
        let mut bits: Vec<_> = points.iter().map(|p| p.map(f64::to_bits)).collect();
        bits.sort_unstable();
        bits
    };
    let orders = |text: &str| {
        let orders = ["generated", "shuffled", "morton"];
        let [generated, shuffled, morton] =
            orders.map(|order| plane(&format!("{text},order={order}")));
        assert_ne!(generated, shuffled, "{text}");
        let others = [&shuffled, &morton];
        assert!(others.iter().all(|other| sorted(other) == sorted(&generated)), "{text}");
        [shuffled, morton]
    };
    orders("clustered:n=1000");
    let [shuffled, morton] = orders("packed:n=1000,lattice=square,jitter=0,spacing=1");
    let path = |points: &[[f64; 2]]| -> f64 {
        let step = |ends: &[[f64; 2]]| (ends[0][0] - ends[1][0]).hypot(ends[0][1] - ends[1][1]);
        points.windows(2).map(step).sum::<f64>() / 999.0
    };
    let paths = [path(&morton), path(&shuffled)];
    assert!(paths[0] < 2.0 && paths[1] > 10.0, "{paths:?}");
    assert_eq!(morton[..4], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
}

/// Particles at the border have fewer neighbours, but most particles are inside.
#[test]
fn packings_and_lattices_have_their_neighbours() {
    let [plane, of_space] =
        [2, 3].map(|dim| coordination(&make(&format!("packed:n=4000,dim={dim}"))));
    assert!((3.2..4.0).contains(&plane) && (5.5..7.5).contains(&of_space), "{plane} {of_space}");
    for dim in [2, 3] {
        let pairs = pairs(&make(&format!("packed:n=500,dim={dim},jitter=0,spacing=0.75")));
        let least = pairs.iter().fold(9.0, |a: f64, b| a.min(b[0]));
        assert!((least.sqrt() - 0.75).abs() < 1e-12, "{least}");
    }
    let cubic =
        "packed:n=27,dim=3,jitter=0,lattice=cubic,spacing=0.97,diameter=0.5,order=generated";
    for (k, centre) in space(cubic).into_iter().enumerate() {
        assert_eq!(centre, [k % 3, k / 3 % 3, k / 9].map(|i| i as f64 * 0.97 * 0.5));
    }
}

#[test]
fn jitter_stays_in_its_bounds() {
    for diameter in [1.0, 0.25] {
        let [still, moved] = [0.0, 0.2].map(|jitter| {
            let of = format!("diameter={diameter},jitter={jitter}");
            space(&format!("packed:n=500,dim=3,order=generated,{of}"))
        });
        let apart = still.as_flattened().iter().zip(moved.as_flattened());
        let most = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most <= 0.2 * diameter + 1e-12 && most > 0.19 * diameter, "{most}");
    }
}

#[test]
fn loose_and_clustered_have_the_requested_fraction() {
    for dim in [2, 3] {
        for ratio in [1, 4] {
            let of = format!("dim={dim},fraction=0.05,size-ratio={ratio},diameter=3");
            let scene = make(&format!("loose:n=20000,{of}"));
            let fraction = stats(&scene.into(), 0).packing_fraction;
            assert!((0.045..0.0501).contains(&fraction), "{of}: {fraction}");
        }
        // At a fraction of 5%, a particle touches on average 4 · 5% others in 2D, and 8 · 5% in 3D.
        let expected = if dim == 2 { 0.2 } else { 0.4 };
        let mean = coordination(&make(&format!("loose:n=4000,dim={dim}")));
        assert!((mean / expected - 1.0).abs() < 0.15, "{dim}D: {mean}");
    }
    let [tight, loose] =
        [0, 1].map(|part| coordination(&make(&format!("clustered:n=3000,background={part}"))));
    assert!(loose < 0.06 && tight > 1.3, "{loose} {tight}");
}

/// In periodic boxes, lattices continue through the faces, and random scenes have as many contacts
/// as an infinite scene would.
#[test]
fn boxes_repeat() {
    use std::f64::consts::PI;
    let found = |text: &str| {
        let contacts = in_box(text).1.len() as u64;
        (contacts, stats(&given(text), contacts))
    };
    for (text, n, dim, neighbours, fraction) in [
        ("packed:n=32,dim=3", 32, 3, 12, PI / 18f64.sqrt()),
        ("packed:n=27,dim=3,lattice=cubic", 27, 3, 6, PI / 6.0),
        ("packed:n=36", 36, 2, 6, PI / 12f64.sqrt()),
        ("packed:n=25,lattice=square,diameter=3,offset=7", 25, 2, 4, PI / 4.0),
    ] {
        let (contacts, stats) = found(&format!("{text},periodic=true,jitter=0,spacing=0.99"));
        assert_eq!(contacts, n * neighbours / 2, "{text}");
        let expected = fraction / 0.99f64.powi(dim);
        assert!((stats.packing_fraction / expected - 1.0).abs() < 1e-12, "{text}");
    }
    for tilt in [0.0, 0.3, -7.5] {
        let text = format!("loose:dim=3,n=2000,fraction=0.2,periodic=true,tilt={tilt}");
        let stats = found(&text).1;
        assert!((stats.packing_fraction - 0.2).abs() < 1e-12);
        assert!((stats.coordination / 1.6 - 1.0).abs() < 0.1, "{}", stats.coordination);
    }
    // A tilted lattice also fits its images. Under `periodic=x` the top and bottom rows have no
    // images.
    assert_eq!(found("packed:n=36,periodic=true,tilt=1,jitter=0").0, 108);
    assert_eq!(found("packed:n=36,periodic=x,jitter=0").0, 108 - 2 * 6);
    let hash = |text: &str| hash(&given(text));
    assert_ne!(hash("loose:n=9,periodic=true"), hash("loose:n=9,periodic=x"));
    assert_eq!(hash("loose:n=9,periodic=none"), hash("loose:n=9"));
}

#[test]
fn clusters_have_their_width_and_number() {
    let of = "per-cluster=10000,background=0,width=3,order=generated";
    let plane = plane(&format!("clustered:n=10000,{of}")).into_iter().map(|centre| centre[1]);
    let space = space(&format!("clustered:n=10000,dim=3,{of}")).into_iter().map(|centre| centre[1]);
    for xs in [plane.collect::<Vec<_>>(), space.collect()] {
        let mean = xs.iter().sum::<f64>() / 1e4;
        let deviation = (xs.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 1e4).sqrt();
        let within = xs.iter().filter(|&&x| (x - mean).abs() < deviation).count();
        assert!((deviation - 3.0).abs() < 0.1, "{deviation}");
        assert!((6600..7050).contains(&within), "{within} of 10000; a normal has 6827");
    }
    // Width 0 makes 3 clusters of 30 coincident particles; the other 10 coincide with none.
    let pairs = pairs(&make("clustered:n=100,per-cluster=30,width=0"));
    assert_eq!(pairs.iter().filter(|[square, _]| *square == 0.0).count(), 3 * 30 * 29 / 2);
}

/// Returns the radii in generated order, for a largest radius of 1.
fn radii(text: &str) -> Vec<f64> {
    with_scene!(&make(&format!("{text},diameter=2")), scene => {
        let Radii::Each(radii) = scene.radii() else { panic!("{text}: one radius each") };
        radii.iter().map(|r| r.wide()).collect()
    })
}

pub(super) fn ascending_radii(text: &str) -> Vec<f64> {
    let mut radii = radii(text);
    radii.sort_by(f64::total_cmp);
    radii
}

#[test]
fn sizes_have_the_requested_distribution() {
    let even = radii("packed:n=2000,size-ratio=5");
    let mean = even.iter().sum::<f64>() / 2000.0;
    assert!(even.iter().all(|r| (0.2..=1.0).contains(r)) && (mean - 0.6).abs() < 0.02, "{mean}");
    // If radii from 1 to 10 have the density r^-3, the part (1 - r^-2) / (1 - 10^-2) is below r.
    let power = ascending_radii("loose:n=1001,size-ratio=10,sizes=power,exponent=-3");
    assert_eq!((power[0], power[1000]), (0.1, 1.0));
    for (k, r) in power.iter().enumerate() {
        let part = (1.0 - (10.0 * r).powi(-2)) / 0.99;
        assert!((part - k as f64 / 1000.0).abs() < 1e-9, "{k}: {r}");
    }
    // The density r^-1 gives equal numbers in each octave.
    let even = radii("clustered:n=3000,size-ratio=8,sizes=power,exponent=-1");
    let octave = even.iter().filter(|&&r| r > 0.25 && r <= 0.5).count();
    assert!((999..=1001).contains(&octave), "{octave}");
    for (dim, part) in [(2, 1.0 / (1.0 + 100.0 / 3.0)), (3, 1.0 / (1.0 + 1000.0 / 3.0))] {
        let of = format!("dim={dim},size-ratio=10,sizes=binary,share=0.25");
        let binary = radii(&format!("loose:n=20000,{of}"));
        let large = binary.iter().filter(|&&r| r == 1.0).count() as f64;
        assert!((large - 20_000.0 * part).abs() <= 1.0, "{dim}D: {large}");
        assert!(binary.iter().all(|&r| r == 1.0 || r == 0.1));
    }
    let lognormal = ascending_radii("packed:n=20000,size-ratio=16,sizes=lognormal");
    assert!(lognormal[0] >= 1.0 / 16.0 && lognormal[19_999] <= 1.0);
    let within = lognormal.iter().filter(|r| (0.125..0.5).contains(*r)).count() as f64 / 20_000.0;
    // One standard deviation is a factor of 2; the cut-off removes 4.6%.
    assert!((within - 0.6827 / 0.9545).abs() < 0.01, "{within}");
    let giants = radii("loose:n=500,size-ratio=1000,sizes=giants,giants=3");
    assert_eq!(giants.iter().filter(|&&r| r == 1.0).count(), 3);
    // The giants are spread over the particles.
    assert!(giants[..3].iter().any(|&r| r < 1.0));
    assert!(make("loose:n=100,sizes=power,exponent=-3").uniform(), "a ratio of 1 is one size");
}

#[test]
fn settled_particles_overlap_up_to_the_limit() {
    for (text, overlap) in [
        ("settled:n=2000,fraction=0.4,overlap=0", 0.0),
        ("settled:n=2000,dim=3,fraction=0.25,overlap=0", 0.0),
        ("settled:n=3000,dim=3,fraction=0.5,size-ratio=20,sizes=power,exponent=-3", 0.05),
        ("settled:n=3000,fraction=0.6,size-ratio=50,sizes=binary,share=0.4,overlap=0.2", 0.2),
    ] {
        let part = pairs(&make(text)).into_iter().map(|[square, reach]| (square / reach).sqrt());
        let deepest = part.fold(2.0, f64::min);
        // Some pairs are nearly at the least allowed distance, because the box is nearly full.
        let near = 1.0 - overlap - 1e-12..1.05 - overlap;
        assert!(near.contains(&deepest), "{text}: {deepest}");
    }
    let mut through_faces = 0;
    for (text, overlap) in [
        ("settled:n=1000,fraction=0.45,overlap=0,periodic=true", 0.0),
        ("settled:n=1000,fraction=0.45,overlap=0,periodic=true,tilt=0.37", 0.0),
        ("settled:n=500,fraction=0.4,overlap=0,periodic=y,tilt=-2.6", 0.0),
        ("settled:n=800,dim=3,fraction=0.3,overlap=0,periodic=true,tilt=1.5,diameter=0.1", 0.0),
        (
            "settled:n=1500,dim=3,fraction=0.5,size-ratio=20,sizes=power,exponent=-3,periodic=xz",
            0.05,
        ),
        ("settled:n=1500,fraction=0.6,size-ratio=50,sizes=binary,share=0.4,periodic=x", 0.05),
        // The grid has a single cell here.
        ("settled:n=2,fraction=0.4,overlap=0,periodic=true,tilt=0.5", 0.0),
        ("settled:n=3,dim=3,fraction=0.9,overlap=0.4,periodic=true", 0.4),
    ] {
        for seed in 1..4 {
            let (scene, pairs) = in_box(&format!("{text},seed={seed}"));
            let depths = pairs.iter().map(|&pair| periodic::depth(&scene, pair));
            let deepest = depths.fold(0.0, f64::max);
            // Depths are overlaps in mean radii.
            assert!(deepest <= 2.0 * overlap + 1e-12, "{text}: {deepest}");
            through_faces += pairs.iter().filter(|pair| pair.image != [0; 3]).count();
        }
    }
    assert!(through_faces > 100, "{through_faces}");
}

/// Random places have the number of pairs that was asked for, and lattices that of the nearest
/// shell. No pair just touches, so lists with `<` and with `<=` are equal.
#[test]
fn neighbours_are_as_many_as_asked_for() {
    let lattice = "packed:n=864,dim=3,jitter=0,periodic=true";
    let random = "settled:n=150,dim=3,periodic=true,tilt=-0.3,fraction=0.2";
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let liquid = format!("file:path={root}/examples/liquid/liquid.xyz,radius=0.5");
    for (text, neighbours) in [
        (lattice, &[(6.0, 12.0), (14.0, 12.0), (40.0, 42.0), (64.0, 54.0), (113.0, 134.0)][..]),
        ("packed:n=36,jitter=0,periodic=true,offset=1e3", &[(2.9, 0.0), (3.0, 6.0), (13.0, 12.0)]),
        (random, &[(0.5, 76.0 / 150.0), (40.0, 40.0), (816.0, 816.0)]),
        (&liquid, &[(14.0, 14.0), (40.0, 40.0)]),
        ("loose:n=300,periodic=x,size-ratio=3", &[(6.0, 6.0), (250.0, 250.0)]),
        ("clustered:n=200,dim=3,diameter=1e-3", &[(14.0, 14.0), (199.0, 199.0)]),
    ] {
        for &(wanted, expected) in neighbours {
            let given = given(&format!("{text},neighbours={wanted}"));
            assert_eq!(given.source, None, "{text}");
            let scene = in_any_box(&given).unwrap();
            for by in [1.0 - 1e-10, 1.0, 1.0 + 1e-10] {
                let pairs = contacts(&scene.resized(|r| r * by).unwrap(), 1 << 30).unwrap();
                let each = 2.0 * pairs.len() as f64 / scene.scene().len() as f64;
                assert_eq!(each, expected, "{text}, {wanted}, {by}");
            }
        }
    }
}

/// The packs of the book: for any n and dyadic D, neighbours that should be D apart are exactly D
/// apart.
#[test]
fn book_packs_touch_exactly() {
    for (diameter, n) in
        [1.0, 0.125, 4.0].into_iter().flat_map(|d| [1usize, 2, 10, 100, 1000].map(|n| (d, n)))
    {
        let columns = (1..).find(|c| c * c >= n).unwrap_or(1);
        let rows = (0..n.div_ceil(columns)).map(|row| columns.min(n - row * columns));
        let along: usize = rows.clone().map(|r| r - 1).sum();
        let halves: usize = rows.clone().map(|r| r / 2).sum();
        for (pack, touching) in [
            ("pack-a:", along),
            ("pack-b:s=1,", along),
            ("pack-b:s=1.5,", 0),
            ("pack-c:s=1,", along + n - columns.min(n)),
            ("pack-c:s=200,", 0),
            ("pack-d:s=3,", halves),
            ("pack-d:s=1,", along),
        ] {
            let pairs = pairs(&make(&format!("{pack}n={n},diameter={diameter}")));
            let least = diameter * diameter;
            let exact = pairs.iter().filter(|[square, _]| *square == least).count();
            assert_eq!(exact, touching, "{pack}n={n}, diameter {diameter}");
            assert!(pairs.iter().all(|[square, _]| *square >= least));
        }
    }
    let places = plane("pack-d:n=10,s=3,diameter=2,order=generated");
    assert_eq!(places[..5], [[0.0, 0.0], [2.0, 0.0], [8.0, 0.0], [10.0, 0.0], [0.0, 4.0]]);
}

/// Every pair just touches, no other particles do, and textbook filters miss some pairs if
/// coordinates are rounded.
#[test]
fn tangent_pairs_touch_and_textbook_filters_lose_them() {
    use contactbench_detectors::table;
    use contactbench_ground::contact::Test;
    use contactbench_ground::detect::Options;
    for (text, lossy) in [
        ("couples:n=2000", false),
        ("couples:n=2000,dim=3,diameter=0.1,offset=-10", true),
        ("couples:n=2000,diameter=0.1,offset=-1e6", true),
    ] {
        let scene = make(text);
        let truth = |arithmetic| oracle::truth(&scene, arithmetic).unwrap().digest.contacts;
        assert_eq!(truth(Arithmetic::Exact), 1000, "{text}");
        let (rounded, mut found) =
            (truth(Arithmetic::Textbook), contactbench_ground::pairs::sink::Count::default());
        let mut nbs = table::find("nbs").unwrap().make(Options::default());
        nbs.visit(&scene, Test::Textbook, &mut found).unwrap();
        assert_eq!(found.0 < rounded, lossy, "{text}: {} of {rounded}", found.0);
    }
}
