//! Least translations of unions against the reference's true minimum, and the paper's equation 1
//! beside them.

use std::hint::black_box;
use std::time::Instant;

use glam::{DVec3, Vec3};
use palpable::geometry::hull::HullBuilder;
use palpable::geometry::union::{
    NODES_USUAL, UnionPair, UnionScratch, least_translation, weighted_mean,
};
use palpable::math::Pose;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::methods::{Core, exact};
use super::shapes::{Shape, direction, log_uniform, orientation};
use super::summary::Spread;
use crate::reference::{Placed, Solid, overlap_depth, union_escape};

/// Overlap that is left counts as none up to this share of the smaller piece's size: ten times what
/// the kernel calls touching.
pub const PARTED: f64 = 1e-5;

/// How often equation 1 is repeated.
const ROUNDS: usize = 4;

/// A kind of unions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum UnionClass {
    /// A hand of 4 to 8 pieces a little inside 2 to 4 pieces.
    Shallow,
    /// The same, deep inside.
    Deep,
    /// A block pressed into a slot that is too narrow: the paper's figure 4(b).
    Slot,
    /// A box in the corner of a floor and a wall.
    Corner,
}

impl UnionClass {
    /// All classes.
    pub const ALL: [Self; 4] = [Self::Shallow, Self::Deep, Self::Slot, Self::Corner];

    /// The class's name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shallow => "shallow",
            Self::Deep => "deep",
            Self::Slot => "slot, figure 4(b)",
            Self::Corner => "corner",
        }
    }
}

/// A piece of a union at its pose.
pub type Piece = (Shape, Pose);

/// Two unions; the first one is to be moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Unions {
    /// The pieces of A and of B.
    pub sides: [Vec<Piece>; 2],
}

/// Unions number `index` of a class: equal arguments give equal bits.
pub fn unions(class: UnionClass, seed: u64, index: u32) -> Unions {
    let stream = seed
        .wrapping_mul(0xD134_2543_DE82_EF95)
        .wrapping_add(u64::from(index) << 8)
        .wrapping_add(class as u64);
    let random = &mut Pcg64Mcg::seed_from_u64(stream);
    let sides = match class {
        UnionClass::Shallow => hand_in_blocks(random, 0.001, 0.006),
        UnionClass::Deep => hand_in_blocks(random, 0.006, 0.025),
        UnionClass::Slot => slot(random),
        UnionClass::Corner => corner(random),
    };
    Unions { sides }
}

fn block(half: [f64; 3], at: [f64; 3]) -> Piece {
    let [x, y, z] = at.map(|x| x as f32);
    (Shape::cuboid(DVec3::from_array(half)), Pose::at(x, y, z))
}

/// A block of width w + 2 d whose bottom is h below the rim of a slot of width w, d less than h: the
/// least way out of either wall is sideways into the other.
fn slot(random: &mut Pcg64Mcg) -> [Vec<Piece>; 2] {
    let width = log_uniform(random, 0.02, 0.2);
    let height = log_uniform(random, 0.005, 0.05);
    let too_wide = height * log_uniform(random, 0.02, 0.8);
    let wall = |side: f64| block([0.2, 0.5, 0.5], [side * (0.2 + 0.5 * width), -0.5, 0.0]);
    let half = [0.5 * width + too_wide, 0.1, 0.1];
    [
        vec![block(half, [0.0, 0.1 - height, 0.0])],
        vec![wall(-1.0), wall(1.0)],
    ]
}

/// A box some millimetres inside a floor and a wall.
fn corner(random: &mut Pcg64Mcg) -> [Vec<Piece>; 2] {
    let [down, aside] = [0; 2].map(|_| log_uniform(random, 0.001, 0.03));
    [
        vec![block([0.1; 3], [0.1 - aside, 0.1 - down, 0.0])],
        vec![
            block([1.0, 0.5, 1.0], [0.0, -0.5, 0.0]),
            block([0.5, 1.0, 1.0], [-0.5, 0.0, 0.0]),
        ],
    ]
}

/// A palm with fingers, its lowest corner `from` to `to` metres inside one of some blocks.
fn hand_in_blocks(random: &mut Pcg64Mcg, from: f64, to: f64) -> [Vec<Piece>; 2] {
    let blocks = blocks(random);
    let mut hand = hand(random);
    let (shape, pose) = &blocks[0];
    let target = pose.point(farthest(shape, pose, Vec3::Y));
    let lowest = hand
        .iter()
        .map(|(shape, pose)| pose.point(farthest(shape, pose, Vec3::NEG_Y)))
        .min_by(|p, q| p.y.total_cmp(&q.y))
        .unwrap_or_default();
    let depth = log_uniform(random, from, to) as f32;
    let shift = target - lowest - Vec3::Y * depth;
    for (_, pose) in &mut hand {
        *pose = pose.moved(shift);
    }
    [hand, blocks]
}

