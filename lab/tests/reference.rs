//! The reference against answers that follow from the shapes alone.

use glam::{DQuat, DVec3};
use palpable_lab::reference::{
    EscapeError, Judge, Placed, Pose, Signed, Solid, SolidError, overlap_depth, signed_distance,
    union_escape,
};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, SQRT_2, TAU};

const EXACT: f64 = 1e-13;

/// Numbers from -1 to 1 by Marsaglia's xorshift64.
struct Noise(u64);

impl Noise {
    fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    fn rotation(&mut self) -> DQuat {
        DQuat::from_xyzw(self.number(), self.number(), self.number(), self.number()).normalize()
    }

    fn hull(&mut self, count: usize, half: DVec3, radius: f64) -> Solid {
        let points: Vec<DVec3> = (0..count).map(|_| self.vector() * half).collect();
        Solid::new(&points, radius).unwrap()
    }

    fn place<'a>(&mut self, solid: &'a Solid, spread: f64) -> Placed<'a> {
        Placed::new(solid, self.rotation(), self.vector() * spread)
    }
}

fn corners(half: DVec3) -> Vec<DVec3> {
    let sign = |bits: usize, axis: usize| if bits >> axis & 1 == 0 { -1.0 } else { 1.0 };
    (0..8)
        .map(|i| half * DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)))
        .collect()
}

fn block(half: DVec3) -> Solid {
    Solid::new(&corners(half), 0.0).unwrap()
}

fn cube() -> Solid {
    block(DVec3::ONE)
}

fn at(solid: &Solid, position: DVec3) -> Placed<'_> {
    Placed::new(solid, DQuat::IDENTITY, position)
}

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value:e} is not {expected:e}"
    );
}

fn consistent(a: &Placed, b: &Placed, tolerance: f64) -> Signed {
    let found = signed_distance(a, b);
    let between = found.point_a - found.point_b - found.value * found.normal;
    close(between.length(), 0.0, tolerance);
    close(found.normal.length(), 1.0, EXACT);
    close(overlap_depth(a, b), (-found.value).max(0.0), tolerance);
    let moved = a.moved(-found.value * found.normal);
    close(signed_distance(&moved, b).value, 0.0, tolerance);
    let swapped = signed_distance(b, a);
    close(swapped.value, found.value, tolerance);
    found
}

