//! Stepping from one certified time to the next: never too far, and hardly ever too short. Judged by
//! the true motion in f64, sampled finely, with a gap that is found by brute force.

#[path = "common/gap.rs"]
mod gap;
#[path = "common/shapes.rs"]
mod shapes;

use gap::{Body, Place, plane_gap};
use glam::{DQuat, DVec3, Vec3};
use palpable::geometry::motion::{Motion, Track};
use palpable::geometry::time_of_contact::MovingPair;
use palpable::geometry::warm::WarmFeature;
use palpable::limits::{GAP_FLOOR_M, LOOSE_ACCURACY, LOOSE_STEP_MIN_M, OVERLAP_SLOP_M, STEP_MIN_M};
use palpable::math::{Pose, quat_from_rotation_vector};
use shapes::{Hull, Random, blob, cuboid};

/// Most steps to a stop. Where a pair only grazes, with m left between the floor and the least gap, the
/// stretch about that time takes some pi W / sqrt(2 m c) steps, W being the bound on the speed and c the
/// curvature of the gap: hundreds when m is a few micrometres. 6000 random pairs needed 1603 at most; of
/// those that look nearby too, 2000 needed 81.
const STEPS_MAX: usize = 2048;

/// How a piece moves: the f32 input that the kernel and the reference both start from.
#[derive(Clone, Copy, Debug)]
struct Way {
    root: Track,
    local: Track,
}

impl Way {
    fn still(pose: Pose) -> Self {
        Self::rigid(pose, pose)
    }

    fn rigid(from: Pose, to: Pose) -> Self {
        Self {
            root: Track::between(from, to),
            local: Track::still(Pose::IDENTITY),
        }
    }

    fn motion(&self, hull: &Hull) -> Motion<'_> {
        Motion::new(self.root, self.local, hull.view().core_reach())
    }

    /// The true place at a time: the definition of the motion, in f64.
    fn at(&self, time: f64) -> Place {
        let (root, local) = (track_at(&self.root, time), track_at(&self.local, time));
        Place {
            turn: root.turn * local.turn,
            at: root.at + root.turn * local.at,
        }
    }

    /// The farthest that the frames get from their origins, one on top of the other.
    fn reach(&self) -> f64 {
        let far = |pose: &Pose| pose.translation().as_dvec3().length();
        let of = |track: &Track| far(&track.from).max(far(&track.to));
        of(&self.root) + of(&self.local)
    }
}

fn track_at(track: &Track, time: f64) -> Place {
    let (start, end) = (f64::from(track.start), f64::from(track.end));
    let share = start + (end - start) * time;
    let (from, mut to) = (track.from.quat().as_dquat(), track.to.quat().as_dquat());
    if from.dot(to) < 0.0 {
        to = -to;
    }
    let (p, q) = (
        track.from.translation().as_dvec3(),
        track.to.translation().as_dvec3(),
    );
    Place {
        turn: DQuat::from_vec4((from * (1.0 - share) + to * share).into()).normalize(),
        at: p + (q - p) * share,
    }
}

/// Two pieces on their ways.
struct Meeting {
    a: Hull,
    b: Hull,
    way_a: Way,
    way_b: Way,
}

/// What stepping did.
#[derive(Clone, Copy, Debug)]
struct Stop {
    time: f32,
    steps: usize,
}

