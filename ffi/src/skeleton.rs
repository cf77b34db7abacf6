//! What chains of joints are made from, what a frame did to them, and what that is in the kernel.

#![allow(non_camel_case_types, reason = "the names in C")]

use palpable_kernel::geometry::chain::{Hinge, JointDef};
use palpable_kernel::geometry::reach_cone::{ConeError, ReachCone};
use palpable_kernel::human::LIMB_JOINTS_MAX;
use palpable_kernel::limits::{CHAIN_HINGES_MAX, CHAINS_PER_BODY_MAX, REACH_CONE_EDGES_MAX};
use palpable_kernel::memory::ChainId;
use palpable_kernel::state::chains::{ChainOptions, ChainReport};

use crate::status::{
    PALP_BAD_ENUM, PALP_CONE_BAD_EDGE, PALP_CONE_BAD_WINDING, PALP_CONE_NO_DIRECTION,
    PALP_CONE_NOT_VISIBLE, PALP_CONE_TOO_FEW_CORNERS, PALP_CONE_TOO_MANY_CORNERS, palp_status,
};
use crate::types::{palp_pose, palp_vec3};

/// Most hinges of a chain; a ball is three.
pub const PALP_CHAIN_HINGES_MAX: u32 = 16;
/// Most chains of a body.
pub const PALP_CHAINS_PER_BODY_MAX: u32 = 32;
/// Most joints of a human limb or finger.
pub const PALP_LIMB_JOINTS_MAX: u32 = 5;
/// Most corners of a reach cone.
pub const PALP_CONE_CORNERS_MAX: u32 = 12;

/// Names a chain. All zeros is null. A stale id is refused.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct palp_chain_id {
    /// Index of the slot plus one; zero is null.
    pub index1: u32,
    /// How often the slot has been used.
    pub generation: u32,
}

/// A joint with one axis: one hinge of the chain, one angle.
pub const PALP_JOINT_HINGE: u32 = 1;
/// Three hinges in one place with the axes X, Y and Z of the rest frame, three angles: Z turned by the
/// first two is the limb, the third is the twist about it. At angles a and b of the first two the limb
/// is (sin b, -sin a cos b, cos a cos b) in the rest frame.
pub const PALP_JOINT_BALL: u32 = 2;

/// A joint as a chain is made from it. Start from `PALP_JOINT_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_joint {
    /// `sizeof(palp_joint)`.
    pub struct_size: u32,
    /// `PALP_JOINT_HINGE` or `PALP_JOINT_BALL`.
    pub kind: u32,
    /// Pose at angle zero in the frame of the link before it; of the first joint, in the frame of what
    /// the chain hangs on.
    pub rest_pose: palp_pose,
    /// Axis of a hinge in the rest frame, of any length; not looked at for a ball.
    pub axis: palp_vec3,
    /// Least angle of a hinge, or least twist of a ball, in radians, -6.2831853 or more.
    pub low_rad: f32,
    /// Largest angle of a hinge, or largest twist of a ball, in radians, 6.2831853 or less.
    pub high_rad: f32,
    /// Direction of any length within a ball's reach cone from which every edge of the cone is seen, in
    /// the rest frame; not looked at for a hinge.
    pub cone_visible: palp_vec3,
    /// Corners of a ball's reach cone, 3 to `PALP_CONE_CORNERS_MAX`; not looked at for a hinge.
    pub cone_corner_count: u32,
    /// Directions of any length in the rest frame, in order, either way round: the limb stays within the
    /// polygon of great arcs between them. It need not be convex, and may be wider than a hemisphere.
    pub cone_corners: [palp_vec3; PALP_CONE_CORNERS_MAX as usize],
}

/// The least change from the tracked angles.
pub const PALP_METHOD_LEAST_DEVIATION: u32 = 0;
/// Cyclic coordinate descent, the method of Schmidl and Lin 2004, begun with what contact did in the last frame.
pub const PALP_METHOD_CYCLIC_DESCENT: u32 = 1;

/// What the chain cannot evade, the body's root does.
pub const PALP_OPTION_MOVES_ROOT: u32 = 1;
/// The chain's links keep out of the links of other chains of the body, and of its root, where those do
/// so too. The root always does.
pub const PALP_OPTION_MEETS_BODY: u32 = 2;
/// The tip is kept at its tracked place, along the surface that it touches; the joints give way instead.
pub const PALP_OPTION_HOLDS_TIP: u32 = 4;
/// Contact moves the root alone: the joints follow the tracked angles, as a rigid group does.
pub const PALP_OPTION_RIGID: u32 = 8;

/// Among chains that hang on the same, this one's turn comes by a number drawn from frame and chain instead
/// of by how deep it is.
pub const PALP_OPTION_SHUFFLED: u32 = 16;

