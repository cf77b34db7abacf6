//! Chains in motion: drift over closed loops, jumps along smooth paths, and whole avatars.

use glam::Vec3;
use palpable::geometry::chain::posture;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::cases::{Case, angles, random, reach};
use super::chains::{Chain, Model, avatar};
use super::measure::{Method, STEPS, solve};
use super::optimum::Problem;
use super::peer::Peer;
use crate::accuracy::summary::Spread;
use palpable::reach::goal::Goal;

/// Times round a loop.
const ROUNDS: usize = 10;
/// Frames of one time round.
const FRAMES: usize = 90;
/// Iterations in a frame.
const FRAME_STEPS: u32 = 8;

/// A smooth path of the arm's tip that closes, and where the arm is tracked.
struct Path {
    wanted: Vec<f32>,
    places: Vec<Vec3>,
}

/// Loops of 20 to 60 mm radius through the tip of a random arm, of which f64 can reach twelve places.
fn paths(chain: &Chain, seed: u64, count: u32) -> Vec<Path> {
    let mut paths = vec![];
    for index in 0..20 * count {
        if paths.len() as u32 == count {
            break;
        }
        let random = &mut random(seed, 77, index);
        let wanted = angles(random, chain, 0.2);
        let places = looped(random, tip(chain, &wanted));
        let is_reached = |place: &Vec3| {
            let case = at(chain, &wanted, *place);
            Problem::new(chain, &case).least(random, 0).is_some()
        };
        if places.iter().step_by(FRAMES / 12).all(is_reached) {
            paths.push(Path { wanted, places });
        }
    }
    paths
}

/// A loop through a place: a circle with a wave across it.
fn looped(random: &mut Pcg64Mcg, through: Vec3) -> Vec<Vec3> {
    let u = crate::accuracy::shapes::direction(random).as_vec3();
    let (v, w) = u.any_orthonormal_pair();
    let radius = random.random_range(0.02..0.06_f32);
    let place = |frame: usize| {
        let turn = std::f32::consts::TAU * frame as f32 / FRAMES as f32;
        let aside = u * (turn.cos() - 1.0) + v * turn.sin() + w * 0.5 * (2.0 * turn).sin();
        through + radius * aside
    };
    (0..FRAMES).map(place).collect()
}

fn tip(chain: &Chain, q: &[f32]) -> Vec3 {
    let placed = posture(&chain.hinges, &chain.root, q);
    placed[chain.last()].link.point(chain.tip)
}

fn at(chain: &Chain, wanted: &[f32], place: Vec3) -> Case {
    Case {
        wanted: wanted.to_vec(),
        goals: Goal::place(chain.last(), chain.tip, place).to_vec(),
    }
}

/// One method along the loops.
#[derive(Clone, Debug, Serialize)]
pub struct Drift {
    /// The method.
    pub method: Method,
    /// How many loops were drawn, ten times each.
    pub loops: usize,
    /// The most that a joint differs from its beginning after the last time round, in degrees.
    pub drift_deg: Option<Spread>,
    /// The most that a joint turns from one frame to the next, in degrees.
    pub jump_deg: Option<Spread>,
}

/// All methods along loops of the 7-joint arm. The tracked angles are those of the beginning; the kernel
/// starts each frame from the last one's angles, as does the peer.
pub fn drifts(seed: u64, loops: u32) -> Vec<Drift> {
    let chain = Model::Arm.chain();
    let paths = paths(&chain, seed, loops);
    let drift = |method: Method| {
        let drawn: Vec<(f64, f64)> = paths
            .iter()
            .map(|path| draw(&chain, path, method))
            .collect();
        Drift {
            method,
            loops: paths.len(),
            drift_deg: Spread::of(drawn.iter().map(|(drift, _)| *drift)),
            jump_deg: Spread::of(drawn.iter().map(|(_, jump)| *jump)),
        }
    };
    Method::ALL.map(drift).into()
}

/// Drift and largest jump along one loop.
fn draw(chain: &Chain, path: &Path, method: Method) -> (f64, f64) {
    let first: Vec<f64> = path.wanted.iter().map(|&q| q.into()).collect();
    let mut before = first.clone();
    let mut jump = 0.0_f64;
    let mut angles = path.wanted.clone();
    let mut peer = Peer::new(chain, &at(chain, &path.wanted, path.places[0]));
    peer.solve(FRAME_STEPS);
    for frame in 1..=ROUNDS * FRAMES {
        let place = path.places[frame % FRAMES];
        let now: Vec<f64> = if let Some(solve) = method.kernel() {
            let case = at(chain, &path.wanted, place);
            solve(&case.task(chain), &mut angles, FRAME_STEPS);
            angles.iter().map(|&q| q.into()).collect()
        } else {
            peer.aim(place);
            peer.go_on(FRAME_STEPS);
            peer.angles()
        };
        jump = jump.max(farthest_deg(&before, &now));
        before = now;
    }
    (farthest_deg(&first, &before), jump)
}

fn farthest_deg(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs().to_degrees());
    differences.fold(0.0, f64::max)
}

/// One method on whole avatars.
#[derive(Clone, Debug, Serialize)]
pub struct Avatars {
    /// The method.
    pub method: Method,
    /// How many avatars were tried.
    pub avatars: usize,
    /// Share of avatars whose five chains are all solved after [`STEPS`] iterations a chain.
    pub solved: [f64; STEPS.len()],
    /// Median time of the five chains together, in nanoseconds.
    pub time_ns: [f64; STEPS.len()],
}

/// All methods on avatars whose five tips are to be at random reachable places, chain after chain.
pub fn avatars(seed: u64, count: u32, timed: bool) -> Vec<Avatars> {
    let chains = avatar();
    let case = |place: usize, index: u32| {
        let random = &mut random(seed, 200 + place as u64, index);
        let wanted = angles(random, &chains[place], 0.0);
        let other = angles(random, &chains[place], 0.0);
        reach(&chains[place], wanted, &other)
    };
    let cases: Vec<Vec<Case>> = (0..count)
        .map(|index| (0..chains.len()).map(|place| case(place, index)).collect())
        .collect();
    let row = |method: Method| {
        let (mut solved, mut times) = ([0.0; STEPS.len()], [0.0; STEPS.len()]);
        for (place, steps) in STEPS.into_iter().enumerate() {
            let mut all_ns = vec![];
            for cases in &cases {
                let answers = chains.iter().zip(cases);
                let answers: Vec<_> = answers
                    .map(|(chain, case)| solve(chain, case, method, steps, timed))
                    .collect();
                let all = answers.iter().all(|answer| answer.is_solved);
                solved[place] += f64::from(u8::from(all)) / f64::from(count);
                all_ns.push(answers.iter().map(|answer| answer.time_ns).sum());
            }
            times[place] = Spread::of(all_ns.into_iter()).map_or(0.0, |spread| spread.median);
        }
        Avatars {
            method,
            avatars: cases.len(),
            solved,
            time_ns: times,
        }
    };
    Method::ALL.map(row).into()
}
