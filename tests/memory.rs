//! The block of memory: making worlds in it, moving it, filling it, rolling it back.

mod common;

use common::{Block, add_box, add_piece};
use palpable::frame::{FrameInput, FrameReport};
use palpable::math::Pose;
use palpable::memory::{
    AttachError, BLOCK_ALIGNMENT, BodyId, Capacities, CreateError, PieceId, SnapshotError,
};
use palpable::state::bodies::BodyKind;
use palpable::state::materials::{Material, Surface};
use palpable::world::{
    AddBodyError, AddPieceError, BodyDef, BodyError, MaterialError, PieceDef, Shape, World,
};

const FRAME_S: f32 = 1.0 / 60.0;

/// The size of a block is known to the compiler, so a host can reserve it in its image.
const ROOM_BYTES: usize = Capacities::ROOM.bytes();
const _: () = assert!(ROOM_BYTES.is_multiple_of(BLOCK_ALIGNMENT));

/// The header is the first column: magic, bytes, layout, eight capacities, padding, checksum.
const HEADER_BYTES: usize = 64;

const SMALL: Capacities = Capacities {
    bodies: 4,
    pieces: 6,
    vertices: 40,
    pairs: 16,
    contacts: 16,
    materials: 2,
    chains: 2,
    joints: 9,
};

const NOTHING: Capacities = Capacities {
    bodies: 0,
    pieces: 0,
    vertices: 0,
    pairs: 0,
    contacts: 0,
    materials: 0,
    chains: 0,
    joints: 0,
};

/// A generator of 32 random bits; the same seed gives the same sequence everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    fn below(&mut self, bound: usize) -> usize {
        self.next() as usize % bound
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 24) as f32
    }
}

fn create_error(memory: &mut [u8], capacities: &Capacities) -> Option<CreateError> {
    World::create(memory, capacities).err()
}

fn attach_error(memory: &mut [u8]) -> Option<AttachError> {
    World::attach(memory).err()
}

/// A driven hand over a floor with two loose bodies: every kind of state is in use.
fn furnish(world: &mut World) -> BodyId {
    add_box(
        world,
        BodyKind::Fixed,
        Pose::at(0.0, -0.5, 0.0),
        [5.0, 0.5, 5.0],
    );
    let hand = add_box(world, BodyKind::Driven, Pose::at(-0.3, 0.2, 0.0), [0.05; 3]);
    add_box(
        world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.3, 0.0),
        [0.04, 0.05, 0.06],
    );
    let ball = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(0.2, 0.1, 0.02)))
        .unwrap();
    add_piece(world, ball, &PieceDef::new(Shape::Point, 0.05));
    hand
}

/// One frame of a hand that presses on the floor and pushes the loose bodies about.
fn play(world: &mut World, hand: BodyId, frame: u32) -> u64 {
    let t = frame as f32 * FRAME_S;
    let target = Pose::at(-0.3 + 0.1 * t, 0.04 + 0.02 * (t - 1.0), 0.03 * t);
    world.set_target(hand, &target).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    world.hash()
}

#[test]
fn a_block_too_small_by_one_byte_is_refused() {
    let mut block = Block::new(&SMALL);
    let bytes = SMALL.bytes();
    let memory = block.bytes();
    assert_eq!(
        create_error(&mut memory[..bytes - 1], &SMALL),
        Some(CreateError::TooSmall)
    );
    assert_eq!(create_error(&mut memory[..bytes], &SMALL), None);
    assert_eq!(
        create_error(&mut memory[..0], &SMALL),
        Some(CreateError::TooSmall)
    );
}

#[test]
fn a_block_misaligned_by_one_byte_is_refused() {
    let larger = Capacities {
        bodies: SMALL.bodies + 64,
        ..SMALL
    };
    let mut block = Block::new(&larger);
    for shift in 1..BLOCK_ALIGNMENT {
        let memory = &mut block.bytes()[shift..];
        assert!(memory.len() >= SMALL.bytes());
        assert_eq!(
            create_error(memory, &SMALL),
            Some(CreateError::Misaligned),
            "shifted by {shift}"
        );
    }
}

