//! The avatar: its triangles, its pieces in the neutral posture, and its motions.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use palpable::geometry::chain::Posture;
use palpable::human::Limb;
use palpable::math::Pose;
use palpable_lab::avatar::bvh::{self, Fault};
use palpable_lab::avatar::motions::{
    JOINT_SPEED_MAX, MOTION_HEIGHT_M, MotionKind, Obstacle, RATE_HZ, SLAP_COUNT, Script, slaps,
};
use palpable_lab::avatar::{AvatarPlan, PIECE_COUNT, Style, Target, Trunk, VERTICES_A_PIECE};
use palpable_lab::hand::{ArticulatedHand, FingerAngles, FingerLink, Hand, HandPose};
use palpable_lab::reference::Solid;
use parry3d_f64::math::Vector;
use parry3d_f64::query;
use parry3d_f64::shape::SharedShape;

const HEIGHT_M: f32 = 1.75;

fn isometry(pose: &Pose) -> parry3d_f64::math::Pose {
    let q = pose.rotation.map(f64::from);
    parry3d_f64::math::Pose::from_parts(
        Vector::from_array(pose.position.map(f64::from)),
        parry3d_f64::math::Rotation::from_array(q).normalize(),
    )
}

fn shape(points: &[[f32; 3]], radius: f32) -> SharedShape {
    let points: Vec<Vector> = points
        .iter()
        .map(|p| Vector::from_array(p.map(f64::from)))
        .collect();
    match points[..] {
        [a, b] => SharedShape::capsule(a, b, f64::from(radius)),
        _ => SharedShape::convex_hull(&points).expect("a hull"),
    }
}

/// Shapes of all pieces.
fn shapes(plan: &AvatarPlan) -> Vec<SharedShape> {
    plan.pieces
        .iter()
        .map(|piece| shape(&piece.points, piece.radius_m))
        .collect()
}

/// Signed distance of two shapes at poses, in metres; 0.1 when they are farther apart.
fn gap_m(a: &SharedShape, at: &Pose, b: &SharedShape, bt: &Pose) -> f64 {
    query::contact(&isometry(at), &**a, &isometry(bt), &**b, 0.1)
        .expect("a supported pair")
        .map_or(0.1, |contact| contact.dist)
}

#[test]
fn about_3600_triangles_and_every_vertex_counts() {
    for trunk in [Trunk::Rigid, Trunk::Bending] {
        let plan = AvatarPlan::new(HEIGHT_M, Style::Hulls, trunk);
        assert_eq!(plan.pieces.len(), PIECE_COUNT);
        let mut faces = 0;
        for piece in &plan.pieces {
            let solid = Solid::from_f32(&piece.points, 0.0).unwrap();
            assert_eq!(solid.vertices().len(), VERTICES_A_PIECE, "{}", piece.name);
            assert_eq!(solid.triangles().len(), piece.triangles(), "{}", piece.name);
            faces += solid.triangles().len();
        }
        assert_eq!(plan.triangles(), faces);
        println!("{} pieces, {faces} triangles", plan.pieces.len());
        assert!((3400..3800).contains(&faces), "{faces}");
        assert_eq!(plan.chains.len(), if trunk == Trunk::Rigid { 5 } else { 6 });
    }
}

#[test]
fn only_neighbours_overlap_in_the_neutral_posture() {
    for style in [Style::Hulls, Style::Capsules] {
        for height in [1.5, HEIGHT_M, 1.95] {
            let plan = AvatarPlan::new(height, style, Trunk::Bending);
            let (shapes, at) = (shapes(&plan), plan.piece_poses(&plan.neutral()));
            let mut least = (f64::INFINITY, String::new());
            for a in 0..shapes.len() {
                for b in (0..a).filter(|&b| !plan.are_neighbours(a, b)) {
                    let gap = gap_m(&shapes[a], &at[a], &shapes[b], &at[b]);
                    if gap < least.0 {
                        least = (
                            gap,
                            format!("{}, {}", plan.pieces[a].name, plan.pieces[b].name),
                        );
                    }
                }
            }
            println!("{style:?} {height}: {least:?}");
            assert!(least.0 > 0.002, "{style:?} {height}: {least:?}");
        }
    }
}

