//! A world being filled, and the same things for the judge.

use palpable::math::Pose;
use palpable::memory::{BodyId, ChainId, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::state::materials::Material;
use palpable::world::{BodyDef, PieceDef, Shape, World};

use crate::figures::{self, Figure};
use crate::hand::Hand;
use crate::hand_scene::{self, SceneError};
use crate::reference::{self, Judge, Solid};
use crate::script::HandTarget;

/// Things that a trial moves or judges.
#[derive(Default)]
pub struct Cast {
    /// Driven bodies, in the order in which they were added.
    pub driven: Vec<BodyId>,
    /// Chains of the driven bodies.
    pub chains: Vec<ChainId>,
    /// Pieces of the driven bodies: what is judged and compared.
    pub pieces: Vec<PieceId>,
    /// Dynamic bodies.
    pub loose: Vec<BodyId>,
}

/// Fills a world and tells the judge of all that is driven or fixed.
pub struct Set<'s, 'w> {
    /// The world.
    pub world: &'s mut World<'w>,
    /// What was added.
    pub cast: Cast,
    /// Knows the fixed pieces, and the driven ones in the order of [`Cast::pieces`].
    pub judge: Judge,
    groups: u32,
}

fn refused(what: &str, why: impl std::fmt::Debug) -> SceneError {
    SceneError(format!("{what}: {why:?}"))
}

fn reference_pose(pose: &Pose) -> reference::Pose {
    reference::Pose::from_f32(pose.rotation, pose.position)
}

/// Corners of a box.
fn corners(half: [f32; 3]) -> Vec<[f32; 3]> {
    let sign = |bits: usize, axis: usize| if bits >> axis & 1 == 0 { -1.0 } else { 1.0 };
    (0..8)
        .map(|bits| std::array::from_fn(|axis| sign(bits, axis) * half[axis]))
        .collect()
}

const DRIVEN: &str = "driven";
/// What the judge calls fixed things.
pub const FIXED: &str = "fixed";

impl<'s, 'w> Set<'s, 'w> {
    /// Around an empty world.
    pub fn new(world: &'s mut World<'w>) -> Self {
        Self {
            world,
            cast: Cast::default(),
            judge: Judge::new(),
            groups: 0,
        }
    }

    fn group(&mut self) -> u32 {
        self.groups += 1;
        self.groups
    }

    fn body(&mut self, kind: BodyKind, pose: Pose) -> Result<BodyId, SceneError> {
        let def = BodyDef::new(kind, pose);
        self.world.add_body(&def).map_err(|e| refused("body", e))
    }

    /// A fixed box.
    ///
    /// # Errors
    /// [`SceneError`] names what was refused, as for all others here.
    pub fn fixed_box(&mut self, pose: Pose, half: [f32; 3]) -> Result<(), SceneError> {
        let body = self.body(BodyKind::Fixed, pose)?;
        let piece = PieceDef::new(Shape::Box(half), 0.0);
        self.world
            .add_piece(body, &piece)
            .map_err(|e| refused("box", e))?;
        let solid = Solid::from_f32(&corners(half), 0.0).map_err(|e| refused("box", e))?;
        let group = self.group();
        self.judge
            .add_fixed(solid, group, FIXED, "box", reference_pose(&pose));
        Ok(())
    }

    /// A floor at height zero and four walls around it: inner half extents and height.
    ///
    /// # Errors
    /// As above.
    pub fn bin(&mut self, half_x: f32, half_z: f32, height: f32) -> Result<(), SceneError> {
        let (thick, mid) = (0.1, 0.5 * height);
        self.fixed_box(
            Pose::at(0.0, -thick, 0.0),
            [half_x + 0.2, thick, half_z + 0.2],
        )?;
        for side in [-1.0, 1.0] {
            let x = side * (half_x + thick);
            self.fixed_box(Pose::at(x, mid, 0.0), [thick, mid, half_z + 0.2])?;
            let z = side * (half_z + thick);
            self.fixed_box(Pose::at(0.0, mid, z), [half_x, mid, thick])?;
        }
        Ok(())
    }

    /// The gallery of the paper's scene.
    ///
    /// # Errors
    /// As above.
    pub fn gallery(&mut self) -> Result<(), SceneError> {
        for object in crate::gallery::gallery() {
            let body = self.body(BodyKind::Fixed, object.pose)?;
            let group = self.group();
            for piece in &object.pieces {
                let shape = piece
                    .half_extents
                    .map_or(Shape::Hull(&piece.points), Shape::Box);
                let def = PieceDef {
                    local: piece.local,
                    ..PieceDef::new(shape, 0.0)
                };
                self.world
                    .add_piece(body, &def)
                    .map_err(|e| refused(object.name, e))?;
                let solid =
                    Solid::from_f32(&piece.points, 0.0).map_err(|e| refused(object.name, e))?;
                let pose = reference_pose(&object.pose.then(&piece.local));
                self.judge.add_fixed(solid, group, FIXED, object.name, pose);
            }
        }
        Ok(())
    }

    /// A dynamic body of one piece.
    ///
    /// # Errors
    /// As above.
    pub fn loose(&mut self, pose: Pose, shape: Shape, radius_m: f32) -> Result<(), SceneError> {
        let body = self.body(BodyKind::Dynamic, pose)?;
        self.world
            .add_piece(body, &PieceDef::new(shape, radius_m))
            .map_err(|e| refused("loose piece", e))?;
        self.cast.loose.push(body);
        Ok(())
    }

    /// A driven body of rounded boxes in a row along x, each of these half extents.
    ///
    /// # Errors
    /// As above.
    pub fn paddle(&mut self, pose: Pose, half: [f32; 3], count: usize) -> Result<(), SceneError> {
        let body = self.body(BodyKind::Driven, pose)?;
        let group = self.group();
        let radius_m = 0.005;
        for index in 0..count {
            let along = (index as f32 - 0.5 * (count as f32 - 1.0)) * 2.2 * half[0];
            let def = PieceDef {
                local: Pose::at(along, 0.0, 0.0),
                material: Material::HUMAN,
                ..PieceDef::new(Shape::Box(half), radius_m)
            };
            let piece = self
                .world
                .add_piece(body, &def)
                .map_err(|e| refused("paddle", e))?;
            let solid =
                Solid::from_f32(&corners(half), radius_m).map_err(|e| refused("paddle", e))?;
            self.judge.add_moving(solid, group, DRIVEN, "paddle");
            self.cast.pieces.push(piece);
        }
        self.cast.driven.push(body);
        Ok(())
    }

    /// The lab's hand in one piece of rigid parts.
    ///
    /// # Errors
    /// As above.
    pub fn hand(&mut self, hand: &Hand, first: &HandTarget) -> Result<(), SceneError> {
        let (body, pieces) = hand_scene::add_hand(self.world, hand, first)?;
        let group = self.group();
        for part in &hand.parts {
            let solid = Solid::from_f32(&part.vertices, 0.0).map_err(|e| refused(&part.name, e))?;
            self.judge.add_moving(solid, group, DRIVEN, &part.name);
        }
        self.cast.driven.push(body);
        self.cast.pieces.extend(pieces);
        Ok(())
    }

    /// A skeleton with pieces.
    ///
    /// # Errors
    /// As above.
    pub fn figure(
        &mut self,
        figure: &Figure,
        body: &BodyDef,
        options: &ChainOptions,
    ) -> Result<(), SceneError> {
        let ids = figures::add(self.world, figure, body, options)?;
        let group = self.group();
        for piece in &figure.pieces {
            let solid = Solid::from_f32(&piece.points, piece.radius_m)
                .map_err(|e| refused(&piece.name, e))?;
            self.judge.add_moving(solid, group, DRIVEN, &piece.name);
        }
        self.cast.driven.push(ids.body);
        self.cast.chains.extend(ids.chains);
        self.cast.pieces.extend(ids.pieces);
        Ok(())
    }
}