#[test]
fn a_refused_block_is_left_alone() {
    let mut block = Block::new(&SMALL);
    let bytes = SMALL.bytes();
    block.bytes().fill(0xa5);
    let memory = block.bytes();
    assert!(create_error(&mut memory[..bytes - 1], &SMALL).is_some());
    let huge = Capacities {
        pairs: u32::MAX,
        ..SMALL
    };
    assert!(create_error(memory, &huge).is_some());
    assert!(memory.iter().all(|&byte| byte == 0xa5));
}

#[test]
fn what_a_block_held_before_does_not_matter() {
    let (mut clean, mut dirty) = (Block::new(&SMALL), Block::new(&SMALL));
    dirty.bytes().fill(0xff);
    let [expected, got]: [Vec<u64>; 2] = [clean.bytes(), dirty.bytes()].map(|memory| {
        let mut world = World::create(memory, &SMALL).unwrap();
        let hand = furnish(&mut world);
        (0..60).map(|frame| play(&mut world, hand, frame)).collect()
    });
    assert_eq!(got, expected);
}

#[test]
fn a_world_without_room_refuses_everything_by_name_and_steps() {
    let mut block = Block::new(&NOTHING);
    let mut world = World::create(block.bytes(), &NOTHING).unwrap();
    assert_eq!(
        world.add_body(&BodyDef::new(BodyKind::Fixed, Pose::IDENTITY)),
        Err(AddBodyError::Full)
    );
    assert_eq!(
        world.add_piece(BodyId::NULL, &PieceDef::new(Shape::Point, 1.0)),
        Err(AddPieceError::StaleBody)
    );
    assert_eq!(world.add_material(), Err(MaterialError::Full));
    let report = world.step(&FrameInput::unlimited(FRAME_S));
    assert_eq!((report.frame, report.flags), (1, 0));
    assert!(world.contacts().is_empty() && world.piece_poses().is_empty());
    let mut buffer = vec![0; world.snapshot_bytes()];
    world.save(&mut buffer).unwrap();
    let saved = world.hash();
    world.step(&FrameInput::unlimited(FRAME_S));
    world.load(&buffer).unwrap();
    assert_eq!(world.hash(), saved);
}

#[test]
fn each_capacity_of_zero_leaves_a_world_that_steps() {
    let zeroed: [fn(&mut Capacities) -> &mut u32; 6] = [
        |c| &mut c.bodies,
        |c| &mut c.pieces,
        |c| &mut c.vertices,
        |c| &mut c.pairs,
        |c| &mut c.contacts,
        |c| &mut c.materials,
    ];
    for field in zeroed {
        let mut capacities = SMALL;
        *field(&mut capacities) = 0;
        let mut block = Block::new(&capacities);
        let mut world = World::create(block.bytes(), &capacities).unwrap();
        for kind in [BodyKind::Fixed, BodyKind::Dynamic, BodyKind::Driven] {
            if let Ok(body) = world.add_body(&BodyDef::new(kind, Pose::IDENTITY)) {
                let _ = world.add_piece(body, &PieceDef::new(Shape::Point, 0.1));
                if kind == BodyKind::Driven {
                    world.set_target(body, &Pose::at(1.0, 0.0, 0.0)).unwrap();
                }
            }
        }
        for _ in 0..3 {
            world.step(&FrameInput::unlimited(FRAME_S));
        }
    }
}

#[test]
fn a_capacity_above_its_bound_is_refused() {
    let raised: [fn(&mut Capacities) -> &mut u32; 6] = [
        |c| &mut c.bodies,
        |c| &mut c.pieces,
        |c| &mut c.vertices,
        |c| &mut c.pairs,
        |c| &mut c.contacts,
        |c| &mut c.materials,
    ];
    let mut block = Block::new(&SMALL);
    for field in raised {
        let bound = *field(&mut Capacities::LARGEST.clone());
        for value in [bound + 1, u32::MAX] {
            let mut capacities = SMALL;
            *field(&mut capacities) = value;
            assert_eq!(capacities.bytes(), usize::MAX);
            assert_eq!(
                create_error(block.bytes(), &capacities),
                Some(CreateError::CapacityTooLarge)
            );
        }
        let mut capacities = NOTHING;
        *field(&mut capacities) = bound;
        assert!(capacities.bytes() < 1 << 40, "within the documented bound");
    }
    assert!(Capacities::LARGEST.bytes() < 1 << 40);
}