/// How a chain answers contact. Start from `PALP_CHAIN_OPTIONS_DEFAULT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_chain_options {
    /// `PALP_METHOD_LEAST_DEVIATION` or `PALP_METHOD_CYCLIC_DESCENT`.
    pub method: u32,
    /// Bits `PALP_OPTION_*`.
    pub flags: u32,
    /// Time constant of the return to the tracked angles once contact lets go, in seconds, 0 to 1e6: the
    /// deviation left after h seconds is exp(-h / attraction_s).
    pub attraction_s: f32,
    /// With `PALP_OPTION_HOLDS_TIP`: the point of the last link that is held, in that link's frame, in
    /// metres.
    pub tip: palp_vec3,
}

/// What a chain is made from. Start from `PALP_CHAIN_DEF_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_chain_def {
    /// `sizeof(palp_chain_def)`.
    pub struct_size: u32,
    /// Number of joints, at least 1. Their hinges are at most `PALP_CHAIN_HINGES_MAX`.
    pub joint_count: u32,
    /// Joints from the base on; read during the call only.
    pub joints: *const palp_joint,
    /// Bytes from one joint to the next; 0 stands for `joints->struct_size`.
    pub joint_stride: u32,
    /// Chain of the same body that the new one hangs on; null for the body's root.
    pub base: palp_chain_id,
    /// Hinge of `base` whose link that is, from 0; not looked at when `base` is null.
    pub base_hinge: u32,
    /// How the chain answers contact.
    pub options: palp_chain_options,
}

/// Contact changed the chain's angles.
pub const PALP_CHAIN_BENT: u32 = 1;
/// The solver met no posture outside all contact planes.
pub const PALP_CHAIN_MISSED: u32 = 2;
/// The budget ended the solver early.
pub const PALP_CHAIN_CUT: u32 = 4;
/// The chain stayed as it was for a part of the frame: no way was found.
pub const PALP_CHAIN_HELD: u32 = 8;

/// What the last frame did to a chain. Start from `PALP_CHAIN_STATE_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_chain_state {
    /// `sizeof(palp_chain_state)`.
    pub struct_size: u32,
    /// `PALP_CHAIN_BENT`, `PALP_CHAIN_MISSED`, `PALP_CHAIN_CUT` and `PALP_CHAIN_HELD`.
    pub flags: u32,
    /// Steps of the solver that were spent.
    pub steps: u32,
    /// The most that a contact's plane is still violated by in the plan, in metres. The published
    /// posture overlaps nothing all the same: the way ends before.
    pub missed_m: f32,
    /// The most that any angle is from its tracked one, in radians.
    pub deviation_rad: f32,
}

pub(crate) const fn cone_status(error: ConeError) -> palp_status {
    match error {
        ConeError::TooFew => PALP_CONE_TOO_FEW_CORNERS,
        ConeError::TooMany => PALP_CONE_TOO_MANY_CORNERS,
        ConeError::NoDirection => PALP_CONE_NO_DIRECTION,
        ConeError::Edge => PALP_CONE_BAD_EDGE,
        ConeError::NotVisible => PALP_CONE_NOT_VISIBLE,
        ConeError::Winding => PALP_CONE_BAD_WINDING,
    }
}

/// The cone of a point that sees it, and its corners.
pub(crate) fn cone(visible: palp_vec3, corners: &[palp_vec3]) -> Result<ReachCone, palp_status> {
    let mut directions = [palp_vec3::new([0.0; 3]).to_array().into(); REACH_CONE_EDGES_MAX];
    let directions = directions
        .get_mut(..corners.len())
        .ok_or(PALP_CONE_TOO_MANY_CORNERS)?;
    for (direction, corner) in directions.iter_mut().zip(corners) {
        *direction = corner.to_array().into();
    }
    let is_finite = |v: &palp_vec3| v.to_array().iter().all(|part| part.is_finite());
    if !(is_finite(&visible) && corners.iter().all(is_finite)) {
        return Err(PALP_CONE_NO_DIRECTION);
    }
    ReachCone::new(visible.to_array().into(), directions).map_err(cone_status)
}

impl palp_joint {
    /// No joint of any kind.
    pub(crate) const NONE: Self = Self {
        struct_size: 0,
        kind: 0,
        rest_pose: palp_pose::IDENTITY,
        axis: palp_vec3::new([0.0; 3]),
        low_rad: 0.0,
        high_rad: 0.0,
        cone_visible: palp_vec3::new([0.0; 3]),
        cone_corner_count: 0,
        cone_corners: [palp_vec3::new([0.0; 3]); PALP_CONE_CORNERS_MAX as usize],
    };