#[test]
fn a_rigid_trunk_stands_as_a_bending_one() {
    let [rigid, bending] =
        [Trunk::Rigid, Trunk::Bending].map(|trunk| AvatarPlan::new(HEIGHT_M, Style::Hulls, trunk));
    let poses = |plan: &AvatarPlan| plan.piece_poses(&plan.neutral());
    for ((a, b), piece) in poses(&rigid).iter().zip(poses(&bending)).zip(&rigid.pieces) {
        let apart = (a.translation() - b.translation()).length();
        assert!(apart < 1e-6, "{}: {apart}", piece.name);
    }
}

#[test]
fn the_pieces_fill_the_height_and_are_mirror_images() {
    for style in [Style::Hulls, Style::Capsules] {
        let plan = AvatarPlan::new(HEIGHT_M, style, Trunk::Rigid);
        let at = plan.piece_poses(&plan.neutral());
        let mut bounds: BTreeMap<&str, [f32; 4]> = BTreeMap::new();
        for (piece, pose) in plan.pieces.iter().zip(&at) {
            for &point in &piece.points {
                let p = pose.point(point.into());
                let entry =
                    bounds
                        .entry(&piece.name)
                        .or_insert([f32::MAX, f32::MIN, f32::MAX, f32::MIN]);
                entry[0] = entry[0].min(p.y - piece.radius_m);
                entry[1] = entry[1].max(p.y + piece.radius_m);
                entry[2] = entry[2].min(p.x);
                entry[3] = entry[3].max(p.x);
            }
        }
        let low = bounds.values().map(|b| b[0]).fold(f32::MAX, f32::min);
        let high = bounds.values().map(|b| b[1]).fold(f32::MIN, f32::max);
        assert!(
            low.abs() < 0.01 && (high - HEIGHT_M).abs() < 0.001,
            "{low} {high}"
        );
        for (name, b) in &bounds {
            if let Some(part) = name.strip_prefix("left ") {
                let other = bounds[format!("right {part}").as_str()];
                let mirrored = [other[0], other[1], -other[3], -other[2]];
                for (x, y) in b.iter().zip(mirrored) {
                    assert!((x - y).abs() < 1e-5, "{name}");
                }
            }
        }
    }
}

/// Deepest overlap with the obstacles and of the left arm with the right one, in metres.
fn deepest_m(plan: &AvatarPlan, shapes: &[SharedShape], at: &Target, boxes: &[Obstacle]) -> f64 {
    let poses = plan.piece_poses(at);
    let mut deepest = 0.0_f64;
    for (a, pose) in shapes.iter().zip(&poses) {
        for obstacle in boxes {
            let [x, y, z] = obstacle.half_m.map(f64::from);
            let cuboid = SharedShape::cuboid(x, y, z);
            deepest = deepest.max(-gap_m(a, pose, &cuboid, &obstacle.pose));
        }
    }
    let arm = |side: &str| -> Vec<usize> {
        let parts = ["upper arm", "forearm", "hand", "thumb"].map(|part| format!("{side} {part}"));
        let pieces = plan.pieces.iter().enumerate();
        pieces
            .filter(|(_, piece)| parts.contains(&piece.name))
            .map(|(index, _)| index)
            .collect()
    };
    for a in arm("left") {
        for b in arm("right") {
            deepest = deepest.max(-gap_m(&shapes[a], &poses[a], &shapes[b], &poses[b]));
        }
    }
    deepest
}

#[test]
fn motions_start_free_and_go_deep() {
    for style in [Style::Hulls, Style::Capsules] {
        let plan = AvatarPlan::new(MOTION_HEIGHT_M, style, Trunk::Rigid);
        let shapes = shapes(&plan);
        for kind in MotionKind::ALL {
            let script = Script::new(kind);
            let depth = |frame| deepest_m(&plan, &shapes, &script.target(frame), &script.obstacles);
            assert_eq!(depth(0), 0.0, "{kind:?} starts free");
            let deep = (0..script.frames)
                .step_by(5)
                .map(|frame| (depth(frame), frame))
                .fold(
                    (0.0, 0),
                    |best, next| if next.0 > best.0 { next } else { best },
                );
            println!(
                "{style:?} {kind:?}: {:.1} mm in frame {}",
                1e3 * deep.0,
                deep.1
            );
            assert!(
                (0.05..0.2).contains(&deep.0),
                "{kind:?} {style:?}: {deep:?}"
            );
        }
    }
}

