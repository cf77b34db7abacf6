//! The avatar's pieces: lofts of eight rings of twelve points between two poles, or capsules.
//!
//! Sizes are fractions of the body's height. Only lengths have a source, see
//! [`palpable::human::lengths`]; widths are chosen so that the pieces of links that are not neighbours
//! keep apart while the avatar stands with hanging arms.

use glam::{Quat, Vec3};
use palpable::human::{Limb, lengths as l, mirrored_point};
use palpable::math::Pose;

use super::{AvatarPlan, Link, PiecePlan, Style};

/// Convex hulls of the avatar: trunk 3, neck, head, and 7 on each side.
pub const PIECE_COUNT: usize = 19;

/// Vertices of each hull.
pub const VERTICES_A_PIECE: usize = RINGS.len() * SIDES + 2;

/// Points of a ring.
const SIDES: usize = 12;

/// Places of the rings between the poles at -1 and 1.
const RINGS: [f32; 8] = [-0.95, -0.8, -0.55, -0.2, 0.2, 0.55, 0.8, 0.95];

/// Exponent of the outline: 2 is an ellipsoid, more is fuller.
const FULLNESS: f32 = 3.0;

/// A piece of the right half or of the middle, in the root's frame in the neutral posture.
struct Sketch {
    name: &'static str,
    limb: Option<Limb>,
    hinge: usize,
    /// Ends in fractions of the height: x to the right, y above the soles, z behind the hips.
    ends: [[f32; 3]; 2],
    /// Half widths at the first end: to the right or ahead for pieces that lie sideways, and at right
    /// angles to that.
    half: [f32; 2],
    /// Width at the second end over that at the first.
    taper: f32,
}

const fn sketch(
    name: &'static str,
    limb: Option<Limb>,
    hinge: usize,
    ends: [[f32; 3]; 2],
    half: [f32; 2],
    taper: f32,
) -> Sketch {
    Sketch {
        name,
        limb,
        hinge,
        ends,
        half,
        taper,
    }
}

/// Trunk, neck and head.
fn middle() -> [Sketch; 5] {
    let neck = Some(Limb::Neck);
    let (spine, last) = (Some(Limb::Spine), 2);
    [
        sketch(
            "pelvis",
            None,
            0,
            [[0.0, 0.480, 0.0], [0.0, 0.605, 0.0]],
            [0.094, 0.062],
            0.95,
        ),
        sketch(
            "abdomen",
            spine,
            last,
            [[0.0, 0.560, 0.0], [0.0, 0.680, 0.0]],
            [0.084, 0.058],
            1.0,
        ),
        sketch(
            "chest",
            spine,
            last,
            [[0.0, 0.640, 0.0], [0.0, 0.835, 0.0]],
            [0.095, 0.065],
            1.0,
        ),
        sketch(
            "neck",
            neck,
            2,
            [[0.0, 0.800, 0.0], [0.0, 0.890, 0.0]],
            [0.032, 0.032],
            1.0,
        ),
        sketch(
            "head",
            neck,
            2,
            [[0.0, 0.865, -0.01], [0.0, 1.0, -0.01]],
            [0.044, 0.054],
            1.0,
        ),
    ]
}

/// One arm and one leg.
fn right() -> [Sketch; 7] {
    let (arm, leg) = (Some(Limb::RightArm), Some(Limb::RightLeg));
    let (x, hip) = (l::SHOULDER_ASIDE, l::HIP_ASIDE);
    let shoulder = l::SHOULDER_HEIGHT;
    let elbow = shoulder - l::UPPER_ARM;
    let wrist = elbow - l::FOREARM;
    let heel = (1.0 - l::FOOT_BEFORE_ANKLE) * l::FOOT_LENGTH;
    let toes = -l::FOOT_BEFORE_ANKLE * l::FOOT_LENGTH;
    let sole = 0.5 * l::ANKLE_HEIGHT;
    [
        sketch(
            "upper arm",
            arm,
            2,
            [[x, shoulder + 0.02, 0.0], [x, elbow - 0.015, 0.0]],
            [0.0265, 0.0265],
            0.85,
        ),
        sketch(
            "forearm",
            arm,
            4,
            [[x, elbow + 0.015, 0.0], [x, wrist - 0.008, 0.0]],
            [0.0215, 0.0235],
            0.75,
        ),
        sketch(
            "hand",
            arm,
            6,
            [[x, wrist + 0.006, 0.0], [x, wrist - l::HAND, 0.0]],
            [0.009, 0.024],
            0.9,
        ),
        sketch(
            "thumb",
            arm,
            6,
            [[x, wrist - 0.012, -0.014], [x, wrist - 0.056, -0.042]],
            [0.0085, 0.0085],
            0.85,
        ),
        sketch(
            "thigh",
            leg,
            2,
            [
                [hip, l::HIP_HEIGHT + 0.02, 0.0],
                [hip, l::KNEE_HEIGHT - 0.02, 0.0],
            ],
            [0.045, 0.047],
            0.72,
        ),
        sketch(
            "shank",
            leg,
            3,
            [
                [hip, l::KNEE_HEIGHT + 0.02, 0.0],
                [hip, l::ANKLE_HEIGHT - 0.008, 0.0],
            ],
            [0.032, 0.034],
            0.7,
        ),
        sketch(
            "foot",
            leg,
            5,
            [[hip, sole, heel], [hip, sole, toes]],
            [0.5 * l::FOOT_BREADTH, sole],
            0.95,
        ),
    ]
}

