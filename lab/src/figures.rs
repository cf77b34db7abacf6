//! Figures: skeletons with convex pieces that a tracker moves. The avatar is one, the hand with bending
//! fingers another.

pub mod capture;
pub mod grasps;
pub mod judge;
pub mod play;
pub mod scenes;
pub mod slaps;
pub mod suite;
pub mod summary;
pub mod wrist;

use palpable::geometry::chain::JointDef;
use palpable::math::Pose;
use palpable::memory::{BodyId, ChainId, PieceId};
use palpable::state::chains::ChainOptions;
use palpable::state::materials::Material;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

use crate::avatar::{AvatarPlan, Link};
use crate::hand::{ArticulatedHand, FingerLink, Hand};
use crate::hand_scene::SceneError;

/// A link of a figure: chain and hinge, or the root.
pub type LinkOf = Option<(usize, usize)>;

/// A chain of a figure.
#[derive(Clone, Debug)]
pub struct FigureChain {
    /// What it hangs on: the root, or a link of an earlier chain.
    pub base: LinkOf,
    /// From the base on.
    pub joints: Vec<JointDef>,
}

/// A convex piece of a figure.
#[derive(Clone, Debug)]
pub struct FigurePiece {
    /// What it is.
    pub name: String,
    /// What it moves with.
    pub link: LinkOf,
    /// Its pose there.
    pub local: Pose,
    /// In its own frame, in metres; two for a capsule.
    pub points: Vec<[f32; 3]>,
    /// Rounding in metres.
    pub radius_m: f32,
}

/// A skeleton with pieces, as plain data.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Each after the one that it hangs on.
    pub chains: Vec<FigureChain>,
    /// In any order.
    pub pieces: Vec<FigurePiece>,
    /// Pairs of pieces that are to keep out of each other.
    pub apart: Vec<[usize; 2]>,
}

impl Figure {
    /// The avatar. Pieces of different chains keep out of each other, and of the trunk, neighbours aside.
    #[must_use]
    pub fn of_avatar(plan: &AvatarPlan) -> Self {
        let link = |link: Link| match link {
            Link::Root => None,
            Link::Behind { chain, hinge } => Some((chain, hinge)),
        };
        let pieces: Vec<FigurePiece> = plan
            .pieces
            .iter()
            .map(|piece| FigurePiece {
                name: piece.name.clone(),
                link: link(piece.link),
                local: piece.local,
                points: piece.points.clone(),
                radius_m: piece.radius_m,
            })
            .collect();
        let mut apart = Vec::new();
        for b in 0..pieces.len() {
            for a in 0..b {
                let chain = |piece: usize| pieces[piece].link.map(|(chain, _)| chain);
                if chain(a) != chain(b) && !plan.are_neighbours(a, b) {
                    apart.push([a, b]);
                }
            }
        }
        Self {
            chains: plan
                .chains
                .iter()
                .map(|chain| FigureChain {
                    base: link(chain.base),
                    joints: chain.joints.clone(),
                })
                .collect(),
            pieces,
            apart,
        }
    }

    /// The hand with bending fingers, which may touch each other.
    #[must_use]
    pub fn of_hand(hand: &Hand, fingers: &ArticulatedHand) -> Self {
        let pieces = hand.parts.iter().zip(&fingers.parts);
        Self {
            chains: (0..fingers.fingers.len())
                .map(|finger| FigureChain {
                    base: None,
                    joints: fingers.joints(finger),
                })
                .collect(),
            pieces: pieces
                .map(|(part, place)| FigurePiece {
                    name: part.name.clone(),
                    link: match place.link {
                        FingerLink::Root => None,
                        FingerLink::Behind { finger, hinge } => Some((finger, hinge)),
                    },
                    local: place.local,
                    points: part.vertices.clone(),
                    radius_m: 0.0,
                })
                .collect(),
            apart: Vec::new(),
        }
    }

    /// A chain that hangs on the root with its pieces, and nothing else.
    #[must_use]
    pub fn chain_alone(&self, chain: usize) -> Self {
        let of_chain = |piece: &FigurePiece| {
            let (own, hinge) = piece.link?;
            (own == chain).then(|| FigurePiece {
                link: Some((0, hinge)),
                ..piece.clone()
            })
        };
        Self {
            chains: vec![FigureChain {
                base: None,
                joints: self.chains[chain].joints.clone(),
            }],
            pieces: self.pieces.iter().filter_map(of_chain).collect(),
            apart: Vec::new(),
        }
    }

    /// Hinges of all chains.
    #[must_use]
    pub fn hinges(&self) -> usize {
        let joints = self.chains.iter().flat_map(|chain| &chain.joints);
        joints.map(JointDef::hinge_count).sum()
    }
}

/// Names of a figure's things in a world.
pub struct FigureIds {
    /// The driven body.
    pub body: BodyId,
    /// In the figure's order.
    pub chains: Vec<ChainId>,
    /// In the figure's order.
    pub pieces: Vec<PieceId>,
}

fn refused(what: &str, why: impl std::fmt::Debug) -> SceneError {
    SceneError(format!("{what}: {why:?}"))
}

/// Adds a figure to a world.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn add(
    world: &mut World,
    figure: &Figure,
    body: &BodyDef,
    options: &ChainOptions,
) -> Result<FigureIds, SceneError> {
    let body = world.add_body(body).map_err(|why| refused("figure", why))?;
    let mut ids = FigureIds {
        body,
        chains: Vec::new(),
        pieces: Vec::new(),
    };
    for chain in &figure.chains {
        let base = chain
            .base
            .map(|(chain, hinge)| (ids.chains[chain], hinge as u32));
        let def = ChainDef {
            joints: &chain.joints,
            base,
            options: *options,
        };
        let id = world
            .add_chain(body, &def)
            .map_err(|why| refused("chain", why))?;
        ids.chains.push(id);
    }
    for piece in &figure.pieces {
        let shape = match piece.points[..] {
            [a, b] => Shape::Segment(a, b),
            _ => Shape::Hull(&piece.points),
        };
        let def = PieceDef {
            local: piece.local,
            material: Material::HUMAN,
            ..PieceDef::new(shape, piece.radius_m)
        };
        let id = match piece.link {
            None => world.add_piece(body, &def),
            Some((chain, hinge)) => world.add_link_piece(ids.chains[chain], hinge as u32, &def),
        };
        ids.pieces
            .push(id.map_err(|why| refused(&piece.name, why))?);
    }
    Ok(ids)
}
