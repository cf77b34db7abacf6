//! The order of calls that leads to the same ids does not show: the state has the same bits.
//!
//! A world is filled by steps of which some need others. Any order that respects that is as good as any
//! other; orders are drawn from a seed, and the assertion that fails names it.

mod common;
#[path = "common/shapes.rs"]
mod shapes;

use common::{Block, add_box, add_piece};
use palpable::frame::FrameInput;
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::state::materials::{Material, Surface};
use palpable::state::pieces::Groups;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};
use shapes::Random;

const FRAMES: u32 = 90;

/// A world that is being filled, and the names of what is in it, in the order of their making.
struct Built {
    world: World<'static>,
    bodies: Vec<BodyId>,
    pieces: Vec<PieceId>,
    chains: Vec<ChainId>,
    materials: Vec<Material>,
}

/// One call, the steps that it needs, and what it does.
struct Step {
    name: &'static str,
    needs: &'static [&'static str],
    act: fn(&mut Built),
}

/// Steps that make ids need the one before of their kind: the ids are to be the same.
const STEPS: [Step; 22] = [
    step("floor", &[], |b| b.body(BodyKind::Fixed, [0.0, -0.5, 0.0])),
    step("crate", &["floor"], |b| {
        b.body(BodyKind::Dynamic, [0.0, 0.3, 0.0])
    }),
    step("hand", &["crate"], |b| {
        b.body(BodyKind::Driven, [-0.4, 0.1, 0.0])
    }),
    step("ball", &["hand"], |b| {
        b.body(BodyKind::Dynamic, [0.02, 0.9, 0.01])
    }),
    step("rubber", &[], |b| {
        b.materials.push(b.world.add_material().unwrap())
    }),
    step("ice", &["rubber"], |b| {
        b.materials.push(b.world.add_material().unwrap())
    }),
    step("floor's piece", &["floor"], |b| {
        b.piece(0, Shape::Box([2.0, 0.5, 2.0]), 0.0, 0)
    }),
    step(
        "crate's first",
        &["crate", "rubber", "floor's piece"],
        |b| {
            b.piece(1, Shape::Box([0.05, 0.05, 0.06]), 0.0, 3);
        },
    ),
    step("palm", &["hand", "crate's first"], |b| {
        b.piece(2, Shape::Box([0.02; 3]), 0.005, 1)
    }),
    step("crate's second", &["ice", "palm"], |b| {
        b.piece(
            1,
            Shape::Segment([0.0, 0.06, 0.0], [0.05, 0.06, 0.0]),
            0.02,
            4,
        );
    }),
    step("ball's piece", &["ball", "crate's second"], |b| {
        b.piece(3, Shape::Point, 0.04, 2)
    }),
    step("finger", &["hand"], Built::finger),
    step("finger's piece", &["finger", "ball's piece"], |b| {
        let shape = Shape::Segment([0.0; 3], [0.1, 0.0, 0.0]);
        let def = PieceDef::new(shape, 0.01);
        let piece = b.world.add_link_piece(b.chains[0], 1, &def).unwrap();
        b.pieces.push(piece);
    }),
    step("rubber on wood", &["rubber"], |b| b.surface(3, 0, 0.7, 0.9)),
    step("ice on wood", &["ice"], |b| b.surface(0, 4, 0.0, 0.0)),
    step("gravity", &[], |b| b.world.set_gravity([0.0, -5.0, 0.1])),
    step("groups", &["palm"], |b| {
        let groups = Groups {
            member_of: 2,
            passes: 4,
        };
        b.world.set_groups(b.pieces[2], groups).unwrap();
    }),
    step("options", &["finger"], |b| {
        let options = ChainOptions {
            attraction_s: 0.1,
            ..ChainOptions::DEFAULT
        };
        b.world.set_chain_options(b.chains[0], &options).unwrap();
    }),
    step("angles", &["finger"], |b| {
        b.world.set_angles(b.chains[0], &[0.1, 0.2]).unwrap();
    }),
    step("target", &["hand"], |b| {
        b.world
            .set_target(b.bodies[2], &Pose::at(-0.35, 0.1, 0.0))
            .unwrap();
    }),
    step("place", &["ball"], |b| {
        b.world
            .place_body(b.bodies[3], &Pose::at(0.01, 0.6, 0.01))
            .unwrap();
    }),
    step("velocity", &["crate's second"], |b| {
        let (linear, angular) = ([0.1, 0.0, 0.0], [0.0, 1.0, 0.5]);
        b.world.set_velocity(b.bodies[1], linear, angular).unwrap();
    }),
];

