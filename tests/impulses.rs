//! Loose bodies: falling, resting, sliding, being pushed, and never passing through anything.
//! Every distance is judged from poses and the shapes' own sizes, in f64.

mod common;
#[path = "common/loose.rs"]
mod loose;

use common::{Block, add_box};
use glam::Vec3;
use loose::{ball, floor, lowest_corner, position, surface};
use palpable::frame::FrameInput;
use palpable::limits::{LOOSE_BAND_M, LOOSE_REST_M};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::BodyKind;
use palpable::state::rows::Mover;
use palpable::world::World;

const FRAME_S: f32 = 1.0 / 60.0;

/// How deep a loose body may overlap anything: promise P1.
const LOOSE_OVERLAP_M: f64 = 1e-3;

fn step(world: &mut World) {
    world.step(&FrameInput::unlimited(FRAME_S));
}

/// Distance of two points.
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Distance of a point outside a box from it.
fn outside_box(pose: &Pose, half: [f32; 3], point: [f64; 3]) -> f64 {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    let rows = [
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
    ];
    let mut outside = [0.0; 3];
    for axis in 0..3 {
        let along: f64 = (0..3)
            .map(|i| rows[i][axis] * (point[i] - f64::from(pose.position[i])))
            .sum();
        outside[axis] = (along.abs() - f64::from(half[axis])).max(0.0);
    }
    distance(outside, [0.0; 3])
}

#[test]
fn a_sphere_dropped_from_a_metre_comes_to_rest_on_the_floor() {
    // HARD_CASES: at rest after 0.838544 s (e = .3), 1.354571 s (.5). Restitution ends below 2 g h =
    // 0.33 m/s, so rest comes earlier than the endless series; later only by the rest gap's settling.
    for (restitution, rest_s) in [(0.3, 0.838_544), (0.5, 1.354_571)] {
        let mut block = Block::new(&Capacities::ROOM);
        let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
        surface(&mut world, restitution, 0.3);
        floor(&mut world);
        let sphere = ball(&mut world, BodyKind::Dynamic, [0.0, 1.1, 0.0], 0.1);
        let (mut moving_until, mut last) = (0.0, position(&world, sphere));
        for frame in 1..=180 {
            step(&mut world);
            let now = position(&world, sphere);
            assert!(now[1] - 0.1 > 0.0, "frame {frame}: {}", now[1] - 0.1);
            // Below 3 mm/s counts as rest.
            if distance(now, last) > 5e-5 {
                moving_until = f64::from(frame) / 60.0;
            }
            last = now;
        }
        assert!(moving_until > 0.45, "the fall alone takes 0.4515 s");
        assert!(
            moving_until < rest_s + 0.1,
            "e = {restitution}: rest after {moving_until} s"
        );
        // Contacts count as closed within a band above the rest gap.
        let gap = last[1] - 0.1;
        assert!(gap <= f64::from(LOOSE_REST_M + LOOSE_BAND_M), "{gap}");
    }
}

#[test]
fn a_bounce_returns_the_right_height() {
    // e = 0.8 from 1 m: back up to 0.64 m. Rounding of times to events costs little; 3 % is what
    // one frame's gravity kick (0.16 of 4.43 m/s) may change in v at worst, halved by its mean.
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    surface(&mut world, 0.8, 0.0);
    floor(&mut world);
    let sphere = ball(&mut world, BodyKind::Dynamic, [0.0, 1.1, 0.0], 0.1);
    let (mut bounced, mut highest) = (false, 0.0_f64);
    for _ in 0..55 {
        let before = position(&world, sphere)[1];
        step(&mut world);
        let now = position(&world, sphere)[1];
        bounced |= now > before;
        if bounced {
            highest = highest.max(now - 0.1);
        }
    }
    assert!((highest / 0.64 - 1.0).abs() < 0.06, "back up to {highest}");
}

