//! Every bound of the kernel: its reason, its unit, and the relations between them, checked when
//! the crate is compiled.

use crate::math::LANE_WIDTH;

/// How deep a published driven piece may overlap a fixed one, in metres: promise P1.
///
/// Half of it is kept as a gap on the other side, so that rounding never eats into the promise.
pub const OVERLAP_SLOP_M: f32 = 1e-4;

/// Most vertices of one piece. The ball of Schmidl and Lin 2004 has 482.
pub const PIECE_VERTICES_MAX: usize = 512;

/// Most faces of one piece: a closed triangle mesh with V vertices has 2 V - 4 faces (Euler).
pub const PIECE_FACES_MAX: usize = 2 * PIECE_VERTICES_MAX - 4;

/// Most edges of one piece: 3 V - 6 (Euler).
pub const PIECE_EDGES_MAX: usize = 3 * PIECE_VERTICES_MAX - 6;

/// Most entries in the vertex loops of one piece: every edge borders two faces.
pub const PIECE_LOOPS_MAX: usize = 2 * PIECE_EDGES_MAX;

/// Most lanes of vertices of one piece.
pub const PIECE_LANES_MAX: usize = PIECE_VERTICES_MAX.div_ceil(LANE_WIDTH);

/// Most contacts between one pair of pieces.
pub const MANIFOLD_CONTACTS_MAX: usize = 4;

/// The farthest a coordinate may be from the origin, in metres. Below it f32 coordinates are spaced by
/// at most 0.061 mm, which gaps that grow with them can still take: see [`GAP_LOST_PART`].
pub const WORLD_REACH_M: f32 = 1024.0;

const _: () = assert!(PIECE_LANES_MAX * LANE_WIDTH == PIECE_VERTICES_MAX);
const _: () = assert!(PIECE_LOOPS_MAX <= u16::MAX as usize);
const _: () = assert!(PIECE_VERTICES_MAX + PIECE_FACES_MAX == PIECE_EDGES_MAX + 2);

/// Most legs of a driven body's way through one frame: one free leg and three slides, after which
/// more slides were found to gain nothing within the frame (the rest follows in the next one).
pub const LEGS_MAX: usize = 4;

/// Most steps of one distance query. Cores of 512 vertices were seen to need 20.
pub const DISTANCE_STEPS_MAX: u32 = 48;

/// The gap that no path of a driven body undercuts, in metres. It is what f32 may lose between the
/// kernel's arithmetic and the truth (pieces up to 10 m, 100 m from the origin); beyond, all gaps of driven
/// bodies are kept wider by what more may be lost.
pub const GAP_FLOOR_M: f32 = 0.2 * OVERLAP_SLOP_M;

/// What f32 may lose of a gap between two poses of a leg, as a part of the numbers that make the poses: each
/// coordinate is rounded by 2^-24 of itself when the root goes on and when the piece is placed on it, at both
/// poses; the square root of three brings that to less than 4 * 2^-24 of each number.
pub const GAP_LOST_PART: f32 = 2.0 * f32::EPSILON;

/// How much of that the slop and the floor take, in metres.
pub const GAP_LOST_M: f32 = 0.8 * OVERLAP_SLOP_M;

/// The gap at which a driven body rests against fixed ones, in metres: above the floor so that it
/// can slide and turn a little, below the slop so that nobody sees it.
pub const GAP_REST_M: f32 = 0.6 * OVERLAP_SLOP_M;

/// Pairs closer than this are in contact, in metres.
pub const GAP_TOUCHING_M: f32 = OVERLAP_SLOP_M;

/// A driven body in contact does not take a step shorter than this, in metres: that makes rest a
/// fixed point (promise P4). Larger values make slow sliding visibly stick.
pub const STILL_M: f32 = 0.1 * OVERLAP_SLOP_M;