    pub(crate) fn new(from: &JointDef) -> Self {
        let mut new = Self {
            struct_size: size_of::<Self>() as u32,
            rest_pose: palp_pose::new(&from.rest()),
            ..Self::NONE
        };
        match from {
            JointDef::Hinge(hinge) => {
                new.kind = PALP_JOINT_HINGE;
                new.axis = palp_vec3::new(hinge.axis.to_array());
                (new.low_rad, new.high_rad) = (hinge.low_rad, hinge.high_rad);
            }
            JointDef::Ball {
                twist_low_rad,
                twist_high_rad,
                cone,
                ..
            } => {
                new.kind = PALP_JOINT_BALL;
                (new.low_rad, new.high_rad) = (*twist_low_rad, *twist_high_rad);
                new.cone_visible = palp_vec3::new(cone.visible().to_array());
                new.cone_corner_count = cone.corners().len() as u32;
                for (slot, corner) in new.cone_corners.iter_mut().zip(cone.corners()) {
                    *slot = palp_vec3::new(corner.to_array());
                }
            }
        }
        new
    }

    pub(crate) fn hinge(&self) -> Hinge {
        Hinge {
            rest: self.rest_pose.to_kernel(),
            axis: self.axis.to_array().into(),
            low_rad: self.low_rad,
            high_rad: self.high_rad,
        }
    }

    fn cone(&self) -> Result<ReachCone, palp_status> {
        let corners = self
            .cone_corners
            .get(..self.cone_corner_count as usize)
            .ok_or(PALP_CONE_TOO_MANY_CORNERS)?;
        cone(self.cone_visible, corners)
    }

    pub(crate) fn to_kernel(self) -> Result<JointDef, palp_status> {
        match self.kind {
            PALP_JOINT_HINGE => Ok(JointDef::Hinge(self.hinge())),
            PALP_JOINT_BALL => Ok(JointDef::Ball {
                rest: self.rest_pose.to_kernel(),
                twist_low_rad: self.low_rad,
                twist_high_rad: self.high_rad,
                cone: self.cone()?,
            }),
            _ => Err(PALP_BAD_ENUM),
        }
    }
}

impl palp_chain_options {
    pub(crate) const DEFAULT: Self = {
        let from = ChainOptions::DEFAULT;
        Self {
            method: from.method,
            flags: from.flags,
            attraction_s: from.attraction_s,
            tip: palp_vec3::new(from.tip),
        }
    };

    pub(crate) const fn to_kernel(self) -> ChainOptions {
        ChainOptions {
            method: self.method,
            flags: self.flags,
            attraction_s: self.attraction_s,
            tip: self.tip.to_array(),
        }
    }
}

impl palp_chain_def {
    /// No joints.
    pub(crate) const NONE: Self = Self {
        struct_size: 0,
        joint_count: 0,
        joints: core::ptr::null(),
        joint_stride: 0,
        base: palp_chain_id::new(ChainId::NULL),
        base_hinge: 0,
        options: palp_chain_options::DEFAULT,
    };

    /// What the chain hangs on, as the kernel says it.
    pub(crate) fn kernel_base(&self) -> Option<(ChainId, u32)> {
        let base = self.base.to_kernel();
        (base != ChainId::NULL).then_some((base, self.base_hinge))
    }
}

impl palp_chain_state {
    pub(crate) const fn new(from: &ChainReport) -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            flags: from.flags,
            steps: from.steps,
            missed_m: from.missed_m,
            deviation_rad: from.deviation_rad,
        }
    }
}

impl palp_chain_id {
    pub(crate) const fn new(id: ChainId) -> Self {
        Self {
            index1: id.index1,
            generation: id.generation,
        }
    }

    pub(crate) const fn to_kernel(self) -> ChainId {
        ChainId {
            index1: self.index1,
            generation: self.generation,
        }
    }
}

// Numbers that the header repeats.
const _: () = {
    assert!(PALP_CHAIN_HINGES_MAX as usize == CHAIN_HINGES_MAX);
    assert!(PALP_CHAINS_PER_BODY_MAX as usize == CHAINS_PER_BODY_MAX);
    assert!(PALP_CONE_CORNERS_MAX as usize == REACH_CONE_EDGES_MAX);
    assert!(PALP_METHOD_LEAST_DEVIATION == ChainOptions::LEAST_DEVIATION);
    assert!(PALP_METHOD_CYCLIC_DESCENT == ChainOptions::CYCLIC_DESCENT);
    assert!(PALP_OPTION_MOVES_ROOT == ChainOptions::MOVES_ROOT);
    assert!(PALP_OPTION_MEETS_BODY == ChainOptions::MEETS_BODY);
    assert!(PALP_OPTION_HOLDS_TIP == ChainOptions::HOLDS_TIP);
    assert!(PALP_OPTION_RIGID == ChainOptions::RIGID);
    assert!(PALP_OPTION_SHUFFLED == ChainOptions::SHUFFLED);
    assert!(PALP_LIMB_JOINTS_MAX as usize == LIMB_JOINTS_MAX);
    assert!(PALP_CHAIN_BENT == ChainReport::BENT);
    assert!(PALP_CHAIN_MISSED == ChainReport::MISSED);
    assert!(PALP_CHAIN_CUT == ChainReport::CUT);
    assert!(PALP_CHAIN_HELD == ChainReport::HELD);
};
