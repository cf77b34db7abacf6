//! The `k` crate's Jacobian solver on the same cases: f64, positions only.
//!
//! A place is asked for in all three coordinates of the tip. A push is asked for as the equality that
//! its optimum is: the world is turned so that the plane's normal is X, and only x is asked for; the
//! least step along the pseudoinverse then suits it. Reach cones it does not know.

use k::nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use k::{
    Constraints, InverseKinematicsSolver, JacobianIkSolver, JointType, Node, NodeBuilder,
    SerialChain,
};

use glam::{Quat, Vec3};
use palpable::math::Pose;

use super::cases::{Case, TOLERANCE_M};
use super::chains::Chain;

/// How much of the Newton step is taken: all of it, as the kernel's solvers do; the default is half.
const MULTIPLIER: f64 = 1.0;

/// A case in the form of the `k` crate.
pub struct Peer {
    chain: SerialChain<f64>,
    target: Isometry3<f64>,
    constraints: Constraints,
    wanted: Vec<f64>,
    rest: Vec<f64>,
}

impl Peer {
    /// The case, to begin from its tracked angles.
    pub fn new(chain: &Chain, case: &Case) -> Self {
        let goal = &case.goals[0];
        let is_place = case.goals.len() == 3;
        let turn = if is_place {
            Quat::IDENTITY
        } else {
            Quat::from_rotation_arc(goal.normal, Vec3::X)
        };
        let world = Pose::new(turn, Vec3::ZERO);
        let place = if is_place {
            case.place()
        } else {
            Vec3::X * goal.height_m
        };
        // A node holds its children only: all are kept until the chain holds them.
        let mut nodes: Vec<Node<f64>> = vec![];
        for (index, hinge) in chain.hinges.iter().take(goal.link + 1).enumerate() {
            let origin = if index == 0 {
                world.then(&chain.root).then(&hinge.rest)
            } else {
                hinge.rest
            };
            let axis = Unit::new_normalize(vector(hinge.axis));
            let node = NodeBuilder::new()
                .name(&format!("joint {index}"))
                .joint_type(JointType::Rotational { axis })
                .limits(Some((hinge.low_rad.into()..=hinge.high_rad.into()).into()))
                .origin(isometry(&origin))
                .into_node();
            if let Some(before) = nodes.last() {
                node.set_parent(before);
            }
            nodes.push(node);
        }
        let tip = NodeBuilder::new()
            .name("tip")
            .joint_type(JointType::Fixed)
            .translation(Translation3::from(vector(goal.point)))
            .into_node();
        if let Some(before) = nodes.last() {
            tip.set_parent(before);
        }
        let angles: Vec<f64> = case.wanted.iter().map(|&q| q.into()).collect();
        let (wanted, rest) = angles.split_at(goal.link + 1);
        Self {
            chain: SerialChain::from_end(&tip),
            target: Isometry3::from_parts(vector(place).into(), UnitQuaternion::identity()),
            constraints: Constraints {
                position_x: true,
                position_y: is_place,
                position_z: is_place,
                rotation_x: false,
                rotation_y: false,
                rotation_z: false,
                ignored_joint_names: vec![],
            },
            wanted: wanted.to_vec(),
            rest: rest.to_vec(),
        }
    }

    /// Solves from the tracked angles with at most `steps` iterations; whether it says it has.
    pub fn solve(&self, steps: u32) -> bool {
        self.solve_from(&self.wanted, steps)
    }

    fn solve_from(&self, angles: &[f64], steps: u32) -> bool {
        self.chain.set_joint_positions_unchecked(angles);
        let tolerance = f64::from(TOLERANCE_M);
        let solver = JacobianIkSolver::new(tolerance, tolerance, MULTIPLIER, steps as usize);
        let solved = solver.solve_with_constraints(&self.chain, &self.target, &self.constraints);
        solved.is_ok()
    }

    /// Moves the goal of a place.
    pub fn aim(&mut self, place: Vec3) {
        self.target.translation = vector(place).into();
    }

    /// Solves from where it is.
    pub fn go_on(&self, steps: u32) -> bool {
        let angles = self.chain.joint_positions();
        self.solve_from(&angles, steps)
    }

    /// All angles of the chain.
    pub fn angles(&self) -> Vec<f64> {
        let mut angles = self.chain.joint_positions();
        angles.extend(&self.rest);
        angles
    }
}

fn vector(v: Vec3) -> Vector3<f64> {
    let [x, y, z] = v.to_array().map(f64::from);
    Vector3::new(x, y, z)
}

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let q = pose.quat();
    let [x, y, z, w] = [q.x, q.y, q.z, q.w].map(f64::from);
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(vector(pose.translation()).into(), turn)
}
