//! The structs and numbers of the header, and what they are in the kernel.

#![allow(non_camel_case_types, reason = "the names in C")]

use core::mem::offset_of;

use palpable_kernel::frame::{Budget, CostTable, Deadline, FrameInput, FrameReport};
use palpable_kernel::limits::{MANIFOLD_CONTACTS_MAX, PIECE_VERTICES_MAX};
use palpable_kernel::math::Pose;
use palpable_kernel::memory::{BLOCK_ALIGNMENT, BodyId, Capacities, PieceId};
use palpable_kernel::state::bodies::{BodyKind, Coupling, DrivenReport};
use palpable_kernel::state::contacts::ContactPoint;
use palpable_kernel::state::events::ContactEvent;
use palpable_kernel::state::materials::Material;
use palpable_kernel::world::BodyPenetration;

use crate::status::palp_status;

/// A world. Its handle is the address of the block it lies in, which is the host's memory: there is
/// no call to destroy it, and a copy of the block at another address is a second world.
pub struct palp_world {
    _opaque: (),
}

/// Alignment of a world's block, in bytes.
pub const PALP_BLOCK_ALIGNMENT: u32 = 64;
/// Most points of a hull.
pub const PALP_POINTS_MAX: u32 = 512;

/// Three coordinates. The same in memory as `XrVector3f`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct palp_vec3 {
    /// Right.
    pub x: f32,
    /// Up.
    pub y: f32,
    /// Backward.
    pub z: f32,
}

/// A rotation. The same in memory as `XrQuaternionf`. Need not have unit length where the host gives
/// it: lengths from 0.001 to 1000 are normalised.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_quat {
    /// First imaginary part.
    pub x: f32,
    /// Second imaginary part.
    pub y: f32,
    /// Third imaginary part.
    pub z: f32,
    /// Real part.
    pub w: f32,
}

/// Where a thing is. 28 bytes, the same in memory as `XrPosef`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_pose {
    /// Orientation.
    pub orientation: palp_quat,
    /// Position in metres.
    pub position: palp_vec3,
}

/// Names a body. All zeros is null. A stale id is refused.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct palp_body_id {
    /// Index of the slot plus one; zero is null.
    pub index1: u32,
    /// How often the slot has been used.
    pub generation: u32,
}

/// Names a piece. All zeros is null. A stale id is refused.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct palp_piece_id {
    /// Index of the slot plus one; zero is null. `index1 - 1` is the index in `palp_piece_poses`.
    pub index1: u32,
    /// How often the slot has been used.
    pub generation: u32,
}

/// How much of everything a world has room for. Start from `PALP_CAPACITIES_ROOM`, ship what
/// `palp_high_water` says.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct palp_capacities {
    /// `sizeof(palp_capacities)`.
    pub struct_size: u32,
    /// Bodies of all kinds.
    pub bodies: u32,
    /// Pieces of all bodies.
    pub pieces: u32,
    /// Vertices of all pieces: a point has 1, a segment 2, a box 8.
    pub vertices: u32,
    /// Pairs of pieces that may touch within one frame, and gaps that driven bodies remember when one is cut.
    pub pairs: u32,
    /// Contacts of loose bodies within one frame, and contacts that `palp_contacts` can give.
    pub contacts: u32,
    /// Materials that the host adds.
    pub materials: u32,
    /// Chains of joints of all bodies.
    pub chains: u32,
    /// Hinges of all chains; a ball joint is three.
    pub joints: u32,
}

/// Never moves; only `palp_body_place` moves it.
pub const PALP_KIND_FIXED: u32 = 1;
/// Moved by impulses and gravity.
pub const PALP_KIND_DYNAMIC: u32 = 2;
/// Follows a tracker, and never into a fixed body.
pub const PALP_KIND_DRIVEN: u32 = 3;
/// Moved by the host's own physics engine, which tells of it with `palp_hosted_set` before each frame and
/// applies what `palp_hosted_impulse` gives before its own step.
pub const PALP_KIND_HOSTED: u32 = 4;