/// The greatest gap over every conceivable facet normal, without arcs and without pruning.
fn by_every_axis(a: &Placed, b: &Placed) -> f64 {
    let points = |p: &Placed| -> Vec<DVec3> {
        p.solid()
            .vertices()
            .iter()
            .map(|&v| p.rotation() * v + p.position())
            .collect()
    };
    let (points_a, points_b) = (points(a), points(b));
    let mut axes: Vec<DVec3> = Vec::new();
    axes.extend(a.solid().faces().iter().map(|f| -(a.rotation() * f.normal)));
    axes.extend(b.solid().faces().iter().map(|f| b.rotation() * f.normal));
    for e in a.solid().edges() {
        for f in b.solid().edges() {
            let cross = (a.rotation() * e.direction).cross(b.rotation() * f.direction);
            if cross.length() > 1e-9 {
                axes.extend([cross.normalize(), -cross.normalize()]);
            }
        }
    }
    let gap = |n: DVec3| {
        let low = points_a
            .iter()
            .map(|&p| n.dot(p))
            .fold(f64::INFINITY, f64::min);
        let high = points_b
            .iter()
            .map(|&p| n.dot(p))
            .fold(f64::NEG_INFINITY, f64::max);
        low - high
    };
    axes.into_iter().map(gap).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_cube_has_six_faces_and_twelve_edges_however_its_points_are_given() {
    let mut points = corners(DVec3::ONE);
    for i in 0..5 {
        for j in 0..5 {
            let (u, v) = (0.5 * f64::from(i) - 1.0, 0.5 * f64::from(j) - 1.0);
            points.extend([
                DVec3::new(1.0, u, v),
                DVec3::new(u, -1.0, v),
                DVec3::new(u, v, 0.0),
            ]);
        }
    }
    points.extend(points.clone());
    let dense = Solid::new(&points, 0.0).unwrap();
    assert_eq!(cube().vertices().len(), 8);
    assert_eq!(cube().faces().len(), 6);
    assert_eq!(cube().edges().len(), 12);
    assert_eq!(dense.faces().len(), 6);
    let other = at(&dense, DVec3::new(1.9, 0.0, 0.0));
    close(
        consistent(&at(&cube(), DVec3::ZERO), &other, EXACT).value,
        -0.1,
        EXACT,
    );
}

#[test]
fn bad_input_is_refused_by_name() {
    assert_eq!(Solid::new(&[], 0.0).unwrap_err(), SolidError::Empty);
    assert_eq!(
        Solid::new(&[DVec3::NAN], 0.0).unwrap_err(),
        SolidError::NotFinite
    );
    assert_eq!(
        Solid::new(&[DVec3::ZERO], f64::INFINITY).unwrap_err(),
        SolidError::NotFinite
    );
    assert_eq!(
        Solid::new(&[DVec3::ZERO], -1.0).unwrap_err(),
        SolidError::NegativeRadius
    );
}

#[test]
fn cubes_face_to_face() {
    let cube = cube();
    let found = consistent(
        &at(&cube, DVec3::ZERO),
        &at(&cube, DVec3::new(1.9, 0.0, 0.0)),
        EXACT,
    );
    close(found.value, -0.1, EXACT);
    close(found.normal.x, -1.0, EXACT);
    let apart = consistent(
        &at(&cube, DVec3::ZERO),
        &at(&cube, DVec3::new(2.1, 0.3, 0.2)),
        EXACT,
    );
    close(apart.value, 0.1, EXACT);
}

#[test]
fn cubes_edge_to_edge() {
    let cube = cube();
    let still = Placed::new(&cube, DQuat::from_rotation_z(FRAC_PI_4), DVec3::ZERO);
    for depth in [0.3, 0.01, 1e-6, -1e-6, -0.2] {
        let position = DVec3::X * (2.0 * SQRT_2 - depth);
        let other = Placed::new(&cube, DQuat::from_rotation_y(FRAC_PI_4), position);
        let found = consistent(&still, &other, EXACT);
        close(found.value, -depth, EXACT);
        close(found.normal.x, -1.0, 1e-9);
    }
}

#[test]
fn a_corner_into_a_face() {
    let cube = cube();
    let tilt = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Y);
    let height = 1.0 + 3.0_f64.sqrt();
    for depth in [0.05, -0.05] {
        let falling = Placed::new(&cube, tilt, DVec3::new(0.1, height - depth, -0.2));
        let found = consistent(&falling, &at(&cube, DVec3::ZERO), EXACT);
        close(found.value, -depth, EXACT);
        close(
            (found.point_a - DVec3::new(0.1, 1.0 - depth, -0.2)).length(),
            0.0,
            EXACT,
        );
    }
}