/// The point of a shape, in its own frame, that is farthest along a direction of the world.
fn farthest(shape: &Shape, pose: &Pose, along: Vec3) -> Vec3 {
    let reach = |p: &Vec3| pose.point(*p).dot(along);
    let points = shape.points.iter().copied().map(Vec3::from_array);
    points
        .max_by(|p, q| reach(p).total_cmp(&reach(q)))
        .unwrap_or_default()
}

/// A palm of 80 mm and 3 to 7 fingers that fan out from its front edge, anyhow in space.
fn hand(random: &mut Pcg64Mcg) -> Vec<Piece> {
    let turn = orientation(random).as_quat();
    let place = |local: Pose| Pose::new(turn, Vec3::ZERO).then(&local);
    let palm = Shape::cuboid(DVec3::new(0.04, 0.012, 0.045));
    let mut pieces = vec![(palm, place(Pose::IDENTITY))];
    let fingers = random.random_range(3..=7);
    for finger in 0..fingers {
        let aside = -0.035 + 0.07 * f64::from(finger) / f64::from(fingers - 1);
        let length = random.random_range(0.02..0.045);
        let bend: f64 = random.random_range(-0.2..0.9);
        let spread = glam::DQuat::from_rotation_y(4.0 * aside) * glam::DQuat::from_rotation_x(bend);
        let knuckle = DVec3::new(aside, 0.0, 0.045);
        let middle = knuckle + spread * DVec3::Z * length;
        let local = Pose::new(spread.as_quat(), middle.as_vec3());
        pieces.push((tapered(length), place(local)));
    }
    pieces
}

/// A finger as a prism of eight corners that narrows to its tip, of half the length given.
fn tapered(half_length: f64) -> Shape {
    let mut points = Vec::new();
    for (end, half) in [(-1.0, 0.008), (1.0, 0.006)] {
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            points.push(DVec3::new(x * half, y * half, end * half_length));
        }
    }
    Shape::hull(&points)
}

/// Two to four boxes next to one another, each turned anyhow.
fn blocks(random: &mut Pcg64Mcg) -> Vec<Piece> {
    let count = random.random_range(2..=4);
    let piece = |random: &mut Pcg64Mcg| {
        let mut half = || random.random_range(0.02..0.06);
        let shape = Shape::cuboid(DVec3::new(half(), half(), half()));
        let at = direction(random) * random.random_range(0.0..0.06);
        (
            shape,
            Pose::new(orientation(random).as_quat(), at.as_vec3()),
        )
    };
    (0..count).map(|_| piece(random)).collect()
}

/// Who moves the union.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mover {
    /// The kernel with its usual budget of nodes.
    Palpable,
    /// The kernel's sweep alone.
    Sweep,
    /// Equation 1 of Schmidl and Lin 2004, once.
    Mean,
    /// Equation 1 repeated up to four times.
    MeanRepeated,
}

impl Mover {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Palpable, Self::Sweep, Self::Mean, Self::MeanRepeated];

    /// The name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Palpable => "Palpable",
            Self::Sweep => "Palpable, sweep only",
            Self::Mean => "equation 1",
            Self::MeanRepeated => "equation 1, to 4 rounds",
        }
    }

    fn offset(self, pairs: &mut [UnionPair], scratch: &mut UnionScratch) -> Vec3 {
        match self {
            Self::Palpable => least_translation(pairs, 0.0, NODES_USUAL, scratch).offset,
            Self::Sweep => least_translation(pairs, 0.0, 0, scratch).offset,
            Self::Mean => weighted_mean(pairs),
            Self::MeanRepeated => repeated_mean(pairs),
        }
    }
}

/// Moves the pairs by equation 1 until it has nothing to add; they stay moved.
fn repeated_mean(pairs: &mut [UnionPair]) -> Vec3 {
    let mut offset = Vec3::ZERO;
    for _ in 0..ROUNDS {
        let step = weighted_mean(pairs);
        if step == Vec3::ZERO {
            break;
        }
        offset += step;
        for pair in &mut *pairs {
            pair.a_pose = pair.a_pose.moved(step);
        }
    }
    offset
}

/// One mover's translation of one pair of unions.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Moved {
    /// The number in the class.
    pub index: u32,
    /// Length of the least translation, by the reference, in metres.
    pub least_m: f64,
    /// Length of this translation, in metres.
    pub length_m: f64,
    /// The deepest overlap left, relative to the smaller piece's size.
    pub left: f64,
    /// Time of the call, in nanoseconds: the least of three.
    pub time_ns: f64,
}

impl Moved {
    /// Whether overlap is left.
    pub fn overlaps(&self) -> bool {
        self.left > PARTED
    }

    /// Length over the least length.
    pub fn ratio(&self) -> f64 {
        self.length_m / self.least_m
    }
}