/// A detached body stays where contact holds it.
pub const PALP_SNAP_NEVER: u32 = 0;
/// A detached body jumps to its tracker as soon as nothing is in the way there.
pub const PALP_SNAP_WHEN_FREE: u32 = 1;
/// A detached body jumps to the place nearest to its tracker where nothing is in the way, as soon as there is one within
/// half of `divergence_m`: one that stands on a floor, or whose tracker is in a table top, does so too.
pub const PALP_SNAP_NEAR: u32 = 2;

/// The body pushes what is free as if it had no end of mass: without lag.
pub const PALP_PUSH_WITHOUT_LAG: u32 = 0;
/// The body pushes with the mass of its spring, and gives way to what is heavy.
pub const PALP_PUSH_WITH_MASS: u32 = 1;

/// The spring between a tracker and a driven body. It carries only what contact forces: free motion
/// does not lag.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_coupling {
    /// Mass in kg, above 0.
    pub mass_kg: f32,
    /// Stiffness in N/m, 0 or more.
    pub stiffness_n_per_m: f32,
    /// Damping in N s/m, 0 or more.
    pub damping_n_s_per_m: f32,
    /// How far body and tracker may be apart before the body counts as detached, in metres, above 0.
    pub divergence_m: f32,
    /// What happens then: `PALP_SNAP_NEVER`, `PALP_SNAP_WHEN_FREE` or `PALP_SNAP_NEAR`.
    pub snap: u32,
    /// How long a lost tracker's last target is kept before the body counts as lost, in seconds.
    pub grace_s: f32,
    /// How the body pushes loose ones: `PALP_PUSH_WITHOUT_LAG` or `PALP_PUSH_WITH_MASS`.
    pub push: u32,
}

/// What a body is made from. Start from `PALP_BODY_DEF_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_body_def {
    /// `sizeof(palp_body_def)`.
    pub struct_size: u32,
    /// `PALP_KIND_FIXED`, `PALP_KIND_DYNAMIC`, `PALP_KIND_DRIVEN` or `PALP_KIND_HOSTED`.
    pub kind: u32,
    /// Where it is.
    pub pose: palp_pose,
    /// The spring of a driven body; not looked at for others.
    pub coupling: palp_coupling,
}

/// A point at the piece's origin: with the radius, a sphere.
pub const PALP_SHAPE_POINT: u32 = 1;
/// The segment from `a` to `b`: with the radius, a capsule.
pub const PALP_SHAPE_SEGMENT: u32 = 2;
/// A box with half extents `a`, centred; with a radius, rounded outward.
pub const PALP_SHAPE_BOX: u32 = 3;
/// The hull of `points`; with a radius, rounded outward.
pub const PALP_SHAPE_HULL: u32 = 4;

/// Built-in material: wood.
pub const PALP_MATERIAL_WOOD: u32 = 0;
/// Built-in material: skin.
pub const PALP_MATERIAL_HUMAN: u32 = 1;
/// Built-in material: metal.
pub const PALP_MATERIAL_METAL: u32 = 2;

/// What a piece is made from. Start from `PALP_PIECE_DEF_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_piece_def {
    /// `sizeof(palp_piece_def)`.
    pub struct_size: u32,
    /// One of the `PALP_SHAPE_` numbers.
    pub shape: u32,
    /// Points of a hull in metres, each three floats; read during the call only. Those inside the
    /// hull are left out.
    pub points: *const f32,
    /// Number of points, 4 to `PALP_POINTS_MAX`.
    pub point_count: u32,
    /// Bytes from one point to the next, a multiple of 4; 0 stands for 12.
    pub point_stride: u32,
    /// One end of a segment, or half extents of a box, in metres.
    pub a: palp_vec3,
    /// Other end of a segment, in metres.
    pub b: palp_vec3,
    /// Rounding radius in metres, 0 or more.
    pub radius_m: f32,
    /// Density in kg/m3, above 0 and at most 1e9; looked at for dynamic bodies only.
    pub density_kg_m3: f32,
    /// A `PALP_MATERIAL_` number or one from `palp_material_add`.
    pub material: u32,
    /// Pose in the body's frame.
    pub local_pose: palp_pose,
}