impl Meeting {
    fn pair(&self) -> MovingPair<'_> {
        MovingPair {
            a: self.a.view(),
            b: self.b.view(),
            motion_a: self.way_a.motion(&self.a),
            motion_b: self.way_b.motion(&self.b),
        }
    }

    /// Steps as the stages do: from one certified time to the next, until the end or until a step
    /// moves nothing by as much as `step_min_m`. What gives nothing of the gap away looks nearby too, as
    /// driven bodies do.
    fn step(&self, floor_m: f32, step_min_m: f32, accuracy: f32) -> Stop {
        let pair = self.pair();
        let way = pair.motion_a.way_m() + pair.motion_b.way_m();
        let (mut time, mut feature) = (0.0_f32, WarmFeature::new());
        for steps in 1..=STEPS_MAX {
            let mut found = pair.clear_until(time, floor_m, &mut feature, accuracy);
            if accuracy == 0.0 {
                found.clear_until = pair.clear_nearby(time, floor_m, &found);
            }
            let next = found.clear_until.max(time);
            let short = (next - time) * way < step_min_m;
            time = next;
            if time >= 1.0 || short {
                return Stop { time, steps };
            }
        }
        panic!("no end after {STEPS_MAX} steps at {time}");
    }

    fn bodies(&self, time: f64) -> (Body<'_>, Body<'_>) {
        (
            Body::new(&self.a, &self.way_a.at(time)),
            Body::new(&self.b, &self.way_b.at(time)),
        )
    }

    fn gap(&self, time: f64) -> f64 {
        let (a, b) = self.bodies(time);
        gap::gap(&a, &b).gap_m
    }

    /// How far the gap falls below `floor_m` at any of the sampled times up to `until`: 1000 of them
    /// evenly, 100 over the last hundredth. Zero when it does not.
    ///
    /// The planes of one sample prove most of the following ones clear without a search.
    fn undercut(&self, until: f64, floor_m: f64) -> f64 {
        let mut normal = DVec3::ZERO;
        let mut most = 0.0_f64;
        let even = (0..=1000).map(|k| f64::from(k) / 1000.0);
        for share in even.chain((0..100).map(|k| 0.99 + f64::from(k) * 1e-4)) {
            let (a, b) = self.bodies(until * share);
            if normal != DVec3::ZERO && plane_gap(&a, &b, normal) >= floor_m {
                continue;
            }
            let found = gap::gap(&a, &b);
            normal = found.normal;
            most = most.max(floor_m - found.gap_m);
        }
        most
    }

    /// What the kernel may lose by f32. A rounding is 6e-8 of a coordinate; a point passes through two
    /// rotations (products and sums of a rounded quaternion), two translations and the supports' sums,
    /// and the time itself is rounded, by the way's part of it: some 30 roundings, which mostly cancel.
    /// Less than one was seen of it all, three are allowed.
    fn rounding(&self) -> f64 {
        let pair = self.pair();
        let way = pair.motion_a.way_m() + pair.motion_b.way_m();
        let pieces = self.a.view().size() + self.b.view().size();
        let places = self.way_a.reach() + self.way_b.reach();
        2e-7 * (f64::from(way + pieces) + places)
    }
}

fn turned(axis_angle: DVec3, at: DVec3) -> Pose {
    Pose::new(
        quat_from_rotation_vector(axis_angle.as_vec3()),
        at.as_vec3(),
    )
}

fn capsule(random: &mut Random, size: f32) -> Hull {
    let half = random.unit().as_vec3() * size * random.between(0.2, 1.0) as f32;
    Hull::new(&[-half, half], size * random.between(0.05, 0.3) as f32)
}

fn piece(random: &mut Random, size: f32) -> Hull {
    let mut part = || random.between(0.15, 1.0) as f32 * size;
    let half = Vec3::new(part(), part(), part());
    let rounding = [0.0, 0.1 * size][random.bits() as usize % 2];
    match random.bits() % 5 {
        0 => Hull::new(&[half], size * 0.5),
        1 => capsule(random, size),
        2 => cuboid(half),
        kind => {
            let mut hull = match kind {
                3 => cuboid(half),
                _ => {
                    let count = 6 + random.bits() as usize % 8;
                    blob(random, count, half)
                }
            };
            hull.radius = rounding;
            hull
        }
    }
}

/// The largest turn: a hair less than half a one, where the shorter arc is still the one meant.
const TURN_MAX: f64 = 3.13;

/// A pair of pieces of some size within a frame: A comes from anywhere and passes near B, both turn by
/// up to half a turn, and in some both move within bodies that move.
fn meeting(random: &mut Random, size: f32) -> Meeting {
    let (a, b) = (piece(random, size), piece(random, size));
    let scale = f64::from(size);
    let spin = |random: &mut Random| random.unit() * random.between(0.0, TURN_MAX);
    let near = |random: &mut Random| random.unit() * random.between(0.0, scale);
    let turns = random.bits() % 3;
    let still = |random: &mut Random| turned(spin(random), near(random));
    let local = |random: &mut Random| {
        let from = still(random);
        let to = turned(spin(random) * 0.5, near(random));
        [Track::still(from), Track::between(from, to)][random.bits() as usize % 2]
    };
    let from = random.unit() * random.between(1.0, 6.0) * scale;
    let to = near(random) - from * random.between(-0.5, 1.0);
    let start = turned(spin(random), from);
    let end = Pose::new(start.quat(), to.as_vec3());
    let mut way_a = Way::rigid(start, end);
    let mut way_b = Way::still(still(random));
    if turns > 0 {
        let turn = quat_from_rotation_vector(spin(random).as_vec3());
        way_a.root.to = Pose::new((turn * start.quat()).normalize(), to.as_vec3());
    }
    if turns > 1 {
        way_b.root.to = still(random);
        way_a.local = local(random);
        way_b.local = local(random);
    }
    Meeting { a, b, way_a, way_b }
}

