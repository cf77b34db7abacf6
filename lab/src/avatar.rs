//! The avatar that the scenes move: a human skeleton with convex pieces, as plain data.
//!
//! Frames, joints and neutral posture are those of [`palpable::human`]. Pieces of neighbouring links
//! overlap at the joints; no others do in the neutral posture. A scene exempts the neighbours, see
//! [`AvatarPlan::are_neighbours`].

pub mod bvh;
pub mod motions;
mod shapes;
mod slaps;
mod track;

use glam::Vec3;
use palpable::geometry::chain::{Posture, posture};
use palpable::human::{Base, JointDef, Limb, LimbDef, hinges_of, kept, limb, limb_on_root};
use palpable::math::Pose;

pub use shapes::{PIECE_COUNT, VERTICES_A_PIECE};

/// What the pieces are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Style {
    /// Lofted hulls, about 3600 triangles in all, as the avatar of Schmidl and Lin 2004.
    Hulls,
    /// Capsules of about the same size; trunk pieces and hands are two each.
    Capsules,
}

/// What the trunk is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trunk {
    /// Part of the root: five chains.
    Rigid,
    /// A chain of its own, that carries the neck and the arms: six chains.
    Bending,
}

/// A link of an avatar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Link {
    /// The driven body.
    Root,
    /// What hangs behind a hinge.
    Behind {
        /// Index of the chain.
        chain: usize,
        /// Index of the hinge within its chain.
        hinge: usize,
    },
}

/// A chain of an avatar.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainPlan {
    /// Which limb it is.
    pub limb: Limb,
    /// What its first joint hangs on; always the root or a link of an earlier chain.
    pub base: Link,
    /// From the base on.
    pub joints: Vec<JointDef>,
    /// The limb's end in the frame of the last link, in metres.
    pub tip: Vec3,
}

impl ChainPlan {
    /// The number of angles.
    #[must_use]
    pub fn hinge_count(&self) -> usize {
        self.joints.iter().map(JointDef::hinge_count).sum()
    }
}

/// A convex piece of an avatar: the hull of its points, rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecePlan {
    /// What it is, such as `left forearm`.
    pub name: String,
    /// What it moves with.
    pub link: Link,
    /// Pose of the piece's frame in the link's frame.
    pub local: Pose,
    /// In the piece's frame, in metres. Two for a capsule.
    pub points: Vec<[f32; 3]>,
    /// Rounding in metres.
    pub radius_m: f32,
}

impl PiecePlan {
    /// Triangles of the hull without its rounding: 2 V - 4 for V vertices, none for a capsule.
    #[must_use]
    pub fn triangles(&self) -> usize {
        (2 * self.points.len()).saturating_sub(4)
    }
}

/// A posture of an avatar: what a tracker wants of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Pose of the root.
    pub root: Pose,
    /// For each chain of the plan one angle a hinge, in radians.
    pub angles: Vec<Vec<f32>>,
}

/// An avatar as plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct AvatarPlan {
    /// Soles to the top of the head, in metres.
    pub height_m: f32,
    /// Each after the one it hangs on.
    pub chains: Vec<ChainPlan>,
    /// Root first, then in the order of the chains.
    pub pieces: Vec<PiecePlan>,
}

impl AvatarPlan {
    /// An avatar of a height between 0.3 m and 3 m.
    ///
    /// # Panics
    /// For other heights.
    #[must_use]
    pub fn new(height_m: f32, style: Style, trunk: Trunk) -> Self {
        assert!((0.3..=3.0).contains(&height_m), "no body is {height_m} m");
        let mut plan = Self {
            height_m,
            chains: chains(height_m, trunk),
            pieces: Vec::new(),
        };
        plan.pieces = shapes::pieces(&plan, style);
        plan
    }

    /// The index of a limb's chain; `None` for the spine of a rigid trunk.
    #[must_use]
    pub fn chain(&self, limb: Limb) -> Option<usize> {
        self.chains.iter().position(|chain| chain.limb == limb)
    }

