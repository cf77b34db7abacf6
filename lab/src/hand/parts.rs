//! Which triangle belongs to which of the 18 parts.

use super::joints::{JOINT_COUNT, JOINT_NAMES};
use super::model::HandMesh;

/// Convex parts of a hand, as in Schmidl and Lin 2004.
pub const PART_COUNT: usize = 18;

/// Name of each part, the joint that drives it, and the further joints whose triangles it takes in.
///
/// The thumb has three moving bones and each finger three: 15 parts. The rest of the hand bends little: it is cut
/// into the palm's two halves, index with middle and ring with pinky, and the wrist.
/// A tip joint dominates no triangle of this model; its part is the distal phalanx.
pub(super) const PARTS: [(&str, &str, &[&str]); PART_COUNT] = [
    ("wrist", "wrist", &[]),
    (
        "palm, thumb side",
        "index-finger-metacarpal",
        &["middle-finger-metacarpal"],
    ),
    (
        "palm, pinky side",
        "ring-finger-metacarpal",
        &["pinky-finger-metacarpal"],
    ),
    ("thumb metacarpal", "thumb-metacarpal", &[]),
    ("thumb proximal", "thumb-phalanx-proximal", &[]),
    ("thumb distal", "thumb-phalanx-distal", &["thumb-tip"]),
    ("index proximal", "index-finger-phalanx-proximal", &[]),
    (
        "index intermediate",
        "index-finger-phalanx-intermediate",
        &[],
    ),
    (
        "index distal",
        "index-finger-phalanx-distal",
        &["index-finger-tip"],
    ),
    ("middle proximal", "middle-finger-phalanx-proximal", &[]),
    (
        "middle intermediate",
        "middle-finger-phalanx-intermediate",
        &[],
    ),
    (
        "middle distal",
        "middle-finger-phalanx-distal",
        &["middle-finger-tip"],
    ),
    ("ring proximal", "ring-finger-phalanx-proximal", &[]),
    ("ring intermediate", "ring-finger-phalanx-intermediate", &[]),
    (
        "ring distal",
        "ring-finger-phalanx-distal",
        &["ring-finger-tip"],
    ),
    ("pinky proximal", "pinky-finger-phalanx-proximal", &[]),
    (
        "pinky intermediate",
        "pinky-finger-phalanx-intermediate",
        &[],
    ),
    (
        "pinky distal",
        "pinky-finger-phalanx-distal",
        &["pinky-finger-tip"],
    ),
];

/// The part of each triangle: that of the joint with the largest sum of weights over the three vertices, the lower
/// joint on a tie.
pub(super) fn part_of_triangles(mesh: &HandMesh) -> Vec<usize> {
    mesh.triangles
        .iter()
        .map(|triangle| part_of_joint(dominating_joint(mesh, *triangle)))
        .collect()
}

fn dominating_joint(mesh: &HandMesh, triangle: [usize; 3]) -> usize {
    let mut sum = [0.0; JOINT_COUNT];
    for (joint, weight) in triangle.into_iter().flat_map(|vertex| mesh.skin[vertex]) {
        sum[joint] += weight;
    }
    (0..JOINT_COUNT).fold(
        0,
        |best, joint| if sum[joint] > sum[best] { joint } else { best },
    )
}

fn part_of_joint(joint: usize) -> usize {
    let name = JOINT_NAMES[joint];
    PARTS
        .iter()
        .position(|(_, driver, more)| *driver == name || more.contains(&name))
        .expect("every model joint belongs to a part")
}
