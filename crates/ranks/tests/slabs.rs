//! Slabs and the data sent between them, on scenes for which both can be predicted.

use contactbench_detectors::spec::parse;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::periodic::{ContactList, ImagePair, without_shift};
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Scene};
use contactbench_lists::searcher::Searcher;
use contactbench_ranks::particles::Numbered;
use contactbench_ranks::rank::{Failure, Rank, Traffic, together};
use contactbench_ranks::world::{Thread, World, threads};
use contactbench_terms::mix::splitmix64;

const OPTIONS: Options = Options { memory_limit: 1 << 26, threads: 1 };

/// Result of a rank: contacts in numbers of the whole scene, digest, data sent, and halo size.
type Found = (Vec<ImagePair>, Digest, Traffic, usize);

/// Runs several ranks, each of which starts with consecutive particles of the scene.
fn ask<const D: usize>(
    scene: &Scene<'_, f64, D>,
    lattice: Option<Lattice>,
    detector: &str,
    ranks: usize,
) -> Result<Vec<Found>, Failure>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let spec = parse(detector).unwrap();
    threads(ranks, |world| {
        let n = scene.len();
        let rows = n * world.rank() / ranks..n * (world.rank() + 1) / ranks;
        let order: Vec<u32> = (rows.start as u32..rows.end as u32).collect();
        let particles = Numbered::new(&scene.reordered(&order), rows.start as u64)?;
        let mut rank = Rank::new(world, particles, lattice)?;
        let mut searcher = Searcher::new(spec.make(OPTIONS));
        let mut contacts = ContactList::default();
        let mut traffic = Traffic::default();
        for _ in 0..2 {
            traffic = rank.refresh(world)?;
            together(world, rank.search(&mut searcher, &mut contacts))?;
        }
        let plain = without_shift(&contacts.plain);
        let pairs = plain.chain(contacts.shifted.iter().copied());
        let named = |p: ImagePair| ImagePair::new(rank.id(p.i), rank.id(p.j), p.image);
        Ok((pairs.map(named).collect(), rank.digest(&contacts), traffic, rank.halo()))
    })
    .unwrap()
    .into_iter()
    .collect()
}

fn whole<const D: usize>(
    scene: &Scene<'_, f64, D>,
    lattice: Option<Lattice>,
) -> Result<Vec<ImagePair>, Refusal>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let mut searcher = Searcher::new(parse("direct").unwrap().make(OPTIONS));
    let mut contacts = ContactList::default();
    let loaded = Loaded::new(&scene.clone().into(), lattice, Arithmetic::Exact).unwrap();
    searcher.list(&loaded, Arithmetic::Exact, &mut contacts)?;
    contacts.sorted(scene.len(), u64::MAX)
}

/// Asserts that the ranks find each contact once. Returns the number of contacts, and the number of
/// contacts with a halo particle.
fn agree<const D: usize>(
    scene: &Scene<'_, f64, D>,
    lattice: Option<Lattice>,
    detector: &str,
    about: &dyn std::fmt::Debug,
) -> [u64; 2]
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let expected = whole(scene, lattice);
    let differ = (1..scene.len()).any(|k| scene.radius(k) != scene.radius(0));
    let mut seen = [0; 2];
    for ranks in [1, 2, 3, 4, 8] {
        let found = ask(scene, lattice, detector, ranks);
        let (found, expected) = match (found, &expected) {
            (Ok(found), Ok(expected)) => (found, expected),
            (Err(_), Err(_)) => continue,
            (found, expected) => panic!("{detector}, {ranks}: {found:?}, {expected:?}, {about:?}"),
        };
        let mut pairs: Vec<ImagePair> = found.iter().flat_map(|rank| &rank.0).copied().collect();
        pairs.sort_unstable();
        assert_eq!(pairs, *expected, "{detector}, {ranks} ranks: {about:?}");
        let mut digest = Digest::default();
        expected.iter().for_each(|pair| digest.image(pair.i, pair.j, pair.image));
        let sum = found.iter().fold(Digest::default(), |sum, rank| Digest {
            contacts: sum.contacts + rank.1.contacts,
            sum: sum.sum.wrapping_add(rank.1.sum),
        });
        assert_eq!(sum, digest);
        let each = 4 + 8 * (D as u64 + u64::from(differ));
        for (_, _, traffic, _) in &found {
            assert_eq!(traffic.bytes, traffic.particles * each);
            assert!(traffic.partners < ranks as u64);
        }
        let sent: u64 = found.iter().map(|rank| rank.2.particles).sum();
        let got: usize = found.iter().map(|rank| rank.3).sum();
        assert_eq!(sent, got as u64);
        // The first rank sends nothing below it, and no rank sends to itself.
        assert_eq!(found[0].2, Traffic::default());
        assert!(ranks > 1 || got == 0);
        seen = [seen[0] + expected.len() as u64, seen[1] + sent];
    }
    seen
}

/// The scene is a touching lattice, on which borders of slabs coincide with many particles.
#[test]
fn borders_at_particles_separate_them() {
    let at = |k: usize| nalgebra::Point::from([(k % 12) as f64, (k / 12) as f64]);
    let centres: Vec<_> = (0..60).map(at).collect();
    let scene = Scene::new(centres, Radii::Uniform(0.5)).unwrap();
    let found = ask(&scene, None, "nbs", 4).unwrap();
    let pairs: usize = found.iter().map(|rank| rank.0.len()).sum();
    assert_eq!(pairs, 11 * 5 + 12 * 4);
    // There are columns of five particles. Each rank but the first sends its lowest column and the
    // next one, which is just within reach of the border.
    assert_eq!(found.iter().map(|rank| rank.2.particles).collect::<Vec<_>>(), [0, 10, 10, 10]);
    let cylinder = Lattice::along_axes([12.0, 1.0, 1.0], [true, false, false]).unwrap();
    let found = ask(&scene, Some(cylinder), "nbs", 4).unwrap();
    let pairs: usize = found.iter().map(|rank| rank.0.len()).sum();
    assert_eq!(pairs, 12 * 5 + 12 * 4);
    // The last rank also sends its highest column to the first.
    assert_eq!(found.iter().map(|rank| rank.2.particles).collect::<Vec<_>>(), [0, 10, 10, 15]);
}

