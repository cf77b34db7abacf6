//! Questions about two bodies without a frame: depth, way out and contacts, or distance and closest
//! points. Judged by arithmetic on the shapes' own sizes, in f64.

mod common;

use common::{Block, add_box, add_piece};
use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, BodyError, BodyPenetration, PieceDef, Shape, World};

/// Error of an answer of up to a metre: 1e-6 of the sizes here.
const CLOSE_M: f64 = 2e-6;

fn with_world(test: impl FnOnce(&mut World)) {
    let mut block = Block::new(&Capacities::ROOM);
    test(&mut World::create(block.bytes(), &Capacities::ROOM).unwrap());
}

fn add_body(world: &mut World, kind: BodyKind, pose: Pose) -> BodyId {
    world.add_body(&BodyDef::new(kind, pose)).unwrap()
}

fn add_sphere(world: &mut World, at: [f32; 3], radius_m: f32) -> BodyId {
    let body = add_body(world, BodyKind::Fixed, Pose::at(at[0], at[1], at[2]));
    add_piece(world, body, &PieceDef::new(Shape::Point, radius_m));
    body
}

fn add_box_piece(world: &mut World, body: BodyId, at: [f32; 3], half: [f32; 3]) {
    let def = PieceDef {
        local: Pose::at(at[0], at[1], at[2]),
        ..PieceDef::new(Shape::Box(half), 0.0)
    };
    add_piece(world, body, &def);
}

fn near(found: f32, expected: f64, error: f64) {
    let error_found = (f64::from(found) - expected).abs();
    assert!(error_found <= error, "{found} instead of {expected}");
}

fn near_vector(found: [f32; 3], expected: [f64; 3], error: f64) {
    for axis in 0..3 {
        let off = (f64::from(found[axis]) - expected[axis]).abs();
        assert!(off <= error, "{found:?} instead of {expected:?}");
    }
}

fn moved(pose: &Pose, found: &BodyPenetration) -> Pose {
    let mut out = *pose;
    for axis in 0..3 {
        out.position[axis] += found.depth_m * found.normal[axis];
    }
    out
}

/// Seeded numbers (xorshift).
struct Random(u64);

