//! Pieces: what is refused, what sizes are accepted, what they weigh, and how each shape meets a
//! floor, judged by f64 arithmetic of its own.

mod common;

use common::{Block, add_box, add_piece};
use palpable::frame::FrameInput;
use palpable::limits::{OVERLAP_SLOP_M, PIECE_REACH_M, PIECE_VERTICES_MAX};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::BodyKind;
use palpable::state::materials::Material;
use palpable::world::{AddPieceError, BodyDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 60.0;

const PI: f64 = std::f64::consts::PI;

fn with_world<T>(run: impl FnOnce(&mut World) -> T) -> T {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    run(&mut world)
}

/// The corners of an octahedron of this radius.
fn octahedron(radius: f32) -> [[f32; 3]; 6] {
    let r = radius;
    [
        [r, 0.0, 0.0],
        [-r, 0.0, 0.0],
        [0.0, r, 0.0],
        [0.0, -r, 0.0],
        [0.0, 0.0, r],
        [0.0, 0.0, -r],
    ]
}

/// What is said of a piece, after checking that a refusal changed nothing.
fn error_of(def: &PieceDef) -> Option<AddPieceError> {
    with_world(|world| {
        let body = world
            .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY))
            .unwrap();
        add_piece(world, body, &PieceDef::new(Shape::Point, 0.1));
        let hash = world.hash();
        let error = world.add_piece(body, def).err();
        assert_eq!(world.hash() == hash, error.is_some(), "{def:?}");
        error
    })
}

#[test]
fn shapes_without_extent_are_degenerate() {
    let degenerate = Some(AddPieceError::Degenerate);
    let end = [0.1, 0.0, 0.0];
    let flat = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.3, 0.4, 0.0],
    ];
    let line = [0.0, 1.0, 2.0, 3.0].map(|x| [x, 2.0 * x, -x]);
    for (shape, radius) in [
        (Shape::Point, 0.0),
        (Shape::Segment([0.0; 3], end), 0.0),
        (Shape::Box([0.0; 3]), 0.0),
        (Shape::Box([0.1, 0.0, 0.1]), 0.0),
        (Shape::Hull(&flat), 0.0),
        (Shape::Hull(&line), 0.0),
        (Shape::Hull(&[[0.5; 3]; 8]), 0.0),
    ] {
        assert_eq!(
            error_of(&PieceDef::new(shape, radius)),
            degenerate,
            "{shape:?}"
        );
    }
}

#[test]
fn points_too_few_and_too_many_are_named() {
    let points: Vec<[f32; 3]> = (0..=PIECE_VERTICES_MAX)
        .map(|i| {
            let angle = i as f32;
            [angle.cos(), angle.sin(), (0.7 * angle).sin()]
        })
        .collect();
    for count in 0..4 {
        let def = PieceDef::new(Shape::Hull(&points[..count]), 0.0);
        assert_eq!(error_of(&def), Some(AddPieceError::TooFewPoints), "{count}");
    }
    let def = PieceDef::new(Shape::Hull(&points), 0.0);
    assert_eq!(error_of(&def), Some(AddPieceError::TooManyPoints));
    let def = PieceDef::new(Shape::Hull(&points[..PIECE_VERTICES_MAX]), 0.0);
    assert_eq!(error_of(&def), None);
}

#[test]
fn numbers_that_are_none_are_not_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut points = octahedron(0.1);
        points[3][2] = bad;
        let spoiled = [0.1, bad, 0.1];
        let sound = PieceDef::new(Shape::Point, 0.1);
        for def in [
            PieceDef::new(Shape::Hull(&points), 0.0),
            PieceDef::new(Shape::Segment(spoiled, [0.0; 3]), 0.1),
            PieceDef::new(Shape::Segment([0.0; 3], spoiled), 0.1),
            PieceDef::new(Shape::Box(spoiled), 0.0),
            PieceDef::new(Shape::Point, bad),
            PieceDef {
                density_kg_m3: bad,
                ..sound
            },
        ] {
            assert_eq!(error_of(&def), Some(AddPieceError::NotFinite), "{def:?}");
        }
    }
}

#[test]
fn what_is_beyond_the_world_is_too_large() {
    let far = 1.001 * PIECE_REACH_M;
    let points = octahedron(far);
    for def in [
        PieceDef::new(Shape::Hull(&points), 0.0),
        PieceDef::new(Shape::Segment([0.0; 3], [far, 0.0, 0.0]), 0.1),
        PieceDef::new(Shape::Box([0.1, far, 0.1]), 0.0),
        PieceDef::new(Shape::Point, far),
    ] {
        assert_eq!(error_of(&def), Some(AddPieceError::TooLarge), "{def:?}");
    }
}

