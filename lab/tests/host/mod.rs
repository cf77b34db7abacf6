//! rapier3d as the engine of a host that leaves its hands to the kernel.
//!
//! Each frame as the kernel's documentation asks for it: tell the kernel where the engine's bodies are,
//! step the kernel, apply what it did to the bodies, step the engine. Floor and table are in both.
//! Gaps are judged in f64 by the lab's reference, from what both publish at the end of the frame.

use glam::DVec3;
use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, HostedImpulse};
use palpable::state::materials::{Material, Surface};
use palpable::world::{BodyDef, HostedInput, PieceDef, Shape, World};
use palpable_lab::compare::peer::{from_peer, to_peer};
use palpable_lab::memory::Block;
use palpable_lab::reference::{self, Placed, Solid, signed_distance};
use rapier3d::prelude as rapier;

/// Length of a frame, in seconds.
pub const FRAME_S: f32 = 1.0 / 90.0;

/// How deep a hand may overlap a loose body: promise P1, in metres.
pub const OVERLAP_M: f64 = 1e-3;

/// Coulomb's coefficient of everything.
pub const FRICTION: f32 = 0.5;

/// Of both, in m/s2.
const GRAVITY_M_S2: f32 = 9.81;

/// Height of the table's top, in metres.
pub const TABLE_M: f32 = 0.8;

/// A ball or a box, sizes in metres.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Its radius.
    Ball(f32),
    /// Its half extents.
    Box([f32; 3]),
}

impl Form {
    fn piece(self) -> PieceDef<'static> {
        match self {
            Self::Ball(radius) => PieceDef::new(Shape::Point, radius),
            Self::Box(half) => PieceDef::new(Shape::Box(half), 0.0),
        }
    }

    fn collider(self) -> rapier::ColliderBuilder {
        let collider = match self {
            Self::Ball(radius) => rapier::ColliderBuilder::ball(radius),
            Self::Box([x, y, z]) => rapier::ColliderBuilder::cuboid(x, y, z),
        };
        collider.friction(FRICTION).restitution(0.0)
    }

    fn solid(self) -> Solid {
        let solid = match self {
            Self::Ball(radius) => Solid::from_f32(&[[0.0; 3]], radius),
            Self::Box([x, y, z]) => {
                let corner = |bits: u32| {
                    let side = |bit: u32, half: f32| if bits & bit == 0 { -half } else { half };
                    [side(1, x), side(2, y), side(4, z)]
                };
                let corners: Vec<[f32; 3]> = (0..8).map(corner).collect();
                Solid::from_f32(&corners, 0.0)
            }
        };
        solid.expect("a solid")
    }
}

/// What a host takes from the kernel for a body that hands touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// What [`World::hosted_impulse`] says.
    Impulse,
    /// The way that the kernel foresaw: the body gets the velocity that brings it where its double is.
    Way,
}

/// A loose body of the engine and its double in the kernel.
struct Loose {
    engine: rapier::RigidBodyHandle,
    kernel: BodyId,
    solid: Solid,
}

struct Hand {
    body: BodyId,
    solid: Solid,
}

/// The host: an engine with loose bodies, and a kernel with hands.
pub struct Host<'a> {
    pub kernel: World<'a>,
    engine: rapier::PhysicsWorld,
    loose: Vec<Loose>,
    hands: Vec<Hand>,
    takes: Takes,
}

/// Memory for the kernel of a host.
pub fn block() -> Block {
    Block::new(&Capacities::ROOM)
}

impl<'a> Host<'a> {
    /// A room with a floor at y = 0 and a table.
    pub fn new(block: &'a mut Block, takes: Takes) -> Self {
        let mut kernel = World::create(block.bytes(), &Capacities::ROOM).expect("room");
        let surface = Surface {
            restitution: 0.0,
            friction: FRICTION,
        };
        let set = kernel.set_surface(Material::WOOD, Material::WOOD, surface);
        set.expect("a valid surface");
        let mut engine = rapier::PhysicsWorld::new();
        engine.integration_parameters.dt = FRAME_S;
        let mut host = Self {
            kernel,
            engine,
            loose: Vec::new(),
            hands: Vec::new(),
            takes,
        };
        host.add_fixed(Pose::at(0.0, -0.5, 0.0), [5.0, 0.5, 5.0]);
        host.add_fixed(Pose::at(0.0, TABLE_M - 0.02, 0.0), [1.0, 0.02, 0.5]);
        host
    }

    fn add_fixed(&mut self, pose: Pose, half: [f32; 3]) {
        let form = Form::Box(half);
        let body = self.kernel.add_body(&BodyDef::new(BodyKind::Fixed, pose));
        self.kernel
            .add_piece(body.expect("room"), &form.piece())
            .expect("room");
        let body = rapier::RigidBodyBuilder::fixed().pose(to_peer(&pose));
        self.engine.insert(body, form.collider());
    }

