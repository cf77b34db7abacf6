//! Bending the way of a body's root along contact planes.
//!
//! The least change of the wanted pose that keeps every touching piece outside its contact plane
//! (Gauss's principle of least constraint; Ortega, Redon and Coquillart 2007, section 4, restricted to
//! translations as the paper's hand is).

use glam::Vec3;

use super::Plan;
use super::skeleton::goes_with_root;
use crate::geometry::time_of_contact::plane_gap;
use crate::limits::{GAP_FLOOR_M, GAP_REST_M, SLIDE_PLANES_MAX};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::contacts::Pair;
use crate::state::ways::{Position, in_world, is_own, obstacle_pose, piece_motion, track};

/// A half-space of translations: normal . u >= offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HalfSpace {
    pub normal: Vec3,
    pub offset: f32,
}

pub(super) type HalfSpaces = heapless::Vec<HalfSpace, SLIDE_PLANES_MAX>;

/// Where to go from `at`: the wanted position, moved by the least translation that keeps every
/// touching piece outside its contact plane. Where no translation does (a slot, a wedge), turn and
/// local poses stay as they are and only the wanted translation is bent; staying is then allowed.
///
/// `missed` are planes that chains could not keep out of, with how far the wanted root is behind them.
pub(super) fn plan(
    state: &State,
    pairs: usize,
    at: &Position,
    wanted: &Position,
    keep_turn: bool,
    missed: &HalfSpaces,
) -> Plan {
    if !keep_turn {
        let mut planes = whole_motion_planes(state, pairs, at, wanted);
        for plane in missed {
            add(&mut planes, plane.normal, plane.offset);
        }
        let reach = reach_m(at, wanted, &planes);
        match nearest_outside(&planes) {
            Some(u) if math::length(u) <= reach => {
                return Plan {
                    goal: Position {
                        root: kept_in_world(at, &moved(&wanted.root, u)),
                        ..*wanted
                    },
                    bent: u != Vec3::ZERO,
                    share: 1.0,
                };
            }
            _ => {}
        }
    }
    plan_translation(state, pairs, at, wanted)
}

/// Whether a pair is in contact and moves the root: its piece is on the root, or on a chain that goes
/// with the root.
fn moves_root(state: &State, pair: &Pair) -> bool {
    pair.bends == 1 && !is_own(state, pair) && {
        let link = state.pieces.link[pair.a as usize];
        link.checked_sub(1).is_none_or(|joint| {
            let chain = state.joints.chain[joint as usize] as usize;
            goes_with_root(state, chain)
        })
    }
}

fn moved(pose: &Pose, u: Vec3) -> Pose {
    if u == Vec3::ZERO {
        *pose
    } else {
        pose.moved(u)
    }
}

/// A correction farther than this undoes more than the whole way and is not a slide.
fn reach_m(at: &Position, wanted: &Position, planes: &HalfSpaces) -> f32 {
    let mut deepest = 0.0;
    for plane in planes {
        deepest = math::max(deepest, plane.offset);
    }
    2.0 * (math::length(wanted.root.translation() - at.root.translation()) + deepest)
}

/// The touching pairs' planes, with the offsets that the wanted end pose violates them by.
fn whole_motion_planes(
    state: &State,
    pairs: usize,
    at: &Position,
    wanted: &Position,
) -> HalfSpaces {
    let leg = track(at, wanted);
    let mut planes = HalfSpaces::new();
    for pair in &state.pairs.list[..pairs] {
        if moves_root(state, pair) {
            let (a, b) = (pair.a as usize, pair.b as usize);
            let end = plane_gap(
                &state.pools.convex(&state.pieces.shape[a]),
                &state.pools.convex(&state.pieces.shape[b]),
                &piece_motion(state, a, &leg).at(1.0),
                &obstacle_pose(state, b),
                pair.normal,
            );
            add(&mut planes, pair.normal, GAP_REST_M + pair.lost - end);
        }
    }
    planes
}

/// Adds a plane; when there is no room, it takes the place of the one that binds least.
pub(super) fn add(planes: &mut HalfSpaces, normal: Vec3, offset: f32) {
    let plane = HalfSpace { normal, offset };
    if planes.push(plane).is_ok() {
        return;
    }
    let mut loosest = 0;
    for i in 1..planes.len() {
        if planes[i].offset < planes[loosest].offset {
            loosest = i;
        }
    }
    if planes[loosest].offset < offset {
        planes[loosest] = plane;
    }
}

