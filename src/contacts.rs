//! 3 contacts: how deep a driven body is where the host put it, and the way out.
//!
//! The kernel itself never lets a driven body overlap a fixed one, so overlap at the start of a frame
//! was made by the host: it spawned a body, or placed one. The way out is the global penetration depth
//! of the two unions, searched as [`crate::geometry::union`] says; the paper's equation 1 stays there
//! for comparison. While nothing overlaps, this stage costs one look at the pairs' boxes, and contacts
//! are measured by the stage that needs them, where the body is on its way.

use arrayvec::ArrayVec;
use glam::Vec3;

use crate::geometry::separation::{separation, separation_from};
use crate::geometry::union::{
    NODES_USUAL, UNION_PAIRS_MAX, UnionPair, UnionScratch, least_translation,
};
use crate::limits::{
    GAP_REST_M, GAP_TOUCHING_M, OVERLAP_SLOP_M, WAY_OUT_OTHERS_MAX, WAY_OUT_PAIR_UNITS,
    WAY_OUT_UNITS, WORLD_REACH_M,
};
use crate::math::Pose;
use crate::state::State;
use crate::state::bodies::is_loose_kind;
use crate::state::contacts::{self, ContactPoint, Pair};
use crate::state::loose;
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::purse::Purse;
use crate::state::ways::{Position, is_own, lost_m, obstacle_bounds, obstacle_pose, piece_pose};

/// Where a driven body that overlaps fixed pieces or other driven bodies gets clear of the pairs whose gap may be
/// less than `within_m`, moved as a whole; `None` when no way out was found.
///
/// The search spends [`WAY_OUT_UNITS`], and [`WAY_OUT_PAIR_UNITS`] and more a pair, and is not begun with fewer. It
/// keeps about 130 kB on the stack.
pub(crate) fn way_out(
    state: &State,
    pairs: usize,
    at: &Position,
    within_m: f32,
    purse: &mut Purse,
) -> Option<Pose> {
    let is_near = |pair: &&Pair| pair.gap < within_m && !is_own(state, pair);
    let near = || state.pairs.list[..pairs].iter().filter(is_near);
    let searched = near().count().min(UNION_PAIRS_MAX) as u32;
    let for_each = WAY_OUT_PAIR_UNITS + searched.min(WAY_OUT_OTHERS_MAX);
    if !purse.take(WAY_OUT_UNITS + for_each * searched) {
        return None;
    }
    let mut listed: ArrayVec<UnionPair, UNION_PAIRS_MAX> = ArrayVec::new();
    for pair in near() {
        let (a, b) = (pair.a as usize, pair.b as usize);
        listed
            .try_push(UnionPair {
                a: state.pools.convex(&state.pieces.shape[a]),
                a_pose: pose_of(state, pair, at),
                b: state.pools.convex(&state.pieces.shape[b]),
                b_pose: obstacle_pose(state, b),
            })
            .ok()?;
    }
    let mut scratch = UnionScratch::new();
    let found = least_translation(&listed, GAP_REST_M, NODES_USUAL, &mut scratch);
    let out = at.root.moved(found.offset);
    let inside = out.translation().abs().cmple(Vec3::splat(WORLD_REACH_M));
    (found.verified && inside.all()).then_some(out)
}

/// How deep a body is in what it was measured against, in metres; zero when it is clear of that.
pub(crate) fn depth_m(state: &State, pairs: usize) -> f32 {
    let measured = state.pairs.list[..pairs]
        .iter()
        .filter(|pair| pair.measured == 1 && !is_own(state, pair));
    measured.fold(0.0, |deepest, pair| crate::math::max(-pair.gap, deepest))
}

/// Whether a body is clear of the pieces that it is paired with; `None` when the units ran out. Spends a
/// distance query a pair whose boxes overlap there.
pub(crate) fn is_clear(
    state: &State,
    pairs: usize,
    at: &Position,
    purse: &mut Purse,
) -> Option<bool> {
    Some(deepest_gap(state, pairs, at, purse)? > 0.0)
}

/// Whether the links of a body are clear of each other but for the slop; false, too, when the units ran out.
/// Spends a distance query a pair of its own pieces whose boxes overlap.
pub(crate) fn is_clear_of_itself(
    state: &State,
    pairs: usize,
    at: &Position,
    purse: &mut Purse,
) -> bool {
    let own = state.pairs.list[..pairs]
        .iter()
        .filter(|pair| is_own(state, pair));
    own.into_iter().all(|pair| {
        let pieces = [pair.a as usize, pair.b as usize];
        let poses = pieces.map(|piece| piece_pose(state, piece, &at.in_root()));
        are_clear(state, pieces, &poses, purse)
    })
}

