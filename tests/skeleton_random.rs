//! Random skeletons among random things, with leaping trackers and random budgets: what must hold in every
//! frame, whatever happens.

mod common;

use common::{Block, add_box};
use glam::{Quat, Vec3};
use palpable::frame::{Budget, FrameInput};
use palpable::geometry::chain::{Ball, Hinge, JointDef};
use palpable::geometry::reach_cone::ReachCone;
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

#[path = "common/shapes.rs"]
mod shapes;

use shapes::Random;

const CAPACITIES: Capacities = Capacities {
    pairs: 4096,
    joints: 128,
    ..Capacities::ROOM
};

fn pose(random: &mut Random, reach_m: f64) -> Pose {
    let turn = random.unit().as_vec3() * random.between(0.0, 3.0) as f32;
    let at = random.unit().as_vec3() * random.between(0.0, reach_m) as f32;
    Pose::new(Quat::from_scaled_axis(turn), at)
}

fn hinge(random: &mut Random, at: Vec3) -> JointDef {
    let middle = random.between(-0.5, 0.5);
    let half = random.between(0.1, 1.5);
    JointDef::Hinge(Hinge {
        rest: Pose::new(pose(random, 0.0).quat(), at),
        axis: random.unit().as_vec3(),
        low_rad: (middle - half) as f32,
        high_rad: (middle + half) as f32,
    })
}

/// A ball with a star-shaped cone about its limb.
fn ball(random: &mut Random, at: Vec3) -> JointDef {
    let count = 3 + (random.bits() % 8) as usize;
    let corners: Vec<Vec3> = (0..count)
        .map(|i| {
            let turn = (i as f32 + 0.4 * random.between(0.0, 1.0) as f32) / count as f32;
            let (s, c) = (turn * core::f32::consts::TAU).sin_cos();
            let wide = random.between(0.3, 1.4) as f32;
            Vec3::new(wide.sin() * c, wide.sin() * s, wide.cos())
        })
        .collect();
    match ReachCone::new(Vec3::Z, &corners) {
        Ok(cone) => JointDef::Ball {
            rest: Pose::new(pose(random, 0.0).quat(), at),
            twist_low_rad: -0.8,
            twist_high_rad: 0.9,
            cone,
        },
        Err(_) => hinge(random, at),
    }
}

struct Figure {
    body: BodyId,
    chains: Vec<(ChainId, Vec<JointDef>)>,
}

fn figure(random: &mut Random, world: &mut World, at: Pose) -> Figure {
    let body = world.add_body(&BodyDef::new(BodyKind::Driven, at)).unwrap();
    world
        .add_piece(body, &PieceDef::new(Shape::Box([0.1, 0.15, 0.05]), 0.01))
        .unwrap();
    let mut chains: Vec<(ChainId, Vec<JointDef>)> = vec![];
    for _ in 0..1 + random.bits() % 3 {
        let mut at = random.unit().as_vec3() * 0.3;
        let mut joints = vec![];
        for _ in 0..1 + random.bits() % 3 {
            joints.push(if random.bits().is_multiple_of(2) {
                ball(random, at)
            } else {
                hinge(random, at)
            });
            at = Vec3::Z * random.between(0.0, 0.3) as f32;
        }
        let base = chains
            .last()
            .filter(|_| random.bits().is_multiple_of(3))
            .map(|(id, _)| (*id, 0));
        let options = ChainOptions {
            method: u32::from(random.bits().is_multiple_of(5)),
            flags: (random.bits() % 32) as u32,
            attraction_s: random.between(0.0, 0.1) as f32,
            tip: [0.0, 0.0, 0.05],
        };
        let def = ChainDef {
            joints: &joints,
            base,
            options,
        };
        let id = world.add_chain(body, &def).unwrap();
        let hinges: usize = joints.iter().map(JointDef::hinge_count).sum();
        let shape = Shape::Segment([0.0; 3], [0.0, 0.0, 0.15]);
        let piece = PieceDef::new(shape, 0.03);
        world.add_link_piece(id, hinges as u32 - 1, &piece).unwrap();
        chains.push((id, joints));
    }
    Figure { body, chains }
}

