//! The engines under test behind one face, and a player that steps them and takes the time.

use cpu_time::ThreadTime;
use glam::DVec3;
use serde::Serialize;

use super::kernel::{self, Kernel};
use super::peer::{Peer, Tuning};
use super::scene::{BodyState, Scene};

/// An engine with its settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// The kernel, one step a frame.
    Palpable,
    /// rapier3d, one step a frame with four solver iterations.
    Rapier,
    /// rapier3d with every frame in four steps and continuous collision detection.
    RapierBest,
}

impl Subject {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Palpable, Self::Rapier, Self::RapierBest];

    /// The name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Palpable => "palpable",
            Self::Rapier => "rapier",
            Self::RapierBest => "rapier, best",
        }
    }
}

/// What every engine can do. Bodies are numbered as in the scene.
pub trait Engine {
    /// Goes on by one frame of `dt_s` seconds.
    fn step(&mut self, dt_s: f64);
    /// Where a body is and how it moves.
    fn state(&self, body: usize) -> BodyState;
    /// Gives a loose body a velocity in m/s and a spin in rad/s, and wakes it.
    fn set_velocity(&mut self, body: usize, velocity: DVec3, spin: DVec3);
    /// Changes the acceleration of free fall, in m/s2.
    fn set_gravity(&mut self, gravity: DVec3);
}

/// Frame rates that everything is played at, in Hz.
pub const RATES_HZ: [f64; 3] = [60.0, 90.0, 1000.0];

/// How a scene is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// By whom.
    pub subject: Subject,
    /// Frames a second.
    pub rate_hz: f64,
    /// Whether times are taken.
    pub timed: bool,
}

impl Setup {
    /// Frames in so many seconds, at least.
    pub fn frames(&self, seconds: f64) -> u32 {
        (seconds * self.rate_hz - 1e-6).ceil().max(0.0) as u32
    }
}

/// CPU time of frames.
#[derive(Clone, Debug, Default)]
pub struct Spent {
    frames_us: Vec<f64>,
}

impl Spent {
    /// All of them, in microseconds, in their order.
    pub fn frames_us(&self) -> &[f64] {
        &self.frames_us
    }

    /// The median frame in microseconds; none when no time was taken.
    pub fn median_us(&self) -> Option<f64> {
        let mut sorted = self.frames_us.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// Together, in milliseconds.
    pub fn total_ms(&self) -> f64 {
        1e-3 * self.frames_us.iter().sum::<f64>()
    }

    /// Runs a frame, and notes its time if it is to be taken.
    pub fn time(&mut self, timed: bool, run: impl FnOnce()) {
        if !timed {
            return run();
        }
        let begun = ThreadTime::now();
        run();
        self.frames_us.push(1e6 * begun.elapsed().as_secs_f64());
    }

    /// Adds the frames of another run.
    pub fn absorb(&mut self, other: &Self) {
        self.frames_us.extend_from_slice(&other.frames_us);
    }
}

/// A scene that is being played.
pub struct Player<'a> {
    engine: Box<dyn Engine + 'a>,
    setup: Setup,
    time_s: f64,
    spent: Spent,
}

/// Plays a scene: what `run` answers, and what the frames that it stepped cost.
pub fn play<R>(setup: &Setup, scene: &Scene, run: impl FnOnce(&mut Player) -> R) -> (R, Spent) {
    let mut block = kernel::block(scene);
    let engine: Box<dyn Engine + '_> = match setup.subject {
        Subject::Palpable => Box::new(Kernel::new(scene, &mut block)),
        Subject::Rapier => Box::new(Peer::new(scene, Tuning::Usual)),
        Subject::RapierBest => Box::new(Peer::new(scene, Tuning::Best)),
    };
    let mut player = Player {
        engine,
        setup: *setup,
        time_s: 0.0,
        spent: Spent::default(),
    };
    let found = run(&mut player);
    (found, player.spent)
}

impl Player<'_> {
    /// Goes on by one frame.
    pub fn step(&mut self) {
        let dt_s = 1.0 / self.setup.rate_hz;
        let engine = &mut self.engine;
        self.spent.time(self.setup.timed, || engine.step(dt_s));
        self.time_s += dt_s;
    }

    /// Lets the scene come to rest for so many seconds; neither counts as played nor as spent.
    pub fn settle(&mut self, seconds: f64) {
        for _ in 0..self.setup.frames(seconds) {
            self.engine.step(1.0 / self.setup.rate_hz);
        }
    }

    /// How it is played.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Seconds that were played.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Where a body is and how it moves.
    pub fn state(&self, body: usize) -> BodyState {
        self.engine.state(body)
    }

    /// What the last frame cost, in microseconds; zero when no time is taken.
    pub fn last_frame_us(&self) -> f64 {
        self.spent.frames_us.last().copied().unwrap_or(0.0)
    }

    /// Gives a loose body a velocity in m/s and a spin in rad/s, and wakes it.
    pub fn set_velocity(&mut self, body: usize, velocity: DVec3, spin: DVec3) {
        self.engine.set_velocity(body, velocity, spin);
    }

    /// Changes the acceleration of free fall, in m/s2.
    pub fn set_gravity(&mut self, gravity: DVec3) {
        self.engine.set_gravity(gravity);
    }
}