#[test]
fn motions_are_smooth_within_limits_and_as_long_as_they_say() {
    let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Capsules, Trunk::Rigid);
    for kind in MotionKind::ALL {
        let script = Script::new(kind);
        let (mut fastest, mut root_fastest) = (0.0_f32, 0.0_f32);
        for frame in 0..script.frames {
            let target = script.target(frame);
            let (_, clamped) = plan.kept(&target);
            assert_eq!(clamped, 0, "{kind:?} frame {frame}");
            let next = script.target(frame + 1);
            for (a, b) in target.angles.iter().zip(&next.angles) {
                for (a, b) in a.iter().zip(b) {
                    fastest = fastest.max((b - a).abs() * RATE_HZ);
                }
            }
            let moved = next.root.translation() - target.root.translation();
            root_fastest = root_fastest.max(moved.length() * RATE_HZ);
        }
        println!("{kind:?}: {fastest:.2} rad/s, root {root_fastest:.2} m/s");
        assert!(fastest <= JOINT_SPEED_MAX, "{kind:?}: {fastest}");
        assert!(root_fastest < 1.5);
        assert_eq!(
            script.target(script.frames + 7),
            script.target(script.frames - 1)
        );
    }
    assert_eq!(Script::new(MotionKind::PushWall).frames, 2001);
}

#[test]
fn the_wall_is_pushed_three_times() {
    let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
    let shapes = shapes(&plan);
    let script = Script::new(MotionKind::PushWall);
    let touching: Vec<bool> = (0..script.frames)
        .step_by(20)
        .map(|frame| deepest_m(&plan, &shapes, &script.target(frame), &script.obstacles) > 0.0)
        .collect();
    let pushes = touching.windows(2).filter(|pair| !pair[0] && pair[1]);
    assert_eq!(pushes.count(), 3);
}

#[test]
fn slaps_start_before_their_plate_and_end_behind_it() {
    let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
    let shapes = shapes(&plan);
    let all = slaps(1);
    assert_eq!(all.len(), SLAP_COUNT);
    assert_eq!(all, slaps(1));
    let hand = |name: &str| plan.pieces.iter().position(|p| p.name == name).unwrap();
    let hand = hand("right hand");
    let (mut slowest, mut fastest, mut through) = (f32::MAX, 0.0_f32, 0);
    for slap in &all {
        let boxes = [slap.plate];
        assert_eq!(slap.plate.half_m[0], 0.01);
        assert_eq!(deepest_m(&plan, &shapes, &slap.target(0), &boxes), 0.0);
        assert_eq!(slap.target(0), slap.target(5));
        let at = |frame| plan.piece_poses(&slap.target(frame))[hand].translation();
        let end =
            slap.plate.pose.quat().conjugate() * (at(slap.frames) - slap.plate.pose.translation());
        assert!(end.x > 0.05, "{}", end.x);
        let near = |time_s| {
            let target = slap.target_at(slap.meeting_s() + time_s);
            plan.piece_poses(&target)[hand].translation()
        };
        let (step_s, meets) = (5e-4, near(0.0) - slap.plate.pose.translation());
        let velocity = (near(step_s) - near(-step_s)) / (2.0 * step_s);
        let speed = slap.plate.pose.quat() * Vec3::X * slap.speed;
        assert!(meets.length() < 1e-3, "{meets}");
        assert!(
            (velocity - speed).length() < 0.01 * slap.speed,
            "{velocity} {speed}"
        );
        (slowest, fastest) = (slowest.min(slap.speed), fastest.max(slap.speed));
        let seen = (0..slap.frames)
            .any(|frame| deepest_m(&plan, &shapes, &slap.target(frame), &boxes) > 0.0);
        through += u32::from(!seen);
        for frame in 0..slap.frames {
            assert_eq!(plan.kept(&slap.target(frame)).1, 0);
        }
    }
    println!("{slowest:.1} to {fastest:.1} m/s, {through} never overlap in a frame");
    assert!(slowest < 6.0 && fastest > 19.0);
}

/// Largest distance of any part's vertex from where the rigid hand has it, in metres.
fn vertex_error_m(
    hand: &Hand,
    articulated: &ArticulatedHand,
    angles: &FingerAngles,
    pose: HandPose,
) -> f64 {
    let rigid = hand.blend(pose, pose, 0.0);
    let bent = articulated.part_poses(&Pose::IDENTITY, angles);
    let mut largest = 0.0_f64;
    for ((part, rigid), bent) in hand.parts.iter().zip(&rigid).zip(&bent) {
        for &vertex in &part.vertices {
            let there = rigid.position + rigid.orientation * DVec3::from(vertex.map(f64::from));
            let here = bent.point(vertex.into()).as_dvec3();
            largest = largest.max(here.distance(there));
        }
    }
    largest
}

