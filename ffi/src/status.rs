//! Status codes: what every call returns.

use core::ffi::{CStr, c_char};

/// What a call came to: zero is fine, positive is done but cut short, negative is refused with
/// nothing changed. A number never gets a second meaning.
#[allow(non_camel_case_types, reason = "the name in C")]
pub type palp_status = i32;

/// Done.
pub const PALP_OK: palp_status = 0;

/// Stepped, with the time step clamped to 0.0001 to 0.1 s.
pub const PALP_TIME_STEP_CLAMPED: palp_status = 1;
/// Stepped; loose bodies stopped early: raise `palp_frame_input.impulse_units`.
pub const PALP_CUT_IMPULSES: palp_status = 2;
/// Stepped; a driven body's way was cut and goes on next frame: raise `palp_frame_input.advance_units`.
pub const PALP_CUT_ADVANCE: palp_status = 3;
/// Stepped; contacts were left out: raise `palp_capacities.contacts`.
pub const PALP_FULL_CONTACTS: palp_status = 4;
/// Stepped; pairs were left out and their movers held: raise `palp_capacities.pairs`.
pub const PALP_FULL_PAIRS: palp_status = 5;
/// Stepped; a driven body overlaps a fixed one where the host put it.
pub const PALP_OVERLAP: palp_status = 6;
/// Set; pieces whose joints were not good keep their last targets.
pub const PALP_JOINTS_IGNORED: palp_status = 7;
/// Nothing set, because the wrist was not good: the next frame counts the tracker as lost.
pub const PALP_TRACKING_LOST: palp_status = 8;
/// Answered for a part of the pairs of pieces in the way: the depth may be too small to part the bodies.
pub const PALP_PAIRS_LEFT_OUT: palp_status = 9;
/// Stepped; chains in contact got fewer steps than they wanted: raise `palp_frame_input.reach_steps`.
pub const PALP_CUT_REACH: palp_status = 10;
/// Done for every entry but those that were refused; `palp_refusal` names the first of them.
pub const PALP_ENTRIES_REFUSED: palp_status = 11;
/// Nothing done: the log has no more calls.
pub const PALP_REPLAY_END: palp_status = 16;
/// Done, and the call came to something else than it did when it was recorded.
pub const PALP_REPLAY_DIFFERS: palp_status = 17;

/// Stepped; the frame's time was used up by the input's prices: raise `palp_frame_input.deadline_ns`.
pub const PALP_OUT_OF_TIME: palp_status = 12;
/// Stepped; the clock ended the frame's work.
pub const PALP_LATE: palp_status = 13;
/// Stepped; the deadline is shorter than the frame's floor, and nothing was spent on contact.
pub const PALP_BELOW_FLOOR: palp_status = 14;
/// Stepped; the thread puts small numbers to zero, which may change bits.
pub const PALP_FLUSHES_TO_ZERO: palp_status = 15;