#[test]
fn a_copy_at_another_address_is_the_same_world() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = furnish(&mut world);
    for frame in 0..30 {
        play(&mut world, hand, frame);
    }
    let hash = world.hash();
    let (mut copy, mut larger) = (Block::new(&SMALL), Block::new(&Capacities::ROOM));
    copy.bytes().copy_from_slice(block.bytes());
    larger.bytes().fill(0x5a);
    larger.bytes()[..SMALL.bytes()].copy_from_slice(&block.bytes()[..SMALL.bytes()]);
    assert_ne!(copy.bytes().as_ptr(), block.bytes().as_ptr());
    let mut original = World::attach(block.bytes()).unwrap();
    let mut copied = World::attach(copy.bytes()).unwrap();
    let mut in_larger = World::attach(larger.bytes()).unwrap();
    assert_eq!(copied.capacities(), SMALL);
    assert_eq!((original.hash(), copied.hash()), (hash, hash));
    for frame in 30..90 {
        let expected = play(&mut original, hand, frame);
        assert_eq!(play(&mut copied, hand, frame), expected, "frame {frame}");
        assert_eq!(play(&mut in_larger, hand, frame), expected, "frame {frame}");
    }
}

#[test]
fn every_flipped_bit_of_the_header_is_refused() {
    let mut block = Block::new(&SMALL);
    World::create(block.bytes(), &SMALL).unwrap();
    let memory = block.bytes();
    for index in 0..HEADER_BYTES {
        for bit in 0..8 {
            memory[index] ^= 1 << bit;
            let error = attach_error(memory);
            memory[index] ^= 1 << bit;
            let expected = match index {
                0..8 => AttachError::NotAWorld,
                16..20 => AttachError::OtherLayout,
                _ => AttachError::Damaged,
            };
            assert_eq!(error, Some(expected), "bit {bit} of byte {index}");
        }
    }
    assert_eq!(attach_error(memory), None);
}

#[test]
fn garbage_and_truncated_blocks_are_refused() {
    let mut block = Block::new(&SMALL);
    assert_eq!(attach_error(block.bytes()), Some(AttachError::NotAWorld));
    let mut random = Random(7);
    for _ in 0..200 {
        let memory = block.bytes();
        memory.fill_with(|| random.next() as u8);
        assert_eq!(attach_error(memory), Some(AttachError::NotAWorld));
    }
    World::create(block.bytes(), &SMALL).unwrap();
    let memory = block.bytes();
    for length in [0, 1, HEADER_BYTES - 1, HEADER_BYTES, SMALL.bytes() - 1] {
        assert_eq!(
            attach_error(&mut memory[..length]),
            Some(AttachError::TooSmall),
            "{length} bytes"
        );
    }
    let mut larger = Block::new(&Capacities::ROOM);
    let shifted = &mut larger.bytes()[1..];
    shifted[..SMALL.bytes()].copy_from_slice(&memory[..SMALL.bytes()]);
    assert_eq!(attach_error(shifted), Some(AttachError::Misaligned));
}

