//! What a host has put into a world: the bodies, pieces and chains that are to be judged.

use std::sync::Arc;

use palpable::geometry::chain::{Ball, Hinge, JointDef};
use palpable::math::Pose;
use palpable::memory::{BodyId, ChainId, PieceId};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::chains::ChainOptions;
use palpable::state::pieces::Groups;
use palpable::world::{
    AddBodyError, AddChainError, AddPieceError, BodyDef, BodyError, ChainDef, ChainError,
    HostedError, HostedInput, PieceDef, Shape, World,
};

use crate::reference::Solid;

/// A body, as the host made it.
#[derive(Clone, Debug)]
pub struct BodyOf {
    /// Its id.
    pub id: BodyId,
    /// What moves it.
    pub kind: BodyKind,
    /// Its spring.
    pub coupling: Coupling,
}

/// The link that a piece is on, for the rule that neighbours may overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The chain and the hinge; nothing for the root.
    pub on: Option<(ChainId, u32)>,
    /// The first hinge in the same place; nothing for the root's own.
    origin: Option<(ChainId, u32)>,
    /// The origin of the link before that one. The root has none.
    before: Option<Option<(ChainId, u32)>>,
}

impl Link {
    const ROOT: Self = Self {
        on: None,
        origin: None,
        before: None,
    };

    /// Whether one of the two is the other's neighbour toward the root.
    #[must_use]
    pub fn is_next_to(&self, other: &Self) -> bool {
        self.before == Some(other.origin) || other.before == Some(self.origin)
    }

    /// The chain that the link is of; nothing for the root.
    #[must_use]
    pub fn chain(&self) -> Option<ChainId> {
        self.on.map(|(chain, _)| chain)
    }
}

/// A piece, as the host made it.
#[derive(Clone, Debug)]
pub struct PieceOf {
    /// Its id.
    pub id: PieceId,
    /// Its body.
    pub body: BodyId,
    /// What moves its body.
    pub kind: BodyKind,
    /// Its shape in f64.
    pub solid: Arc<Solid>,
    /// The link that it is on.
    pub link: Link,
    /// Whom it passes through.
    pub groups: Groups,
}

/// A chain, as the host made it.
#[derive(Clone, Debug)]
pub struct ChainOf {
    /// Its id.
    pub id: ChainId,
    /// Its body.
    pub body: BodyId,
    /// What it hangs on.
    pub base: Option<(ChainId, u32)>,
    /// Its hinges in their order.
    pub hinges: Vec<Hinge>,
    /// The cones of its balls.
    pub balls: Vec<Ball>,
    /// How many joints it was made of.
    pub joints: usize,
    /// How it answers contact.
    pub options: ChainOptions,
}

/// All that a host has put into a world, kept up by doing so through it.
#[derive(Clone, Debug, Default)]
pub struct Cast {
    /// Bodies, in the order they were added.
    pub bodies: Vec<BodyOf>,
    /// Pieces, in the order they were added.
    pub pieces: Vec<PieceOf>,
    /// Chains, in the order they were added.
    pub chains: Vec<ChainOf>,
    /// Counts changes of what there is to be judged: what was added, removed, or does not pass any more.
    pub changes: u64,
    /// Counts what the host placed.
    pub moves: u64,
}

impl Cast {
    /// Adds a body.
    ///
    /// # Errors
    /// Those of [`World::add_body`].
    pub fn add_body(&mut self, world: &mut World, def: &BodyDef) -> Result<BodyId, AddBodyError> {
        let id = world.add_body(def)?;
        self.bodies.push(BodyOf {
            id,
            kind: def.kind,
            coupling: def.coupling,
        });
        Ok(id)
    }

    /// Adds a piece to a body.
    ///
    /// # Errors
    /// Those of [`World::add_piece`].
    pub fn add_piece(
        &mut self,
        world: &mut World,
        body: BodyId,
        def: &PieceDef,
    ) -> Result<PieceId, AddPieceError> {
        let id = world.add_piece(body, def)?;
        self.note_piece(id, body, Link::ROOT, def);
        Ok(id)
    }