#[test]
fn a_box_dropped_flat_rests_on_four_contacts_and_sleeps() {
    let half = [0.1, 0.05, 0.08];
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let crate_body = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.25, 0.0),
        half,
    );
    let mut corners = 0;
    for frame in 0..120 {
        step(&mut world);
        let pose = world.pose(crate_body).unwrap();
        let gap = lowest_corner(&pose, half);
        assert!(gap > 0.0, "frame {frame}: {gap}");
        let mut points: Vec<[f32; 3]> = world.contacts().iter().map(|c| c.point).collect();
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points.dedup_by(|a, b| distance(a.map(f64::from), b.map(f64::from)) < 0.02);
        corners = corners.max(points.len());
    }
    assert_eq!(corners, 4, "under each corner one");
    let pose = world.pose(crate_body).unwrap();
    assert!(lowest_corner(&pose, half) <= f64::from(LOOSE_REST_M) + 1e-5);
    // Flat: no corner of the underside is higher than twice the rest gap, so the tilt is unseen.
    let highest = 2.0 * f64::from(pose.position[1]) - lowest_corner(&pose, half) - 0.1;
    assert!(highest <= 2.0 * f64::from(LOOSE_REST_M), "{highest}");
    assert!(pose.position[0].abs() < 1e-3 && pose.position[2].abs() < 1e-3);

    // Asleep.
    let hash = world.hash();
    for _ in 0..300 {
        step(&mut world);
        assert_eq!(world.hash(), hash);
        assert_eq!(world.pose(crate_body).unwrap(), pose);
        assert_eq!(world.velocity(crate_body).unwrap(), ([0.0; 3], [0.0; 3]));
    }
    let impulses = world.step(&FrameInput::unlimited(FRAME_S)).impulses;
    assert_eq!(impulses, 0);
}

#[test]
fn a_ball_is_pushed_over_the_floor_without_lag() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = ball(&mut world, BodyKind::Driven, [-0.3, 0.1, 0.0], 0.05);
    let pushed = ball(&mut world, BodyKind::Dynamic, [0.0, 0.1003, 0.0], 0.1);
    for frame in 0..240 {
        let target = Pose::at(-0.3 + 0.5 * frame as f32 / 60.0, 0.1, 0.0);
        world.set_target(hand, &target).unwrap();
        step(&mut world);
        assert_eq!(world.pose(hand).unwrap(), target, "frame {frame}");
        let (a, b) = (position(&world, hand), position(&world, pushed));
        let gap = distance(a, b) - 0.15;
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: {gap}");
        let gap = b[1] - 0.1;
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: floor {gap}");
    }
    let end = position(&world, pushed);
    assert!(end[0] > -0.3 + 0.5 * 239.0 / 60.0, "{end:?}");
}

/// A plate that leans over a ball meets it in the middle of a frame. With the floor it makes a wedge of 58
/// degrees; a ball is jammed by friction of 0.5 below 2 atan 0.5 = 53 degrees, and goes ahead above that.
#[test]
fn a_ball_that_is_almost_jammed_is_pushed_without_lag() {
    const RADIUS_M: f64 = 0.06;
    const THICK_M: f64 = 0.01;
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    surface(&mut world, 0.0, 0.5);
    floor(&mut world);
    let pushed = ball(&mut world, BodyKind::Dynamic, [0.0, 0.06002, 0.0], 0.06);
    // The face that leads points to -Z and down by 32 degrees.
    let lean = 32.0_f64.to_radians();
    let (down, ahead) = lean.sin_cos();
    let turn = [
        -(0.5 * lean).sin() as f32,
        0.0,
        0.0,
        (0.5 * lean).cos() as f32,
    ];
    let at = |z: f32| Pose {
        rotation: turn,
        position: [0.0, 0.12, z],
    };
    let plate = add_box(
        &mut world,
        BodyKind::Driven,
        at(0.2),
        [0.3, 0.06, THICK_M as f32],
    );
    for frame in 0..60 {
        let target = at(0.2 - 2.0 * frame as f32 / 60.0);
        world.set_target(plate, &target).unwrap();
        step(&mut world);
        let (hand, met) = (position(&world, plate), position(&world, pushed));
        assert_eq!(hand, target.position.map(f64::from), "frame {frame}");
        let gap = (hand[1] - met[1]) * down + (hand[2] - met[2]) * ahead - THICK_M - RADIUS_M;
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: {gap}");
    }
    assert!(position(&world, pushed)[2] < -1.0);
}