/// The library failed inside. The world may be half changed: load a saved state or create it anew.
pub const PALP_PANICKED: palp_status = -1;
/// A pointer that must not be null is null.
pub const PALP_NULL: palp_status = -2;
/// A pointer is not aligned to its type, or a block not to `PALP_BLOCK_ALIGNMENT`.
pub const PALP_MISALIGNED: palp_status = -3;
/// A `struct_size` is not that of any version of the struct, or a field that this library does not
/// know is not zero.
pub const PALP_BAD_STRUCT_SIZE: palp_status = -4;
/// A number names no kind, shape or policy.
pub const PALP_BAD_ENUM: palp_status = -5;
/// The block is shorter than `palp_memory_bytes` says.
pub const PALP_MEMORY_TOO_SMALL: palp_status = -6;
/// A capacity is beyond what any world may have.
pub const PALP_CAPACITY_TOO_LARGE: palp_status = -7;
/// The block holds no world.
pub const PALP_NOT_A_WORLD: palp_status = -8;
/// The world, the saved state or the log was made by a library with another memory layout, or the state
/// with other capacities.
pub const PALP_OTHER_LAYOUT: palp_status = -9;
/// The head of a world, or a part of a saved state or of a log, contradicts its checksum.
pub const PALP_DAMAGED: palp_status = -10;
/// The id names no body of this world.
pub const PALP_STALE_BODY: palp_status = -11;
/// The id names no piece of this world.
pub const PALP_STALE_PIECE: palp_status = -12;
/// The body is of a kind that this cannot be done to.
pub const PALP_WRONG_KIND: palp_status = -13;
/// A pose is not finite, farther than 1024 m from the origin, or without orientation.
pub const PALP_BAD_POSE: palp_status = -14;
/// There are not as many entries as the body has pieces, or as the chain has hinges or joints; or a
/// chain is to have no joint, or more than `PALP_CHAIN_HINGES_MAX` hinges.
pub const PALP_WRONG_COUNT: palp_status = -15;
/// The coupling's mass or divergence is not above zero, another of its numbers is negative, or one
/// is not finite.
pub const PALP_BAD_COUPLING: palp_status = -16;
/// A number is outside its range.
pub const PALP_BAD_NUMBER: palp_status = -17;
/// A number is not finite.
pub const PALP_NOT_FINITE: palp_status = -18;
/// A coordinate or a radius is beyond 10 km.
pub const PALP_TOO_LARGE: palp_status = -19;
/// Fewer points than a hull needs.
pub const PALP_TOO_FEW_POINTS: palp_status = -20;
/// More points than `PALP_POINTS_MAX`.
pub const PALP_TOO_MANY_POINTS: palp_status = -21;
/// The shape is flat, or a point or segment without radius, or a box without extent.
pub const PALP_DEGENERATE: palp_status = -22;
/// The world has no such material.
pub const PALP_UNKNOWN_MATERIAL: palp_status = -23;
/// The restitution is outside 0 to 1, or the friction outside 0 to 1e6.
pub const PALP_BAD_SURFACE: palp_status = -24;
/// The time step is not a positive number: nothing moved.
pub const PALP_BAD_TIME_STEP: palp_status = -25;
/// A stride is shorter than what lies in it, or not a multiple of the alignment.
pub const PALP_BAD_STRIDE: palp_status = -26;
/// The buffer is shorter than `palp_state_bytes` says.
pub const PALP_BUFFER_TOO_SMALL: palp_status = -27;
/// A piece names a joint that a hand, or a hinge that the chain, does not have.
pub const PALP_UNKNOWN_JOINT: palp_status = -28;
/// An array or buffer of the host reaches into the world's block.
pub const PALP_INSIDE_WORLD: palp_status = -29;
/// No room for the body: raise `palp_capacities.bodies`.
pub const PALP_FULL_BODIES: palp_status = -30;
/// No room for the piece: raise `palp_capacities.pieces`.
pub const PALP_FULL_PIECES: palp_status = -31;
/// No room for the piece's vertices: raise `palp_capacities.vertices`.
pub const PALP_FULL_VERTICES: palp_status = -32;
/// No room for the material: raise `palp_capacities.materials`.
pub const PALP_FULL_MATERIALS: palp_status = -33;
/// A velocity is not finite or too fast.
pub const PALP_BAD_VELOCITY: palp_status = -34;
/// Two bodies are needed, and both ids name the same one.
pub const PALP_SAME_BODY: palp_status = -35;
/// The id names no chain of this world.
pub const PALP_STALE_CHAIN: palp_status = -36;
/// No room for the chain: raise `palp_capacities.chains`.
pub const PALP_FULL_CHAINS: palp_status = -37;
/// No room for the chain's joints: raise `palp_capacities.joints`.
pub const PALP_FULL_JOINTS: palp_status = -38;
/// The body has `PALP_CHAINS_PER_BODY_MAX` chains.
pub const PALP_TOO_MANY_CHAINS: palp_status = -39;
/// A chain is to hang on what is no chain of the same body, or on a hinge that it does not have.
pub const PALP_BAD_BASE: palp_status = -40;
/// The axis of a hinge has no direction.
pub const PALP_BAD_AXIS: palp_status = -41;
/// A range of angles is not finite, reaches beyond a full turn, or ends below its start.
pub const PALP_BAD_RANGE: palp_status = -42;
/// A chain's options name no method or an unknown flag, its attraction is not 0 to 1e6 s, or its tip is
/// not finite.
pub const PALP_BAD_OPTIONS: palp_status = -43;
/// Another chain hangs on this one.
pub const PALP_CHAIN_IN_USE: palp_status = -44;
/// A reach cone has fewer than 3 corners.
pub const PALP_CONE_TOO_FEW_CORNERS: palp_status = -45;
/// A reach cone has more than `PALP_CONE_CORNERS_MAX` corners.
pub const PALP_CONE_TOO_MANY_CORNERS: palp_status = -46;
/// A corner of a reach cone, or the point that sees it, is zero or not finite.
pub const PALP_CONE_NO_DIRECTION: palp_status = -47;
/// Neighbouring corners of a reach cone are less than a milliradian apart, or less from opposite.
pub const PALP_CONE_BAD_EDGE: palp_status = -48;
/// The visible point of a reach cone does not see every edge from inside, by a milliradian at least.
pub const PALP_CONE_NOT_VISIBLE: palp_status = -49;
/// The corners of a reach cone go around its visible point more than once.
pub const PALP_CONE_BAD_WINDING: palp_status = -50;
/// A force, a torque or an impulse is not finite, or a coordinate of it or of its sum is beyond 1e9.
pub const PALP_BAD_FORCE: palp_status = -51;
/// A mass or a moment of inertia is outside 1e-9 to 1e9, the centre of mass is not finite or farther than
/// 1024 m from the body's origin, or the principal axes have no direction.
pub const PALP_BAD_MASS: palp_status = -52;
/// The bytes do not start as a log does.
pub const PALP_NOT_A_LOG: palp_status = -53;
/// The log has another format than this library reads.
pub const PALP_OTHER_LOG_VERSION: palp_status = -54;
/// The log ends in the middle of its head, of its state or of a call. A call of which only the outcome is
/// missing was made.
pub const PALP_LOG_CUT_SHORT: palp_status = -55;
/// The log has a call that this library does not know, or none where one is to be.
pub const PALP_UNKNOWN_CALL: palp_status = -56;
/// The arguments of a call in the log are not what such a call has.
pub const PALP_MALFORMED_CALL: palp_status = -57;
/// Called by the sink of the same world.
pub const PALP_INSIDE_SINK: palp_status = -58;

