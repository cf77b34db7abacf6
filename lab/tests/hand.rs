//! What the hand promises to the scenes.

use std::sync::LazyLock;

use glam::{DQuat, DVec3};
use palpable_lab::hand::{
    Hand, HandPart, HandPose, JOINT_COUNT, JOINT_NAMES, JointPose, PALM, PART_COUNT,
    PART_VERTICES_MAX, WRIST, joint_index, joint_parent,
};

const GLB: &[u8] = include_bytes!("../assets/hand/generic_hand_right.glb");
const POSES: &str = include_str!("../assets/hand/poses.json");

static HAND: LazyLock<Hand> = LazyLock::new(|| Hand::load().expect("the embedded hand loads"));

fn joint(name: &str) -> usize {
    joint_index(name).expect("a WebXR joint name")
}

fn pose(pose: HandPose) -> [JointPose; JOINT_COUNT] {
    HAND.joints(pose, pose, 0.0)
}

fn pairs() -> impl Iterator<Item = (HandPose, HandPose)> {
    HandPose::ALL
        .into_iter()
        .flat_map(|from| HandPose::ALL.map(|to| (from, to)))
}

fn vertices(part: &HandPart) -> Vec<DVec3> {
    part.vertices
        .iter()
        .map(|vertex| DVec3::from(vertex.map(f64::from)))
        .collect()
}

/// Every plane through three vertices that has all others on one side, by trying all triples.
fn face_planes(vertices: &[DVec3]) -> Vec<(DVec3, f64)> {
    let mut planes = Vec::new();
    for (i, &a) in vertices.iter().enumerate() {
        for (j, &b) in vertices.iter().enumerate() {
            for &c in &vertices[j..] {
                let cross = (b - a).cross(c - a);
                if i == j || cross.length() < 1e-8 {
                    continue;
                }
                for normal in [cross.normalize(), -cross.normalize()] {
                    if vertices.iter().all(|&vertex| normal.dot(vertex - a) < 2e-8) {
                        planes.push((normal, normal.dot(a)));
                    }
                }
            }
        }
    }
    planes
}

#[test]
fn the_model_is_the_one_that_webxr_pages_show() {
    assert_eq!(HAND.mesh.triangles.len(), 2314);
    assert_eq!(HAND.mesh.positions.len(), 1360);
    let sums = HAND
        .mesh
        .skin
        .iter()
        .map(|skin| skin.iter().map(|(_, weight)| weight).sum::<f64>());
    assert!(sums.into_iter().all(|sum| (sum - 1.0).abs() < 1e-12));
}

#[test]
fn there_are_18_parts_of_4_to_32_vertices() {
    assert_eq!(HAND.parts.len(), 18);
    assert_eq!(PART_COUNT, 18);
    for part in &HAND.parts {
        assert!(
            (4..=PART_VERTICES_MAX).contains(&part.vertices.len()),
            "{}",
            part.name
        );
        assert!(
            part.vertices
                .iter()
                .flatten()
                .all(|coordinate| coordinate.is_finite())
        );
    }
}

#[test]
fn every_triangle_has_a_part_and_every_part_has_triangles() {
    assert_eq!(HAND.triangle_parts.len(), HAND.mesh.triangles.len());
    let count = |part| {
        HAND.triangle_parts
            .iter()
            .filter(|&&owner| owner == part)
            .count()
    };
    assert!((0..PART_COUNT).all(|part| count(part) >= 20));
}

