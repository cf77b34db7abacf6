//! Adding and removing pieces.

use super::World;
use crate::geometry::hull::{HullBuilder, HullError, HullView};
use crate::geometry::mass::{MassProperties, MassSum};
use crate::limits::{DENSITY_MAX, PIECE_REACH_M, WORLD_REACH_M};
use crate::math::{self, Pose};
use crate::memory::ids::free_slot;
use crate::memory::{BodyId, PieceId};
use crate::publish::place_pieces;
use crate::recording::{CallKind, calls};
use crate::state::bodies::{BodyKind, BodyMass};
use crate::state::materials::Material;
use crate::state::pieces::{Groups, PiecesOf, PoolUse, Touched};
use glam::Vec3;

/// The core of a piece in its own frame. A [`PieceDef`]'s radius rounds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<'a> {
    /// A point: with its radius, a sphere.
    Point,
    /// A segment between two points: with its radius, a capsule.
    Segment([f32; 3], [f32; 3]),
    /// A box with these half extents, centred, in metres.
    Box([f32; 3]),
    /// The hull of at most [`crate::limits::PIECE_VERTICES_MAX`] points, in metres. Points inside the
    /// hull are left out.
    Hull(&'a [[f32; 3]]),
}

/// What a piece is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceDef<'a> {
    /// The core.
    pub shape: Shape<'a>,
    /// Rounding radius in metres, 0 or more.
    pub radius_m: f32,
    /// Pose in the body's frame.
    pub local: Pose,
    /// Surface.
    pub material: Material,
    /// Density in kg/m3, above zero and at most [`DENSITY_MAX`]; looked at for dynamic bodies only.
    pub density_kg_m3: f32,
}

impl<'a> PieceDef<'a> {
    /// A wooden piece of 700 kg/m3 in the body's own frame.
    #[must_use]
    pub const fn new(shape: Shape<'a>, radius_m: f32) -> Self {
        Self {
            shape,
            radius_m,
            local: Pose::IDENTITY,
            material: Material::WOOD,
            density_kg_m3: 700.0,
        }
    }
}

/// Why a piece was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddPieceError {
    /// The id names no body of this world.
    StaleBody,
    /// The id names no chain of this world.
    StaleChain,
    /// The chain has no such hinge.
    UnknownHinge,
    /// No room: raise [`crate::memory::Capacities::pieces`].
    FullPieces,
    /// No room: raise [`crate::memory::Capacities::vertices`].
    FullVertices,
    /// Fewer points than a hull needs.
    TooFewPoints,
    /// More points than [`crate::limits::PIECE_VERTICES_MAX`].
    TooManyPoints,
    /// A coordinate, the radius or the density is not finite.
    NotFinite,
    /// A coordinate or the radius is beyond [`PIECE_REACH_M`].
    TooLarge,
    /// The shape is flat, or a sphere or capsule without radius, or a box without extent.
    Degenerate,
    /// The radius is negative, or the density is not above zero or beyond [`DENSITY_MAX`].
    BadNumber,
    /// The local pose is not finite, too far away, or its orientation has no length.
    BadPose,
    /// The world has no such material.
    UnknownMaterial,
}

impl From<HullError> for AddPieceError {
    fn from(error: HullError) -> Self {
        match error {
            HullError::TooFew => Self::TooFewPoints,
            HullError::TooMany => Self::TooManyPoints,
            HullError::NotFinite => Self::NotFinite,
            HullError::TooLarge => Self::TooLarge,
            HullError::Degenerate => Self::Degenerate,
        }
    }
}

