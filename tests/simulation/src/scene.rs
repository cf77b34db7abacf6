//! Random scenes: what stands around, what lies about, and who is tracked.

use glam::{DVec3, Vec3};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::geometry::reach_cone::ReachCone;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::chains::ChainOptions;
use palpable::state::materials::Material;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

use crate::cast::Cast;
use crate::draw::Draw;

/// How a scene is made and how its host behaves.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    /// Fixed bodies, beside the floor.
    pub fixed: u32,
    /// Dynamic bodies.
    pub dynamic: u32,
    /// Rigid driven bodies.
    pub hands: u32,
    /// Driven bodies with chains.
    pub figures: u32,
    /// Bodies of the host's own engine.
    pub hosted: u32,
    /// Centre of the scene, in the world.
    pub home: Vec3,
    /// A host call beside tracking comes about once in so many frames.
    pub calm: u32,
    /// Something is wrong with a tracker about once in so many frames.
    pub clean: u32,
    /// 0 unlimited, 1 none, 2 small, 3 drawn each frame.
    pub budget: u32,
    /// Whether the pools are too small for the scene.
    pub tight: bool,
    /// Whether time steps vary.
    pub uneven: bool,
}

impl Style {
    /// A style: mostly a hand or two and a few things, rarely a crowd.
    pub fn draw(draw: &mut impl Draw) -> Self {
        let large = draw.once_in(64);
        let most = |draw: &mut dyn FnMut(u32) -> u32, usual: u32, large_most: u32| {
            draw(1 + if large { large_most } else { usual })
        };
        let mut below = |bound: u32| draw.below(bound);
        let fixed = most(&mut below, 5, 40);
        let dynamic = [0, most(&mut below, 4, 16)][usize::from(below(3) > 0)];
        let hands = most(&mut below, 2, 4);
        let figures = if below(4) == 0 { 1 + below(2) } else { 0 };
        let hosted = if below(5) == 0 { 1 + below(2) } else { 0 };
        let far = [0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 100.0, 900.0][below(8) as usize];
        let calm = [4, 16, 64, 255][below(4) as usize];
        let clean = [8, 32, 128, 255][below(4) as usize];
        let budget = [0, 0, 0, 1, 2, 3, 3, 3][below(8) as usize];
        let (tight, uneven) = (below(8) == 0, below(3) == 0);
        Self {
            fixed,
            dynamic,
            hands: hands.max(u32::from(figures == 0)),
            figures,
            hosted,
            home: far * draw.vector(),
            calm,
            clean,
            budget,
            tight,
            uneven,
        }
    }

    /// Room for the scene and for what its host adds, or not quite.
    pub fn capacities(&self, draw: &mut impl Draw) -> Capacities {
        let bodies = 1 + self.fixed + self.dynamic + self.hands + self.figures + self.hosted;
        let mut room = Capacities {
            bodies: bodies + 3,
            pieces: 2 * bodies + 6 * self.figures + 6,
            vertices: 16 * bodies + 48,
            pairs: 64 + 24 * bodies,
            contacts: 32 + 16 * self.dynamic,
            materials: 2,
            chains: 3 * self.figures + 2,
            joints: 21 * self.figures + 6,
        };
        if self.tight {
            let part = |draw: &mut dyn FnMut(u32) -> u32, of: u32| draw(256) * of / 256;
            let mut below = |bound: u32| draw.below(bound);
            let which = below(8);
            match which {
                0 => room.bodies = part(&mut below, room.bodies),
                1 => room.pieces = part(&mut below, room.pieces),
                2 => room.vertices = part(&mut below, room.vertices),
                3 => room.pairs = part(&mut below, 32),
                4 => room.contacts = part(&mut below, 16),
                5 => room.chains = part(&mut below, room.chains),
                6 => room.joints = part(&mut below, room.joints),
                _ => room.pairs = part(&mut below, 8),
            }
        }
        room
    }
}

/// A piece that is still to be added.
#[derive(Clone, Debug)]
pub struct Recipe {
    kind: u32,
    points: Vec<[f32; 3]>,
    radius_m: f32,
    /// Its place on the body.
    pub local: Pose,
    material: Material,
    density_kg_m3: f32,
}

impl Recipe {
    /// A piece of about this half size, in metres.
    pub fn draw(draw: &mut impl Draw, half_m: f32) -> Self {
        let kind = draw.below(6);
        let count = match kind {
            0 => 0,
            1 => 2,
            2 | 3 => 1,
            _ => 4 + draw.below(9),
        };
        let stretch = Vec3::new(1.0, draw.between(0.2, 1.0), draw.between(0.1, 1.0));
        let point = |_| (half_m * stretch * draw.vector()).to_array();
        let points: Vec<[f32; 3]> = (0..count).map(point).collect();
        let round = kind < 2 || draw.once_in(4);
        Self {
            kind,
            points,
            radius_m: if round {
                half_m * draw.between(0.1, 0.6)
            } else {
                0.0
            },
            local: Pose::IDENTITY,
            material: Material(draw.below(4)),
            density_kg_m3: [700.0, 700.0, 2700.0, 30.0][draw.below(4) as usize],
        }
    }