#[test]
fn spheres_and_capsules() {
    let sphere = Solid::new(&[DVec3::ZERO], 0.5).unwrap();
    let small = Solid::new(&[DVec3::ZERO], 0.25).unwrap();
    let offset = DVec3::new(0.3, 0.4, 0.0);
    close(
        consistent(&at(&sphere, offset), &at(&small, DVec3::ZERO), EXACT).value,
        -0.25,
        EXACT,
    );
    let far = consistent(&at(&sphere, 2.0 * offset), &at(&small, DVec3::ZERO), EXACT);
    close(far.value, 0.25, EXACT);
    close((far.normal - offset / 0.5).length(), 0.0, EXACT);

    let capsule = Solid::new(&[DVec3::NEG_X, DVec3::X], 0.1).unwrap();
    let crossed = Placed::new(&capsule, DQuat::from_rotation_y(1.0), DVec3::Y * 0.15);
    close(
        consistent(&crossed, &at(&capsule, DVec3::ZERO), EXACT).value,
        -0.05,
        EXACT,
    );
    let parallel = at(&capsule, DVec3::new(0.7, 0.3, 0.0));
    close(
        consistent(&parallel, &at(&capsule, DVec3::ZERO), EXACT).value,
        0.1,
        EXACT,
    );
    let ahead = at(&capsule, DVec3::X * 2.15);
    close(
        consistent(&ahead, &at(&capsule, DVec3::ZERO), EXACT).value,
        -0.05,
        EXACT,
    );
    let on_face = at(&capsule, DVec3::Y * 1.04);
    close(
        consistent(&on_face, &at(&cube(), DVec3::ZERO), EXACT).value,
        -0.06,
        EXACT,
    );
    let buried = at(&capsule, DVec3::Y * 0.9);
    close(
        consistent(&buried, &at(&cube(), DVec3::ZERO), EXACT).value,
        -0.2,
        EXACT,
    );
}

#[test]
fn concentric_and_inside() {
    let cube = cube();
    let sphere = Solid::new(&[DVec3::ZERO], 0.5).unwrap();
    let capsule = Solid::new(&[DVec3::NEG_X, DVec3::X], 0.1).unwrap();
    let small = block(DVec3::splat(0.25));
    let here = |solid| at(solid, DVec3::ZERO);
    close(
        consistent(&here(&cube), &here(&cube), EXACT).value,
        -2.0,
        EXACT,
    );
    close(
        consistent(&here(&sphere), &here(&sphere), EXACT).value,
        -1.0,
        EXACT,
    );
    close(
        consistent(&here(&capsule), &here(&capsule), EXACT).value,
        -0.2,
        EXACT,
    );
    close(
        consistent(&here(&sphere), &here(&capsule), EXACT).value,
        -0.6,
        EXACT,
    );
    close(
        consistent(&here(&sphere), &here(&cube), EXACT).value,
        -1.5,
        EXACT,
    );
    let inside = at(&small, DVec3::new(0.0, 0.5, 0.125));
    close(consistent(&inside, &here(&cube), EXACT).value, -0.75, EXACT);
}

#[test]
fn touching_at_a_point_an_edge_and_a_face() {
    let cube = cube();
    let touching = [
        DVec3::new(2.0, 2.0, 2.0),
        DVec3::new(2.0, 2.0, 0.5),
        DVec3::new(2.0, 0.5, 0.25),
        DVec3::new(0.0, -2.0, 0.0),
    ];
    for position in touching {
        let found = consistent(&at(&cube, position), &at(&cube, DVec3::ZERO), EXACT);
        close(found.value, 0.0, EXACT);
        assert!(found.normal.dot(position) > 0.0);
    }
}

#[test]
fn flat_and_thin_cores() {
    let plate = [
        DVec3::ZERO,
        DVec3::X,
        DVec3::Z,
        DVec3::X + DVec3::Z,
        0.5 * DVec3::X,
    ];
    let plate = Solid::new(&plate, 0.01).unwrap();
    assert_eq!(plate.vertices().len(), 4);
    let cube = cube();
    let over = at(&cube, DVec3::new(0.5, 1.005, 0.5));
    close(
        consistent(&over, &at(&plate, DVec3::ZERO), EXACT).value,
        -0.005,
        EXACT,
    );
    let through = at(&cube, DVec3::new(0.5, 0.75, 0.5));
    close(
        consistent(&through, &at(&plate, DVec3::ZERO), EXACT).value,
        -0.26,
        EXACT,
    );
    close(
        consistent(&at(&plate, DVec3::ZERO), &at(&plate, DVec3::ZERO), EXACT).value,
        -0.02,
        EXACT,
    );

    let sliver = block(DVec3::new(1.0, 1e-3, 1e-3));
    let across = Placed::new(&sliver, DQuat::from_rotation_y(0.7), DVec3::Y * 1.5e-3);
    close(
        consistent(&across, &at(&sliver, DVec3::ZERO), EXACT).value,
        -5e-4,
        EXACT,
    );
}