#[test]
fn every_pool_full_by_one_is_refused_and_nothing_changes() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let def = BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY);
    let bodies = [(); 4].map(|()| world.add_body(&def).unwrap());
    let full = world.hash();
    assert_eq!(world.add_body(&def), Err(AddBodyError::Full));
    assert_eq!(world.hash(), full);

    let materials = [(); 2].map(|()| world.add_material().unwrap());
    let full = world.hash();
    assert_eq!(world.add_material(), Err(MaterialError::Full));
    assert_eq!(world.hash(), full);
    assert_ne!(materials[0], materials[1]);

    // Four boxes take 32 of 40 vertices: a fifth fits to the brim, a sphere more does not.
    for body in bodies {
        add_piece(&mut world, body, &PieceDef::new(Shape::Box([0.1; 3]), 0.0));
    }
    let last = add_piece(
        &mut world,
        bodies[0],
        &PieceDef::new(Shape::Box([0.2; 3]), 0.0),
    );
    let full = world.hash();
    for def in [
        PieceDef::new(Shape::Point, 0.1),
        PieceDef::new(Shape::Box([0.1; 3]), 0.0),
    ] {
        assert_eq!(
            world.add_piece(bodies[1], &def),
            Err(AddPieceError::FullVertices)
        );
        assert_eq!(world.hash(), full);
    }

    world.remove_piece(last).unwrap();
    for body in &bodies[..2] {
        add_piece(&mut world, *body, &PieceDef::new(Shape::Point, 0.1));
    }
    let full = world.hash();
    assert_eq!(
        world.add_piece(bodies[1], &PieceDef::new(Shape::Point, 0.1)),
        Err(AddPieceError::FullPieces)
    );
    assert_eq!(world.hash(), full);
}

/// A driven box resting on as many fixed boxes as there is to be pairs of them.
fn tiles(world: &mut World, tiles: u32) -> BodyId {
    let ground = world
        .add_body(&BodyDef::new(BodyKind::Fixed, Pose::IDENTITY))
        .unwrap();
    for tile in 0..tiles {
        let x = 0.02 * (tile as f32 + 0.5) - 0.01 * tiles as f32;
        add_piece(
            world,
            ground,
            &PieceDef {
                local: Pose::at(x, -0.5, 0.0),
                ..PieceDef::new(Shape::Box([0.0099, 0.5, 0.1]), 0.0)
            },
        );
    }
    add_box(
        world,
        BodyKind::Driven,
        Pose::at(0.0, 0.2, 0.0),
        [0.1, 0.05, 0.05],
    )
}

fn press(capacities: &Capacities, count: u32) -> (u32, Pose, Capacities) {
    let mut block = Block::new(capacities);
    let mut world = World::create(block.bytes(), capacities).unwrap();
    let hand = tiles(&mut world, count);
    let mut flags = 0;
    for _ in 0..30 {
        world.set_target(hand, &Pose::at(0.0, -0.1, 0.0)).unwrap();
        flags |= world.step(&FrameInput::unlimited(FRAME_S)).flags;
    }
    (flags, world.pose(hand).unwrap(), world.high_water())
}

#[test]
fn pairs_full_by_one_hold_their_mover_and_are_reported() {
    let capacities = Capacities {
        pieces: 16,
        vertices: 128,
        pairs: 8,
        ..SMALL
    };
    let (flags, pose, high) = press(&capacities, 8);
    assert_eq!(flags & FrameReport::FULL_PAIRS, 0);
    assert!(pose.position[1] < 0.051 && pose.position[1] > 0.05);
    assert_eq!(high.pairs, 8);
    let (flags, pose, _) = press(&capacities, 9);
    assert_ne!(flags & FrameReport::FULL_PAIRS, 0);
    assert!(pose.position[1] > 0.051, "{pose:?}");
}

/// Steps a box or a sphere that falls on a floor; all flags, and the most contacts read at once.
fn drop_on_floor(contacts: u32, shape: Shape, radius_m: f32) -> (u32, usize) {
    let capacities = Capacities { contacts, ..SMALL };
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).unwrap();
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.0, -0.5, 0.0),
        [5.0, 0.5, 5.0],
    );
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(0.0, 0.06, 0.0)))
        .unwrap();
    add_piece(&mut world, body, &PieceDef::new(shape, radius_m));
    let (mut flags, mut most) = (0, 0);
    for _ in 0..60 {
        let report = world.step(&FrameInput::unlimited(FRAME_S));
        assert_eq!(report.contacts as usize, world.contacts().len());
        flags |= report.flags;
        most = most.max(world.contacts().len());
        let pose = world.pose(body).unwrap();
        assert!(pose.is_finite());
    }
    (flags, most)
}