/// What must hold of a figure in every frame.
fn check(world: &World, figure: &Figure, fixed: &[BodyId], say: &str) {
    for &other in fixed {
        let found = world.penetration(figure.body, other).unwrap();
        assert!(
            found.depth_m <= OVERLAP_SLOP_M,
            "{say}: {} m deep",
            found.depth_m
        );
    }
    for (chain, joints) in &figure.chains {
        let angles = world.angles(*chain).unwrap();
        let mut first = 0;
        for joint in joints {
            if let JointDef::Ball { cone, .. } = joint {
                let outside = Ball { first, cone: *cone }.outside_rad(angles);
                assert!(outside <= 1e-5, "{say}: {outside} rad outside the cone");
            }
            for hinge in joint.hinges() {
                let angle = angles[first];
                assert!(
                    angle >= hinge.low_rad && angle <= hinge.high_rad,
                    "{say}: {angle} rad"
                );
                first += 1;
            }
        }
        assert!(
            world
                .link_poses(*chain)
                .unwrap()
                .iter()
                .all(Pose::is_finite),
            "{say}"
        );
    }
}

fn run(seed: u64, frames: u32) -> (u64, u32) {
    let mut random = Random(seed);
    let random = &mut random;
    let mut block = Block::new(&CAPACITIES);
    let mut world = World::create(block.bytes(), &CAPACITIES).unwrap();
    let figures: Vec<Figure> = [-1.5, 1.5]
        .map(|x| figure(random, &mut world, Pose::at(x, 0.0, 0.0)))
        .into();
    let mut fixed = vec![];
    for _ in 0..6 {
        let mut at = pose(random, 0.8);
        at.position[1] += 1.8
            * if random.bits().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
        let half = [0, 1, 2].map(|_| random.between(0.02, 0.5) as f32);
        fixed.push(add_box(&mut world, BodyKind::Fixed, at, half));
    }
    let mut steps = 0;
    for frame in 0..frames {
        for figure in &figures {
            if random.bits().is_multiple_of(4) {
                world.set_target(figure.body, &pose(random, 2.0)).unwrap();
            }
            for (chain, joints) in &figure.chains {
                let hinges: usize = joints.iter().map(JointDef::hinge_count).sum();
                let angles: Vec<f32> = (0..hinges)
                    .map(|_| random.between(-2.0, 2.0) as f32)
                    .collect();
                match random.bits() % 8 {
                    0 => world.set_angles(*chain, &angles).unwrap(),
                    1 => {
                        let tip = pose(random, 2.0);
                        world.set_tip(*chain, &tip, &angles).unwrap();
                    }
                    2 => {
                        let poses: Vec<Pose> = joints.iter().map(|_| pose(random, 2.0)).collect();
                        world.set_link_poses(*chain, &poses).unwrap();
                    }
                    _ => {}
                }
            }
        }
        let few = |random: &mut Random| match random.bits() % 3 {
            0 => (random.bits() % 30) as u32,
            _ => u32::MAX,
        };
        let budget = Budget {
            advance_units: few(random),
            impulse_units: 0,
            reach_steps: few(random),
        };
        let report = world.step(&FrameInput {
            budget,
            ..FrameInput::unlimited(1.0 / 60.0)
        });
        assert!(
            report.advance_units <= budget.advance_units,
            "seed {seed}, frame {frame}"
        );
        assert!(
            report.reach_steps <= budget.reach_steps,
            "seed {seed}, frame {frame}"
        );
        steps += report.reach_steps;
        for (number, figure) in figures.iter().enumerate() {
            check(
                &world,
                figure,
                &fixed,
                &format!("seed {seed}, frame {frame}, figure {number}"),
            );
        }
        let met = world.penetration(figures[0].body, figures[1].body).unwrap();
        assert!(
            met.depth_m <= 1e-3,
            "seed {seed}, frame {frame}: {} m",
            met.depth_m
        );
    }
    (world.hash(), steps)
}

#[test]
fn whatever_happens_links_stay_out_of_things_and_within_their_limits() {
    let mut steps = 0;
    for seed in 1..=60 {
        steps += run(seed, 60).1;
    }
    assert!(steps > 1000, "{steps} steps: too little was touched");
}

#[test]
fn equal_histories_have_equal_bits() {
    assert_eq!(run(5, 40), run(5, 40));
}
