//! Global penetration depth: the least translation that parts two unions of convex pieces.
//!
//! For one pair the translations that leave it overlapping are the inside of a convex set, the
//! difference of the pieces, known by its half-spaces: t parts the pair if n . t >= h for one of
//! them, n a unit normal from B into A and h the overlap along n, radii included. A translation of
//! the union must part every pair that can matter. That is a choice of one half-space a pair, and
//! the least such translation is the nearest point of their common part.
//!
//! Three answers, from weak to strong: [`weighted_mean`] is equation 1 of Schmidl and Lin 2004,
//! kept for comparison. The sweep of [`least_translation`] walks along rays: each pair blocks an
//! interval of a ray, and the first place that no interval covers parts all pairs, so it always
//! finds a translation and pairs cannot cancel. Its branch and bound then chooses half-spaces, and
//! is exact when it ends before its budget does.
//!
//! Rounded pieces: the half-spaces of the cores' difference are moved out by the radii. Beyond its
//! edges that is more than the rounded difference, so depths there are upper bounds; the
//! half-spaces along 26 fixed directions and along the closest points trim the excess.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3};

use super::convex::Convex;
use super::penetration::axes_within;
use super::separation::core_gap;
use crate::math::{Pose, direction, length, max, min};

/// Most pairs of pieces in one question.
pub const UNION_PAIRS_MAX: usize = 64;

/// Most half-spaces that are kept for one pair; those of least overlap win.
pub const PAIR_HALF_SPACES_MAX: usize = 96;

const _: () = assert!(PAIR_HALF_SPACES_MAX > 2 * FIXED_NORMALS);

/// Most nodes of the branch and bound that wait at one time; those of least length win.
pub const NODES_WAITING_MAX: usize = 256;

/// The branch and bound's usual budget: within 5 % of the best known in 98 % of trials with 2 x 4 boxes or
/// hulls, 8.4 % away in the worst.
pub const NODES_USUAL: u32 = 64;

/// Half-spaces that one node remembers; the last three always decide its point.
const CHOICES_MAX: usize = 6;

/// How often a translation is shortened with the half-spaces it satisfies best.
const SETTLE_ROUNDS: usize = 4;

/// Most half-spaces that are added for one such shortening.
const SETTLE_STEPS: usize = 16;

/// Normals of one overlapping pair that the sweep walks along: those of least overlap.
const SWEPT_NORMALS: usize = 4;

/// Half-spaces of a pair that are measured before its faces: 26 fixed ones and the closest points'.
const FIXED_NORMALS: usize = 27;

/// Overlap that counts as touching, as a part of the smaller piece's size: the accuracy of f32.
/// Without it a resting contact would block every sideways ray by a rounding error.
const TOUCHING_PART: f32 = 1e-6;

/// Overlap left by a translation that counts as none, as a part of the translation's length: a dot
/// product of f32 with a ray's unit vector on one side, a quotient by another on the other.
const ROUNDING_PART: f32 = 1e-6;

/// Two half-spaces are the same when their normals differ by at most this.
const SAME_NORMAL: f32 = 5e-7;

/// A piece of the union that moves, a piece of the other, and where they are. Both poses are in
/// one common frame, best near the pieces.
#[derive(Clone, Copy, Debug)]
pub struct UnionPair<'p> {
    /// The piece that moves.
    pub a: Convex<'p>,
    /// Its pose.
    pub a_pose: Pose,
    /// The piece that stays.
    pub b: Convex<'p>,
    /// Its pose.
    pub b_pose: Pose,
}

/// A translation of the union of all A pieces, in the common frame of the poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translation {
    /// What to move by, in metres.
    pub offset: Vec3,
    /// Whether the offset was checked to part every pair, up to 1e-6 of the smaller piece's size and
    /// of the offset's length.
    /// False when there were more pairs than [`UNION_PAIRS_MAX`], and never otherwise for finite
    /// input.
    pub verified: bool,
    /// Whether no shorter translation exists within the half-spaces (see the module on radii).
    pub optimal: bool,
    /// Nodes of the branch and bound that were used.
    pub nodes: u32,
    /// Length of the sweep's answer in metres: never less than that of `offset`.
    pub sweep_m: f32,
}