/// What work costs on the host's machine, in nanoseconds: measured worst cases with a margin, not
/// guarantees. A unit's price covers all that a stage does between two units. All zero costs nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct palp_costs {
    /// A frame of an empty world.
    pub frame_ns: u32,
    /// Each body, whatever it does.
    pub body_ns: u32,
    /// Each piece, whatever it does.
    pub piece_ns: u32,
    /// Each chain, whatever it does.
    pub chain_ns: u32,
    /// Each 256 tests of two boxes against each other.
    pub boxes_ns: u32,
    /// A unit of `palp_frame_input.advance_units`.
    pub advance_unit_ns: u32,
    /// A unit of `palp_frame_input.impulse_units`.
    pub impulse_unit_ns: u32,
    /// A step of `palp_frame_input.reach_steps`.
    pub reach_step_ns: u32,
}

/// What a frame is given. Start from `PALP_FRAME_INPUT_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_frame_input {
    /// `sizeof(palp_frame_input)`.
    pub struct_size: u32,
    /// Time since the frame before, in seconds. Kept between 0.0001 and 0.1; not above zero is
    /// refused.
    pub dt_s: f32,
    /// Work that may be spent on driven bodies; one unit is one distance query between two ordinary pieces,
    /// and more with many vertices.
    pub advance_units: u32,
    /// Work that may be spent on loose bodies, in the same units; eight impulses make one as well.
    pub impulse_units: u32,
    /// Steps that may be spent on chains that touch something: a sweep of cyclic descent, or a step of
    /// least deviation. A chain that gets none goes as far as contact lets its joints follow the trackers.
    pub reach_steps: u32,
    /// How long the frame may take by `costs`, in nanoseconds; zero for as long as its units last. The floor
    /// (`palp_frame_floor`) is paid first, then driven bodies, then loose ones, for which a quarter is kept
    /// while any is awake. A deadline below the floor publishes the last safe poses.
    pub deadline_ns: u32,
    /// What work costs.
    pub costs: palp_costs,
    /// One when `focus` is where the viewer looks, in the world: when time is short, what is near goes first.
    pub has_focus: u32,
    pub focus: palp_vec3,
}

/// The time step was not a positive number: nothing moved.
pub const PALP_FRAME_BAD_TIME_STEP: u32 = 1;
/// The time step was clamped.
pub const PALP_FRAME_TIME_STEP_CLAMPED: u32 = 2;
/// A driven body's way was cut by the budget.
pub const PALP_FRAME_CUT_ADVANCE: u32 = 4;
/// Loose bodies were stopped early by the budget or by the bound on events.
pub const PALP_FRAME_CUT_IMPULSES: u32 = 8;
/// Pairs were left out and their movers held: raise `palp_capacities.pairs`.
pub const PALP_FRAME_FULL_PAIRS: u32 = 16;
/// Contacts were left out: raise `palp_capacities.contacts`.
pub const PALP_FRAME_FULL_CONTACTS: u32 = 32;
/// A driven body overlaps a fixed one where the host put it.
pub const PALP_FRAME_OVERLAP: u32 = 64;
/// The steps for chains were used up: raise `palp_frame_input.reach_steps`.
pub const PALP_FRAME_CUT_REACH: u32 = 128;
/// The frame's time was used up, by `palp_frame_input.costs`.
pub const PALP_FRAME_OUT_OF_TIME: u32 = 256;
/// The clock of `palp_frame_step_by_clock` ended the frame's work. Stepping with the units of this report
/// and no deadline gives the same bits.
pub const PALP_FRAME_LATE: u32 = 512;
/// The deadline is shorter than the frame's floor: no unit was spent.
pub const PALP_FRAME_BELOW_FLOOR: u32 = 1024;
/// The calling thread puts numbers below 1.2e-38 to zero, and the library cannot switch that off on this
/// processor: bits may not be those of other machines. Never set on x86-64 and 64-bit Arm.
pub const PALP_FRAME_FLUSHES_TO_ZERO: u32 = 2048;