impl World<'_> {
    /// Adds a piece to a body, behind those it has. Builds hulls on the stack, in about
    /// [`size_of::<HullBuilder>`] bytes.
    ///
    /// # Errors
    /// [`AddPieceError`]; on an error nothing has changed.
    pub fn add_piece(&mut self, body: BodyId, def: &PieceDef) -> Result<PieceId, AddPieceError> {
        self.recorded(
            CallKind::AddPiece,
            |to| {
                to.pod(&body);
                calls::put_piece(to, def);
            },
            |world| world.take_piece(body, def),
        )
    }

    fn take_piece(&mut self, body: BodyId, def: &PieceDef) -> Result<PieceId, AddPieceError> {
        let body = self
            .body_index(body)
            .map_err(|_| AddPieceError::StaleBody)?;
        self.add_piece_at(body, 0, def)
    }

    /// Adds a piece to a link, index plus one, or to the root.
    pub(super) fn add_piece_at(
        &mut self,
        body: usize,
        on_link: u32,
        def: &PieceDef,
    ) -> Result<PieceId, AddPieceError> {
        let local = self.judge(def)?;
        let mut builder = HullBuilder::new();
        let hull = build(&mut builder, def)?;
        let slot = self.store(&hull, def)?;
        let pieces = &mut self.state.pieces;
        pieces.generation[slot] = pieces.generation[slot].wrapping_add(1);
        pieces.body[slot] = body as u32;
        pieces.body_kind[slot] = self.state.bodies.kind[body];
        pieces.material[slot] = def.material.0;
        pieces.density[slot] = def.density_kg_m3;
        pieces.link[slot] = on_link;
        pieces.groups[slot] = Groups::default();
        pieces.local[slot] = local;
        pieces.local_target[slot] = local;
        pieces.touched[slot] = Touched::default();
        let id = PieceId::new(slot, pieces.generation[slot]);
        self.link(body, slot);
        let slots = &mut self.state.registers.piece_slots;
        *slots = (*slots).max(slot as u32 + 1);
        self.weigh(body);
        place_pieces(&mut self.state, body);
        self.wake_all();
        self.state.note_use();
        Ok(id)
    }

    /// What can be refused before building; the normalised local pose.
    fn judge(&self, def: &PieceDef) -> Result<Pose, AddPieceError> {
        if !def.radius_m.is_finite() || !def.density_kg_m3.is_finite() {
            return Err(AddPieceError::NotFinite);
        }
        if def.radius_m < 0.0 || def.density_kg_m3 <= 0.0 || def.density_kg_m3 > DENSITY_MAX {
            return Err(AddPieceError::BadNumber);
        }
        if def.radius_m > PIECE_REACH_M {
            return Err(AddPieceError::TooLarge);
        }
        if !self.has_material(def.material) {
            return Err(AddPieceError::UnknownMaterial);
        }
        def.local
            .normalised(WORLD_REACH_M)
            .ok_or(AddPieceError::BadPose)
    }

    /// Copies a hull into the pools; the slot that it belongs to, not yet in use.
    fn store(&mut self, hull: &HullView, def: &PieceDef) -> Result<usize, AddPieceError> {
        let slot = free_slot(self.state.pieces.generation).ok_or(AddPieceError::FullPieces)?;
        let convex = hull.convex(def.radius_m);
        let used = self.pool_use();
        let room = self.state.header.capacities.vertices - self.state.registers.vertices;
        let fits = convex.vertex_count as u32 <= room && self.state.pools.has_room(&used, &convex);
        if !fits {
            return Err(AddPieceError::FullVertices);
        }
        let shape = self.state.pools.append(&used, &convex);
        self.state.pieces.shape[slot] = shape;
        let registers = &mut *self.state.registers;
        registers.vertices += shape.vertices;
        registers.lanes += shape.lanes;
        registers.faces += shape.faces;
        registers.edges += shape.edges;
        registers.loops += shape.loops;
        Ok(slot)
    }

    fn pool_use(&self) -> PoolUse {
        let registers = &self.state.registers;
        PoolUse {
            lanes: registers.lanes,
            faces: registers.faces,
            edges: registers.edges,
            loops: registers.loops,
        }
    }

    /// Hangs a piece behind the last one of its body.
    fn link(&mut self, body: usize, slot: usize) {
        let first = self.state.bodies.first_piece[body];
        let last = PiecesOf::new(self.state.pieces.next, first).last();
        self.state.pieces.next[slot] = 0;
        match last {
            Some(last) => self.state.pieces.next[last] = slot as u32 + 1,
            None => self.state.bodies.first_piece[body] = slot as u32 + 1,
        }
    }

    /// Removes a piece. Cost: one pass over the pools.
    ///
    /// # Errors
    /// [`super::BodyError::Stale`].
    pub fn remove_piece(&mut self, id: PieceId) -> Result<(), super::BodyError> {
        self.recorded(
            CallKind::RemovePiece,
            |to| to.pod(&id),
            |world| world.drop_piece(id),
        )
    }

    fn drop_piece(&mut self, id: PieceId) -> Result<(), super::BodyError> {
        let piece = id
            .find(self.state.pieces.generation)
            .ok_or(super::BodyError::Stale)?;
        self.remove_piece_at(piece);
        Ok(())
    }

    pub(super) fn remove_piece_at(&mut self, piece: usize) {
        let body = self.state.pieces.body[piece] as usize;
        self.unlink(body, piece);
        let used = self.pool_use();
        let shape = self.state.pieces.shape[piece];
        self.state.pools.remove(&used, &shape);
        for other in self.state.pieces.shape.iter_mut() {
            other.move_down(&shape);
        }
        let registers = &mut *self.state.registers;
        registers.vertices -= shape.vertices;
        registers.lanes -= shape.lanes;
        registers.faces -= shape.faces;
        registers.edges -= shape.edges;
        registers.loops -= shape.loops;
        let pieces = &mut self.state.pieces;
        pieces.generation[piece] = pieces.generation[piece].wrapping_add(1);
        pieces.body_kind[piece] = 0;
        pieces.shape[piece] = Default::default();
        self.weigh(body);
        self.wake_all();
    }

    fn unlink(&mut self, body: usize, piece: usize) {
        let after = self.state.pieces.next[piece];
        let first = self.state.bodies.first_piece[body];
        if first as usize == piece + 1 {
            self.state.bodies.first_piece[body] = after;
            return;
        }
        let before = PiecesOf::new(self.state.pieces.next, first)
            .find(|&other| self.state.pieces.next[other] as usize == piece + 1);
        if let Some(before) = before {
            self.state.pieces.next[before] = after;
        }
    }

    /// Recomputes what a dynamic body weighs. What is left of it moves as it did.
    fn weigh(&mut self, body: usize) {
        if self.state.bodies.kind[body] != BodyKind::Dynamic.code() {
            return;
        }
        let mut sum = MassSum::new();
        let first = self.state.bodies.first_piece[body];
        for piece in PiecesOf::new(self.state.pieces.next, first) {
            let convex = self.state.pools.convex(&self.state.pieces.shape[piece]);
            let density = self.state.pieces.density[piece];
            if let Ok(part) = MassProperties::of_piece(&convex, density) {
                sum.add(&self.state.pieces.local[piece], &part);
            }
        }
        let bodies = &mut self.state.bodies;
        let rotation = bodies.pose[body].quat();
        let (before, now) = (bodies.mass[body], body_mass(&sum));
        bodies.mass[body] = now;
        bodies.momentum[body].reweigh(&before, &now, rotation);
    }
}

