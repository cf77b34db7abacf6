//! What must hold for the separation of any two pieces at any two poses, however they were made up. The
//! fuzz target and a test over seeded bytes share it.
#![allow(unreachable_pub, reason = "included by a test and by a fuzz target")]

use glam::{DQuat, DVec3, Quat, Vec3};
use palpable::geometry::convex::{Convex, Face};
use palpable::geometry::hull::{HullBuilder, HullError, HullView};
use palpable::geometry::separation::{Separation, separation, separation_again};
use palpable::geometry::warm::WarmStart;
use palpable::limits::WORLD_REACH_M;
use palpable::math::Pose;

/// Where the numbers of a case come from.
pub trait Draw {
    /// The next 32 bits; zero when there are no more.
    fn word(&mut self) -> u32;

    /// From -1 to 1.
    fn unit(&mut self) -> f32 {
        self.word().cast_signed() as f32 / 2_147_483_648.0
    }

    /// One of -1, -0.5, 0, 0.5 and 1.
    fn step(&mut self) -> f32 {
        (self.word() % 5) as f32 * 0.5 - 1.0
    }

    /// Any number at all, infinite and none included.
    fn any(&mut self) -> f32 {
        f32::from_bits(self.word())
    }
}

/// A piece that is still to be made.
#[derive(Clone, Debug)]
struct Recipe {
    /// 0 a sphere, 1 a capsule, 2 a box, else the hull of all points.
    kind: u32,
    points: Vec<[f32; 3]>,
    radius: f32,
    /// About how large it is, in metres.
    scale: f32,
}

impl Recipe {
    fn draw(draw: &mut impl Draw) -> Self {
        let [kind, style, size, stretch, offset, count] = {
            let bits = draw.word();
            [0, 4, 8, 12, 20, 24].map(|shift| bits >> shift)
        };
        let scale = [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0][(size % 16 % 6) as usize];
        let part = |axis: u32| [1.0, 1.0, 0.1, 1e-3][(stretch >> (2 * axis) & 3) as usize];
        let stretch = [0, 1, 2].map(|axis| scale * part(axis));
        let offset = match offset % 4 {
            0 => [0; 3].map(|_| 2.0 * scale * draw.unit()),
            _ => [0.0; 3],
        };
        let mut points: Vec<[f32; 3]> = Vec::new();
        for index in 0..4 + (count % 28) as usize {
            let point = [0, 1, 2].map(|axis: usize| match style % 8 {
                0 => any_of_a_piece(draw),
                1 | 2 => draw.step() * stretch[axis] + offset[axis],
                _ => draw.unit() * stretch[axis] + offset[axis],
            });
            let again = style % 8 == 3 && index % 3 == 2;
            points.push(if again { points[index / 2] } else { point });
        }
        let rounding = draw.word();
        let radius = [0.0, 0.0, 0.01, 0.3][(rounding & 3) as usize] * scale;
        Self {
            kind: kind % 8,
            points,
            radius,
            scale,
        }
    }

    fn build<'b>(&self, builder: &'b mut HullBuilder) -> Result<HullView<'b>, HullError> {
        let point = |index: usize| Vec3::from_array(self.points[index]);
        match self.kind {
            0 => builder.sphere(point(0)),
            1 => builder.capsule(point(0), point(1)),
            2 => builder.cuboid(point(0).abs()),
            _ => builder.build(&self.points),
        }
    }
}

/// Any number, those from 100 to 1e4 as hundredths: larger pieces are refused, and ones in between are
/// no scale that answers are promised for.
fn any_of_a_piece(draw: &mut impl Draw) -> f32 {
    let any = draw.any();
    if (100.0..1e4).contains(&any.abs()) {
        any / 100.0
    } else {
        any
    }
}

/// A pose within twice `near_m` of `home`, mostly, of whatever the words make of it.
fn draw_pose(draw: &mut impl Draw, home: Vec3, near_m: f32) -> Option<Pose> {
    let style = draw.word();
    let turn = match style % 8 {
        0 | 1 => [0; 4].map(|_| draw.step()),
        2 => [0.0, 0.0, 0.0, 1.0],
        3 if style & 0x700 == 0 => [0; 4].map(|_| draw.any()),
        _ => [0; 4].map(|_| draw.unit()),
    };
    let at = match style >> 4 & 7 {
        0 => [0; 3].map(|_| near_m * draw.step()),
        1 if style & 0x700 == 0 => [0; 3].map(|_| draw.any()),
        2 => [0; 3].map(|_| 2.0 * near_m * draw.unit()),
        _ => [0; 3].map(|_| 0.7 * near_m * draw.unit()),
    };
    let pose = Pose::new(Quat::from_array(turn), Vec3::from_array(at) + home);
    pose.normalised(WORLD_REACH_M)
}

