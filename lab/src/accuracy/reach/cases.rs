//! What chains are asked for: seeded tracked angles and goals, class by class.

use glam::Vec3;
use palpable::geometry::chain::posture;
use palpable::reach::goal::{Goal, Task};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::chains::Chain;
use crate::accuracy::shapes::direction;

/// A goal is met when it is missed by no more than this, in metres.
pub const TOLERANCE_M: f32 = 1e-3;

/// A kind of cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// A plane that a point of a far link is 10 to 80 mm behind; the finger's is a fifth of that.
    Push,
    /// The tip at the place that it has at other random angles.
    Reach,
    /// The same from a straight chain, bent by less than 20 mrad, to a nearly straight one.
    Straight,
    /// The same from a nearly straight chain with half of its joints on their limits to one with a
    /// third of them there.
    Limits,
    /// The tip at a place that is up to as far again as the chain is long.
    Beyond,
}

impl Class {
    /// All classes.
    pub const ALL: [Self; 5] = [
        Self::Push,
        Self::Reach,
        Self::Straight,
        Self::Limits,
        Self::Beyond,
    ];

    /// The class's name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Push => "contact push",
            Self::Reach => "far reach",
            Self::Straight => "near-straight",
            Self::Limits => "on limits",
            Self::Beyond => "out of reach",
        }
    }
}

/// Tracked angles, which are those to begin with, and goals.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The tracked angles in radians.
    pub wanted: Vec<f32>,
    /// The goals: one plane, or three for a place.
    pub goals: Vec<Goal>,
}

impl Case {
    /// The task that the kernel is given.
    pub fn task<'a>(&'a self, chain: &'a Chain) -> Task<'a> {
        Task {
            hinges: &chain.hinges,
            balls: &chain.balls,
            root: chain.root,
            wanted: &self.wanted,
            goals: &self.goals,
            tolerance_m: TOLERANCE_M,
        }
    }

    /// The place that three goals ask for.
    pub fn place(&self) -> Vec3 {
        let heights = self.goals.iter().map(|goal| goal.height_m);
        heights.zip(Vec3::AXES).map(|(h, axis)| axis * h).sum()
    }
}

/// The generator of a stream.
pub fn random(seed: u64, stream: u64, index: u32) -> Pcg64Mcg {
    let mixed = seed
        .wrapping_mul(0xD134_2543_DE82_EF95)
        .wrapping_add(stream << 32)
        .wrapping_add(u64::from(index));
    Pcg64Mcg::seed_from_u64(mixed)
}

/// Case number `index` of a class for a chain: equal arguments give equal bits. It may be impossible.
pub fn case(chain: &Chain, class: Class, seed: u64, index: u32) -> Case {
    let stream = (chain.hinges.len() * 16 + chain.balls.len() * 8 + class as usize) as u64;
    let random = &mut random(seed, stream, index);
    match class {
        Class::Push => push(random, chain),
        Class::Reach => {
            let wanted = angles(random, chain, 0.0);
            let other = angles(random, chain, 0.0);
            reach(chain, wanted, &other)
        }
        Class::Straight => {
            let [wanted, other] = [0.02, 0.2].map(|most| {
                let q = angles(random, chain, 0.0);
                straight(random, chain, q, most)
            });
            reach(chain, wanted, &other)
        }
        Class::Limits => {
            let [wanted, other] = [(0.05, 0.5), (0.6, 0.33)].map(|(most, share)| {
                let q = angles(random, chain, 0.0);
                let q = straight(random, chain, q, most);
                limited(random, chain, q, share)
            });
            reach(chain, wanted, &other)
        }
        Class::Beyond => {
            let wanted = angles(random, chain, 0.0);
            let far = length(chain) * random.random_range(1.05..2.0_f32);
            let place = chain.root.translation() + direction(random).as_vec3() * far;
            Case {
                wanted,
                goals: Goal::place(chain.last(), chain.tip, place).to_vec(),
            }
        }
    }
}

/// The chain's length from the first hinge to the tip.
pub fn length(chain: &Chain) -> f32 {
    let links = chain.hinges.iter().skip(1);
    let links: f32 = links.map(|hinge| hinge.rest.translation().length()).sum();
    links + chain.tip.length()
}

/// Random angles within the limits, apart from them by a share of the ranges.
pub fn angles(random: &mut Pcg64Mcg, chain: &Chain, margin: f32) -> Vec<f32> {
    loop {
        let within = |hinge: &palpable::geometry::chain::Hinge| {
            let share = random.random_range(margin..=1.0 - margin);
            hinge.kept(hinge.low_rad + share * (hinge.high_rad - hinge.low_rad))
        };
        let q: Vec<f32> = chain.hinges.iter().map(within).collect();
        if allowed(chain, &q) {
            return q;
        }
    }
}

fn allowed(chain: &Chain, q: &[f32]) -> bool {
    chain.balls.iter().all(|ball| ball.outside_rad(q) == 0.0)
}

/// The same with a chain that bends by less than `most` radians.
fn straight(random: &mut Pcg64Mcg, chain: &Chain, mut q: Vec<f32>, most: f32) -> Vec<f32> {
    for &joint in &chain.bends {
        q[joint] = chain.hinges[joint].kept(random.random_range(-most..most));
    }
    q
}

/// The same with a share of the joints on one of their limits. Shoulders with a cone stay.
fn limited(random: &mut Pcg64Mcg, chain: &Chain, mut q: Vec<f32>, share: f32) -> Vec<f32> {
    let first = 2 * chain.balls.len();
    for (q, hinge) in q.iter_mut().zip(&chain.hinges).skip(first) {
        if random.random_range(0.0..1.0) < share {
            let high = random.random_range(0..2) == 1;
            *q = if high { hinge.high_rad } else { hinge.low_rad };
        }
    }
    q
}

/// The tip's place at other angles.
pub fn reach(chain: &Chain, wanted: Vec<f32>, other: &[f32]) -> Case {
    let placed = posture(&chain.hinges, &chain.root, other);
    let place = placed[chain.last()].link.point(chain.tip);
    Case {
        wanted,
        goals: Goal::place(chain.last(), chain.tip, place).to_vec(),
    }
}

fn push(random: &mut Pcg64Mcg, chain: &Chain) -> Case {
    let wanted = angles(random, chain, 0.1);
    let link = chain.pushed[random.random_range(0..chain.pushed.len())];
    let point = chain.tip * random.random_range(0.2..1.0_f32);
    let normal = direction(random).as_vec3();
    let placed = posture(&chain.hinges, &chain.root, &wanted);
    let depth = random.random_range(0.01..0.08_f32) * if length(chain) < 0.2 { 0.2 } else { 1.0 };
    let goal = Goal {
        link,
        point,
        normal,
        height_m: normal.dot(placed[link].link.point(point)) + depth,
        is_exact: false,
        softness: 0.0,
    };
    Case {
        wanted,
        goals: vec![goal],
    }
}