/// The wanted translation alone, bent along the touching planes. A gap below the floor, which rounding made far
/// from the origin or the host anywhere, is widened to the floor where all can be: f32 would take a little of it
/// on every slide.
fn plan_translation(state: &State, pairs: usize, at: &Position, wanted: &Position) -> Plan {
    let way = wanted.root.translation() - at.root.translation();
    let widened = translation_planes(state, pairs, way, GAP_FLOOR_M);
    let step = nearest_outside(&widened)
        .or_else(|| nearest_outside(&translation_planes(state, pairs, way, f32::NEG_INFINITY)))
        .map_or(Vec3::ZERO, |u| way + u);
    Plan {
        goal: Position {
            root: kept_in_world(at, &at.root.moved(step)),
            local: at.local,
            ..*wanted
        },
        bent: true,
        share: 1.0,
    }
}

/// The touching pairs' planes, with the offsets that a translation violates them by when gaps are to stay what
/// they are, but at least `least_m`.
fn translation_planes(state: &State, pairs: usize, way: Vec3, least_m: f32) -> HalfSpaces {
    let mut planes = HalfSpaces::new();
    for pair in &state.pairs.list[..pairs] {
        if moves_root(state, pair) {
            let kept = math::min(GAP_REST_M, math::max(pair.gap, least_m));
            let offset = kept - pair.gap - pair.normal.dot(way);
            add(&mut planes, pair.normal, offset);
        }
    }
    planes
}

/// A pose, or, where that is out of the world, one with the same turn on the straight way there.
fn kept_in_world(at: &Position, to: &Pose) -> Pose {
    let beyond = to.translation() - in_world(to.translation());
    if beyond == Vec3::ZERO {
        return *to;
    }
    let from = at.root.translation();
    let way = to.translation() - from;
    let mut share = 1.0;
    for (beyond, way) in beyond.to_array().into_iter().zip(way.to_array()) {
        if beyond != 0.0 {
            share = math::min(share, math::max(0.0, 1.0 - beyond / way));
        }
    }
    Pose::new(to.quat(), in_world(from + way * share))
}

/// How much a plane may be violated by rounding, in metres.
const ROUNDING_M: f32 = 1e-7;

/// The shortest vector inside all half-spaces, or `None` when there is none.
///
/// Seidel's incremental scheme: a vector that violates the next half-space is replaced by the
/// shortest on its plane that satisfies all before it, which is the same problem in one dimension
/// less. Cost: at most of the order of n^3 for n half-spaces, n when few bind.
pub(super) fn nearest_outside(planes: &[HalfSpace]) -> Option<Vec3> {
    let mut u = Vec3::ZERO;
    for (i, plane) in planes.iter().enumerate() {
        if plane.normal.dot(u) < plane.offset - ROUNDING_M {
            u = shortest_on_plane(plane, &planes[..i])?;
        }
    }
    Some(u)
}

fn shortest_on_plane(on: &HalfSpace, planes: &[HalfSpace]) -> Option<Vec3> {
    let mut u = on.normal * on.offset;
    for (i, plane) in planes.iter().enumerate() {
        if plane.normal.dot(u) < plane.offset - ROUNDING_M {
            u = shortest_on_line(on, plane, &planes[..i])?;
        }
    }
    Some(u)
}

fn shortest_on_line(first: &HalfSpace, second: &HalfSpace, planes: &[HalfSpace]) -> Option<Vec3> {
    let along = math::direction(first.normal.cross(second.normal))?;
    let cosine = first.normal.dot(second.normal);
    let sine_squared = 1.0 - cosine * cosine;
    if sine_squared < 1e-6 {
        return None;
    }
    let first_weight = (first.offset - cosine * second.offset) / sine_squared;
    let second_weight = (second.offset - cosine * first.offset) / sine_squared;
    let base = first.normal * first_weight + second.normal * second_weight;
    let (mut low, mut high) = (f32::NEG_INFINITY, f32::INFINITY);
    for plane in planes {
        let slope = plane.normal.dot(along);
        let missing = plane.offset - plane.normal.dot(base);
        if slope.abs() < 1e-6 {
            if missing > 1e-5 {
                return None;
            }
        } else if slope > 0.0 {
            low = math::max(low, missing / slope);
        } else {
            high = math::min(high, missing / slope);
        }
    }
    (low <= high + 1e-6).then(|| base + along * math::clamp(0.0, low, high))
}
