//! Skeletons: adding chains of joints to driven bodies, where their links are wanted, and where they are.

use glam::{Quat, Vec3};

use super::pieces::AddPieceError;
use super::{BodyError, PieceDef, World};
use crate::geometry::chain::{self, Hinge, JointDef, turns_nearest};
use crate::limits::{CHAIN_HINGES_MAX, CHAINS_PER_BODY_MAX, WORLD_REACH_M};
use crate::math::{self, Pose};
use crate::memory::ids::free_slot;
use crate::memory::{BodyId, ChainId, PieceId};
use crate::publish::{place_pieces, place_published_links};
use crate::reach::goal::{Goal, Task};
use crate::reach::least_deviation::least_deviation_paid;
use crate::recording::{CallKind, calls};
use crate::state::bodies::BodyKind;
use crate::state::chains::{
    ChainOptions, ChainReport, TipAsked, ball_at, cone_slot, joints_of, linkage,
};
use crate::state::pieces::{Groups, PiecesOf};

/// What a chain is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainDef<'a> {
    /// Its joints from the base on; at most [`CHAIN_HINGES_MAX`] hinges, a ball counting for three.
    pub joints: &'a [JointDef],
    /// The chain of the same body that it hangs on, and the hinge there whose link that is; `None` for the
    /// body's root.
    pub base: Option<(ChainId, u32)>,
    /// How it answers contact.
    pub options: ChainOptions,
}

/// Why a chain was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddChainError {
    /// The id names no body of this world.
    StaleBody,
    /// Chains belong to driven bodies.
    WrongKind,
    /// No room: raise [`crate::memory::Capacities::chains`].
    FullChains,
    /// No room: raise [`crate::memory::Capacities::joints`].
    FullJoints,
    /// The body has [`CHAINS_PER_BODY_MAX`] chains.
    TooManyChains,
    /// No joint, or more than [`CHAIN_HINGES_MAX`] hinges.
    WrongCount,
    /// The base is no chain of this body, or has no such hinge.
    BadBase,
    /// A rest pose is not finite, too far away, or its orientation has no length.
    BadPose,
    /// An axis has no direction.
    BadAxis,
    /// A range is not finite, wider than a full turn each way, or its end is below its start.
    BadRange,
    /// [`ChainOptions::is_valid`] says no.
    BadOptions,
}

/// Why something was not done to a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainError {
    /// The id names no chain of this world.
    Stale,
    /// There are not as many numbers or poses as the chain has hinges.
    WrongCount,
    /// A number is not finite. The last good targets stay.
    BadAngle,
    /// A pose is not finite, too far away, or its orientation has no length. The last good targets stay.
    BadPose,
    /// [`ChainOptions::is_valid`] says no.
    BadOptions,
    /// Another chain hangs on this one.
    InUse,
}

/// Steps that [`World::set_tip`] may take.
pub const TIP_STEPS_MAX: u32 = 4;

/// Lever at which a tip's orientation counts like its place, in metres.
const TIP_LEVER_M: f32 = 0.1;

/// What missing the tip's pose costs against the posture, in m2/rad2.
const TIP_SOFTNESS: f32 = 1e-5;