#[test]
fn a_wedged_ball_stops_the_hand() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    // A wall 2 cm thick with its face at x = 0.5.
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.51, 1.0, 0.0),
        [0.01, 1.0, 5.0],
    );
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(-0.3, 0.1, 0.0),
        [0.05, 0.08, 0.3],
    );
    let wedged = ball(&mut world, BodyKind::Dynamic, [0.3, 0.1003, 0.0], 0.1);
    for frame in 0..240 {
        let x = (-0.3 + 0.5 * frame as f32 / 60.0).min(0.8);
        world.set_target(hand, &Pose::at(x, 0.1, 0.0)).unwrap();
        step(&mut world);
        let (h, b) = (position(&world, hand), position(&world, wedged));
        let gap = b[0] - 0.1 - (h[0] + 0.05);
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: hand {gap}");
        let gap = 0.5 - (b[0] + 0.1);
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: wall {gap}");
        let gap = b[1] - 0.1;
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: floor {gap}");
    }
    let (h, b) = (position(&world, hand), position(&world, wedged));
    assert!(h[0] + 0.05 < 0.5 - 0.2 + 2.0 * LOOSE_OVERLAP_M, "{h:?}");
    // Both gaps at rest are at most the rest gap and one shortest advance each.
    assert!(
        h[0] + 0.05 > 0.5 - 0.2 - 4.0 * f64::from(LOOSE_REST_M),
        "{h:?} {b:?}"
    );
}

#[test]
fn a_fast_ball_does_not_pass_a_thin_plate() {
    for speed in [5.0, 20.0, 50.0] {
        for offset in 0..10 {
            let mut block = Block::new(&Capacities::ROOM);
            let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
            add_box(
                &mut world,
                BodyKind::Fixed,
                Pose::at(2.0, 0.0, 0.0),
                [0.0005, 5.0, 5.0],
            );
            let start = -0.08 * offset as f32;
            let fast = ball(&mut world, BodyKind::Dynamic, [start, 0.0, 0.0], 0.02);
            world
                .set_velocity(fast, [speed, 0.0, 0.0], [0.0; 3])
                .unwrap();
            let mut returned = false;
            for frame in 0..60 {
                step(&mut world);
                let gap = 1.9995 - 0.02 - position(&world, fast)[0];
                assert!(gap > -1e-6, "{speed} m/s, frame {frame}: {gap}");
                let (v, _) = world.velocity(fast).unwrap();
                returned |= v[0] < 0.0;
            }
            assert!(returned, "{speed} m/s from {start}");
        }
    }
}

/// Kinetic energy of a solid ball of this mass and radius.
fn ball_energy(world: &World, body: BodyId, radius: f64) -> f64 {
    let (v, w) = world.velocity(body).unwrap();
    let square = |v: [f32; 3]| v.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
    let mass = f64::from(world.mass_kg(body).unwrap());
    0.5 * mass * (square(v) + 0.4 * radius * radius * square(w))
}

#[test]
fn no_impact_adds_energy() {
    // HARD_CASES: e = mu = 1, v = (0.1, -1), and other angles and spins.
    for velocity in [[0.1, -1.0, 0.0], [1.0, -1.0, 0.3], [3.0, -0.5, 0.0]] {
        for spin in [[0.0; 3], [0.0, 0.0, 30.0], [-20.0, 5.0, -10.0]] {
            let mut block = Block::new(&Capacities::ROOM);
            let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
            world.set_gravity([0.0; 3]);
            surface(&mut world, 1.0, 1.0);
            floor(&mut world);
            let sphere = ball(&mut world, BodyKind::Dynamic, [0.0, 0.15, 0.0], 0.1);
            world.set_velocity(sphere, velocity, spin).unwrap();
            let before = ball_energy(&world, sphere, 0.1);
            for frame in 0..30 {
                step(&mut world);
                let now = ball_energy(&world, sphere, 0.1);
                // A handful of f32 roundings in each of two velocities.
                assert!(
                    now <= before * (1.0 + 2e-6),
                    "{velocity:?} {spin:?}, frame {frame}: {before} J became {now} J"
                );
            }
            let (after, _) = world.velocity(sphere).unwrap();
            // e = 1: the normal velocity returns whole (1e-5 relative: f32 and the velocity's target).
            assert!((after[1] + velocity[1]).abs() < 1e-5, "{after:?}");
        }
    }
}

