//! Playing a motion with a figure and measuring it: every frame is judged in f64 from the published poses
//! alone.

use cpu_time::ThreadTime;
use glam::Vec3;
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::{Ball, JointDef};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, World};

use super::judge::{Finding, Judge, add_things};
use super::{Figure, FigureIds, add, refused};
use crate::avatar::Target;
use crate::hand_scene::SceneError;
use crate::memory::Block;

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

/// A tracker at the end of a chain, and the plane that it goes through.
pub struct Tip<'s> {
    /// The chain, whose angles in the target are the posture that it is to keep near.
    pub chain: usize,
    /// Where the tracker sees the chain's last link.
    pub pose: Box<dyn Fn(u32) -> Pose + 's>,
    /// The way out of the obstacle, of length one.
    pub out: Vec3,
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
    /// A chain that is led by its end instead of its angles.
    pub tip: Option<Tip<'s>>,
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
    /// What the judge found.
    pub found: Finding,
    /// Largest change of an angle since the frame before, in degrees.
    pub jump_deg: f64,
    /// Largest change of a wanted angle since the frame before, in degrees.
    pub wanted_jump_deg: f64,
    /// How far the root is from its target, in millimetres.
    pub root_mm: f64,
    /// How far an angle is beyond its range, or a limb outside its cone, in radians.
    pub beyond_rad: f64,
    /// How far a tracked end is from the nearest place in front of the wall, in millimetres: across the
    /// wall's normal, and along it where the end is behind the tracker.
    pub tip_off_mm: f64,
    /// The gap between a chain with a tracked end and the fixed things, in millimetres.
    pub tip_gap_mm: f64,
    /// Whether the targets are those of the frame before, to the bit.
    pub still: bool,
    /// Whether the published root and angles are those of the frame before, to the bit.
    pub at_rest: bool,
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

/// Root and angles, wanted or published.
#[derive(Clone, PartialEq)]
struct State {
    root: Pose,
    angles: Vec<f32>,
}

/// Plays a scene; `tick` is called after every frame.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn play(scene: &Scene, mut tick: impl FnMut()) -> Result<Played, SceneError> {
    play_and(scene, |_, _| {
        tick();
        Ok(())
    })
}

/// Plays a scene and shows every published frame.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn play_and(
    scene: &Scene,
    mut show: impl FnMut(&World, &FigureIds) -> Result<(), SceneError>,
) -> Result<Played, SceneError> {
    let mut block = Block::new(&CAPACITIES);
    let mut world =
        World::create(block.bytes(), &CAPACITIES).map_err(|why| refused("world", why))?;
    let ids = begin(&mut world, scene)?;
    let bodies = add_things(&mut world, &scene.things)?;
    let mut judge = Judge::new(scene.figure, &scene.things, &bodies)?;
    let mut samples = Vec::new();
    let mut before = published(&world, &ids)?;
    let mut wanted_before = wanted(&world, &ids, &(scene.target)(0))?;
    for frame in 0..scene.frames {
        let target = (scene.target)(frame);
        let mut sample = step(&mut world, &ids, scene, frame, &target)?;
        sample.found = judge.frame(&world, &ids)?;
        let after = published(&world, &ids)?;
        let wanted = wanted(&world, &ids, &target)?;
        sample.jump_deg = largest_change(&before.angles, &after.angles).to_degrees();
        sample.wanted_jump_deg = largest_change(&wanted_before.angles, &wanted.angles).to_degrees();
        let angles = after.angles.iter().zip(&wanted.angles);
        sample.adjusted = angles.filter(|(a, b)| a != b).count() as u32;
        let off = after.root.translation() - target.root.translation();
        sample.root_mm = 1e3 * f64::from(off.length());
        sample.beyond_rad = beyond_rad(scene.figure, &world, &ids)?;
        sample.still = wanted == wanted_before;
        sample.at_rest = after == before;
        if let Some(tip) = &scene.tip {
            sample.tip_off_mm = tip_off_mm(&world, &ids, tip, frame)?;
            sample.tip_gap_mm = 1e3 * judge.gap_m(&world, &ids, tip.chain)?;
        }
        (before, wanted_before) = (after, wanted);
        samples.push(sample);
        show(&world, &ids)?;
    }
    Ok(Played {
        name: scene.name.clone(),
        samples,
        high_water: world.high_water(),
        hash: world.hash(),
    })
}

/// The figure in its first posture.
fn begin(world: &mut World, scene: &Scene) -> Result<FigureIds, SceneError> {
    let first = (scene.target)(0);
    let body = BodyDef::new(BodyKind::Driven, first.root);
    let ids = add(world, scene.figure, &body, &scene.options)?;
    lead(world, &ids, scene, 0, &first)?;
    for &chain in &ids.chains {
        let angles = world.target_angles(chain);
        let angles = angles.map_err(|why| refused("chain", why))?.to_vec();
        world
            .place_angles(chain, &angles)
            .map_err(|why| refused("angles", why))?;
    }
    Ok(ids)
}

/// Tells the world the targets of a frame.
fn lead(
    world: &mut World,
    ids: &FigureIds,
    scene: &Scene,
    frame: u32,
    target: &Target,
) -> Result<(), SceneError> {
    world
        .set_target(ids.body, &target.root)
        .map_err(|why| refused("root", why))?;
    for (index, (&chain, angles)) in ids.chains.iter().zip(&target.angles).enumerate() {
        match &scene.tip {
            Some(tip) if tip.chain == index => {
                let pose = (tip.pose)(frame);
                world.set_tip(chain, &pose, angles).map(|_| ())
            }
            _ => world.set_angles(chain, angles),
        }
        .map_err(|why| refused("angles", why))?;
    }
    Ok(())
}

fn step(
    world: &mut World,
    ids: &FigureIds,
    scene: &Scene,
    frame: u32,
    target: &Target,
) -> Result<Sample, SceneError> {
    let input = FrameInput::unlimited(1.0 / scene.rate_hz);
    let begun = ThreadTime::now();
    lead(world, ids, scene, frame, target)?;
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

fn published(world: &World, ids: &FigureIds) -> Result<State, SceneError> {
    let mut angles = Vec::new();
    for &chain in &ids.chains {
        angles.extend(world.angles(chain).map_err(|why| refused("chain", why))?);
    }
    let root = world.pose(ids.body).map_err(|why| refused("root", why))?;
    Ok(State { root, angles })
}

fn wanted(world: &World, ids: &FigureIds, target: &Target) -> Result<State, SceneError> {
    let mut angles = Vec::new();
    for &chain in &ids.chains {
        let wanted = world.target_angles(chain);
        angles.extend(wanted.map_err(|why| refused("chain", why))?);
    }
    Ok(State {
        root: target.root,
        angles,
    })
}

fn largest_change(before: &[f32], after: &[f32]) -> f64 {
    let changes = before.iter().zip(after);
    changes.fold(0.0, |most, (a, b)| f64::max(most, f64::from((a - b).abs())))
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

/// How far a tracked end is from the nearest place that the obstacle leaves it.
fn tip_off_mm(world: &World, ids: &FigureIds, tip: &Tip, frame: u32) -> Result<f64, SceneError> {
    let links = world.link_poses(ids.chains[tip.chain]);
    let links = links.map_err(|why| refused("chain", why))?;
    let at = links.last().copied().unwrap_or_default().translation();
    let off = at - (tip.pose)(frame).translation();
    // Being held out is what the obstacle is for.
    let out = off.dot(tip.out).max(0.0);
    Ok(1e3 * f64::from((off - tip.out * out).length()))
}