/// The mean of the pairs' penetration vectors weighted by their depths, in the common frame.
///
/// Schmidl and Lin 2004, equation 1: sum of w d n / sum of w with weights w = d. It is exact for one
/// overlapping pair. With two at an angle it satisfies neither, and opposite ones cancel.
///
/// Cost: one separation query a pair.
#[must_use]
pub fn weighted_mean(pairs: &[UnionPair]) -> Vec3 {
    let mut sum = Vec3::ZERO;
    let mut weights = 0.0;
    for pair in pairs {
        let (normal, depth) = pair_depth(pair);
        if depth > 0.0 {
            sum += normal * (depth * depth);
            weights += depth;
        }
    }
    if weights > 0.0 {
        sum / weights
    } else {
        Vec3::ZERO
    }
}

/// Normal (common frame) and depth of one pair, radii included; negative when apart.
fn pair_depth(pair: &UnionPair) -> (Vec3, f32) {
    let a_in_b = pair.a_pose.seen_from(&pair.b_pose);
    let radii = pair.a.radius + pair.b.radius;
    let cores = core_gap(&pair.a, &pair.b, &a_in_b, Vec3::ZERO);
    (pair.b_pose.quat() * cores.normal, radii - cores.gap)
}

/// A translation t with `normal . t >= offset` parts the pair.
#[derive(Clone, Copy, Debug)]
struct HalfSpace {
    normal: Vec3,
    offset: f32,
}

impl HalfSpace {
    /// How much of the overlap is left after a translation.
    fn left(&self, t: Vec3) -> f32 {
        self.offset - self.normal.dot(t)
    }
}

/// The half-spaces of one pair.
#[derive(Clone, Debug)]
struct Blocked {
    planes: ArrayVec<HalfSpace, PAIR_HALF_SPACES_MAX>,
    /// Least overlap of the half-spaces that found no room; those are missing from here on.
    missing_from: f32,
    /// The first half-spaces, which do not give way: the coarse answer rests on them.
    fixed: usize,
}

impl Blocked {
    fn new() -> Self {
        Self {
            planes: ArrayVec::new(),
            missing_from: f32::INFINITY,
            fixed: 0,
        }
    }

    /// Adds a half-space; the one of most overlap gives way when there is no room.
    fn add(&mut self, plane: HalfSpace) {
        for known in &mut self.planes {
            let apart = known.normal - plane.normal;
            if apart.length_squared() <= SAME_NORMAL * SAME_NORMAL {
                if plane.offset < known.offset {
                    *known = plane;
                }
                return;
            }
        }
        if self.planes.try_push(plane).is_ok() {
            return;
        }
        let mut worst = self.fixed;
        for (index, known) in self.planes.iter().enumerate().skip(self.fixed) {
            if known.offset > self.planes[worst].offset {
                worst = index;
            }
        }
        let mut missing = plane;
        if plane.offset < self.planes[worst].offset {
            missing = core::mem::replace(&mut self.planes[worst], plane);
        }
        self.missing_from = min(missing.offset, self.missing_from);
    }

    /// Overlap left after a translation, along the half-space that parts best.
    fn left(&self, t: Vec3) -> f32 {
        let mut least = f32::INFINITY;
        for plane in &self.planes {
            least = min(plane.left(t), least);
        }
        least
    }

    /// The half-space that parts best after a translation, the first of those that tie.
    fn best_plane(&self, t: Vec3) -> Option<&HalfSpace> {
        let mut best: Option<&HalfSpace> = None;
        for plane in &self.planes {
            if best.is_none_or(|known| plane.left(t) < known.left(t)) {
                best = Some(plane);
            }
        }
        best
    }

    /// Where the ray `s * along`, s >= 0, is inside all half-spaces: an open interval.
    fn interval(&self, along: Vec3) -> Interval {
        let mut inside = Interval {
            from: f32::NEG_INFINITY,
            to: f32::INFINITY,
        };
        for plane in &self.planes {
            let speed = plane.normal.dot(along);
            if speed > 0.0 {
                inside.to = min(plane.offset / speed, inside.to);
            } else if speed < 0.0 {
                inside.from = max(plane.offset / speed, inside.from);
            } else if plane.offset <= 0.0 {
                return Interval { from: 0.0, to: 0.0 };
            }
        }
        inside
    }

