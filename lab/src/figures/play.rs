//! Playing a motion with a figure and measuring it: every frame is judged in f64 from the published poses
//! alone.

use cpu_time::ThreadTime;
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::{Ball, JointDef};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, PieceDef, Shape, World};

use super::{Figure, FigureIds, add, refused};
use crate::avatar::Target;
use crate::hand_scene::SceneError;
use crate::memory::Block;
use crate::reference::{self, Placed, Solid, overlap_depth};

/// Room for any figure and its scene.
pub const CAPACITIES: Capacities = Capacities {
    bodies: 16,
    pieces: 64,
    vertices: 4096,
    pairs: 1024,
    contacts: 128,
    materials: 0,
    chains: 8,
    joints: 64,
};

/// A convex thing that stays or falls.
#[derive(Clone, Debug)]
pub struct Thing {
    /// What it is.
    pub name: String,
    /// Fixed, or dynamic.
    pub kind: BodyKind,
    /// Where it is at the start.
    pub pose: Pose,
    /// Its pieces: local pose, points and rounding in metres.
    pub pieces: Vec<(Pose, Vec<[f32; 3]>, f32)>,
}

/// A figure, things, and what the tracker wants of the figure.
pub struct Scene<'s> {
    /// What happens.
    pub name: String,
    /// Who moves.
    pub figure: &'s Figure,
    /// What it meets.
    pub things: Vec<Thing>,
    /// How its chains answer.
    pub options: ChainOptions,
    /// Frames to play.
    pub frames: u32,
    /// Frames a second.
    pub rate_hz: f32,
    /// The target of each frame.
    pub target: Box<dyn Fn(u32) -> Target + 's>,
}

/// What a frame showed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// CPU time of the thread for telling the targets and stepping, in microseconds.
    pub time_us: f64,
    /// Steps of the chains' solvers.
    pub steps: u32,
    /// Distance queries.
    pub units: u32,
    /// Hinges that are not where the tracker wants them.
    pub adjusted: u32,
    /// Contacts.
    pub contacts: u32,
    /// Deepest overlap with a fixed thing, in millimetres.
    pub fixed_mm: f64,
    /// Deepest overlap with a loose thing, in millimetres.
    pub loose_mm: f64,
    /// Deepest overlap of pieces that are to keep out of each other, in millimetres.
    pub own_mm: f64,
    /// Largest change of an angle since the frame before, in degrees.
    pub jump_deg: f64,
    /// Largest change of a wanted angle since the frame before, in degrees.
    pub wanted_jump_deg: f64,
    /// How far the root is from its target, in millimetres.
    pub root_mm: f64,
    /// How far an angle is beyond its range, or a limb outside its cone, in radians.
    pub beyond_rad: f64,
    /// Bits of the frame's report.
    pub flags: u32,
}

/// What a scene showed.
#[derive(Clone, Debug)]
pub struct Played {
    /// The scene's name.
    pub name: String,
    /// One for each frame.
    pub samples: Vec<Sample>,
    /// The most in use.
    pub high_water: Capacities,
    /// Hash of the state at the end.
    pub hash: u64,
}

/// Plays a scene; `tick` is called after every frame.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn play(scene: &Scene, mut tick: impl FnMut()) -> Result<Played, SceneError> {
    let mut block = Block::new(&CAPACITIES);
    let mut world =
        World::create(block.bytes(), &CAPACITIES).map_err(|why| refused("world", why))?;
    let first = (scene.target)(0);
    let ids = add(&mut world, scene.figure, first.root, &scene.options)?;
    for (&chain, angles) in ids.chains.iter().zip(&first.angles) {
        world
            .place_angles(chain, angles)
            .map_err(|why| refused("angles", why))?;
    }
    let judge = Judge::new(&mut world, scene)?;
    let mut samples = Vec::new();
    let mut before = angles_of(&world, &ids)?;
    let mut wanted_before = before.clone();
    for frame in 0..scene.frames {
        let target = (scene.target)(frame);
        let mut sample = step(&mut world, &ids, &target, scene.rate_hz)?;
        judge.frame(&world, &ids, &mut sample)?;
        let after = angles_of(&world, &ids)?;
        let wanted = targets_of(&world, &ids)?;
        sample.jump_deg = largest_change(&before, &after).to_degrees();
        sample.wanted_jump_deg = largest_change(&wanted_before, &wanted).to_degrees();
        sample.adjusted = after.iter().zip(&wanted).filter(|(a, b)| a != b).count() as u32;
        sample.root_mm = root_off_mm(&world, &ids, &target)?;
        sample.beyond_rad = beyond_rad(scene.figure, &world, &ids)?;
        (before, wanted_before) = (after, wanted);
        samples.push(sample);
        tick();
    }
    Ok(Played {
        name: scene.name.clone(),
        samples,
        high_water: world.high_water(),
        hash: world.hash(),
    })
}