/// What a frame did. Start from `PALP_FRAME_REPORT_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_frame_report {
    /// `sizeof(palp_frame_report)`.
    pub struct_size: u32,
    /// `PALP_FRAME_` bits.
    pub flags: u32,
    /// Frames stepped so far, this one included.
    pub frame: u64,
    /// Units spent on driven bodies.
    pub advance_units: u32,
    /// Units spent on loose bodies.
    pub impulse_units: u32,
    /// Contacts that `palp_contacts` gives.
    pub contacts: u32,
    /// Impulses applied.
    pub impulses: u32,
    /// Time by which loose bodies were stopped before the end of the frame, at most, in seconds.
    pub lost_s: f32,
    /// Steps spent on chains; none while nothing touches one.
    pub reach_steps: u32,
    /// Contact events that `palp_contact_events` gives.
    pub events: u32,
    /// Contact events that found no room: raise `palp_capacities.contacts`.
    pub events_dropped: u32,
    /// Driven bodies whose way was cut: the rest follows, before all others, in the next frame.
    pub driven_cut: u32,
    /// Chains that got fewer steps than they wanted.
    pub chains_cut: u32,
    /// Loose bodies that were stopped before the end of the frame.
    pub loose_cut: u32,
    /// Bodies of both kinds that were to move and have the poses of the last frame because there was no
    /// time for them.
    pub kept: u32,
    /// What the frame costs whatever happens, by the input's prices, in nanoseconds; zero without a
    /// deadline.
    pub floor_ns: u32,
    /// What it cost by those prices, at most `UINT32_MAX`.
    pub priced_ns: u32,
}

/// Contact bent or ended the body's way.
pub const PALP_DRIVEN_TOUCHING: u32 = 1;
/// The body stayed exactly where it was.
pub const PALP_DRIVEN_HELD: u32 = 2;
/// The body is farther from its tracker than `palp_coupling.divergence_m`.
pub const PALP_DRIVEN_DETACHED: u32 = 4;
/// The tracker has been lost for longer than `palp_coupling.grace_s`.
pub const PALP_DRIVEN_LOST: u32 = 8;
/// The budget ended the body's way early, or a loose body did between two postures within the reach cones; the
/// rest follows next frame.
pub const PALP_DRIVEN_CUT: u32 = 16;
/// The host placed things so that the body overlaps a fixed one, and no way out was found yet.
pub const PALP_DRIVEN_OVERLAPS: u32 = 32;
/// A pool was full: the body stayed where it was.
pub const PALP_DRIVEN_POOL_FULL: u32 = 64;
/// There was no room for all contacts that `palp_contacts` can give.
pub const PALP_DRIVEN_CONTACTS_FULL: u32 = 128;

/// What the last frame did to a driven body. Start from `PALP_DRIVEN_STATE_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_driven_state {
    /// `sizeof(palp_driven_state)`.
    pub struct_size: u32,
    /// `PALP_DRIVEN_` bits.
    pub flags: u32,
    /// How far contact holds the body from its target, in metres.
    pub displacement_m: f32,
    /// Force of the coupling on the hand, in newtons, in the world: the haptic signal.
    pub force_n: palp_vec3,
    /// Mean force of loose bodies on the body over the frame, in newtons, in the world. A body that pushes
    /// without lag feels it here alone; one that gives way feels it in its coupling too.
    pub reaction_n: palp_vec3,
}

/// A contact of the last frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_contact {
    /// Piece of the driven or dynamic body.
    pub piece_a: palp_piece_id,
    /// Piece of the other body.
    pub piece_b: palp_piece_id,
    /// Midway between the surfaces, in the world, in metres.
    pub point: palp_vec3,
    /// From B into A, unit length.
    pub normal: palp_vec3,
    /// Distance of the surfaces in metres; negative is overlap.
    pub gap_m: f32,
    /// Impulse on A along the normal during the frame, in newton seconds; zero for driven against
    /// fixed.
    pub impulse_n_s: f32,
    /// Fastest approach of the surfaces in the frame before an impulse, in m/s; zero for driven against
    /// fixed.
    pub approach_m_s: f32,
    /// Speed of the surfaces along each other, in m/s.
    pub slide_m_s: f32,
}

/// The pieces did not touch in the frame before.
pub const PALP_EVENT_BEGIN: u32 = 1;
/// The pieces touched in the frame before, and still do.
pub const PALP_EVENT_STAY: u32 = 2;
/// The pieces do not touch any more.
pub const PALP_EVENT_END: u32 = 3;

