//! Time of one detection, from raw coordinates to the complete list of pairs in a reused buffer,
//! for a dense packing of spheres in random order.
//!
//! `cargo bench -p contactbench-campaigns --bench detectors` prints nanoseconds per detection and
//! particles per second, for up to a million particles. The experiment `million` makes the paired
//! comparison with intervals; times printed here depend on the machine and are not checked.

use contactbench_core::contact::Test;
use contactbench_core::detect::Options;
use contactbench_core::detect::table::{Role, TABLE};
use contactbench_scenes::spec::Spec;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

fn detectors(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("packed spheres");
    group.sample_size(10);
    for n in [10_000u64, 1_000_000] {
        let scene = Spec::parse(&format!("packed:dim=3,n={n}"))
            .and_then(|spec| spec.make())
            .expect("the scene is a constant of this bench");
        group.throughput(Throughput::Elements(n));
        for entry in
            TABLE.iter().filter(|entry| entry.role == Role::Detector && entry.name != "direct")
        {
            let (mut detector, mut pairs) = (entry.make(Options::default()), Vec::new());
            group.bench_with_input(BenchmarkId::new(entry.name, n), &scene, |bencher, scene| {
                bencher.iter(|| {
                    pairs.clear();
                    detector
                        .list(scene, Test::Exact, &mut pairs)
                        .expect("a dense pack fits the default limit");
                    pairs.len()
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, detectors);
criterion_main!(benches);