    /// A box of these half extents.
    pub fn cuboid(half: [f32; 3]) -> Self {
        Self {
            kind: 2,
            points: vec![half],
            radius_m: 0.0,
            local: Pose::IDENTITY,
            material: Material::WOOD,
            density_kg_m3: 700.0,
        }
    }

    /// A capsule along Z from its origin, in metres.
    fn bone(length_m: f32, radius_m: f32) -> Self {
        Self {
            kind: 1,
            points: vec![[0.0; 3], [0.0, 0.0, length_m]],
            radius_m,
            ..Self::cuboid([0.0; 3])
        }
    }

    /// The piece as the kernel takes it.
    pub fn def(&self) -> PieceDef<'_> {
        let shape = match self.kind {
            0 => Shape::Point,
            1 => Shape::Segment(self.points[0], self.points[1]),
            2 | 3 => Shape::Box(self.points[0].map(f32::abs)),
            _ => Shape::Hull(&self.points),
        };
        PieceDef {
            local: self.local,
            material: self.material,
            density_kg_m3: self.density_kg_m3,
            ..PieceDef::new(shape, self.radius_m)
        }
    }

    /// The farthest that the piece reaches from the body's origin, in metres.
    fn reach_m(&self) -> f32 {
        let point = |p: &[f32; 3]| Vec3::from_array(*p).length();
        let core = self.points.iter().map(point).fold(0.0, f32::max);
        core + self.radius_m + self.local.translation().length()
    }
}

/// A coupling of usual or of extreme numbers.
pub fn coupling(draw: &mut impl Draw) -> Coupling {
    let mut coupling = Coupling {
        snap: [0, 0, 0, 0, 0, 0, 1, 2][draw.below(8) as usize],
        push: u32::from(draw.once_in(2)),
        ..Coupling::DEFAULT
    };
    if draw.once_in(4) {
        coupling.mass_kg = [1e-3, 0.05, 10.0, 1e5][draw.below(4) as usize];
        coupling.stiffness_n_per_m = [0.0, 10.0, 1e5, 1e9][draw.below(4) as usize];
        coupling.damping_n_s_per_m = [0.0, 1.0, 1e3, 1e9][draw.below(4) as usize];
        coupling.divergence_m = [1e-3, 0.05, 1e3, 1e9][draw.below(4) as usize];
        coupling.grace_s = [0.0, 0.01, 1.0, 1e9][draw.below(4) as usize];
    }
    coupling
}

/// Puts a scene into an empty world; what finds no room is left out.
pub fn build(draw: &mut impl Draw, style: &Style, world: &mut World, cast: &mut Cast) {
    for _ in 0..draw.below(3) {
        let _ = world.add_material();
    }
    floor(draw, style, world, cast);
    for _ in 0..style.fixed {
        let half_m = [0.1, 0.3, 0.3, 1.0][draw.below(4) as usize];
        add_body(draw, style, world, cast, BodyKind::Fixed, half_m);
    }
    for _ in 0..style.dynamic {
        add_body(draw, style, world, cast, BodyKind::Dynamic, 0.1);
    }
    for _ in 0..style.hosted {
        add_body(draw, style, world, cast, BodyKind::Hosted, 0.1);
    }
    for _ in 0..style.hands {
        add_body(draw, style, world, cast, BodyKind::Driven, 0.06);
    }
    for _ in 0..style.figures {
        add_figure(draw, style, world, cast);
    }
}

fn floor(draw: &mut impl Draw, style: &Style, world: &mut World, cast: &mut Cast) {
    if draw.once_in(4) {
        return;
    }
    let at = Pose::new(glam::Quat::IDENTITY, style.home - 1.1 * Vec3::Y);
    if let Ok(body) = cast.add_body(world, &BodyDef::new(BodyKind::Fixed, at)) {
        let slab = Recipe::cuboid([3.0, 0.1, 3.0]);
        let _ = cast.add_piece(world, body, &slab.def());
    }
}

/// Adds a body of some pieces where there is room, mostly.
pub fn add_body(
    draw: &mut impl Draw,
    style: &Style,
    world: &mut World,
    cast: &mut Cast,
    kind: BodyKind,
    half_m: f32,
) -> Option<BodyId> {
    let half_m = half_m * draw.between(0.3, 1.0);
    let more = if draw.once_in(2) { draw.below(3) } else { 0 };
    let pieces: Vec<Recipe> = (0..1 + more)
        .map(|number| {
            let mut piece = Recipe::draw(draw, half_m);
            if number > 0 || draw.once_in(4) {
                piece.local = draw.pose(half_m);
            }
            piece
        })
        .collect();
    let reach_m = pieces.iter().map(Recipe::reach_m).fold(0.0, f32::max);
    let pose = place(draw, style, world, cast, reach_m);
    let def = BodyDef {
        coupling: coupling(draw),
        ..BodyDef::new(kind, pose)
    };
    let body = cast.add_body(world, &def).ok()?;
    for piece in &pieces {
        let _ = cast.add_piece(world, body, &piece.def());
    }
    Some(body)
}