#[test]
fn contacts_full_by_one_are_reported() {
    // A box on its face needs four contacts, a sphere one.
    let (flags, most) = drop_on_floor(3, Shape::Box([0.05; 3]), 0.0);
    assert_ne!(flags & FrameReport::FULL_CONTACTS, 0);
    assert_eq!(most, 3);
    let (flags, _) = drop_on_floor(0, Shape::Point, 0.05);
    assert_ne!(flags & FrameReport::FULL_CONTACTS, 0);
    for (shape, radius) in [(Shape::Box([0.05; 3]), 0.0), (Shape::Point, 0.05)] {
        let (flags, most) = drop_on_floor(SMALL.contacts, shape, radius);
        assert_eq!(flags & FrameReport::FULL_CONTACTS, 0);
        assert!(most > 0);
    }
}

#[test]
fn high_water_marks_are_what_was_used_at_once() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    assert_eq!(world.high_water(), NOTHING);
    let hand = furnish(&mut world);
    let extra = add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.01));
    world.add_material().unwrap();
    world.remove_piece(extra).unwrap();
    world.remove_body(hand).unwrap();
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(-0.3, 0.2, 0.0),
        [0.05; 3],
    );
    let high = world.high_water();
    assert_eq!(
        (high.bodies, high.pieces, high.vertices, high.materials),
        (4, 5, 26, 1)
    );
    for frame in 0..120 {
        play(&mut world, hand, frame);
    }
    let high = world.high_water();
    assert!(high.pairs > 0 && high.pairs <= SMALL.pairs);
    assert!(high.contacts > 0 && high.contacts <= SMALL.contacts);

    // What the marks say is enough to ship.
    let mut block = Block::new(&high);
    let mut tight = World::create(block.bytes(), &high).unwrap();
    let hand = furnish(&mut tight);
    let mut flags = 0;
    for frame in 0..120 {
        let t = frame as f32 * FRAME_S;
        let target = Pose::at(-0.3 + 0.1 * t, 0.04 + 0.02 * (t - 1.0), 0.03 * t);
        tight.set_target(hand, &target).unwrap();
        flags |= tight.step(&FrameInput::unlimited(FRAME_S)).flags;
    }
    assert_eq!(
        flags & (FrameReport::FULL_PAIRS | FrameReport::FULL_CONTACTS),
        0
    );
}

#[test]
fn null_and_stale_ids_are_refused_and_change_nothing() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let piece = add_piece(&mut world, body, &PieceDef::new(Shape::Point, 0.1));
    world.remove_piece(piece).unwrap();
    world.remove_body(body).unwrap();
    let hash = world.hash();
    let beyond = BodyId {
        index1: SMALL.bodies + 1,
        generation: 1,
    };
    let last = BodyId {
        index1: u32::MAX,
        generation: u32::MAX,
    };
    let unused = BodyId {
        index1: 2,
        generation: 0,
    };
    for id in [BodyId::NULL, BodyId::default(), body, beyond, last, unused] {
        assert_eq!(world.pose(id), Err(BodyError::Stale));
        assert_eq!(world.remove_body(id), Err(BodyError::Stale));
        assert_eq!(world.place_body(id, &Pose::IDENTITY), Err(BodyError::Stale));
        assert_eq!(world.set_target(id, &Pose::IDENTITY), Err(BodyError::Stale));
        assert_eq!(world.set_piece_targets(id, &[]), Err(BodyError::Stale));
        assert_eq!(
            world.set_velocity(id, [0.0; 3], [0.0; 3]),
            Err(BodyError::Stale)
        );
        assert_eq!(world.velocity(id), Err(BodyError::Stale));
        assert_eq!(world.mass_kg(id), Err(BodyError::Stale));
        assert_eq!(world.driven_report(id), Err(BodyError::Stale));
        assert_eq!(
            world.add_piece(id, &PieceDef::new(Shape::Point, 0.1)),
            Err(AddPieceError::StaleBody)
        );
    }
    for id in [PieceId::NULL, piece] {
        assert_eq!(world.piece_pose(id), Err(BodyError::Stale));
        assert_eq!(world.remove_piece(id), Err(BodyError::Stale));
    }
    assert_eq!(world.hash(), hash);
}

