//! Bad input to chains and to tracked hands, pools of chains that are full by one, and the fault table: each
//! row of it names a test.

mod common;

use std::fs;
use std::path::Path;

use common::{Block, add_box};
use glam::Vec3;
use palpable::frame::FrameInput;
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::limits::{CHAIN_HINGES_MAX, CHAINS_PER_BODY_MAX};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{
    AddChainError, AddPieceError, ChainDef, ChainError, JointInput, JointUse, PieceDef,
    SetJointsError, Shape, World,
};

const SMALL: Capacities = Capacities {
    bodies: 4,
    pieces: 8,
    vertices: 64,
    pairs: 16,
    contacts: 8,
    materials: 0,
    chains: 3,
    joints: 8,
};

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn hinge() -> Hinge {
    Hinge {
        rest: Pose::at(0.0, 0.1, 0.0),
        axis: Vec3::X,
        low_rad: -1.0,
        high_rad: 2.0,
    }
}

fn chain(joints: &[JointDef]) -> ChainDef<'_> {
    ChainDef {
        joints,
        base: None,
        options: ChainOptions::DEFAULT,
    }
}

/// Calls with a world that has a driven box, and checks that nothing changed.
fn unchanged<T>(call: impl FnOnce(&mut World, BodyId) -> T) -> T {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let body = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.1; 3]);
    let before = world.hash();
    let result = call(&mut world, body);
    assert_eq!(world.hash(), before);
    result
}

fn refused(def: &ChainDef) -> Option<AddChainError> {
    unchanged(|world, body| world.add_chain(body, def).err())
}

#[test]
fn joints_that_make_no_chain_are_refused_by_name() {
    let with = |hinge: Hinge| refused(&chain(&[JointDef::Hinge(hinge)]));
    assert_eq!(refused(&chain(&[])), Some(AddChainError::WrongCount));
    let many = [JointDef::Hinge(hinge()); CHAIN_HINGES_MAX + 1];
    assert_eq!(refused(&chain(&many)), Some(AddChainError::WrongCount));
    for bad in BAD.into_iter().chain([1e30]) {
        let rest = Pose::at(0.0, bad, 0.0);
        let found = with(Hinge { rest, ..hinge() });
        assert_eq!(found, Some(AddChainError::BadPose), "{bad}");
        let low = with(Hinge {
            low_rad: -bad,
            ..hinge()
        });
        assert_eq!(low, Some(AddChainError::BadRange), "{bad}");
    }
    let empty = Hinge {
        low_rad: 1.0,
        high_rad: 0.9,
        ..hinge()
    };
    assert_eq!(with(empty), Some(AddChainError::BadRange));
    for axis in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let found = with(Hinge { axis, ..hinge() });
        assert_eq!(found, Some(AddChainError::BadAxis), "{axis}");
    }
    let one = [JointDef::Hinge(hinge())];
    let nowhere = ChainDef {
        base: Some((ChainId::NULL, 0)),
        ..chain(&one)
    };
    assert_eq!(refused(&nowhere), Some(AddChainError::BadBase));
    for options in bad_options() {
        let def = ChainDef {
            options,
            ..chain(&one)
        };
        assert_eq!(refused(&def), Some(AddChainError::BadOptions));
    }
}

fn bad_options() -> [ChainOptions; 4] {
    let options = ChainOptions::DEFAULT;
    [
        ChainOptions {
            method: 2,
            ..options
        },
        ChainOptions {
            flags: 1 << 5,
            ..options
        },
        ChainOptions {
            attraction_s: f32::NAN,
            ..options
        },
        ChainOptions {
            tip: [0.0, f32::INFINITY, 0.0],
            ..options
        },
    ]
}

#[test]
fn bad_targets_of_chains_keep_the_old_ones() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let body = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.1; 3]);
    let joints = [JointDef::Hinge(hinge()); 2];
    let id = world.add_chain(body, &chain(&joints)).unwrap();
    // Beyond a range is the nearest angle in it.
    world.set_angles(id, &[-3.0, 0.5]).unwrap();
    assert_eq!(world.target_angles(id), Ok(&[-1.0, 0.5][..]));
    let before = world.hash();
    for bad in BAD {
        assert_eq!(world.set_angles(id, &[0.1, bad]), Err(ChainError::BadAngle));
        assert_eq!(
            world.place_angles(id, &[0.1, bad]),
            Err(ChainError::BadAngle)
        );
        let pose = Pose::at(0.0, bad, 0.0);
        let poses = [Pose::IDENTITY, pose];
        assert_eq!(world.set_link_poses(id, &poses), Err(ChainError::BadPose));
        assert_eq!(
            world.set_tip(id, &pose, &[0.0; 2]),
            Err(ChainError::BadPose)
        );
        let posture = [bad, 0.0];
        let found = world.set_tip(id, &Pose::IDENTITY, &posture);
        assert_eq!(found, Err(ChainError::BadAngle));
    }
    for count in [0, 1, 3] {
        let angles = vec![0.0; count];
        assert_eq!(world.set_angles(id, &angles), Err(ChainError::WrongCount));
        let poses = vec![Pose::IDENTITY; count];
        assert_eq!(
            world.set_link_poses(id, &poses),
            Err(ChainError::WrongCount)
        );
    }
    for options in bad_options() {
        let found = world.set_chain_options(id, &options);
        assert_eq!(found, Err(ChainError::BadOptions));
    }
    for stale in [
        ChainId::NULL,
        ChainId {
            index1: 9,
            generation: 1,
        },
    ] {
        assert_eq!(world.set_angles(stale, &[0.0; 2]), Err(ChainError::Stale));
        assert_eq!(world.remove_chain(stale), Err(ChainError::Stale));
        let def = PieceDef::new(Shape::Point, 0.1);
        let piece = world.add_link_piece(stale, 0, &def);
        assert_eq!(piece, Err(AddPieceError::StaleChain));
    }
    let def = PieceDef::new(Shape::Point, 0.1);
    assert_eq!(
        world.add_link_piece(id, 2, &def),
        Err(AddPieceError::UnknownHinge)
    );
    assert_eq!(world.hash(), before);
}