#[test]
fn nearly_parallel_edges() {
    let cube = cube();
    for angle in [1e-12, 1e-9, 1e-7, 1e-5] {
        let turned = DQuat::from_rotation_y(angle) * DQuat::from_rotation_x(FRAC_PI_4);
        let found = consistent(
            &Placed::new(&cube, turned, DVec3::Y * (1.0 + SQRT_2 - 0.1)),
            &at(&cube, DVec3::ZERO),
            EXACT,
        );
        close(found.value, -0.1, EXACT);
        let edges = Placed::new(&cube, turned, DVec3::Y * (2.0 * SQRT_2 - 0.1));
        let under = Placed::new(&cube, DQuat::from_rotation_x(FRAC_PI_4), DVec3::ZERO);
        let found = consistent(&edges, &under, EXACT);
        close(found.value, -0.1 * FRAC_1_SQRT_2, EXACT + 2.0 * angle);
        close(found.value, by_every_axis(&edges, &under), EXACT);
    }
}

#[test]
fn nearly_parallel_segments_that_touch() {
    let segment = Solid::new(&[DVec3::NEG_X, DVec3::X], 0.0).unwrap();
    let mut noise = Noise(23);
    for angle in [1e-5, 1e-7, 5e-8, 1e-9] {
        for _ in 0..20 {
            let (turn, shift) = (noise.rotation(), 0.3 * noise.number());
            let still = Placed::new(&segment, turn, DVec3::ZERO);
            let crossed = turn * DQuat::from_rotation_y(angle);
            let gap = 1e-3 * noise.number().abs();
            let position = turn * (shift * DVec3::X + gap * DVec3::Y);
            let found = consistent(&Placed::new(&segment, crossed, position), &still, EXACT);
            close(found.value, gap, EXACT);
        }
    }
}

#[test]
fn the_normal_alone_proves_a_gap() {
    let mut noise = Noise(29);
    for round in 0..300 {
        let half = DVec3::new(1.0, [1.0, 1e-3, 1e-6][round % 3], 0.5);
        let (a, b) = (noise.hull(20, half, 0.0), noise.hull(14, half, 0.0));
        let (a, b) = (noise.place(&a, 2.0), noise.place(&b, 0.0));
        let found = signed_distance(&a, &b);
        let along = |p: &Placed, v: DVec3| found.normal.dot(p.rotation() * v + p.position());
        let low = a.solid().vertices().iter().map(|&v| along(&a, v));
        let high = b.solid().vertices().iter().map(|&v| along(&b, v));
        let gap = low.fold(f64::INFINITY, f64::min) - high.fold(f64::NEG_INFINITY, f64::max);
        close(found.value, gap, EXACT);
    }
}

#[test]
fn every_size_from_a_millimetre_to_a_hundred_metres() {
    for (size, other) in [(1e-3, 1e-3), (100.0, 100.0), (1e-3, 100.0), (0.05, 100.0)] {
        let (one, two) = (block(DVec3::splat(size)), block(DVec3::splat(other)));
        let depth = 0.125 * size;
        let raised = DVec3::new(0.25 * size, size + other - depth, 0.0);
        let found = consistent(&at(&one, raised), &at(&two, DVec3::ZERO), EXACT * other);
        close(found.value, -depth, EXACT * other);
    }
}

#[test]
fn random_hulls_match_every_axis_and_are_left_just_touching() {
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    let mut overlapping = 0;
    for round in 0..200 {
        let half = DVec3::new(0.3, 0.2, 0.1);
        let a = noise.hull(4 + round % 29, half, 0.0);
        let b = noise.hull(4 + round % 13, half, 0.0);
        let (a, b) = (noise.place(&a, 0.15), noise.place(&b, 0.15));
        let found = consistent(&a, &b, EXACT);
        let expected = by_every_axis(&a, &b);
        assert!(found.value >= expected - EXACT);
        if expected < 0.0 {
            close(found.value, expected, EXACT);
            overlapping += 1;
        }
    }
    assert!(overlapping > 50);
}