    /// Adds a piece to a link of a chain.
    ///
    /// # Errors
    /// Those of [`World::add_link_piece`].
    pub fn add_link_piece(
        &mut self,
        world: &mut World,
        chain: ChainId,
        hinge: u32,
        def: &PieceDef,
    ) -> Result<PieceId, AddPieceError> {
        let id = world.add_link_piece(chain, hinge, def)?;
        let body = self.chain(chain).map_or(BodyId::NULL, |chain| chain.body);
        let link = self.link(Some((chain, hinge)));
        self.note_piece(id, body, link, def);
        Ok(id)
    }

    fn note_piece(&mut self, id: PieceId, body: BodyId, link: Link, def: &PieceDef) {
        let solid = solid(def).expect("what the kernel takes is a solid");
        let kind = self.body(body).map_or(BodyKind::Fixed, |body| body.kind);
        self.pieces.push(PieceOf {
            id,
            body,
            kind,
            solid: Arc::new(solid),
            link,
            groups: Groups::default(),
        });
        self.changes += 1;
    }

    /// Adds a chain to a body.
    ///
    /// # Errors
    /// Those of [`World::add_chain`].
    pub fn add_chain(
        &mut self,
        world: &mut World,
        body: BodyId,
        def: &ChainDef,
    ) -> Result<ChainId, AddChainError> {
        let id = world.add_chain(body, def)?;
        let (mut hinges, mut balls) = (Vec::new(), Vec::new());
        for joint in def.joints {
            if let JointDef::Ball { cone, .. } = joint {
                balls.push(Ball {
                    first: hinges.len(),
                    cone: *cone,
                });
            }
            hinges.extend(joint.hinges());
        }
        self.chains.push(ChainOf {
            id,
            body,
            base: def.base,
            hinges,
            balls,
            joints: def.joints.len(),
            options: def.options,
        });
        self.changes += 1;
        Ok(id)
    }

    /// Removes a body with all that is on it.
    ///
    /// # Errors
    /// Those of [`World::remove_body`].
    pub fn remove_body(&mut self, world: &mut World, id: BodyId) -> Result<(), BodyError> {
        world.remove_body(id)?;
        self.changes += 1;
        self.bodies.retain(|body| body.id != id);
        self.pieces.retain(|piece| piece.body != id);
        self.chains.retain(|chain| chain.body != id);
        Ok(())
    }

    /// Removes a piece.
    ///
    /// # Errors
    /// Those of [`World::remove_piece`].
    pub fn remove_piece(&mut self, world: &mut World, id: PieceId) -> Result<(), BodyError> {
        world.remove_piece(id)?;
        self.changes += 1;
        self.pieces.retain(|piece| piece.id != id);
        Ok(())
    }

    /// Removes a chain with the pieces on its links.
    ///
    /// # Errors
    /// Those of [`World::remove_chain`].
    pub fn remove_chain(&mut self, world: &mut World, id: ChainId) -> Result<(), ChainError> {
        world.remove_chain(id)?;
        self.changes += 1;
        self.chains.retain(|chain| chain.id != id);
        self.pieces.retain(|piece| piece.link.chain() != Some(id));
        Ok(())
    }

    /// Puts a body elsewhere.
    ///
    /// # Errors
    /// Those of [`World::place_body`].
    pub fn place_body(
        &mut self,
        world: &mut World,
        id: BodyId,
        pose: &Pose,
    ) -> Result<(), BodyError> {
        world.place_body(id, pose)?;
        self.moves += 1;
        Ok(())
    }

    /// Puts a chain's joints at angles.
    ///
    /// # Errors
    /// Those of [`World::place_angles`].
    pub fn place_angles(
        &mut self,
        world: &mut World,
        id: ChainId,
        angles: &[f32],
    ) -> Result<(), ChainError> {
        world.place_angles(id, angles)?;
        self.moves += 1;
        Ok(())
    }