/// A place where a ball of this radius meets nobody, if one is soon found.
fn place(draw: &mut impl Draw, style: &Style, world: &World, cast: &Cast, reach_m: f32) -> Pose {
    let mut pose = Pose::IDENTITY;
    for _ in 0..6 {
        pose = draw.pose(1.0);
        pose = pose.moved(style.home);
        let at = pose.translation().as_dvec3();
        if cast.pieces.iter().all(|piece| {
            let seat = &world.piece_poses()[piece.id.index1 as usize - 1];
            let turn = seat.quat().as_dquat();
            let placed =
                crate::reference::Placed::new(&piece.solid, turn, seat.translation().as_dvec3());
            let [low, high] = placed.bounds();
            let away = (low - at).max(at - high).max(DVec3::ZERO).length();
            away > f64::from(reach_m)
        }) {
            break;
        }
    }
    pose
}

/// Adds a driven body with chains.
pub fn add_figure(
    draw: &mut impl Draw,
    style: &Style,
    world: &mut World,
    cast: &mut Cast,
) -> Option<BodyId> {
    let pose = place(draw, style, world, cast, 0.7);
    let def = BodyDef {
        coupling: coupling(draw),
        ..BodyDef::new(BodyKind::Driven, pose)
    };
    let body = cast.add_body(world, &def).ok()?;
    let torso = Recipe::cuboid([0.1, 0.15, 0.05]);
    let _ = cast.add_piece(world, body, &torso.def());
    let mut last = None;
    for _ in 0..1 + draw.below(3) {
        let base = last.filter(|_| draw.once_in(3)).map(|id| (id, 0));
        last = add_chain(draw, world, cast, body, base).or(last);
    }
    Some(body)
}

/// Adds a chain of random joints with bones on its links.
pub fn add_chain(
    draw: &mut impl Draw,
    world: &mut World,
    cast: &mut Cast,
    body: BodyId,
    base: Option<(ChainId, u32)>,
) -> Option<ChainId> {
    let mut at = 0.25 * draw.vector();
    let mut joints = Vec::new();
    for _ in 0..1 + draw.below(3) {
        joints.push(joint(draw, at));
        at = Vec3::Z * draw.between(0.0, 0.3);
    }
    let def = ChainDef {
        joints: &joints,
        base,
        options: options(draw),
    };
    let id = cast.add_chain(world, body, &def).ok()?;
    let mut hinge = 0;
    for joint in &joints {
        hinge += joint.hinge_count() as u32;
        let bone = Recipe::bone(draw.between(0.03, 0.25), draw.between(0.01, 0.04));
        if !draw.once_in(4) {
            let _ = cast.add_link_piece(world, id, hinge - 1, &bone.def());
        }
    }
    Some(id)
}

/// Options of any kind.
pub fn options(draw: &mut impl Draw) -> ChainOptions {
    ChainOptions {
        method: u32::from(draw.once_in(4)),
        flags: draw.below(32),
        attraction_s: draw.between(0.0, 0.1),
        tip: [0.0, 0.0, 0.05],
    }
}

fn joint(draw: &mut impl Draw, at: Vec3) -> JointDef {
    let rest = Pose::new(draw.turn(), at);
    if draw.once_in(2) {
        let (middle, half) = (draw.between(-0.5, 0.5), draw.between(0.0, 1.5));
        return JointDef::Hinge(Hinge {
            rest,
            axis: draw.vector() + Vec3::new(0.0, 0.0, 1.01),
            low_rad: middle - half,
            high_rad: middle + half,
        });
    }
    let count = 3 + draw.below(8);
    let corners: Vec<Vec3> = (0..count)
        .map(|index| {
            let turn = (index as f32 + draw.between(0.0, 0.4)) / count as f32;
            let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
            let wide = draw.between(0.3, 1.4);
            Vec3::new(wide.sin() * cos, wide.sin() * sin, wide.cos())
        })
        .collect();
    match ReachCone::new(Vec3::Z, &corners) {
        Ok(cone) => JointDef::Ball {
            rest,
            twist_low_rad: -draw.between(0.0, 1.0),
            twist_high_rad: draw.between(0.0, 1.0),
            cone,
        },
        Err(_) => JointDef::Hinge(Hinge {
            rest,
            axis: Vec3::X,
            low_rad: -1.0,
            high_rad: 1.0,
        }),
    }
}