#[test]
fn swapping_negates_the_normal_and_rounding_only_shifts_the_value() {
    let mut noise = Noise(7);
    let half = DVec3::splat(0.1);
    for _ in 0..100 {
        let points: Vec<DVec3> = (0..20).map(|_| noise.vector() * half).collect();
        let sharp = Solid::new(&points, 0.0).unwrap();
        let round = Solid::new(&points, 0.02).unwrap();
        let other = noise.hull(12, half, 0.0);
        let (rotation, position) = (noise.rotation(), noise.vector() * 0.15);
        let other = noise.place(&other, 0.0);
        let sharp = Placed::new(&sharp, rotation, position);
        let round = Placed::new(&round, rotation, position);
        let found = consistent(&sharp, &other, EXACT);
        let swapped = signed_distance(&other, &sharp);
        close((found.normal + swapped.normal).length(), 0.0, 1e-9);
        let rounded = consistent(&round, &other, EXACT);
        close(rounded.value, found.value - 0.02, EXACT);
    }
}

#[test]
fn moving_both_changes_nothing() {
    let mut noise = Noise(11);
    let (a, b) = (
        noise.hull(24, DVec3::splat(0.1), 0.005),
        noise.hull(16, DVec3::splat(0.1), 0.0),
    );
    for _ in 0..100 {
        let (turn_a, place_a) = (noise.rotation(), noise.vector() * 0.15);
        let (turn_b, place_b) = (noise.rotation(), noise.vector() * 0.15);
        let near = signed_distance(
            &Placed::new(&a, turn_a, place_a),
            &Placed::new(&b, turn_b, place_b),
        );
        let (turn, shift) = (noise.rotation(), noise.vector() * 1000.0);
        let far = signed_distance(
            &Placed::new(&a, turn * turn_a, turn * place_a + shift),
            &Placed::new(&b, turn * turn_b, turn * place_b + shift),
        );
        close(far.value, near.value, 2e-12);
        close((far.normal - turn * near.normal).length(), 0.0, 1e-8);
    }
}

#[test]
fn depth_is_continuous_over_a_full_turn() {
    let mut noise = Noise(13);
    let (a, b) = (noise.hull(16, DVec3::splat(0.1), 0.0), cube());
    let steps = 2000;
    let value = |step: i32| {
        let turn = DQuat::from_axis_angle(DVec3::ONE.normalize(), TAU * f64::from(step) / 2000.0);
        signed_distance(
            &Placed::new(&a, turn, DVec3::Y * 1.05),
            &at(&b, DVec3::ZERO),
        )
        .value
    };
    for step in 0..steps {
        close(value(step + 1), value(step), 0.18 * TAU / f64::from(steps));
    }
    close(value(steps), value(0), EXACT);
}

#[test]
fn poses_from_f32_are_normalised() {
    let cube = cube();
    let pose = Pose::from_f32([0.0, 0.0, 0.0, 0.999], [0.0, 1.9, 0.0]);
    close(pose.rotation.length(), 1.0, EXACT);
    let found = signed_distance(&Placed::at(&cube, pose), &at(&cube, DVec3::ZERO));
    close(found.value, f64::from(1.9_f32) - 2.0, EXACT);
}

#[test]
fn a_ball_of_960_triangles() {
    let ball = ball(0.1);
    assert_eq!(ball.vertices().len(), 482);
    assert_eq!(ball.triangles().len(), 960);
    let floor = block(DVec3::new(1.0, 0.1, 1.0));
    for depth in [1e-4, 0.02, -2e-5] {
        let raised = at(&ball, DVec3::Y * (f64::from(0.1_f32) + 0.1 - depth));
        close(
            consistent(&raised, &at(&floor, DVec3::ZERO), EXACT).value,
            -depth,
            EXACT,
        );
    }
}