impl World<'_> {
    /// Adds a chain of joints to a driven body. Its angles begin at zero, or at the limit nearest to it,
    /// and are held there until targets come.
    ///
    /// # Errors
    /// [`AddChainError`]; on an error nothing has changed.
    pub fn add_chain(&mut self, body: BodyId, def: &ChainDef) -> Result<ChainId, AddChainError> {
        self.recorded(
            CallKind::AddChain,
            |to| {
                to.pod(&body);
                calls::put_chain(to, def);
            },
            |world| world.take_chain(body, def),
        )
    }

    fn take_chain(&mut self, body: BodyId, def: &ChainDef) -> Result<ChainId, AddChainError> {
        let body = self
            .body_index(body)
            .map_err(|_| AddChainError::StaleBody)?;
        if self.state.bodies.kind[body] != BodyKind::Driven.code() {
            return Err(AddChainError::WrongKind);
        }
        if !def.options.is_valid() {
            return Err(AddChainError::BadOptions);
        }
        let base = self.base_joint(body, def)?;
        let hinges = judge_joints(def.joints)?;
        let slot = free_slot(self.state.chains.generation).ok_or(AddChainError::FullChains)?;
        let first = self.state.registers.joints as usize;
        if first + hinges > self.state.joints.hinge.len() {
            return Err(AddChainError::FullJoints);
        }
        if self.chains(body).count() >= CHAINS_PER_BODY_MAX {
            return Err(AddChainError::TooManyChains);
        }
        self.link_chain(body, slot);
        let chains = &mut self.state.chains;
        chains.generation[slot] = chains.generation[slot].wrapping_add(1);
        chains.body[slot] = body as u32;
        chains.first_joint[slot] = first as u32;
        chains.joint_count[slot] = hinges as u32;
        chains.base[slot] = base;
        chains.options[slot] = def.options;
        chains.report[slot] = ChainReport::default();
        chains.tip_offset[slot] = Vec3::ZERO;
        chains.tip_tracked[slot] = Vec3::ZERO;
        chains.is_tip_seen[slot] = 0;
        chains.asked[slot] = TipAsked::default();
        chains.tip_settled[slot] = Vec3::ZERO;
        chains.depth[slot] = 0.0;
        chains.led[slot] = 0;
        let id = ChainId::new(slot, chains.generation[slot]);
        self.store_joints(slot, def.joints);
        let registers = &mut *self.state.registers;
        registers.joints += hinges as u32;
        registers.chain_slots = registers.chain_slots.max(slot as u32 + 1);
        self.state.note_use();
        self.place_skeleton(body);
        Ok(id)
    }

    /// The joint that a chain is to hang on, index plus one.
    fn base_joint(&self, body: usize, def: &ChainDef) -> Result<u32, AddChainError> {
        let Some((base, hinge)) = def.base else {
            return Ok(0);
        };
        let chain = self.chain_index(base).map_err(|_| AddChainError::BadBase)?;
        let joint = joints_of(&self.state, chain).nth(hinge as usize);
        let own = self.state.chains.body[chain] as usize == body;
        match joint {
            Some(joint) if own => Ok(joint as u32 + 1),
            _ => Err(AddChainError::BadBase),
        }
    }

    fn chains(&self, body: usize) -> crate::state::chains::ChainsOf<'_> {
        crate::state::chains::chains_of(&self.state, body)
    }

    /// Hangs a chain behind the last one of its body.
    fn link_chain(&mut self, body: usize, slot: usize) {
        let last = self.chains(body).last();
        self.state.chains.next[slot] = 0;
        match last {
            Some(last) => self.state.chains.next[last] = slot as u32 + 1,
            None => self.state.bodies.first_chain[body] = slot as u32 + 1,
        }
    }

    fn store_joints(&mut self, chain: usize, defs: &[JointDef]) {
        let mut joint = self.state.chains.first_joint[chain] as usize;
        let mut parent = self.state.chains.base[chain];
        let mut put = |state: &mut crate::state::State, hinge: Hinge, ball: bool| {
            let joints = &mut state.joints;
            let angle = hinge.kept(0.0);
            joints.hinge[joint] = hinge;
            joints.parent[joint] = parent;
            joints.length[joint] = math::length(hinge.rest.translation());
            let before = parent
                .checked_sub(1)
                .map_or(0.0, |parent| joints.arm[parent as usize]);
            joints.arm[joint] = before + joints.length[joint];
            joints.chain[joint] = chain as u32;
            joints.ball[joint] = u32::from(ball);
            joints.angle[joint] = angle;
            joints.target[joint] = angle;
            joints.previous[joint] = angle;
            joints.deviation[joint] = 0.0;
            joints.pressed[joint] = 0.0;
            joint += 1;
            parent = joint as u32;
            joint - 1
        };
        for def in defs {
            let is_ball = def.hinge_count() == 3;
            for (index, hinge) in def.hinges().into_iter().enumerate() {
                let rest = hinge.rest.normalised(WORLD_REACH_M).unwrap_or_default();
                let axis = math::direction(hinge.axis).unwrap_or(Vec3::X);
                let at = put(
                    &mut self.state,
                    Hinge {
                        rest,
                        axis,
                        ..hinge
                    },
                    is_ball && index == 0,
                );
                if let (JointDef::Ball { cone, .. }, 0) = (def, index) {
                    self.state.joints.cone[cone_slot(at)] = *cone;
                }
            }
        }
        self.keep_in_cones(chain);
    }

    /// Brings a chain's targets into its cones, and its angles to the targets: for a chain that is new.
    fn keep_in_cones(&mut self, chain: usize) {
        let joints = joints_of(&self.state, chain);
        self.keep_targets(chain);
        for joint in joints {
            let joints = &mut self.state.joints;
            joints.angle[joint] = joints.target[joint];
            joints.previous[joint] = joints.target[joint];
        }
    }

    /// Projects a chain's targets into the ranges of its hinges and the cones of its balls.
    fn keep_targets(&mut self, chain: usize) {
        let range = joints_of(&self.state, chain);
        for joint in range.clone() {
            let joints = &mut self.state.joints;
            joints.target[joint] = joints.hinge[joint].kept(joints.target[joint]);
        }
        for joint in range.clone() {
            if let Some(ball) = ball_at(&self.state, joint, range.start) {
                ball.kept(&mut self.state.joints.target[range.clone()]);
            }
        }
    }

    /// Removes a chain, and the pieces on its links. Cost: one pass over the pools for each piece.
    ///
    /// # Errors
    /// [`ChainError::Stale`], [`ChainError::InUse`] when another chain hangs on it.
    pub fn remove_chain(&mut self, id: ChainId) -> Result<(), ChainError> {
        self.recorded(
            CallKind::RemoveChain,
            |to| to.pod(&id),
            |world| world.drop_chain(id),
        )
    }

    fn drop_chain(&mut self, id: ChainId) -> Result<(), ChainError> {
        let chain = self.chain_index(id)?;
        let joints = joints_of(&self.state, chain);
        let body = self.state.chains.body[chain] as usize;
        let hangs = |other: usize| {
            let base = self.state.chains.base[other].checked_sub(1);
            base.is_some_and(|joint| joints.contains(&(joint as usize)))
        };
        if self.chains(body).any(hangs) {
            return Err(ChainError::InUse);
        }
        self.remove_chain_at(chain);
        Ok(())
    }

    /// Removes all chains of a body, the last one first.
    pub(super) fn remove_chains(&mut self, body: usize) {
        while let Some(chain) = self.chains(body).last() {
            self.remove_chain_at(chain);
        }
    }

    fn remove_chain_at(&mut self, chain: usize) {
        let body = self.state.chains.body[chain] as usize;
        let joints = joints_of(&self.state, chain);
        loop {
            let links = &self.state.pieces.link;
            let on_it = |&piece: &usize| {
                let joint = links[piece].checked_sub(1);
                joint.is_some_and(|joint| joints.contains(&(joint as usize)))
            };
            let first = self.state.bodies.first_piece[body];
            let Some(piece) = PiecesOf::new(self.state.pieces.next, first).find(on_it) else {
                break;
            };
            self.remove_piece_at(piece);
        }
        self.unlink_chain(body, chain);
        let chains = &mut self.state.chains;
        chains.generation[chain] = chains.generation[chain].wrapping_add(1);
        self.state.close_joints(joints);
        self.wake_all();
    }

    fn unlink_chain(&mut self, body: usize, chain: usize) {
        let after = self.state.chains.next[chain];
        let before = self
            .chains(body)
            .find(|&other| self.state.chains.next[other] as usize == chain + 1);
        match before {
            Some(before) => self.state.chains.next[before] = after,
            None => self.state.bodies.first_chain[body] = after,
        }
    }

    fn chain_index(&self, id: ChainId) -> Result<usize, ChainError> {
        id.find(self.state.chains.generation)
            .ok_or(ChainError::Stale)
    }

    fn place_skeleton(&mut self, body: usize) {
        place_published_links(&mut self.state, body);
        place_pieces(&mut self.state, body);
        self.wake_all();
    }

    /// Adds a piece to the link behind a hinge of a chain; its local pose is in that link's frame.
    ///
    /// # Errors
    /// [`AddPieceError`]; on an error nothing has changed.
    pub fn add_link_piece(
        &mut self,
        chain: ChainId,
        hinge: u32,
        def: &PieceDef,
    ) -> Result<PieceId, AddPieceError> {
        self.recorded(
            CallKind::AddLinkPiece,
            |to| {
                to.pod(&chain);
                to.pod(&hinge);
                calls::put_piece(to, def);
            },
            |world| world.take_link_piece(chain, hinge, def),
        )
    }

    fn take_link_piece(
        &mut self,
        chain: ChainId,
        hinge: u32,
        def: &PieceDef,
    ) -> Result<PieceId, AddPieceError> {
        let index = self
            .chain_index(chain)
            .map_err(|_| AddPieceError::StaleChain)?;
        let joint = joints_of(&self.state, index)
            .nth(hinge as usize)
            .ok_or(AddPieceError::UnknownHinge)?;
        self.add_piece_at(
            self.state.chains.body[index] as usize,
            joint as u32 + 1,
            def,
        )
    }

    /// Says which groups a driven piece belongs to and passes through. A new piece belongs to none.
    ///
    /// # Errors
    /// [`BodyError::Stale`].
    pub fn set_groups(&mut self, piece: PieceId, groups: Groups) -> Result<(), BodyError> {
        self.recorded(
            CallKind::SetGroups,
            |to| {
                to.pod(&piece);
                to.pod(&groups);
            },
            |world| world.take_groups(piece, groups),
        )
    }

    fn take_groups(&mut self, piece: PieceId, groups: Groups) -> Result<(), BodyError> {
        let piece = piece
            .find(self.state.pieces.generation)
            .ok_or(BodyError::Stale)?;
        self.state.pieces.groups[piece] = groups;
        self.wake_all();
        Ok(())
    }

    /// Says how a chain answers contact.
    ///
    /// # Errors
    /// [`ChainError::Stale`], [`ChainError::BadOptions`].
    pub fn set_chain_options(
        &mut self,
        id: ChainId,
        options: &ChainOptions,
    ) -> Result<(), ChainError> {
        self.recorded(
            CallKind::SetChainOptions,
            |to| {
                to.pod(&id);
                to.pod(options);
            },
            |world| world.take_options(id, options),
        )
    }

    fn take_options(&mut self, id: ChainId, options: &ChainOptions) -> Result<(), ChainError> {
        let chain = self.chain_index(id)?;
        if !options.is_valid() {
            return Err(ChainError::BadOptions);
        }
        self.state.chains.options[chain] = *options;
        self.wake_all();
        Ok(())
    }

    /// Tells where the tracker wants a chain's hinges, in radians. Angles outside a range or a cone become
    /// the nearest ones inside. The chain moves there over the frame, as far as contact allows.
    ///
    /// # Errors
    /// [`ChainError`]; on an error no target has changed.
    pub fn set_angles(&mut self, id: ChainId, angles: &[f32]) -> Result<(), ChainError> {
        self.recorded(
            CallKind::SetAngles,
            |to| {
                to.pod(&id);
                to.list(angles, CHAIN_HINGES_MAX);
            },
            |world| world.take_angles(id, angles),
        )
    }

    fn take_angles(&mut self, id: ChainId, angles: &[f32]) -> Result<(), ChainError> {
        let chain = self.chain_index(id)?;
        let joints = joints_of(&self.state, chain);
        if angles.len() != joints.len() {
            return Err(ChainError::WrongCount);
        }
        if !angles.iter().all(|angle| angle.is_finite()) {
            return Err(ChainError::BadAngle);
        }
        self.state.chains.is_tip_seen[chain] = 0;
        self.state.chains.asked[chain].is_answered = 0;
        // Targets that stay are within the limits.
        if self.state.joints.target[joints.clone()] != *angles {
            self.state.joints.target[joints].copy_from_slice(angles);
            self.keep_targets(chain);
        }
        Ok(())
    }

    /// Tells where the tracker sees a chain's links, one pose in the world for each joint of its
    /// definition: behind a hinge, or behind a ball. The angles are taken from each joint's rotation
    /// against the one before, the first one's against what the chain hangs on at its target: about the
    /// axis of a hinge, by swing and twist for a ball. What the limits do not allow is left out.
    ///
    /// Cost: two quaternion products and an arc tangent a hinge.
    ///
    /// # Errors
    /// [`ChainError`]; on an error no target has changed.
    pub fn set_link_poses(&mut self, id: ChainId, poses: &[Pose]) -> Result<(), ChainError> {
        self.recorded(
            CallKind::SetLinkPoses,
            |to| {
                to.pod(&id);
                to.list(poses, CHAIN_HINGES_MAX);
            },
            |world| world.take_link_poses(id, poses),
        )
    }

    fn take_link_poses(&mut self, id: ChainId, poses: &[Pose]) -> Result<(), ChainError> {
        let chain = self.chain_index(id)?;
        let joints = joints_of(&self.state, chain);
        let mut expected = 0;
        let mut joint = joints.start;
        while joint < joints.end {
            joint += if self.state.joints.ball[joint] == 1 {
                3
            } else {
                1
            };
            expected += 1;
        }
        if poses.len() != expected {
            return Err(ChainError::WrongCount);
        }
        if !poses.iter().all(|p| p.normalised(WORLD_REACH_M).is_some()) {
            return Err(ChainError::BadPose);
        }
        self.state.chains.is_tip_seen[chain] = 0;
        self.state.chains.asked[chain].is_answered = 0;
        let mut before = self.target_base(chain).quat();
        let mut joint = joints.start;
        for pose in poses {
            let turned = pose.normalised(WORLD_REACH_M).unwrap_or_default().quat();
            let rest = before * self.state.joints.hinge[joint].rest.quat();
            joint = self.extract(joint, joints.start, rest.conjugate() * turned);
            before = turned;
        }
        self.keep_targets(chain);
        Ok(())
    }

    /// Takes the target angles of the joint at `joint` from its rotation; the joint behind it.
    fn extract(&mut self, joint: usize, first: usize, turn: Quat) -> usize {
        let Some(ball) = ball_at(&self.state, joint, first) else {
            let axis = self.state.joints.hinge[joint].axis;
            let along = axis.dot(Vec3::new(turn.x, turn.y, turn.z));
            let angle = turns_nearest(
                2.0 * math::atan2(along, turn.w),
                self.state.joints.target[joint],
            );
            self.state.joints.target[joint] = angle;
            return joint + 1;
        };
        let angles = &mut self.state.joints.target[first..];
        ball.set_turn(turn, angles);
        joint + 3
    }

    /// Where the link that a chain hangs on is wanted, in the world.
    fn target_base(&self, chain: usize) -> Pose {
        let body = self.state.chains.body[chain] as usize;
        let root = self.state.bodies.tracker[body].target;
        match self.state.chains.base[chain].checked_sub(1) {
            None => root,
            Some(joint) => root
                .then(&linkage(&self.state).link(joint as usize, |j| self.state.joints.target[j])),
        }
    }

    /// Tells where the tracker sees the last link alone, in the world: a controller in the hand. The
    /// target angles are the ones that bring the link there with the least change from `posture`, or as
    /// near as the limits allow. How far the link's origin is from there, in metres.
    ///
    /// Cost: at most [`TIP_STEPS_MAX`] steps of [`crate::reach::least_deviation`] with nine goals, from the
    /// last target angles on: a tip that leaps is followed over some frames. Nothing when the answer is
    /// known. Call it behind [`World::set_target`], and for a chain behind the one that it hangs on.
    ///
    /// # Errors
    /// [`ChainError`]; on an error no target has changed.
    pub fn set_tip(&mut self, id: ChainId, tip: &Pose, posture: &[f32]) -> Result<f32, ChainError> {
        self.recorded(
            CallKind::SetTip,
            |to| {
                to.pod(&id);
                to.pod(tip);
                to.list(posture, CHAIN_HINGES_MAX);
            },
            |world| world.take_tip(id, tip, posture),
        )
    }

    fn take_tip(&mut self, id: ChainId, tip: &Pose, posture: &[f32]) -> Result<f32, ChainError> {
        let chain = self.chain_index(id)?;
        let joints = joints_of(&self.state, chain);
        if posture.len() != joints.len() {
            return Err(ChainError::WrongCount);
        }
        if !posture.iter().all(|angle| angle.is_finite()) {
            return Err(ChainError::BadAngle);
        }
        let tip = tip.normalised(WORLD_REACH_M).ok_or(ChainError::BadPose)?;
        let base = self.target_base(chain);
        let asked = self.state.chains.asked[chain];
        let same = asked.is_answered == 1 && asked.tip == tip && asked.base == base;
        if same && self.state.joints.posture[joints.clone()] == *posture {
            return Ok(asked.missed_m);
        }
        let (steps, missed_m) = self.solve_tip(chain, &base, &tip, posture);
        self.state.joints.posture[joints].copy_from_slice(posture);
        let chains = &mut self.state.chains;
        chains.is_tip_seen[chain] = 1;
        chains.tip_seen[chain] = tip.point(Vec3::from_array(chains.options[chain].tip));
        chains.asked[chain] = TipAsked {
            tip,
            base,
            missed_m,
            is_answered: u32::from(steps < TIP_STEPS_MAX),
        };
        Ok(missed_m)
    }

    /// Brings the target angles nearer to those that have the last link at a pose; the steps it took, and how far
    /// the link's origin is from there, in metres.
    fn solve_tip(&mut self, chain: usize, base: &Pose, tip: &Pose, posture: &[f32]) -> (u32, f32) {
        let joints = joints_of(&self.state, chain);
        let there = tip.moved(-base.translation());
        let goals = tip_goals(joints.len() - 1, &there);
        let balls: arrayvec::ArrayVec<_, { CHAIN_HINGES_MAX / 3 }> = joints
            .clone()
            .filter_map(|joint| ball_at(&self.state, joint, joints.start))
            .collect();
        let mut angles = [0.0; CHAIN_HINGES_MAX];
        let angles = &mut angles[..joints.len()];
        angles.copy_from_slice(&self.state.joints.target[joints.clone()]);
        let root = base.moved(-base.translation());
        let task = Task {
            hinges: &self.state.joints.hinge[joints.clone()],
            balls: &balls,
            root,
            wanted: posture,
            goals: &goals,
            tolerance_m: 1e-5,
        };
        let (found, mut reached) =
            least_deviation_paid(&task, angles, TIP_STEPS_MAX, None, &mut || true);
        self.state.joints.target[joints.clone()].copy_from_slice(angles);
        self.keep_targets(chain);
        let targets = &self.state.joints.target[joints.clone()];
        if targets != angles {
            reached = chain::posture(&self.state.joints.hinge[joints], &root, targets);
        }
        let last = reached.last().map_or(root, |placed| placed.link);
        let missed = last.translation() - there.translation();
        (found.steps, math::length(missed))
    }

    /// A chain's published angles in radians, one for each hinge.
    ///
    /// # Errors
    /// [`ChainError::Stale`].
    pub fn angles(&self, id: ChainId) -> Result<&[f32], ChainError> {
        let joints = joints_of(&self.state, self.chain_index(id)?);
        Ok(&self.state.joints.angle[joints])
    }

    /// A chain's target angles in radians, as the limits left them.
    ///
    /// # Errors
    /// [`ChainError::Stale`].
    pub fn target_angles(&self, id: ChainId) -> Result<&[f32], ChainError> {
        let joints = joints_of(&self.state, self.chain_index(id)?);
        Ok(&self.state.joints.target[joints])
    }

    /// The published poses of a chain's links in the world, one for each hinge.
    ///
    /// # Errors
    /// [`ChainError::Stale`].
    pub fn link_poses(&self, id: ChainId) -> Result<&[Pose], ChainError> {
        let joints = joints_of(&self.state, self.chain_index(id)?);
        Ok(&self.state.joints.world[joints])
    }

    /// What the last frame did to a chain.
    ///
    /// # Errors
    /// [`ChainError::Stale`].
    pub fn chain_report(&self, id: ChainId) -> Result<ChainReport, ChainError> {
        Ok(self.state.chains.report[self.chain_index(id)?])
    }

    /// Puts a chain's joints at angles at once, without a way there; they become the targets too. Overlap
    /// made so is reported by the next frame and never gets deeper.
    ///
    /// # Errors
    /// [`ChainError`]; on an error nothing has changed.
    pub fn place_angles(&mut self, id: ChainId, angles: &[f32]) -> Result<(), ChainError> {
        self.recorded(
            CallKind::PlaceAngles,
            |to| {
                to.pod(&id);
                to.list(angles, CHAIN_HINGES_MAX);
            },
            |world| world.place_at_angles(id, angles),
        )
    }

    fn place_at_angles(&mut self, id: ChainId, angles: &[f32]) -> Result<(), ChainError> {
        self.take_angles(id, angles)?;
        let chain = self.chain_index(id)?;
        for joint in joints_of(&self.state, chain) {
            let joints = &mut self.state.joints;
            joints.angle[joint] = joints.target[joint];
            joints.previous[joint] = joints.target[joint];
            joints.deviation[joint] = 0.0;
            joints.pressed[joint] = 0.0;
        }
        self.state.chains.tip_offset[chain] = Vec3::ZERO;
        self.place_skeleton(self.state.chains.body[chain] as usize);
        Ok(())
    }
}