/// Rows of the lattice are as long as the stride of the sample, which must not fall on one column.
#[test]
fn a_lattice_is_divided_evenly_for_any_row_length() {
    let at = |k: usize| nalgebra::Point::from([k % 64, k / 64 % 16, k / 1024].map(|x| x as f64));
    let centres: Vec<_> = (0..64 * 16 * 32).map(at).collect();
    let scene = Scene::new(centres, Radii::Uniform(0.5)).unwrap();
    let own = threads(2, |world| {
        let rows: Vec<u32> = if world.rank() == 0 { (0..64 * 16 * 32).collect() } else { vec![] };
        let particles = Numbered::new(&scene.reordered(&rows), 0).unwrap();
        Rank::new(world, particles, None).unwrap().own()
    });
    for own in own.unwrap() {
        assert!((13_000..20_000).contains(&own), "{own}");
    }
}

/// A giant is larger than all slabs, the rest is dust: only particles near the giant are sent far.
#[test]
fn a_particle_larger_than_slabs_is_sent_to_all_it_reaches() {
    for place in [0.0, 50.0, 100.0] {
        let mut centres: Vec<_> =
            (0..=100).map(|k| nalgebra::Point::from([k as f64, 0.0])).collect();
        let mut radii = vec![0.25; 101];
        centres.push([place, 30.0].into());
        radii.push(40.0);
        let scene = Scene::new(centres, Radii::Each(radii.into())).unwrap();
        let [contacts, sent] = agree(&scene, None, "streamed-nbs", &place);
        assert!(contacts > 100 && sent < 3 * contacts, "{contacts} {sent}");
    }
}

#[test]
fn a_refusal_of_one_rank_ends_all() {
    let failures = threads(3, |world| {
        let refused = Refusal::Exhausted { bytes: 1 };
        together(world, if world.rank() == 1 { Err(Failure::Here(refused)) } else { Ok(()) })
    })
    .unwrap();
    let here = Failure::Here(Refusal::Exhausted { bytes: 1 });
    assert_eq!(failures, [Err(Failure::Elsewhere(1)), Err(here), Err(Failure::Elsewhere(1))]);
    let scene = Scene::new(vec![nalgebra::Point::from([0.0, 0.0])], Radii::Uniform(1.0)).unwrap();
    let last = u64::from(u32::MAX);
    assert!(Numbered::new(&scene, last - 1).is_ok());
    assert!(matches!(Numbered::new(&scene, last), Err(Failure::Scene(_))));
}

#[test]
fn ranks_with_different_scenes_fail() {
    fn of<const D: usize>(world: &Thread, lattice: Option<Lattice>) -> Option<Failure>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        Rank::<D>::new(world, Numbered::default(), lattice).err()
    }
    let plane = |length| Lattice::along_axes([length, 9.0, 1.0], [true, true, false]).unwrap();
    let dimensions = |world: &Thread| match world.rank() {
        0 => of::<2>(world, Some(plane(9.0))),
        _ => of::<3>(world, None),
    };
    let boxes = |world: &Thread| of::<2>(world, Some(plane([8.0, 9.0, 9.0][world.rank()])));
    let missing = |world: &Thread| of::<2>(world, (world.rank() < 2).then(|| plane(9.0)));
    let unlike = |what| vec![Some(Failure::Unlike(what)); 3];
    assert_eq!(threads(3, dimensions).unwrap(), unlike("its dimension"));
    assert_eq!(threads(3, boxes).unwrap(), unlike("its box"));
    assert_eq!(threads(3, missing).unwrap(), unlike("its box"));
}

/// Particles far from the box have inaccurate places; those in contact must be sent all the same.
#[test]
fn tangent_particles_many_boxes_away_are_sent() {
    // Fractions along the vector are multiples of 1/10, not doubles; coordinates are doubles.
    let cylinder = Lattice::along_axes([5.0, 9.0, 1.0], [true, false, false]).unwrap();
    for seed in 0..20 {
        let away = |k: u64| (splitmix64(seed << 8 ^ k) % 2001) as f64 - 1000.0;
        let centres: Vec<_> = (0..10u64)
            .map(|k| nalgebra::Point::from([0.5 * k as f64 + 5.0 * away(k), 0.5]))
            .collect();
        let scene = Scene::new(centres, Radii::Uniform(0.25)).unwrap();
        let [contacts, _] = agree(&scene, Some(cylinder), "direct", &seed);
        assert_eq!(contacts, 5 * 10);
    }
}

/// The extent of this scene overflows.
#[test]
fn slabs_lie_along_the_longest_axis_however_long() {
    let centres = [[-1.2e308, -1.7e308], [1.2e308, 1.7e308]].map(nalgebra::Point::from);
    let scene = Scene::new(centres.to_vec(), Radii::Uniform(1.0)).unwrap();
    let direction = threads(2, |world| {
        let rows: &[u32] = if world.rank() == 0 { &[0, 1] } else { &[] };
        let particles = Numbered::new(&scene.reordered(rows), 0).unwrap();
        Rank::new(world, particles, None).unwrap().slabs().direction()
    });
    assert_eq!(direction.unwrap(), [(1, false); 2]);
}