#[test]
fn momentum_is_kept_between_two_balls() {
    for (radius, offset) in [(0.1, 0.0), (0.1, 0.05), (0.02, 0.03)] {
        let mut block = Block::new(&Capacities::ROOM);
        let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
        world.set_gravity([0.0; 3]);
        surface(&mut world, 0.5, 0.3);
        let a = ball(&mut world, BodyKind::Dynamic, [-0.5, 0.0, 0.0], 0.1);
        let b = ball(&mut world, BodyKind::Dynamic, [0.0, offset, 0.0], radius);
        world.set_velocity(a, [2.0, 0.0, 0.0], [0.0; 3]).unwrap();
        let momentum = |world: &World| -> [f64; 3] {
            let mut sum = [0.0; 3];
            for body in [a, b] {
                let mass = f64::from(world.mass_kg(body).unwrap());
                let (v, _) = world.velocity(body).unwrap();
                for axis in 0..3 {
                    sum[axis] += mass * f64::from(v[axis]);
                }
            }
            sum
        };
        let before = momentum(&world);
        for frame in 0..60 {
            step(&mut world);
            // Each of at most a few impulses is rounded once for either body.
            let change = distance(momentum(&world), before);
            assert!(change < 1e-6 * before[0], "frame {frame}: {change}");
            let gap = distance(position(&world, a), position(&world, b)) - 0.1 - f64::from(radius);
            assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: {gap}");
        }
        let (v, _) = world.velocity(b).unwrap();
        assert!(v[0] > 0.5, "b was hit: {v:?}");
    }
}

#[test]
fn a_head_on_impact_has_newtons_velocities() {
    // Equal balls, e = 0.5: (1 - e) / 2 and (1 + e) / 2 of the speed. 0.1 % for the impulse's
    // direction, which is found at a gap of up to the loose margin.
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    world.set_gravity([0.0; 3]);
    surface(&mut world, 0.5, 0.3);
    let a = ball(&mut world, BodyKind::Dynamic, [-0.5, 0.0, 0.0], 0.1);
    let b = ball(&mut world, BodyKind::Dynamic, [0.0, 0.0, 0.0], 0.1);
    world.set_velocity(a, [2.0, 0.0, 0.0], [0.0; 3]).unwrap();
    for _ in 0..30 {
        step(&mut world);
    }
    let (va, vb) = (
        world.velocity(a).unwrap().0[0],
        world.velocity(b).unwrap().0[0],
    );
    assert!(
        (va - 0.5).abs() < 2e-3 && (vb - 1.5).abs() < 2e-3,
        "{va} {vb}"
    );
}

#[test]
fn what_impulses_do_not_move_they_do_not_turn() {
    let mut still = Mover::default();
    still.push(Vec3::X, Vec3::Y);
    assert_eq!((still.velocity, still.spin), (Vec3::ZERO, Vec3::ZERO));
}

#[test]
fn a_sleeping_box_wakes_when_the_floor_is_taken_away() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let ground = floor(&mut world);
    let sleeper = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.051, 0.0),
        [0.05; 3],
    );
    for _ in 0..120 {
        step(&mut world);
    }
    let rest = world.pose(sleeper).unwrap();
    step(&mut world);
    assert_eq!(world.pose(sleeper).unwrap(), rest);
    world.remove_body(ground).unwrap();
    for _ in 0..30 {
        step(&mut world);
    }
    // Half a second of free fall is 1.23 m; a frame more or less is 8 cm.
    let fallen = f64::from(rest.position[1]) - position(&world, sleeper)[1];
    assert!((fallen - 1.23).abs() < 0.1, "{fallen}");
}