fn step(
    world: &mut World,
    ids: &FigureIds,
    target: &Target,
    rate_hz: f32,
) -> Result<Sample, SceneError> {
    let input = FrameInput::unlimited(1.0 / rate_hz);
    let begun = ThreadTime::now();
    world
        .set_target(ids.body, &target.root)
        .map_err(|why| refused("root", why))?;
    for (&chain, angles) in ids.chains.iter().zip(&target.angles) {
        world
            .set_angles(chain, angles)
            .map_err(|why| refused("angles", why))?;
    }
    let report: FrameReport = world.step(&input);
    let spent = begun.elapsed();
    Ok(Sample {
        time_us: spent.as_secs_f64() * 1e6,
        steps: report.reach_steps,
        units: report.advance_units + report.impulse_units,
        contacts: report.contacts,
        flags: report.flags,
        ..Sample::default()
    })
}

fn angles_of(world: &World, ids: &FigureIds) -> Result<Vec<f32>, SceneError> {
    let mut all = Vec::new();
    for &chain in &ids.chains {
        all.extend(world.angles(chain).map_err(|why| refused("chain", why))?);
    }
    Ok(all)
}

fn targets_of(world: &World, ids: &FigureIds) -> Result<Vec<f32>, SceneError> {
    let mut all = Vec::new();
    for &chain in &ids.chains {
        let angles = world.target_angles(chain);
        all.extend(angles.map_err(|why| refused("chain", why))?);
    }
    Ok(all)
}

fn largest_change(before: &[f32], after: &[f32]) -> f64 {
    let changes = before.iter().zip(after);
    changes.fold(0.0, |most, (a, b)| f64::max(most, f64::from((a - b).abs())))
}

fn root_off_mm(world: &World, ids: &FigureIds, target: &Target) -> Result<f64, SceneError> {
    let pose = world.pose(ids.body).map_err(|why| refused("root", why))?;
    let off = pose.translation() - target.root.translation();
    Ok(1e3 * f64::from(off.length()))
}

/// How far the published angles are beyond the figure's limits, in radians.
fn beyond_rad(figure: &Figure, world: &World, ids: &FigureIds) -> Result<f64, SceneError> {
    let mut most: f64 = 0.0;
    for (chain, &id) in figure.chains.iter().zip(&ids.chains) {
        let angles = world.angles(id).map_err(|why| refused("chain", why))?;
        let mut first = 0;
        for joint in &chain.joints {
            for (hinge, &angle) in joint.hinges().iter().zip(&angles[first..]) {
                let beyond = (hinge.low_rad - angle).max(angle - hinge.high_rad);
                most = most.max(f64::from(beyond));
            }
            if let JointDef::Ball { cone, .. } = joint {
                let ball = Ball { first, cone: *cone };
                most = most.max(f64::from(ball.outside_rad(angles)));
            }
            first += joint.hinge_count();
        }
    }
    Ok(most)
}

/// A solid of a thing, and where it is.
struct Part {
    solid: Solid,
    local: Pose,
    body: palpable::memory::BodyId,
    kind: BodyKind,
}

/// The figure and its scene in f64.
struct Judge<'s> {
    figure: &'s Figure,
    solids: Vec<Solid>,
    parts: Vec<Part>,
}

impl<'s> Judge<'s> {
    /// Adds the things to the world, and everything to the judge.
    fn new(world: &mut World, scene: &'s Scene) -> Result<Self, SceneError> {
        let mut parts = Vec::new();
        for thing in &scene.things {
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
                parts.push(Part {
                    solid: Solid::from_f32(points, *radius_m)
                        .map_err(|why| refused(&thing.name, why))?,
                    local: *local,
                    body,
                    kind: thing.kind,
                });
            }
        }
        let solids = scene
            .figure
            .pieces
            .iter()
            .map(|piece| {
                Solid::from_f32(&piece.points, piece.radius_m)
                    .map_err(|why| refused(&piece.name, why))
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            figure: scene.figure,
            solids,
            parts,
        })
    }

    fn frame(&self, world: &World, ids: &FigureIds, sample: &mut Sample) -> Result<(), SceneError> {
        let mut placed = Vec::new();
        for (solid, &piece) in self.solids.iter().zip(&ids.pieces) {
            let pose = world
                .piece_pose(piece)
                .map_err(|why| refused("piece", why))?;
            placed.push(at(solid, &pose));
        }
        for part in &self.parts {
            let body = world.pose(part.body).map_err(|why| refused("thing", why))?;
            let thing = at(&part.solid, &body.then(&part.local));
            for piece in &placed {
                let depth_mm = 1e3 * depth_m(piece, &thing);
                let slot = if part.kind == BodyKind::Fixed {
                    &mut sample.fixed_mm
                } else {
                    &mut sample.loose_mm
                };
                *slot = slot.max(depth_mm);
            }
        }
        for &[a, b] in &self.figure.apart {
            sample.own_mm = sample.own_mm.max(1e3 * depth_m(&placed[a], &placed[b]));
        }
        Ok(())
    }
}

fn at<'a>(solid: &'a Solid, pose: &Pose) -> Placed<'a> {
    Placed::at(
        solid,
        reference::Pose::from_f32(pose.rotation, pose.position),
    )
}

fn depth_m(a: &Placed, b: &Placed) -> f64 {
    let ([a_low, a_high], [b_low, b_high]) = (a.bounds(), b.bounds());
    let apart = a_low.cmpgt(b_high).any() || b_low.cmpgt(a_high).any();
    if apart { 0.0 } else { overlap_depth(a, b) }
}
