//! The recorded poses of `assets/hand/poses.json`.

use std::collections::BTreeMap;

use glam::DQuat;
use serde::Deserialize;

use super::HandError;
use super::joints::{JOINT_COUNT, joint_index};

const TEXT: &str = include_str!("../../assets/hand/poses.json");

#[derive(Deserialize)]
struct PoseFile {
    poses: BTreeMap<String, Vec<RecordedJoint>>,
}

#[derive(Deserialize)]
struct RecordedJoint {
    joint: String,
    orientation: [f64; 4],
    radius: f64,
}

/// One recorded pose: orientations in the wrist's frame and radii in metres, in OpenXR order.
pub(super) struct Recorded {
    pub(super) orientation: [DQuat; JOINT_COUNT],
    pub(super) radius_m: [f64; JOINT_COUNT],
}

/// All recorded poses by name.
pub(super) fn read() -> Result<BTreeMap<String, Recorded>, HandError> {
    let file: PoseFile =
        serde_json::from_str(TEXT).map_err(|error| HandError::Poses(error.to_string()))?;
    file.poses
        .into_iter()
        .map(|(name, joints)| Ok((name, recorded(&joints)?)))
        .collect()
}

fn recorded(joints: &[RecordedJoint]) -> Result<Recorded, HandError> {
    if joints.len() != JOINT_COUNT - 1 {
        return Err(HandError::Poses(format!("{} joints", joints.len())));
    }
    let mut pose = Recorded {
        orientation: [DQuat::IDENTITY; JOINT_COUNT],
        radius_m: [0.0; JOINT_COUNT],
    };
    for entry in joints {
        let joint =
            joint_index(&entry.joint).ok_or_else(|| HandError::Joint(entry.joint.clone()))?;
        pose.orientation[joint] = DQuat::from_array(entry.orientation).normalize();
        pose.radius_m[joint] = entry.radius;
    }
    Ok(pose)
}
