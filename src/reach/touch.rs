//! Contacts of a chain, as goals of its solver.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::goal::Goal;
use crate::geometry::motion::interpolate;
use crate::limits::{CHAIN_GOALS_MAX, GAP_REST_M};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::chains::slot_range;
use crate::state::contacts::Pair;
use crate::state::ways::{Position, is_own, obstacle_pose};

/// Most contacts of one chain that are looked at; the deepest are kept.
pub(super) const TOUCHES_MAX: usize = 8;

/// A piece of a chain and a plane that its core is to stay outside of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    piece: usize,
    /// Link in the chain.
    link: usize,
    /// Toward the piece, in the solver's frame.
    normal: Vec3,
    /// In the solver's frame.
    height_m: f32,
    gap_m: f32,
}

pub(super) type Touches = ArrayVec<Touch, TOUCHES_MAX>;
pub(super) type Goals = ArrayVec<Goal, CHAIN_GOALS_MAX>;

/// Where a chain is planned: its solver's frame has its origin at the root's place at the start of the
/// leg, so that it does not lose digits far from the world's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub chain: usize,
    pub first_joint: usize,
    pub at: Position,
    pub goal: Position,
}

impl Place {
    fn origin(&self) -> Vec3 {
        self.at.root.translation()
    }

    /// The root at the end of the leg, in the solver's frame.
    pub(super) fn root(&self) -> Pose {
        self.goal.root.moved(-self.origin())
    }

    pub(super) fn point(&self, in_world: Vec3) -> Vec3 {
        in_world - self.origin()
    }

    /// The contacts that the chain is to answer.
    pub(super) fn touches(&self, state: &State, pairs: usize) -> Touches {
        let mut touches = Touches::new();
        for pair in &state.pairs.list[..pairs] {
            if pair.bends == 0 {
                continue;
            }
            let own = is_own(state, pair);
            if self.has(state, pair.a) {
                let touch = if own {
                    self.own(state, pair, pair.a, pair.b, pair.normal)
                } else {
                    self.foreign(state, pair)
                };
                keep(&mut touches, touch);
            }
            if own && self.has(state, pair.b) {
                keep(
                    &mut touches,
                    self.own(state, pair, pair.b, pair.a, -pair.normal),
                );
            }
        }
        touches
    }

    fn has(&self, state: &State, piece: u32) -> bool {
        let link = state.pieces.link[piece as usize];
        link.checked_sub(1)
            .is_some_and(|joint| state.joints.chain[joint as usize] as usize == self.chain)
    }

    fn link_of(&self, state: &State, piece: u32) -> usize {
        state.pieces.link[piece as usize] as usize - 1 - self.first_joint
    }

    /// A contact with a thing that stands still.
    fn foreign(&self, state: &State, pair: &Pair) -> Touch {
        let (a, b) = (pair.a as usize, pair.b as usize);
        let other = state.pools.convex(&state.pieces.shape[b]);
        let pose = obstacle_pose(state, b);
        let reach = other.support(pose.quat().conjugate() * pair.normal).reach;
        let apart = pair.normal.dot(pose.translation() - self.origin());
        let own_radius = state.pieces.shape[a].radius;
        Touch {
            piece: a,
            link: self.link_of(state, pair.a),
            normal: pair.normal,
            height_m: apart + reach + other.radius + own_radius + GAP_REST_M + pair.lost,
            gap_m: pair.gap,
        }
    }

    /// A contact with another piece of the same body: a plane in the root's frame. Pieces of two chains
    /// keep to their halves of the gap; beside the root, or a link that the chain hangs on, the chain
    /// alone gives way.
    fn own(&self, state: &State, pair: &Pair, piece: u32, other: u32, normal: Vec3) -> Touch {
        let index = piece as usize;
        let in_root = self.at.root.quat().conjugate() * normal;
        let joint = state.pieces.link[index] as usize - 1;
        let link = state.ways.from_link[slot_range(state, self.at.leg).start + joint];
        let pose = link.then(&self.local(state, index, self.at.local));
        let core = state.pools.convex(&state.pieces.shape[index]);
        let reach = core.support(pose.quat().conjugate() * -in_root).reach;
        let here = in_root.dot(pose.translation()) - reach;
        let missing = GAP_REST_M - pair.gap;
        let share = if self.gives_way(state, other) {
            0.5
        } else {
            1.0
        };
        let root = self.root();
        let turned = root.quat() * in_root;
        Touch {
            piece: index,
            link: self.link_of(state, piece),
            normal: turned,
            height_m: here + share * missing + turned.dot(root.translation()),
            gap_m: pair.gap,
        }
    }

    /// Whether a piece is on a chain that is planned beside this one.
    fn gives_way(&self, state: &State, piece: u32) -> bool {
        let Some(joint) = state.pieces.link[piece as usize].checked_sub(1) else {
            return false;
        };
        let chain = state.joints.chain[joint as usize];
        let mut base = state.chains.base[self.chain];
        while let Some(under) = base.checked_sub(1) {
            let under = state.joints.chain[under as usize];
            if under == chain {
                return false;
            }
            base = state.chains.base[under as usize];
        }
        true
    }

    fn local(&self, state: &State, piece: usize, share: f32) -> Pose {
        let pieces = &state.pieces;
        interpolate(&pieces.local[piece], &pieces.local_target[piece], share)
    }

    /// Adds the goal of the point of a touching piece that is lowest over its plane when its link is
    /// turned so, unless it is there already; whether it was added.
    pub(super) fn add_goal(
        &self,
        state: &State,
        touch: &Touch,
        link: &Pose,
        goals: &mut Goals,
    ) -> bool {
        let local = self.local(state, touch.piece, self.goal.local);
        let turned = link.quat() * local.quat();
        let core = state.pools.convex(&state.pieces.shape[touch.piece]);
        let lowest = core.support(turned.conjugate() * -touch.normal).index;
        let goal = Goal {
            link: touch.link,
            point: local.point(core.vertex(lowest)),
            normal: touch.normal,
            height_m: touch.height_m,
            is_exact: false,
            softness: 0.0,
        };
        !goals.contains(&goal) && goals.try_push(goal).is_ok()
    }
}

impl Touch {
    pub(super) fn link(&self) -> usize {
        self.link
    }
}

/// Adds a contact; when there is no room, it takes the place of the one with the widest gap.
fn keep(touches: &mut Touches, touch: Touch) {
    if touches.try_push(touch).is_ok() {
        return;
    }
    let mut widest = 0;
    for (index, other) in touches.iter().enumerate() {
        if other.gap_m > touches[widest].gap_m {
            widest = index;
        }
    }
    if touches[widest].gap_m > touch.gap_m {
        touches[widest] = touch;
    }
}

/// The lowest of the heights of goals over their planes, zero when none is below.
pub(super) fn deepest_m(goals: &[Goal], posture: &crate::geometry::chain::Posture) -> f32 {
    goals
        .iter()
        .filter(|goal| goal.softness == 0.0)
        .fold(0.0, |deepest, goal| {
            math::max(goal.missed_m(posture), deepest)
        })
}
