//! The paper's hand scene: a world for the kernel and the same things for the independent judge.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::state::materials::Material;
use palpable::world::{BodyDef, PieceDef, Shape, World};

use crate::gallery::{
    BALL_RADIUS_M, BALL_START, SceneryObject, SceneryPiece, ball_points, gallery,
};
use crate::hand::{Hand, PartPose};
use crate::reference::{self, Judge, Solid};
use crate::report::Ball;
use crate::script::HandTarget;

/// What the scene needs: its own high-water marks, rounded up.
pub const CAPACITIES: Capacities = Capacities {
    bodies: 32,
    pieces: 96,
    vertices: 1536,
    pairs: 512,
    contacts: 128,
    materials: 0,
    chains: 0,
    joints: 0,
};

/// Names of things in a world.
pub struct Ids {
    /// The hand.
    pub hand: BodyId,
    /// Its parts, in the order of [`Hand::parts`].
    pub hand_pieces: Vec<PieceId>,
    /// The ball.
    pub ball: BodyId,
}

/// Why a scene was not made.
#[derive(Debug)]
pub struct SceneError(pub String);

impl std::fmt::Display for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "scene: {}", self.0)
    }
}

impl std::error::Error for SceneError {}

fn refused(what: &str, why: impl std::fmt::Debug) -> SceneError {
    SceneError(format!("{what}: {why:?}"))
}

/// Fills an empty world with the gallery, the ball and the hand.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn fill(
    world: &mut World,
    hand: &Hand,
    ball: Ball,
    first: &HandTarget,
) -> Result<Ids, SceneError> {
    for object in gallery() {
        add_scenery(world, &object)?;
    }
    let ball = add_ball(world, ball)?;
    let (hand, hand_pieces) = add_hand(world, hand, first)?;
    Ok(Ids {
        hand,
        hand_pieces,
        ball,
    })
}

fn add_scenery(world: &mut World, object: &SceneryObject) -> Result<(), SceneError> {
    let body = world
        .add_body(&BodyDef::new(BodyKind::Fixed, object.pose))
        .map_err(|why| refused(object.name, why))?;
    for piece in &object.pieces {
        let def = PieceDef {
            local: piece.local,
            ..PieceDef::new(shape(piece), 0.0)
        };
        world
            .add_piece(body, &def)
            .map_err(|why| refused(object.name, why))?;
    }
    Ok(())
}

fn shape(piece: &SceneryPiece) -> Shape<'_> {
    piece
        .half_extents
        .map_or(Shape::Hull(&piece.points), Shape::Box)
}

fn add_ball(world: &mut World, ball: Ball) -> Result<BodyId, SceneError> {
    let [x, y, z] = BALL_START;
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(x, y, z)))
        .map_err(|why| refused("ball", why))?;
    let points = ball_points();
    let (shape, radius_m) = match ball {
        Ball::Sphere => (Shape::Point, BALL_RADIUS_M),
        Ball::Hull => (Shape::Hull(&points), 0.0),
    };
    world
        .add_piece(body, &PieceDef::new(shape, radius_m))
        .map_err(|why| refused("ball", why))?;
    Ok(body)
}

/// Adds the hand alone; its body and its parts.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn add_hand(
    world: &mut World,
    hand: &Hand,
    first: &HandTarget,
) -> Result<(BodyId, Vec<PieceId>), SceneError> {
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, wrist(first)))
        .map_err(|why| refused("hand", why))?;
    let mut pieces = Vec::new();
    for (part, local) in hand.parts.iter().zip(locals(hand, first)) {
        let def = PieceDef {
            local,
            material: Material::HUMAN,
            ..PieceDef::new(Shape::Hull(&part.vertices), 0.0)
        };
        let piece = world
            .add_piece(body, &def)
            .map_err(|why| refused(&part.name, why))?;
        pieces.push(piece);
    }
    Ok((body, pieces))
}

/// The wrist's pose as the tracker gives it: f32.
#[must_use]
pub fn wrist(target: &HandTarget) -> Pose {
    pose(target.orientation, target.position)
}

/// The parts' poses in the wrist's frame.
#[must_use]
pub fn locals(hand: &Hand, target: &HandTarget) -> Vec<Pose> {
    hand.blend(target.from, target.to, target.weight)
        .iter()
        .map(|part: &PartPose| pose(part.orientation, part.position))
        .collect()
}

fn pose(orientation: DQuat, position: DVec3) -> Pose {
    let q = orientation.as_quat();
    Pose {
        rotation: q.to_array(),
        position: position.as_vec3().to_array(),
    }
}

/// Categories that the judge tells apart.
pub const HAND: &str = "hand";
/// See [`HAND`].
pub const FIXED: &str = "fixed";
/// See [`HAND`].
pub const BALL: &str = "ball";

/// The same scene for the judge: the parts of the hand first, then the ball.
///
/// # Errors
/// [`SceneError`] names the piece that the reference refused.
pub fn judge(hand: &Hand, ball: Ball) -> Result<Judge, SceneError> {
    let mut judge = Judge::new();
    for (group, object) in (0..).zip(&gallery()) {
        for piece in &object.pieces {
            let solid = Solid::from_f32(&piece.points, 0.0).map_err(|e| refused(object.name, e))?;
            let world = object.pose.then(&piece.local);
            judge.add_fixed(solid, group, FIXED, object.name, reference_pose(&world));
        }
    }
    for part in &hand.parts {
        let solid = Solid::from_f32(&part.vertices, 0.0).map_err(|e| refused(&part.name, e))?;
        judge.add_moving(Arc::new(solid), HAND_GROUP, HAND, &part.name);
    }
    let solid = match ball {
        Ball::Sphere => Solid::from_f32(&[[0.0; 3]], BALL_RADIUS_M),
        Ball::Hull => Solid::from_f32(&ball_points(), 0.0),
    };
    let solid = solid.map_err(|e| refused("ball", e))?;
    judge.add_moving(Arc::new(solid), BALL_GROUP, BALL, "ball");
    Ok(judge)
}

const HAND_GROUP: u32 = 1000;
const BALL_GROUP: u32 = 1001;

/// The published poses in the judge's order.
///
/// # Errors
/// [`SceneError`] when an id is stale.
pub fn published(world: &World, ids: &Ids) -> Result<Vec<reference::Pose>, SceneError> {
    let mut poses = poses_of_pieces(world, &ids.hand_pieces)?;
    let ball = world.pose(ids.ball).map_err(|e| refused("ball", e))?;
    poses.push(reference_pose(&ball));
    Ok(poses)
}

/// The published poses of some pieces.
///
/// # Errors
/// [`SceneError`] when an id is stale.
pub fn poses_of_pieces(
    world: &World,
    pieces: &[PieceId],
) -> Result<Vec<reference::Pose>, SceneError> {
    pieces
        .iter()
        .map(|&piece| {
            let pose = world.piece_pose(piece).map_err(|e| refused("piece", e))?;
            Ok(reference_pose(&pose))
        })
        .collect()
}

fn reference_pose(pose: &Pose) -> reference::Pose {
    reference::Pose::from_f32(pose.rotation, pose.position)
}
