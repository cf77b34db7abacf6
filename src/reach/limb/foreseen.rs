//! What contact is expected to do to a chain, from what it did in the frame before.
//!
//! Contact presses from frame to frame much alike: the wanted angles with a part of the last frame's correction are
//! near to what is looked for, and for the least deviation often all of it.

use core::ops::Range;

use super::{Angles, Problem, TOLERANCE_M};
use crate::geometry::chain::Posture;
use crate::math;
use crate::reach::goal::Row;
use crate::reach::least_deviation::relaxed;
use crate::reach::touch::deepest_m;
use crate::state::State;
use crate::state::chains::joints_of;

/// Most that contact is expected to turn a joint by beyond what it did in the last frame, in radians.
const PRESSED_MORE_RAD: f32 = 0.05;

/// Points that are above their planes by no more than this are pressed, and relaxing may leave them as much below, in
/// metres.
const PRESSED_M: f32 = 1e-5;

/// Joints give way to pushes beside what contact holds that are larger than the first; larger ones than the second take a
/// step, in radians.
const PUSH_RAD: Range<f32> = 6e-4..5e-3;

/// How often the part of what contact did is mended for how heights bend.
const MENDS: u32 = 2;

/// What contact did to a chain in the last frame.
struct Pressed<'p> {
    /// What was added to the wanted angles.
    by: &'p [f32],
    /// The largest part of it that is expected, all of it being one.
    part_max: f32,
    /// Where all of it takes the links.
    all: Posture,
}

impl Pressed<'_> {
    /// The part at which a height is zero that is `above_m` at another part and gains `gain_m` by each whole one.
    fn part(&self, at: f32, above_m: f32, gain_m: f32) -> f32 {
        math::clamp(at - above_m / gain_m, 0.0, self.part_max)
    }
}

impl Problem<'_> {
    /// Angles that a descent begins at: the wanted ones, which take the links to `wanted`, with the part of the last
    /// frame's correction that takes the lowest goal to its plane if heights go straight.
    pub(super) fn begun(&self, state: &State, wanted: &Posture) -> Angles {
        let low_m = self.lowest(wanted).1;
        let part = self.pressed(state).and_then(|pressed| {
            let gain_m = self.lowest(&pressed.all).1 - low_m;
            (gain_m > 0.0)
                .then(|| self.pressed_by(state, &pressed, pressed.part(0.0, low_m, gain_m)))
        });
        part.unwrap_or_else(|| self.wanted.clone())
    }

    /// The least deviation without a step: the wanted angles with the part of the last frame's correction that has the
    /// lowest goal on its plane, relaxed, where they take the links, and what is missed there. None where a step is due.
    ///
    /// Cost: at most four forward kinematics, and the slopes of the goals that press.
    pub(super) fn foreseen(&mut self, state: &State) -> Option<(Angles, Posture, f32)> {
        let pressed = self.pressed(state)?;
        let (lowest, mut above_m) = self.lowest(&pressed.all);
        let goal = self.goals.get(lowest)?;
        let row = goal.row(&goal.levers(&pressed.all));
        let gain_m = self.gain_m(state, &pressed, &row);
        if gain_m <= 0.0 {
            return None;
        }
        let (mut part, mut posture) = (1.0, pressed.all.clone());
        for _ in 0..MENDS {
            if above_m.abs() <= TOLERANCE_M {
                break;
            }
            part = pressed.part(part, above_m, gain_m);
            posture = self.posture(state, &self.pressed_by(state, &pressed, part));
            above_m = self.lowest(&posture).1;
        }
        let mut angles = self.pressed_by(state, &pressed, part);
        self.look(state, &posture);
        let near_m = TOLERANCE_M..PRESSED_M;
        let next = relaxed(&self.task(state), &angles, &posture, near_m, PUSH_RAD)?;
        if next != angles {
            let there = self.posture(state, &next);
            // A limit on the way may have bent it toward a plane.
            if deepest_m(&self.goals, &there) <= PRESSED_M {
                (angles, posture) = (next, there);
            }
        }
        let missed_m = deepest_m(&self.goals, &posture);
        Some((angles, posture, missed_m))
    }

    /// What contact did to the chain in the last frame, if anything.
    fn pressed<'s>(&self, state: &'s State) -> Option<Pressed<'s>> {
        let by = &state.joints.pressed[joints_of(state, self.limb.chain)];
        let most = by.iter().fold(0.0, |most, p| math::max(p.abs(), most));
        if most == 0.0 {
            return None;
        }
        let mut pressed = Pressed {
            by,
            part_max: 1.0 + math::min(PRESSED_MORE_RAD / most, 1.0),
            all: Posture::new(),
        };
        pressed.all = self.posture(state, &self.pressed_by(state, &pressed, 1.0));
        Some(pressed)
    }

    /// What a height with such slopes gains by each whole part more, in metres. Joints at their limits go no farther.
    fn gain_m(&self, state: &State, pressed: &Pressed, row: &Row) -> f32 {
        let hinges = &state.joints.hinge[joints_of(state, self.limb.chain)];
        let ends = self.wanted.iter().zip(pressed.by).zip(hinges);
        let gains = ends.zip(row).map(|(((wanted, by), hinge), slope)| {
            let angle = wanted + by;
            if hinge.low_rad < angle && angle < hinge.high_rad {
                slope * by
            } else {
                0.0
            }
        });
        gains.sum()
    }

    /// The wanted angles with a part of it, within the limits.
    fn pressed_by(&self, state: &State, pressed: &Pressed, part: f32) -> Angles {
        let angles = self.wanted.iter().zip(pressed.by);
        let angles: Angles = angles.map(|(wanted, p)| wanted + part * p).collect();
        self.task(state).start(&angles)
    }

    /// The lowest of the hard goals over its plane, and its height there in metres.
    fn lowest(&self, posture: &Posture) -> (usize, f32) {
        let hard = self.goals.iter().enumerate().skip(self.soft);
        hard.fold((usize::MAX, f32::INFINITY), |lowest, (index, goal)| {
            let above_m = goal.above_m(posture);
            if above_m < lowest.1 {
                (index, above_m)
            } else {
                lowest
            }
        })
    }
}