/// How far a driven body that leans on sleepers may be wanted aside while its tracker is still, in metres: a tenth of a
/// newton by the default spring. Its coupling comes to rest later than what it holds, and is not to wake that.
pub const LEANING_M: f32 = OVERLAP_SLOP_M;

/// And how far turned, in radians.
pub const LEANING_RAD: f32 = 1e-3;

/// Advancing along a path stops when a step would be shorter than this, in metres.
pub const STEP_MIN_M: f32 = 0.02 * OVERLAP_SLOP_M;

/// Boxes are grown by this before they are paired, in metres, so that a slide along a contact
/// mostly stays among the pairs that were found for the straight way.
pub const PAIR_MARGIN_M: f32 = 0.02;

/// Most contacts that bend one leg of a driven body's way. A body rests on three planes; more only
/// come from many pieces touching the same surface, and then the deepest ones bind.
pub const SLIDE_PLANES_MAX: usize = 32;

/// Most units that one driven body may spend on its way through one frame.
pub const ADVANCE_UNITS_MAX: u32 = 4096;

/// Most units that the loose bodies may spend in one frame.
pub const IMPULSE_UNITS_MAX: u32 = 16384;

/// Most frames for which what a driven body knows of its gaps is kept after the last one that was cut.
pub const LOOK_FRAMES_MAX: u32 = 64;

/// Lanes of vertices of a pair that its distance query has for one unit; every so many more cost another.
/// Ordinary pieces (64 vertices and fewer) cost one.
pub const QUERY_LANES: u32 = 16;

/// Impulses that make a unit, and other work about as large: what one row or one body takes in an event.
pub const PARTS_PER_UNIT: u32 = 8;

/// Tests of two boxes that make a unit.
pub const BOXES_PER_UNIT: u32 = 256;

/// Units for planning a leg along contacts, beside the steps of chains.
pub const PLAN_UNITS: u32 = 1;

/// Units for the search of a way out of overlap that the host made, and for each pair that it looks at.
/// It is not begun with fewer.
pub const WAY_OUT_UNITS: u32 = 32;

/// The same for each pair that the search looks at, beside one for each pair that it is weighed against: itself and
/// others, of which [`WAY_OUT_OTHERS_MAX`] count.
pub const WAY_OUT_PAIR_UNITS: u32 = 12;

/// See [`WAY_OUT_PAIR_UNITS`].
pub const WAY_OUT_OTHERS_MAX: u32 = 16;

/// One part in so many of a frame's time is kept for loose bodies that are awake.
pub const LOOSE_SHARE: u64 = 4;

/// The fastest that a loose body moves, in m/s; faster ones are slowed to this.
pub const SPEED_MAX: f32 = 1e3;

/// The fastest that a loose body turns, in rad/s: half a turn in the shortest usual frame (1 ms).
pub const SPIN_MAX: f32 = 3e3;

/// The largest coordinate of a host's force, torque or impulse, in N, N m or N s.
pub const FORCE_MAX: f32 = 1e9;

/// The largest density of a piece, in kg/m3: far beyond any matter. Masses, moments and impulses stay far within
/// f32.
pub const DENSITY_MAX: f32 = 1e9;

/// The largest coefficient of friction. What sticks at that sticks; its products with impulses stay far
/// within f32.
pub const FRICTION_MAX: f32 = 1e6;

/// Coordinates of a displacement smaller than this are no displacement, in metres or radians.
pub const DISPLACEMENT_MIN: f32 = 1e-5;

/// A displacement ends when it is small and changes by less than this, in m/s or rad/s.
pub const DISPLACEMENT_RATE_MIN: f32 = 1e-3;

/// The shortest frame that is stepped as it is, in seconds; shorter ones count as this long.
pub const FRAME_S_MIN: f32 = 1e-4;

/// The longest frame that is stepped as it is, in seconds; longer ones count as this long.
pub const FRAME_S_MAX: f32 = 0.1;