#[test]
fn bad_radius_density_material_and_pose_are_named() {
    let sound = PieceDef::new(Shape::Point, 0.1);
    assert_eq!(error_of(&sound), None);
    for radius_m in [-0.1, -1e-30] {
        let def = PieceDef { radius_m, ..sound };
        assert_eq!(error_of(&def), Some(AddPieceError::BadNumber));
    }
    for density_kg_m3 in [0.0, -700.0] {
        let def = PieceDef {
            density_kg_m3,
            ..sound
        };
        assert_eq!(error_of(&def), Some(AddPieceError::BadNumber));
    }
    for material in [Material(3), Material(u32::MAX)] {
        let def = PieceDef { material, ..sound };
        assert_eq!(error_of(&def), Some(AddPieceError::UnknownMaterial));
    }
    let local = Pose {
        rotation: [0.0; 4],
        position: [0.0; 3],
    };
    let def = PieceDef { local, ..sound };
    assert_eq!(error_of(&def), Some(AddPieceError::BadPose));
}

/// How far a driven piece pressed on the floor is above it, given the extent below its origin.
fn gap_at_rest(shape: Shape, radius_m: f32, turn: [f32; 4], below: f64) -> f64 {
    with_world(|world| {
        // Top at y = 0, wide enough for the largest.
        add_box(
            world,
            BodyKind::Fixed,
            Pose::at(0.0, -50.0, 0.0),
            [500.0, 50.0, 500.0],
        );
        let at = |y: f64| Pose {
            rotation: turn,
            position: [0.3, y as f32, -0.2],
        };
        let body = world
            .add_body(&BodyDef::new(BodyKind::Driven, at(below * 1.5)))
            .unwrap();
        add_piece(world, body, &PieceDef::new(shape, radius_m));
        for _ in 0..60 {
            world.set_target(body, &at(below * 0.9)).unwrap();
            world.step(&FrameInput::unlimited(FRAME_S));
        }
        f64::from(world.pose(body).unwrap().position[1]) - below
    })
}

fn assert_rests(gap: f64, what: &str) {
    assert!(
        gap > 0.0 && gap <= f64::from(OVERLAP_SLOP_M),
        "{what}: {gap}"
    );
}

#[test]
fn every_shape_rests_within_a_tenth_of_a_millimetre_of_the_floor() {
    let none = [0.0, 0.0, 0.0, 1.0];
    // Turned by 2 atan2(3, 4) about z: rows (7, -24) / 25 and (24, 7) / 25.
    let tilted = [0.0, 0.0, 0.6, 0.8];
    let (cosine, sine) = (0.28, 0.96);
    let ends = Shape::Segment([-0.1, 0.0, 0.0], [0.1, 0.02, 0.0]);
    let hull = octahedron(0.1);
    let half = [0.1, 0.05, 0.02];
    for (what, shape, radius, turn, below) in [
        ("sphere", Shape::Point, 0.05, none, 0.05),
        ("sphere, turned", Shape::Point, 0.05, tilted, 0.05),
        ("capsule", ends, 0.03, none, 0.03),
        ("capsule, turned", ends, 0.03, tilted, 0.1 * sine + 0.03),
        ("box", Shape::Box(half), 0.0, none, 0.05),
        (
            "box, turned",
            Shape::Box(half),
            0.0,
            tilted,
            0.1 * sine + 0.05 * cosine,
        ),
        ("rounded box", Shape::Box(half), 0.01, none, 0.06),
        ("hull", Shape::Hull(&hull), 0.0, none, 0.1),
        ("hull, turned", Shape::Hull(&hull), 0.0, tilted, 0.1 * sine),
        (
            "rounded hull",
            Shape::Hull(&hull),
            0.02,
            tilted,
            0.1 * sine + 0.02,
        ),
    ] {
        // The sizes are f32 numbers: as such they are off by 1e-8 m at most.
        assert_rests(gap_at_rest(shape, radius, turn, below), what);
    }
}

#[test]
fn hulls_of_a_millimetre_and_of_a_hundred_metres_are_as_good() {
    let none = [0.0, 0.0, 0.0, 1.0];
    for size in [0.001_f32, 0.01, 0.1, 1.0, 10.0] {
        let points = octahedron(size);
        let gap = gap_at_rest(Shape::Hull(&points), 0.0, none, f64::from(size));
        assert_rests(gap, &format!("hull of {size} m"));
    }
    // At 100 m one spacing of f32 is 7.6 micrometres: the promise of 0.1 mm is 13 of them.
    let points = octahedron(100.0);
    let gap = gap_at_rest(Shape::Hull(&points), 0.0, none, 100.0);
    assert_rests(gap, "hull of 100 m");
}

fn mass_of(pieces: &[PieceDef]) -> f64 {
    with_world(|world| {
        let body = world
            .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY))
            .unwrap();
        for def in pieces {
            add_piece(world, body, def);
        }
        f64::from(world.mass_kg(body).unwrap())
    })
}

fn assert_near(got: f64, expected: f64, what: &str) {
    // Sizes, density and result are f32: a few roundings of 6e-8, three of them cubed.
    assert!(
        (got / expected - 1.0).abs() < 1e-6,
        "{what}: {got}, not {expected}"
    );
}

