//! Chains of joints between the links of a driven body, and their angles.
//!
//! A chain's joints lie side by side, a chain's base before the chain itself, so that one pass over the
//! joints in their order meets every parent before its children.

use core::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::chain::{Ball, Hinge};
use crate::geometry::linkage::Linkage;
use crate::geometry::reach_cone::ReachCone;
use crate::limits::LEGS_MAX;
use crate::math::Pose;
use crate::memory::columns::columns;
use crate::state::State;
use crate::state::pieces::Bounds;

/// How a chain answers contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ChainOptions {
    /// One of the `ChainOptions::LEAST_DEVIATION` constants.
    pub method: u32,
    /// Bits of [`ChainOptions::MOVES_ROOT`] and the others.
    pub flags: u32,
    /// Time constant of the return to the tracked angles where contact no longer holds the chain from
    /// them, in seconds: the deviation left after h seconds is exp(-h / attraction).
    pub attraction_s: f32,
    /// With [`ChainOptions::HOLDS_TIP`]: the point of the last link that stays at the tracked place as far
    /// as contact allows, in that link's frame, in metres.
    pub tip: [f32; 3],
}

impl ChainOptions {
    /// The least change from the tracked angles.
    pub const LEAST_DEVIATION: u32 = 0;
    /// Cyclic coordinate descent, the method of Schmidl and Lin 2004, begun with what contact did in the last frame.
    pub const CYCLIC_DESCENT: u32 = 1;

    /// What the chain cannot evade, the body's root does.
    pub const MOVES_ROOT: u32 = 1;
    /// The chain's links keep out of the links of other chains of the body, and of its root, where those
    /// do so too. The root always does.
    pub const MEETS_BODY: u32 = 1 << 1;
    /// The tip is kept at its tracked place, along the surface it touches; the joints give way instead.
    pub const HOLDS_TIP: u32 = 1 << 2;
    /// Contact moves the root alone: the joints follow the tracked angles, as a rigid group does.
    pub const RIGID: u32 = 1 << 3;
    /// Among chains that hang on the same, this one's turn comes by a number drawn from frame and chain, as
    /// in Schmidl and Lin 2004, instead of by how deep it is.
    pub const SHUFFLED: u32 = 1 << 4;

    /// Least deviation, moves the root, returns with a time constant of 60 ms.
    pub const DEFAULT: Self = Self {
        method: Self::LEAST_DEVIATION,
        flags: Self::MOVES_ROOT,
        attraction_s: 0.06,
        tip: [0.0; 3],
    };

    /// Whether the method and the flags are known, the attraction is 0 to 1e6 s, and the tip is finite.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let known =
            Self::MOVES_ROOT | Self::MEETS_BODY | Self::HOLDS_TIP | Self::RIGID | Self::SHUFFLED;
        self.method <= Self::CYCLIC_DESCENT
            && self.flags & !known == 0
            && (0.0..=1e6).contains(&self.attraction_s)
            && Vec3::from_array(self.tip).is_finite()
    }

    pub(crate) fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }
}

impl Default for ChainOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What a frame did to a chain.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ChainReport {
    /// Bits of [`ChainReport::BENT`] and the others.
    pub flags: u32,
    /// Steps of the solver that were spent.
    pub steps: u32,
    /// The most that a contact's plane is still violated by in the plan, in metres. The published posture
    /// overlaps nothing all the same: the way ends before.
    pub missed_m: f32,
    /// The most that any angle is from its tracked one, in radians.
    pub deviation_rad: f32,
}

impl ChainReport {
    /// Contact changed the angles.
    pub const BENT: u32 = 1;
    /// The solver met no posture outside all contact planes.
    pub const MISSED: u32 = 1 << 1;
    /// The budget ended the solver early.
    pub const CUT: u32 = 1 << 2;
    /// The chain stayed as it was for a part of the frame: no way was found.
    pub const HELD: u32 = 1 << 3;
}

/// A question about a tip that was answered for good: more steps would not better it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct TipAsked {
    pub tip: Pose,
    pub base: Pose,
    pub missed_m: f32,
    /// One when the answer is in the targets.
    pub is_answered: u32,
}

columns! {
    /// One entry for every chain slot.
    pub(crate) struct Chains(capacities) {
        generation: [u32; capacities.chains],
        body: [u32; capacities.chains],
        /// Next chain of the same body, index plus one.
        next: [u32; capacities.chains],
        first_joint: [u32; capacities.chains],
        joint_count: [u32; capacities.chains],
        /// The joint whose link the chain hangs on, index plus one; zero for the root.
        base: [u32; capacities.chains],
        options: [ChainOptions; capacities.chains],
        report: [ChainReport; capacities.chains],
        /// From the tracked tip to the published one, in the world.
        tip_offset: [Vec3; capacities.chains],
        /// Where the tracker itself sees the tip, in the world, when it does.
        tip_seen: [Vec3; capacities.chains],
        /// One when it does, zero when the tracked angles say where the tip is.
        is_tip_seen: [u32; capacities.chains],
        /// What [`crate::world::World::set_tip`] was asked last: the last link's pose, the base's, and
        /// what came of it, in metres.
        asked: [TipAsked; capacities.chains],
        /// Where the tracked tip was in the last frame.
        tip_tracked: [Vec3; capacities.chains],
        /// Where the tip was wanted when the body last settled.
        tip_settled: [Vec3; capacities.chains],
        /// How deep the chain was when it was last solved, in metres: the deepest is solved first.
        depth: [f32; capacities.chains],
        /// One for a chain that was solved before all others last time.
        led: [u32; capacities.chains],
    }
}