const _: () = assert!(0.0 < GAP_FLOOR_M && GAP_FLOOR_M < GAP_REST_M && GAP_REST_M < GAP_TOUCHING_M);
const _: () = assert!(GAP_TOUCHING_M <= OVERLAP_SLOP_M);
const _: () = assert!(STEP_MIN_M < STILL_M && STILL_M < GAP_REST_M - GAP_FLOOR_M);

/// The gap at which loose bodies rest, in metres: wide enough that a rolling polyhedron passes over
/// its corners in few steps, too narrow to be seen.
pub const LOOSE_REST_M: f32 = 2.5 * OVERLAP_SLOP_M;

/// Loose contacts whose gap is at most this much above the rest gap carry weight like those at it,
/// in metres.
pub const LOOSE_BAND_M: f32 = 0.5 * OVERLAP_SLOP_M;

/// Share of a gap that a certificate between loose bodies may give away. Half as many steps as with
/// none, and the next step makes up for it.
pub const LOOSE_ACCURACY: f32 = 0.05;

/// The same of a gap that is too wide for a contact, where forces are found.
pub const FAR_ACCURACY: f32 = 0.5;

/// Advancing loose bodies stops when a step would be shorter than this, in metres. A tenth of what
/// lies between the rest gap and the floor: shorter steps cost queries and gain nothing that is seen.
pub const LOOSE_STEP_MIN_M: f32 = 0.05 * OVERLAP_SLOP_M;

/// Loose bodies that overlap by more than this come no closer at all, in metres.
pub const LOOSE_DEEP_M: f32 = 0.5 * OVERLAP_SLOP_M;

/// A pair of loose bodies that comes no nearer than this in a stretch is not looked at, in metres.
pub const LOOSE_STILL_M: f32 = 0.005 * OVERLAP_SLOP_M;

/// Pairs of loose bodies closer than this get a velocity constraint, in metres.
pub const LOOSE_MARGIN_M: f32 = 20.0 * OVERLAP_SLOP_M;

/// Most events (impacts, or ends of a driven body's legs) of one frame. Loose bodies that are not
/// through by then stop at their last safe time.
pub const EVENTS_MAX: u32 = 32;

/// Most impulses on one contact within one event. With 8, a stack of three boxes that was dropped by
/// 1 mm crept 2 mm sideways before it slept; with 32 it stays within 1 mm.
pub const IMPULSES_PER_CONTACT_MAX: u32 = 32;

/// Events in a row that may bring nobody forward before somebody waits for the next frame.
pub const STALLS_MAX: u32 = 2;

/// Events that bring an island no farther than this share of the frame bring nobody forward.
pub const STALL_SHARE: f32 = 1e-4;

/// Nor do events that the same pair ends again, if they bring the island no farther than this share of the frame:
/// what bounces takes longer ([`LONE_BOUNCE_MIN`]).
pub const CREEP_SHARE: f32 = 0.01;

/// Errors of velocity that impulses leave alone, as a share of what gravity adds in a frame. Half as many
/// impulses as with a tenth of it, and a box at rest still creeps by less than a micrometre a frame.
pub const RESIDUAL_PART: f32 = 5e-4;

/// Least speed at which an impact bounces, in m/s.
pub const BOUNCE_MIN: f32 = 1e-3;

/// Least speed at which the only contact of a body bounces, in m/s: what is left of the series of bounces
/// then lasts 11 ms at a restitution of 0.9.
pub const LONE_BOUNCE_MIN: f32 = 0.006;

/// The same as a share of what gravity adds in a frame: each bounce is an event of its own, and there is room
/// for so many in a frame.
pub const LONE_BOUNCE_PART: f32 = 0.06;

/// A driven body gives way when impulses leave a contact that would close by more than this within the
/// frame, in metres.
pub const WEDGED_M: f32 = OVERLAP_SLOP_M;

