//! The skinned mesh of `assets/hand/generic_hand_right.glb`.

use glam::{DMat4, DQuat, DVec3, Mat4};

use super::HandError;
use super::joints::{JOINT_COUNT, WRIST, joint_index};

const GLB: &[u8] = include_bytes!("../../assets/hand/generic_hand_right.glb");

/// The skinned mesh in its bind pose.
#[derive(Clone, Debug)]
pub struct HandMesh {
    /// Metres, in the wrist's frame.
    pub positions: Vec<DVec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[usize; 3]>,
    /// Up to four OpenXR joints and their weights for each vertex; the weights sum to one.
    pub skin: Vec<[(usize, f64); 4]>,
}

/// Bind poses in the wrist's frame, in OpenXR order; the palm's entry is the identity.
pub(super) type BindPoses = [(DQuat, DVec3); JOINT_COUNT];

/// Reads the embedded model.
pub(super) fn read() -> Result<(HandMesh, BindPoses), HandError> {
    let gltf = gltf::Gltf::from_slice(GLB).map_err(|error| HandError::Model(error.to_string()))?;
    let blob = gltf
        .blob
        .as_deref()
        .ok_or_else(|| missing("binary chunk"))?;
    let skin = gltf.skins().next().ok_or_else(|| missing("skin"))?;
    let joints = joint_indices(&skin)?;
    let inverse_bind = inverse_binds(&skin, blob)?;
    let wrist = joints
        .iter()
        .position(|&joint| joint == WRIST)
        .ok_or_else(|| missing("wrist"))?;
    let to_wrist = inverse_bind[wrist];
    let primitive = gltf
        .meshes()
        .flat_map(|mesh| mesh.primitives())
        .next()
        .ok_or_else(|| missing("mesh"))?;
    let mesh = read_mesh(&primitive, blob, to_wrist, &joints)?;
    Ok((mesh, bind_poses(&joints, &inverse_bind, to_wrist)))
}

fn missing(what: &str) -> HandError {
    HandError::Model(format!("no {what}"))
}

fn joint_indices(skin: &gltf::Skin) -> Result<Vec<usize>, HandError> {
    skin.joints()
        .map(|node| {
            let name = node.name().unwrap_or_default();
            joint_index(name).ok_or_else(|| HandError::Joint(name.to_owned()))
        })
        .collect()
}

fn inverse_binds(skin: &gltf::Skin, blob: &[u8]) -> Result<Vec<DMat4>, HandError> {
    let matrices: Vec<DMat4> = skin
        .reader(|_| Some(blob))
        .read_inverse_bind_matrices()
        .ok_or_else(|| missing("inverse bind matrices"))?
        .map(|columns| Mat4::from_cols_array_2d(&columns).as_dmat4())
        .collect();
    if matrices.len() == JOINT_COUNT - 1 {
        Ok(matrices)
    } else {
        Err(HandError::Model(format!("{} joints", matrices.len())))
    }
}

fn bind_poses(joints: &[usize], inverse_bind: &[DMat4], to_wrist: DMat4) -> BindPoses {
    let mut bind = [(DQuat::IDENTITY, DVec3::ZERO); JOINT_COUNT];
    for (&joint, inverse) in joints.iter().zip(inverse_bind) {
        let (_, orientation, position) =
            (to_wrist * inverse.inverse()).to_scale_rotation_translation();
        bind[joint] = (orientation.normalize(), position);
    }
    bind
}

fn read_mesh(
    primitive: &gltf::Primitive,
    blob: &[u8],
    to_wrist: DMat4,
    joints: &[usize],
) -> Result<HandMesh, HandError> {
    let reader = primitive.reader(|_| Some(blob));
    let positions: Vec<DVec3> = reader
        .read_positions()
        .ok_or_else(|| missing("positions"))?
        .map(|position| to_wrist.transform_point3(DVec3::from(position.map(f64::from))))
        .collect();
    let indices: Vec<usize> = reader
        .read_indices()
        .ok_or_else(|| missing("indices"))?
        .into_u32()
        .map(|index| index as usize)
        .collect();
    let skin_joints = reader
        .read_joints(0)
        .ok_or_else(|| missing("skin joints"))?
        .into_u16();
    let weights = reader
        .read_weights(0)
        .ok_or_else(|| missing("skin weights"))?
        .into_f32();
    let skin = skin_joints
        .zip(weights)
        .map(|(indices, weights)| skin_entry(indices, weights, joints))
        .collect();
    let triangles = indices.as_chunks::<3>().0.to_vec();
    Ok(HandMesh {
        positions,
        triangles,
        skin,
    })
}

fn skin_entry(indices: [u16; 4], weights: [f32; 4], joints: &[usize]) -> [(usize, f64); 4] {
    let total: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
    std::array::from_fn(|slot| {
        (
            joints[usize::from(indices[slot])],
            f64::from(weights[slot]) / total,
        )
    })
}