#[test]
fn a_hand_that_touches_a_sleeping_ball_wakes_it() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = ball(&mut world, BodyKind::Driven, [-0.4, 0.1, 0.0], 0.05);
    let sleeper = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.101, 0.0),
        [0.1; 3],
    );
    for _ in 0..120 {
        step(&mut world);
    }
    let rest = position(&world, sleeper);
    for frame in 0..60 {
        let x = -0.4 + 0.5 * frame as f32 / 60.0;
        world.set_target(hand, &Pose::at(x, 0.1, 0.0)).unwrap();
        step(&mut world);
        let pose = world.pose(sleeper).unwrap();
        let gap = outside_box(&pose, [0.1; 3], position(&world, hand)) - 0.05;
        assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: {gap}");
    }
    // The hand ends 0.2417 m into where the box was; the box may turn a little on its way.
    let moved = position(&world, sleeper)[0] - rest[0];
    assert!(moved > 0.23, "{moved}");
}

#[test]
fn a_stack_of_boxes_stands_and_sleeps() {
    let half = [0.05; 3];
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let stack = [0.051, 0.152, 0.253]
        .map(|y| add_box(&mut world, BodyKind::Dynamic, Pose::at(0.0, y, 0.0), half));
    for frame in 0..240 {
        step(&mut world);
        let heights = stack.map(|body| position(&world, body)[1]);
        let gaps = [
            heights[0] - 0.05,
            heights[1] - heights[0] - 0.1,
            heights[2] - heights[1] - 0.1,
        ];
        for gap in gaps {
            assert!(gap > -LOOSE_OVERLAP_M, "frame {frame}: {gaps:?}");
        }
    }
    let poses = stack.map(|body| world.pose(body).unwrap());
    for pose in &poses {
        assert!(
            pose.position[0].abs() < 1e-3 && pose.position[2].abs() < 1e-3,
            "{poses:?}"
        );
    }
    for _ in 0..60 {
        step(&mut world);
        assert_eq!(stack.map(|body| world.pose(body).unwrap()), poses);
    }
}

/// A kilometre from the origin f32 has a grid of 0.06 mm, and each of a frame's events rounds where a body is.
#[test]
fn rounding_at_a_frames_events_does_not_add_up() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    world.set_gravity([0.0; 3]);
    surface(&mut world, 1.0, 0.0);
    let at = |x: f32, y: f32| Pose::at(-640.0 + x, 508.0 + y, 772.0);
    for side in [-1.0, 1.0] {
        add_box(&mut world, BodyKind::Fixed, at(0.03 * side, 0.0), [0.01; 3]);
    }
    let rattling = ball(&mut world, BodyKind::Dynamic, [-640.0, 508.0, 772.0], 0.01);
    world
        .set_velocity(rattling, [25.0, 0.0, 0.0], [0.0; 3])
        .unwrap();
    let drifting = add_box(&mut world, BodyKind::Dynamic, at(0.0, 0.1), [0.02; 3]);
    let velocity = [0.047_f32, 0.031, 0.019];
    world.set_velocity(drifting, velocity, [0.0; 3]).unwrap();
    let spacing = f64::from(f32::EPSILON) * 512.0;
    for frame in 0..10 {
        let before = position(&world, drifting);
        let report = world.step(&FrameInput::unlimited(FRAME_S));
        let after = position(&world, drifting);
        assert!(
            report.impulses > 10,
            "frame {frame}: {} impulses",
            report.impulses
        );
        for axis in 0..3 {
            let way = f64::from(velocity[axis]) * f64::from(FRAME_S);
            let off = (after[axis] - before[axis] - way).abs() / spacing;
            assert!(
                off < 1.01,
                "frame {frame}: off by {off} spacings along {axis}"
            );
        }
    }
}