#[test]
fn the_articulated_hand_rests_where_the_rigid_one_is() {
    let hand = Hand::load().unwrap();
    let articulated = ArticulatedHand::new(&hand);
    assert_eq!(articulated.parts.len(), hand.parts.len());
    let error_m = vertex_error_m(&hand, &articulated, &articulated.rest(), HandPose::Flat);
    println!("rest: {:.3e} m", error_m);
    assert!(error_m < 1e-6, "{error_m}");
    let on_root = articulated
        .parts
        .iter()
        .filter(|part| part.link == FingerLink::Root);
    assert_eq!(on_root.count(), 3);
    let hinges: Vec<usize> = articulated.rest().iter().map(Vec::len).collect();
    assert_eq!(hinges, [5, 4, 4, 4, 4]);
}

#[test]
fn recorded_poses_are_fitted_by_angles_within_limits() {
    let hand = Hand::load().unwrap();
    let articulated = ArticulatedHand::new(&hand);
    for (pose, max_mm) in [
        (HandPose::Flat, 0.001),
        (HandPose::Relaxed, 0.6),
        (HandPose::Pinch, 0.6),
        (HandPose::Point, 3.1),
    ] {
        let fit = articulated.fit(&hand.joints(pose, pose, 0.0));
        for (finger, angles) in fit.angles.iter().enumerate() {
            let joints = articulated.joints(finger);
            assert_eq!(palpable::human::kept(&joints, angles).clamped, 0);
            let shown: Vec<String> = angles
                .iter()
                .map(|a| format!("{:.0}", a.to_degrees()))
                .collect();
            let residual = fit.residual_m[finger].map(|m| format!("{:.2}", 1e3 * m));
            println!(
                "{pose:?} finger {finger}: {} deg, residual {} mm",
                shown.join(" "),
                residual.join(" ")
            );
        }
        let (median, max) = fit.median_and_max_m();
        let vertices = vertex_error_m(&hand, &articulated, &fit.angles, pose);
        println!(
            "{pose:?}: median {:.2} mm, max {:.2} mm; vertices max {:.2} mm",
            1e3 * median,
            1e3 * max,
            1e3 * vertices
        );
        assert!(1e3 * max < max_mm, "{pose:?}: {max}");
    }
}

#[test]
fn a_fist_closes_all_four_fingers() {
    let hand = Hand::load().unwrap();
    let articulated = ArticulatedHand::new(&hand);
    let fist = articulated.fist(&hand);
    let links = articulated.postures(&Pose::IDENTITY, &fist);
    let open = articulated.postures(&Pose::IDENTITY, &articulated.rest());
    for finger in 1..5 {
        let tip = |links: &[Posture; 5]| {
            links[finger]
                .last()
                .unwrap()
                .link
                .point(articulated.fingers[finger].tip)
        };
        assert_eq!(
            palpable::human::kept(&articulated.joints(finger), &fist[finger]).clamped,
            0
        );
        assert!(tip(&links).z > tip(&open).z + 0.05, "finger {finger}");
    }
}

#[test]
fn fits_find_the_angles_that_made_a_pose() {
    let hand = Hand::load().unwrap();
    let articulated = ArticulatedHand::new(&hand);
    let mut joints = hand.joints(HandPose::Flat, HandPose::Flat, 0.0);
    let made: FingerAngles = std::array::from_fn(|finger| {
        let hinges = articulated.fingers[finger].hinges.iter();
        hinges
            .map(|hinge| hinge.low_rad + 0.6 * (hinge.high_rad - hinge.low_rad))
            .collect()
    });
    let links = articulated.postures(&Pose::IDENTITY, &made);
    for (finger, first) in [2, 7, 12, 17, 22].into_iter().enumerate() {
        let def = &articulated.fingers[finger];
        for bone in 1..3 {
            let at = links[finger][def.bones[bone]].link.translation();
            joints[first + bone].position = at.as_dvec3();
        }
        let tip = links[finger].last().unwrap().link.point(def.tip);
        joints[first + 3].position = tip.as_dvec3();
    }
    let fit = articulated.fit(&joints);
    assert!(fit.median_and_max_m().1 < 1e-6);
    for (found, made) in fit.angles.iter().flatten().zip(made.iter().flatten()) {
        assert!((found - made).abs() < 1e-3, "{found} {made}");
    }
}