fn build<'a>(builder: &'a mut HullBuilder, def: &PieceDef) -> Result<HullView<'a>, AddPieceError> {
    let round = def.radius_m > 0.0;
    let hull = match def.shape {
        Shape::Point if !round => return Err(AddPieceError::Degenerate),
        Shape::Segment(..) if !round => return Err(AddPieceError::Degenerate),
        Shape::Point => builder.sphere(Vec3::ZERO)?,
        Shape::Segment(a, b) => builder.capsule(Vec3::from_array(a), Vec3::from_array(b))?,
        Shape::Box(half) => builder.cuboid(Vec3::from_array(half))?,
        Shape::Hull(points) => builder.build(points)?,
    };
    Ok(hull)
}

fn body_mass(sum: &MassSum) -> BodyMass {
    let Some(total) = sum.total() else {
        return BodyMass::default();
    };
    let principal = total.principal();
    let moments = principal.moments;
    // Of a grain so light that f32 has no inverse: it counts as none, and nothing moves it.
    let inverse = |moment: f32| {
        let inverse = 1.0 / moment;
        if moment > 0.0 && inverse.is_finite() {
            inverse
        } else {
            0.0
        }
    };
    BodyMass {
        mass_kg: total.mass_kg,
        inverse_mass: inverse(total.mass_kg),
        centre: total.centre,
        moments,
        inverse_moments: Vec3::new(inverse(moments.x), inverse(moments.y), inverse(moments.z)),
        axes: math::renormalised(principal.rotation).to_array(),
    }
}
