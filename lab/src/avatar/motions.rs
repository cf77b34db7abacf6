//! The motions of Schmidl and Lin 2004 as scripts: what a tracker would want, with nothing in the way.
//!
//! All are for [`AvatarPlan::new`] with [`MOTION_HEIGHT_M`] and [`Trunk::Rigid`], at [`RATE_HZ`]. Targets
//! are pure functions of the frame and lie within all limits; no joint turns faster than
//! [`JOINT_SPEED_MAX`]. Every motion starts free of the obstacles and goes 50 to 200 mm into them.
//!
//! [`AvatarPlan::new`]: super::AvatarPlan::new
//! [`Trunk::Rigid`]: super::Trunk::Rigid

use palpable::math::Pose;

use super::Target;
use super::track::{Arm, HANGING, Leg, STANDING, STANDING_HIP_M, Track, arm};

pub use super::slaps::{ArmSlap, SLAP_COUNT, slaps};
pub use super::track::MOTION_HEIGHT_M;

/// Frames a second.
pub const RATE_HZ: f32 = 90.0;

/// No scripted joint turns faster, in rad/s.
pub const JOINT_SPEED_MAX: f32 = 3.0;

/// A fixed box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Of the box's middle.
    pub pose: Pose,
    /// Half extents in metres.
    pub half_m: [f32; 3],
}

impl Obstacle {
    const fn at(centre_m: [f32; 3], half_m: [f32; 3]) -> Self {
        let [x, y, z] = centre_m;
        Self {
            pose: Pose::at(x, y, z),
            half_m,
        }
    }
}

/// What a motion is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionKind {
    /// Walks up to a box at chest height and touches it with both hands; 450 frames.
    TouchBox,
    /// Pushes a wall with both arms, three times; 2001 frames.
    PushWall,
    /// Sweeps the right arm through the corner of two walls; 600 frames.
    Corner,
    /// Crosses the left arm into the right one; 400 frames, no obstacles.
    CrossArms,
    /// Sits at a table, raises the thighs against its underside and lets the arms come down on it; 600
    /// frames.
    Table,
}

impl MotionKind {
    /// All motions.
    pub const ALL: [Self; 5] = [
        Self::TouchBox,
        Self::PushWall,
        Self::Corner,
        Self::CrossArms,
        Self::Table,
    ];
}

/// A scripted motion and the boxes of its scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// Which one.
    pub kind: MotionKind,
    /// Number of frames; the first is frame 0.
    pub frames: u32,
    /// Fixed boxes.
    pub obstacles: Vec<Obstacle>,
    root: Track<3>,
    arms: [Track<7>; 2],
    legs: [Track<6>; 2],
}

impl Script {
    /// The script of a motion.
    #[must_use]
    pub fn new(kind: MotionKind) -> Self {
        match kind {
            MotionKind::TouchBox => touch_box(),
            MotionKind::PushWall => push_wall(),
            MotionKind::Corner => corner(),
            MotionKind::CrossArms => cross_arms(),
            MotionKind::Table => table(),
        }
    }

    /// Root and angles at a frame; after the last one the motion stays.
    #[must_use]
    pub fn target(&self, frame: u32) -> Target {
        let [x, y, z] = self.root.at(frame);
        let mut angles = vec![vec![0.0; 3]];
        angles.extend(self.arms.iter().map(|arm| arm.at(frame).to_vec()));
        angles.extend(self.legs.iter().map(|leg| leg.at(frame).to_vec()));
        Target {
            root: Pose::at(x, y, z),
            angles,
        }
    }
}

/// Both arms by the same keys.
fn both_arms(keys: &[(u32, Arm)]) -> [Track<7>; 2] {
    [true, false].map(|is_left| arm_track(keys, is_left))
}

fn arm_track(keys: &[(u32, Arm)], is_left: bool) -> Track<7> {
    let keys: Vec<_> = keys
        .iter()
        .map(|(frame, arm)| (*frame, arm.angles(is_left)))
        .collect();
    Track::new(&keys)
}

fn leg_track(keys: &[(u32, Leg)]) -> Track<6> {
    let keys: Vec<_> = keys
        .iter()
        .map(|(frame, leg)| (*frame, leg.angles()))
        .collect();
    Track::new(&keys)
}

fn standing() -> [Track<6>; 2] {
    [leg_track(&[(0, STANDING)]), leg_track(&[(0, STANDING)])]
}

