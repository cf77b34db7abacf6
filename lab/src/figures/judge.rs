//! The judge of figures: overlap in f64 from the published poses alone.

use glam::{DQuat, DVec3};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::math::Pose;
use palpable::memory::BodyId;
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};

use super::play::Thing;
use super::{Figure, FigureIds, LinkOf, refused};
use crate::hand_scene::SceneError;
use crate::reference::{self, Placed, Solid, overlap_depth, signed_distance};

/// Own overlap that is promised: deeper pairs may only get shallower, in millimetres.
pub(super) const OWN_MM_MAX: f64 = 1.0;

/// What the judge found in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Finding {
    /// Deepest overlap with a fixed thing, in millimetres.
    pub fixed_mm: f64,
    /// Deepest overlap with a loose thing, in millimetres.
    pub loose_mm: f64,
    /// Deepest overlap of pieces that are to keep out of each other, in millimetres.
    pub own_mm: f64,
    /// The most by which a pair of such pieces is deeper than in the frame before and than 1 mm.
    pub own_grown_mm: f64,
    /// How far a published piece is from where forward kinematics of the published angles in f64 has it,
    /// in millimetres.
    pub astray_mm: f64,
}

/// A solid of a thing, and where it is.
struct Part {
    solid: Solid,
    local: Pose,
    body: BodyId,
    kind: BodyKind,
}

/// The figure and its scene in f64.
pub struct Judge<'s> {
    figure: &'s Figure,
    solids: Vec<Solid>,
    parts: Vec<Part>,
    own_before_mm: Vec<f64>,
}

/// Adds things to a world.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn add_things(world: &mut World, things: &[Thing]) -> Result<Vec<BodyId>, SceneError> {
    let mut bodies = Vec::new();
    for thing in things {
        let body = world
            .add_body(&BodyDef::new(thing.kind, thing.pose))
            .map_err(|why| refused(&thing.name, why))?;
        for (local, points, radius_m) in &thing.pieces {
            let shape = match points[..] {
                [_] => Shape::Point,
                [a, b] => Shape::Segment(a, b),
                _ => Shape::Hull(points),
            };
            let def = PieceDef {
                local: *local,
                ..PieceDef::new(shape, *radius_m)
            };
            world
                .add_piece(body, &def)
                .map_err(|why| refused(&thing.name, why))?;
        }
        bodies.push(body);
    }
    Ok(bodies)
}

impl<'s> Judge<'s> {
    /// A judge of a figure among things that are in a world as these bodies.
    ///
    /// # Errors
    /// [`SceneError`] names the piece that the reference refused.
    pub fn new(
        figure: &'s Figure,
        things: &[Thing],
        bodies: &[BodyId],
    ) -> Result<Self, SceneError> {
        let mut parts = Vec::new();
        for (thing, &body) in things.iter().zip(bodies) {
            for (local, points, radius_m) in &thing.pieces {
                parts.push(Part {
                    solid: solid(&thing.name, points, *radius_m)?,
                    local: *local,
                    body,
                    kind: thing.kind,
                });
            }
        }
        let solids = solids_of(figure)?;
        let own_before_mm = vec![f64::INFINITY; figure.apart.len()];
        Ok(Self {
            figure,
            solids,
            parts,
            own_before_mm,
        })
    }

    /// Judges the published frame.
    ///
    /// # Errors
    /// [`SceneError`] when an id is stale.
    pub fn frame(&mut self, world: &World, ids: &FigureIds) -> Result<Finding, SceneError> {
        let mut found = Finding::default();
        let poses = published(world, ids)?;
        let placed: Vec<Placed> = self.solids.iter().zip(&poses).map(at).collect();
        for part in &self.parts {
            let body = world.pose(part.body).map_err(|why| refused("thing", why))?;
            let thing = at((&part.solid, &body.then(&part.local)));
            let slot = if part.kind == BodyKind::Fixed {
                &mut found.fixed_mm
            } else {
                &mut found.loose_mm
            };
            for piece in &placed {
                *slot = slot.max(1e3 * depth_m(piece, &thing));
            }
        }
        for (&[a, b], before_mm) in self.figure.apart.iter().zip(&mut self.own_before_mm) {
            let depth_mm = 1e3 * depth_m(&placed[a], &placed[b]);
            found.own_mm = found.own_mm.max(depth_mm);
            let grown_mm = depth_mm - before_mm.max(OWN_MM_MAX);
            found.own_grown_mm = found.own_grown_mm.max(grown_mm);
            *before_mm = depth_mm;
        }
        found.astray_mm = 1e3 * astray_m(self.figure, world, ids, &poses)?;
        Ok(found)
    }