/// Whether a driven body is clear of loose ones but for the slop; false, too, when the units ran out. Spends
/// a distance query a pair of pieces whose boxes overlap there, and parts of a unit for the boxes.
pub(crate) fn is_clear_of_loose(
    state: &State,
    body: usize,
    at: &Position,
    purse: &mut Purse,
) -> bool {
    let own = || PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]);
    let slots = state.registers.piece_slots as usize;
    purse.take_parts(contacts::box_parts(own().count() * slots))
        && own().all(|a| {
            let pose = piece_pose(state, a, at);
            (0..slots).all(|b| {
                !is_loose_kind(state.pieces.body_kind[b])
                    || are_clear(state, [a, b], &[pose, loose::piece_pose(state, b)], purse)
            })
        })
}

/// Whether two pieces are clear of each other but for the slop; false, too, when the units ran out.
pub(crate) fn are_clear(
    state: &State,
    pieces: [usize; 2],
    poses: &[Pose; 2],
    purse: &mut Purse,
) -> bool {
    way_off(state, pieces, poses, 0.0, purse) == Some(Vec3::ZERO)
}

/// How the first of two pieces gets so far away from the other one if they overlap by more than the slop; zero when
/// they do not, `None` when the units ran out. Spends a distance query when the boxes overlap.
pub(crate) fn way_off(
    state: &State,
    pieces: [usize; 2],
    poses: &[Pose; 2],
    rest_m: f32,
    purse: &mut Purse,
) -> Option<Vec3> {
    let [a, b] = pieces.map(|piece| &state.pieces.shape[piece]);
    let [pose_a, pose_b] = poses;
    if Bounds::of(a, pose_a).gap(&Bounds::of(b, pose_b)) >= 0.0 {
        return Some(Vec3::ZERO);
    }
    if !purse.take(contacts::query_units(a, b)) {
        return None;
    }
    let (a, b) = (state.pools.convex(a), state.pools.convex(b));
    let found = separation(&a, &b, pose_a, pose_b, Vec3::ZERO);
    if found.gap_m > -OVERLAP_SLOP_M {
        return Some(Vec3::ZERO);
    }
    Some(found.normal * (rest_m - found.gap_m))
}

/// The moving piece's pose where the body is.
fn pose_of(state: &State, pair: &Pair, at: &Position) -> Pose {
    piece_pose(state, pair.a as usize, at)
}

/// The least gap of the pairs whose boxes overlap; infinite when there are none, `None` when the units
/// ran out.
fn deepest_gap(state: &State, pairs: usize, at: &Position, purse: &mut Purse) -> Option<f32> {
    let mut deepest = f32::INFINITY;
    for pair in &state.pairs.list[..pairs] {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let pose = pose_of(state, pair, at);
        let shape = &state.pieces.shape[a];
        let bounds = Bounds::of(shape, &pose);
        let lost = lost_m(state, pair, &at.still(), &pose, 0.0);
        if is_own(state, pair) || bounds.gap(&obstacle_bounds(state, b)) >= lost {
            continue;
        }
        if !purse.take(contacts::query_units(
            &state.pieces.shape[a],
            &state.pieces.shape[b],
        )) {
            return None;
        }
        let found = separation(
            &state.pools.convex(shape),
            &state.pools.convex(&state.pieces.shape[b]),
            &pose,
            &obstacle_pose(state, b),
            Vec3::ZERO,
        );
        deepest = crate::math::min(found.gap_m, deepest);
    }
    Some(deepest)
}

/// Measures, at the leg's start, every pair that may be in contact there. False when the budget ran
/// out.
///
/// The boxes tell most pairs apart without a query.
pub(crate) fn measure_touching(
    state: &mut State,
    pairs: usize,
    at: &Position,
    purse: &mut Purse,
) -> bool {
    if !purse.take_parts(contacts::scan_parts(pairs)) {
        return false;
    }
    let mut known = None;
    let is_shown = is_where_shown(state, pairs, at);
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        if pair.measured == 1 || !touches(pair.gap) {
            continue;
        }
        let (poses, apart) = if is_shown {
            boxes_shown_apart(state, &pair)
        } else {
            boxes_apart(state, &pair, at, &mut known)
        };
        let lost = lost_m(state, &pair, &at.still(), &poses[0], 0.0);
        let pair = &mut state.pairs.list[index];
        pair.gap_time = 0.0;
        pair.lost = lost;
        if !touches(apart - lost) {
            pair.gap = apart - lost;
            continue;
        }
        let [a, b] = [pair.a, pair.b].map(|piece| &state.pieces.shape[piece as usize]);
        if !purse.take(contacts::query_units(a, b)) {
            return false;
        }
        measure(state, index, at, &poses);
    }
    true
}

/// A piece, where it is, and its box: pairs of one piece follow each other.
type Placed = Option<(u32, Pose, Bounds)>;

