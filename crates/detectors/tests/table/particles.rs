use contactbench_detectors::book::screening::Screening;
use contactbench_ground::contact::{Arithmetic, StoredParticles};
use contactbench_ground::detect::any::run_stored;
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::probe::Tally;
use contactbench_ground::scene::{AnyScene, Radii, Scene};
use contactbench_terms::mix::splitmix64;

/// Many spheres nearly touch, so the number of exact tests depends on every rounding.
#[test]
fn counts_and_pairs_do_not_depend_on_the_type_of_particles() {
    let place = |k| [0, 20, 40].map(|bit| (splitmix64(k) >> bit) % 6).map(|x| x as f64 / 3.0);
    let centres: Vec<_> = (0..200).map(|k| place(k).into()).collect();
    let each = (0..200).map(|k| if k % 3 == 0 { 1.0 / 3.0 } else { 1.0 / 6.0 }).collect();
    for (radii, arithmetic) in [Radii::Uniform(1.0 / 6.0), Radii::Each(each)]
        .into_iter()
        .flat_map(|radii| Arithmetic::ALL.map(|arithmetic| (radii.clone(), arithmetic)))
    {
        let scene = AnyScene::from(Scene::new(centres.clone(), radii).unwrap());
        let AnyScene::Space(scene) = scene.stored(arithmetic).unwrap() else { continue };
        let (mut detector, test) = (Screening::with(Options::default()), arithmetic.test());
        let (mut any, mut fixed) = <[(Tally, Vec<_>); 2]>::default().into();
        let particles = StoredParticles::<3, false>::new(&scene, test).unwrap();
        detector.detect(particles, &mut any.0, &mut any.1).unwrap();
        run_stored(&mut detector, &scene, test, &mut fixed.0, &mut fixed.1).unwrap();
        assert!(any == fixed && !any.1.is_empty(), "{arithmetic:?}: {any:?}, {fixed:?}");
    }
}