/// Pairs that begin at least twice the floor apart, as many as asked for.
fn meetings(seed: u64, count: usize) -> impl Iterator<Item = Meeting> {
    let mut random = Random(seed);
    let sizes = [0.02, 0.1, 1.0];
    (0..)
        .map(move |round| meeting(&mut random, sizes[round % 3]))
        .filter(|pair| pair.gap(0.0) > 2.0 * f64::from(GAP_FLOOR_M))
        .take(count)
}

/// Prints how many steps were taken; a median and a 99th percentile to hold.
fn judge_steps(what: &str, steps: &mut [usize], median: usize, hundredth: usize) {
    steps.sort_unstable();
    let part = |share: f64| steps[((steps.len() - 1) as f64 * share) as usize];
    let found = [0.5, 0.9, 0.99, 1.0].map(part);
    let count = steps.len();
    println!("{what}: {count} pairs, steps (median, 90 %, 99 %, most) {found:?}");
    assert!(found[0] <= median && found[2] <= hundredth, "{found:?}");
}

/// Never late by more than rounding. A stop means that the last step was shorter than STEP_MIN_M even at
/// the largest speed, so the certified gap is within that of the floor.
#[test]
fn random_pairs_stop_in_time_and_where_they_touch() {
    let (floor, step) = (f64::from(GAP_FLOOR_M), f64::from(STEP_MIN_M));
    let mut steps = vec![];
    let (mut stopped, mut latest, mut earliest) = (0, 0.0_f64, 0.0_f64);
    for meeting in meetings(41, 2000) {
        let stop = meeting.step(GAP_FLOOR_M, STEP_MIN_M, 0.0);
        steps.push(stop.steps);
        let rounding = meeting.rounding();
        let late = meeting.undercut(f64::from(stop.time), floor);
        assert!(
            late <= rounding,
            "{late} m late, {rounding} allowed: {stop:?}"
        );
        latest = latest.max(late);
        if stop.time < 1.0 {
            stopped += 1;
            let early = meeting.gap(f64::from(stop.time)) - floor;
            assert!(early <= step + rounding, "{early} m early: {stop:?}");
            assert!(early <= f64::from(OVERLAP_SLOP_M));
            earliest = earliest.max(early);
        }
    }
    println!("{stopped} stopped; late {latest:.1e} m, early {earliest:.1e} m at most");
    assert!((500..1900).contains(&stopped), "{stopped}");
    judge_steps("to the stop", &mut steps, 8, 40);
}

/// Pairs that begin overlapping, or closer than the floor, get no deeper within one certified step.
#[test]
fn what_overlaps_gets_no_deeper() {
    let mut random = Random(43);
    let (mut overlapping, mut parting) = (0, 0);
    for round in 0..4000 {
        let mut meeting = meeting(&mut random, [0.02, 0.1, 1.0][round % 3]);
        let from = meeting.way_a.root.from;
        meeting.way_a.root.from = from.moved(-0.8 * from.translation());
        let gap = meeting.gap(0.0);
        if gap > f64::from(GAP_FLOOR_M) {
            continue;
        }
        overlapping += 1;
        let found = meeting
            .pair()
            .clear_until(0.0, GAP_FLOOR_M, &mut WarmFeature::new(), 0.0);
        let nearby = meeting.pair().clear_nearby(0.0, GAP_FLOOR_M, &found);
        assert!(nearby == found.clear_until);
        parting += usize::from(found.clear_until > 0.0);
        let (rounding, until) = (meeting.rounding(), f64::from(found.clear_until));
        assert!(
            (f64::from(found.gap_m) - gap).abs() <= rounding,
            "{found:?} not {gap}"
        );
        let deeper = meeting.undercut(until, gap);
        assert!(deeper <= rounding, "{deeper} deeper than {gap}: {found:?}");
    }
    println!("{overlapping} overlapping, {parting} of them certified to part");
    assert!(overlapping > 500 && parting > 50);
}