fn ball(radius: f64) -> Solid {
    let mut points = vec![[0.0, radius as f32, 0.0], [0.0, -radius as f32, 0.0]];
    for row in 1..16 {
        for column in 0..32 {
            let (high, low) = (0.5 * TAU * f64::from(row) / 16.0).sin_cos();
            let (sine, cosine) = (TAU * f64::from(column) / 32.0).sin_cos();
            let point = radius * DVec3::new(high * cosine, low, high * sine);
            points.push(point.to_array().map(|x| x as f32));
        }
    }
    Solid::from_f32(&points, 0.0).unwrap()
}

#[test]
fn the_judge_finds_the_deepest_pair_per_category() {
    let mut judge = Judge::new();
    let half = block(DVec3::new(1.0, 0.5, 1.0));
    let floor = judge.add_fixed(half.clone(), 0, "fixed", "floor", Pose::IDENTITY);
    let wall = Pose::new(DQuat::IDENTITY, DVec3::new(1.5, 0.0, 0.0));
    judge.add_fixed(half, 0, "fixed", "wall", wall);
    let tip = Solid::new(&[DVec3::ZERO], 0.01).unwrap();
    let thumb = judge.add_moving(tip.clone(), 1, "hand", "thumb");
    judge.add_moving(tip.clone(), 1, "hand", "index");
    judge.add_moving(tip, 2, "ball", "ball");
    let poses = |thumb: f64, index: f64, ball: f64| {
        [thumb, index, ball].map(|y| Pose::new(DQuat::IDENTITY, DVec3::Y * y))
    };
    let verdict = judge.frame(&poses(0.508, 0.512, 0.530));
    let deepest = verdict.deepest.unwrap();
    assert_eq!(deepest.pieces, [floor, thumb]);
    assert_eq!(judge.name(deepest.pieces[1]), "thumb");
    assert_eq!(judge.category(deepest.pieces[0]), "fixed");
    close(deepest.depth_m, 0.002, EXACT);
    close(verdict.depth_between("hand", "fixed"), 0.002, EXACT);
    close(verdict.depth_between("ball", "hand"), 0.002, EXACT);
    assert_eq!(verdict.depth_between("ball", "fixed"), 0.0);

    let mut worst = verdict;
    worst.absorb(&judge.frame(&poses(0.509, 0.52, 0.505)));
    close(worst.depth_between("fixed", "ball"), 0.005, EXACT);
    close(worst.depth_between("fixed", "hand"), 0.002, EXACT);
    assert!(judge.frame(&poses(1.0, 2.0, 3.0)).deepest.is_none());
}

fn escape(a: &[Placed], b: &[Placed]) -> DVec3 {
    let answer = union_escape(a, b).unwrap();
    for p in a {
        for q in b {
            assert!(signed_distance(&p.moved(answer), q).value >= -1e-11);
        }
    }
    answer
}

#[test]
fn a_box_in_a_corner_leaves_floor_and_wall_together() {
    let hand = block(DVec3::splat(0.05));
    let slab = block(DVec3::splat(1.0));
    let hand = [at(&hand, DVec3::new(0.04, 0.04, 0.0))];
    let room = [
        at(&slab, DVec3::NEG_Y),
        at(&slab, DVec3::new(-1.0, 1.0, 0.0)),
    ];
    let answer = escape(&hand, &room);
    close((answer - DVec3::new(0.01, 0.01, 0.0)).length(), 0.0, 1e-12);
}

