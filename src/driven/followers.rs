//! Loose bodies that followed a driven one to where it goes back to.
//!
//! They come out of it the shortest way, mostly some of the way that they came, if they are clear of everything there.
//! Their motion stays as it is. Spends units of the advance: a distance query for every two pieces whose boxes
//! overlap, and parts for the boxes.

use arrayvec::ArrayVec;
use glam::Vec3;

use crate::contacts::{are_clear, way_off};
use crate::limits::LOOSE_REST_M;
use crate::math::Pose;
use crate::state::State;
use crate::state::bodies::{BodyKind, is_loose_kind};
use crate::state::contacts::box_parts;
use crate::state::loose;
use crate::state::pieces::PiecesOf;
use crate::state::purse::Purse;
use crate::state::ways::{Position, obstacle_pose, piece_pose};

/// Most bodies that step back: more have hardly come to one place within a frame.
const FOLLOWERS_MAX: usize = 8;

/// Takes loose bodies out of a driven one at a place; false, and nobody moved, when one of them cannot get out or
/// the units ran out.
#[cold]
pub(super) fn step_back(state: &mut State, body: usize, at: &Position, purse: &mut Purse) -> bool {
    let mut moved: ArrayVec<(usize, Pose), FOLLOWERS_MAX> = ArrayVec::new();
    for follower in 0..state.registers.body_slots as usize {
        // What the host's own engine moves is where that has it.
        if state.bodies.kind[follower] != BodyKind::Dynamic.code() {
            continue;
        }
        let stood = state.bodies.pose[follower];
        let gets_out = leaves(state, follower, body, at, purse);
        let moves = state.bodies.pose[follower] != stood;
        if gets_out && (!moves || moved.try_push((follower, stood)).is_ok()) {
            continue;
        }
        state.bodies.pose[follower] = stood;
        for (other, stood) in moved {
            state.bodies.pose[other] = stood;
        }
        return false;
    }
    true
}

/// Takes one of them out, if it is in there and clear of everything elsewhere; whether it is out then.
fn leaves(
    state: &mut State,
    follower: usize,
    body: usize,
    at: &Position,
    purse: &mut Purse,
) -> bool {
    let Some(way) = way_out(state, follower, body, at, purse) else {
        return false;
    };
    if way == Vec3::ZERO {
        return true;
    }
    let stood = state.bodies.pose[follower];
    state.bodies.pose[follower] = stood.moved(way);
    let clear = is_clear(state, follower, body, at, purse);
    if !clear {
        state.bodies.pose[follower] = stood;
    }
    clear
}

/// The longest way on which a loose body gets out of one piece of a driven one; zero when it is in none, `None` when
/// the units ran out.
fn way_out(
    state: &State,
    follower: usize,
    body: usize,
    at: &Position,
    purse: &mut Purse,
) -> Option<Vec3> {
    let [own, others] =
        [follower, body].map(|of| PiecesOf::new(state.pieces.next, state.bodies.first_piece[of]));
    let pairs = own.clone().count() * others.clone().count();
    if !purse.take_parts(box_parts(pairs)) {
        return None;
    }
    let mut longest = Vec3::ZERO;
    for own in own {
        for other in others.clone() {
            let poses = [loose::piece_pose(state, own), piece_pose(state, other, at)];
            let way = way_off(state, [own, other], &poses, LOOSE_REST_M, purse)?;
            if way.length_squared() > longest.length_squared() {
                longest = way;
            }
        }
    }
    Some(longest)
}

/// Whether a loose body is clear of everything with a driven one at a place; false, too, when the units ran out.
fn is_clear(state: &State, follower: usize, body: usize, at: &Position, purse: &mut Purse) -> bool {
    let own = PiecesOf::new(state.pieces.next, state.bodies.first_piece[follower]);
    let slots = state.registers.piece_slots as usize;
    if !purse.take_parts(box_parts(own.clone().count() * slots)) {
        return false;
    }
    let is_other = |&other: &usize| {
        let is_alive = state.pieces.body_kind[other] != 0;
        is_alive && state.pieces.body[other] as usize != follower
    };
    let place = |other: usize| -> Pose {
        if state.pieces.body[other] as usize == body {
            piece_pose(state, other, at)
        } else if is_loose_kind(state.pieces.body_kind[other]) {
            loose::piece_pose(state, other)
        } else {
            obstacle_pose(state, other)
        }
    };
    own.into_iter().all(|own| {
        let pose = loose::piece_pose(state, own);
        let mut others = (0..slots).filter(is_other);
        others.all(|other| are_clear(state, [own, other], &[pose, place(other)], purse))
    })
}
