//! Joint order, names and parents of a tracked hand.

/// Joints of a hand in the order of `XrHandJointEXT`.
pub const JOINT_COUNT: usize = 26;

/// OpenXR index of the palm, which has no joint in the model or in WebXR.
pub const PALM: usize = 0;

/// OpenXR index of the wrist, the root of every other joint.
pub const WRIST: usize = 1;

const MIDDLE_METACARPAL: usize = 11;
const MIDDLE_PROXIMAL: usize = 12;

/// WebXR names in the order of `XrHandJointEXT`; the palm, which WebXR leaves out, is named `palm`.
pub const JOINT_NAMES: [&str; JOINT_COUNT] = [
    "palm",
    "wrist",
    "thumb-metacarpal",
    "thumb-phalanx-proximal",
    "thumb-phalanx-distal",
    "thumb-tip",
    "index-finger-metacarpal",
    "index-finger-phalanx-proximal",
    "index-finger-phalanx-intermediate",
    "index-finger-phalanx-distal",
    "index-finger-tip",
    "middle-finger-metacarpal",
    "middle-finger-phalanx-proximal",
    "middle-finger-phalanx-intermediate",
    "middle-finger-phalanx-distal",
    "middle-finger-tip",
    "ring-finger-metacarpal",
    "ring-finger-phalanx-proximal",
    "ring-finger-phalanx-intermediate",
    "ring-finger-phalanx-distal",
    "ring-finger-tip",
    "pinky-finger-metacarpal",
    "pinky-finger-phalanx-proximal",
    "pinky-finger-phalanx-intermediate",
    "pinky-finger-phalanx-distal",
    "pinky-finger-tip",
];

/// The OpenXR index of a WebXR joint name.
#[must_use]
pub fn joint_index(name: &str) -> Option<usize> {
    JOINT_NAMES.iter().position(|known| *known == name)
}

/// The next joint toward the wrist; `None` for the wrist itself. The palm hangs from the middle metacarpal.
#[must_use]
pub fn joint_parent(joint: usize) -> Option<usize> {
    match joint {
        WRIST => None,
        PALM => Some(MIDDLE_METACARPAL),
        _ if is_metacarpal(joint) => Some(WRIST),
        _ => Some(joint - 1),
    }
}

/// Whether the joint is the base of a finger's or of the thumb's chain.
pub(super) fn is_metacarpal(joint: usize) -> bool {
    JOINT_NAMES[joint].ends_with("metacarpal")
}

/// Whether the joint is one of the four metacarpals inside the palm, which the recorded poses do not bend.
pub(super) fn is_palm_bone(joint: usize) -> bool {
    JOINT_NAMES[joint].ends_with("finger-metacarpal")
}

/// The two joints whose midpoint OpenXR calls the palm.
pub(super) const PALM_ENDS: [usize; 2] = [MIDDLE_METACARPAL, MIDDLE_PROXIMAL];