#[test]
fn a_block_too_wide_for_its_slot_leaves_along_the_slot() {
    let (width, depth, high) = (0.1, 0.004, 0.02);
    let block_half = DVec3::new(0.5 * width + depth, 0.5, 0.3);
    let wall_half = DVec3::new(0.5, 0.5, 0.5);
    let (hand, wall) = (block(block_half), block(wall_half));
    let side = 0.5 * width + 0.5;
    let hand = [at(&hand, DVec3::Y * (0.5 - high))];
    let walls = [
        at(&wall, DVec3::new(-side, -0.5, 0.0)),
        at(&wall, DVec3::new(side, -0.5, 0.0)),
    ];
    let answer = escape(&hand, &walls);
    close((answer - DVec3::Y * high).length(), 0.0, 1e-12);
}

#[test]
fn an_escape_does_not_run_into_the_next_obstacle() {
    let hand = block(DVec3::splat(0.05));
    let shelf = block(DVec3::new(1.0, 0.1, 1.0));
    let hand = [at(&hand, DVec3::Y * 0.14)];
    let ceiling = |gap: f64| at(&shelf, DVec3::Y * (0.2 + gap));
    let roomy = [at(&shelf, DVec3::ZERO), ceiling(0.11)];
    close(
        (escape(&hand, &roomy) - DVec3::Y * 0.01).length(),
        0.0,
        1e-12,
    );
    let cramped = [at(&shelf, DVec3::ZERO), ceiling(0.09)];
    close(
        (escape(&hand, &cramped) + DVec3::Y * 0.29).length(),
        0.0,
        1e-12,
    );
}

#[test]
fn one_pair_escapes_by_its_penetration_depth() {
    let mut noise = Noise(17);
    for _ in 0..50 {
        let (a, b) = (
            noise.hull(12, DVec3::splat(0.1), 0.0),
            noise.hull(9, DVec3::splat(0.1), 0.0),
        );
        let (a, b) = (noise.place(&a, 0.05), noise.place(&b, 0.05));
        let answer = escape(&[a], &[b]);
        close(
            answer.length(),
            (-signed_distance(&a, &b).value).max(0.0),
            1e-12,
        );
    }
}

/// The least of all crossings of one, two and three facet planes that lie outside every box.
fn by_every_crossing(a: &[Placed], b: &[Placed]) -> f64 {
    let mut boxes: Vec<[DVec3; 2]> = Vec::new();
    for p in a {
        for q in b {
            let ([low_a, high_a], [low_b, high_b]) = (p.bounds(), q.bounds());
            boxes.push([low_b - high_a, high_b - low_a]);
        }
    }
    let choices = |axis: usize| -> Vec<f64> {
        let planes = boxes.iter().flat_map(|[low, high]| [low[axis], high[axis]]);
        planes.chain([0.0]).collect()
    };
    let mut least = f64::INFINITY;
    for &x in &choices(0) {
        for &y in &choices(1) {
            for &z in &choices(2) {
                let t = DVec3::new(x, y, z);
                let free = |[low, high]: &[DVec3; 2]| {
                    (t.cmple(*low + 1e-12) | t.cmpge(*high - 1e-12)).any()
                };
                if t.length() < least && boxes.iter().all(free) {
                    least = t.length();
                }
            }
        }
    }
    least
}

#[test]
fn unions_of_boxes_match_all_plane_crossings() {
    let mut noise = Noise(19);
    for _ in 0..40 {
        let solids: Vec<Solid> = (0..5)
            .map(|_| block(DVec3::splat(0.12) + noise.vector() * 0.05))
            .collect();
        let placed: Vec<Placed> = solids.iter().map(|s| at(s, noise.vector() * 0.2)).collect();
        let answer = escape(&placed[..2], &placed[2..]);
        close(
            answer.length(),
            by_every_crossing(&placed[..2], &placed[2..]),
            1e-12,
        );
    }
}

#[test]
fn rounded_unions_are_refused() {
    let sphere = Solid::new(&[DVec3::ZERO], FRAC_1_SQRT_2).unwrap();
    let refused = union_escape(&[at(&sphere, DVec3::ZERO)], &[at(&cube(), DVec3::ZERO)]);
    assert_eq!(refused, Err(EscapeError::Rounded));
}