/// Two pieces that began to touch, still do, or came apart: for haptics and sound.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_contact_event {
    /// `PALP_EVENT_BEGIN`, `PALP_EVENT_STAY` or `PALP_EVENT_END`.
    pub kind: u32,
    /// Piece of the driven or loose body. After an end it may be gone.
    pub piece_a: palp_piece_id,
    /// Piece of the other body.
    pub piece_b: palp_piece_id,
    /// Material of A: a `PALP_MATERIAL_` number or one from `palp_material_add`.
    pub material_a: u32,
    /// Material of B.
    pub material_b: u32,
    /// Mean of the contacts' points, weighted by their impulses, in the world, in metres; after an end the
    /// last one.
    pub point: palp_vec3,
    /// From B into A at the contact with the largest impulse, unit length.
    pub normal: palp_vec3,
    /// Sum of the normal impulses during the frame, in newton seconds; zero for driven against fixed.
    pub impulse_n_s: f32,
    /// Fastest approach before an impulse, in m/s: how hard the pieces met.
    pub approach_m_s: f32,
    /// Fastest slip, in m/s.
    pub slide_m_s: f32,
}

/// Most contacts between one pair of pieces.
pub const PALP_PAIR_CONTACTS: u32 = 4;

/// How two bodies lie to each other. Start from `PALP_PENETRATION_RESULT_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_penetration_result {
    /// `sizeof(palp_penetration_result)`.
    pub struct_size: u32,
    /// How many of `contacts` there are; none when the bodies are apart.
    pub contact_count: u32,
    /// Length of the least translation of A that parts the bodies, in metres; zero when they are apart.
    pub depth_m: f32,
    /// Distance of the bodies in metres; zero when they overlap, infinite when one has no pieces.
    pub distance_m: f32,
    /// From B into A, unit length: along the least translation, or between the closest points. Zero when
    /// a body has no pieces.
    pub normal: palp_vec3,
    /// Where A's surface is nearest to B, or deepest in it, in the world, in metres.
    pub point_a: palp_vec3,
    /// Where B's surface is nearest to A, or deepest in it, in the world, in metres.
    pub point_b: palp_vec3,
    /// A's piece of the nearest, or deepest, pair; null when a body has no pieces.
    pub piece_a: palp_piece_id,
    /// B's piece of that pair.
    pub piece_b: palp_piece_id,
    /// Contacts of that pair, with that pair's own normal. Their impulse is zero.
    pub contacts: [palp_contact; PALP_PAIR_CONTACTS as usize],
}

/// The first of several entries that was refused.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct palp_refusal {
    /// Its place among those given, from 0; their number when none was refused.
    pub index: u32,
    /// Why; PALP_OK when none was refused.
    pub status: palp_status,
}

/// Joints of a hand in OpenXR: `XR_HAND_JOINT_COUNT_EXT`.
pub const PALP_HAND_JOINTS: u32 = 26;

impl palp_capacities {
    pub(crate) const fn new(from: &Capacities) -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            bodies: from.bodies,
            pieces: from.pieces,
            vertices: from.vertices,
            pairs: from.pairs,
            contacts: from.contacts,
            materials: from.materials,
            chains: from.chains,
            joints: from.joints,
        }
    }

    pub(crate) const fn to_kernel(self) -> Capacities {
        Capacities {
            bodies: self.bodies,
            pieces: self.pieces,
            vertices: self.vertices,
            pairs: self.pairs,
            contacts: self.contacts,
            materials: self.materials,
            chains: self.chains,
            joints: self.joints,
        }
    }
}

impl palp_vec3 {
    pub(crate) const fn new([x, y, z]: [f32; 3]) -> Self {
        Self { x, y, z }
    }

    pub(crate) const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }
}

impl palp_pose {
    pub(crate) const IDENTITY: Self = Self::new(&Pose::IDENTITY);

    pub(crate) const fn new(pose: &Pose) -> Self {
        let [x, y, z, w] = pose.rotation;
        Self {
            orientation: palp_quat { x, y, z, w },
            position: palp_vec3::new(pose.position),
        }
    }

