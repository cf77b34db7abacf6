//! What is pressed from two sides and could be held by friction is held: the solver comes to its end there.

use glam::{Mat3, Vec3};
use palpable::impulses::solver::{Order, Problem};
use palpable::state::rows::{Mover, Row};

/// Numbers in -1..1 from a seed.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 8_388_608.0 - 1.0
    }
}

const MASS_KG: f32 = 0.2;
const HALF_M: f32 = 0.03;
const TOLERANCE: f32 = 5e-5;

/// A box that a frame's gravity and a little turning set in motion.
fn held_box(noise: &mut Noise) -> Mover {
    let edge = 2.0 * HALF_M;
    Mover {
        velocity: Vec3::new(0.0, -9.81 / 90.0, 0.0),
        spin: 0.1 * Vec3::new(noise.next(), noise.next(), noise.next()),
        inverse_mass: 1.0 / MASS_KG,
        inverse_inertia: Mat3::from_diagonal(Vec3::splat(6.0 / (MASS_KG * edge * edge))),
    }
}

/// Three contacts on either side, opposite to each other, each pressed by so much that all together would hold ten
/// such boxes.
fn pressed_rows(noise: &mut Noise) -> Vec<Row> {
    let weight = MASS_KG * 9.81 / 90.0;
    let mut rows = Vec::new();
    for _ in 0..3 {
        let mut row = Row::default();
        row.body_a = 1;
        row.normal = Vec3::new(-1.0, 0.05 * noise.next(), 0.05 * noise.next()).normalize();
        row.arm_a = HALF_M * Vec3::new(1.0, noise.next(), noise.next());
        row.friction = 0.5;
        row.least = 10.0 * weight / (6.0 * 0.5);
        rows.push(row);
    }
    for index in 0..3 {
        let mut row = rows[index];
        row.normal = -row.normal;
        // Where the line along the normal leaves the box on the other side.
        row.arm_a -= row.normal * (2.0 * HALF_M / row.normal.x);
        row.manifold = 3;
        rows.push(row);
    }
    rows
}

#[test]
fn what_is_pressed_enough_does_not_slip() {
    let (mut slipping, mut contacts) = (0, 0);
    for seed in 0..2000 {
        let mut noise = Noise(seed);
        let mut movers = vec![Mover::default(), held_box(&mut noise)];
        let mut rows = pressed_rows(&mut noise);
        let (mut first, mut queue) = (vec![0; movers.len()], vec![0; rows.len()]);
        let mut problem = Problem {
            movers: &mut movers,
            rows: &mut rows,
            first: &mut first,
            queue: &mut queue,
            order: Order::Conjugate,
            tolerance: TOLERANCE,
        };
        problem.prepare();
        problem.settle(u32::MAX);
        for row in &rows {
            let push = row.impulse.dot(row.normal);
            let held = (row.impulse - row.normal * push).length();
            assert!(push >= row.least * 0.9999, "seed {seed}: let go");
            assert!(held <= row.friction * push * 1.0001, "seed {seed}: pulled");
            let velocity = movers[1].velocity_at(row.arm_a);
            let slip = (velocity - row.normal * velocity.dot(row.normal)).length();
            // Without friction it would fall at 0.1 m/s.
            assert!(slip < 6e-3, "seed {seed}: slips at {slip} m/s");
            slipping += u32::from(slip > 1e-3);
            contacts += 1;
        }
    }
    assert!(slipping * 300 < contacts, "{slipping} of {contacts} slip");
}