#[test]
fn a_slot_used_again_gets_a_new_generation() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let def = BodyDef::new(BodyKind::Driven, Pose::IDENTITY);
    let mut seen: Vec<(BodyId, PieceId)> = Vec::new();
    for _ in 0..20 {
        let body = world.add_body(&def).unwrap();
        let piece = add_piece(&mut world, body, &PieceDef::new(Shape::Point, 0.1));
        assert_eq!((body.index1, piece.index1), (1, 1));
        for (old_body, old_piece) in &seen {
            assert_ne!(body.generation, old_body.generation);
            assert_ne!(piece.generation, old_piece.generation);
            assert_eq!(world.pose(*old_body), Err(BodyError::Stale));
            assert_eq!(world.piece_pose(*old_piece), Err(BodyError::Stale));
        }
        seen.push((body, piece));
        world.remove_body(body).unwrap();
    }
}

#[test]
fn a_removed_body_takes_its_pieces_along() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let wall = world
        .add_body(&BodyDef::new(BodyKind::Fixed, Pose::at(0.5, 0.0, 0.0)))
        .unwrap();
    let pieces = [0.0, 0.3].map(|z| {
        add_piece(
            &mut world,
            wall,
            &PieceDef {
                local: Pose::at(0.0, 0.0, z),
                ..PieceDef::new(Shape::Box([0.01, 0.2, 0.2]), 0.0)
            },
        )
    });
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    let through = Pose::at(1.0, 0.0, 0.0);
    world.set_target(hand, &through).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    assert!(world.pose(hand).unwrap().position[0] < 0.44);
    world.remove_body(wall).unwrap();
    for piece in pieces {
        assert_eq!(world.piece_pose(piece), Err(BodyError::Stale));
    }
    for _ in 0..120 {
        world.set_target(hand, &through).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
    }
    assert_eq!(world.pose(hand).unwrap(), through);
}

#[derive(Clone, Copy)]
struct Listed {
    piece: PieceId,
    local: Pose,
    half: f32,
    vertices: u32,
}

fn random_piece(random: &mut Random, world: &mut World, body: BodyId) -> Option<Listed> {
    let half = 0.01 + 0.05 * random.unit();
    let local = Pose::at(random.unit(), random.unit(), random.unit());
    let corners = [
        [half, -half, -half],
        [-half, half, -half],
        [-half, -half, half],
        [half, half, half],
    ];
    let (shape, radius, vertices) = match random.below(4) {
        0 => (Shape::Point, half, 1),
        1 => (Shape::Segment([-half, 0.0, 0.0], [half, 0.0, 0.0]), half, 2),
        2 => (Shape::Hull(&corners), 0.0, 4),
        _ => (Shape::Box([half; 3]), 0.0, 8),
    };
    let def = PieceDef {
        local,
        ..PieceDef::new(shape, radius)
    };
    let piece = world.add_piece(body, &def).ok()?;
    Some(Listed {
        piece,
        local,
        half,
        vertices,
    })
}