    pub(crate) const fn to_kernel(self) -> Pose {
        let q = self.orientation;
        Pose {
            rotation: [q.x, q.y, q.z, q.w],
            position: self.position.to_array(),
        }
    }
}

impl palp_coupling {
    pub(crate) const DEFAULT: Self = {
        let from = Coupling::DEFAULT;
        Self {
            mass_kg: from.mass_kg,
            stiffness_n_per_m: from.stiffness_n_per_m,
            damping_n_s_per_m: from.damping_n_s_per_m,
            divergence_m: from.divergence_m,
            snap: from.snap,
            grace_s: from.grace_s,
            push: from.push,
        }
    };

    pub(crate) const fn to_kernel(self) -> Coupling {
        Coupling {
            mass_kg: self.mass_kg,
            stiffness_n_per_m: self.stiffness_n_per_m,
            damping_n_s_per_m: self.damping_n_s_per_m,
            divergence_m: self.divergence_m,
            snap: self.snap,
            grace_s: self.grace_s,
            push: self.push,
        }
    }
}

impl palp_frame_input {
    pub(crate) const fn to_kernel(self) -> FrameInput {
        FrameInput {
            dt_s: self.dt_s,
            budget: Budget {
                advance_units: self.advance_units,
                impulse_units: self.impulse_units,
                reach_steps: self.reach_steps,
            },
            deadline: match self.deadline_ns {
                0 => None,
                time_ns => Some(Deadline {
                    time_ns: time_ns as u64,
                    costs: self.costs.to_kernel(),
                }),
            },
            focus: match self.has_focus {
                0 => None,
                _ => Some(self.focus.to_array()),
            },
        }
    }
}

impl palp_costs {
    pub(crate) const FREE: Self = Self {
        frame_ns: 0,
        body_ns: 0,
        piece_ns: 0,
        chain_ns: 0,
        boxes_ns: 0,
        advance_unit_ns: 0,
        impulse_unit_ns: 0,
        reach_step_ns: 0,
    };

    pub(crate) const fn to_kernel(self) -> CostTable {
        CostTable {
            frame_ns: self.frame_ns,
            body_ns: self.body_ns,
            piece_ns: self.piece_ns,
            chain_ns: self.chain_ns,
            boxes_ns: self.boxes_ns,
            advance_unit_ns: self.advance_unit_ns,
            impulse_unit_ns: self.impulse_unit_ns,
            reach_step_ns: self.reach_step_ns,
        }
    }
}

const fn saturated(number: u64) -> u32 {
    if number > u32::MAX as u64 {
        u32::MAX
    } else {
        number as u32
    }
}

impl palp_frame_report {
    pub(crate) const fn new(from: &FrameReport) -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            flags: from.flags,
            frame: from.frame,
            advance_units: from.advance_units,
            impulse_units: from.impulse_units,
            contacts: from.contacts,
            impulses: from.impulses,
            lost_s: from.lost_s,
            reach_steps: from.reach_steps,
            events: from.events,
            events_dropped: from.events_dropped,
            driven_cut: from.driven_cut,
            chains_cut: from.chains_cut,
            loose_cut: from.loose_cut,
            kept: from.kept,
            floor_ns: saturated(from.floor_ns),
            priced_ns: saturated(from.priced_ns),
        }
    }
}

impl palp_driven_state {
    pub(crate) const fn new(from: &DrivenReport) -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            flags: from.flags,
            displacement_m: from.displacement_m,
            force_n: palp_vec3::new(from.force_n),
            reaction_n: palp_vec3::new(from.reaction_n),
        }
    }
}

impl palp_contact {
    pub(crate) const NONE: Self = Self {
        piece_a: palp_piece_id::NULL,
        piece_b: palp_piece_id::NULL,
        point: palp_vec3::new([0.0; 3]),
        normal: palp_vec3::new([0.0; 3]),
        gap_m: 0.0,
        impulse_n_s: 0.0,
        approach_m_s: 0.0,
        slide_m_s: 0.0,
    };

