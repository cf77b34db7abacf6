use palpable_lab::avatar::motions::*;
use palpable_lab::avatar::*;
use palpable_lab::figures::{Figure, play::play, scenes};
fn main() {
    for style in [Style::Capsules, Style::Hulls] {
        let plan = AvatarPlan::new(MOTION_HEIGHT_M, style, Trunk::Rigid);
        let figure = Figure::of_avatar(&plan);
        for kind in MotionKind::ALL {
            let scene = scenes::of_motion(&figure, kind, scenes::AVATAR_OPTIONS);
            let p = play(&scene, || {}).unwrap();
            let m = |f: &dyn Fn(&palpable_lab::figures::play::Sample) -> f64| {
                p.samples.iter().map(f).fold(0.0, f64::max)
            };
            let mut t: Vec<f64> = p.samples.iter().map(|s| s.time_us).collect();
            t.sort_by(f64::total_cmp);
            println!(
                "{style:?} {:24} fixed {:.4} own {:.4} mm jump {:.2} (wanted {:.2}) deg root {:.2} mm beyond {:.2e} steps max {} sum {} units max {} time med {:.1} p99 {:.1} max {:.1} flags {:x}",
                p.name,
                m(&|s| s.fixed_mm),
                m(&|s| s.own_mm),
                m(&|s| s.jump_deg),
                m(&|s| s.wanted_jump_deg),
                m(&|s| s.root_mm),
                m(&|s| s.beyond_rad),
                m(&|s| s.steps as f64),
                p.samples.iter().map(|s| s.steps).sum::<u32>(),
                m(&|s| s.units as f64),
                t[t.len() / 2],
                t[t.len() * 99 / 100],
                t[t.len() - 1],
                p.samples.iter().fold(0, |a, s| a | s.flags)
            );
        }
    }
    let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
    let figure = Figure::of_avatar(&plan);
    let (mut worst, mut own) = (0.0f64, 0.0f64);
    for s in &slaps(1) {
        let p = play(&scenes::of_slap(&figure, s), || {}).unwrap();
        worst = worst.max(p.samples.iter().map(|s| s.fixed_mm).fold(0.0, f64::max));
        own = own.max(p.samples.iter().map(|s| s.own_mm).fold(0.0, f64::max));
    }
    println!("slaps worst {worst} own {own}");
}
