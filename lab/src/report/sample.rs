//! Made-up reports with the shape of real ones.

use super::{
    ArmSlaps, Ball, FigureFrame, FigureScene, FirstContact, FrameSample, HandCoverage, Machine,
    Phase, Quantiles, Report, Rest, Run, Wrist,
};

/// Name, number of frames, typical frame time in microseconds, typical number of contacts.
type Plan = (&'static str, u32, f64, f64);

pub const PAPER_PHASES: [Plan; 4] = [
    ("idle", 903, 2.1, 0.0),
    ("slide there", 900, 34.0, 9.0),
    ("slide back", 850, 31.0, 8.0),
    ("push the ball (free set)", 1000, 44.0, 12.0),
];

pub fn report() -> Report {
    let runs = [
        ("ball as sphere, no noise", Ball::Sphere, false),
        ("ball as sphere, noise", Ball::Sphere, true),
        ("ball as hull, no noise", Ball::Hull, false),
        ("ball as hull, noise", Ball::Hull, true),
    ];
    let runs = runs.into_iter().zip(1..);
    Report {
        title: "Palpable: the hand in the art gallery".to_owned(),
        slaps: Some(super::Slaps {
            slaps: 60,
            parts_behind: 0,
            overlap_mm_max: 0.0,
        }),
        machine: Machine::detect(),
        hand: HandCoverage {
            parts: 18,
            uncovered_share: 0.0123,
            uncovered_mm_max: 1.84,
            sticking_out_mm_max: 3.21,
            sticking_out_mm_mean: 0.412,
        },
        runs: runs
            .map(|((name, ball, noise), seed)| run(name, ball, noise, seed, &PAPER_PHASES))
            .collect(),
        figures: Vec::new(),
        arm_slaps: None,
    }
}

pub fn run(name: &str, ball: Ball, noise: bool, seed: u64, plans: &[Plan]) -> Run {
    let mut chance = Chance(seed);
    let mut run = Run {
        name: name.to_owned(),
        ball,
        noise,
        frames: plans.iter().map(|plan| plan.1).sum(),
        beyond_walls: 0,
        state_hash: format!("{:016x}", seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)),
        phases: Vec::new(),
        samples: Vec::new(),
    };
    for plan in plans {
        let first_frame = run.samples.len() as u32;
        let samples: Vec<FrameSample> = (first_frame..first_frame + plan.1)
            .map(|frame| sample(frame, plan, &mut chance))
            .collect();
        run.phases.push(phase(plan.0, first_frame, &samples));
        run.samples.extend(samples);
    }
    run
}

fn sample(frame: u32, plan: &Plan, chance: &mut Chance) -> FrameSample {
    let wave =
        1.0 + 0.35 * (f64::from(frame) * 0.013).sin() + 0.2 * (f64::from(frame) * 0.11).sin();
    let spike = if chance.next() < 0.006 {
        2.0 + 8.0 * chance.next()
    } else {
        1.0
    };
    let contacts = (plan.3 * wave + 1.5 * chance.next()) as u32 * u32::from(plan.3 > 0.0);
    FrameSample {
        frame,
        time_us: short(plan.2 * wave * spike * (0.8 + 0.5 * chance.next())),
        contacts,
        impulses: if plan.3 > 10.0 {
            (f64::from(contacts) * 2.5 * chance.next()) as u32
        } else {
            0
        },
        units: u64::from(40 + contacts * 31),
        overlap_mm: short(0.08 * chance.next() * f64::from(contacts.min(1))),
    }
}

