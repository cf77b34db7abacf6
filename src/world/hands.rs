//! A tracked skeleton drives a body: its root joint is the body's target, its other joints carry
//! the pieces.

use super::{BodyError, World};
use crate::limits::WORLD_REACH_M;
use crate::math::{self, Pose};
use crate::memory::BodyId;
use crate::recording::{CallKind, List, calls};
use crate::state::bodies::BodyKind;
use crate::state::pieces::PiecesOf;

/// What a hand tracker saw, and which joint carries which piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointInput<'a> {
    /// The joints in the world. `None` where the tracker says that it does not know; what it says it
    /// knows is checked all the same.
    pub joints: &'a [Option<Pose>],
    /// The joint that carries the body itself: for a hand, the wrist.
    pub root: usize,
    /// The joint that carries each piece, in the order the pieces were added.
    pub piece_joints: &'a [u32],
    /// Each piece's pose on its joint; empty when every piece lies on its joint as it is.
    pub piece_offsets: &'a [Pose],
    /// A joint farther than this from the root is not believed, in metres. For a hand of human size,
    /// 0.5.
    pub reach_m: f32,
}

/// What was made of the joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JointUse {
    /// Whether the root was good. If not, nothing was set, and the frame counts the tracker as lost.
    pub root: bool,
    /// Pieces that keep their last target because their joint was not good.
    pub pieces_kept: u32,
}

/// Why joints were refused as a whole. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetJointsError {
    /// The id names no body of this world.
    Stale,
    /// The body is not a driven one.
    WrongKind,
    /// There are not as many piece joints as the body has pieces, or some offsets but not as many.
    WrongCount,
    /// The root or a piece's joint is beyond the end of the joints.
    UnknownJoint,
    /// An offset is not finite, too far away, or its orientation has no length.
    BadOffset,
    /// The reach is not above zero.
    BadReach,
    /// A piece is on a link of a chain: its joint's pose goes to [`World::set_link_poses`].
    OnLinks,
}

impl From<BodyError> for SetJointsError {
    fn from(error: BodyError) -> Self {
        match error {
            BodyError::Stale => Self::Stale,
            _ => Self::WrongKind,
        }
    }
}

impl World<'_> {
    /// Tells where a tracker sees the joints of a hand: sets the driven body's target to the root,
    /// and each piece's target to its joint seen from the root, then its offset.
    ///
    /// No joint is trusted. One that is missing, not finite, without orientation or out of reach
    /// leaves its pieces' targets as they were; a root like that leaves everything as it was, and the
    /// frame counts the tracker as lost. Good quaternions of any length are normalised.
    ///
    /// Cost: three quaternion products a piece.
    ///
    /// # Errors
    /// [`SetJointsError`], for mistakes of the host alone.
    pub fn set_joints(
        &mut self,
        id: BodyId,
        input: &JointInput,
    ) -> Result<JointUse, SetJointsError> {
        self.set_listed_joints(id, &Joints::given(input))
    }

    /// The same with joints that lie anywhere.
    pub(crate) fn set_listed_joints(
        &mut self,
        id: BodyId,
        input: &Joints,
    ) -> Result<JointUse, SetJointsError> {
        let most = self.state.header.capacities.pieces as usize;
        self.recorded(
            CallKind::SetJoints,
            |to| {
                to.pod(&id);
                calls::put_joints(to, input, most);
            },
            |world| world.take_joints(id, input),
        )
    }

    fn take_joints(&mut self, id: BodyId, input: &Joints) -> Result<JointUse, SetJointsError> {
        let body = self.body_index(id)?;
        if self.state.bodies.kind[body] != BodyKind::Driven.code() {
            return Err(SetJointsError::WrongKind);
        }
        let first = self.state.bodies.first_piece[body];
        if PiecesOf::new(self.state.pieces.next, first).any(|p| self.state.pieces.link[p] != 0) {
            return Err(SetJointsError::OnLinks);
        }
        let pieces = PiecesOf::new(self.state.pieces.next, first).count();
        input.judge(pieces)?;
        let Some(root) = input.root() else {
            return Ok(JointUse::default());
        };
        self.take_target(id, &root)?;
        let mut used = JointUse {
            root: true,
            pieces_kept: 0,
        };
        let pieces = &mut self.state.pieces;
        for (number, piece) in PiecesOf::new(pieces.next, first).enumerate() {
            match input.piece_target(number, &root) {
                Some(target) if pieces.local_target[piece] != target => {
                    pieces.local_target[piece] = target;
                    self.state.bodies.settled[body].is_settled = 0;
                }
                Some(_) => {}
                None => used.pieces_kept += 1,
            }
        }
        Ok(used)
    }
}

/// A [`JointInput`] whose lists may lie in a log.
pub(crate) struct Joints<'a> {
    pub joints: List<'a, Option<Pose>>,
    pub root: usize,
    pub piece_joints: List<'a, u32>,
    pub piece_offsets: List<'a, Pose>,
    pub reach_m: f32,
}

impl<'a> Joints<'a> {
    fn given(input: &JointInput<'a>) -> Self {
        Self {
            joints: List::Given(input.joints),
            root: input.root,
            piece_joints: List::Given(input.piece_joints),
            piece_offsets: List::Given(input.piece_offsets),
            reach_m: input.reach_m,
        }
    }

    /// Refuses what no tracker can be blamed for.
    fn judge(&self, pieces: usize) -> Result<(), SetJointsError> {
        let offsets = &self.piece_offsets;
        if self.piece_joints.len() != pieces || !(offsets.is_empty() || offsets.len() == pieces) {
            return Err(SetJointsError::WrongCount);
        }
        let known = |joint: usize| joint < self.joints.len();
        if !known(self.root) || !self.piece_joints.iter().all(|j| known(j as usize)) {
            return Err(SetJointsError::UnknownJoint);
        }
        if offsets
            .iter()
            .any(|p| p.normalised(WORLD_REACH_M).is_none())
        {
            return Err(SetJointsError::BadOffset);
        }
        if self.reach_m > 0.0 {
            Ok(())
        } else {
            Err(SetJointsError::BadReach)
        }
    }

    fn root(&self) -> Option<Pose> {
        self.joint(self.root)
    }

    /// A joint's pose; `None` when it is not good.
    fn joint(&self, index: usize) -> Option<Pose> {
        self.joints.get(index)??.normalised(WORLD_REACH_M)
    }

    /// Where a piece is to be in the body's frame; `None` when its joint is not good.
    fn piece_target(&self, number: usize, root: &Pose) -> Option<Pose> {
        let joint = self.joint(self.piece_joints.get(number)? as usize)?;
        let local = joint.seen_from(root);
        if math::length(local.translation()) > self.reach_m {
            return None;
        }
        let target = match self.piece_offsets.get(number) {
            Some(offset) => local.then(&offset.normalised(WORLD_REACH_M)?),
            None => local,
        };
        target.normalised(WORLD_REACH_M)
    }
}
