//! How long frames of the adversarial scenes take at each deadline, on the thread's processor.
//!
//! Goals: a median to watch while one works on what is cut, and on the order in which it is cut.
//! Not goals: misses, errors and the worst case, which need a hundred thousand frames and a reference:
//! `cargo run --release -p palpable-lab -- deadline`, which plays the same scenes.
//!
//! `cargo bench -p palpable-lab --bench deadline`. Prices are measured first, in a few seconds.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion};
use palpable_lab::deadline::{DEADLINES_US, Kit, Trial, calibrate, play};
use palpable_lab::hand::Hand;

/// Frames of each scene that prices are measured by.
const CALIBRATED: u32 = 100;

fn main() {
    let kit = Kit::new(Hand::load().expect("the hand is in a package"));
    let found = calibrate(&kit, CALIBRATED, || ()).expect("the trials can be played");
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    for trial in Trial::ALL {
        let mut group = criterion.benchmark_group(trial.name());
        for deadline_us in DEADLINES_US.map(Some).into_iter().chain([None]) {
            let name = deadline_us.map_or("none".into(), |us| format!("{us} us"));
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
                bencher.iter_custom(|frames| {
                    let frames = black_box(frames as u32);
                    play::time(&kit, trial, frames, deadline_us, &found.prices).expect("it plays")
                });
            });
        }
        group.finish();
    }
    criterion.final_summary();
}
