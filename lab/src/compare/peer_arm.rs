//! The same arm in Rapier: seven hinges with their ranges as multibody joints on a fixed trunk, the hand
//! pulled to the tracker by the soft drive. The arm alone meets the wall; nothing else of the avatar
//! would.

use cpu_time::ThreadTime;
use palpable::geometry::chain::Hinge;
use palpable::human::{Limb, hinges_of};
use palpable::math::Pose;
use rapier3d::prelude as rapier;

use super::arm::{Arm, ArmFound};
use super::drive::{Drive, HandDrive};
use super::judging::{largest, reference_pose};
use super::peer::{SUBSTEPS, from_peer, hull, to_peer, tuned_world};
use super::setting::Perturbation;
use crate::avatar::{Link, PiecePlan};
use crate::figures::play::Scene;
use crate::hand_scene::SceneError;
use crate::reference::{Placed, Solid, overlap_depth};

/// Mass of a link with a piece and of one without, in kg; moments in kg m2.
const LINK_KG: [f32; 2] = [1.2, 0.02];
const LINK_KG_M2: [f32; 2] = [2e-3, 2e-5];
/// What the soft drive takes the hand and the arm behind it to weigh, in kg.
const PULLED_KG: f32 = 1.2;
/// Rotor inertia of each hinge in kg m2, which keeps the light links calm, and its damping in N m s.
const ARMATURE_KG_M2: f32 = 2e-3;
const DAMPING_N_M_S: f32 = 0.2;

/// A convex piece of the arm: its collider and its solid for the judge.
struct Piece {
    collider: rapier::ColliderHandle,
    solid: Solid,
}

struct PeerArm {
    world: rapier::PhysicsWorld,
    links: Vec<rapier::RigidBodyHandle>,
    /// Least and largest coordinate of each hinge, in radians.
    ranges: Vec<[f32; 2]>,
    pieces: Vec<Piece>,
    drive: HandDrive,
}

/// Plays the scene on Rapier.
///
/// # Errors
/// [`SceneError`] names what the engine refused.
pub fn play(arm: &Arm, tracker: Perturbation) -> Result<ArmFound, SceneError> {
    let missing = || SceneError("the arm's scene has no tracked wrist".to_owned());
    let scene = arm.scene(tracker)?;
    let tip = scene.tip.as_ref().ok_or_else(missing)?;
    let mut peer = PeerArm::new(arm, &scene)?;
    let (_, points, radius_m) = &scene.things[0].pieces[0];
    let wall = Solid::from_f32(points, *radius_m).map_err(|why| refused("wall", why))?;
    let wall = Placed::at(&wall, reference_pose(&scene.things[0].pose));
    let mut found = ArmFound::default();
    let mut before = peer.angles();
    for frame in 0..scene.frames {
        let begun = ThreadTime::now();
        peer.step(&(tip.pose)(frame));
        let time_us = begun.elapsed().as_secs_f64() * 1e6;
        let angles = peer.angles();
        let changes = before.iter().zip(&angles).map(|(a, b)| (a - b).abs());
        let turned_deg = largest(changes.map(f64::from)).to_degrees();
        let beyond_deg = peer.beyond_rad(&angles).to_degrees();
        found.note(peer.overlap_mm(&wall), beyond_deg, turned_deg, time_us);
        before = angles;
    }
    Ok(found)
}

fn refused(what: &str, why: impl std::fmt::Debug) -> SceneError {
    SceneError(format!("{what}: {why:?}"))
}

impl PeerArm {
    fn new(arm: &Arm, scene: &Scene) -> Result<Self, SceneError> {
        let start = (scene.target)(0);
        let chain = arm
            .plan
            .chain(Limb::RightArm)
            .ok_or_else(|| SceneError("no right arm".to_owned()))?;
        let hinges = hinges_of(&arm.plan.chains[chain].joints);
        let places = &arm.plan.postures(&start)[chain];
        let wrist = places.last().map(|place| to_peer(&place.link));
        let mut peer = Self {
            world: tuned_world(SUBSTEPS),
            links: Vec::new(),
            ranges: Vec::new(),
            pieces: Vec::new(),
            drive: HandDrive::new(Drive::Soft, wrist.unwrap_or_default(), pulled_mass()),
        };
        peer.add_wall(scene)?;
        let mut parent = peer
            .world
            .insert_body(rapier::RigidBodyBuilder::fixed().pose(to_peer(&start.root)));
        for (index, (hinge, place)) in hinges.iter().zip(places.iter()).enumerate() {
            let link = Link::Behind {
                chain,
                hinge: index,
            };
            let pieces: Vec<_> = arm.plan.pieces.iter().filter(|p| p.link == link).collect();
            let body = peer.add_link(&place.link, &pieces)?;
            peer.add_joint(parent, body, hinge, start.angles[chain][index])?;
            parent = body;
        }
        peer.calm();
        Ok(peer)
    }

    fn add_wall(&mut self, scene: &Scene) -> Result<(), SceneError> {
        for thing in &scene.things {
            let body = rapier::RigidBodyBuilder::fixed().pose(to_peer(&thing.pose));
            let body = self.world.insert_body(body);
            for (local, points, _) in &thing.pieces {
                let collider = hull(points)?.position(to_peer(local));
                self.world.insert_collider(collider, Some(body));
            }
        }
        Ok(())
    }

