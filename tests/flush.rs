//! In a thread that puts small numbers to zero the report says so, and all promises but that of equal bits
//! hold.
#![cfg(target_arch = "x86_64")]

mod common;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/watched.rs"]
mod watched;

use std::arch::asm;

use common::{Block, add_box, add_piece};
use palpable::frame::{FrameInput, FrameReport};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};
use scenes::FRAME_S;

/// Bits of MXCSR: flush results to zero, take operands as zero.
const FLUSH_RESULTS: u32 = 1 << 15;
const FLUSH_OPERANDS: u32 = 1 << 6;

fn read() -> u32 {
    let mut value = 0_u32;
    // SAFETY: stores four bytes where there are four.
    unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack)) };
    value
}

fn write(value: u32) {
    // SAFETY: what was read before, with two bits that trap nothing.
    unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack)) };
}

/// Puts the thread's own environment back, also when a test fails.
struct Flushing(u32);

impl Flushing {
    fn on(bits: u32) -> Self {
        let before = read();
        write(before | bits);
        Self(before)
    }
}

impl Drop for Flushing {
    fn drop(&mut self) {
        write(self.0);
    }
}

#[test]
fn the_report_says_whether_the_thread_flushes() {
    let flag = || scenes::falling_sphere().step().flags & FrameReport::FLUSHES_TO_ZERO;
    assert_eq!(flag(), 0);
    for bits in [
        FLUSH_RESULTS,
        FLUSH_OPERANDS,
        FLUSH_RESULTS | FLUSH_OPERANDS,
    ] {
        let _restored = Flushing::on(bits);
        assert_ne!(flag(), 0, "{bits:x}");
    }
    assert_eq!(flag(), 0);
}

#[test]
fn a_hand_that_slides_over_a_table_stays_clear() {
    const RADIUS_M: f32 = 0.05;
    let _restored = Flushing::on(FLUSH_RESULTS | FLUSH_OPERANDS);
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let table = Pose::at(0.0, -0.5, 0.0);
    add_box(&mut world, BodyKind::Fixed, table, [2.0, 0.5, 2.0]);
    let hand = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::at(-0.5, 0.2, 0.0)))
        .unwrap();
    add_piece(&mut world, hand, &PieceDef::new(Shape::Point, RADIUS_M));
    for frame in 0..300 {
        let x = -0.5 + 0.004 * frame.min(200) as f32;
        world.set_target(hand, &Pose::at(x, -0.1, 0.0)).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let [at_x, at_y, _] = world.pose(hand).unwrap().position.map(f64::from);
        let gap = at_y - f64::from(RADIUS_M);
        assert!(gap > -1e-4, "frame {frame}: {gap} m into the table");
        assert!(
            (at_x - f64::from(x)).abs() < 0.2,
            "frame {frame}: at {at_x}"
        );
    }
    // Still trackers, still bodies: not by one bit.
    let hash = world.hash();
    world.set_target(hand, &Pose::at(0.3, -0.1, 0.0)).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    assert_eq!(world.hash(), hash);
}

#[test]
fn every_scene_stays_finite_and_near() {
    let _restored = Flushing::on(FLUSH_RESULTS | FLUSH_OPERANDS);
    for (name, make) in watched::ALL {
        let kept = {
            let _as_usual = Flushing(read());
            write(read() & !(FLUSH_RESULTS | FLUSH_OPERANDS));
            make().after(60)
        };
        let flushed = make().after(60);
        let [a, b] = [&kept, &flushed].map(|scene| scene.world.pose(scene.shown).unwrap().position);
        let away: f32 = (0..3).map(|axis| (a[axis] - b[axis]).abs()).sum();
        assert!(away < 0.02, "{name}: {away} m from where it is otherwise");
        let poses = flushed.after(180);
        let pose = poses.world.pose(poses.shown).unwrap();
        assert!(pose.position.iter().all(|x| x.is_finite()), "{name}");
        assert!(pose.rotation.iter().all(|x| x.is_finite()), "{name}");
    }
}
