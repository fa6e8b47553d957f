//! Compares the contacts of a scene on several ranks with those that one process finds: for all
//! generators and hard cases, in boxes and in open space, with all detectors.

use contactbench::scene::Given;
use contactbench::scene::hard::{Expect, cases};
use contactbench::scene::spec::Spec;
use contactbench_detectors::spec::parse;
use contactbench_detectors::table::TABLE;
use contactbench_ranks::rank::Failure;
use contactbench_ranks::share::Share;
use contactbench_ranks::world::{World, threads};
use contactbench_ranks::{RankResults, Setting, measure, whole};

const MEMORY: u64 = 1 << 28;

/// Small scenes of all kinds: touching lattices, different sizes, boxes smaller than a diameter.
const SCENES: [&str; 12] = [
    "packed:n=0",
    "packed:n=300",
    "packed:dim=3,n=300,spacing=1,jitter=0,lattice=cubic",
    "packed:dim=3,n=300,size-ratio=3",
    "loose:n=300,fraction=0.6,size-ratio=20",
    "loose:dim=3,n=300,sizes=giants,giants=3,size-ratio=100",
    "clustered:dim=3,n=300,per-cluster=50",
    "couples:n=100,diameter=0.1,offset=-1000",
    "packed:n=100,spacing=1,jitter=0,lattice=square,periodic=true",
    "loose:dim=3,n=3,fraction=0.9,tilt=-0.375,periodic=true",
    "loose:dim=3,n=300,fraction=0.3,size-ratio=4,periodic=xy",
    "clustered:n=300,per-cluster=20,size-ratio=5,periodic=true",
];

fn ask(given: &Given, detector: &str, ranks: usize) -> Result<RankResults, Failure> {
    let spec = parse(detector).unwrap();
    let setting = Setting { spec: &spec, memory_limit: MEMORY, steps: 1 };
    let rows = threads(ranks, |world| {
        measure(world, "threads", "scene", Share::of(given, world.rank(), ranks), setting)
    });
    let rows: Result<Vec<RankResults>, Failure> = rows.unwrap().into_iter().collect();
    rows.map(|rows| rows.into_iter().next().unwrap())
}

#[test]
fn ranks_find_the_contacts_of_one_process() {
    let direct = parse("direct").unwrap();
    let detectors: Vec<&str> =
        TABLE.iter().filter(|entry| entry.must_be_right()).map(|entry| entry.name).collect();
    let hard = cases().filter(|case| case.expect != Expect::Invalid).flat_map(|case| {
        case.dims.iter().map(|dim| format!("hard:case={},dim={dim},order=generated", case.name))
    });
    let scenes = SCENES.iter().map(|scene| scene.to_string()).chain(hard);
    let (mut answers, mut refused, mut sent) = (0, 0, 0);
    for (k, scene) in scenes.enumerate() {
        let given = Spec::parse(&scene).unwrap().given().unwrap();
        let setting = Setting { spec: &direct, memory_limit: MEMORY, steps: 1 };
        let Ok(truth) = whole(&given, setting) else { continue };
        // Every second detector is tested with three ranks, and one with all other numbers.
        let turn = detectors[k % detectors.len()];
        let others = [1, 2, 4, 8].map(|ranks| (turn, ranks));
        let half = detectors.iter().skip(k % 2).step_by(2).map(|&name| (name, 3));
        for (detector, ranks) in half.chain(others) {
            match ask(&given, detector, ranks) {
                Ok(row) => {
                    let found = row.found;
                    assert_eq!(found, truth, "{detector}, {ranks} ranks: {scene}");
                    assert!(row.ranks == ranks && row.n == given.scene.len() as u64);
                    sent += row.sent;
                }
                // A detector with cells may refuse on ranks alone: the whole scene has few large
                // cells, but a slab of dust has many small ones.
                Err(_) => refused += 1,
            }
            answers += 1;
        }
    }
    println!("{answers} answers, {refused} refused, {sent} particles sent");
    assert!(answers > 3_000 && refused < answers / 20 && sent > 100_000);
}
