//! What must hold of a world after every frame, whatever its host did before.

use std::fmt;

use glam::DVec3;
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::Ball;
use palpable::limits::{FRAME_S_MAX, WORLD_REACH_M};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId, PieceId};
use palpable::state::bodies::{BodyKind, Coupling, DrivenReport};
use palpable::state::events::ContactEvent;
use palpable::world::World;

use crate::cast::{BodyOf, Cast};
use crate::overlap::{Class, Overlap, Overlaps};
use crate::put::Put;

/// How far a published angle may be outside its range, and a limb outside its cone, in radians.
const LIMIT_RAD: f64 = 1e-5;

/// How far a published orientation, or a normal, may be from unit length.
const UNIT_MAX: f64 = 1e-5;

/// What of an overlap that the host made may be rounding, in metres, near the origin.
const GROWTH_M: f64 = 1e-6;

/// The same as a part of the distance from the origin and of the depth: four roundings.
const GROWTH_PART: f64 = 4.0 * f32::EPSILON as f64;

/// A loose piece whose box is nearer than this to a driven piece's may have stopped it in the middle of the
/// frame, in metres.
const STOPS_M: f64 = 5e-3;

/// The first invariant that does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// Which.
    pub what: &'static str,
    /// Where, and by how much.
    pub detail: String,
}

impl Broken {
    pub(crate) fn new(what: &'static str, detail: impl fmt::Debug) -> Self {
        Self {
            what,
            detail: format!("{detail:?}"),
        }
    }
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.what, self.detail)
    }
}

impl std::error::Error for Broken {}

fn hold(holds: bool, what: &'static str, detail: impl fmt::Debug) -> Result<(), Broken> {
    if holds {
        Ok(())
    } else {
        Err(Broken::new(what, detail))
    }
}

fn all_finite(numbers: &[f32]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

fn is_unit(parts: &[f32]) -> bool {
    let square: f64 = parts.iter().map(|&part| f64::from(part).powi(2)).sum();
    (square.sqrt() - 1.0).abs() <= UNIT_MAX
}

/// The most that an overlap which a pair of pieces showed may have been but for rounding, in metres.
type Known = ([PieceId; 2], f64);

/// A ball by its chain and first hinge, and how far it is outside its cone, in radians.
type Outside = ((ChainId, usize), f64);

/// The deepest overlaps that were seen, by [`Class`], in metres.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// Of pairs that the host did not make overlap.
    pub clean_m: [f64; Class::COUNT],
    /// Of pairs that it did.
    pub made_m: [f64; Class::COUNT],
    /// Of pairs whose overlap is not promised away: see [`Checker`].
    pub excused_m: [f64; Class::COUNT],
    /// The farthest that a ball was outside its cone where a loose body had stopped it, in radians.
    pub outside_rad: f64,
}

/// Judges one world, frame by frame: [`Checker::before`] and [`Checker::after`] each step.
///
/// Links that the host put into each other by less than is promised stay so in their body's frame, and show in the world
/// what rounding their positions makes of it.
///
/// What the kernel does not promise is counted apart: a driven body that a loose one stopped in the middle of
/// the frame may be met by another driven one, and be outside a cone; one that leaves overlap which the host
/// made goes through loose bodies; and the host's own engine moves its bodies as it likes.
#[derive(Clone, Debug, Default)]
pub struct Checker {
    overlaps: Overlaps,
    /// Overlaps beyond the limits that the host made, as deep as they were last.
    known: Vec<Known>,
    /// Links in each other within the limits, as deep as the host put them.
    put: Put,
    /// The cast's counts of changes and of moves that were looked at.
    seen: (u64, u64),
    frames: u64,
    high_water: Option<Capacities>,
    /// Balls outside their cones, by chain and first hinge, and how far, in radians.
    outside: Vec<Outside>,
    /// Bodies that are to stay: driven ones where nothing may be spent, and dynamic ones out of the world.
    held: Vec<(BodyId, Pose)>,
    /// The deepest overlaps so far.
    pub worst: Worst,
}