const fn step(name: &'static str, needs: &'static [&'static str], act: fn(&mut Built)) -> Step {
    Step { name, needs, act }
}

impl Built {
    fn new() -> Self {
        Self {
            world: empty(),
            bodies: vec![],
            pieces: vec![],
            chains: vec![],
            materials: vec![Material::WOOD, Material::HUMAN, Material::METAL],
        }
    }

    fn body(&mut self, kind: BodyKind, at: [f32; 3]) {
        let def = BodyDef::new(kind, Pose::at(at[0], at[1], at[2]));
        self.bodies.push(self.world.add_body(&def).unwrap());
    }

    fn piece(&mut self, body: usize, shape: Shape, radius_m: f32, material: usize) {
        let def = PieceDef {
            material: self.materials[material],
            ..PieceDef::new(shape, radius_m)
        };
        self.pieces
            .push(add_piece(&mut self.world, self.bodies[body], &def));
    }

    fn finger(&mut self) {
        let hinge = |x: f32| {
            JointDef::Hinge(Hinge {
                rest: Pose::at(x, 0.0, 0.0),
                axis: glam::Vec3::Z,
                low_rad: -1.0,
                high_rad: 1.0,
            })
        };
        let def = ChainDef {
            joints: &[hinge(0.03), hinge(0.1)],
            base: None,
            options: ChainOptions::DEFAULT,
        };
        self.chains
            .push(self.world.add_chain(self.bodies[2], &def).unwrap());
    }

    fn surface(&mut self, a: usize, b: usize, restitution: f32, friction: f32) {
        let surface = Surface {
            restitution,
            friction,
        };
        let (a, b) = (self.materials[a], self.materials[b]);
        self.world.set_surface(a, b, surface).unwrap();
    }

    /// Pushes with the hand, telling in one order or the other.
    fn frame(&mut self, frame: u32, angles_first: bool) {
        let far = 0.5 * frame as f32 / FRAMES as f32;
        let angles = [0.1 + far, 0.2 - far];
        if angles_first {
            self.world.set_angles(self.chains[0], &angles).unwrap();
        }
        let target = Pose::at(-0.35 + far, 0.1, 0.0);
        self.world.set_target(self.bodies[2], &target).unwrap();
        if !angles_first {
            self.world.set_angles(self.chains[0], &angles).unwrap();
        }
        self.world.step(&FrameInput::unlimited(1.0 / 90.0));
    }
}

fn empty() -> World<'static> {
    let block = Box::leak(Box::new(Block::new(&Capacities::ROOM)));
    World::create(block.bytes(), &Capacities::ROOM).unwrap()
}

/// Fills a world in the order that `pick` decides among the steps that are possible.
fn build(pick: &mut dyn FnMut(usize) -> usize) -> (Built, Vec<&'static str>) {
    let mut built = Built::new();
    let mut done: Vec<&str> = vec![];
    while done.len() < STEPS.len() {
        let possible: Vec<&Step> = STEPS
            .iter()
            .filter(|step| !done.contains(&step.name))
            .filter(|step| step.needs.iter().all(|need| done.contains(need)))
            .collect();
        let step = possible[pick(possible.len())];
        (step.act)(&mut built);
        done.push(step.name);
    }
    (built, done)
}

#[test]
fn the_order_of_calls_that_gives_the_same_ids_gives_the_same_bits() {
    let (mut usual, order) = build(&mut |_| 0);
    let at_start = usual.world.hash();
    let mut touched = false;
    for frame in 0..FRAMES {
        usual.frame(frame, false);
        touched |= !usual.world.contacts().is_empty();
    }
    assert!(touched, "nothing met anything");
    for seed in 0..40 {
        let mut random = Random(seed);
        let (mut other, other_order) = build(&mut |count| (random.bits() % count as u64) as usize);
        assert_ne!(order, other_order, "seed {seed} draws the usual order");
        assert_eq!(usual.bodies, other.bodies, "seed {seed}");
        assert_eq!(usual.pieces, other.pieces, "seed {seed}");
        assert_eq!(at_start, other.world.hash(), "seed {seed}: {other_order:?}");
        for frame in 0..FRAMES {
            other.frame(frame, true);
        }
        assert_eq!(
            usual.world.hash(),
            other.world.hash(),
            "seed {seed}: {other_order:?}"
        );
    }
}

/// A loose box of a size, as a body of its own.
fn add_loose(world: &mut World, half: f32, at: [f32; 3]) -> BodyId {
    let pose = Pose::at(at[0], at[1], at[2]);
    add_box(world, BodyKind::Dynamic, pose, [half, half, 1.5 * half])
}

/// What of a loose body a host can read, bit by bit.
fn seen(world: &World, body: BodyId) -> Vec<u32> {
    let pose = world.pose(body).unwrap();
    let (linear, angular) = world.velocity(body).unwrap();
    let numbers = [&pose.rotation[..], &pose.position, &linear, &angular].concat();
    numbers.into_iter().map(f32::to_bits).collect()
}

#[test]
fn what_was_there_before_changes_nothing_that_is_seen() {
    // The first two slots are used once or twice, with the same ids in the end; the pools of vertices were
    // filled in another order, and other high-water marks were reached. Both lie in the state and are hashed.
    let ground = |world: &mut World| {
        let pose = Pose::at(0.0, -0.5, 0.0);
        add_box(world, BodyKind::Fixed, pose, [2.0, 0.5, 2.0])
    };
    let (lower, upper) = ([0.0, 0.06, 0.0], [0.01, 0.18, 0.0]);
    let mut first = empty();
    let gone = add_loose(&mut first, 0.2, [0.0, 3.0, 0.0]);
    let first_upper = add_loose(&mut first, 0.04, upper);
    first.remove_body(gone).unwrap();
    let first_lower = add_loose(&mut first, 0.05, lower);
    ground(&mut first);
    let mut second = empty();
    let gone = add_loose(&mut second, 0.03, [9.0, 3.0, 0.0]);
    second.remove_body(gone).unwrap();
    let second_lower = add_loose(&mut second, 0.05, lower);
    let second_upper = add_loose(&mut second, 0.04, upper);
    ground(&mut second);
    assert_eq!([first_lower, first_upper], [second_lower, second_upper]);
    let mut touched = false;
    for frame in 0..FRAMES {
        let input = FrameInput::unlimited(1.0 / 90.0);
        assert_eq!(first.step(&input), second.step(&input), "frame {frame}");
        for body in [first_lower, first_upper] {
            assert_eq!(seen(&first, body), seen(&second, body), "frame {frame}");
        }
        assert_eq!(first.contacts(), second.contacts(), "frame {frame}");
        touched |= !first.contacts().is_empty();
    }
    assert!(touched, "nothing met anything");
}