/// What a driven body that gives way with its coupling's mass resists turning with, in kg m2, where it becomes one
/// with what it holds: about as much as a stretched arm does about its shoulder. Its own turn is its tracker's; this is
/// how little it lets a held object turn.
pub const GIVING_INERTIA_KG_M2: f32 = 1.0;

/// How far a body turns in a stretch of time while its contacts count as where they were found, in radians.
pub const CONTACT_TURN_RAD: f32 = 0.25;

/// How far a loose body turns in a stretch of time at the most, in radians. Its way is the one between two poses,
/// which turns 1 % slower than the body at both ends when it is as long as this, 4 % when it is twice as long.
pub const TURN_RAD: f32 = 0.5;

/// The least share of a frame that is gone at once nevertheless: what turns faster is not to use up the events of
/// a frame.
pub const TURN_SHARE_MIN: f32 = 0.125;

const _: () = assert!(TURN_SHARE_MIN * EVENTS_MAX as f32 >= 4.0);

/// What is left of both after each event in a row that brought nobody forward: the shorter the way, the straighter.
pub const STALLED_TURN_PART: f32 = 0.2;

/// A pair that comes no farther through a frame than this share of it loses half of its relative motion.
pub const STALLED_SHARE: f32 = 0.125;

/// The least share of a stretch that is gone at once nevertheless: what turns faster is not to use up the
/// events of a frame.
pub const CONTACT_SHARE_MIN: f32 = 0.125;

/// Share by which the pressure on a held object is evened out in a frame.
pub const GRIP_EVENED: f32 = 0.25;

/// Most way that a coupling presses a held piece by, in metres: 30 N at the default stiffness.
pub const GRIP_M_MAX: f32 = 0.03;

/// A loose body slower than this (surface points included) is still, in m/s.
pub const STILL_SPEED: f32 = 0.01;

/// A loose body that has been still for this long sleeps, in seconds.
pub const SLEEP_S: f32 = 0.5;

/// Most share of a loose contact's overlap that is taken away in a frame.
pub const GAP_RESTORED: f32 = 0.2;

/// The share in a second, of short frames: how fast it goes does not depend on the frame rate.
pub const GAP_RESTORED_PER_S: f32 = 15.0;

/// Most speed that taking overlap away may add, in m/s: overlap that the host made goes away gently.
pub const RESTORING_SPEED_MAX: f32 = 0.05;

const _: () = assert!(GAP_REST_M < LOOSE_REST_M && LOOSE_REST_M < LOOSE_MARGIN_M);

/// Most plans of one driven body's way through one frame; those that gain nothing add no leg.
pub const ROUNDS_MAX: u32 = 2 * LEGS_MAX as u32;

/// Most places where a driven body is tried that gets out of overlap which the host made. Each but the last
/// was among pieces that it was not near before.
pub const WAY_OUT_ROUNDS_MAX: u32 = 3;

/// Most translations that a question about two bodies tries. Each but the last was found to bring in
/// pairs of pieces that were not in the way before.
pub const QUERY_ROUNDS_MAX: u32 = 8;

/// The farthest a vertex may be from its piece's origin, in metres.
pub const PIECE_REACH_M: f32 = 1e4;

/// Most edges of a reach cone: Wilhelms and Van Gelder 2001 use 6 to 12 for a shoulder.
pub const REACH_CONE_EDGES_MAX: usize = 12;

/// Most hinges of one chain: two ball joints, an elbow and a wrist of two are nine.
pub const CHAIN_HINGES_MAX: usize = 16;

/// Most chains of one body.
pub const CHAINS_PER_BODY_MAX: usize = 32;

/// Most steps of a chain's solver on one leg, for each of three looks at its contacts. The chains of the
/// lab's scenes need one to four.
pub const REACH_STEPS_PER_LEG_MAX: u32 = 8;

/// Most goals of one chain: its tip's place, and the points of its contacts.
pub const CHAIN_GOALS_MAX: usize = 16;
