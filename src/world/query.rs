//! How two bodies lie to each other, asked without a frame.
//!
//! Everything is computed in the frame of one of the bodies, so that accuracy does not depend on the
//! distance from the origin. The body in the lower slot is always taken first: asking the other way
//! round gives the same numbers with the normals turned round, bit for bit.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::{BodyError, World};
use crate::geometry::manifold::manifold;
use crate::geometry::separation::{Separation, core_gap, separation};
use crate::geometry::union::{
    NODES_USUAL, Translation, UNION_PAIRS_MAX, UnionPair, UnionScratch, least_translation,
};
use crate::limits::{MANIFOLD_CONTACTS_MAX, QUERY_ROUNDS_MAX, WORLD_REACH_M};
use crate::math::{self, Pose, length};
use crate::memory::{BodyId, PieceId};
use crate::state::State;
use crate::state::contacts::ContactPoint;
use crate::state::pieces::{Bounds, PiecesOf};

/// Overlap that a translation may leave, as a part of the smaller piece's size and of the
/// translation's length: twice what [`least_translation`] counts as touching.
const LEFT_PART: f32 = 2e-6;

/// How two bodies lie to each other, in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPenetration {
    /// Length of the least translation of A that parts the bodies, in metres; zero when they are apart.
    pub depth_m: f32,
    /// Distance of the bodies in metres; zero when they overlap, infinite when one has no pieces.
    pub distance_m: f32,
    /// From B into A, unit length: along the least translation, or between the closest points. Zero when
    /// a body has no pieces.
    pub normal: [f32; 3],
    /// Where A's surface is nearest to B, or deepest in it, in metres.
    pub point_a: [f32; 3],
    /// Where B's surface is nearest to A, or deepest in it, in metres.
    pub point_b: [f32; 3],
    /// A's piece of the nearest, or deepest, pair.
    pub piece_a: PieceId,
    /// B's piece of that pair.
    pub piece_b: PieceId,
    /// Contacts of the deepest pair, with that pair's own normal; none when the bodies are apart.
    pub contacts: ArrayVec<ContactPoint, MANIFOLD_CONTACTS_MAX>,
    /// False when not all pairs of pieces that are in the way were considered: `depth_m` may be too small
    /// to part the bodies.
    pub complete: bool,
}

impl BodyPenetration {
    /// What is known of bodies of which one has no pieces.
    const NOTHING_NEAR: Self = Self {
        depth_m: 0.0,
        distance_m: f32::INFINITY,
        normal: [0.0; 3],
        point_a: [0.0; 3],
        point_b: [0.0; 3],
        piece_a: PieceId::NULL,
        piece_b: PieceId::NULL,
        contacts: ArrayVec::new_const(),
        complete: true,
    };

    /// The answer to the question asked the other way round.
    fn turned_round(mut self) -> Self {
        let back = |normal: [f32; 3]| normal.map(|part| -part);
        self.normal = back(self.normal);
        core::mem::swap(&mut self.point_a, &mut self.point_b);
        core::mem::swap(&mut self.piece_a, &mut self.piece_b);
        for contact in &mut self.contacts {
            contact.normal = back(contact.normal);
            core::mem::swap(&mut contact.piece_a, &mut contact.piece_b);
        }
        self
    }
}

impl World<'_> {
    /// How deep two bodies overlap where they are published, and the way out, or how far apart they are.
    ///
    /// Overlapping: the least translation of A that parts the two unions of pieces (moved by it they
    /// overlap by at most 2e-6 of the smaller piece's size and of the way; for several pairs within a
    /// few percent of the least), and the contacts of the deepest pair. Apart: the distance, from below
    /// and within 1e-6 of it, and the closest points.
    ///
    /// Cost, for n and m pieces: n m boxes twice, and a separation for each pair whose boxes are nearer
    /// than the nearest pair so far. Overlapping bodies: as much once more in each of at most
    /// [`QUERY_ROUNDS_MAX`] rounds, and where more than one pair is in the way a search of
    /// [`NODES_USUAL`] nodes in each. Takes about 200 kB of stack. More than [`UNION_PAIRS_MAX`] pairs in
    /// the way, or more rounds, are left out: [`BodyPenetration::complete`] then is false.
    ///
    /// # Errors
    /// [`BodyError::Stale`]; [`BodyError::SameBody`] when `a` is `b`.
    pub fn penetration(&self, a: BodyId, b: BodyId) -> Result<BodyPenetration, BodyError> {
        let pose_a = self.state.bodies.pose[self.body_index(a)?];
        let pose_b = self.state.bodies.pose[self.body_index(b)?];
        self.penetration_at(a, &pose_a, b, &pose_b)
    }

    /// As [`World::penetration`], with the bodies at other poses. Their pieces keep the local poses that
    /// were published, a bent finger stays bent.
    ///
    /// # Errors
    /// [`BodyError::Stale`]; [`BodyError::SameBody`] when `a` is `b`; [`BodyError::BadPose`].
    pub fn penetration_at(
        &self,
        a: BodyId,
        pose_a: &Pose,
        b: BodyId,
        pose_b: &Pose,
    ) -> Result<BodyPenetration, BodyError> {
        let (slot_a, slot_b) = (self.body_index(a)?, self.body_index(b)?);
        if slot_a == slot_b {
            return Err(BodyError::SameBody);
        }
        let place = |pose: &Pose| pose.normalised(WORLD_REACH_M).ok_or(BodyError::BadPose);
        let (pose_a, pose_b) = (place(pose_a)?, place(pose_b)?);
        Ok(if slot_a < slot_b {
            Question::new(&self.state, slot_a, &pose_a, slot_b, &pose_b).answer()
        } else {
            Question::new(&self.state, slot_b, &pose_b, slot_a, &pose_a)
                .answer()
                .turned_round()
        })
    }
}