/// Refuses joints that make no chain; how many hinges they take.
fn judge_joints(defs: &[JointDef]) -> Result<usize, AddChainError> {
    let hinges: usize = defs.iter().map(JointDef::hinge_count).sum();
    if hinges == 0 || hinges > CHAIN_HINGES_MAX {
        return Err(AddChainError::WrongCount);
    }
    let turn = core::f32::consts::TAU;
    for def in defs {
        let (rest, axis, low, high) = match *def {
            JointDef::Hinge(hinge) => (hinge.rest, hinge.axis, hinge.low_rad, hinge.high_rad),
            JointDef::Ball {
                rest,
                twist_low_rad,
                twist_high_rad,
                ..
            } => (rest, Vec3::Z, twist_low_rad, twist_high_rad),
        };
        if rest.normalised(WORLD_REACH_M).is_none() {
            return Err(AddChainError::BadPose);
        }
        if !axis.is_finite() || math::direction(axis).is_none() {
            return Err(AddChainError::BadAxis);
        }
        let range = -turn..=turn;
        if !(range.contains(&low) && range.contains(&high) && low <= high) {
            return Err(AddChainError::BadRange);
        }
    }
    Ok(hinges)
}

/// Goals that ask for the pose of a link: its origin and two points off it.
fn tip_goals(link: usize, tip: &Pose) -> [Goal; 9] {
    let points = [Vec3::ZERO, Vec3::X * TIP_LEVER_M, Vec3::Y * TIP_LEVER_M];
    let places = points.map(|point| Goal::place(link, point, tip.point(point)));
    core::array::from_fn(|index| Goal {
        softness: TIP_SOFTNESS,
        ..places[index / 3][index % 3]
    })
}