/// A small skeleton in centimetres that faces +Z, with a bone straight along each branch. One frame stands
/// with the arms sideways; the others are made by rotations.
const SMALL_BVH: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT LeftUpLeg
  {
    OFFSET 9 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT LeftLeg
    {
      OFFSET 0 -42 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT LeftFoot
      {
        OFFSET 0 -42 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        {
          OFFSET 0 -6 17.538462
        }
      }
    }
  }
  JOINT RightUpLeg
  {
    OFFSET -9 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT RightLeg
    {
      OFFSET 0 -42 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT RightFoot
      {
        OFFSET 0 -42 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        {
          OFFSET 0 -6 17.538462
        }
      }
    }
  }
  JOINT Neck
  {
    OFFSET 0 50 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT Head
    {
      OFFSET 0 10 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      End Site
      {
        OFFSET 0 20 0
      }
    }
  }
  JOINT LeftArm
  {
    OFFSET 20 50 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT LeftForeArm
    {
      OFFSET 30 0 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT LeftHand
      {
        OFFSET 25 0 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        {
          OFFSET 8 0 0
        }
      }
    }
  }
  JOINT RightArm
  {
    OFFSET -20 50 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT RightForeArm
    {
      OFFSET -30 0 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT RightHand
      {
        OFFSET -25 0 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        {
          OFFSET -8 0 0
        }
      }
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.0333333
";

/// The small file: arms sideways; arms hanging, the right elbow bent by a right angle forward; and the
/// right hip and knee bent by a right angle.
fn small_bvh() -> String {
    bent_bvh(90.0, 90.0)
}

/// The same with other bends of the elbow and the knee, in degrees.
fn bent_bvh(elbow: f64, knee: f64) -> String {
    let mut text = SMALL_BVH.to_owned();
    let channels = 6 + 14 * 3;
    let frame = |changes: &[(usize, f64)]| {
        let mut values = vec![0.0; channels];
        values[1] = 100.0;
        for &(channel, value) in changes {
            values[channel] = value;
        }
        let words: Vec<String> = values.iter().map(f64::to_string).collect();
        words.join(" ") + "\n"
    };
    // Joints after the root: legs 0 to 5, neck and head 6 and 7, left arm 8 to 10, right arm 11 to 13.
    let z = |joint: usize| 6 + 3 * joint;
    text += &frame(&[]);
    text += &frame(&[(z(8), -90.0), (z(11), 90.0), (z(12) + 2, elbow)]);
    text += &frame(&[
        (0, 50.0),
        (z(8), -90.0),
        (z(11), 90.0),
        (z(3) + 1, -90.0),
        (z(4) + 1, knee),
    ]);
    text
}

#[test]
fn a_small_motion_is_put_on_the_avatar() {
    let motion = bvh::parse(&small_bvh()).unwrap();
    assert_eq!((motion.frame_count(), motion.names().count()), (3, 15));
    for trunk in [Trunk::Rigid, Trunk::Bending] {
        let plan = AvatarPlan::new(HEIGHT_M, Style::Capsules, trunk);
        let frames = motion.frames(&plan).unwrap();
        let chain = |limb| plan.chain(limb).unwrap();
        for frame in &frames {
            assert_eq!(frame.clamped, 0, "{trunk:?}");
            assert_eq!(plan.kept(&frame.target).1, 0);
        }
        let root = frames[0].target.root;
        assert!(
            (root.translation() - Vec3::Y * 0.53 * HEIGHT_M).length() < 1e-5,
            "{root:?}"
        );
        assert!(
            (root.quat() * Vec3::NEG_Z - Vec3::Z).length() < 1e-5,
            "the figure faces +Z"
        );
        let shoulder = Vec3::new(-0.1295, 0.288, 0.0) * HEIGHT_M;
        let hand = root.point(shoulder + Vec3::NEG_X * 0.44 * HEIGHT_M);
        let tip = plan.tip(Limb::LeftArm, &frames[0].target).unwrap();
        assert!((tip - hand).length() < 1e-4, "{tip} {hand}");

        let right = &frames[1].target.angles[chain(Limb::RightArm)];
        assert!(
            right[..3].iter().all(|angle| angle.abs() < 1e-4),
            "{right:?}"
        );
        assert!(
            (right[3] - std::f32::consts::FRAC_PI_2).abs() < 1e-4,
            "{right:?}"
        );
        let leg = &frames[2].target.angles[chain(Limb::RightLeg)];
        let quarter = std::f32::consts::FRAC_PI_2;
        for (angle, wanted) in leg.iter().zip([quarter, 0.0, 0.0, quarter, 0.0, 0.0]) {
            assert!((angle - wanted).abs() < 1e-3, "{leg:?}");
        }
        let moved = frames[2].target.root.translation() - root.translation();
        assert!(
            (moved - Vec3::X * 0.5 * 0.491 / 0.84 * HEIGHT_M).length() < 1e-4,
            "{moved}"
        );
    }
}

#[test]
fn poses_beyond_the_limits_are_clamped_and_counted() {
    let motion = bvh::parse(&bent_bvh(-90.0, -40.0)).unwrap();
    let plan = AvatarPlan::new(HEIGHT_M, Style::Capsules, Trunk::Rigid);
    let frames = motion.frames(&plan).unwrap();
    assert!(frames[1].clamped > 0, "{:?}", frames[1].target.angles[2]);
    let leg = &frames[2].target.angles[plan.chain(Limb::RightLeg).unwrap()];
    assert!(frames[2].clamped > 0 && leg[3] == 0.0, "{leg:?}");
    assert!(
        leg[2].abs() < 1e-4,
        "a knee that bends forward turns no thigh: {leg:?}"
    );
    assert!(frames.iter().all(|frame| plan.kept(&frame.target).1 == 0));
}

#[test]
fn broken_files_are_refused_with_their_line() {
    let whole = small_bvh();
    let fault = |text: &str| bvh::parse(text).unwrap_err();
    assert_eq!(
        fault(""),
        bvh::BvhError {
            line: 1,
            fault: Fault::Ends
        }
    );
    let bad = fault(&whole.replacen("OFFSET 9 0 0", "OFFSET 9 nan 0", 1));
    assert_eq!((bad.line, &bad.fault), (8, &Fault::Number("nan".into())));
    assert_eq!(bad.to_string(), "line 8: \"nan\" is no finite number");
    let bad = fault(&whole.replacen("6 Xposition", "6 Xplace", 1));
    assert_eq!((bad.line, bad.fault), (5, Fault::Channel("Xplace".into())));
    let bad = fault(&whole.replacen("CHANNELS 6", "CHANNELS 7", 1));
    assert_eq!((bad.line, bad.fault), (5, Fault::TooMany("channels")));
    let bad = fault(&whole.replacen("Xposition", "Yposition", 1));
    assert!(matches!(bad.fault, Fault::Channel(_)) && bad.line == 5);
    let bad = fault(&whole.replacen("JOINT", "JOIN", 1));
    assert!(matches!(bad.fault, Fault::Expected(..)) && bad.line == 6);
    let bad = fault(&whole.replacen("Frames: 3", "Frames: 4", 1));
    assert_eq!((bad.line, bad.fault), (0, Fault::FrameCount(3, 4)));
    let bad = fault(&whole.replacen("0.0333333", "-1", 1));
    assert!(matches!(bad.fault, Fault::Expected(..)));
    let lines = whole.lines().count();
    let bad = fault(&format!("{} 7\n", whole.trim_end()));
    assert_eq!((bad.line, bad.fault), (lines, Fault::FrameLength(49, 48)));
    let bad = fault(&whole[..whole.find("MOTION").unwrap()]);
    assert_eq!(bad.fault, Fault::Ends);
    assert!(bvh::read(std::path::Path::new("no/such/file.bvh")).is_err());
    let plan = AvatarPlan::new(HEIGHT_M, Style::Capsules, Trunk::Rigid);
    let missing = bvh::parse(&whole.replace("LeftForeArm", "Something")).unwrap();
    let why = missing.frames(&plan).unwrap_err();
    assert_eq!(why.fault, Fault::Missing("a forearm"));
    for end in 0..whole.len() {
        if let Ok(motion) = bvh::parse(&whole[..end]) {
            let _ = motion.frames(&plan);
        }
    }
}