impl Checker {
    /// Looks at a world before a frame: overlap that is there is the host's.
    pub fn before(&mut self, world: &World, cast: &Cast, input: &FrameInput) {
        let seen = (cast.changes, cast.moves);
        if seen != self.seen {
            let afresh = cast.changes != self.seen.0;
            self.seen = seen;
            let left = self.overlaps.found().to_vec();
            self.overlaps.measure(cast, world.piece_poses(), afresh);
            self.put.note(&left, self.overlaps.found());
            self.know(world);
            for overlap in self.overlaps.found() {
                let worst = &mut self.worst.made_m[overlap.class as usize];
                *worst = worst.max(overlap.depth_m);
            }
        }
        self.held.clear();
        self.hold_lost(world, cast);
        if input.budget.advance_units == 0 {
            self.hold_back(world, cast);
        }
    }

    /// Notes the dynamic bodies that left the world: there they stop.
    fn hold_lost(&mut self, world: &World, cast: &Cast) {
        for body in cast.bodies.iter().filter(|b| b.kind == BodyKind::Dynamic) {
            if let Ok(pose) = world.pose(body.id)
                && !is_inside(&pose)
            {
                self.held.push((body.id, pose));
            }
        }
    }

    /// Notes the driven bodies that boxes alone do not prove clear.
    fn hold_back(&mut self, world: &World, cast: &Cast) {
        for body in cast.bodies.iter().filter(|b| b.kind == BodyKind::Driven) {
            if self.is_boxed_in(cast, body)
                && let Ok(pose) = world.pose(body.id)
            {
                self.held.push((body.id, pose));
            }
        }
    }

    /// Whether the box around a piece of a driven body overlaps that of a fixed one.
    fn is_boxed_in(&self, cast: &Cast, body: &BodyOf) -> bool {
        let places = |holds: &dyn Fn(usize) -> bool| {
            let all = 0..cast.pieces.len();
            all.filter(|&at| holds(at)).collect::<Vec<usize>>()
        };
        let own = places(&|at| cast.pieces[at].body == body.id);
        let fixed = places(&|at| cast.pieces[at].kind == BodyKind::Fixed);
        let pairs = own.iter().flat_map(|&a| fixed.iter().map(move |&b| [a, b]));
        let mut boxes = pairs.map(|pair| self.overlaps.boxes_overlap(pair, 1e-3));
        body.coupling.snap == Coupling::SNAP_NEVER && boxes.any(|overlap| overlap)
    }

    /// Looks at a world after a frame, and at what the frame reported.
    ///
    /// # Errors
    /// The first invariant that does not hold.
    pub fn after(
        &mut self,
        world: &World,
        cast: &Cast,
        input: &FrameInput,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        self.check_report(world, input, report)?;
        check_poses(world, cast)?;
        check_reports(world, cast)?;
        if report.flags & FrameReport::BAD_TIME_STEP == 0 {
            check_contacts(world)?;
        }
        self.check_capacities(world)?;
        for (body, before) in &self.held {
            let now = world.pose(*body);
            let stayed = now == Ok(*before);
            hold(
                stayed,
                "a body moved without budget near others, or out of the world",
                (body, before, now),
            )?;
        }
        self.check_overlaps(world, cast, input, report)?;
        self.check_limits(world, cast, report)
    }

    fn check_report(
        &mut self,
        world: &World,
        input: &FrameInput,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        let budget = &input.budget;
        let within = report.advance_units <= budget.advance_units
            && report.impulse_units <= budget.impulse_units
            && report.reach_steps <= budget.reach_steps;
        hold(within, "more was spent than the budget", (budget, report))?;
        hold(report.flags >> 12 == 0, "a flag is not known", report)?;
        let below = report.flags & FrameReport::BELOW_FLOOR != 0;
        let paid = input.deadline.is_none_or(|deadline| {
            report.priced_ns <= deadline.time_ns || (below && report.priced_ns == report.floor_ns)
        });
        // What costs nothing is spent even so.
        let free = input.deadline.is_some_and(|deadline| {
            let costs = deadline.costs;
            [
                costs.advance_unit_ns,
                costs.impulse_unit_ns,
                costs.reach_step_ns,
            ]
            .contains(&0)
        });
        hold(
            paid || free,
            "a frame cost more than its deadline",
            (input, report),
        )?;
        let counts = report.contacts as usize == world.contacts().len()
            && report.events as usize == world.contact_events().len();
        let stepped = report.flags & FrameReport::BAD_TIME_STEP == 0;
        hold(
            counts || !stepped,
            "counts are not those of the lists",
            report,
        )?;
        let lost = (0.0..=FRAME_S_MAX).contains(&report.lost_s);
        hold(lost, "time lost is not within the frame", report)?;
        let good = input.dt_s > 0.0 && input.dt_s.is_finite();
        hold(
            good == stepped,
            "a time step was judged wrongly",
            (input.dt_s, report),
        )?;
        let frames = self.frames + u64::from(stepped);
        hold(
            report.frame == frames,
            "a frame was not counted",
            (frames, report),
        )?;
        self.frames = frames;
        Ok(())
    }

