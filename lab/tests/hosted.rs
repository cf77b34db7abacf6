//! rapier3d as the host's engine beside the kernel: its bodies are pushed, carried, thrown and squeezed by
//! hands of the kernel, and both agree on where they are.

mod host;

use glam::DVec3;
use host::{FRAME_S, Form, Host, OVERLAP_M, TABLE_M, Takes, block, place};
use palpable::math::Pose;

/// Frames of a second.
const SECOND: u32 = 90;

/// A palm that stands on its edge: its thin side along x.
const UPRIGHT: [f32; 3] = [0.01, 0.05, 0.06];

/// An open palm.
const OPEN: [f32; 3] = [0.06, 0.01, 0.08];

const CUBE: [f32; 3] = [0.05; 3];

/// How far a hand may be from its tracker where nothing is in its way, in metres: some roundings of f32.
const FREE_M: f64 = 1e-6;

fn seconds(frame: u32) -> f32 {
    frame as f32 * FRAME_S
}

/// From 0 to 1 in `duration` seconds, at rest at both ends, at most 1.5 / duration a second.
fn eased(time: f32, duration: f32) -> f32 {
    let share = (time / duration).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Asserts that a palm and a body overlap by no more than they may.
fn assert_apart(host: &Host, frame: u32, palm: usize, loose: usize) {
    let gap = host.gap_m(palm, loose);
    assert!(
        gap >= -OVERLAP_M,
        "frame {frame}: palm {palm} overlaps by {:.3} mm, body at {:?} with {:?} m/s, palm at {:?}",
        -1e3 * gap,
        place(&host.pose(loose)),
        host.velocity(loose),
        place(&host.palm(palm)),
    );
}

/// Pushes something along x for two seconds at 0.3 m/s, moving up and down by 5 mm on the way; how far the
/// body went, and its gap to the palm at the end, in metres.
fn push(form: Form, half: f32) -> (f64, f64) {
    let mut memory = block();
    let mut host = Host::new(&mut memory, Takes::Impulse);
    let at = Pose::at(0.0, TABLE_M + half + 0.0005, 0.0);
    let body = host.add_loose(form, 0.3, at);
    let start = [-0.12, TABLE_M + 0.07, 0.0];
    let palm = host.add_palm(UPRIGHT, Pose::at(start[0], start[1], start[2]));
    for frame in 1..=2 * SECOND {
        let time = seconds(frame);
        let up = 0.005 * (6.0 * time).sin();
        let target = Pose::at(start[0] + 0.3 * time, start[1] + up, start[2]);
        host.track(palm, &target);
        host.step();
        assert_apart(&host, frame, palm, body);
        let off = place(&host.palm(palm)) - place(&target);
        // What is free on a table is pushed without lag, and nothing holds the hand along its face.
        assert!(
            off.length() <= FREE_M,
            "frame {frame}: the hand is off by {off:?}, body at {:?}, gap {:.3} mm",
            place(&host.pose(body)),
            1e3 * host.gap_m(palm, body)
        );
    }
    let moved = place(&host.pose(body)).x;
    (moved, host.gap_m(palm, body))
}

#[test]
fn a_hand_pushes_a_ball_of_the_engine_over_a_table() {
    let (moved, _) = push(Form::Ball(0.05), 0.05);
    // The palm's face ends 0.49 m from where the ball's centre was, the ball 0.05 m ahead or rolling on.
    assert!(moved >= 0.539 - OVERLAP_M, "{moved}");
}

#[test]
fn a_hand_pushes_a_box_of_the_engine_over_a_table() {
    let (moved, gap) = push(Form::Box(CUBE), CUBE[1]);
    assert!(moved >= 0.539 - OVERLAP_M, "{moved}");
    // Friction stops what is not pushed: it stays on the palm.
    assert!(gap < 2e-3, "{gap}");
}

/// Where a body is on a palm.
fn on_palm(host: &Host, palm: usize, body: usize) -> DVec3 {
    place(&host.pose(body)) - place(&host.palm(palm))
}

#[test]
fn a_box_of_the_engine_is_lifted_and_carried() {
    let mut memory = block();
    let mut host = Host::new(&mut memory, Takes::Impulse);
    let start = [0.0, TABLE_M + 0.02, 0.0];
    let palm = host.add_palm(OPEN, Pose::at(start[0], start[1], start[2]));
    let at = Pose::at(0.0, start[1] + 0.01 + 0.05 + 0.001, 0.0);
    let body = host.add_loose(Form::Box(CUBE), 0.5, at);
    let mut before = DVec3::ZERO;
    for frame in 1..=4 * SECOND {
        let time = seconds(frame);
        let (up, aside) = (0.3 * eased(time - 0.5, 1.0), 0.3 * eased(time - 1.8, 1.2));
        let target = Pose::at(start[0] + aside, start[1] + up, start[2]);
        host.track(palm, &target);
        host.step();
        assert_apart(&host, frame, palm, body);
        let off = (place(&host.palm(palm)) - place(&target)).length();
        assert!(off <= FREE_M, "frame {frame}: the hand is off by {off}");
        if frame == SECOND / 2 {
            before = on_palm(&host, palm, body);
        }
        let gap = host.gap_m(palm, body);
        assert!(gap < 2e-3, "frame {frame}: {gap} above the palm");
    }
    // Friction of 0.5 holds 4.9 m/s2; the way aside takes 1.3.
    let slid = (on_palm(&host, palm, body) - before).length();
    assert!(slid < 2e-3, "slid by {slid}");
}

/// Steps a palm that moves at `speed` from `start` for half a second, speeding up in the first quarter, and
/// then stops; the body's velocity two frames later, in m/s.
fn throw(host: &mut Host, [palm, body]: [usize; 2], start: DVec3, speed: DVec3) -> DVec3 {
    let quarter = 0.25_f64;
    for frame in 1..=SECOND / 2 + 2 {
        let time = f64::from(seconds(frame)).min(0.5);
        let way = if time < quarter {
            0.5 * time * time / quarter
        } else {
            0.5 * quarter + time - quarter
        };
        let to = (start + speed * way).as_vec3();
        host.track(palm, &Pose::at(to.x, to.y, to.z));
        host.step();
        assert_apart(host, frame, palm, body);
    }
    println!(
        "{:?} m/s, {:.3} mm",
        host.velocity(body),
        1e3 * host.gap_m(palm, body)
    );
    host.velocity(body)
}

#[test]
fn a_box_of_the_engine_is_thrown_upwards() {
    let mut memory = block();
    let mut host = Host::new(&mut memory, Takes::Impulse);
    let start = DVec3::new(0.0, 1.0, 0.0);
    let palm = host.add_palm(OPEN, Pose::at(0.0, 1.0, 0.0));
    let at = Pose::at(0.0, 1.0 + 0.01 + 0.05 + 0.0003, 0.0);
    let body = host.add_loose(Form::Box(CUBE), 0.5, at);
    let left = throw(&mut host, [palm, body], start, DVec3::new(0.0, 2.0, 0.0));
    // Two frames of free fall.
    let fallen = 2.0 * f64::from(FRAME_S) * 9.81;
    assert!((left.y + fallen - 2.0).abs() <= 0.2, "{left:?}");
    for _ in 0..SECOND / 6 {
        host.step();
    }
    assert!(host.gap_m(palm, body) > 0.1, "it left the palm");
}

#[test]
fn a_ball_of_the_engine_is_thrown_along_the_table() {
    let mut memory = block();
    let mut host = Host::new(&mut memory, Takes::Impulse);
    let start = DVec3::new(-0.062, f64::from(TABLE_M) + 0.07, 0.0);
    let palm = host.add_palm(UPRIGHT, Pose::at(-0.062, TABLE_M + 0.07, 0.0));
    let at = Pose::at(0.0, TABLE_M + 0.05, 0.0);
    let body = host.add_loose(Form::Ball(0.05), 0.3, at);
    let left = throw(&mut host, [palm, body], start, DVec3::new(1.5, 0.0, 0.0));
    assert!((left.x - 1.5).abs() <= 0.15, "{left:?}");
}

#[test]
fn a_box_of_the_engine_rests_on_a_still_palm() {
    let mut memory = block();
    let mut host = Host::new(&mut memory, Takes::Impulse);
    let rest = Pose::at(0.0, 1.0, 0.0);
    let palm = host.add_palm(OPEN, rest);
    let at = Pose::at(0.0, 1.0 + 0.01 + 0.05 + 0.001, 0.0);
    let body = host.add_loose(Form::Box(CUBE), 0.5, at);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for frame in 1..=3 * SECOND {
        host.track(palm, &rest);
        host.step();
        assert_apart(&host, frame, palm, body);
        if frame > SECOND {
            assert_eq!(host.palm(palm), rest, "frame {frame}");
            let at = place(&host.pose(body));
            (low, high) = (low.min(at), high.max(at));
        }
    }
    let jitter = high - low;
    assert!(jitter.max_element() < 1e-4, "{jitter:?}");
    assert!(host.gap_m(palm, body) < 2e-3);
}

#[test]
fn a_squeezed_box_of_the_engine_keeps_to_the_way_that_the_kernel_foresaw() {
    squeeze_and_carry();
}

/// Two palms squeeze a box by 10 mm at each side and lift it by 0.2 m.
fn squeeze_and_carry() {
    let mut memory = block();
    let mut host = Host::new(&mut memory, Takes::Way);
    let height = TABLE_M + 0.05;
    let body = host.add_loose(Form::Box(CUBE), 0.5, Pose::at(0.0, height, 0.0));
    // Faces 20 mm from the box.
    let start = 0.05 + 0.01 + 0.02;
    let palms = [-1.0, 1.0].map(|side| {
        let pose = Pose::at(side * start, height + 0.02, 0.0);
        (side, host.add_palm(UPRIGHT, pose))
    });
    let mut before = 0.0;
    for frame in 1..=4 * SECOND {
        let time = seconds(frame);
        // 10 mm into each side.
        let x = start - 0.03 * eased(time, 0.7);
        let up = 0.2 * eased(time - 1.2, 1.2);
        for (side, palm) in palms {
            host.track(palm, &Pose::at(side * x, height + 0.02 + up, 0.0));
        }
        host.step();
        for (_, palm) in palms {
            assert_apart(&host, frame, palm, body);
        }
        if frame == SECOND {
            before = place(&host.pose(body)).y;
        }
        if time > 1.0 {
            let gaps = palms.map(|(_, palm)| host.gap_m(palm, body));
            let at = place(&host.pose(body));
            let lag = before + f64::from(up) - at.y;
            let told = format!("frame {frame}: gaps {gaps:?}, body at {at:?}, {lag} below");
            assert!(gaps.iter().all(|&gap| gap < 1e-3), "{told}");
            // The springs hold it sideways for as long as both palms are kept from their targets.
            assert!(lag.abs() < 5e-3 && at.x.abs() < 0.01, "{told}");
        }
    }
}