/// The published pose of a piece in its body's frame, through the link that it is on.
fn published_in_body(state: &State, piece: usize) -> Pose {
    let local = &state.pieces.local[piece];
    match state.pieces.link[piece].checked_sub(1) {
        Some(joint) => state.joints.link[joint as usize].then(local),
        None => *local,
    }
}

/// Pieces of the two bodies, by slot.
type PiecePair = (usize, usize);

/// Two bodies, in the frame of the second.
struct Question<'s, 'w> {
    state: &'s State<'w>,
    first_a: u32,
    first_b: u32,
    a_in_b: Pose,
    pose_b: Pose,
    /// A box around all of B.
    whole_b: Bounds,
}

/// A pair of pieces and how they lie to each other in B's frame.
struct Found {
    pair: PiecePair,
    separation: Separation,
}

impl<'s, 'w> Question<'s, 'w> {
    fn new(state: &'s State<'w>, a: usize, pose_a: &Pose, b: usize, pose_b: &Pose) -> Self {
        let first_b = state.bodies.first_piece[b];
        let mut whole_b = Bounds::EMPTY;
        for piece in PiecesOf::new(state.pieces.next, first_b) {
            let pose = published_in_body(state, piece);
            whole_b = whole_b.union(Bounds::of(&state.pieces.shape[piece], &pose));
        }
        Self {
            state,
            first_a: state.bodies.first_piece[a],
            first_b,
            a_in_b: pose_a.seen_from(pose_b),
            pose_b: *pose_b,
            whole_b,
        }
    }

    fn answer(&self) -> BodyPenetration {
        let Some(nearest) = self.nearest() else {
            return BodyPenetration::NOTHING_NEAR;
        };
        let (a, b) = nearest.pair;
        let found = &nearest.separation;
        let mut answer = BodyPenetration {
            distance_m: math::max(found.gap_m, 0.0),
            normal: (self.pose_b.quat() * found.normal).to_array(),
            point_a: self.pose_b.point(found.point_a).to_array(),
            point_b: self.pose_b.point(found.point_b).to_array(),
            piece_a: self.state.pieces.id(a as u32),
            piece_b: self.state.pieces.id(b as u32),
            ..BodyPenetration::NOTHING_NEAR
        };
        if found.gap_m <= 0.0 {
            let (offset, complete) = self.way_out(&nearest);
            answer.complete = complete;
            answer.depth_m = length(offset);
            if let Some(along) = math::direction(offset) {
                answer.normal = (self.pose_b.quat() * along).to_array();
            }
            self.touch(&nearest, &mut answer);
        }
        answer
    }

