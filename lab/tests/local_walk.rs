//! The paper's local walk: it ends on a face of the Minkowski difference, and never below the depth.

use glam::{DQuat, DVec3};
use palpable_lab::accuracy::generate::{Class, pair, solids};
use palpable_lab::accuracy::local_walk::{Found, HUBS_MAX, Mesh, Pair, Start, walk};
use palpable_lab::accuracy::measure;
use palpable_lab::accuracy::methods::{Method, exact};
use palpable_lab::reference::{Placed, Signed, Solid, signed_distance};

const SEED: u64 = 7;
const PAIRS: u32 = 60;

/// Rounding, relative to size.
const ERROR_MAX: f64 = 1e-6;

/// A pair that overlaps, as the reference and as the walk take it.
struct Overlapping {
    class: Class,
    index: u32,
    solids: [Solid; 2],
    poses: [(DQuat, DVec3); 2],
    truth: Signed,
}

impl Overlapping {
    fn size_m(&self) -> f64 {
        self.solids[0].size().min(self.solids[1].size())
    }

    fn walk(&self, start: impl Fn(&Pair) -> Start) -> Found {
        let meshes = self
            .solids
            .each_ref()
            .map(|solid| Mesh::new(solid).unwrap());
        let pair = Pair::new(&meshes, &self.poses);
        walk(&pair, &start(&pair))
    }

    /// How much deeper the walk's overlap is than the depth, relative to size.
    fn too_deep(&self, found: &Found) -> f64 {
        (found.overlap_m + self.truth.value) / self.size_m()
    }

    fn name(&self) -> String {
        format!("{:?} seed {SEED} index {}", self.class, self.index)
    }
}

fn measured(solids: &[Solid; 2], poses: &[(DQuat, DVec3); 2]) -> Signed {
    let [a, b] = [0, 1].map(|i| Placed::new(&solids[i], poses[i].0, poses[i].1));
    signed_distance(&a, &b)
}

fn overlapping() -> impl Iterator<Item = Overlapping> {
    let pairs = Class::ALL
        .into_iter()
        .flat_map(|class| (0..PAIRS).map(move |index| pair(class, SEED, index)));
    pairs.filter_map(|pair| {
        let solids = solids(&pair.shapes);
        let poses = pair.poses[0].each_ref().map(exact);
        let truth = measured(&solids, &poses);
        (truth.value < 0.0).then_some(Overlapping {
            class: pair.class,
            index: pair.index,
            solids,
            poses,
            truth,
        })
    })
}

fn boxes(half: [f64; 3], poses: [(DQuat, DVec3); 2]) -> Overlapping {
    let corner = |index: usize| {
        DVec3::from_array([0, 1, 2].map(|axis| {
            if index >> axis & 1 == 1 {
                half[axis]
            } else {
                -half[axis]
            }
        }))
    };
    let corners: Vec<DVec3> = (0..8).map(corner).collect();
    let solids = [0; 2].map(|_| Solid::new(&corners, 0.0).unwrap());
    let truth = measured(&solids, &poses);
    Overlapping {
        class: Class::Box8,
        index: 0,
        solids,
        poses,
        truth,
    }
}

#[test]
fn two_boxes_overlap_by_a_tenth() {
    let aside = (DQuat::IDENTITY, DVec3::new(1.9, 0.0, 0.0));
    let pair = boxes([1.0; 3], [aside, (DQuat::IDENTITY, DVec3::ZERO)]);
    let found = pair.walk(Start::between_centres);
    assert!((found.overlap_m - 0.1).abs() < 1e-12, "{found:?}");
    assert!(found.normal.distance(DVec3::X) < 1e-12, "{found:?}");
    assert_eq!(found, pair.walk(Start::between_centres));
}

/// Edges that cross: neither box has a face whose plane is the nearest one.
#[test]
fn crossed_boxes_overlap_along_no_face() {
    let eighth = std::f64::consts::FRAC_PI_4;
    let up = (
        DQuat::from_rotation_x(eighth),
        DVec3::new(0.0, 0.0, 2.0 * 2f64.sqrt() - 0.1),
    );
    let pair = boxes(
        [1.0; 3],
        [up, (DQuat::from_rotation_y(eighth), DVec3::ZERO)],
    );
    let found = pair.walk(Start::between_centres);
    assert!((found.overlap_m - 0.1).abs() < 1e-12, "{found:?}");
    assert!(found.normal.distance(DVec3::Z) < 1e-12, "{found:?}");
}

#[test]
fn the_reference_s_normal_is_not_left() {
    let mut count = 0;
    for pair in overlapping() {
        let found = pair.walk(|_| Start::along(pair.truth.normal));
        let off = pair.too_deep(&found).abs();
        assert!(off < ERROR_MAX, "{}: off by {off:e}", pair.name());
        count += 1;
    }
    assert!(count > 400, "{count} pairs overlap");
}

#[test]
fn the_walk_never_ends_below_the_depth() {
    let (mut count, mut local) = (0, 0);
    for pair in overlapping() {
        let found = pair.walk(Start::between_centres);
        let too_deep = pair.too_deep(&found);
        assert!(
            too_deep > -ERROR_MAX,
            "{}: off by {too_deep:e}",
            pair.name()
        );
        assert!(found.hubs_seen < HUBS_MAX, "{}: {found:?}", pair.name());
        count += 1;
        local += usize::from(too_deep > ERROR_MAX);
    }
    assert!(
        local > 0 && local < count / 2,
        "{local} of {count} are local minima only"
    );
}

/// What is found is the overlap along the normal: moving by it makes the pieces touch.
#[test]
fn moving_by_the_overlap_parts_the_pieces() {
    for pair in overlapping() {
        let found = pair.walk(Start::between_centres);
        let mut poses = pair.poses;
        poses[0].1 += found.normal * found.overlap_m;
        let left = measured(&pair.solids, &poses).value / pair.size_m();
        assert!(left.abs() < ERROR_MAX, "{}: {left:e} left", pair.name());
    }
}

#[test]
fn equal_pairs_give_equal_bits() {
    for pair in overlapping().step_by(5) {
        let first = pair.walk(Start::between_centres);
        assert_eq!(first, pair.walk(Start::between_centres), "{}", pair.name());
        let second = pair.walk(|_| Start::at(&first));
        assert!(second.overlap_m <= first.overlap_m * (1.0 + 1e-12));
    }
}

/// Pairs apart are no failures of a method that is for overlap; it is not asked about them.
#[test]
fn pairs_apart_are_not_asked_about() {
    for scores in measure::class(Class::Hull12, SEED, 24, false, || ()) {
        let is_walk = matches!(scores.method, Method::LocalWalk | Method::LocalWalkWarm);
        assert_eq!(scores.method.needs_overlap(), is_walk);
        let apart = scores.scores.iter().any(|score| score.reference_m >= 0.0);
        assert_eq!(apart, !is_walk, "{:?}", scores.method);
        assert!(scores.scores.iter().all(|score| score.error.is_some()));
    }
}