    /// Forgets half-spaces that no translation within `reach` satisfies.
    fn prune(&mut self, reach: f32) {
        let reach = reach * (1.0 + ROUNDING_PART);
        self.planes.retain(|plane| plane.offset <= reach);
    }
}

/// Part of a ray that a pair blocks.
#[derive(Clone, Copy, Debug)]
struct Interval {
    from: f32,
    to: f32,
}

/// Half-spaces that were chosen, the nearest point of their common part, and its squared length.
#[derive(Clone, Copy, Debug)]
struct Node {
    choices: [HalfSpace; CHOICES_MAX],
    count: usize,
    point: Vec3,
    squared: f32,
}

impl Node {
    const ROOT: Self = Self {
        choices: [HalfSpace {
            normal: Vec3::ZERO,
            offset: 0.0,
        }; CHOICES_MAX],
        count: 0,
        point: Vec3::ZERO,
        squared: 0.0,
    };

    /// The node with one more half-space, which the node's point violates.
    ///
    /// When the memory is full the oldest is forgotten: the child then is nearer to the origin than
    /// it should be, which is still a lower bound.
    fn with(&self, plane: HalfSpace) -> Option<Self> {
        let mut child = *self;
        if child.count == CHOICES_MAX {
            child.choices.rotate_left(1);
            child.count -= 1;
        }
        child.choices[child.count] = plane;
        child.count += 1;
        child.point = nearest_point(&child.choices[..child.count])?;
        child.squared = child.point.length_squared();
        Some(child)
    }
}

/// Scratch memory for [`least_translation`], about 130 kB. Its contents between calls mean nothing.
#[derive(Clone, Debug, Default)]
pub struct UnionScratch {
    blocked: ArrayVec<Blocked, UNION_PAIRS_MAX>,
    waiting: ArrayVec<Node, NODES_WAITING_MAX>,
}

