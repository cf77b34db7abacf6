//! The avatar: its triangles, its pieces in the neutral posture, and its motions.

use std::collections::BTreeMap;

use palpable::math::Pose;
use palpable_lab::avatar::{AvatarPlan, PIECE_COUNT, Style, Trunk, VERTICES_A_PIECE};
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