#[test]
fn pools_stay_whole_under_adding_and_removing_in_any_order() {
    let capacities = Capacities {
        bodies: 4,
        pieces: 24,
        vertices: 100,
        pairs: 64,
        contacts: 16,
        materials: 0,
        chains: 0,
        joints: 0,
    };
    for seed in 1..=8 {
        let mut random = Random(seed);
        let mut block = Block::new(&capacities);
        let mut world = World::create(block.bytes(), &capacities).unwrap();
        let place = Pose::at(1.0, 2.0, 3.0);
        let body = world
            .add_body(&BodyDef::new(BodyKind::Fixed, place))
            .unwrap();
        let probe = world
            .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
            .unwrap();
        let tip = add_piece(&mut world, probe, &PieceDef::new(Shape::Point, 0.005));
        let mut listed: Vec<Listed> = Vec::new();
        for _ in 0..400 {
            if random.below(5) < 3 {
                listed.extend(random_piece(&mut random, &mut world, body));
            } else if !listed.is_empty() {
                let gone = listed.swap_remove(random.below(listed.len()));
                world.remove_piece(gone.piece).unwrap();
            }
            let used: u32 = listed.iter().map(|l| l.vertices).sum();
            assert!(used < capacities.vertices);
        }
        for l in &listed {
            let expected = place.then(&l.local);
            assert_eq!(world.piece_pose(l.piece).unwrap(), expected, "seed {seed}");
        }
        // Whatever is left of the pools, a probe finds each surface where it was made.
        let shown: Vec<Listed> = listed.iter().take(4).copied().collect();
        for l in &listed[shown.len()..] {
            world.remove_piece(l.piece).unwrap();
        }
        for (index, l) in shown.iter().enumerate() {
            let clear = shown[index + 1..].iter().all(|other| apart(l, other));
            if clear {
                touch_from_above(&mut world, probe, place.then(&l.local).position, l.half);
            }
            world.remove_piece(l.piece).unwrap();
        }
        world.remove_piece(tip).unwrap();
        world.remove_body(body).unwrap();
        let body = world
            .add_body(&BodyDef::new(BodyKind::Fixed, place))
            .unwrap();
        for _ in 0..12 {
            add_piece(&mut world, body, &PieceDef::new(Shape::Box([0.1; 3]), 0.0));
        }
        for _ in 0..2 {
            add_piece(
                &mut world,
                body,
                &PieceDef::new(Shape::Segment([0.0; 3], [1.0; 3]), 0.1),
            );
        }
        let sphere = PieceDef::new(Shape::Point, 0.1);
        assert_eq!(
            world.add_piece(body, &sphere),
            Err(AddPieceError::FullVertices),
            "seed {seed}: 100 vertices were in use"
        );
    }
}

/// Whether two pieces are so far apart sideways that a probe above one misses the other: each
/// reaches 0.12 m from its middle at most.
fn apart(a: &Listed, b: &Listed) -> bool {
    let away = |axis: usize| (a.local.position[axis] - b.local.position[axis]).abs() > 0.15;
    away(0) || away(2)
}

/// A sphere of 5 mm comes down from 0.2 m above on the middle of a piece. All random pieces reach
/// at most `half` above their middle and at least `half` / 3 (the tetrahedron's surface there).
fn touch_from_above(world: &mut World, probe: BodyId, at: [f32; 3], half: f32) {
    let start = Pose::at(at[0], at[1] + 0.2, at[2]);
    world.place_body(probe, &start).unwrap();
    for _ in 0..12 {
        world
            .set_target(probe, &Pose::at(at[0], at[1] - 0.5, at[2]))
            .unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
    }
    let height = world.pose(probe).unwrap().position[1] - at[1] - 0.005;
    // 0.1 mm of rest gap, and the sphere may touch the tetrahedron's slope beside its middle.
    let range = half / 3.0..half + 1.1e-4;
    assert!(range.contains(&height), "{height} on a piece of {half}");
}

#[test]
fn a_piece_removed_from_the_middle_leaves_the_others_in_order() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let pieces =
        [1.0, 2.0, 3.0, 4.0].map(|r| add_piece(&mut world, hand, &PieceDef::new(Shape::Point, r)));
    world.remove_piece(pieces[1]).unwrap();
    world.remove_piece(pieces[0]).unwrap();
    let behind = add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 5.0));
    let targets = [10.0, 20.0, 30.0].map(|x| Pose::at(x, 0.0, 0.0));
    world.set_piece_targets(hand, &targets).unwrap();
    world.set_target(hand, &Pose::IDENTITY).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    let got = [pieces[2], pieces[3], behind].map(|id| world.piece_pose(id).unwrap());
    assert_eq!(got, targets);
}