    const fn new(from: &ContactPoint) -> Self {
        Self {
            piece_a: palp_piece_id::new(from.piece_a),
            piece_b: palp_piece_id::new(from.piece_b),
            point: palp_vec3::new(from.point),
            normal: palp_vec3::new(from.normal),
            gap_m: from.gap_m,
            impulse_n_s: from.impulse_n_s,
            approach_m_s: from.approach_m_s,
            slide_m_s: from.slide_m_s,
        }
    }
}

impl palp_penetration_result {
    pub(crate) fn new(from: &BodyPenetration) -> Self {
        let mut contacts = [palp_contact::NONE; PALP_PAIR_CONTACTS as usize];
        for (contact, found) in contacts.iter_mut().zip(&from.contacts) {
            *contact = palp_contact::new(found);
        }
        Self {
            struct_size: size_of::<Self>() as u32,
            contact_count: from.contacts.len() as u32,
            depth_m: from.depth_m,
            distance_m: from.distance_m,
            normal: palp_vec3::new(from.normal),
            point_a: palp_vec3::new(from.point_a),
            point_b: palp_vec3::new(from.point_b),
            piece_a: palp_piece_id::new(from.piece_a),
            piece_b: palp_piece_id::new(from.piece_b),
            contacts,
        }
    }
}

impl palp_body_id {
    pub(crate) const fn new(id: BodyId) -> Self {
        Self {
            index1: id.index1,
            generation: id.generation,
        }
    }

    pub(crate) const fn to_kernel(self) -> BodyId {
        BodyId {
            index1: self.index1,
            generation: self.generation,
        }
    }
}

impl palp_piece_id {
    pub(crate) const NULL: Self = Self::new(PieceId::NULL);

    pub(crate) const fn new(id: PieceId) -> Self {
        Self {
            index1: id.index1,
            generation: id.generation,
        }
    }

    pub(crate) const fn to_kernel(self) -> PieceId {
        PieceId {
            index1: self.index1,
            generation: self.generation,
        }
    }
}

// Columns of the kernel are handed out as these types.
const _: () = {
    assert!(size_of::<palp_pose>() == 28 && size_of::<Pose>() == 28);
    assert!(align_of::<palp_pose>() == align_of::<Pose>());
    assert!(offset_of!(palp_pose, orientation) == offset_of!(Pose, rotation));
    assert!(offset_of!(palp_pose, position) == offset_of!(Pose, position));
    assert!(size_of::<palp_contact>() == size_of::<ContactPoint>());
    assert!(align_of::<palp_contact>() == align_of::<ContactPoint>());
    assert!(offset_of!(palp_contact, piece_a) == offset_of!(ContactPoint, piece_a));
    assert!(offset_of!(palp_contact, piece_b) == offset_of!(ContactPoint, piece_b));
    assert!(offset_of!(palp_contact, point) == offset_of!(ContactPoint, point));
    assert!(offset_of!(palp_contact, normal) == offset_of!(ContactPoint, normal));
    assert!(offset_of!(palp_contact, gap_m) == offset_of!(ContactPoint, gap_m));
    assert!(offset_of!(palp_contact, impulse_n_s) == offset_of!(ContactPoint, impulse_n_s));
    assert!(offset_of!(palp_contact, approach_m_s) == offset_of!(ContactPoint, approach_m_s));
    assert!(offset_of!(palp_contact, slide_m_s) == offset_of!(ContactPoint, slide_m_s));
};

// And the column of events.
const _: () = {
    assert!(size_of::<palp_contact_event>() == size_of::<ContactEvent>());
    assert!(align_of::<palp_contact_event>() == align_of::<ContactEvent>());
    assert!(size_of::<Material>() == size_of::<u32>());
    assert!(offset_of!(palp_contact_event, kind) == offset_of!(ContactEvent, kind));
    assert!(offset_of!(palp_contact_event, piece_a) == offset_of!(ContactEvent, piece_a));
    assert!(offset_of!(palp_contact_event, piece_b) == offset_of!(ContactEvent, piece_b));
    assert!(offset_of!(palp_contact_event, material_a) == offset_of!(ContactEvent, material_a));
    assert!(offset_of!(palp_contact_event, material_b) == offset_of!(ContactEvent, material_b));
    assert!(offset_of!(palp_contact_event, point) == offset_of!(ContactEvent, point));
    assert!(offset_of!(palp_contact_event, normal) == offset_of!(ContactEvent, normal));
    assert!(offset_of!(palp_contact_event, impulse_n_s) == offset_of!(ContactEvent, impulse_n_s));
    assert!(offset_of!(palp_contact_event, approach_m_s) == offset_of!(ContactEvent, approach_m_s));
    assert!(offset_of!(palp_contact_event, slide_m_s) == offset_of!(ContactEvent, slide_m_s));
};

