//! How long things take here and now.
//!
//! Goals: ratios between two versions on one quiet machine (`cargo bench --bench stages -- --save-baseline
//! before`, then `-- --baseline before`), and figures to read beside the instruction counts.
//! Not goals: a limit that a shared machine could miss, the worst case (a median says nothing of
//! it), and comparisons between machines.
//!
//! Before anything is measured, the hash of what every scene comes to is printed. A version that is
//! faster and prints other hashes computes something else; look at `tests/golden.rs` then.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/pairs.rs"]
mod pairs;
#[path = "../tests/common/scenes.rs"]
mod scenes;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion};
use palpable::geometry::penetration::core_penetration;
use palpable::recording::Sink;

use pairs::{APART_M, Class, SHALLOW_M};
use scenes::Scene;

/// Frames of one sample: those that the instruction counts count.
const FRAMES: u32 = 10;

/// Name, scene, and how many frames pass before the measured ones.
type Case = (&'static str, fn() -> Scene, u32);

const CASES: [Case; 8] = [
    ("empty", scenes::empty, 0),
    ("free hand beside 0", || scenes::free_hand(0), 30),
    ("free hand beside 16", || scenes::free_hand(16), 30),
    ("free hand beside 56", || scenes::free_hand(56), 30),
    ("free hand beside 64", || scenes::free_hand(64), 30),
    ("pressed hand at rest", scenes::pressed_hand, 120),
    ("slid hand", scenes::slid_hand, 60),
    ("rolling sphere", scenes::rolling_sphere, 60),
];

fn main() {
    for (name, make, before) in CASES {
        let hash = make().after(before + FRAMES).world.hash();
        println!("state {hash:016x} after {name}");
    }
    let mut criterion = Criterion::default().configure_from_args();
    geometry(&mut criterion);
    frames(&mut criterion);
    recording(&mut criterion);
    criterion.final_summary();
}

fn geometry(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("separation");
    for (name, class) in Class::ALL {
        for (how, gap_m) in [("apart", APART_M), ("shallow", SHALLOW_M)] {
            let pair = class.at_gap(gap_m);
            group.bench_function(format!("{name} {how}, cold"), |bencher| {
                bencher.iter(|| black_box(&pair).ask());
            });
            group.bench_function(format!("{name} {how}, warm"), |bencher| {
                bencher.iter(|| black_box(&pair).ask_again());
            });
        }
    }
    let pair = Class::Hulls32.at_gap(SHALLOW_M);
    let a_in_b = pair.poses[0].seen_from(&pair.poses[1]);
    group.bench_function("hulls of 32 shallow, enumeration", |bencher| {
        bencher.iter(|| core_penetration(&pair.a, &pair.b, black_box(&a_in_b)));
    });
    group.finish();
}

/// Ten frames a sample, each sample from the same snapshot: a scene that runs on comes to rest.
fn frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ten frames");
    for (name, make, before) in CASES {
        ten_frames(&mut group, name, make().after(before));
    }
    group.finish();
}

/// The same with a sink that lets go of everything: what recording costs, less the copy that a host makes.
fn recording(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ten recorded frames");
    for (name, make, before) in CASES {
        let mut scene = make().after(before);
        let sink: &'static mut dyn Sink = Box::leak(Box::new(|bytes: &[u8]| {
            black_box(bytes);
        }));
        scene.world.record_to(sink);
        ten_frames(&mut group, name, scene);
    }
    let scene = scenes::empty();
    group.bench_function("hash of a state with room for a room", |bencher| {
        bencher.iter(|| black_box(&scene.world).hash());
    });
    group.finish();
}

fn ten_frames(group: &mut BenchmarkGroup<WallTime>, name: &str, mut scene: Scene) {
    let first = scene.frame;
    let mut start = vec![0; scene.world.snapshot_bytes()];
    scene.world.save(&mut start).unwrap();
    group.bench_function(name, |bencher| {
        bencher.iter_custom(|samples| {
            let mut time = Duration::ZERO;
            for _ in 0..samples {
                scene.world.load(&start).unwrap();
                scene.frame = first;
                let begun = Instant::now();
                for _ in 0..FRAMES {
                    black_box(scene.step());
                }
                time += begun.elapsed();
            }
            time
        });
    });
}