/// What became of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The points made no piece, or the numbers no pose.
    Refused,
    /// The pieces are apart, and all was as it should be.
    Apart,
    /// They overlap, and all was as it should be.
    Overlapping,
}

/// How far a normal may be from unit length: a pose's quaternion is by up to 5e-7, which counts as it is
/// in products, and a product rounds as often again.
const UNIT_MAX: f64 = 2e-6;

/// What is checked of a pair, in the order of [`Checker::worst`].
pub const CHECKS: [&str; 9] = [
    "unit normal",
    "gap along the normal in f64",
    "gap between the points",
    "A's point in A's box",
    "B's point in B's box",
    "gap after a swap",
    "gap with another seed",
    "gap from a warm start",
    "gap after moving by it",
];

/// Room for the pieces, and the largest errors so far as parts of what is allowed.
pub struct Checker {
    first: Box<HullBuilder>,
    second: Box<HullBuilder>,
    pub worst: [f64; CHECKS.len()],
}

impl Default for Checker {
    fn default() -> Self {
        Self {
            first: Box::new(HullBuilder::new()),
            second: Box::new(HullBuilder::new()),
            worst: [0.0; CHECKS.len()],
        }
    }
}

impl Checker {
    /// Makes a case of the numbers drawn and checks it.
    pub fn check(&mut self, draw: &mut impl Draw) -> Outcome {
        let (of_a, of_b) = (Recipe::draw(draw), Recipe::draw(draw));
        let (Ok(a), Ok(b)) = (of_a.build(&mut self.first), of_b.build(&mut self.second)) else {
            return Outcome::Refused;
        };
        let (a, b) = (a.convex(of_a.radius), b.convex(of_b.radius));
        assert_unit_normals(&a);
        assert_unit_normals(&b);
        let far = if draw.word().is_multiple_of(4) {
            500.0
        } else {
            0.0
        };
        let home = Vec3::from_array([0; 3].map(|_| far * draw.unit()));
        let near = of_a.scale.max(of_b.scale);
        let (Some(pose_a), Some(pose_b)) = (
            draw_pose(draw, home, near),
            draw_pose(draw, home, 0.1 * near),
        ) else {
            return Outcome::Refused;
        };
        let seeds = [
            Vec3::from_array([0; 3].map(|_| draw.unit())),
            Vec3::from_array([0; 3].map(|_| draw.any())),
        ];
        let pair = Pair::new(a, b, pose_a, pose_b);
        let errors = pair.errors(seeds);
        for (index, error) in errors.iter().enumerate() {
            self.worst[index] = self.worst[index].max(*error);
            assert!(
                *error <= 1.0,
                "{}: {error} of what is allowed\n{:?}\n{of_a:?}\n{of_b:?}\n{pose_a:?}\n{pose_b:?}",
                CHECKS[index],
                pair.found,
            );
        }
        if pair.found.gap_m > 0.0 {
            Outcome::Apart
        } else {
            Outcome::Overlapping
        }
    }
}

/// A pair, what was found, and how much a number may be off.
struct Pair<'p> {
    a: Convex<'p>,
    b: Convex<'p>,
    pose_a: Pose,
    pose_b: Pose,
    found: Separation,
    /// Distance of the cores: zero when they overlap.
    apart_m: f64,
    /// Rounding of what is computed in B's frame: sixteen roundings of all that adds up there. A vertex
    /// passes through a product of quaternions, a matrix and sums; eight were seen.
    relative_m: f64,
    /// The same for a point in the world.
    world_m: f64,
    /// Rounding of the gap to f32.
    given_away_m: f64,
}

impl<'p> Pair<'p> {
    fn new(a: Convex<'p>, b: Convex<'p>, pose_a: Pose, pose_b: Pose) -> Self {
        let found = separation(&a, &b, &pose_a, &pose_b, Vec3::ZERO);
        let between = pose_a.translation().as_dvec3() - pose_b.translation().as_dvec3();
        let reach = |piece: &Convex| f64::from(piece.core_reach()) + f64::from(piece.radius);
        let far = |pose: &Pose| pose.translation().as_dvec3().length();
        // Denormal lengths have no square: a femtometre on top.
        let relative_m = 1e-15 + 1e-6 * (reach(&a) + reach(&b) + between.length());
        let cores_m = f64::from(found.gap_m) + f64::from(a.radius) + f64::from(b.radius);
        let apart_m = cores_m.max(0.0);
        Self {
            a,
            b,
            pose_a,
            pose_b,
            found,
            apart_m,
            relative_m,
            world_m: relative_m + 1e-6 * (far(&pose_a) + far(&pose_b)),
            given_away_m: 1.2e-7 * apart_m,
        }
    }