const TEXTS: &[(palp_status, &CStr)] = &[
    (PALP_OK, c"done"),
    (
        PALP_TIME_STEP_CLAMPED,
        c"the time step was clamped to 0.0001 to 0.1 s",
    ),
    (
        PALP_CUT_IMPULSES,
        c"loose bodies stopped early: raise palp_frame_input.impulse_units",
    ),
    (
        PALP_CUT_ADVANCE,
        c"a driven body was cut: raise palp_frame_input.advance_units",
    ),
    (
        PALP_FULL_CONTACTS,
        c"contacts were left out: raise palp_capacities.contacts",
    ),
    (
        PALP_FULL_PAIRS,
        c"pairs were left out and their movers held: raise palp_capacities.pairs",
    ),
    (
        PALP_OVERLAP,
        c"a driven body overlaps a fixed one where the host put it",
    ),
    (
        PALP_JOINTS_IGNORED,
        c"pieces whose joints were not good keep their last targets",
    ),
    (
        PALP_TRACKING_LOST,
        c"the wrist was not good: nothing was set",
    ),
    (
        PALP_PANICKED,
        c"the library failed inside: load a saved state or create the world anew",
    ),
    (PALP_NULL, c"a pointer is null"),
    (PALP_MISALIGNED, c"a pointer or a block is misaligned"),
    (
        PALP_BAD_STRUCT_SIZE,
        c"a struct_size is wrong, or an unknown field is not zero",
    ),
    (PALP_BAD_ENUM, c"a number names no kind, shape or policy"),
    (
        PALP_MEMORY_TOO_SMALL,
        c"the block is shorter than palp_memory_bytes says",
    ),
    (
        PALP_CAPACITY_TOO_LARGE,
        c"a capacity is beyond what any world may have",
    ),
    (PALP_NOT_A_WORLD, c"the block holds no world"),
    (
        PALP_OTHER_LAYOUT,
        c"made by a library with another layout, or with other capacities",
    ),
    (PALP_DAMAGED, c"a head, a state or a log contradicts its checksum"),
    (PALP_STALE_BODY, c"the id names no body of this world"),
    (PALP_STALE_PIECE, c"the id names no piece of this world"),
    (
        PALP_WRONG_KIND,
        c"the body is of a kind that this cannot be done to",
    ),
    (
        PALP_BAD_POSE,
        c"a pose is not finite, too far away or without orientation",
    ),
    (
        PALP_WRONG_COUNT,
        c"there are not as many entries as pieces, hinges or joints, or a chain is too short or too long",
    ),
    (PALP_BAD_COUPLING, c"the coupling cannot be integrated"),
    (PALP_BAD_NUMBER, c"a number is outside its range"),
    (PALP_NOT_FINITE, c"a number is not finite"),
    (PALP_TOO_LARGE, c"a coordinate or a radius is beyond 10 km"),
    (PALP_TOO_FEW_POINTS, c"fewer points than a hull needs"),
    (PALP_TOO_MANY_POINTS, c"more points than PALP_POINTS_MAX"),
    (PALP_DEGENERATE, c"the shape has no extent"),
    (PALP_UNKNOWN_MATERIAL, c"the world has no such material"),
    (
        PALP_BAD_SURFACE,
        c"the restitution or the friction is outside its range",
    ),
    (
        PALP_BAD_TIME_STEP,
        c"the time step is not a positive number: nothing moved",
    ),
    (
        PALP_BAD_STRIDE,
        c"a stride is too short or not a multiple of the alignment",
    ),
    (
        PALP_BUFFER_TOO_SMALL,
        c"the buffer is shorter than palp_state_bytes says",
    ),
    (
        PALP_UNKNOWN_JOINT,
        c"a piece names a joint or a hinge that is not there",
    ),
    (
        PALP_INSIDE_WORLD,
        c"an array or buffer of the host reaches into the world's block",
    ),
    (
        PALP_FULL_BODIES,
        c"no room for the body: raise palp_capacities.bodies",
    ),
    (
        PALP_FULL_PIECES,
        c"no room for the piece: raise palp_capacities.pieces",
    ),
    (
        PALP_FULL_VERTICES,
        c"no room for the piece's vertices: raise palp_capacities.vertices",
    ),
    (
        PALP_FULL_MATERIALS,
        c"no room for the material: raise palp_capacities.materials",
    ),
    (PALP_BAD_VELOCITY, c"a velocity is not finite or too fast"),
    (
        PALP_PAIRS_LEFT_OUT,
        c"pairs of pieces were left out: the depth may be too small",
    ),
    (PALP_SAME_BODY, c"both ids name the same body"),
    (
        PALP_CUT_REACH,
        c"chains got fewer steps than they wanted: raise palp_frame_input.reach_steps",
    ),
    (
        PALP_OUT_OF_TIME,
        c"the frame's time was used up: raise palp_frame_input.deadline_ns",
    ),
    (PALP_LATE, c"the clock ended the frame's work"),
    (
        PALP_BELOW_FLOOR,
        c"the deadline is shorter than the frame's floor (palp_frame_floor)",
    ),
    (
        PALP_FLUSHES_TO_ZERO,
        c"the thread puts small numbers to zero: bits may not be those of other machines",
    ),
    (PALP_STALE_CHAIN, c"the id names no chain of this world"),
    (
        PALP_FULL_CHAINS,
        c"no room for the chain: raise palp_capacities.chains",
    ),
    (
        PALP_FULL_JOINTS,
        c"no room for the chain's joints: raise palp_capacities.joints",
    ),
    (
        PALP_TOO_MANY_CHAINS,
        c"the body has PALP_CHAINS_PER_BODY_MAX chains",
    ),
    (
        PALP_BAD_BASE,
        c"the base is no chain of the same body, or has no such hinge",
    ),
    (PALP_BAD_AXIS, c"the axis of a hinge has no direction"),
    (
        PALP_BAD_RANGE,
        c"a range of angles is not finite, too wide, or ends below its start",
    ),
    (
        PALP_BAD_OPTIONS,
        c"a chain's method, flags, attraction or tip are outside their ranges",
    ),
    (PALP_CHAIN_IN_USE, c"another chain hangs on this one"),
    (
        PALP_CONE_TOO_FEW_CORNERS,
        c"a reach cone has fewer than 3 corners",
    ),
    (
        PALP_CONE_TOO_MANY_CORNERS,
        c"a reach cone has more than PALP_CONE_CORNERS_MAX corners",
    ),
    (
        PALP_CONE_NO_DIRECTION,
        c"a corner or the visible point of a reach cone has no direction",
    ),
    (
        PALP_CONE_BAD_EDGE,
        c"neighbouring corners of a reach cone are equal or opposite",
    ),
    (
        PALP_CONE_NOT_VISIBLE,
        c"the visible point of a reach cone does not see every edge from inside",
    ),
    (
        PALP_CONE_BAD_WINDING,
        c"the corners of a reach cone go around its visible point more than once",
    ),
    (
        PALP_ENTRIES_REFUSED,
        c"some entries were refused, the others are done: palp_refusal names the first",
    ),
    (
        PALP_BAD_FORCE,
        c"a force, a torque or an impulse is not finite or too large",
    ),
    (
        PALP_BAD_MASS,
        c"a mass, a moment, a centre of mass or the principal axes are out of range",
    ),
    (PALP_REPLAY_END, c"the log has no more calls"),
    (
        PALP_REPLAY_DIFFERS,
        c"the call came to something else than when it was recorded",
    ),
    (PALP_NOT_A_LOG, c"the bytes are no log"),
    (
        PALP_OTHER_LOG_VERSION,
        c"the log has another format than this library reads",
    ),
    (PALP_LOG_CUT_SHORT, c"the log ends in the middle of something"),
    (PALP_UNKNOWN_CALL, c"the log has a call that is not known"),
    (
        PALP_MALFORMED_CALL,
        c"the arguments of a call in the log are not those of such a call",
    ),
    (PALP_INSIDE_SINK, c"a sink called the library with its own world"),
];

fn text(status: palp_status) -> &'static CStr {
    TEXTS
        .iter()
        .find(|(known, _)| *known == status)
        .map_or(c"unknown status", |(_, text)| text)
}

/// What a status means, in English. Never null; lasts as long as the library is loaded.
#[unsafe(no_mangle)]
pub extern "C" fn palp_status_text(status: palp_status) -> *const c_char {
    text(status).as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_status_has_one_number_and_one_text() {
        let declared = include_str!("status.rs")
            .lines()
            .filter(|line| line.starts_with("pub const PALP_"))
            .count();
        assert_eq!(declared, TEXTS.len());
        for (index, (number, text)) in TEXTS.iter().enumerate() {
            assert!(!text.is_empty());
            assert!(TEXTS[..index].iter().all(|(other, _)| other != number));
        }
    }

    #[test]
    fn a_number_without_meaning_has_a_text_too() {
        assert_eq!(text(i32::MIN), c"unknown status");
        assert_eq!(text(9999), c"unknown status");
    }
}
