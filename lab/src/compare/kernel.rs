//! The kernel as an engine: its public interface, used as a host would.

use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::state::materials::{Material, Surface};
use palpable::world::{BodyDef, PieceDef, Shape, World};

use super::play::Engine;
use super::setting::{FRICTION, Fixed, Loose, LooseShape, RATE_HZ, Setting, Tracked};
use crate::hand_scene::SceneError;

/// Room for every setting.
pub const CAPACITIES: Capacities = Capacities {
    bodies: 32,
    pieces: 96,
    vertices: 1536,
    pairs: 1024,
    contacts: 256,
    materials: 1,
    chains: 0,
    joints: 0,
};

/// A setting in a world of the kernel.
pub struct Kernel<'a> {
    world: World<'a>,
    fixed: Vec<BodyId>,
    loose: Vec<BodyId>,
    hands: Vec<(BodyId, Vec<PieceId>)>,
}

fn refused(what: &str, why: impl std::fmt::Debug) -> SceneError {
    SceneError(format!("{what}: {why:?}"))
}

impl<'a> Kernel<'a> {
    /// Makes a world of [`CAPACITIES`] in the block and fills it.
    ///
    /// # Errors
    /// [`SceneError`] names what the world refused.
    pub fn new(block: &'a mut [u8], setting: &Setting) -> Result<Self, SceneError> {
        let world = World::create(block, &CAPACITIES).map_err(|why| refused("world", why))?;
        let mut kernel = Self {
            world,
            fixed: Vec::new(),
            loose: Vec::new(),
            hands: Vec::new(),
        };
        let grip = kernel.add_grip()?;
        for fixed in &setting.fixed {
            kernel.add_fixed(fixed)?;
        }
        for loose in &setting.loose {
            kernel.add_loose(loose, grip)?;
        }
        for hand in &setting.hands {
            kernel.add_hand(hand)?;
        }
        Ok(kernel)
    }

    /// Whether a loose thing sleeps.
    ///
    /// # Errors
    /// [`SceneError`] when it is not there.
    pub fn is_asleep(&self, index: usize) -> Result<bool, SceneError> {
        let asleep = self.world.is_asleep(self.loose[index]);
        asleep.map_err(|why| refused("loose", why))
    }

    /// What loose things are made of: it does not bounce.
    fn add_grip(&mut self) -> Result<Material, SceneError> {
        let world = &mut self.world;
        let grip = world
            .add_material()
            .map_err(|why| refused("material", why))?;
        let surface = Surface {
            restitution: 0.0,
            friction: FRICTION,
        };
        for other in [Material::WOOD, Material::HUMAN, grip] {
            world
                .set_surface(grip, other, surface)
                .map_err(|why| refused("surface", why))?;
        }
        Ok(grip)
    }

    fn add_body(&mut self, kind: BodyKind, pose: Pose) -> Result<BodyId, SceneError> {
        let def = BodyDef::new(kind, pose);
        self.world
            .add_body(&def)
            .map_err(|why| refused("body", why))
    }

    fn add_piece(&mut self, body: BodyId, def: &PieceDef) -> Result<PieceId, SceneError> {
        let piece = self.world.add_piece(body, def);
        piece.map_err(|why| refused("piece", why))
    }

    fn add_fixed(&mut self, fixed: &Fixed) -> Result<(), SceneError> {
        let body = self.add_body(BodyKind::Fixed, fixed.object.pose)?;
        for piece in &fixed.object.pieces {
            let shape = piece
                .half_extents
                .map_or(Shape::Hull(&piece.points), Shape::Box);
            let def = PieceDef {
                local: piece.local,
                ..PieceDef::new(shape, 0.0)
            };
            self.add_piece(body, &def)?;
        }
        self.fixed.push(body);
        Ok(())
    }

    fn add_loose(&mut self, loose: &Loose, material: Material) -> Result<(), SceneError> {
        let body = self.add_body(BodyKind::Dynamic, loose.pose)?;
        let (shape, radius_m) = match loose.shape {
            LooseShape::Sphere(radius_m) => (Shape::Point, radius_m),
            LooseShape::Box(half) => (Shape::Box(half), 0.0),
        };
        let def = PieceDef {
            material,
            density_kg_m3: loose.mass_kg / loose.shape.volume_m3(),
            ..PieceDef::new(shape, radius_m)
        };
        self.add_piece(body, &def)?;
        self.loose.push(body);
        Ok(())
    }

    fn add_hand(&mut self, hand: &Tracked) -> Result<(), SceneError> {
        let wrist = hand.wrist.first().copied().unwrap_or_default();
        let body = self.add_body(BodyKind::Driven, wrist)?;
        let mut pieces = Vec::new();
        for (points, &local) in hand.model.points.iter().zip(&hand.model.locals) {
            let def = PieceDef {
                local,
                material: Material::HUMAN,
                ..PieceDef::new(Shape::Hull(points), 0.0)
            };
            pieces.push(self.add_piece(body, &def)?);
        }
        self.hands.push((body, pieces));
        Ok(())
    }
}

impl Engine for Kernel<'_> {
    fn remove_fixed(&mut self, index: usize) -> Result<(), SceneError> {
        let removed = self.world.remove_body(self.fixed[index]);
        removed.map_err(|why| refused("fixed", why))
    }

    fn step(&mut self, wrists: &[Pose]) -> Result<(), SceneError> {
        for ((body, _), wrist) in self.hands.iter().zip(wrists) {
            let told = self.world.set_target(*body, wrist);
            told.map_err(|why| refused("target", why))?;
        }
        self.world.step(&FrameInput::unlimited(1.0 / RATE_HZ));
        Ok(())
    }

    fn parts(&self, hand: usize) -> Result<Vec<Pose>, SceneError> {
        let pieces = self.hands[hand].1.iter();
        pieces
            .map(|&piece| self.world.piece_pose(piece))
            .collect::<Result<_, _>>()
            .map_err(|why| refused("part", why))
    }

    fn loose(&self, index: usize) -> Result<Pose, SceneError> {
        let pose = self.world.pose(self.loose[index]);
        pose.map_err(|why| refused("loose", why))
    }
}