    /// The gap between the pieces of a chain and the fixed things, or minus the depth, in metres.
    ///
    /// # Errors
    /// [`SceneError`] when an id is stale.
    pub fn gap_m(&self, world: &World, ids: &FigureIds, chain: usize) -> Result<f64, SceneError> {
        let poses = published(world, ids)?;
        let mut least = f64::INFINITY;
        for part in &self.parts {
            let body = world.pose(part.body).map_err(|why| refused("thing", why))?;
            let thing = at((&part.solid, &body.then(&part.local)));
            for (index, place) in self.solids.iter().zip(&poses).enumerate() {
                let link = self.figure.pieces[index].link;
                if link.is_some_and(|(of, _)| of == chain) {
                    least = least.min(signed_distance(&at(place), &thing).value);
                }
            }
        }
        Ok(least)
    }
}

/// The figure's pieces for the reference, in its order.
pub(super) fn solids_of(figure: &Figure) -> Result<Vec<Solid>, SceneError> {
    let pieces = figure.pieces.iter();
    pieces
        .map(|piece| solid(&piece.name, &piece.points, piece.radius_m))
        .collect()
}

fn solid(name: &str, points: &[[f32; 3]], radius_m: f32) -> Result<Solid, SceneError> {
    Solid::from_f32(points, radius_m).map_err(|why| refused(name, why))
}

fn published(world: &World, ids: &FigureIds) -> Result<Vec<Pose>, SceneError> {
    let pieces = ids.pieces.iter();
    pieces
        .map(|&piece| world.piece_pose(piece).map_err(|why| refused("piece", why)))
        .collect()
}

pub(super) fn at<'a>((solid, pose): (&'a Solid, &Pose)) -> Placed<'a> {
    Placed::at(
        solid,
        reference::Pose::from_f32(pose.rotation, pose.position),
    )
}

pub(super) fn depth_m(a: &Placed, b: &Placed) -> f64 {
    let ([a_low, a_high], [b_low, b_high]) = (a.bounds(), b.bounds());
    let apart = a_low.cmpgt(b_high).any() || b_low.cmpgt(a_high).any();
    if apart { 0.0 } else { overlap_depth(a, b) }
}

/// A frame in f64.
#[derive(Clone, Copy)]
struct Frame {
    turn: DQuat,
    at: DVec3,
}

impl Frame {
    fn of(pose: &Pose) -> Self {
        Self {
            turn: DQuat::from_array(pose.rotation.map(f64::from)).normalize(),
            at: DVec3::from_array(pose.position.map(f64::from)),
        }
    }

    fn point(&self, point: DVec3) -> DVec3 {
        self.at + self.turn * point
    }

    fn then(&self, next: &Self) -> Self {
        Self {
            turn: self.turn * next.turn,
            at: self.point(next.at),
        }
    }

    fn behind(&self, hinge: &Hinge, angle: f32) -> Self {
        let mut link = self.then(&Self::of(&hinge.rest));
        link.turn *= DQuat::from_axis_angle(hinge.axis.as_dvec3().normalize(), f64::from(angle));
        link
    }
}

fn astray_m(
    figure: &Figure,
    world: &World,
    ids: &FigureIds,
    poses: &[Pose],
) -> Result<f64, SceneError> {
    let root = Frame::of(&world.pose(ids.body).map_err(|why| refused("root", why))?);
    let mut links: Vec<Vec<Frame>> = Vec::new();
    let of = |links: &[Vec<Frame>], link: LinkOf| {
        link.map_or(root, |(chain, hinge): (usize, usize)| links[chain][hinge])
    };
    for (chain, &id) in figure.chains.iter().zip(&ids.chains) {
        let angles = world.angles(id).map_err(|why| refused("chain", why))?;
        let mut link = of(&links, chain.base);
        let mut all = Vec::new();
        let hinges = chain.joints.iter().flat_map(JointDef::hinges);
        for (hinge, &angle) in hinges.zip(angles) {
            link = link.behind(&hinge, angle);
            all.push(link);
        }
        links.push(all);
    }
    let mut most: f64 = 0.0;
    for (piece, pose) in figure.pieces.iter().zip(poses) {
        let here = Frame::of(pose);
        let there = of(&links, piece.link).then(&Frame::of(&piece.local));
        for point in &piece.points {
            let point = DVec3::from_array(point.map(f64::from));
            most = most.max(here.point(point).distance(there.point(point)));
        }
    }
    Ok(most)
}