    fn pieces_of(&self, first: u32) -> PiecesOf<'s> {
        PiecesOf::new(self.state.pieces.next, first)
    }

    /// The pose of a piece of A that is moved by `offset`.
    fn pose_a(&self, piece: usize, offset: Vec3) -> Pose {
        self.a_in_b
            .then(&published_in_body(self.state, piece))
            .moved(offset)
    }

    /// The pose of a piece of B.
    fn pose_in_b(&self, piece: usize) -> Pose {
        published_in_body(self.state, piece)
    }

    fn separation(&self, (a, b): PiecePair, offset: Vec3) -> Separation {
        let pieces = &self.state.pieces;
        separation(
            &self.state.pools.convex(&pieces.shape[a]),
            &self.state.pools.convex(&pieces.shape[b]),
            &self.pose_a(a, offset),
            &self.pose_in_b(b),
            Vec3::ZERO,
        )
    }

    /// Calls `visit` with every pair whose boxes are nearer than `within` allows, A moved by `offset`, and
    /// a lower bound of its gap. `visit` returns how near boxes must be from there on.
    fn each_near(
        &self,
        offset: Vec3,
        mut within: f32,
        mut visit: impl FnMut(PiecePair, f32) -> f32,
    ) {
        let pieces = &self.state.pieces;
        for a in self.pieces_of(self.first_a) {
            let bounds = Bounds::of(&pieces.shape[a], &self.pose_a(a, offset));
            if bounds.gap(&self.whole_b) >= within {
                continue;
            }
            for b in self.pieces_of(self.first_b) {
                let gap = bounds.gap(&Bounds::of(&pieces.shape[b], &self.pose_in_b(b)));
                if gap < within {
                    within = visit((a, b), gap);
                }
            }
        }
    }

    /// The pair of least gap; `None` when a body has no pieces.
    ///
    /// The gap of the boxes along an axis is at most that of the pieces, also where both are negative.
    fn nearest(&self) -> Option<Found> {
        let mut start = None;
        self.each_near(Vec3::ZERO, f32::INFINITY, |pair, gap| {
            start = Some(pair);
            gap
        });
        let start = start?;
        let mut best = Found {
            pair: start,
            separation: self.separation(start, Vec3::ZERO),
        };
        let within = best.separation.gap_m;
        self.each_near(Vec3::ZERO, within, |pair, _| {
            if pair != start {
                let separation = self.separation(pair, Vec3::ZERO);
                if separation.gap_m < best.separation.gap_m {
                    best = Found { pair, separation };
                }
            }
            best.separation.gap_m
        });
        Some(best)
    }

    /// The least translation that parts all pairs, in B's frame, and whether it does.
    ///
    /// It is first sought for the pairs that overlap now. A pair that it would make overlap is added,
    /// and it is sought again: as long as pairs are missing it can only be too short.
    fn way_out(&self, deepest: &Found) -> (Vec3, bool) {
        let mut listed: ArrayVec<PiecePair, UNION_PAIRS_MAX> = ArrayVec::new();
        listed.push(deepest.pair);
        if !self.list_overlapping(Vec3::ZERO, &mut listed) {
            return (self.least(&listed).offset, false);
        }
        let mut offset = Vec3::ZERO;
        for _ in 0..QUERY_ROUNDS_MAX {
            let mut verified = true;
            if listed.len() == 1 {
                offset = deepest.separation.normal * -deepest.separation.gap_m;
            } else {
                let found = self.least(&listed);
                offset = found.offset;
                verified = found.verified;
            }
            let before = listed.len();
            let all = self.list_overlapping(offset, &mut listed);
            if !all || !verified {
                return (offset, false);
            }
            if listed.len() == before {
                return (offset, true);
            }
        }
        (offset, false)
    }

    /// Lists the pairs that overlap when A is moved by `offset` and are not listed yet. False when there
    /// was no room for all.
    fn list_overlapping(
        &self,
        offset: Vec3,
        listed: &mut ArrayVec<PiecePair, UNION_PAIRS_MAX>,
    ) -> bool {
        let known = listed.len();
        let way = length(offset);
        let mut all = true;
        self.each_near(offset, 0.0, |pair, _| {
            if !listed[..known].contains(&pair)
                && self.separation(pair, offset).gap_m < -self.left_over(pair, way)
            {
                all &= listed.try_push(pair).is_ok();
            }
            0.0
        });
        all
    }

    /// Overlap that counts as none after a translation of this length.
    fn left_over(&self, (a, b): PiecePair, way_m: f32) -> f32 {
        let size = |piece: usize| {
            let shape = &self.state.pieces.shape[piece];
            self.state.pools.convex(shape).size()
        };
        LEFT_PART * (math::min(size(a), size(b)) + way_m)
    }

    /// In a function of its own, so that its stack is taken only where it is needed.
    #[inline(never)]
    fn least(&self, listed: &[PiecePair]) -> Translation {
        let pieces = &self.state.pieces;
        let pairs: ArrayVec<UnionPair, UNION_PAIRS_MAX> = listed
            .iter()
            .map(|&(a, b)| UnionPair {
                a: self.state.pools.convex(&pieces.shape[a]),
                a_pose: self.pose_a(a, Vec3::ZERO),
                b: self.state.pools.convex(&pieces.shape[b]),
                b_pose: self.pose_in_b(b),
            })
            .collect();
        let mut scratch = UnionScratch::new();
        least_translation(&pairs, 0.0, NODES_USUAL, &mut scratch)
    }

    /// Writes down the contacts of the deepest pair.
    fn touch(&self, deepest: &Found, answer: &mut BodyPenetration) {
        let (a, b) = deepest.pair;
        let pieces = &self.state.pieces;
        let (shape_a, shape_b) = (
            self.state.pools.convex(&pieces.shape[a]),
            self.state.pools.convex(&pieces.shape[b]),
        );
        let local = &self.pose_in_b(b);
        let a_in_piece = self.pose_a(a, Vec3::ZERO).seen_from(local);
        let core = core_gap(&shape_a, &shape_b, &a_in_piece, Vec3::ZERO);
        let to_world = self.pose_b.then(local);
        for found in manifold(&shape_a, &shape_b, &a_in_piece, &core, 0.0) {
            answer.contacts.push(ContactPoint {
                piece_a: answer.piece_a,
                piece_b: answer.piece_b,
                point: self.pose_b.point(local.point(found.point)).to_array(),
                normal: (to_world.quat() * found.normal).to_array(),
                gap_m: found.gap,
                impulse_n_s: 0.0,
                approach_m_s: 0.0,
                slide_m_s: 0.0,
            });
        }
    }
}