columns! {
    /// One entry for every joint, the joints of a chain side by side, without gaps.
    pub(crate) struct Joints(capacities) {
        hinge: [Hinge; capacities.joints],
        /// The joint before, index plus one; zero for the root.
        parent: [u32; capacities.joints],
        /// Length of the hinge's rest translation.
        length: [f32; capacities.joints],
        /// The farthest that the hinge can be from the root: the sum of the lengths from there to it.
        arm: [f32; capacities.joints],
        chain: [u32; capacities.joints],
        /// One for the first of a ball's three.
        ball: [u32; capacities.joints],
        /// Published angle in radians.
        angle: [f32; capacities.joints],
        /// Where the tracker wants it.
        target: [f32; capacities.joints],
        /// The posture that the last question about the tip kept near.
        posture: [f32; capacities.joints],
        /// The target of the frame before.
        previous: [f32; capacities.joints],
        /// The angle that was wanted when the body last settled.
        settled: [f32; capacities.joints],
        /// How far contact holds the angle from its target.
        deviation: [f32; capacities.joints],
        /// What contact added to the wanted angle in the last frame.
        pressed: [f32; capacities.joints],
        /// Published pose of the link in the body's frame.
        link: [Pose; capacities.joints],
        /// Published pose of the link in the world.
        world: [Pose; capacities.joints],
        /// Cones of balls, see [`cone_slot`].
        cone: [ReachCone; capacities.joints.div_ceil(3)],
    }
}

columns! {
    /// Angles on the legs of a frame: scratch. One entry per joint for each leg and one more.
    pub(crate) struct AngleWays(capacities) {
        from: [f32; capacities.joints * ANGLE_SLOTS],
        to: [f32; capacities.joints * ANGLE_SLOTS],
        from_link: [Pose; capacities.joints * ANGLE_SLOTS],
        to_link: [Pose; capacities.joints * ANGLE_SLOTS],
        /// Where the attraction wants the angles at the end of the frame.
        wanted: [f32; capacities.joints],
        /// One for a chain that stays as it is until the end of the frame.
        held: [u32; capacities.chains],
        /// Where the tip of a chain is wanted, in the world.
        tip: [Vec3; capacities.chains],
        /// The first joint of each chain that does not rest on a leg, and the first that does not rest where it
        /// was published; the joint behind the chain's last when there is none.
        turns: [u32; capacities.chains],
        leaves: [u32; capacities.chains],
        /// Boxes of pieces in their body's frame that were paired with each other.
        swept: [Bounds; capacities.pieces],
    }
}

/// Legs of a way, and one place more for what comes behind the last one.
pub(crate) const ANGLE_SLOTS: u32 = LEGS_MAX as u32 + 1;

/// Where the cone of a ball lies: of three joints in a row only the first can be a ball's first.
pub(crate) const fn cone_slot(first_joint: usize) -> usize {
    first_joint / 3
}

/// The chains of a body in the order they were made: bases before what hangs on them.
pub(crate) struct ChainsOf<'a> {
    next: &'a [u32],
    current: u32,
}

impl Iterator for ChainsOf<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let index = self.current.checked_sub(1)? as usize;
        self.current = self.next[index];
        Some(index)
    }
}

pub(crate) fn chains_of<'a>(state: &'a State, body: usize) -> ChainsOf<'a> {
    ChainsOf {
        next: state.chains.next,
        current: state.bodies.first_chain[body],
    }
}

/// The chain behind one of the same body, index plus one, for loops that change the state.
pub(crate) fn next_chain(state: &State, chain: usize) -> u32 {
    state.chains.next[chain]
}

pub(crate) fn has_chains(state: &State, body: usize) -> bool {
    state.bodies.first_chain[body] != 0
}

pub(crate) fn joints_of(state: &State, chain: usize) -> Range<usize> {
    let first = state.chains.first_joint[chain] as usize;
    first..first + state.chains.joint_count[chain] as usize
}

pub(crate) fn linkage<'a>(state: &'a State) -> Linkage<'a> {
    Linkage {
        hinges: state.joints.hinge,
        parents: state.joints.parent,
        lengths_m: state.joints.length,
    }
}