    /// Adds a loose body of this mass, in kg; its number.
    pub fn add_loose(&mut self, form: Form, mass_kg: f32, pose: Pose) -> usize {
        let kernel = self.kernel.add_body(&BodyDef::new(BodyKind::Hosted, pose));
        let kernel = kernel.expect("room");
        self.kernel.add_piece(kernel, &form.piece()).expect("room");
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(to_peer(&pose))
            .can_sleep(false);
        let engine = self.engine.insert(body, form.collider().mass(mass_kg)).0;
        self.loose.push(Loose {
            engine,
            kernel,
            solid: form.solid(),
        });
        self.loose.len() - 1
    }

    /// Adds a palm, a box with these half extents in metres; its number.
    pub fn add_palm(&mut self, half: [f32; 3], pose: Pose) -> usize {
        let form = Form::Box(half);
        let body = self.kernel.add_body(&BodyDef::new(BodyKind::Driven, pose));
        let body = body.expect("room");
        self.kernel.add_piece(body, &form.piece()).expect("room");
        self.hands.push(Hand {
            body,
            solid: form.solid(),
        });
        self.hands.len() - 1
    }

    /// Tells where a palm's tracker is.
    pub fn track(&mut self, palm: usize, target: &Pose) {
        let set = self.kernel.set_target(self.hands[palm].body, target);
        set.expect("a valid target");
    }

    /// One frame of both.
    pub fn step(&mut self) {
        let inputs: Vec<HostedInput> = self.loose.iter().map(|l| self.input(l)).collect();
        self.kernel.set_hosted(inputs).expect("valid bodies");
        self.kernel.step(&FrameInput::unlimited(FRAME_S));
        for loose in &self.loose {
            let given = self.kernel.hosted_impulse(loose.kernel);
            let to = self.kernel.pose(loose.kernel).expect("a hosted body");
            let body = &mut self.engine.bodies[loose.engine];
            hand_over(body, &given.expect("a hosted body"), &to, self.takes);
        }
        self.engine.step();
    }

    /// A loose body as the engine has it.
    fn input(&self, loose: &Loose) -> HostedInput {
        let body = &self.engine.bodies[loose.engine];
        let mass = &body.mass_properties().local_mprops;
        HostedInput {
            body: loose.kernel,
            pose: from_peer(body.position()),
            velocity: body.linvel().to_array(),
            spin: body.angvel().to_array(),
            mass_kg: mass.mass(),
            centre: mass.local_com.to_array(),
            moments: mass.principal_inertia().to_array(),
            axes: mass.principal_inertia_local_frame.to_array(),
        }
    }

    /// Where a loose body is.
    pub fn pose(&self, loose: usize) -> Pose {
        from_peer(self.engine.bodies[self.loose[loose].engine].position())
    }

    /// Velocity of a loose body's centre of mass, in m/s.
    pub fn velocity(&self, loose: usize) -> DVec3 {
        let body = &self.engine.bodies[self.loose[loose].engine];
        DVec3::from_array(body.linvel().to_array().map(f64::from))
    }

    /// Where a palm is.
    pub fn palm(&self, palm: usize) -> Pose {
        let pose = self.kernel.pose(self.hands[palm].body);
        pose.expect("a palm")
    }

    /// Gap of a palm and a loose body in metres, minus the depth where they overlap.
    pub fn gap_m(&self, palm: usize, loose: usize) -> f64 {
        let (palm_pose, loose_pose) = (self.palm(palm), self.pose(loose));
        let a = Placed::at(&self.hands[palm].solid, exact(&palm_pose));
        let b = Placed::at(&self.loose[loose].solid, exact(&loose_pose));
        signed_distance(&a, &b).value
    }
}

/// Gives a body what the kernel did to it.
///
/// The kernel foresees that a touched body moves at even speed, gravity at once. The engine spreads gravity
/// over its iterations, so that in each frame a body that is held up would rise by 3/8 g dt^2 = 0.45 mm
/// beyond what was foreseen: in a grip it climbs. So such a body gets the frame's gravity at once.
fn hand_over(body: &mut rapier::RigidBody, given: &HostedImpulse, to: &Pose, takes: Takes) {
    let touched = given.contacts > 0;
    body.set_gravity_scale(if touched { 0.0 } else { 1.0 }, true);
    if !touched {
        return;
    }
    if takes == Takes::Way {
        let (from, to) = (exact(&from_peer(body.position())), exact(to));
        let frame_s = f64::from(FRAME_S);
        let velocity = (to.position - from.position) / frame_s;
        let turn = (to.rotation * from.rotation.inverse()).to_scaled_axis();
        body.set_linvel(single(velocity), true);
        body.set_angvel(single(turn / frame_s), true);
        return;
    }
    let fall = rapier::Vector::new(0.0, -GRAVITY_M_S2 * FRAME_S * body.mass(), 0.0);
    body.apply_impulse(fall + rapier::Vector::from_array(given.impulse_n_s), true);
    body.apply_torque_impulse(rapier::Vector::from_array(given.angular_n_m_s), true);
}

fn single(v: DVec3) -> rapier::Vector {
    rapier::Vector::from_array(v.as_vec3().to_array())
}

fn exact(pose: &Pose) -> reference::Pose {
    reference::Pose::from_f32(pose.rotation, pose.position)
}

/// A place in f64.
pub fn place(pose: &Pose) -> DVec3 {
    DVec3::from_array(pose.position.map(f64::from))
}