    /// Starts from a world as it is: after a rollback, or when it was stepped before.
    pub fn start_from(&mut self, world: &World, cast: &Cast, frames: u64) {
        self.frames = frames;
        self.high_water = None;
        self.outside = outside(world, cast);
    }

    fn check_capacities(&mut self, world: &World) -> Result<(), Broken> {
        let (most, room) = (world.high_water(), world.capacities());
        let counts = |of: &Capacities| {
            [
                of.bodies,
                of.pieces,
                of.vertices,
                of.pairs,
                of.contacts,
                of.materials,
                of.chains,
                of.joints,
            ]
        };
        let fits =
            |a: &Capacities, b: &Capacities| counts(a).iter().zip(counts(b)).all(|(&a, b)| a <= b);
        hold(
            fits(&most, &room),
            "a high-water mark is above its capacity",
            most,
        )?;
        if let Some(before) = &self.high_water {
            hold(
                fits(before, &most),
                "a high-water mark fell",
                (before, most),
            )?;
        }
        self.high_water = Some(most);
        Ok(())
    }

    fn check_overlaps(
        &mut self,
        world: &World,
        cast: &Cast,
        input: &FrameInput,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        self.check_told(cast, input, report)?;
        self.overlaps.measure(cast, world.piece_poses(), false);
        for index in 0..self.overlaps.found().len() {
            let overlap = self.overlaps.found()[index];
            let known = self.known.iter().find(|(pair, _)| *pair == overlap.pieces);
            match known.map(|(_, depth_m)| *depth_m) {
                Some(before_m) => self.check_made(world, cast, &overlap, before_m, report)?,
                None => self.check_clean(world, cast, &overlap, report)?,
            }
        }
        self.put.keep(self.overlaps.found());
        self.know(world);
        Ok(())
    }

    /// Notes what is deeper than promised, but for what the host put less deep.
    fn know(&mut self, world: &World) {
        self.known = beyond(world, self.overlaps.found(), &self.known);
        self.known.retain(|(pieces, _)| !self.put.has(*pieces));
    }

    /// Overlap that the host made does not grow.
    fn check_made(
        &mut self,
        world: &World,
        cast: &Cast,
        overlap: &Overlap,
        before_m: f64,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        let most = before_m.max(overlap.class.limit_m()) + rounding_m(world, overlap);
        if overlap.depth_m > most && !self.is_excused(world, cast, overlap, report) {
            return Err(Broken::new(
                "overlap that the host made grew",
                (before_m, overlap),
            ));
        }
        let worst = &mut self.worst.made_m[overlap.class as usize];
        *worst = worst.max(overlap.depth_m);
        Ok(())
    }

    /// Pairs that the host did not make overlap do so by no more than promised.
    fn check_clean(
        &mut self,
        world: &World,
        cast: &Cast,
        overlap: &Overlap,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        let put_m = self.put.most_m(overlap, world.piece_poses());
        let worst = if put_m.is_some_and(|most_m| overlap.depth_m <= most_m) {
            &mut self.worst.made_m[overlap.class as usize]
        } else if overlap.depth_m <= overlap.class.limit_m() {
            &mut self.worst.clean_m[overlap.class as usize]
        } else if self.is_excused(world, cast, overlap, report) {
            &mut self.worst.excused_m[overlap.class as usize]
        } else {
            return Err(Broken::new("overlap", (overlap, overlap.class.name())));
        };
        *worst = worst.max(overlap.depth_m);
        Ok(())
    }