// Numbers that the header repeats.
const _: () = {
    assert!(PALP_BLOCK_ALIGNMENT as usize == BLOCK_ALIGNMENT);
    assert!(PALP_POINTS_MAX as usize == PIECE_VERTICES_MAX);
    assert!(PALP_PAIR_CONTACTS as usize == MANIFOLD_CONTACTS_MAX);
    assert!(PALP_KIND_FIXED == BodyKind::Fixed as u32);
    assert!(PALP_KIND_DYNAMIC == BodyKind::Dynamic as u32);
    assert!(PALP_KIND_DRIVEN == BodyKind::Driven as u32);
    assert!(PALP_KIND_HOSTED == BodyKind::Hosted as u32);
    assert!(PALP_PUSH_WITHOUT_LAG == Coupling::PUSH_WITHOUT_LAG);
    assert!(PALP_PUSH_WITH_MASS == Coupling::PUSH_WITH_MASS);
    assert!(PALP_EVENT_BEGIN == ContactEvent::BEGIN);
    assert!(PALP_EVENT_STAY == ContactEvent::STAY);
    assert!(PALP_EVENT_END == ContactEvent::END);
    assert!(PALP_SNAP_NEVER == Coupling::SNAP_NEVER);
    assert!(PALP_SNAP_WHEN_FREE == Coupling::SNAP_WHEN_FREE);
    assert!(PALP_SNAP_NEAR == Coupling::SNAP_NEAR);
    assert!(PALP_MATERIAL_WOOD == Material::WOOD.0);
    assert!(PALP_MATERIAL_HUMAN == Material::HUMAN.0);
    assert!(PALP_MATERIAL_METAL == Material::METAL.0);
    assert!(PALP_FRAME_BAD_TIME_STEP == FrameReport::BAD_TIME_STEP);
    assert!(PALP_FRAME_TIME_STEP_CLAMPED == FrameReport::TIME_STEP_CLAMPED);
    assert!(PALP_FRAME_CUT_ADVANCE == FrameReport::ADVANCE_CUT);
    assert!(PALP_FRAME_CUT_IMPULSES == FrameReport::IMPULSES_CUT);
    assert!(PALP_FRAME_FULL_PAIRS == FrameReport::FULL_PAIRS);
    assert!(PALP_FRAME_FULL_CONTACTS == FrameReport::FULL_CONTACTS);
    assert!(PALP_FRAME_OVERLAP == FrameReport::OVERLAP);
    assert!(PALP_FRAME_CUT_REACH == FrameReport::REACH_CUT);
    assert!(PALP_FRAME_OUT_OF_TIME == FrameReport::OUT_OF_TIME);
    assert!(PALP_FRAME_LATE == FrameReport::LATE);
    assert!(PALP_FRAME_BELOW_FLOOR == FrameReport::BELOW_FLOOR);
    assert!(PALP_FRAME_FLUSHES_TO_ZERO == FrameReport::FLUSHES_TO_ZERO);
    assert!(PALP_DRIVEN_TOUCHING == DrivenReport::TOUCHING);
    assert!(PALP_DRIVEN_HELD == DrivenReport::HELD);
    assert!(PALP_DRIVEN_DETACHED == DrivenReport::DETACHED);
    assert!(PALP_DRIVEN_LOST == DrivenReport::LOST);
    assert!(PALP_DRIVEN_CUT == DrivenReport::CUT);
    assert!(PALP_DRIVEN_OVERLAPS == DrivenReport::OVERLAPS);
    assert!(PALP_DRIVEN_POOL_FULL == DrivenReport::POOL_FULL);
    assert!(PALP_DRIVEN_CONTACTS_FULL == DrivenReport::CONTACTS_FULL);
};