    fn add_link(
        &mut self,
        at: &Pose,
        pieces: &[&PiecePlan],
    ) -> Result<rapier::RigidBodyHandle, SceneError> {
        let kind = usize::from(pieces.is_empty());
        let moments = rapier::Vector::splat(LINK_KG_M2[kind]);
        let mass = rapier::MassProperties::new(rapier::Vector::ZERO, LINK_KG[kind], moments);
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(to_peer(at))
            .gravity_scale(0.0)
            .additional_mass_properties(mass)
            .can_sleep(false);
        let body = self.world.insert_body(body);
        for piece in pieces {
            let solid = Solid::from_f32(&piece.points, piece.radius_m);
            let solid = solid.map_err(|why| refused(&piece.name, why))?;
            let collider = hull(&piece.points)?
                .position(to_peer(&piece.local))
                .density(0.0);
            let collider = self.world.insert_collider(collider, Some(body));
            self.pieces.push(Piece { collider, solid });
        }
        self.links.push(body);
        Ok(body)
    }

    /// A hinge turns about the X axis of both its frames; the start angle is in the first of them, since
    /// joints begin at zero.
    fn add_joint(
        &mut self,
        parent: rapier::RigidBodyHandle,
        body: rapier::RigidBodyHandle,
        hinge: &Hinge,
        start_rad: f32,
    ) -> Result<(), SceneError> {
        let axis = rapier::Vector::from_array(hinge.axis.to_array());
        let aligned = rapier::Rotation::from_rotation_arc(rapier::Vector::X, axis);
        let aligned = rapier::Pose::from_rotation(aligned);
        let turned = rapier::Rotation::from_axis_angle(axis, start_rad);
        let rest = to_peer(&hinge.rest) * rapier::Pose::from_rotation(turned);
        let range = [hinge.low_rad - start_rad, hinge.high_rad - start_rad];
        let joint = rapier::GenericJointBuilder::new(rapier::JointAxesMask::LOCKED_REVOLUTE_AXES)
            .local_frame1(rest * aligned)
            .local_frame2(aligned)
            .limits(rapier::JointAxis::AngX, range)
            .contacts_enabled(false)
            .build();
        let joint = self.world.insert_multibody_joint(parent, body, joint);
        joint.ok_or_else(|| SceneError("the peer refuses a joint".to_owned()))?;
        self.ranges.push(range);
        Ok(())
    }

    fn calm(&mut self) {
        // The fixed root loses its own coordinates in the first step; before it, places in these columns
        // belong to other joints.
        self.world.step();
        let last = self.links.last().copied().unwrap_or_default();
        let joints = &mut self.world.multibody_joints;
        let Some(link) = joints.rigid_body_link(last).copied() else {
            return;
        };
        if let Some(multibody) = joints.get_multibody_mut(link.multibody) {
            multibody.set_self_contacts_enabled(false);
            multibody.armature_mut().fill(ARMATURE_KG_M2);
            multibody.damping_mut().fill(DAMPING_N_M_S);
        }
    }

    fn step(&mut self, wrist: &Pose) {
        self.drive.track(to_peer(wrist));
        let step_s = self.world.integration_parameters.dt;
        let hand = self.links.last().copied().unwrap_or_default();
        for substep in 0..SUBSTEPS {
            let body = &mut self.world.bodies[hand];
            self.drive.pull(body, substep, SUBSTEPS, step_s);
            self.world.step();
        }
    }

    /// The hinges' coordinates in radians, zero at the start.
    fn angles(&self) -> Vec<f32> {
        let joints = &self.world.multibody_joints;
        let angle = |&body: &rapier::RigidBodyHandle| {
            let link = joints.rigid_body_link(body)?;
            let link = joints.get_multibody(link.multibody)?.link(link.id)?;
            Some(link.joint().coords()[rapier::JointAxis::AngX as usize])
        };
        let angles = self.links.iter().map(angle);
        angles.map(|angle| angle.unwrap_or(f32::NAN)).collect()
    }

    fn beyond_rad(&self, angles: &[f32]) -> f64 {
        let each = angles.iter().zip(&self.ranges);
        largest(each.map(|(&angle, &[low, high])| {
            let [angle, low, high] = [angle, low, high].map(f64::from);
            // What is not a number is within no range.
            if angle > low && angle < high {
                0.0
            } else {
                (low - angle).abs().min((angle - high).abs())
            }
        }))
    }

    fn overlap_mm(&self, wall: &Placed) -> f64 {
        let depth = |piece: &Piece| {
            let at = from_peer(self.world.colliders[piece.collider].position());
            let placed = Placed::at(&piece.solid, reference_pose(&at));
            1e3 * overlap_depth(&placed, wall)
        };
        largest(self.pieces.iter().map(depth))
    }
}

/// What the drive takes the hand for.
fn pulled_mass() -> rapier::MassProperties {
    let moments = rapier::Vector::splat(2.0 * LINK_KG_M2[0]);
    rapier::MassProperties::new(rapier::Vector::ZERO, PULLED_KG, moments)
}