/// All movers on unions that overlap; none if they do not, or if the reference gave up.
pub fn judge(unions: &Unions, index: u32, builder: &mut HullBuilder) -> Option<[Moved; 4]> {
    let solids = unions.sides.each_ref().map(|side| {
        let solid = |piece: &Piece| Solid::from_f32(&piece.0.points, 0.0);
        side.iter().map(solid).collect::<Result<Vec<_>, _>>()
    });
    let [a, b] = solids.map(|side| side.expect("generated points are finite"));
    let (a, b) = (placed(&a, &unions.sides[0]), placed(&b, &unions.sides[1]));
    let least_m = union_escape(&a, &b).ok()?.length();
    if least_m <= PARTED * a[0].solid().size() {
        return None;
    }
    let cores = unions.sides.each_ref().map(|side| {
        let core = |piece: &Piece| Core::new(builder, &piece.0);
        side.iter().map(core).collect::<Result<Vec<_>, _>>()
    });
    let [of_a, of_b] = cores.map(|side| side.expect("generated pieces have volume"));
    let pairs = all_pairs([&of_a, &of_b], unions);
    let mut scratch = Box::new(UnionScratch::new());
    Some(Mover::ALL.map(|mover| {
        let (offset, time_ns) = timed(mover, &pairs, &mut scratch);
        Moved {
            index,
            least_m,
            length_m: offset.as_dvec3().length(),
            left: left(&a, &b, offset.as_dvec3()),
            time_ns,
        }
    }))
}

fn placed<'a>(solids: &'a [Solid], pieces: &[Piece]) -> Vec<Placed<'a>> {
    let place = |(solid, (_, pose)): (&'a Solid, &Piece)| {
        let (rotation, position) = exact(pose);
        Placed::new(solid, rotation, position)
    };
    solids.iter().zip(pieces).map(place).collect()
}

fn all_pairs<'c>(cores: [&'c [Core]; 2], unions: &Unions) -> Vec<UnionPair<'c>> {
    let [a, b] = [0, 1].map(|side| {
        let poses = unions.sides[side].iter().map(|(_, pose)| *pose);
        cores[side].iter().zip(poses).collect::<Vec<_>>()
    });
    let pair = |(a, a_pose): (&'c Core, Pose), (b, b_pose): (&'c Core, Pose)| UnionPair {
        a: a.convex(),
        a_pose,
        b: b.convex(),
        b_pose,
    };
    a.iter()
        .flat_map(|&a| b.iter().map(move |&b| pair(a, b)))
        .collect()
}

fn timed(mover: Mover, pairs: &[UnionPair], scratch: &mut UnionScratch) -> (Vec3, f64) {
    let mut least_ns = f64::INFINITY;
    let mut offset = Vec3::ZERO;
    for _ in 0..3 {
        let mut pairs = pairs.to_vec();
        let start = Instant::now();
        offset = black_box(mover.offset(black_box(&mut pairs), scratch));
        least_ns = least_ns.min(start.elapsed().as_secs_f64() * 1e9);
    }
    (offset, least_ns)
}

fn left(a: &[Placed], b: &[Placed], offset: DVec3) -> f64 {
    let mut most = 0.0_f64;
    for a in a {
        for b in b {
            let size_m = a.solid().size().min(b.solid().size());
            most = most.max(overlap_depth(&a.moved(offset), b) / size_m);
        }
    }
    most
}

/// One mover on one class of unions.
#[derive(Clone, Debug, Serialize)]
pub struct UnionRow {
    /// The class.
    pub class: UnionClass,
    /// The mover.
    pub mover: Mover,
    /// How many pairs of unions were measured.
    pub unions: usize,
    /// How many still overlap after the call.
    pub overlapping: usize,
    /// The deepest overlap left, relative to the smaller piece's size.
    pub left: Option<Spread>,
    /// Length over the least length, of those that are parted.
    pub ratio: Option<Spread>,
    /// Time of a call in nanoseconds.
    pub time_ns: Option<Spread>,
}

/// Rows of all movers from the judged unions of a class.
pub fn rows(class: UnionClass, judged: &[[Moved; 4]]) -> Vec<UnionRow> {
    let row = |(place, mover): (usize, Mover)| {
        let moved = || judged.iter().map(move |all| &all[place]);
        UnionRow {
            class,
            mover,
            unions: judged.len(),
            overlapping: moved().filter(|moved| moved.overlaps()).count(),
            left: Spread::of(moved().map(|moved| moved.left)),
            ratio: Spread::of(moved().filter(|m| !m.overlaps()).map(Moved::ratio)),
            time_ns: Spread::of(moved().map(|moved| moved.time_ns)),
        }
    };
    Mover::ALL.into_iter().enumerate().map(row).collect()
}

/// Judges unions of a class in turn until `wanted` overlap.
pub fn class(class: UnionClass, seed: u64, wanted: u32, mut tick: impl FnMut()) -> Vec<[Moved; 4]> {
    let mut builder = Box::new(HullBuilder::new());
    let mut judged = Vec::new();
    for index in 0..4 * wanted {
        if judged.len() as u32 == wanted {
            break;
        }
        if let Some(moved) = judge(&unions(class, seed, index), index, &mut builder) {
            judged.push(moved);
            tick();
        }
    }
    judged
}