/// Certificates that give away a share of the gap, as loose bodies use them: the least gap at a stop is
/// then the floor's over what is kept of it.
fn judge_loose(rounded: bool) {
    let (floor, step) = (f64::from(GAP_FLOOR_M), f64::from(LOOSE_STEP_MIN_M));
    let (mut steps, mut worst) = (vec![], 0.0_f64);
    let is_rounded = |pair: &Meeting| pair.a.radius + pair.b.radius > 0.0;
    for meeting in meetings(42, 4000).filter(|pair| is_rounded(pair) == rounded) {
        let stop = meeting.step(GAP_FLOOR_M, LOOSE_STEP_MIN_M, LOOSE_ACCURACY);
        steps.push(stop.steps);
        let (rounding, time) = (meeting.rounding(), f64::from(stop.time));
        assert!(meeting.undercut(time, floor) <= rounding);
        if stop.time < 1.0 {
            let least = (floor + step) / (1.0 - f64::from(LOOSE_ACCURACY));
            worst = worst.max(meeting.gap(time) - least - rounding);
        }
    }
    judge_steps("loose", &mut steps, 10, 128);
    assert!(worst <= 0.0, "{worst} m too early");
}

#[test]
fn coarse_certificates_stop_where_solids_touch() {
    judge_loose(false);
}

/// The share once was taken of the cores' distance, radii included, not of the gap, so that rounded
/// pieces stopped up to a share of their radii too early: centimetres for a ball of half a metre.
#[test]
fn coarse_certificates_stop_where_rounded_pieces_touch() {
    judge_loose(true);
}

/// A piece that is carried along frame by frame: the frame in which it stops, and where in it.
fn first_stop(frames: i32, frame_of: impl Fn(i32) -> Meeting, floor_m: f32) -> (i32, Stop, f64) {
    for frame in 0..frames {
        let meeting = frame_of(frame);
        let stop = meeting.step(floor_m, STEP_MIN_M, 0.0);
        if stop.time < 1.0 {
            let gap = meeting.gap(f64::from(stop.time));
            return (frame, stop, gap);
        }
    }
    panic!("nothing stopped it");
}

/// A 20 mm cube at 10 m/s toward a 1 mm plate 100 mm away: they touch after 10 ms.
#[test]
fn a_cube_reaches_a_thin_plate_after_ten_milliseconds() {
    for dt_s in [1.0 / 60.0, 1.0 / 1000.0] {
        let cube_at = |frame: i32| Pose::at(10.0 * dt_s * frame as f32, 0.0, 0.0);
        let frame_of = |frame| Meeting {
            a: cuboid(Vec3::splat(0.01)),
            b: cuboid(Vec3::new(0.0005, 1.0, 1.0)),
            way_a: Way::rigid(cube_at(frame), cube_at(frame + 1)),
            way_b: Way::still(Pose::at(0.1105, 0.0, 0.0)),
        };
        let (frame, stop, gap) = first_stop(20, frame_of, GAP_FLOOR_M);
        assert!(gap > 0.0 && gap <= f64::from(OVERLAP_SLOP_M), "{gap}");
        let early_s = 0.01 - (f64::from(frame) + f64::from(stop.time)) * f64::from(dt_s);
        // The 0.1 mm of the promise, at 10 m/s.
        assert!((0.0..=1e-5).contains(&early_s), "{early_s} {dt_s}");
        assert!(stop.steps <= 3, "{stop:?}");
    }
}

/// The share of a normalised linear interpolation about one axis, by the angle `whole`, at which it has
/// turned by `angle`: with f half of `whole`, tan(angle / 2) = s sin f / (1 - s + s cos f).
fn share_at(angle: f64, whole: f64) -> f64 {
    let (tangent, f) = ((0.5 * angle).tan(), 0.5 * whole);
    tangent / (f.sin() + tangent * (1.0 - f.cos()))
}

