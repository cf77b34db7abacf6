//! Skeletons in a world: free motion, arms at walls, links that meet each other, budgets, bad input.

mod common;

use common::{Block, add_box};
use glam::{DQuat, DVec3, Quat, Vec3};
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 90.0;
const RADIUS_M: f32 = 0.04;

fn hinge(at: Vec3, axis: Vec3, low_rad: f32, high_rad: f32) -> JointDef {
    JointDef::Hinge(Hinge {
        rest: Pose::new(Quat::IDENTITY, at),
        axis,
        low_rad,
        high_rad,
    })
}

const UPPER: Vec3 = Vec3::new(0.0, -0.30, 0.0);
const FORE: Vec3 = Vec3::new(0.0, -0.26, 0.0);
const HAND: Vec3 = Vec3::new(0.0, -0.10, 0.0);

/// A shoulder of three hinges, an elbow, a forearm's twist, a wrist of two, hanging down.
fn arm_joints() -> [JointDef; 7] {
    [
        hinge(Vec3::ZERO, Vec3::X, -1.0, 2.8),
        hinge(Vec3::ZERO, Vec3::Z, -2.8, 2.8),
        hinge(Vec3::ZERO, Vec3::Y, -1.5, 1.5),
        hinge(UPPER, Vec3::X, 0.0, 2.5),
        hinge(Vec3::ZERO, Vec3::Y, -1.4, 1.4),
        hinge(FORE, Vec3::X, -1.2, 1.2),
        hinge(Vec3::ZERO, Vec3::Z, -0.6, 0.6),
    ]
}

fn capsule(to: Vec3) -> PieceDef<'static> {
    PieceDef::new(Shape::Segment([0.0; 3], to.to_array()), RADIUS_M)
}

/// The links with pieces, and the far ends of their segments.
const LINKS: [(u32, Vec3); 3] = [(2, UPPER), (4, FORE), (6, HAND)];

/// An arm that hangs on a driven body without pieces of its own.
fn add_arm(world: &mut World, shoulder: Pose, options: ChainOptions) -> (BodyId, ChainId) {
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, shoulder))
        .unwrap();
    let def = ChainDef {
        joints: &arm_joints(),
        base: None,
        options,
    };
    let chain = world.add_chain(body, &def).unwrap();
    for (link, to) in LINKS {
        world.add_link_piece(chain, link, &capsule(to)).unwrap();
    }
    world.set_target(body, &shoulder).unwrap();
    (body, chain)
}

/// Ends of the arm's segments in double precision, from the published angles alone.
fn ends(world: &World, body: BodyId, chain: ChainId) -> Vec<DVec3> {
    let root = world.pose(body).unwrap();
    let mut turn = DQuat::from_array(root.rotation.map(f64::from)).normalize();
    let mut at = DVec3::from_array(root.position.map(f64::from));
    let mut found = vec![];
    for (index, (joint, &angle)) in arm_joints()
        .iter()
        .zip(world.angles(chain).unwrap())
        .enumerate()
    {
        let JointDef::Hinge(hinge) = joint else {
            unreachable!()
        };
        at += turn * hinge.rest.translation().as_dvec3();
        turn *= DQuat::from_axis_angle(hinge.axis.as_dvec3(), f64::from(angle));
        for (link, to) in LINKS {
            if link as usize == index {
                found.extend([at, at + turn * to.as_dvec3()]);
            }
        }
    }
    found
}

fn step(world: &mut World, body: BodyId, root: &Pose) -> FrameReport {
    world.set_target(body, root).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S))
}

/// How deep the arm is behind the plane z = `wall`, in metres; the wall is on the side of -Z.
fn depth_m(world: &World, body: BodyId, chain: ChainId, wall: f64) -> f64 {
    let lowest = ends(world, body, chain)
        .iter()
        .fold(f64::INFINITY, |low, end| low.min(end.z));
    wall - (lowest - f64::from(RADIUS_M))
}

#[test]
fn an_arm_at_a_wall_stays_outside() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    // The wall's face is at z = -0.45.
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.0, 1.2, -0.55),
        [2.0, 2.0, 0.1],
    );
    let shoulder = Pose::at(0.0, 1.4, 0.0);
    let (body, chain) = add_arm(&mut world, shoulder, ChainOptions::DEFAULT);
    let mut before = world.angles(chain).unwrap().to_vec();
    let (mut deepest, mut jump, mut steps) = (f64::NEG_INFINITY, 0.0_f32, 0);
    for frame in 0..400 {
        let t = (frame as f32 / 180.0).min(1.0);
        let s = 0.5 - 0.5 * (t * core::f32::consts::PI).cos();
        // The arm swings forward, straight: the hand is wanted 0.2 m behind the face.
        let angles = [
            1.5 * s,
            0.1 * s,
            0.0,
            0.25 * (1.0 - s) + 0.05,
            0.0,
            0.0,
            0.0,
        ];
        world.set_angles(chain, &angles).unwrap();
        let report = step(&mut world, body, &shoulder);
        deepest = deepest.max(depth_m(&world, body, chain, -0.45));
        let now = world.angles(chain).unwrap().to_vec();
        for (a, b) in now.iter().zip(&before) {
            jump = jump.max((a - b).abs());
        }
        steps += report.reach_steps;
        if frame % 40 == 0 {
            println!(
                "{frame} {:?} {:?} {:?} {now:?} {:?}",
                report,
                world.chain_report(chain).unwrap(),
                world.driven_report(body).unwrap(),
                depth_m(&world, body, chain, -0.45)
            );
        }
        before = now;
    }
    println!(
        "deepest {deepest} jump {} deg steps {steps} root {:?}",
        jump.to_degrees(),
        world.pose(body).unwrap()
    );
    assert!(deepest <= f64::from(OVERLAP_SLOP_M));
}
