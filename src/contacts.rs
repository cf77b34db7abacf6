//! 3 contacts: how deep a driven body is where the host put it, and the way out.
//!
//! The kernel itself never lets a driven body overlap a fixed one, so overlap at the start of a frame
//! was made by the host: it spawned a body, or placed one. The way out is the global penetration depth
//! of the two unions, searched as [`crate::geometry::union`] says; the paper's equation 1 stays there
//! for comparison. While nothing overlaps, this stage costs one look at the pairs' boxes, and contacts
//! are measured by the stage that needs them, where the body is on its way.

use arrayvec::ArrayVec;

use crate::frame::budget::Purse;
use crate::geometry::separation::separation;
use crate::geometry::union::{
    NODES_USUAL, UNION_PAIRS_MAX, UnionPair, UnionScratch, least_translation,
};
use crate::limits::GAP_REST_M;
use crate::math::Pose;
use crate::state::State;
use crate::state::contacts::Pair;

/// Where a driven body at `root` that overlaps fixed pieces gets clear of them; `None` when no way out
/// was found and verified.
///
/// Verifying spends one unit a pair whose boxes overlap there. The search keeps about 130 kB on the
/// stack.
pub(crate) fn way_out(
    state: &mut State,
    pairs: usize,
    root: &Pose,
    purse: &mut Purse,
) -> Option<Pose> {
    let out = search(state, pairs, root)?;
    let left = deepest_gap(state, pairs, &out, purse)?;
    (left > 0.0).then_some(out)
}

/// The pieces' poses when the body is at `root` with its published local poses.
fn pose_of(state: &State, pair: &Pair, root: &Pose) -> Pose {
    root.then(&state.pieces.local[pair.a as usize])
}

/// The least gap of the pairs whose boxes overlap; infinite when there are none, `None` when the units
/// ran out.
fn deepest_gap(state: &State, pairs: usize, root: &Pose, purse: &mut Purse) -> Option<f32> {
    let mut deepest = f32::INFINITY;
    for pair in &state.pairs.list[..pairs] {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let pose = pose_of(state, pair, root);
        let shape = &state.pieces.shape[a];
        let bounds = crate::state::pieces::Bounds::of(shape, &pose);
        if bounds.gap(&state.pieces.bounds[b]) >= 0.0 {
            continue;
        }
        if !purse.take() {
            return None;
        }
        let found = separation(
            &state.pools.convex(shape),
            &state.pools.convex(&state.pieces.shape[b]),
            &pose,
            &state.pieces.world[b],
            glam::Vec3::ZERO,
        );
        deepest = crate::math::min(found.gap_m, deepest);
    }
    Some(deepest)
}

/// The body moved by the global penetration depth of all its pairs.
fn search(state: &State, pairs: usize, root: &Pose) -> Option<Pose> {
    let mut listed: ArrayVec<UnionPair, UNION_PAIRS_MAX> = ArrayVec::new();
    for pair in &state.pairs.list[..pairs] {
        let (a, b) = (pair.a as usize, pair.b as usize);
        listed
            .try_push(UnionPair {
                a: state.pools.convex(&state.pieces.shape[a]),
                a_pose: pose_of(state, pair, root),
                b: state.pools.convex(&state.pieces.shape[b]),
                b_pose: state.pieces.world[b],
            })
            .ok()?;
    }
    let mut scratch = UnionScratch::new();
    let found = least_translation(&listed, GAP_REST_M, NODES_USUAL, &mut scratch);
    found.verified.then(|| root.moved(found.offset))
}