impl UnionScratch {
    /// Empty scratch.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}

/// The least translation of the A pieces that parts all pairs and leaves them `clearance_m` apart.
///
/// `pairs` are all pairs that could matter, also those that do not overlap yet: a pair that is not
/// listed is not respected. `nodes_max` bounds the branch and bound; with 0 the sweep answers.
/// Touching within 1e-6 of the smaller piece's size counts as parted, so give a clearance of that
/// size where it must not.
///
/// Cost, with P pairs of H half-spaces: per pair one enumeration of axes and 27 supports of each
/// piece; the sweep at most (28 + 4 P) P (H + P) steps; each node P H steps and H projections of at
/// most 16 small solves.
#[must_use]
pub fn least_translation(
    pairs: &[UnionPair],
    clearance_m: f32,
    nodes_max: u32,
    scratch: &mut UnionScratch,
) -> Translation {
    let listed = &pairs[..pairs.len().min(UNION_PAIRS_MAX)];
    gather(listed, clearance_m, &mut scratch.blocked);
    let coarse = sweep(&scratch.blocked, f32::INFINITY).unwrap_or(Vec3::ZERO);
    gather_faces(listed, clearance_m, length(coarse), &mut scratch.blocked);
    let offset = sweep(&scratch.blocked, length(coarse)).unwrap_or(coarse);
    let reach = length(offset);
    for blocked in &mut scratch.blocked {
        blocked.prune(reach);
    }
    let mut result = Translation {
        offset,
        verified: false,
        optimal: false,
        nodes: 0,
        sweep_m: reach,
    };
    branch_and_bound(scratch, nodes_max, &mut result);
    let all_listed = pairs.len() <= UNION_PAIRS_MAX;
    result.optimal &= all_listed;
    result.verified = all_listed && most_violated(&scratch.blocked, result.offset).is_none();
    result
}

/// What is added to the cores' overlap: radii and clearance, less what counts as touching.
fn padding(pair: &UnionPair, clearance_m: f32) -> f32 {
    let touching = TOUCHING_PART * min(pair.a.size(), pair.b.size());
    pair.a.radius + pair.b.radius + clearance_m - touching
}

/// Half-spaces along the fixed directions and the closest points: enough to bound every ray.
fn gather(pairs: &[UnionPair], clearance_m: f32, all: &mut ArrayVec<Blocked, UNION_PAIRS_MAX>) {
    all.clear();
    for pair in pairs {
        let mut blocked = Blocked::new();
        let padding = padding(pair, clearance_m);
        let turn = pair.b_pose.quat();
        let a_in_b = pair.a_pose.seen_from(&pair.b_pose);
        let nearest = core_gap(&pair.a, &pair.b, &a_in_b, Vec3::ZERO).normal;
        blocked.add(measured(pair, &a_in_b, turn * nearest, padding));
        for number in 0..27 {
            if let Some(normal) = fixed_direction(number) {
                blocked.add(measured(pair, &a_in_b, normal, padding));
            }
        }
        all.push(blocked);
    }
}

/// The half-space along a unit normal of the common frame, by the supports of both cores.
fn measured(pair: &UnionPair, a_in_b: &Pose, normal: Vec3, padding: f32) -> HalfSpace {
    let local = pair.b_pose.quat().conjugate() * normal;
    let low = pair.a.support(a_in_b.quat().conjugate() * -local).index;
    let high = pair.b.support(local).index;
    let between = pair.b.vertex(high) - a_in_b.point(pair.a.vertex(low));
    HalfSpace {
        normal,
        offset: local.dot(between) + padding,
    }
}

/// The faces, and edge pairs, of the cores' differences within `reach`.
fn gather_faces(pairs: &[UnionPair], clearance_m: f32, reach: f32, all: &mut [Blocked]) {
    for (pair, blocked) in pairs.iter().zip(all) {
        blocked.prune(reach);
        blocked.fixed = blocked.planes.len();
        let padding = padding(pair, clearance_m);
        let turn = pair.b_pose.quat();
        let a_in_b = pair.a_pose.seen_from(&pair.b_pose);
        let mut visit = |normal: Vec3, overlap: f32| {
            blocked.add(HalfSpace {
                normal: turn * normal,
                offset: overlap + padding,
            });
        };
        axes_within(&pair.a, &pair.b, &a_in_b, reach - padding, &mut visit);
    }
}

/// Direction `number` of 27: the corners, edges and faces of a cube, none for its middle.
fn fixed_direction(number: usize) -> Option<Vec3> {
    let part = |digit: usize| (digit % 3) as f32 - 1.0;
    direction(Vec3::new(part(number), part(number / 3), part(number / 9)))
}

/// The shortest way out along a ray: fixed directions, the pairs' least normals, their sum and
/// their weighted mean. `None` when there is nothing shorter than `reach`.
fn sweep(all: &[Blocked], reach: f32) -> Option<Vec3> {
    let mut best = Vec3::ZERO;
    let mut shortest = reach;
    let mut look = |along: Vec3| {
        let way = first_gap(all, along, shortest);
        if way < shortest {
            (best, shortest) = (along * way, way);
        }
    };
    let (mut sum, mut mean) = (Vec3::ZERO, Vec3::ZERO);
    for blocked in all {
        let mut floor = f32::NEG_INFINITY;
        for rank in 0..SWEPT_NORMALS {
            let Some(plane) = next_plane(blocked, floor) else {
                break;
            };
            if rank == 0 && plane.offset > 0.0 {
                sum += plane.normal * plane.offset;
                mean += plane.normal * (plane.offset * plane.offset);
            }
            if blocked.left(Vec3::ZERO) > 0.0 {
                look(plane.normal);
            }
            floor = plane.offset;
        }
    }
    for along in [direction(sum), direction(mean)].into_iter().flatten() {
        look(along);
    }
    for number in 0..27 {
        if let Some(along) = fixed_direction(number) {
            look(along);
        }
    }
    (shortest < reach).then_some(best)
}

/// The half-space of least overlap above `floor`.
fn next_plane(blocked: &Blocked, floor: f32) -> Option<HalfSpace> {
    let mut next: Option<HalfSpace> = None;
    for plane in &blocked.planes {
        if plane.offset > floor && next.is_none_or(|known| plane.offset < known.offset) {
            next = Some(*plane);
        }
    }
    next
}

/// The least s >= 0 for which `s * along` parts all pairs; infinite when it is not below `give_up`.
///
/// Each pass moves to the end of an interval that covers the place reached so far, so every pair
/// moves it at most once.
fn first_gap(all: &[Blocked], along: Vec3, give_up: f32) -> f32 {
    let mut intervals = ArrayVec::<Interval, UNION_PAIRS_MAX>::new();
    for blocked in all {
        let interval = blocked.interval(along);
        if interval.from < 0.0 && interval.to > give_up {
            return f32::INFINITY;
        }
        intervals.push(interval);
    }
    let mut place = 0.0;
    let mut moved = true;
    while moved {
        moved = false;
        for interval in &intervals {
            if interval.from < place + f32::EPSILON * place && place < interval.to {
                place = interval.to;
                moved = true;
            }
            if place > give_up {
                return f32::INFINITY;
            }
        }
    }
    place
}

/// Improves `result.offset` by choosing half-spaces, best first.
///
/// A node is a set of chosen half-spaces and the nearest point of their common part, which is no
/// farther than any translation that satisfies them. The most violated pair at that point gives the
/// children. The first node popped that violates nothing is the optimum; every second pop is
/// followed down to its best child instead, to have a better answer early if the budget ends.
fn branch_and_bound(scratch: &mut UnionScratch, nodes_max: u32, result: &mut Translation) {
    let all = &scratch.blocked;
    let waiting = &mut scratch.waiting;
    if nodes_max > 0 {
        result.offset = settled(all, result.offset);
    }
    let mut best = result.offset.length_squared();
    let mut complete = !all
        .iter()
        .any(|pair| pair.missing_from < length(result.offset));
    waiting.clear();
    waiting.push(Node::ROOT);
    let mut dive: Option<Node> = None;
    let mut pops = 0u32;
    while result.nodes < nodes_max {
        let next = dive.take().or_else(|| {
            pops += 1;
            pop_least(waiting)
        });
        let Some(node) = next else {
            result.optimal = complete;
            return;
        };
        if node.squared >= best {
            continue;
        }
        result.nodes += 1;
        let Some(worst) = most_violated(all, node.point) else {
            result.offset = settled(all, node.point);
            best = result.offset.length_squared();
            continue;
        };
        let mut nearest: Option<Node> = None;
        for plane in &all[worst].planes {
            let Some(child) = node.with(*plane).filter(|child| child.squared < best) else {
                continue;
            };
            let previous = match nearest {
                Some(known) if child.squared >= known.squared => Some(child),
                known => {
                    nearest = Some(child);
                    known
                }
            };
            if let Some(other) = previous {
                complete &= wait(waiting, other);
            }
        }
        if pops % 2 == 1 {
            dive = nearest;
        } else if let Some(child) = nearest {
            complete &= wait(waiting, child);
        }
    }
    result.optimal = complete && waiting.iter().all(|node| node.squared >= best) && dive.is_none();
}

/// A translation at least as short as one that parts all pairs: each pair keeps the half-space that
/// it satisfies best, and the nearest point of those is taken, a few times over.
fn settled(all: &[Blocked], start: Vec3) -> Vec3 {
    let mut best = start;
    for _ in 0..SETTLE_ROUNDS {
        let Some(point) = nearest_of_chosen(all, best) else {
            break;
        };
        let shorter = point.length_squared() < best.length_squared() * (1.0 - ROUNDING_PART);
        if !shorter || most_violated(all, point).is_some() {
            break;
        }
        best = point;
    }
    best
}

/// The nearest point of the half-spaces, one a pair, that a translation satisfies best.
///
/// The most violated one is added until none is: every addition takes the point farther out, so
/// none comes back for long, and [`SETTLE_STEPS`] bounds the rest.
fn nearest_of_chosen(all: &[Blocked], t: Vec3) -> Option<Vec3> {
    let mut chosen = ArrayVec::<HalfSpace, UNION_PAIRS_MAX>::new();
    for blocked in all {
        chosen.push(*blocked.best_plane(t)?);
    }
    let mut node = Node::ROOT;
    for _ in 0..SETTLE_STEPS {
        let mut most = ROUNDING_PART * length(node.point);
        let mut worst = None;
        for plane in &chosen {
            let left = plane.left(node.point);
            if left > most {
                (most, worst) = (left, Some(plane));
            }
        }
        match worst {
            None => return Some(node.point),
            Some(plane) => node = node.with(*plane)?,
        }
    }
    None
}

/// The pair with the most overlap left after a translation, if any is left.
fn most_violated(all: &[Blocked], t: Vec3) -> Option<usize> {
    let mut most = ROUNDING_PART * length(t);
    let mut worst = None;
    for (index, blocked) in all.iter().enumerate() {
        let left = blocked.left(t);
        if left > most {
            most = left;
            worst = Some(index);
        }
    }
    worst
}

/// Takes the waiting node of least length, the first of those that tie.
fn pop_least(waiting: &mut ArrayVec<Node, NODES_WAITING_MAX>) -> Option<Node> {
    let mut least = 0;
    for (index, node) in waiting.iter().enumerate() {
        if node.squared < waiting[least].squared {
            least = index;
        }
    }
    waiting.swap_pop(least)
}

/// Lets a node wait; false when the longest had to be forgotten for want of room.
fn wait(waiting: &mut ArrayVec<Node, NODES_WAITING_MAX>, node: Node) -> bool {
    if waiting.try_push(node).is_ok() {
        return true;
    }
    let mut longest = 0;
    for (index, known) in waiting.iter().enumerate() {
        if known.squared > waiting[longest].squared {
            longest = index;
        }
    }
    if node.squared < waiting[longest].squared {
        waiting[longest] = node;
    }
    false
}

/// The point nearest the origin that satisfies all half-spaces, the last of which was violated
/// by the nearest point of the others. `None` when they have no common point.
///
/// The last is active then, so the point is decided by it and at most two more; with multipliers
/// that are not negative and nothing violated it is the one (Karush, Kuhn and Tucker). In f64, so
/// that nearly parallel planes do no harm.
fn nearest_point(planes: &[HalfSpace]) -> Option<Vec3> {
    let (last, others) = planes.split_last()?;
    let first = row(last);
    if first.1 > 0.0 {
        let point = first.0 * (first.1 / first.0.length_squared());
        if satisfies(planes, point) {
            return Some(point.as_vec3());
        }
    }
    for (index, other) in others.iter().enumerate() {
        if let Some(point) = on_two(first, row(other)).filter(|&p| satisfies(planes, p)) {
            return Some(point.as_vec3());
        }
        for third in &others[..index] {
            let point = on_three(first, row(other), row(third));
            if let Some(point) = point.filter(|&p| satisfies(planes, p)) {
                return Some(point.as_vec3());
            }
        }
    }
    None
}

fn row(plane: &HalfSpace) -> (DVec3, f64) {
    (plane.normal.as_dvec3(), f64::from(plane.offset))
}

fn satisfies(planes: &[HalfSpace], point: DVec3) -> bool {
    let rounding = 1e-9 * (point.x.abs() + point.y.abs() + point.z.abs());
    planes
        .iter()
        .all(|plane| plane.normal.as_dvec3().dot(point) >= f64::from(plane.offset) - rounding)
}

/// The nearest point of the line where two planes meet, if both pull on it.
fn on_two((n, h): (DVec3, f64), (m, k): (DVec3, f64)) -> Option<DVec3> {
    let (nn, mm, nm) = (n.length_squared(), m.length_squared(), n.dot(m));
    let det = nn * mm - nm * nm;
    if det <= 1e-12 {
        return None;
    }
    let of_n = (h * mm - k * nm) / det;
    let of_m = (k * nn - h * nm) / det;
    (of_n >= 0.0 && of_m >= 0.0).then(|| n * of_n + m * of_m)
}

/// The point where three planes meet, if all pull on it.
fn on_three((n, h): (DVec3, f64), (m, k): (DVec3, f64), (o, l): (DVec3, f64)) -> Option<DVec3> {
    let (mo, on, nm) = (m.cross(o), o.cross(n), n.cross(m));
    let det = n.dot(mo);
    if det.abs() <= 1e-9 {
        return None;
    }
    let point = (mo * h + on * k + nm * l) / det;
    let pulls = [mo, on, nm].map(|across| point.dot(across) / det);
    pulls.iter().all(|&pull| pull >= 0.0).then_some(point)
}