impl State<'_> {
    /// Takes the joints of a chain out that nothing hangs on any more; what lies behind them moves down.
    pub(crate) fn close_joints(&mut self, gone: Range<usize>) {
        let used = self.registers.joints as usize;
        let count = gone.len();
        self.move_cones_down(&gone, used);
        let joints = &mut self.joints;
        close(joints.hinge, &gone, used);
        close(joints.parent, &gone, used);
        close(joints.length, &gone, used);
        close(joints.arm, &gone, used);
        close(joints.chain, &gone, used);
        close(joints.ball, &gone, used);
        close(joints.angle, &gone, used);
        close(joints.target, &gone, used);
        close(joints.posture, &gone, used);
        close(joints.previous, &gone, used);
        close(joints.settled, &gone, used);
        close(joints.deviation, &gone, used);
        close(joints.pressed, &gone, used);
        close(joints.link, &gone, used);
        close(joints.world, &gone, used);
        self.registers.joints -= count as u32;
        // Indices plus one of joints behind the gap.
        let down = |link: &mut u32| {
            if *link as usize > gone.end {
                *link -= count as u32;
            }
        };
        self.joints.parent[..used - count].iter_mut().for_each(down);
        self.chains.base.iter_mut().for_each(down);
        self.pieces.link.iter_mut().for_each(down);
        for first in self.chains.first_joint.iter_mut() {
            if *first as usize >= gone.end {
                *first -= count as u32;
            }
        }
    }

    /// Brings the cones of balls behind a gap to the places that they have when it is closed.
    fn move_cones_down(&mut self, gone: &Range<usize>, used: usize) {
        for joint in gone.end..used {
            if self.joints.ball[joint] == 1 {
                let cone = self.joints.cone[cone_slot(joint)];
                self.joints.cone[cone_slot(joint - gone.len())] = cone;
            }
        }
    }
}

/// Closes a gap in a column with `used` entries; what becomes free is zero.
fn close<T: Copy + Zeroable>(column: &mut [T], gone: &Range<usize>, used: usize) {
    column.copy_within(gone.end..used, gone.start);
    column[used - gone.len()..used].fill(T::zeroed());
}

/// The ball that begins with a joint, as a chain's solver sees it.
pub(crate) fn ball_at(state: &State, joint: usize, first: usize) -> Option<Ball> {
    (state.joints.ball[joint] == 1).then(|| Ball {
        first: joint - first,
        cone: state.joints.cone[cone_slot(joint)],
    })
}

/// Where the entries of a leg lie in the columns of [`AngleWays`].
pub(crate) fn slot_range(state: &State, leg: usize) -> Range<usize> {
    let joints = state.joints.hinge.len();
    leg * joints..(leg + 1) * joints
}

/// Which end of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    From,
    To,
}

/// Computes the links of a body for the angles at one end of a leg. Those at the other end of the leg `like` are
/// placed: see [`place_chain`].
pub(crate) fn place_links(
    state: &mut State,
    body: usize,
    leg: usize,
    end: End,
    like: Option<usize>,
) {
    let mut next = state.bodies.first_chain[body];
    while let Some(chain) = next.checked_sub(1) {
        place_chain(state, chain as usize, leg, end, like);
        next = next_chain(state, chain as usize);
    }
}

/// Computes the links of a chain whose base is placed. Up to the first joint whose angle is another than at the
/// other end of the leg `like`, where links are placed, they are the same.
pub(crate) fn place_chain(
    state: &mut State,
    chain: usize,
    leg: usize,
    end: End,
    like: Option<usize>,
) {
    let slot = slot_range(state, leg).start;
    let like = like.map(|like| slot_range(state, like).start);
    let joints = joints_of(state, chain);
    let first = like.map_or(joints.start, |like| {
        copy_links(state, chain, slot, end, like)
    });
    for joint in first..joints.end {
        let (joints, ways) = (&state.joints, &mut state.ways);
        let (angles, links) = match end {
            End::From => (&*ways.from, &mut *ways.from_link),
            End::To => (&*ways.to, &mut *ways.to_link),
        };
        let parent = joints.parent[joint].checked_sub(1);
        let base = parent.map_or(Pose::IDENTITY, |parent| links[slot + parent as usize]);
        links[slot + joint] = joints.hinge[joint].placed(&base, angles[slot + joint]);
    }
}

/// Copies the links that are the same at the other end of another leg; the first joint that is not.
fn copy_links(state: &mut State, chain: usize, slot: usize, end: End, like: usize) -> usize {
    let joints = joints_of(state, chain);
    let base = state.chains.base[chain].checked_sub(1);
    let ways = &mut state.ways;
    let (angles, links, known, known_links) = match end {
        End::From => (&*ways.from, &mut *ways.from_link, &*ways.to, &*ways.to_link),
        End::To => (&*ways.to, &mut *ways.to_link, &*ways.from, &*ways.from_link),
    };
    if let Some(base) = base
        && links[slot + base as usize] != known_links[like + base as usize]
    {
        return joints.start;
    }
    for joint in joints.clone() {
        if angles[slot + joint] != known[like + joint] {
            return joint;
        }
        links[slot + joint] = known_links[like + joint];
    }
    joints.end
}