fn phase(name: &str, first_frame: u32, samples: &[FrameSample]) -> Phase {
    let mut times: Vec<f64> = samples.iter().map(|sample| sample.time_us).collect();
    let none = Quantiles {
        median: 0.0,
        p99: 0.0,
        p999: 0.0,
        max: 0.0,
    };
    let contacts = samples
        .iter()
        .map(|sample| f64::from(sample.contacts))
        .sum::<f64>();
    let is_free = samples.iter().any(|sample| sample.contacts == 0);
    Phase {
        name: name.to_owned(),
        first_frame,
        frames: samples.len() as u32,
        frame_time_us: Quantiles::from_samples(&mut times).unwrap_or(none),
        overlap_hand_fixed_mm_max: samples
            .iter()
            .map(|sample| sample.overlap_mm)
            .fold(0.0, f64::max),
        overlap_ball_fixed_mm_max: 0.0002,
        overlap_hand_ball_mm_max: if is_free { 0.0 } else { 1.25 },
        free_lag_mm_max: is_free.then_some(0.0),
        jitter_mm_max: (!is_free).then_some(0.0),
        contacts_max: samples
            .iter()
            .map(|sample| sample.contacts)
            .max()
            .unwrap_or(0),
        contacts_mean: short(contacts / samples.len().max(1) as f64),
        impulses_total: samples
            .iter()
            .map(|sample| u64::from(sample.impulses))
            .sum(),
        units_total: samples.iter().map(|sample| sample.units).sum(),
        units_max: samples.iter().map(|sample| sample.units).max().unwrap_or(0),
    }
}

/// Rounds to few enough decimals for every JSON parser to read the same bits back.
fn short(value: f64) -> f64 {
    (value * 1024.0).round() / 1024.0
}

/// Numbers from 0 to 1 that are the same on every call (xorshift64*).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A made-up report with figures.
pub fn report_with_figures() -> Report {
    let names = [
        ("avatar of 3648 triangles", "two arms into a wall"),
        ("avatar of 3648 triangles", "wall by cyclic descent"),
        ("hand with bending fingers", "on a mug's <handle>"),
    ];
    Report {
        figures: names.map(|(figure, name)| scene(figure, name)).to_vec(),
        arm_slaps: Some(ArmSlaps {
            slaps: 200,
            speed_min: 5.25,
            speed_max: 19.75,
            tunnelled_speeds: Vec::new(),
            behind: 12,
            touched: 199,
            overlap_mm_max: 0.0,
            overlap_between_mm_max: 7.5,
            overlap_own_mm_max: 0.0,
            began_in_itself: 3,
            beyond_limits_rad_max: 0.0,
            frame_time_us: None,
        }),
        ..report()
    }
}

fn scene(figure: &str, name: &str) -> FigureScene {
    let samples: Vec<FigureFrame> = (0..2001).map(figure_frame).collect();
    FigureScene {
        figure: figure.to_owned(),
        name: name.to_owned(),
        method: "cyclic descent".to_owned(),
        frames: samples.len() as u32,
        frame_time_us: Quantiles {
            median: 1064.5,
            p99: 1797.25,
            p999: 2111.5,
            max: 14_449.0,
        },
        overlap_fixed_mm_max: 0.0625,
        overlap_loose_mm_max: 0.0,
        overlap_own_mm_max: 0.5,
        overlap_own_first_mm: 0.0,
        overlap_own_grown_mm_max: 0.0,
        astray_mm_max: 0.001,
        beyond_limits_rad_max: 1.0 / 1_048_576.0,
        jump_deg_max: 139.25,
        wanted_jump_deg_max: 139.25,
        root_off_mm_max: 1787.75,
        steps_total: 417_457,
        steps_max: 308,
        steps_untouched: 0,
        adjusted_max: 14,
        contacts_max: 67,
        state_hash: "97ddf445cf26a7e4".to_owned(),
        first_contacts: [173, 773, 1373]
            .map(|first_frame| FirstContact {
                first_frame,
                frames: 355,
                steps_onset_mean: 127.25,
                steps_sustained_mean: 182.75,
                steps_after_mean: 96.5,
            })
            .to_vec(),
        rest: Some(Rest {
            first_frame: 301,
            frames: 100,
            moving_frames: 21,
        }),
        wrist: Some(Wrist {
            off_mm_max: 4.5,
            gap_mm_max: 0.125,
        }),
        samples,
    }
}

fn figure_frame(frame: u32) -> FigureFrame {
    let touches = frame % 600 > 173 && frame % 600 < 520;
    FigureFrame {
        frame,
        time_us: if touches { 900.0 } else { 4.0 },
        steps: u32::from(touches) * (100 + frame % 37),
        adjusted: 14 * u32::from(touches),
        contacts: 2 * u32::from(touches),
        units: 20,
        fixed_mm: 0.0,
        loose_mm: 0.0,
        own_mm: 0.0,
        jump_deg: 0.5,
        root_off_mm: 0.0,
    }
}