    /// The errors as parts of what is allowed, in the order of [`CHECKS`].
    fn errors(&self, seeds: [Vec3; 2]) -> [f64; CHECKS.len()] {
        let (found, gap) = (&self.found, f64::from(self.found.gap_m));
        let finite = found.normal.is_finite() && found.gap_m.is_finite();
        assert!(finite && found.point_a.is_finite() && found.point_b.is_finite());
        assert_eq!(self.ask(Vec3::ZERO), *found, "the same question");
        let n = found.normal.as_dvec3();
        let off = |other: f64| (other - gap).abs();
        let seeded = seeds.map(|seed| off(f64::from(self.ask(seed).gap_m)));
        [
            (n.length() - 1.0).abs() / UNIT_MAX,
            off(self.plane_gap(n.normalize())) / self.relative_m,
            self.between_off() / (self.given_away_m + self.world_m),
            outside(&self.a, &self.pose_a, found.point_a) / self.world_m,
            outside(&self.b, &self.pose_b, found.point_b) / self.world_m,
            off(self.swapped()) / self.touching_m(),
            seeded[0].max(seeded[1]) / self.touching_m(),
            off(self.again()) / self.touching_m(),
            self.moved().abs() / (self.sideways_m() + self.world_m),
        ]
    }

    /// Rounding of the cores' gap: within it nobody knows whether they overlap.
    fn touching_m(&self) -> f64 {
        self.given_away_m + self.relative_m
    }

    /// How far the gap is from that between the points.
    fn between_off(&self) -> f64 {
        let between = self.found.point_a.as_dvec3() - self.found.point_b.as_dvec3();
        (self.found.normal.as_dvec3().dot(between) - f64::from(self.found.gap_m)).abs()
    }

    /// How far moving by the gap may miss: the normal is rounded to f32 in B's frame and in the world.
    fn sideways_m(&self) -> f64 {
        1e-6 * self.apart_m + self.relative_m
    }

    /// The gap, found from where the search ended that A's pose of `moved` began.
    fn again(&self) -> f64 {
        let mut warm = WarmStart::new();
        let pose = self.pose_a.moved(-self.found.gap_m * self.found.normal);
        let _ = separation_again(&self.a, &self.b, &pose, &self.pose_b, &mut warm);
        let found = separation_again(&self.a, &self.b, &self.pose_a, &self.pose_b, &mut warm);
        f64::from(found.gap_m)
    }

    fn ask(&self, seed: Vec3) -> Separation {
        separation(&self.a, &self.b, &self.pose_a, &self.pose_b, seed)
    }

    fn swapped(&self) -> f64 {
        let found = separation(&self.b, &self.a, &self.pose_b, &self.pose_a, Vec3::ZERO);
        f64::from(found.gap_m)
    }

    /// The gap that is left once A has moved by it.
    fn moved(&self) -> f64 {
        let pose = self.pose_a.moved(-self.found.gap_m * self.found.normal);
        let left = separation(&self.a, &self.b, &pose, &self.pose_b, self.found.normal);
        f64::from(left.gap_m)
    }

    /// The gap between planes across a unit normal, in f64.
    fn plane_gap(&self, normal: DVec3) -> f64 {
        let apart = self.pose_a.translation().as_dvec3() - self.pose_b.translation().as_dvec3();
        let [of_a, of_b] =
            [&self.pose_a, &self.pose_b].map(|pose| turn_of(pose).inverse() * normal);
        let low = vertices(&self.a).fold(f64::MAX, |low, v| low.min(of_a.dot(v)));
        let high = vertices(&self.b).fold(f64::MIN, |high, v| high.max(of_b.dot(v)));
        normal.dot(apart) + low - high - f64::from(self.a.radius) - f64::from(self.b.radius)
    }
}

fn turn_of(pose: &Pose) -> DQuat {
    pose.quat().as_dquat().normalize()
}

fn vertices<'p>(piece: &'p Convex) -> impl Iterator<Item = DVec3> + 'p {
    (0..piece.vertex_count).map(|index| piece.vertex(index).as_dvec3())
}

fn assert_unit_normals(piece: &Convex) {
    let off = |face: &Face| (face.normal.as_dvec3().length() - 1.0).abs();
    let worst = piece.faces.iter().map(off).fold(0.0, f64::max);
    assert!(worst < 1e-6, "a face's normal is {worst} off unit length");
}

/// How far a point of the world is outside a piece's box, rounding radius included.
fn outside(piece: &Convex, pose: &Pose, point: Vec3) -> f64 {
    let local = turn_of(pose).inverse() * (point.as_dvec3() - pose.translation().as_dvec3());
    let half = piece.half_extents.as_dvec3() + f64::from(piece.radius);
    let over = (local - piece.centre.as_dvec3()).abs() - half;
    over.max_element().max(0.0)
}