    /// Whether an overlap is one of those that are not promised: a driven body was stopped by a loose one in
    /// the middle of the frame where another driven one came by; it left overlap that the host made, through
    /// loose bodies; or the host's own engine moved one of the two.
    fn is_excused(
        &self,
        world: &World,
        cast: &Cast,
        overlap: &Overlap,
        report: &FrameReport,
    ) -> bool {
        let leaps = |&place: &usize| {
            let report = world.driven_report(cast.pieces[place].body);
            report.is_ok_and(|report| report.flags & DrivenReport::OVERLAPS != 0)
        };
        match overlap.class {
            Class::DrivenDriven => {
                let mut pieces = overlap.pieces.iter();
                pieces.any(|&id| may_be_stopped(world, cast, &self.overlaps, id, report))
            }
            Class::DynamicDriven => overlap.places.iter().any(leaps),
            Class::Hosted => true,
            _ => false,
        }
    }

    /// Whether the report says that a driven body overlaps a fixed one where the host put it.
    fn check_told(
        &self,
        cast: &Cast,
        input: &FrameInput,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        let unsure =
            FrameReport::BAD_TIME_STEP | FrameReport::ADVANCE_CUT | FrameReport::FULL_PAIRS;
        if report.flags & (unsure | FrameReport::OVERLAP) != 0 || input.budget.advance_units < 4096
        {
            return Ok(());
        }
        let snaps = |id: PieceId| {
            let piece = cast.pieces.iter().find(|piece| piece.id == id);
            let body = piece.and_then(|piece| cast.body(piece.body));
            body.is_some_and(|body| body.coupling.snap != Coupling::SNAP_NEVER)
        };
        for overlap in self.overlaps.found() {
            let host_made = overlap.class == Class::DrivenFixed
                && overlap.depth_m > overlap.class.limit_m()
                && !overlap.pieces.iter().any(|&piece| snaps(piece));
            hold(
                !host_made,
                "overlap that the host made was not reported",
                overlap,
            )?;
        }
        Ok(())
    }

    fn check_limits(
        &mut self,
        world: &World,
        cast: &Cast,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        for chain in &cast.chains {
            let angles = world.angles(chain.id);
            let angles = angles.map_err(|error| Broken::new("a chain is gone", error))?;
            let targets = world.target_angles(chain.id);
            let targets = targets.map_err(|error| Broken::new("a chain is gone", error))?;
            for (index, hinge) in chain.hinges.iter().enumerate() {
                for angle in [angles[index], targets[index]].map(f64::from) {
                    let low = f64::from(hinge.low_rad) - LIMIT_RAD;
                    let high = f64::from(hinge.high_rad) + LIMIT_RAD;
                    let kept = (low..=high).contains(&angle);
                    hold(
                        kept,
                        "a joint is outside its range",
                        (chain.id, index, angle),
                    )?;
                }
            }
        }
        self.check_cones(world, cast, report)
    }

    /// Balls are within their cones. One that a loose body stopped outside comes no farther out; one whose body was
    /// cut may be anywhere on its way.
    fn check_cones(
        &mut self,
        world: &World,
        cast: &Cast,
        report: &FrameReport,
    ) -> Result<(), Broken> {
        let left = outside(world, cast);
        for (name, far) in &left {
            let known = self.outside.iter().find(|(other, _)| other == name);
            let body = cast.chain(name.0).map_or(BodyId::NULL, |chain| chain.body);
            let mut pieces = cast.pieces_of(body);
            let cut = world.driven_report(body);
            let excused = known.is_some_and(|(_, before)| *far <= before + LIMIT_RAD)
                || cut.is_ok_and(|report| report.flags & DrivenReport::CUT != 0)
                || pieces
                    .any(|piece| may_be_stopped(world, cast, &self.overlaps, piece.id, report));
            hold(excused, "a ball is outside its cone", (name, far))?;
            self.worst.outside_rad = self.worst.outside_rad.max(*far);
        }
        self.outside = left;
        Ok(())
    }
}

/// Balls that are outside their cones, and how far, in radians.
fn outside(world: &World, cast: &Cast) -> Vec<Outside> {
    let mut found = Vec::new();
    for chain in &cast.chains {
        let angles = world.angles(chain.id).unwrap_or_default();
        for ball in &chain.balls {
            let far = outside_rad(ball, angles);
            if far > LIMIT_RAD {
                found.push(((chain.id, ball.first), far));
            }
        }
    }
    found
}