#[test]
fn chains_and_joints_full_by_one_are_refused_and_nothing_changes() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let body = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.1; 3]);
    let joints = [JointDef::Hinge(hinge()); 4];
    let three = world.add_chain(body, &chain(&joints[..3])).unwrap();
    world.add_chain(body, &chain(&joints)).unwrap();
    let full = world.hash();
    let found = world.add_chain(body, &chain(&joints[..2]));
    assert_eq!(found, Err(AddChainError::FullJoints));
    assert_eq!(world.hash(), full);
    // One joint is left, and one chain.
    world.add_chain(body, &chain(&joints[..1])).unwrap();
    let full = world.hash();
    let found = world.add_chain(body, &chain(&joints[..1]));
    assert_eq!(found, Err(AddChainError::FullChains));
    assert_eq!(world.hash(), full);
    let high = world.high_water();
    assert_eq!((high.chains, high.joints), (SMALL.chains, SMALL.joints));
    world.set_target(body, &Pose::at(0.1, 0.0, 0.0)).unwrap();
    world.step(&FrameInput::unlimited(1.0 / 90.0));
    assert_eq!(world.pose(body), Ok(Pose::at(0.1, 0.0, 0.0)));
    world.remove_chain(three).unwrap();
    world.add_chain(body, &chain(&joints[..3])).unwrap();
}

#[test]
fn more_chains_than_a_body_may_have_are_refused() {
    let many = Capacities {
        chains: 64,
        joints: 64,
        ..SMALL
    };
    let mut block = Block::new(&many);
    let mut world = World::create(block.bytes(), &many).unwrap();
    let body = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.1; 3]);
    let joints = [JointDef::Hinge(hinge())];
    for _ in 0..CHAINS_PER_BODY_MAX {
        world.add_chain(body, &chain(&joints)).unwrap();
    }
    let full = world.hash();
    let found = world.add_chain(body, &chain(&joints));
    assert_eq!(found, Err(AddChainError::TooManyChains));
    assert_eq!(world.hash(), full);
}

fn input<'j>(joints: &'j [Option<Pose>], piece_joints: &'j [u32]) -> JointInput<'j> {
    JointInput {
        joints,
        root: 0,
        piece_joints,
        piece_offsets: &[],
        reach_m: 0.5,
    }
}

#[test]
fn joints_of_a_hand_that_are_not_good_keep_what_was_there() {
    let good = [Some(Pose::at(0.1, 0.0, 0.0)), Some(Pose::at(0.2, 0.0, 0.0))];
    let bad = [
        None,
        Some(Pose::at(f32::NAN, 0.0, 0.0)),
        Some(Pose::at(5.0, 0.0, 0.0)),
    ];
    // A root that is not good changes nothing at all.
    for root in &bad[..2] {
        let joints = [*root, good[1]];
        let used = unchanged(|world, body| world.set_joints(body, &input(&joints, &[1])));
        assert_eq!(used, Ok(JointUse::default()));
    }
    // Another one keeps the target of its piece.
    for joint in bad {
        let mut block = Block::new(&SMALL);
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        let body = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.1; 3]);
        let used = world.set_joints(body, &input(&[good[0], joint], &[1]));
        let kept = JointUse {
            root: true,
            pieces_kept: 1,
        };
        assert_eq!(used, Ok(kept));
    }
    let error = |input: JointInput| unchanged(|world, body| world.set_joints(body, &input).err());
    assert_eq!(error(input(&good, &[])), Some(SetJointsError::WrongCount));
    assert_eq!(
        error(input(&good, &[2])),
        Some(SetJointsError::UnknownJoint)
    );
    for reach_m in [0.0, -1.0, f32::NAN] {
        let input = JointInput {
            reach_m,
            ..input(&good, &[1])
        };
        assert_eq!(error(input), Some(SetJointsError::BadReach));
    }
    let offsets = [Pose::at(f32::NAN, 0.0, 0.0)];
    let spoiled = JointInput {
        piece_offsets: &offsets,
        ..input(&good, &[1])
    };
    assert_eq!(error(spoiled), Some(SetJointsError::BadOffset));
}

#[test]
fn gravity_that_is_none_is_left_out() {
    for bad in BAD.into_iter().chain([1e30]) {
        unchanged(|world, _| world.set_gravity([0.0, bad, 0.0]));
    }
}

/// All that is below a folder of tests.
fn tests_below(folder: &Path) -> String {
    let mut text = String::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            text += &tests_below(&path);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            text += &fs::read_to_string(path).unwrap();
        }
    }
    text
}

#[test]
fn every_row_of_the_fault_table_names_a_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let table = fs::read_to_string(root.join("src/faults.rs")).unwrap();
    let tests = tests_below(&root.join("tests"));
    let mut rows = 0;
    for line in table.lines().filter(|line| line.starts_with("//! | ")) {
        let name = line
            .trim_end_matches([' ', '|'])
            .rsplit('|')
            .next()
            .unwrap();
        let name = name.trim().trim_matches('`');
        if name == "test" {
            continue;
        }
        rows += 1;
        assert!(
            tests.contains(&format!("fn {name}()")),
            "no test is named {name}"
        );
    }
    assert!(rows > 25, "{rows} rows");
}
