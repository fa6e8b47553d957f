use contactbench_detectors::table::TABLE;
use contactbench_ground::contact::Test;
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::normalise::normalise;
use contactbench_ground::scene::AnyScene;
use contactbench_terms::mix::splitmix64;

/// From 30,000 particles on, `streamed-nbs` uses several threads.
#[test]
fn several_threads_find_the_contacts_of_one() {
    for entry in TABLE.iter().filter(|entry| entry.threads) {
        let n = if entry.name == "direct" { 1500 } else { 31_000 };
        let centre = |k: u32| {
            let at = |salt: u64| (splitmix64(u64::from(k) ^ salt << 40) % 2900) as f64 / 20.0;
            [at(1), at(2)]
        };
        let scene = AnyScene::at((0..n).map(centre), 0.3).unwrap();
        let found = [1, 2, 3].map(|threads| {
            let mut pairs = Vec::new();
            let options = Options { threads, ..Options::default() };
            entry.make(options).list(&scene, Test::Exact, &mut pairs).unwrap();
            normalise(&mut pairs);
            pairs
        });
        assert!(found[0].len() > 10, "{}: {}", entry.name, found[0].len());
        assert!(found[0] == found[1] && found[0] == found[2], "{}", entry.name);
    }
}