/// All pieces of a plan that has its chains.
pub(super) fn pieces(plan: &AvatarPlan, style: Style) -> Vec<PiecePlan> {
    let mut pieces = Vec::new();
    for sketch in middle() {
        pieces.extend(piece(plan, style, &sketch, None));
    }
    for side in [Limb::LeftArm, Limb::RightArm, Limb::LeftLeg, Limb::RightLeg] {
        let (of, is_left) = match side {
            Limb::LeftArm => (Limb::RightArm, true),
            Limb::LeftLeg => (Limb::RightLeg, true),
            other => (other, false),
        };
        for sketch in right().iter().filter(|sketch| sketch.limb == Some(of)) {
            pieces.extend(piece(plan, style, sketch, Some((side, is_left))));
        }
    }
    pieces
}

fn piece(
    plan: &AvatarPlan,
    style: Style,
    sketch: &Sketch,
    side: Option<(Limb, bool)>,
) -> Vec<PiecePlan> {
    let is_left = side.is_some_and(|(_, is_left)| is_left);
    let limb = side.map_or(sketch.limb, |(limb, _)| Some(limb));
    let link = limb
        .and_then(|limb| plan.chain(limb))
        .map_or(Link::Root, |chain| Link::Behind {
            chain,
            hinge: sketch.hinge,
        });
    let prefix = match (side.is_some(), is_left) {
        (false, _) => "",
        (true, true) => "left ",
        (true, false) => "right ",
    };
    let ends = sketch.ends.map(|[x, y, z]| {
        let end = plan.height_m * Vec3::new(x, y - l::HIP_HEIGHT, z);
        if is_left { mirrored_point(end) } else { end }
    });
    let [first, second] = half_axes(sketch, ends, plan.height_m);
    let shapes = match style {
        Style::Hulls => vec![(loft(ends, first, second, sketch.taper), 0.0)],
        Style::Capsules => capsules(ends, first, second, sketch.taper),
    };
    let centre = 0.5 * (ends[0] + ends[1]);
    let local = Pose::new(Quat::IDENTITY, centre).seen_from(&neutral_link(plan, link));
    let one = |(points, radius_m): (Vec<Vec3>, f32)| PiecePlan {
        name: format!("{prefix}{}", sketch.name),
        link,
        local,
        points: points.iter().map(|&p| (p - centre).to_array()).collect(),
        radius_m,
    };
    shapes.into_iter().map(one).collect()
}

/// A link's frame in the root's frame in the neutral posture.
fn neutral_link(plan: &AvatarPlan, link: Link) -> Pose {
    let mut target = plan.neutral();
    target.root = Pose::IDENTITY;
    super::link_pose(link, &target.root, &plan.postures(&target))
}

/// Half widths across the axis: the first as near to the avatar's right as can be.
fn half_axes(sketch: &Sketch, ends: [Vec3; 2], height_m: f32) -> [Vec3; 2] {
    let axis = (ends[1] - ends[0]).normalize();
    let right = (Vec3::X - axis * axis.x).normalize();
    [
        right * (sketch.half[0] * height_m),
        axis.cross(right) * (sketch.half[1] * height_m),
    ]
}

/// Rings of an outline |s|^p + r^p = 1, stretched and tapered.
fn loft(ends: [Vec3; 2], first: Vec3, second: Vec3, taper: f32) -> Vec<Vec3> {
    let (centre, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
    let mut points = vec![ends[0]];
    for place in RINGS {
        let round = (1.0 - place.abs().powf(FULLNESS)).powf(1.0 / FULLNESS);
        let width = round * (1.0 + (taper - 1.0) * 0.5 * (1.0 + place));
        for side in 0..SIDES {
            let (sin, cos) = (std::f32::consts::TAU * side as f32 / SIDES as f32).sin_cos();
            points.push(centre + half * place + (first * cos + second * sin) * width);
        }
    }
    points.push(ends[1]);
    points
}

/// One capsule, or two side by side when the piece is much wider one way than the other.
fn capsules(ends: [Vec3; 2], first: Vec3, second: Vec3, taper: f32) -> Vec<(Vec<Vec3>, f32)> {
    let (wide, narrow) = if first.length() > second.length() {
        (first, second)
    } else {
        (second, first)
    };
    let mean = 0.5 * (1.0 + taper);
    let axis = (ends[1] - ends[0]).normalize();
    let one = |aside: Vec3, radius: f32| {
        let cut = axis * radius;
        (vec![ends[0] + cut + aside, ends[1] - cut + aside], radius)
    };
    let radius = narrow.length() * mean;
    if wide.length() < 1.3 * narrow.length() {
        return vec![one(Vec3::ZERO, radius)];
    }
    let aside = wide * mean - wide.normalize() * radius;
    vec![one(aside, radius), one(-aside, radius)]
}

const _: () = assert!(VERTICES_A_PIECE <= 100);