/// Overlaps that are deeper than promised, with what rounding may have taken off them. One that was stays so
/// until it is less than promised by more than rounding.
fn beyond(world: &World, found: &[Overlap], before: &[Known]) -> Vec<Known> {
    let mut known = Vec::new();
    for overlap in found {
        let rounding_m = rounding_m(world, overlap);
        let was = before.iter().any(|(pieces, _)| *pieces == overlap.pieces);
        let kept_m = if was { rounding_m } else { 0.0 };
        if overlap.depth_m > overlap.class.limit_m() - kept_m {
            known.push((overlap.pieces, overlap.depth_m + rounding_m));
        }
    }
    known
}

/// What of an overlap may be rounding of the pieces' poses and of the kernel's depth, in metres.
fn rounding_m(world: &World, overlap: &Overlap) -> f64 {
    let far = overlap.pieces.map(|piece| {
        let at = world.piece_poses()[piece.index1 as usize - 1].position;
        DVec3::from_array(at.map(f64::from)).length()
    });
    GROWTH_M + GROWTH_PART * (far[0].max(far[1]) + overlap.depth_m)
}

/// Whether a loose body may have stopped a piece's driven body before the end of the frame.
fn may_be_stopped(
    world: &World,
    cast: &Cast,
    overlaps: &Overlaps,
    piece: PieceId,
    report: &FrameReport,
) -> bool {
    let cut = FrameReport::IMPULSES_CUT | FrameReport::FULL_PAIRS | FrameReport::FULL_CONTACTS;
    if report.flags & cut != 0 {
        return true;
    }
    let is_loose = |kind: BodyKind| kind == BodyKind::Dynamic || kind == BodyKind::Hosted;
    let Some(body) = cast.pieces.iter().find(|p| p.id == piece).map(|p| p.body) else {
        return false;
    };
    let owner = |id: PieceId| cast.pieces.iter().find(|p| p.id == id);
    let touches = world.contacts().iter().any(|contact| {
        let [a, b] = [contact.piece_a, contact.piece_b].map(owner);
        a.is_some_and(|a| is_loose(a.kind)) && b.is_some_and(|b| b.body == body)
    });
    let places = 0..cast.pieces.len();
    let own = places.clone().filter(|&at| cast.pieces[at].body == body);
    touches
        || own.into_iter().any(|a| {
            let mut loose = places.clone().filter(|&at| is_loose(cast.pieces[at].kind));
            loose.any(|b| overlaps.boxes_overlap([a, b], -STOPS_M))
        })
}

fn check_poses(world: &World, cast: &Cast) -> Result<(), Broken> {
    for body in &cast.bodies {
        let pose = world.pose(body.id);
        let pose = pose.map_err(|error| Broken::new("a body is gone", (body.id, error)))?;
        check_pose(&pose, "a body's pose")?;
        let near = 1.000_001 * WORLD_REACH_M;
        let inside = body.kind != BodyKind::Driven || pose.position.iter().all(|x| x.abs() <= near);
        hold(inside, "a body left the world", (body, pose))?;
    }
    for piece in &cast.pieces {
        let pose = world.piece_pose(piece.id);
        let pose = pose.map_err(|error| Broken::new("a piece is gone", (piece.id, error)))?;
        check_pose(&pose, "a piece's pose")?;
    }
    for chain in &cast.chains {
        let poses = world.link_poses(chain.id);
        let poses = poses.map_err(|error| Broken::new("a chain is gone", error))?;
        for pose in poses {
            check_pose(pose, "a link's pose")?;
        }
    }
    Ok(())
}

fn check_pose(pose: &Pose, what: &'static str) -> Result<(), Broken> {
    hold(pose.is_finite() && is_unit(&pose.rotation), what, pose)
}

/// Whether a place is in the world.
fn is_inside(pose: &Pose) -> bool {
    pose.position.iter().all(|x| x.abs() <= WORLD_REACH_M)
}