#[test]
fn bodies_weigh_what_their_volumes_say() {
    let boxed = PieceDef::new(Shape::Box([0.1, 0.2, 0.3]), 0.0);
    assert_near(mass_of(&[boxed]), 0.048 * 700.0, "box");
    let sphere = PieceDef::new(Shape::Point, 0.1);
    let ball = 4.0 / 3.0 * PI * 0.001;
    assert_near(mass_of(&[sphere]), ball * 700.0, "sphere");
    let capsule = PieceDef::new(Shape::Segment([0.0; 3], [0.0, 0.5, 0.0]), 0.1);
    let capsule_volume = ball + PI * 0.01 * 0.5;
    assert_near(mass_of(&[capsule]), capsule_volume * 700.0, "capsule");
    let points = octahedron(0.3);
    let hull = PieceDef::new(Shape::Hull(&points), 0.0);
    assert_near(mass_of(&[hull]), 4.0 / 3.0 * 0.027 * 700.0, "octahedron");
    let light = PieceDef {
        density_kg_m3: 10.0,
        local: Pose::at(1.0, 2.0, 3.0),
        ..sphere
    };
    assert_near(
        mass_of(&[boxed, light, hull]),
        0.048 * 700.0 + ball * 10.0 + 0.036 * 700.0,
        "compound",
    );
    assert_eq!(mass_of(&[]), 0.0);
}

#[test]
fn a_removed_piece_takes_its_mass_along() {
    with_world(|world| {
        let body = add_box(world, BodyKind::Dynamic, Pose::IDENTITY, [0.1; 3]);
        let alone = world.mass_kg(body).unwrap();
        let extra = add_piece(world, body, &PieceDef::new(Shape::Point, 0.3));
        assert!(world.mass_kg(body).unwrap() > alone);
        world.remove_piece(extra).unwrap();
        assert_eq!(world.mass_kg(body).unwrap(), alone);
    });
}

/// Distance of a point from an axis along z through (x, y).
fn from_axis(p: [f32; 3], x: f64, y: f64) -> f64 {
    ((f64::from(p[0]) - x).powi(2) + (f64::from(p[1]) - y).powi(2)).sqrt()
}

fn dumbbell(world: &mut World) -> BodyId {
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY))
        .unwrap();
    for (x, density_kg_m3) in [(-0.3, 900.0), (0.1, 300.0)] {
        let def = PieceDef {
            local: Pose::at(x, 0.0, 0.0),
            density_kg_m3,
            ..PieceDef::new(Shape::Point, 0.05)
        };
        add_piece(world, body, &def);
    }
    body
}

#[test]
fn a_compound_turns_about_its_centre_of_mass() {
    // Masses 3 to 1 at x = -0.3 and 0.1: the centre is at -0.2.
    with_world(|world| {
        world.set_gravity([0.0; 3]);
        let body = dumbbell(world);
        world.set_velocity(body, [0.0; 3], [0.0, 0.0, 2.0]).unwrap();
        for frame in 0..120 {
            world.step(&FrameInput::unlimited(FRAME_S));
            let origin = world.pose(body).unwrap().position;
            // 120 poses rounded to f32 at 0.2 m, at worst all the same way.
            assert!(
                (from_axis(origin, -0.2, 0.0) - 0.2).abs() < 4e-6,
                "frame {frame}: {origin:?}"
            );
        }
        let [_, _, z, w] = world.pose(body).unwrap().rotation.map(f64::from);
        // A principal axis: 2 rad/s for 2 s, found in 120 turns rounded to f32.
        let angle = 2.0 * z.atan2(w);
        let off = (angle - 4.0).rem_euclid(2.0 * PI);
        assert!(off.min(2.0 * PI - off) < 1e-4, "{angle} rad");
    });
}

#[test]
fn a_compound_keeps_its_angular_momentum() {
    // Spun about an axis that is none of its principal ones, it wobbles; the energy stays between
    // what the same momentum has about the least and the greatest principal moment.
    with_world(|world| {
        world.set_gravity([0.0; 3]);
        let body = dumbbell(world);
        let spin = [3.0, 0.0, 1.0];
        world.set_velocity(body, [0.0; 3], spin).unwrap();
        let mass = 4.0 / 3.0 * PI * 0.05_f64.powi(3) * 1200.0;
        let own = 0.4 * mass * 0.0025;
        let across = own + mass * 0.75 * 0.25 * 0.16;
        let momentum_squared = (own * 3.0).powi(2) + across.powi(2);
        let (least, greatest) = (momentum_squared / across, momentum_squared / own);
        for frame in 0..300 {
            world.step(&FrameInput::unlimited(FRAME_S));
            let (linear, angular) = world.velocity(body).unwrap();
            assert_eq!(linear, [0.0; 3]);
            let w = angular.map(f64::from);
            // I w . w = L . w, and L = (own 3, 0, across) never changes.
            let twice_energy = own * 3.0 * w[0] + across * w[2];
            assert!(
                twice_energy > least * 0.999 && twice_energy < greatest * 1.001,
                "frame {frame}: {twice_energy}"
            );
        }
    });
}