    /// Says whom a piece passes through.
    ///
    /// # Errors
    /// Those of [`World::set_groups`].
    pub fn set_groups(
        &mut self,
        world: &mut World,
        id: PieceId,
        groups: Groups,
    ) -> Result<(), BodyError> {
        world.set_groups(id, groups)?;
        if let Some(piece) = self.pieces.iter_mut().find(|piece| piece.id == id) {
            piece.groups = groups;
        }
        self.changes += 1;
        Ok(())
    }

    /// Says how a chain answers contact.
    ///
    /// # Errors
    /// Those of [`World::set_chain_options`].
    pub fn set_chain_options(
        &mut self,
        world: &mut World,
        id: ChainId,
        options: &ChainOptions,
    ) -> Result<(), ChainError> {
        world.set_chain_options(id, options)?;
        if let Some(chain) = self.chains.iter_mut().find(|chain| chain.id == id) {
            chain.options = *options;
        }
        self.changes += 1;
        Ok(())
    }

    /// Tells where a body of the host's own engine is.
    ///
    /// # Errors
    /// Those of [`World::set_hosted`].
    pub fn set_hosted(&mut self, world: &mut World, input: HostedInput) -> Result<(), HostedError> {
        world.set_hosted([input])?;
        self.moves += 1;
        Ok(())
    }

    /// The body of an id.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<&BodyOf> {
        self.bodies.iter().find(|body| body.id == id)
    }

    /// The chain of an id.
    #[must_use]
    pub fn chain(&self, id: ChainId) -> Option<&ChainOf> {
        self.chains.iter().find(|chain| chain.id == id)
    }

    /// The pieces of a body, in the order they were added.
    pub fn pieces_of(&self, body: BodyId) -> impl Iterator<Item = &PieceOf> {
        self.pieces.iter().filter(move |piece| piece.body == body)
    }

    /// The link that a hinge moves.
    fn link(&self, on: Option<(ChainId, u32)>) -> Link {
        let origin = self.origin(on);
        let before = origin.map(|hinge| self.origin(self.parent(hinge)));
        Link { on, origin, before }
    }

    /// What a hinge hangs on.
    fn parent(&self, (chain, hinge): (ChainId, u32)) -> Option<(ChainId, u32)> {
        match hinge.checked_sub(1) {
            Some(before) => Some((chain, before)),
            None => self.chain(chain)?.base,
        }
    }

    /// The first of the hinges that turn about the same centre.
    fn origin(&self, mut link: Option<(ChainId, u32)>) -> Option<(ChainId, u32)> {
        while let Some((chain, hinge)) = link {
            let rest = &self.chain(chain)?.hinges[hinge as usize].rest;
            if rest.translation().length() > 0.0 {
                break;
            }
            link = self.parent((chain, hinge));
        }
        link
    }

    /// Whether two pieces of driven bodies keep out of each other: of two bodies, or of two chains of one
    /// body that meet it, neighbours aside.
    #[must_use]
    pub fn keep_out(&self, a: &PieceOf, b: &PieceOf) -> bool {
        let shared = a.groups.member_of & b.groups.passes | a.groups.passes & b.groups.member_of;
        if shared != 0 {
            return false;
        }
        let meets = |piece: &PieceOf| {
            piece.link.chain().is_none_or(|id| {
                self.chain(id)
                    .is_some_and(|chain| chain.options.flags & ChainOptions::MEETS_BODY != 0)
            })
        };
        a.body != b.body
            || a.link.chain() != b.link.chain()
                && meets(a)
                && meets(b)
                && !a.link.is_next_to(&b.link)
    }
}

/// A piece in f64.
fn solid(def: &PieceDef) -> Result<Solid, crate::reference::SolidError> {
    let round = |points: &[[f32; 3]]| Solid::from_f32(points, def.radius_m);
    match def.shape {
        Shape::Point => round(&[[0.0; 3]]),
        Shape::Segment(a, b) => round(&[a, b]),
        Shape::Box([x, y, z]) => {
            let corner = |i: u32| {
                let side = |bit: u32, half: f32| if i >> bit & 1 == 1 { half } else { -half };
                [side(0, x), side(1, y), side(2, z)]
            };
            round(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner))
        }
        Shape::Hull(points) => round(points),
    }
}
