//! Forces among surfaces that jam: contacts that stay as they are take kinetic energy, computed here in f64, and give
//! none, whether the solver comes to an end or not.

use glam::{DMat3, DVec3, Mat3, Vec3};
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

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * 0.5 * (self.next() + 1.0)
    }
}

fn movable(noise: &mut Noise, mass: f32, inertia: f32) -> Mover {
    Mover {
        velocity: noise.vector(),
        spin: 5.0 * noise.vector(),
        inverse_mass: 1.0 / mass,
        inverse_inertia: Mat3::from_diagonal(Vec3::splat(1.0 / inertia)),
    }
}

/// What stands still, a few light bodies, and a heavy one that runs into the last of them.
fn movers(noise: &mut Noise) -> Vec<Mover> {
    let count = 2 + (noise.next().abs() * 3.0) as usize;
    let mut movers = vec![Mover::default()];
    for _ in 0..count {
        let mass = noise.between(0.02, 0.5);
        movers.push(movable(noise, mass, 0.4 * mass * 0.04 * 0.04));
    }
    movers.push(Mover {
        velocity: 3.0 * noise.vector(),
        spin: Vec3::ZERO,
        ..movable(noise, 2.0, 1.0)
    });
    movers
}

fn row(noise: &mut Noise, a: usize, b: usize, along: Vec3) -> Row {
    let normal = (along + noise.vector()).normalize();
    let arm = |noise: &mut Noise, out: Vec3| 0.04 * (out + 0.7 * noise.vector()).normalize();
    let mut row = Row::default();
    (row.body_a, row.body_b) = (a as u32, b as u32);
    row.normal = normal;
    row.arm_a = arm(noise, -normal);
    if b > 0 {
        row.arm_b = arm(noise, normal);
    }
    row.friction = noise.between(0.4, 1.2);
    row.bounce = f32::INFINITY;
    // What it remembers of an earlier stretch: mostly nothing.
    let remembered = 20.0 * noise.between(-3.0, 1.0).max(0.0);
    row.impulse = remembered * (normal + 0.3 * noise.vector().cross(normal));
    row
}

/// A chain of contacts from what stands still to the heavy body, and walls beside some.
fn rows(noise: &mut Noise, count: usize) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for a in 1..count {
        rows.push(row(noise, a, 0, Vec3::Y));
        if a + 1 < count {
            rows.push(row(noise, a, a + 1, -Vec3::Y));
        }
    }
    for (index, row) in rows.iter_mut().enumerate() {
        row.manifold = index as u32;
    }
    rows
}

/// Kinetic energy in joules, in f64.
fn energy_j(movers: &[Mover]) -> f64 {
    let own = |mover: &Mover| {
        if mover.inverse_mass == 0.0 {
            return 0.0;
        }
        let spin = mover.spin.as_dvec3();
        let inertia: DMat3 = mover.inverse_inertia.as_dmat3().inverse();
        let velocity: DVec3 = mover.velocity.as_dvec3();
        0.5 * (velocity.length_squared() / f64::from(mover.inverse_mass) + spin.dot(inertia * spin))
    };
    movers.iter().map(own).sum()
}

#[test]
fn forces_among_jammed_bodies_feed_no_energy_in() {
    let mut unsolved = 0;
    for seed in 0..20_000 {
        let mut noise = Noise(seed);
        let mut movers = movers(&mut noise);
        let mut rows = rows(&mut noise, movers.len());
        let before = energy_j(&movers);
        let (mut first, mut queue) = (vec![0; movers.len()], vec![0; rows.len()]);
        let mut problem = Problem {
            movers: &mut movers,
            rows: &mut rows,
            first: &mut first,
            queue: &mut queue,
            order: Order::Conjugate,
            tolerance: 1e-4,
        };
        problem.prepare();
        problem.warm_start();
        problem.settle(u32::MAX);
        unsolved += u32::from(problem.worst_approach(|_| true) > 1e-2);
        let after = energy_j(&movers);
        assert!(
            after <= before * 1.001,
            "seed {seed}: {before} J became {after} J"
        );
    }
    assert!(unsolved > 20, "only {unsolved} of them jammed");
}
