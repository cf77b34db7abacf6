//! Chains that come, go and are refused, and what that leaves.

mod common;

use common::Block;
use glam::Vec3;
use palpable::frame::FrameInput;
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::geometry::reach_cone::ReachCone;
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{AddChainError, BodyDef, ChainDef, ChainError, PieceDef, Shape, World};

#[test]
fn an_axis_with_any_part_not_a_number_is_refused() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let before = world.hash();
    for part in 0..3 {
        for bad in [f32::NAN, f32::INFINITY] {
            let mut axis = [1.0; 3];
            axis[part] = bad;
            let hinge = Hinge {
                rest: Pose::IDENTITY,
                axis: Vec3::from_array(axis),
                low_rad: -1.0,
                high_rad: 1.0,
            };
            let def = ChainDef {
                joints: &[JointDef::Hinge(hinge)],
                base: None,
                options: ChainOptions::DEFAULT,
            };
            let added = world.add_chain(body, &def);
            assert_eq!(added, Err(AddChainError::BadAxis), "{axis:?}");
            assert_eq!(world.hash(), before);
        }
    }
}

/// A chain of the model: what must be found again after others went.
struct Kept {
    id: ChainId,
    body: usize,
    base: Option<ChainId>,
    pieces: Vec<PieceId>,
    angles: Vec<f32>,
    links: Vec<Pose>,
}

/// A small generator: the numbers of Numerical Recipes.
struct Random(u32);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as usize % bound
    }
}

fn ball(turn: u32) -> JointDef {
    // Cones of different widths, so that another ball's cone would be noticed.
    let across = 0.3 + 0.1 * turn as f32;
    let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    let corners = corners.map(|(x, y)| Vec3::new(across * x, across * y, 1.0));
    JointDef::Ball {
        rest: Pose::at(0.0, 0.1, 0.0),
        twist_low_rad: -1.0,
        twist_high_rad: 1.0,
        cone: ReachCone::new(Vec3::Z, &corners).unwrap(),
    }
}

fn hinge() -> JointDef {
    JointDef::Hinge(Hinge {
        rest: Pose::at(0.0, 0.0, 0.1),
        axis: Vec3::X,
        low_rad: -1.5,
        high_rad: 1.5,
    })
}

fn check(world: &World, kept: &Kept) {
    assert_eq!(world.angles(kept.id).unwrap(), kept.angles);
    assert_eq!(world.target_angles(kept.id).unwrap(), kept.angles);
    assert_eq!(world.link_poses(kept.id).unwrap(), kept.links);
    for (&piece, link) in kept.pieces.iter().zip(&kept.links) {
        assert_eq!(world.piece_pose(piece).unwrap(), *link);
    }
}

/// Adds a chain at a wild posture, with a sphere on each of its first links.
fn add(world: &mut World, bodies: &[BodyId], chains: &[Kept], random: &mut Random) -> Option<Kept> {
    let body = random.below(bodies.len());
    let own: Vec<_> = chains.iter().filter(|chain| chain.body == body).collect();
    let base = (!own.is_empty() && random.below(2) == 0).then(|| own[random.below(own.len())]);
    let joints: Vec<_> = (0..1 + random.below(4))
        .map(|turn| match random.below(2) {
            0 => hinge(),
            _ => ball(turn as u32),
        })
        .collect();
    let def = ChainDef {
        joints: &joints,
        base: base.map(|base| (base.id, random.below(base.angles.len()) as u32)),
        options: ChainOptions::DEFAULT,
    };
    let id = world.add_chain(bodies[body], &def).ok()?;
    let hinges = world.angles(id).unwrap().len();
    let wild: Vec<_> = (0..hinges)
        .map(|_| random.below(400) as f32 * 0.01 - 2.0)
        .collect();
    world.place_angles(id, &wild).unwrap();
    let sphere = PieceDef::new(Shape::Point, 0.01);
    let pieces = (0..hinges.min(2) as u32)
        .map_while(|link| world.add_link_piece(id, link, &sphere).ok())
        .collect();
    Some(Kept {
        id,
        body,
        base: base.map(|base| base.id),
        pieces,
        angles: world.angles(id).unwrap().to_vec(),
        links: world.link_poses(id).unwrap().to_vec(),
    })
}