#[test]
fn parts_are_driven_by_different_joints() {
    let mut joints: Vec<usize> = HAND.parts.iter().map(|part| part.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    assert_eq!(joints.len(), PART_COUNT);
}

#[test]
fn parts_contain_the_points_they_were_cut_from() {
    let bind = pose(HandPose::Flat);
    for (index, part) in HAND.parts.iter().enumerate() {
        let planes = face_planes(&vertices(part));
        assert!(planes.len() >= 4, "{}", part.name);
        let frame = bind[part.joint];
        for point in HAND.part_points(index) {
            let local = frame.orientation.inverse() * (point - frame.position);
            let excess = planes
                .iter()
                .map(|(normal, offset)| normal.dot(local) - offset);
            let excess = excess.fold(f64::NEG_INFINITY, f64::max);
            assert!(excess <= 1e-6, "{}: {excess}", part.name);
        }
    }
}

#[test]
fn no_part_is_thin() {
    for part in &HAND.parts {
        let vertices = vertices(part);
        let width = |normal: DVec3| {
            let along = vertices.iter().map(|vertex| normal.dot(*vertex));
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        let thinnest = face_planes(&vertices)
            .into_iter()
            .map(|(normal, _)| width(normal));
        assert!(
            thinnest.fold(f64::INFINITY, f64::min) > 0.008,
            "{}",
            part.name
        );
    }
}

#[test]
fn the_flat_pose_is_the_model_s_bind_pose() {
    let gltf = gltf::Gltf::from_slice(GLB).unwrap();
    let placed = |name: &str| {
        let node = gltf.nodes().find(|node| node.name() == Some(name)).unwrap();
        let (position, orientation, _) = node.transform().decomposed();
        (
            DQuat::from_array(orientation.map(f64::from)),
            DVec3::from(position.map(f64::from)),
        )
    };
    let (wrist_orientation, wrist) = placed("wrist");
    let flat = pose(HandPose::Flat);
    for joint in WRIST..JOINT_COUNT {
        let (orientation, position) = placed(JOINT_NAMES[joint]);
        let position = wrist_orientation.inverse() * (position - wrist);
        let orientation = wrist_orientation.inverse() * orientation;
        assert!(
            flat[joint].position.distance(position) < 1e-5,
            "{}",
            JOINT_NAMES[joint]
        );
        assert!(
            flat[joint].orientation.dot(orientation).abs() > 1.0 - 1e-6,
            "{}",
            JOINT_NAMES[joint]
        );
    }
}

#[test]
fn the_axes_are_those_of_openxr() {
    let flat = pose(HandPose::Flat);
    for finger in ["index", "middle", "ring", "pinky"] {
        let [base, tip] =
            ["phalanx-proximal", "tip"].map(|bone| flat[joint(&format!("{finger}-finger-{bone}"))]);
        assert!(
            (tip.position - base.position).normalize().z < -0.9,
            "{finger}"
        );
        assert!((base.orientation * DVec3::Y).y > 0.9, "{finger}");
    }
    assert!(flat[joint("thumb-tip")].position.x < -0.05);
    assert!(flat[joint("pinky-finger-tip")].position.x > 0.03);
    let fist = pose(HandPose::Point);
    assert!(fist[joint("middle-finger-phalanx-intermediate")].position.y < -0.02);
}

#[test]
fn the_palm_lies_between_the_ends_of_the_middle_metacarpal() {
    for hand_pose in HandPose::ALL {
        let joints = pose(hand_pose);
        let [near, far] = ["metacarpal", "phalanx-proximal"]
            .map(|bone| joints[joint(&format!("middle-finger-{bone}"))]);
        let middle = near.position.midpoint(far.position);
        assert!(joints[PALM].position.distance(middle) < 1e-9);
        assert!(joints[PALM].orientation.abs_diff_eq(near.orientation, 1e-9));
    }
}

#[test]
fn phalanges_have_the_recorded_orientations() {
    let file: serde_json::Value = serde_json::from_str(POSES).unwrap();
    let named = [
        ("relaxed", HandPose::Relaxed),
        ("pinch", HandPose::Pinch),
        ("point", HandPose::Point),
    ];
    for (name, hand_pose) in named {
        let joints = pose(hand_pose);
        for entry in file["poses"][name].as_array().unwrap() {
            let joint_name = entry["joint"].as_str().unwrap();
            let recorded: [f64; 4] = serde_json::from_value(entry["orientation"].clone()).unwrap();
            let cosine = joints[joint(joint_name)]
                .orientation
                .dot(DQuat::from_array(recorded).normalize())
                .abs();
            let palm_bone = joint_name.ends_with("finger-metacarpal");
            assert!(palm_bone || cosine > 1.0 - 1e-9, "{name} {joint_name}");
        }
    }
}

#[test]
fn a_pinch_brings_thumb_and_index_together() {
    let apart = |hand_pose| {
        let joints = pose(hand_pose);
        joints[joint("thumb-tip")]
            .position
            .distance(joints[joint("index-finger-tip")].position)
    };
    assert!(apart(HandPose::Flat) > 0.08);
    assert!(apart(HandPose::Pinch) < 0.016);
    assert!(apart(HandPose::Pinch) < apart(HandPose::Relaxed) / 4.0);
}

#[test]
fn bones_keep_their_lengths() {
    let flat = pose(HandPose::Flat);
    for (from, to) in pairs() {
        let joints = HAND.joints(from, to, 0.37);
        for child in WRIST + 1..JOINT_COUNT {
            let parent = joint_parent(child).unwrap();
            let length =
                |joints: &[JointPose]| joints[child].position.distance(joints[parent].position);
            assert!(
                (length(&joints) - length(&flat)).abs() < 1e-12,
                "{}",
                JOINT_NAMES[child]
            );
        }
    }
}

#[test]
fn blends_have_no_jumps() {
    for (from, to) in pairs() {
        for percent in 0..100 {
            let here = HAND.joints(from, to, f64::from(percent) / 100.0);
            let next = HAND.joints(from, to, f64::from(percent + 1) / 100.0);
            for (a, b) in here.iter().zip(&next) {
                assert!(
                    a.position.distance(b.position) < 0.002,
                    "{from:?} {to:?} {percent} %"
                );
                assert!(a.orientation.angle_between(b.orientation) < 0.04);
                assert!(a.orientation.is_normalized());
            }
        }
    }
}

#[test]
fn a_blend_moves_all_the_way() {
    for (from, to) in pairs().filter(|(from, to)| from != to) {
        let tip = joint("middle-finger-tip");
        let half = HAND.joints(from, to, 0.5)[tip].position;
        let travel = pose(from)[tip].position.distance(pose(to)[tip].position);
        assert!(half.distance(pose(from)[tip].position) > 0.2 * travel);
        assert!(half.distance(pose(to)[tip].position) > 0.2 * travel);
    }
}

#[test]
fn blends_end_at_the_poses_to_the_bit() {
    for (from, to) in pairs() {
        assert_eq!(HAND.joints(from, to, 0.0), pose(from));
        assert_eq!(HAND.joints(from, to, 1.0), pose(to));
        assert_eq!(HAND.joints(from, to, -3.0), pose(from));
        assert_eq!(HAND.joints(from, to, f64::INFINITY), pose(to));
        assert_eq!(HAND.joints(from, to, f64::NAN), pose(from));
    }
}

#[test]
fn parts_follow_their_joints() {
    let joints = HAND.joints(HandPose::Flat, HandPose::Point, 0.6);
    let parts = HAND.blend(HandPose::Flat, HandPose::Point, 0.6);
    assert_eq!(parts.len(), PART_COUNT);
    for (part, placed) in HAND.parts.iter().zip(&parts) {
        assert_eq!(placed.position, joints[part.joint].position);
        assert_eq!(placed.orientation, joints[part.joint].orientation);
    }
}

#[test]
fn the_mesh_in_the_flat_pose_is_the_mesh() {
    let skinned = HAND.skinned(&pose(HandPose::Flat));
    let moved = skinned
        .iter()
        .zip(&HAND.mesh.positions)
        .map(|(a, b)| a.distance(*b));
    assert!(moved.fold(0.0, f64::max) < 1e-9);
}

#[test]
fn the_parts_cover_the_mesh_and_little_else() {
    let coverage = HAND.coverage(0.004).unwrap();
    assert_eq!(coverage.uncovered_share, 0.0, "{coverage}");
    assert!(coverage.missed_share < 0.005, "{coverage}");
    assert!(coverage.phantom_share < 0.15, "{coverage}");
    assert!(coverage.outside_m_mean < 0.0015, "{coverage}");
    assert!(coverage.outside_m_max < 0.012, "{coverage}");
}