/// Whether the body that these pairs are of is where it was published.
fn is_where_shown(state: &State, pairs: usize, at: &Position) -> bool {
    state.pairs.list[..pairs].first().is_some_and(|pair| {
        let body = state.pieces.body[pair.a as usize] as usize;
        let is_at_start = at.leg == 0 && at.share == 0.0 && at.local == 0.0;
        is_at_start && at.root == state.bodies.pose[body]
    })
}

/// [`boxes_apart`] for a body that is where it was published: poses and boxes are known.
fn boxes_shown_apart(state: &State, pair: &Pair) -> ([Pose; 2], f32) {
    let (a, b) = (pair.a as usize, pair.b as usize);
    let pieces = &state.pieces;
    if is_own(state, pair) {
        let poses = [a, b].map(|piece| match pieces.link[piece].checked_sub(1) {
            Some(joint) => state.joints.link[joint as usize].then(&pieces.local[piece]),
            None => pieces.local[piece],
        });
        return (poses, pieces.own_bounds[a].gap(&pieces.own_bounds[b]));
    }
    let poses = [pieces.world[a], obstacle_pose(state, b)];
    (poses, pieces.bounds[a].gap(&obstacle_bounds(state, b)))
}

/// Where the pieces of a pair are, and how far their boxes are apart: in the root's frame for pieces of one
/// body.
fn boxes_apart(state: &State, pair: &Pair, at: &Position, known: &mut Placed) -> ([Pose; 2], f32) {
    let (a, b) = (pair.a as usize, pair.b as usize);
    let shapes = &state.pieces.shape;
    if is_own(state, pair) {
        let poses = [a, b].map(|piece| piece_pose(state, piece, &at.in_root()));
        let bounds = Bounds::of(&shapes[a], &poses[0]);
        return (poses, bounds.gap(&Bounds::of(&shapes[b], &poses[1])));
    }
    let (pose, bounds) = match *known {
        Some((piece, pose, bounds)) if piece == pair.a => (pose, bounds),
        _ => {
            let pose = piece_pose(state, a, at);
            (pose, Bounds::of(&shapes[a], &pose))
        }
    };
    *known = Some((pair.a, pose, bounds));
    let apart = bounds.gap(&obstacle_bounds(state, b));
    ([pose, obstacle_pose(state, b)], apart)
}

/// Measures the gap of a pair, less what is lost of it, and where it is in the world.
fn measure(state: &mut State, index: usize, at: &Position, poses: &[Pose; 2]) {
    let own = is_own(state, &state.pairs.list[index]);
    let pair = &mut state.pairs.list[index];
    let [a, b] = [pair.a, pair.b].map(|piece| &state.pieces.shape[piece as usize]);
    let found = separation_from(
        &state.pools.convex(a),
        &state.pools.convex(b),
        &poses[0],
        &poses[1],
        &mut pair.feature,
        0.0,
    );
    pair.gap = found.gap_m - pair.lost;
    pair.normal = found.normal;
    pair.point = 0.5 * (found.point_a + found.point_b);
    if own {
        pair.normal = at.root.quat() * pair.normal;
        pair.point = at.root.point(pair.point);
    }
    pair.measured = 1;
}

/// Notes which pairs are in contact where the next leg starts.
pub(crate) fn mark_touching(state: &mut State, pairs: usize) {
    for pair in &mut state.pairs.list[..pairs] {
        pair.bends = u32::from(pair.measured == 1 && touches(pair.gap));
        pair.bending_gap = pair.gap + pair.lost;
    }
}

/// Writes the contacts that the last leg met where the host can read them; false when there was no room
/// for all.
pub(crate) fn record(state: &mut State, pairs: usize) -> bool {
    let mut all = true;
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        if pair.bends == 1 {
            let point = ContactPoint {
                piece_a: state.pieces.id(pair.a),
                piece_b: state.pieces.id(pair.b),
                point: pair.point.to_array(),
                normal: pair.normal.to_array(),
                gap_m: pair.bending_gap,
                impulse_n_s: 0.0,
                approach_m_s: 0.0,
                slide_m_s: 0.0,
            };
            all &= contacts::add(state, point);
        }
    }
    all
}

/// Whether a measured pair overlaps, links of the body with each other aside.
pub(crate) fn overlaps(state: &State, pairs: usize) -> bool {
    state.pairs.list[..pairs]
        .iter()
        .any(|pair| pair.measured == 1 && pair.gap + pair.lost < 0.0 && !is_own(state, pair))
}

/// Whether a measured pair is in contact.
pub(crate) fn touches_any(state: &State, pairs: usize) -> bool {
    state.pairs.list[..pairs]
        .iter()
        .any(|pair| pair.measured == 1 && touches(pair.gap))
}

/// Whether a gap counts as contact.
fn touches(gap: f32) -> bool {
    gap <= GAP_TOUCHING_M
}