#[test]
fn a_snapshot_rolls_back_to_the_bit() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = furnish(&mut world);
    let wood_on_skin = Surface {
        restitution: 0.5,
        friction: 0.7,
    };
    world
        .set_surface(Material::WOOD, Material::HUMAN, wood_on_skin)
        .unwrap();
    for frame in 0..40 {
        play(&mut world, hand, frame);
    }
    let mut buffer = vec![0xee; world.snapshot_bytes()];
    let written = world.save(&mut buffer).unwrap();
    assert!(written <= buffer.len());
    let saved = world.hash();
    let first: Vec<u64> = (40..120).map(|f| play(&mut world, hand, f)).collect();
    world.remove_body(hand).unwrap();
    world.set_gravity([1.0, 2.0, 3.0]);
    assert_ne!(world.hash(), saved);
    world.load(&buffer).unwrap();
    assert_eq!(world.hash(), saved);
    let second: Vec<u64> = (40..120).map(|f| play(&mut world, hand, f)).collect();
    assert_eq!(first, second);
}

#[test]
fn a_snapshot_restored_at_another_address_goes_on_with_equal_hashes() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = furnish(&mut world);
    for frame in 0..100 {
        play(&mut world, hand, frame);
    }
    let mut buffer = vec![0; world.snapshot_bytes()];
    world.save(&mut buffer).unwrap();

    let mut other_block = Block::new(&SMALL);
    other_block.bytes().fill(0xff);
    let mut other = World::create(other_block.bytes(), &SMALL).unwrap();
    let other_hand = furnish(&mut other);
    for frame in 0..37 {
        play(&mut other, other_hand, frame);
    }
    other.load(&buffer).unwrap();
    for frame in 100..400 {
        assert_eq!(
            play(&mut world, hand, frame),
            play(&mut other, hand, frame),
            "frame {frame}"
        );
    }
}

#[test]
fn a_bad_snapshot_is_refused_and_nothing_changes() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = furnish(&mut world);
    play(&mut world, hand, 0);
    let mut buffer = vec![0; world.snapshot_bytes()];
    assert_eq!(
        world.save(&mut vec![0; buffer.len() - 1]),
        Err(SnapshotError::TooSmall)
    );
    world.save(&mut buffer).unwrap();
    play(&mut world, hand, 1);
    let hash = world.hash();

    let others = Capacities {
        contacts: SMALL.contacts + 1,
        ..SMALL
    };
    let mut other_block = Block::new(&others);
    let other = World::create(other_block.bytes(), &others).unwrap();
    let mut foreign = vec![0; other.snapshot_bytes()];
    other.save(&mut foreign).unwrap();
    assert_eq!(world.load(&foreign), Err(SnapshotError::OtherLayout));
    assert_eq!(world.hash(), hash);

    for index in 0..HEADER_BYTES {
        buffer[index] ^= 0x10;
        // The version is judged before the rest: another layout may have another header.
        let expected = match index {
            16..20 => SnapshotError::OtherLayout,
            _ => SnapshotError::Damaged,
        };
        assert_eq!(world.load(&buffer), Err(expected), "byte {index}");
        buffer[index] ^= 0x10;
        assert_eq!(world.hash(), hash);
    }
    for length in [0, HEADER_BYTES - 1] {
        assert_eq!(world.load(&buffer[..length]), Err(SnapshotError::Damaged));
    }
    for length in [HEADER_BYTES, buffer.len() - 1] {
        assert_eq!(world.load(&buffer[..length]), Err(SnapshotError::TooSmall));
    }
    assert_eq!(world.hash(), hash);
    assert_eq!(world.load(&buffer), Ok(()));
}

#[test]
fn an_attached_world_can_be_filled_on() {
    let mut block = Block::new(&SMALL);
    let first = {
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        world
            .add_body(&BodyDef::new(BodyKind::Fixed, Pose::IDENTITY))
            .unwrap()
    };
    let mut world = World::attach(block.bytes()).unwrap();
    let second = world
        .add_body(&BodyDef::new(BodyKind::Fixed, Pose::at(1.0, 0.0, 0.0)))
        .unwrap();
    assert_ne!(first, second);
    assert_eq!(world.pose(first).unwrap(), Pose::IDENTITY);
    assert_eq!(world.pose(second).unwrap(), Pose::at(1.0, 0.0, 0.0));
}
