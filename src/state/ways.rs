//! Ways: how bodies go through a frame, leg by leg.

use bytemuck::{Pod, Zeroable};

use crate::geometry::motion::{Motion, Track, interpolate};
use crate::limits::LEGS_MAX;
use crate::math::Pose;
use crate::memory::columns::columns;
use crate::state::State;
use crate::state::pieces::Bounds;

/// One straight part of a driven body's way through a frame.
///
/// The root goes from `from` toward `to` (positions linearly, orientations by normalised linear
/// interpolation) as far as `reached`; the pieces' local poses go from `local_from` to `local_to`,
/// both measured as a share of the way from the frame's first to its last local poses.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Leg {
    pub from: Pose,
    pub to: Pose,
    pub local_from: f32,
    pub local_to: f32,
    /// Share of this leg that was found clear.
    pub reached: f32,
    /// Share of the frame at which the leg ends; it starts where the one before ends.
    pub end_time: f32,
}

columns! {
    /// Ways of driven bodies: scratch of one frame.
    pub(crate) struct Legs(capacities) {
        /// [`LEGS_MAX`] for every body slot.
        legs: [Leg; capacities.bodies * LEGS_MAX as u32],
        count: [u32; capacities.bodies],
        /// Where the coupling wants the body.
        wanted: [Pose; capacities.bodies],
        /// Share of the way to the target local poses that the body has gone.
        local_share: [f32; capacities.bodies],
        /// A box around everything the body can touch on its way.
        whole: [Bounds; capacities.bodies],
        /// Share of the frame at which a loose object stopped the body; 1 when none did.
        stop_time: [f32; capacities.bodies],
    }
}

impl Legs<'_> {
    /// The legs of a body, in order.
    pub(crate) fn of(&self, body: usize) -> &[Leg] {
        let first = body * LEGS_MAX;
        &self.legs[first..first + self.count[body] as usize]
    }

    /// Adds a leg; there is room by construction.
    pub(crate) fn push(&mut self, body: usize, leg: Leg) {
        let count = self.count[body] as usize;
        debug_assert!(count < LEGS_MAX);
        self.legs[body * LEGS_MAX + count] = leg;
        self.count[body] += 1;
    }
}

/// How a body's root and its pieces' local poses move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyTrack {
    pub root: Track,
    /// Shares of the way from the published to the target local poses.
    pub local_from: f32,
    pub local_to: f32,
}

impl BodyTrack {
    pub(crate) fn still(pose: Pose, local: f32) -> Self {
        Self {
            root: Track::still(pose),
            local_from: local,
            local_to: local,
        }
    }
}

/// The motion of one piece of a body that moves so.
pub(crate) fn piece_motion(state: &State, piece: usize, track: &BodyTrack) -> Motion {
    let pieces = &state.pieces;
    let shape = &state.pieces.shape[piece];
    let local = Track {
        from: pieces.local[piece],
        to: pieces.local_target[piece],
        start: track.local_from,
        end: track.local_to,
    };
    Motion::new(track.root, local, shape.core_reach())
}

/// A box around a piece's whole way.
pub(crate) fn swept_bounds(state: &State, piece: usize, motion: &Motion) -> Bounds {
    let shape = &state.pieces.shape[piece];
    Bounds::of(shape, &motion.at(0.0))
        .union(Bounds::of(shape, &motion.at(1.0)))
        .grown(motion.bulge_m())
}

/// Where a driven body is at a share of the frame: its root, and the share of its pieces' way.
pub(crate) fn driven_at(legs: &[Leg], start: &Pose, time: f32) -> (Pose, f32) {
    let mut begun = 0.0;
    let mut last = (*start, 0.0);
    for leg in legs {
        if time < leg.end_time {
            let part = (time - begun) / (leg.end_time - begun);
            let share = leg.reached * part;
            return (
                interpolate(&leg.from, &leg.to, share),
                leg.local_from + (leg.local_to - leg.local_from) * share,
            );
        }
        begun = leg.end_time;
        let local = if leg.reached >= 1.0 {
            leg.local_to
        } else {
            leg.local_from + (leg.local_to - leg.local_from) * leg.reached
        };
        last = (interpolate(&leg.from, &leg.to, leg.reached), local);
    }
    last
}

/// Where a driven body is on its way through the frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub root: Pose,
    /// Share of the way from the published to the target local poses.
    pub local: f32,
}

/// The whole way between two positions.
pub(crate) fn track(from: &Position, to: &Position) -> BodyTrack {
    BodyTrack {
        root: Track::between(from.root, to.root),
        local_from: from.local,
        local_to: to.local,
    }
}
