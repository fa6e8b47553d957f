use contactbench_detectors::spec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::periodic::{ContactList, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_lists::searcher::Searcher;

/// Images made for a box are freed when a scene in open space follows.
#[test]
fn open_space_keeps_no_images_of_an_earlier_box() {
    let scene = || AnyScene::at([0.5, 4.0, 7.5].map(|x| [x, 1.0]), 0.5).unwrap();
    let lattice = Lattice::along_axes([8.0, 8.0, 1.0], [true, true, false]).unwrap();
    let boxed = Loaded::InBox(Periodic::new(scene(), lattice).unwrap());
    let open = Loaded::Open(scene());
    let bytes = |scenes: &[&Loaded<'_>]| {
        let mut searcher = Searcher::new(spec::parse("nbs").unwrap().make(Options::default()));
        for scene in scenes {
            searcher.list(scene, Arithmetic::Exact, &mut ContactList::default()).unwrap();
        }
        searcher.formula_bytes()
    };
    assert!(bytes(&[&boxed]) > bytes(&[&open]));
    assert_eq!(bytes(&[&boxed, &open]), bytes(&[&open]));
}