/// A rod of 1 m, its pivot 0.0998334 m = sin 0.1 above a plane, turning down at 30 rad/s: the tip
/// touches after 0.1 / 30 s. Within a frame of 1/60 s the interpolation is not even; its own time counts.
#[test]
fn a_turning_rod_reaches_a_plane_with_its_tip() {
    for (dt_s, radius) in [(1.0 / 60.0, 0.0), (1e-3, 0.0), (1e-3, 0.01)] {
        let pivot = DVec3::Y * (0.1_f64.sin() + radius);
        let whole = 30.0 * dt_s;
        let rod_at = |frame: i32| turned(DVec3::NEG_Z * whole * f64::from(frame), pivot);
        let frame_of = |frame| Meeting {
            a: Hull::new(&[Vec3::ZERO, Vec3::X], radius as f32),
            b: cuboid(Vec3::new(2.0, 0.5, 1.0)),
            way_a: Way::rigid(rod_at(frame), rod_at(frame + 1)),
            way_b: Way::still(Pose::at(0.0, -0.5, 0.0)),
        };
        let (frame, stop, gap) = first_stop(10, frame_of, GAP_FLOOR_M);
        assert!(gap > 0.0 && gap <= f64::from(OVERLAP_SLOP_M), "{gap}");
        let share = share_at(0.1 - f64::from(frame) * whole, whole);
        let early_s = (share - f64::from(stop.time)) * dt_s;
        // The 0.1 mm of the promise, at 30 m/s.
        let within = 0.0..=1e-4 / 30.0;
        assert!(within.contains(&early_s), "{early_s} {stop:?}");
        if dt_s == 1e-3 {
            let contact_s = (f64::from(frame) + f64::from(stop.time)) * dt_s;
            assert!(within.contains(&(0.1 / 30.0 - contact_s)), "{contact_s}");
        }
        assert!(stop.steps <= 8, "{stop:?}");
    }
}

/// A forearm that turns by a radian a few micrometres above the floor of a wall: judged over the whole
/// way alone, it crept by as much as its slack in each of 100 000 steps.
#[test]
fn a_rod_turns_along_a_wall_in_few_steps() {
    for slack_m in [1e-6_f32, 4e-6, 4e-5] {
        let radius = 0.04;
        let pose = |angle: f64| {
            let above = f64::from(radius + GAP_FLOOR_M + slack_m);
            turned(DVec3::Z * angle, DVec3::Z * above)
        };
        let meeting = Meeting {
            a: Hull::new(&[Vec3::ZERO, Vec3::X * 0.36], radius),
            b: cuboid(Vec3::new(2.0, 2.0, 0.5)),
            way_a: Way::rigid(pose(0.0), pose(1.0)),
            way_b: Way::still(Pose::at(0.0, 0.0, -0.5)),
        };
        let stop = meeting.step(GAP_FLOOR_M, STEP_MIN_M, 0.0);
        let most = 3.0 * (0.36 / slack_m).sqrt();
        assert!(stop.time >= 1.0 && stop.steps as f32 <= most, "{stop:?}");
        let late = meeting.undercut(1.0, f64::from(GAP_FLOOR_M));
        assert!(late <= meeting.rounding(), "{late}");
    }
}

/// A teleport of 10 m through three walls ends at the first of them.
#[test]
fn a_teleport_stops_at_the_first_wall() {
    let times = [3.0, 5.0, 7.0].map(|wall| {
        let meeting = Meeting {
            a: blob(&mut Random(44), 12, Vec3::splat(0.1)),
            b: cuboid(Vec3::new(0.001, 2.0, 2.0)),
            way_a: Way::rigid(Pose::IDENTITY, Pose::at(10.0, 0.0, 0.0)),
            way_b: Way::still(Pose::at(wall, 0.0, 0.0)),
        };
        let stop = meeting.step(GAP_FLOOR_M, STEP_MIN_M, 0.0);
        let gap = meeting.gap(f64::from(stop.time));
        assert!(gap > 0.0 && gap <= f64::from(OVERLAP_SLOP_M), "{gap}");
        assert!(stop.steps <= 3, "{stop:?}");
        stop.time
    });
    assert!(times[0] < times[1] && times[1] < times[2], "{times:?}");
}

/// A full turn within one frame is none: the ends' quaternions differ by their sign, and the shorter
/// arc between them is no motion. One certificate covers the frame.
#[test]
fn a_full_turn_is_no_motion() {
    let from = turned(DVec3::new(0.3, -0.2, 0.5), DVec3::new(0.0, 0.12, 0.0));
    let meeting = Meeting {
        a: cuboid(Vec3::new(0.05, 0.01, 0.09)),
        b: cuboid(Vec3::new(1.0, 0.01, 1.0)),
        way_a: Way::rigid(from, Pose::new(-from.quat(), from.translation())),
        way_b: Way::still(Pose::IDENTITY),
    };
    let stop = meeting.step(GAP_FLOOR_M, STEP_MIN_M, 0.0);
    assert_eq!((stop.time, stop.steps), (1.0, 1));
}