    /// Triangles of all pieces.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.pieces.iter().map(PiecePlan::triangles).sum()
    }

    /// The neutral posture with the soles at height zero, at the origin.
    #[must_use]
    pub fn neutral(&self) -> Target {
        let hip_m = palpable::human::lengths::HIP_HEIGHT * self.height_m;
        Target {
            root: Pose::at(0.0, hip_m, 0.0),
            angles: self
                .chains
                .iter()
                .map(|chain| vec![0.0; chain.hinge_count()])
                .collect(),
        }
    }

    /// Forward kinematics of every chain.
    #[must_use]
    pub fn postures(&self, target: &Target) -> Vec<Posture> {
        let mut done: Vec<Posture> = Vec::new();
        for (chain, angles) in self.chains.iter().zip(&target.angles) {
            let base = link_pose(chain.base, &target.root, &done);
            done.push(posture(&hinges_of(&chain.joints), &base, angles));
        }
        done
    }

    /// Where the pieces are, in the order of `pieces`.
    #[must_use]
    pub fn piece_poses(&self, target: &Target) -> Vec<Pose> {
        let links = self.postures(target);
        let place = |piece: &PiecePlan| link_pose(piece.link, &target.root, &links);
        self.pieces
            .iter()
            .map(|piece| place(piece).then(&piece.local))
            .collect()
    }

    /// Where a limb ends, in metres; `None` for the spine of a rigid trunk.
    #[must_use]
    pub fn tip(&self, limb: Limb, target: &Target) -> Option<Vec3> {
        let chain = self.chain(limb)?;
        let links = self.postures(target);
        Some(links[chain].last()?.link.point(self.chains[chain].tip))
    }

    /// The target with every angle within its limits, and how many had to be changed.
    #[must_use]
    pub fn kept(&self, target: &Target) -> (Target, u32) {
        let mut clamped = 0;
        let mut angles = Vec::new();
        for (chain, wanted) in self.chains.iter().zip(&target.angles) {
            let result = kept(&chain.joints, wanted);
            clamped += result.clamped;
            angles.push(result.angles.to_vec());
        }
        let root = target.root;
        (Target { root, angles }, clamped)
    }

    /// Whether two pieces move with one link, or with two links between which no other piece lies.
    #[must_use]
    pub fn are_neighbours(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|piece| self.pieces[piece].link);
        a == b || self.carrier_before(a) == Some(b) || self.carrier_before(b) == Some(a)
    }

    /// The nearest link toward the root that has pieces.
    fn carrier_before(&self, link: Link) -> Option<Link> {
        let mut at = link;
        loop {
            at = match at {
                Link::Root => return None,
                Link::Behind { chain, hinge: 0 } => self.chains[chain].base,
                Link::Behind { chain, hinge } => Link::Behind {
                    chain,
                    hinge: hinge - 1,
                },
            };
            if self.pieces.iter().any(|piece| piece.link == at) {
                return Some(at);
            }
        }
    }
}

fn link_pose(link: Link, root: &Pose, postures: &[Posture]) -> Pose {
    match link {
        Link::Root => *root,
        Link::Behind { chain, hinge } => postures[chain][hinge].link,
    }
}

fn chains(height_m: f32, trunk: Trunk) -> Vec<ChainPlan> {
    let bending = trunk == Trunk::Bending;
    let spine_end = Link::Behind { chain: 0, hinge: 2 };
    let limbs = Limb::ALL
        .into_iter()
        .filter(|&limb| bending || limb != Limb::Spine);
    limbs
        .map(|which| {
            let def: LimbDef = if bending {
                limb(which, height_m)
            } else {
                limb_on_root(which, height_m)
            };
            ChainPlan {
                limb: which,
                base: match def.base {
                    Base::Root => Link::Root,
                    Base::Spine => spine_end,
                },
                joints: def.joints.to_vec(),
                tip: def.tip,
            }
        })
        .collect()
}