impl Random {
    /// Evenly from -1 to 1.
    fn number(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn point(&mut self, reach: f32) -> [f32; 3] {
        [0; 3].map(|_| reach * self.number())
    }

    fn half(&mut self) -> [f32; 3] {
        [0; 3].map(|_| 0.06 + 0.05 * self.number())
    }

    fn pose(&mut self, reach: f32) -> Pose {
        let mut rotation = [0.0; 4].map(|_: f32| self.number());
        let length = rotation.iter().map(|x| x * x).sum::<f32>().sqrt();
        rotation = rotation.map(|x| x / length);
        Pose {
            rotation,
            position: self.point(reach),
        }
    }
}

#[test]
fn a_box_in_a_floor_and_a_wall_gets_out_by_both() {
    with_world(|world| {
        let room = add_body(world, BodyKind::Fixed, Pose::IDENTITY);
        add_box_piece(world, room, [0.0, -0.5, 0.0], [2.0, 0.5, 2.0]);
        add_box_piece(world, room, [-0.5, 0.0, 0.0], [0.5, 2.0, 2.0]);
        // 10 mm in the floor, 10 mm in the wall.
        let half = [0.1; 3];
        let hand = add_box(world, BodyKind::Driven, Pose::at(0.09, 0.09, 0.0), half);
        let found = world.penetration(hand, room).unwrap();
        let root = 0.5_f64.sqrt();
        near(found.depth_m, 0.01 / root, 5e-6);
        near_vector(found.normal, [root, root, 0.0], 1e-4);
        assert!(found.complete);
        assert_eq!(found.distance_m, 0.0);
        assert_eq!(found.contacts.len(), 4);
        for contact in &found.contacts {
            near(contact.gap_m, -0.01, CLOSE_M);
        }
        let out = moved(&world.pose(hand).unwrap(), &found);
        near(out.position[0], 0.1, 5e-6);
        near(out.position[1], 0.1, 5e-6);
    });
}

#[test]
fn spheres_apart_and_overlapping() {
    with_world(|world| {
        let a = add_sphere(world, [0.0, 0.5, 0.0], 0.1);
        let b = add_sphere(world, [0.0, 0.0, 0.0], 0.15);
        let found = world.penetration(a, b).unwrap();
        near(found.distance_m, 0.25, CLOSE_M);
        assert_eq!(found.depth_m, 0.0);
        near_vector(found.normal, [0.0, 1.0, 0.0], 1e-6);
        near_vector(found.point_a, [0.0, 0.4, 0.0], CLOSE_M);
        near_vector(found.point_b, [0.0, 0.15, 0.0], CLOSE_M);
        assert!(found.contacts.is_empty() && found.complete);

        let (here, there) = (Pose::at(0.2, 0.0, 0.0), Pose::IDENTITY);
        let found = world.penetration_at(a, &here, b, &there).unwrap();
        near(found.depth_m, 0.05, CLOSE_M);
        assert_eq!(found.distance_m, 0.0);
        near_vector(found.normal, [1.0, 0.0, 0.0], 1e-6);
        near_vector(found.point_a, [0.1, 0.0, 0.0], CLOSE_M);
        near_vector(found.point_b, [0.15, 0.0, 0.0], CLOSE_M);
        assert_eq!(found.contacts.len(), 1);
        near_vector(found.contacts[0].point, [0.125, 0.0, 0.0], CLOSE_M);
        near(found.contacts[0].gap_m, -0.05, CLOSE_M);
    });
}

#[test]
fn boxes_apart_a_hundred_metres_out() {
    // Coordinates there are spaced by 7.6e-6 m: the points are that coarse, the distance is not.
    for (origin, error) in [(0.0_f32, CLOSE_M), (100.0, 1.6e-5)] {
        with_world(|world| {
            let high = Pose::at(origin, origin + 0.5, -origin);
            let a = add_box(world, BodyKind::Fixed, high, [0.1, 0.1, 0.05]);
            let low = Pose::at(origin, origin, -origin);
            let b = add_box(world, BodyKind::Fixed, low, [0.25, 0.125, 0.25]);
            let found = world.penetration(a, b).unwrap();
            near(found.distance_m, 0.275, CLOSE_M);
            near_vector(found.normal, [0.0, 1.0, 0.0], 1e-6);
            let o = f64::from(origin);
            near(found.point_a[1], o + 0.4, error);
            near(found.point_b[1], o + 0.125, error);
            assert!((f64::from(found.point_a[0]) - o).abs() < 0.1 + error);
            near(found.point_a[0], f64::from(found.point_b[0]), error);
            near(found.point_a[2], f64::from(found.point_b[2]), error);

            let sunk = Pose::at(origin, origin + 0.21875, -origin);
            let found = world.penetration_at(a, &sunk, b, &low).unwrap();
            near(found.depth_m, 0.00625, CLOSE_M);
            assert_eq!(found.contacts.len(), 4);
        });
    }
}

#[test]
fn a_plug_between_two_walls_leaves_through_the_open_side() {
    // Figure 4(b) of Schmidl and Lin 2004: opposite pairs, whose weighted mean is zero.
    with_world(|world| {
        let slot = add_body(world, BodyKind::Fixed, Pose::IDENTITY);
        add_box_piece(world, slot, [-0.6, 0.0, 0.0], [0.5, 0.2, 0.5]);
        add_box_piece(world, slot, [0.6, 0.0, 0.0], [0.5, 0.2, 0.5]);
        // 0.22 m wide in a gap of 0.2 m, its underside 0.1 m below the walls' top.
        let half = [0.11, 0.1, 0.1];
        let plug = add_box(world, BodyKind::Dynamic, Pose::at(0.0, 0.2, 0.0), half);
        let found = world.penetration(plug, slot).unwrap();
        near(found.depth_m, 0.1, 2e-6);
        near_vector(found.normal, [0.0, 1.0, 0.0], 1e-5);
        assert!(found.complete);
    });
}

#[test]
fn pairs_that_come_in_the_way_are_respected() {
    // Out of the floor to the nearer side (left, 20 mm) a second piece stands 10 mm away.
    with_world(|world| {
        let ground = add_body(world, BodyKind::Fixed, Pose::IDENTITY);
        add_box_piece(world, ground, [0.0, 0.0, 0.0], [0.1, 0.5, 0.5]);
        add_box_piece(world, ground, [-0.31, 0.0, 0.0], [0.1, 0.5, 0.5]);
        // Left face at -0.2, right face at -0.08: 20 mm in the first piece.
        let half = [0.06, 0.1, 0.1];
        let hand = add_box(world, BodyKind::Driven, Pose::at(-0.14, 0.0, 0.0), half);
        let found = world.penetration(hand, ground).unwrap();
        assert!(found.complete);
        let out = moved(&world.pose(hand).unwrap(), &found);
        let again = world
            .penetration_at(hand, &out, ground, &Pose::IDENTITY)
            .unwrap();
        assert!(again.depth_m < 1e-5, "{again:?}");
        // To the right: the hand's left face to 0.1.
        near(found.depth_m, 0.3, 2e-6);
    });
}

#[test]
fn a_bent_finger_counts_where_it_is_published() {
    with_world(|world| {
        let hand = add_body(world, BodyKind::Driven, Pose::IDENTITY);
        add_piece(world, hand, &PieceDef::new(Shape::Point, 0.05));
        let ball = add_sphere(world, [0.0, 1.0, 0.0], 0.1);
        near(
            world.penetration(hand, ball).unwrap().distance_m,
            0.85,
            CLOSE_M,
        );
        world.set_target(hand, &Pose::IDENTITY).unwrap();
        world
            .set_piece_targets(hand, &[Pose::at(0.0, 0.25, 0.0)])
            .unwrap();
        near(
            world.penetration(hand, ball).unwrap().distance_m,
            0.85,
            CLOSE_M,
        );
        world.step(&FrameInput::unlimited(1.0 / 60.0));
        near(
            world.penetration(hand, ball).unwrap().distance_m,
            0.6,
            CLOSE_M,
        );
    });
}

/// Two bodies of a few boxes and spheres.
fn compounds(world: &mut World, random: &mut Random) -> [BodyId; 2] {
    [BodyKind::Driven, BodyKind::Fixed].map(|kind| {
        let body = add_body(world, kind, random.pose(0.12));
        for piece in 0..3 {
            let def = PieceDef {
                local: random.pose(0.12),
                ..if piece == 2 {
                    PieceDef::new(Shape::Point, 0.05)
                } else {
                    PieceDef::new(Shape::Box(random.half()), 0.0)
                }
            };
            add_piece(world, body, &def);
        }
        body
    })
}

#[test]
fn asked_the_other_way_round_the_normal_is_negated() {
    let mut random = Random(7);
    for _ in 0..100 {
        with_world(|world| {
            let [a, b] = compounds(world, &mut random);
            let ab = world.penetration(a, b).unwrap();
            let ba = world.penetration(b, a).unwrap();
            assert_eq!((ab.depth_m, ab.distance_m), (ba.depth_m, ba.distance_m));
            assert_eq!(ab.normal, ba.normal.map(|part| -part));
            assert_eq!((ab.point_a, ab.point_b), (ba.point_b, ba.point_a));
            assert_eq!((ab.piece_a, ab.piece_b), (ba.piece_b, ba.piece_a));
            assert_eq!(ab.contacts.len(), ba.contacts.len());
        });
    }
}

#[test]
fn moved_by_the_answer_random_bodies_are_apart() {
    let mut random = Random(11);
    let mut overlapping = 0;
    for scene in 0..200 {
        with_world(|world| {
            let [a, b] = compounds(world, &mut random);
            let found = world.penetration(a, b).unwrap();
            assert!(found.complete, "scene {scene}");
            if found.depth_m == 0.0 {
                return;
            }
            overlapping += 1;
            let (pose_a, pose_b) = (world.pose(a).unwrap(), world.pose(b).unwrap());
            let out = moved(&pose_a, &found);
            let again = world.penetration_at(a, &out, b, &pose_b).unwrap();
            assert!(again.depth_m <= 2e-6, "scene {scene}: {again:?}");
            // No union gets apart by less than its deepest pair needs.
            let deepest = found.contacts.iter().map(|c| -c.gap_m).fold(0.0, f32::max);
            assert!(found.depth_m >= deepest - 1e-6, "scene {scene}");
        });
    }
    assert!(overlapping > 60, "{overlapping}");
}

fn rows(pose: &Pose) -> [[f64; 3]; 3] {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - z * w),
            2.0 * (x * z + y * w),
        ],
        [
            2.0 * (x * y + z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - x * w),
        ],
        [
            2.0 * (x * z - y * w),
            2.0 * (y * z + x * w),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

/// Greatest gap of two boxes over their fifteen axes; negative is their penetration depth.
fn box_gap(pose_a: &Pose, half_a: [f32; 3], pose_b: &Pose, half_b: [f32; 3]) -> f64 {
    let (a, b) = (rows(pose_a), rows(pose_b));
    let column = |m: &[[f64; 3]; 3], k: usize| [m[0][k], m[1][k], m[2][k]];
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let mut axes: Vec<[f64; 3]> = Vec::new();
    for k in 0..3 {
        axes.push(column(&a, k));
        axes.push(column(&b, k));
        for l in 0..3 {
            let (u, v) = (column(&a, k), column(&b, l));
            let cross = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            let length = dot(cross, cross).sqrt();
            if length > 1e-6 {
                axes.push(cross.map(|part| part / length));
            }
        }
    }
    let between: Vec<f64> = (0..3)
        .map(|i| f64::from(pose_a.position[i]) - f64::from(pose_b.position[i]))
        .collect();
    let reach = |m: &[[f64; 3]; 3], half: [f32; 3], axis: [f64; 3]| -> f64 {
        (0..3)
            .map(|k| dot(column(m, k), axis).abs() * f64::from(half[k]))
            .sum()
    };
    axes.iter()
        .map(|&axis| {
            let centre = dot([between[0], between[1], between[2]], axis).abs();
            centre - reach(&a, half_a, axis) - reach(&b, half_b, axis)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// How far a point is outside a box along one of its axes, at most.
fn outside(pose: &Pose, half: [f32; 3], point: [f32; 3]) -> f64 {
    let m = rows(pose);
    (0..3)
        .map(|k| {
            let along: f64 = (0..3)
                .map(|i| m[i][k] * (f64::from(point[i]) - f64::from(pose.position[i])))
                .sum();
            along.abs() - f64::from(half[k])
        })
        .fold(0.0, f64::max)
}

#[test]
fn random_boxes_are_as_deep_as_their_fifteen_axes_say() {
    let mut random = Random(23);
    let mut overlapping = 0;
    for scene in 0..300 {
        with_world(|world| {
            let (pose_a, pose_b) = (random.pose(0.08), random.pose(0.08));
            let (half_a, half_b) = (random.half(), random.half());
            let a = add_box(world, BodyKind::Dynamic, pose_a, half_a);
            let b = add_box(world, BodyKind::Fixed, pose_b, half_b);
            let (pose_a, pose_b) = (world.pose(a).unwrap(), world.pose(b).unwrap());
            let found = world.penetration(a, b).unwrap();
            let gap = box_gap(&pose_a, half_a, &pose_b, half_b);
            if gap < -1e-6 {
                overlapping += 1;
                near(found.depth_m, -gap, 1e-6);
                let out = moved(&pose_a, &found);
                let left = box_gap(&out, half_a, &pose_b, half_b);
                assert!(left > -1e-6, "scene {scene}: {left}");
            } else if gap > 1e-6 {
                assert!(f64::from(found.distance_m) >= gap - 1e-6, "scene {scene}");
                // The points are of the boxes, so no distance is longer than theirs.
                assert!(outside(&pose_a, half_a, found.point_a) < 1e-6);
                assert!(outside(&pose_b, half_b, found.point_b) < 1e-6);
                let apart = (0..3)
                    .map(|i| (f64::from(found.point_a[i]) - f64::from(found.point_b[i])).powi(2))
                    .sum::<f64>()
                    .sqrt();
                near(found.distance_m, apart, 1e-6);
            }
        });
    }
    assert!(overlapping > 100, "{overlapping}");
}

#[test]
fn more_pairs_than_fit_are_said_to_be_left_out() {
    with_world(|world| {
        let slab = add_box(world, BodyKind::Fixed, Pose::IDENTITY, [2.0, 0.1, 2.0]);
        let comb = add_body(world, BodyKind::Driven, Pose::at(0.0, 0.1, 0.0));
        for tooth in 0..70 {
            let at = [0.02 * (tooth % 10) as f32, 0.0, 0.02 * (tooth / 10) as f32];
            add_box_piece(world, comb, at, [0.005; 3]);
        }
        let found = world.penetration(comb, slab).unwrap();
        assert!(!found.complete);
        near(found.depth_m, 0.005, 1e-5);
    });
}

#[test]
fn what_cannot_be_answered_is_refused() {
    with_world(|world| {
        let a = add_sphere(world, [0.0; 3], 0.1);
        let b = add_sphere(world, [1.0, 0.0, 0.0], 0.1);
        let empty = add_body(world, BodyKind::Fixed, Pose::IDENTITY);
        let good = Pose::IDENTITY;
        assert_eq!(world.penetration(a, a), Err(BodyError::SameBody));
        assert_eq!(world.penetration(a, BodyId::NULL), Err(BodyError::Stale));
        assert_eq!(world.penetration(BodyId::NULL, a), Err(BodyError::Stale));
        for bad in [Pose::at(f32::NAN, 0.0, 0.0), Pose::at(2e3, 0.0, 0.0)] {
            let refused = Err(BodyError::BadPose);
            assert_eq!(world.penetration_at(a, &bad, b, &good), refused);
            assert_eq!(world.penetration_at(a, &good, b, &bad), refused);
        }
        let found = world.penetration(a, empty).unwrap();
        assert_eq!((found.distance_m, found.normal), (f32::INFINITY, [0.0; 3]));
        world.remove_body(b).unwrap();
        assert_eq!(world.penetration(a, b), Err(BodyError::Stale));
        assert_eq!(
            world.penetration_at(a, &good, b, &good),
            Err(BodyError::Stale)
        );
    });
}