fn touch_box() -> Script {
    let step = |flexion, knee| Leg { flexion, knee };
    let stride = |first: bool| {
        let mut keys = vec![(0, STANDING)];
        for count in 0..5_u32 {
            let forward = (count % 2 == 0) == first;
            let leg = if forward {
                step(20.0, 25.0)
            } else {
                step(-18.0, 5.0)
            };
            keys.push((45 * (count + 1), leg));
        }
        keys.push((270, STANDING));
        leg_track(&keys)
    };
    let reach = arm(90.0, -10.0, 10.0);
    Script {
        kind: MotionKind::TouchBox,
        frames: 450,
        obstacles: vec![Obstacle::at([0.0, 1.25, -2.05], [0.45, 0.2, 0.2])],
        root: Track::new(&[
            (0, [0.0, STANDING_HIP_M, 0.0]),
            (270, [0.0, STANDING_HIP_M, -1.2]),
            (390, [0.0, STANDING_HIP_M, -1.2]),
            (449, [0.0, STANDING_HIP_M, -1.0]),
        ]),
        arms: both_arms(&[(0, HANGING), (180, HANGING), (300, reach)]),
        legs: [stride(true), stride(false)],
    }
}

fn push_wall() -> Script {
    let drawn = Arm {
        twist: 20.0,
        ..arm(90.0, -60.0, 100.0)
    };
    let pushed = Arm {
        twist: 40.0,
        ..arm(90.0, 0.0, 5.0)
    };
    let mut keys = vec![(0, drawn)];
    for push in 0..3 {
        let start = 100 + 600 * push;
        keys.extend([
            (start, drawn),
            (start + 200, pushed),
            (start + 300, pushed),
            (start + 500, drawn),
        ]);
    }
    Script {
        kind: MotionKind::PushWall,
        frames: 2001,
        obstacles: vec![Obstacle::at([0.0, 1.25, -0.87], [1.5, 1.25, 0.25])],
        root: Track::still([0.0, STANDING_HIP_M, 0.0]),
        arms: both_arms(&keys),
        legs: standing(),
    }
}

fn corner() -> Script {
    let right = arm_track(
        &[
            (0, HANGING),
            (30, HANGING),
            (180, arm(46.0, 0.0, 5.0)),
            (300, arm(53.0, 0.0, 5.0)),
            (460, arm(39.0, 0.0, 5.0)),
            (599, arm(46.0, -20.0, 5.0)),
        ],
        false,
    );
    Script {
        kind: MotionKind::Corner,
        frames: 600,
        obstacles: vec![
            Obstacle::at([0.0, 1.25, -0.70], [2.0, 1.25, 0.25]),
            Obstacle::at([0.90, 1.25, 0.0], [0.25, 1.25, 2.0]),
        ],
        root: Track::still([0.0, STANDING_HIP_M, 0.0]),
        arms: [arm_track(&[(0, HANGING)], true), right],
        legs: standing(),
    }
}

fn cross_arms() -> Script {
    let held = arm(112.0, -15.0, 0.0);
    let right = arm_track(&[(0, HANGING), (100, held)], false);
    let left = arm_track(
        &[
            (0, HANGING),
            (100, arm(0.0, -15.0, 0.0)),
            (280, arm(122.0, -15.0, 0.0)),
            (320, arm(122.0, -15.0, 0.0)),
            (399, arm(60.0, -15.0, 0.0)),
        ],
        true,
    );
    Script {
        kind: MotionKind::CrossArms,
        frames: 400,
        obstacles: Vec::new(),
        root: Track::still([0.0, STANDING_HIP_M, 0.0]),
        arms: [left, right],
        legs: standing(),
    }
}

fn table() -> Script {
    let seated = Leg {
        flexion: 90.0,
        knee: 90.0,
    };
    let raised = Leg {
        flexion: 112.0,
        knee: 100.0,
    };
    let above = arm(90.0, 10.0, 20.0);
    let down = arm(90.0, -35.0, 10.0);
    let leg = leg_track(&[
        (0, seated),
        (60, seated),
        (180, raised),
        (260, raised),
        (360, seated),
    ]);
    Script {
        kind: MotionKind::Table,
        frames: 600,
        obstacles: vec![Obstacle::at([0.0, 0.76, -0.65], [0.7, 0.03, 0.4])],
        root: Track::still([0.0, 0.55, 0.0]),
        arms: both_arms(&[
            (0, above),
            (300, above),
            (450, down),
            (520, down),
            (599, above),
        ]),
        legs: [leg.clone(), leg],
    }
}