/// What the world says of each body and chain.
fn check_reports(world: &World, cast: &Cast) -> Result<(), Broken> {
    for body in &cast.bodies {
        match body.kind {
            BodyKind::Driven => check_driven(world, body)?,
            BodyKind::Dynamic => {
                let moves = world.velocity(body.id);
                let finite = moves.is_ok_and(|(v, w)| all_finite(&v) && all_finite(&w));
                hold(finite, "a velocity is not finite", (body.id, moves))?;
            }
            BodyKind::Hosted => {
                let got = world.hosted_impulse(body.id);
                let finite = got.is_ok_and(|got| {
                    all_finite(&got.impulse_n_s)
                        && all_finite(&got.angular_n_m_s)
                        && all_finite(&got.point)
                        && got.push_n_s >= 0.0
                        && got.push_n_s.is_finite()
                });
                hold(finite, "a hosted impulse is not finite", (body.id, got))?;
            }
            BodyKind::Fixed => {}
        }
    }
    for chain in &cast.chains {
        let report = world.chain_report(chain.id);
        let sound = report.is_ok_and(|report| {
            let known = report.flags >> 4 == 0;
            known && report.missed_m.is_finite() && report.deviation_rad.is_finite()
        });
        hold(sound, "a chain's report", (chain.id, report))?;
    }
    Ok(())
}

fn check_driven(world: &World, body: &BodyOf) -> Result<(), Broken> {
    let report = world.driven_report(body.id);
    let sound = |report: DrivenReport| {
        report.flags >> 8 == 0
            && report.displacement_m >= 0.0
            && report.displacement_m.is_finite()
            && all_finite(&report.force_n)
            && all_finite(&report.reaction_n)
    };
    hold(
        report.is_ok_and(sound),
        "a driven body's report",
        (body.id, report),
    )
}

fn check_contacts(world: &World) -> Result<(), Broken> {
    let lives = |piece: PieceId| world.piece_pose(piece).is_ok();
    for contact in world.contacts() {
        let numbers = [contact.gap_m, contact.impulse_n_s, contact.approach_m_s];
        let sound = all_finite(&contact.point)
            && is_unit(&contact.normal)
            && all_finite(&numbers)
            && contact.slide_m_s.is_finite()
            && contact.impulse_n_s >= 0.0
            && contact.approach_m_s >= 0.0
            && contact.slide_m_s >= 0.0;
        hold(sound, "a contact's numbers", contact)?;
        let live = lives(contact.piece_a) && lives(contact.piece_b);
        hold(live, "a contact of a piece that is gone", contact)?;
    }
    for event in world.contact_events() {
        let sound = all_finite(&event.point)
            && is_unit(&event.normal)
            && all_finite(&[event.impulse_n_s, event.approach_m_s, event.slide_m_s]);
        hold(sound, "an event's numbers", event)?;
        let known = (ContactEvent::BEGIN..=ContactEvent::END).contains(&event.kind);
        let live = lives(event.piece_a) && lives(event.piece_b);
        let ended = event.kind == ContactEvent::END;
        hold(
            known && (live || ended),
            "an event of a piece that is gone",
            event,
        )?;
    }
    Ok(())
}

/// How far a ball's limb is outside its cone in f64, in radians: zero inside, else the angle to the nearest
/// edge.
fn outside_rad(ball: &Ball, angles: &[f32]) -> f64 {
    let [a, b] = [ball.first, ball.first + 1].map(|hinge| f64::from(angles[hinge]));
    let limb = DVec3::new(b.sin(), -a.sin() * b.cos(), a.cos() * b.cos());
    let visible = ball.cone.visible().as_dvec3();
    let corners = ball.cone.corners();
    let mut nearest = f64::INFINITY;
    for index in 0..corners.len() {
        let next = (index + 1) % corners.len();
        let [from, to] = [index, next].map(|corner| corners[corner].as_dvec3());
        let inward = from.cross(to).normalize();
        let in_lune = visible.cross(from).dot(limb) >= 0.0 && to.cross(visible).dot(limb) >= 0.0;
        if in_lune && inward.dot(limb) >= 0.0 {
            return 0.0;
        }
        nearest = nearest.min(to_edge_rad(limb, from, to, inward));
    }
    nearest
}

/// The angle between a direction and the arc between two, which `normal` is square to.
fn to_edge_rad(limb: DVec3, from: DVec3, to: DVec3, normal: DVec3) -> f64 {
    let beside = normal.cross(from).dot(limb) >= 0.0 && to.cross(normal).dot(limb) >= 0.0;
    if beside {
        normal.dot(limb).clamp(-1.0, 1.0).asin().abs()
    } else {
        limb.angle_between(from).min(limb.angle_between(to))
    }
}