#[test]
fn what_is_left_stays_to_the_bit_when_chains_go() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let mut random = Random(7);
    let bodies: Vec<_> = (0..3)
        .map(|at| {
            let pose = Pose::at(5.0 * at as f32, 0.0, 0.0);
            world
                .add_body(&BodyDef::new(BodyKind::Driven, pose))
                .unwrap()
        })
        .collect();
    let mut chains: Vec<Kept> = vec![];
    let (mut refused, mut removed) = (0, 0);
    for _ in 0..3000 {
        if random.below(5) < 3 {
            match add(&mut world, &bodies, &chains, &mut random) {
                Some(chain) => chains.push(chain),
                None => refused += 1,
            }
        } else if !chains.is_empty() {
            let gone = random.below(chains.len());
            let id = chains[gone].id;
            if chains.iter().any(|chain| chain.base == Some(id)) {
                assert_eq!(world.remove_chain(id), Err(ChainError::InUse));
            } else {
                world.remove_chain(id).unwrap();
                assert_eq!(world.remove_chain(id), Err(ChainError::Stale));
                for piece in chains.remove(gone).pieces {
                    assert!(world.piece_pose(piece).is_err());
                }
                removed += 1;
            }
        }
        for kept in &chains {
            check(&world, kept);
            // Asking for the same again changes nothing: each ball still has its own cone.
            world.set_angles(kept.id, &kept.angles).unwrap();
            check(&world, kept);
        }
    }
    assert!(refused > 50 && removed > 500, "{refused} {removed}");
}

#[test]
fn links_go_where_their_body_is_placed() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let bodies = [world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap()];
    let kept = add(&mut world, &bodies, &[], &mut Random(3)).unwrap();
    world
        .place_body(bodies[0], &Pose::at(0.0, 2.0, 0.0))
        .unwrap();
    for (now, before) in world.link_poses(kept.id).unwrap().iter().zip(&kept.links) {
        let moved = now.translation() - before.translation();
        assert!((moved - Vec3::new(0.0, 2.0, 0.0)).length() < 1e-6);
    }
    assert_eq!(
        world.piece_pose(kept.pieces[0]).unwrap(),
        world.link_poses(kept.id).unwrap()[0]
    );
}

/// An arm of a ball and two hinges in front of a wall, with extreme options, postures and targets that are
/// all accepted.
fn extreme(seed: u32) {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let mut random = Random(seed);
    let sizes: [f32; 10] = [0.0, -0.0, 1e-40, 0.1, -1.0, 3.0, 1e4, -1e20, 3e38, -3e38];
    // Its face is at z = 0.35.
    common::add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.0, 0.0, 0.45),
        [1.0, 1.0, 0.1],
    );
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let any = |random: &mut Random| sizes[random.below(sizes.len())];
    let options = ChainOptions {
        method: random.below(2) as u32,
        flags: random.below(16) as u32,
        attraction_s: any(&mut random).clamp(0.0, 1e6),
        tip: [any(&mut random), any(&mut random), any(&mut random)],
    };
    let joints = [ball(0), hinge(), hinge()];
    let def = ChainDef {
        joints: &joints,
        base: None,
        options,
    };
    let arm = world.add_chain(body, &def).unwrap();
    let capsule = PieceDef::new(Shape::Segment([0.0; 3], [0.0, 0.0, 0.1]), 0.02);
    let pieces = [2, 3, 4].map(|link| world.add_link_piece(arm, link, &capsule).unwrap());
    for frame in 0..40 {
        world
            .set_target(body, &Pose::at(0.0, 0.0, 0.01 * frame as f32))
            .unwrap();
        let angles: [f32; 5] = core::array::from_fn(|_| any(&mut random));
        let far = any(&mut random).clamp(-1000.0, 1000.0);
        match random.below(3) {
            0 => world.set_angles(arm, &angles).unwrap(),
            1 => assert!(
                world
                    .set_tip(arm, &Pose::at(far, 0.0, 0.3), &angles)
                    .unwrap()
                    .is_finite()
            ),
            _ => {}
        }
        world.step(&FrameInput::unlimited(1.0 / 60.0));
        for (joint, &angle) in world.angles(arm).unwrap().iter().enumerate() {
            let limit = if joint < 3 { 6.3 } else { 1.5 };
            assert!(
                angle.abs() <= limit,
                "seed {seed}, frame {frame}: {angle} of {joint}, {options:?}"
            );
        }
        for link in world.link_poses(arm).unwrap() {
            assert!(link.is_finite(), "seed {seed}, frame {frame}, {options:?}");
        }
        assert!(
            world.pose(body).unwrap().is_finite(),
            "seed {seed}, frame {frame}, {options:?}"
        );
        for &piece in &pieces {
            let pose = world.piece_pose(piece).unwrap();
            for end in [Vec3::ZERO, 0.1 * Vec3::Z] {
                let over = pose.point(end).z + 0.02 - 0.35;
                assert!(
                    over <= OVERLAP_SLOP_M,
                    "seed {seed}, frame {frame}: {over} m deep, {options:?}"
                );
            }
        }
    }
}

#[test]
fn no_accepted_number_makes_a_chain_leave_its_limits_or_overlap() {
    for seed in 0..100 {
        extreme(seed);
    }
}
