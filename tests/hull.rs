//! Hulls against what must hold for every polytope, in double precision.

use glam::Vec3;
use palpable::geometry::convex::Edge;
use palpable::geometry::hull::{DEVIATION_MAX, HullBuilder, HullError, HullView};
use palpable::limits::PIECE_VERTICES_MAX;
use palpable::math::LANE_WIDTH;

type Point = [f32; 3];

/// PCG-like generator: one seed replays everything.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Uniform in [-1, 1).
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn point(&mut self) -> [f64; 3] {
        [self.next(), self.next(), self.next()]
    }

    fn index(&mut self, count: usize) -> usize {
        ((self.next() + 1.0) * 0.5 * count as f64) as usize
    }

    /// A rotation matrix.
    fn rotation(&mut self) -> [[f64; 3]; 3] {
        let a = unit(self.point());
        let b = self.point();
        let c = unit(cross(a, b));
        [a, cross(c, a), c]
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

fn wide(p: Point) -> [f64; 3] {
    p.map(f64::from)
}

fn narrow(p: [f64; 3]) -> Point {
    p.map(|x| x as f32)
}

/// Turned, scaled, moved and rounded to f32.
fn placed(points: &[[f64; 3]], turn: [[f64; 3]; 3], scale: f64, at: [f64; 3]) -> Vec<Point> {
    let place = |p: &[f64; 3]| {
        narrow([
            dot(turn[0], *p) * scale + at[0],
            dot(turn[1], *p) * scale + at[1],
            dot(turn[2], *p) * scale + at[2],
        ])
    };
    points.iter().map(place).collect()
}

fn size(points: &[Point]) -> f64 {
    let extent = |axis: usize| {
        let column = || points.iter().map(|p| f64::from(p[axis]));
        column().fold(f64::MIN, f64::max) - column().fold(f64::MAX, f64::min)
    };
    (0..3).map(|axis| extent(axis).powi(2)).sum::<f64>().sqrt()
}

fn vertex(hull: &HullView, index: u16) -> [f64; 3] {
    wide(hull.convex(0.0).vertex(index as usize).to_array())
}

fn vertices(hull: &HullView) -> Vec<[f64; 3]> {
    (0..hull.vertex_count)
        .map(|i| vertex(hull, i as u16))
        .collect()
}

fn counts(hull: &HullView) -> (usize, usize, usize) {
    (hull.vertex_count, hull.faces.len(), hull.edges.len())
}

fn check(hull: &HullView, points: &[Point]) {
    check_within(hull, points, 0.0);
}

/// `slack`: by how much, relative to the size, another vertex may reach beyond one.
fn check_within(hull: &HullView, points: &[Point], slack: f64) {
    check_polytope(hull, points);
    check_extreme(hull, slack * size(points));
}

fn check_polytope(hull: &HullView, points: &[Point]) {
    let size = size(points);
    check_vertices(hull, points);
    check_planes(hull, points, size);
    check_loops(hull, size);
    check_edges(hull);
    check_box(hull);
    let (v, f, e) = counts(hull);
    assert_eq!(v + f, e + 2, "Euler");
}

fn check_vertices(hull: &HullView, points: &[Point]) {
    let mut rest = points.iter();
    for v in vertices(hull) {
        assert!(
            rest.any(|p| wide(*p) == v),
            "vertices are inputs in input order"
        );
    }
    assert_eq!(hull.lanes.len(), hull.vertex_count.div_ceil(LANE_WIDTH));
    for pad in hull.vertex_count..hull.lanes.len() * LANE_WIDTH {
        assert_eq!(vertex(hull, pad as u16), vertex(hull, 0));
    }
}

fn check_planes(hull: &HullView, points: &[Point], size: f64) {
    for face in hull.faces {
        let normal = wide(face.normal.to_array());
        let offset = f64::from(face.offset);
        assert!((dot(normal, normal) - 1.0).abs() < 3e-7);
        let reach = vertices(hull)
            .iter()
            .map(|v| dot(normal, *v))
            .fold(f64::MIN, f64::max);
        assert!(reach <= offset, "vertex outside by {}", reach - offset);
        assert!(offset - reach <= 1.2e-7 * offset.abs() + 1e-40);
        for p in points {
            let out = dot(normal, wide(*p)) - offset;
            assert!(
                out <= DEVIATION_MAX * size,
                "point outside by {}",
                out / size
            );
        }
    }
}

fn check_loops(hull: &HullView, size: f64) {
    let mut total = 0;
    for face in hull.faces {
        let corners = hull.convex(0.0).face_loop(face).to_vec();
        assert_eq!(face.first_loop as usize, total);
        assert!(corners.len() >= 3);
        assert_eq!(corners[0], *corners.iter().min().unwrap());
        total += corners.len();
        let normal = wide(face.normal.to_array());
        let reach = vertices(hull)
            .iter()
            .map(|v| dot(normal, *v))
            .fold(f64::MIN, f64::max);
        for i in 0..corners.len() {
            let at = |k: usize| vertex(hull, corners[(i + k) % corners.len()]);
            assert!(dot(cross(sub(at(1), at(0)), sub(at(2), at(1))), normal) > 0.0);
            let below = reach - dot(normal, at(0));
            assert!(
                below <= DEVIATION_MAX * size,
                "corner below its face by {}",
                below / size
            );
        }
    }
    assert_eq!(total, hull.loops.len());
}

fn check_edges(hull: &HullView) {
    let mut borders = std::collections::BTreeMap::new();
    for (index, face) in hull.faces.iter().enumerate() {
        let corners = hull.convex(0.0).face_loop(face).to_vec();
        for i in 0..corners.len() {
            let next = corners[(i + 1) % corners.len()];
            let known = borders.insert([corners[i], next], index as u16);
            assert_eq!(known, None, "a half edge twice");
        }
    }
    assert_eq!(borders.len(), 2 * hull.edges.len());
    let mut pairs = std::collections::BTreeSet::new();
    for Edge {
        vertices: [a, b],
        faces: [f, g],
    } in hull.edges
    {
        assert_eq!(borders[&[*a, *b]], *f);
        assert_eq!(borders[&[*b, *a]], *g);
        assert!(f != g);
        assert!(
            pairs.insert([*f.min(g), *f.max(g)]),
            "two faces share two edges"
        );
    }
}

/// Every vertex is the farthest one along the mean normal of its faces; strictly, without slack.
fn check_extreme(hull: &HullView, slack: f64) {
    let all = vertices(hull);
    for (index, v) in all.iter().enumerate() {
        let mut mean = [0.0; 3];
        for face in hull.faces {
            if hull.convex(0.0).face_loop(face).contains(&(index as u16)) {
                let n = wide(face.normal.to_array());
                mean = [mean[0] + n[0], mean[1] + n[1], mean[2] + n[2]];
            }
        }
        let beaten = |(i, w): (usize, &[f64; 3])| {
            i == index || dot(mean, sub(*w, *v)) < slack * dot(mean, mean).sqrt()
        };
        assert!(
            all.iter().enumerate().all(beaten),
            "vertex {index} is not extreme"
        );
    }
}

fn check_box(hull: &HullView) {
    let centre = wide(hull.centre.to_array());
    let half = wide(hull.half_extents.to_array());
    for axis in 0..3 {
        let out = |v: &[f64; 3]| (v[axis] - centre[axis]).abs();
        let reach = vertices(hull).iter().map(out).fold(0.0, f64::max);
        assert!(reach <= half[axis]);
        assert!(half[axis] - reach <= 1.2e-7 * half[axis]);
    }
}

fn build_and_check(points: &[Point]) -> (usize, usize, usize) {
    let mut builder = HullBuilder::new();
    let hull = builder.build(points).unwrap();
    check(&hull, points);
    counts(&hull)
}

/// For points as close together as the tolerance, where flat faces hide what is a corner.
fn build_and_check_fine(points: &[Point]) {
    let mut builder = HullBuilder::new();
    let hull = builder.build(points).unwrap();
    check_within(&hull, points, DEVIATION_MAX);
}

/// Corners of a box, with `steps` points along every edge, all of them or the surface only.
fn box_grid(half: [f64; 3], steps: usize) -> Vec<[f64; 3]> {
    let at = |i: usize, axis: usize| half[axis] * (2.0 * i as f64 / (steps - 1) as f64 - 1.0);
    let mut points = Vec::new();
    for i in 0..steps.pow(3) {
        let [x, y, z] = [i % steps, i / steps % steps, i / steps / steps];
        if [x, y, z].iter().any(|&k| k == 0 || k == steps - 1) {
            points.push([at(x, 0), at(y, 1), at(z, 2)]);
        }
    }
    points
}

/// 482 points and 960 triangles: two poles and 16 rings of 30.
fn ball() -> Vec<[f64; 3]> {
    let mut points = vec![[0.0, 0.0, 1.0]];
    for ring in 1..=16 {
        let polar = std::f64::consts::PI * f64::from(ring) / 17.0;
        for step in 0..30 {
            let twist = if ring % 2 == 0 { 0.5 } else { 0.0 };
            let azimuth = std::f64::consts::TAU * (f64::from(step) + twist) / 30.0;
            points.push([
                polar.sin() * azimuth.cos(),
                polar.sin() * azimuth.sin(),
                polar.cos(),
            ]);
        }
    }
    points.push([0.0, 0.0, -1.0]);
    points
}

const PLACES: [(f64, [f64; 3]); 6] = [
    (1e-3, [0.0; 3]),
    (1.0, [0.0; 3]),
    (100.0, [0.0; 3]),
    (1.0, [1000.0, -700.0, 400.0]),
    (1e-3, [0.1, 0.2, -0.3]),
    (100.0, [-1000.0, 0.0, 1000.0]),
];

#[test]
fn unit_cube_has_8_vertices_6_faces_12_edges() {
    let upright = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for steps in [2, 3, 4, 9] {
        let points = placed(&box_grid([0.5; 3], steps), upright, 1.0, [0.0; 3]);
        let mut builder = HullBuilder::new();
        let hull = builder.build(&points).unwrap();
        check(&hull, &points);
        assert_eq!(counts(&hull), (8, 6, 12));
        for face in hull.faces {
            assert_eq!(face.normal.abs().element_sum(), 1.0);
            assert_eq!(face.offset, 0.5);
        }
        assert_eq!(
            (hull.centre, hull.half_extents),
            (Vec3::ZERO, Vec3::splat(0.5))
        );
    }
}

#[test]
fn turned_boxes_are_boxes_however_finely_their_surface_is_sampled() {
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let steps = 2 + seed as usize % 8;
        let half = [1.0, 0.3 + 0.2 * random.next(), 0.02 + 0.01 * random.next()];
        let turn = random.rotation();
        for scale in [1e-3, 1.0, 100.0] {
            let points = placed(&box_grid(half, steps), turn, scale, [0.0; 3]);
            assert_eq!(build_and_check(&points), (8, 6, 12), "seed {seed}");
        }
    }
}

#[test]
fn turned_boxes_far_from_the_origin_are_valid() {
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let points = box_grid([1.0, 0.5, 0.2], 2 + seed as usize % 8);
        let turn = random.rotation();
        for (scale, at) in PLACES {
            build_and_check(&placed(&points, turn, scale, at));
        }
    }
}

#[test]
fn the_ball_of_the_paper_has_960_faces() {
    let points = ball();
    assert_eq!(points.len(), 482);
    for (seed, (scale, at)) in PLACES[..3].iter().enumerate() {
        let turn = Random::new(seed as u64).rotation();
        let found = build_and_check(&placed(&points, turn, *scale, *at));
        assert_eq!(found, (482, 960, 1440));
    }
}

#[test]
fn random_points_in_a_cube() {
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let count = 4 + random.index(if seed % 10 == 0 { 500 } else { 60 });
        let points: Vec<_> = (0..count).map(|_| random.point()).collect();
        let turn = random.rotation();
        for (scale, at) in PLACES {
            build_and_check(&placed(&points, turn, scale, at));
        }
    }
}

#[test]
fn random_points_on_a_sphere_are_all_vertices() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let count = 8 + random.index(504);
        let points: Vec<_> = (0..count).map(|_| unit(random.point())).collect();
        let points = placed(&points, random.rotation(), 0.01, [0.0; 3]);
        let (found, ..) = build_and_check(&points);
        assert!(found + 2 >= count, "{found} of {count}");
    }
}

#[test]
fn points_on_a_coarse_lattice_with_duplicates() {
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let side = 2 + seed % 4;
        let lattice = |x: f64| ((x + 1.0) * 0.5 * side as f64) as i32 as f32;
        let mut points: Vec<Point> = (0..40).map(|_| narrow(random.point())).collect();
        for p in &mut points {
            *p = p.map(|x| lattice(f64::from(x)));
        }
        points.extend_from_within(..20);
        build_and_check(&points);
    }
}

#[test]
fn turned_lattices_with_rounding() {
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let side = 2.0 + (seed % 5) as f64;
        let mut points: Vec<_> = (0..200).map(|_| random.point()).collect();
        for p in &mut points {
            *p = p.map(|x| (x * side).round() / side);
        }
        let turn = random.rotation();
        for (scale, at) in PLACES {
            build_and_check(&placed(&points, turn, scale, at));
        }
    }
}

#[test]
fn slivers_needles_and_prisms() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let shapes = [[1.0, 1.0, 1e-3], [1.0, 1e-3, 1e-3], [1.0, 0.03, 1e-3]];
        for shape in shapes {
            let stretch = |p: [f64; 3]| [p[0] * shape[0], p[1] * shape[1], p[2] * shape[2]];
            let points: Vec<_> = (0..60).map(|_| stretch(random.point())).collect();
            let turn = random.rotation();
            for (scale, at) in &PLACES[..3] {
                build_and_check(&placed(&points, turn, *scale, *at));
            }
        }
    }
}

#[test]
fn a_prism_of_256_sides_has_two_faces_of_256_corners() {
    let ring = (0..256).map(|i| std::f64::consts::TAU * f64::from(i) / 256.0);
    let points: Vec<_> = ring
        .flat_map(|a| [[a.cos(), a.sin(), -0.2], [a.cos(), a.sin(), 0.2]])
        .collect();
    let points = placed(&points, Random::new(1).rotation(), 1.0, [0.0; 3]);
    assert_eq!(build_and_check(&points), (512, 258, 768));
}

#[test]
fn finely_sampled_blunt_tips_are_simplified_within_the_deviation() {
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let width = 10f64.powf(-2.5 + random.next());
        let mut points = box_grid([1.0, 1.0, 0.5], 2);
        for _ in 0..300 {
            let [x, y, _] = random.point().map(|x| x * width);
            points.push([x, y, 0.7 - 0.5 * (x * x + y * y)]);
        }
        let turn = random.rotation();
        for (scale, at) in &PLACES[..3] {
            build_and_check_fine(&placed(&points, turn, *scale, *at));
        }
    }
}

#[test]
fn clusters_of_nearly_equal_points() {
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let spread = 10f64.powf(-5.5 + 2.0 * random.next());
        let corners: Vec<_> = (0..12).map(|_| random.point()).collect();
        let near = |c: &[f64; 3], d: [f64; 3]| [0, 1, 2].map(|i| c[i] + spread * d[i]);
        let points: Vec<_> = (0..300)
            .map(|i| near(&corners[i % 12], random.point()))
            .collect();
        build_and_check_fine(&placed(&points, random.rotation(), 1.0, [0.0; 3]));
    }
}

/// A point on a line or in a plane of earlier ones, but for noise from nothing to more than the
/// tolerances.
fn nearly_between(points: &[[f64; 3]], random: &mut Random) -> [f64; 3] {
    let [p, q, r] = [(); 3].map(|()| points[random.index(points.len())]);
    let (t, u) = (random.next(), random.next());
    let u = if random.index(2) == 0 { 0.0 } else { u };
    let noise = 10f64.powf(-8.5 + 4.5 * random.next());
    [0, 1, 2].map(|i| p[i] + t * (q[i] - p[i]) + u * (r[i] - p[i]) + noise * random.next())
}

#[test]
fn points_on_edges_and_faces_of_blades() {
    let mut made = 0;
    for seed in 140_000..160_000 {
        let mut random = Random::new(seed);
        let stretch = [(); 3].map(|()| 10f64.powi(-(random.index(7) as i32)));
        let mut points: Vec<[f64; 3]> = Vec::new();
        for index in 0..5 + random.index(12) {
            let p = random.point();
            points.push(if index > 3 && random.index(3) > 0 {
                nearly_between(&points, &mut random)
            } else {
                let step = |x: f64| {
                    if seed % 2 == 0 {
                        (2.0 * x).round() / 2.0
                    } else {
                        x
                    }
                };
                [0, 1, 2].map(|i| stretch[i] * step(p[i]))
            });
        }
        let points: Vec<Point> = points.into_iter().map(narrow).collect();
        let mut builder = HullBuilder::new();
        match builder.build(&points) {
            Ok(hull) => {
                check_polytope(&hull, &points);
                made += 1;
            }
            Err(error) => assert_eq!(error, HullError::Degenerate),
        }
    }
    assert!(made > 15_000, "{made}");
}

#[test]
fn the_smallest_hull_and_the_largest_input() {
    let tetrahedron = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(build_and_check(&tetrahedron), (4, 4, 6));
    let mut many = vec![[0.1, 0.1, 0.1]; PIECE_VERTICES_MAX];
    many[100..104].copy_from_slice(&tetrahedron);
    assert_eq!(build_and_check(&many), (4, 4, 6));
    many.push([0.2; 3]);
    assert_eq!(
        HullBuilder::new().build(&many).unwrap_err(),
        HullError::TooMany
    );
}

fn refused(points: &[Point]) -> HullError {
    HullBuilder::new().build(points).unwrap_err()
}

#[test]
fn what_is_no_hull_is_refused() {
    let cube: Vec<Point> = box_grid([1.0; 3], 2).into_iter().map(narrow).collect();
    assert_eq!(refused(&[]), HullError::TooFew);
    assert_eq!(refused(&cube[..3]), HullError::TooFew);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut points = cube.clone();
        points[5][1] = bad;
        assert_eq!(refused(&points), HullError::NotFinite);
    }
    let mut points = cube.clone();
    points[5][1] = 3e38;
    assert_eq!(refused(&points), HullError::TooLarge);
}

#[test]
fn flat_collinear_and_coincident_points_are_degenerate_at_any_size() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let turn = random.rotation();
        let flat: Vec<_> = (0..50)
            .map(|_| random.point())
            .map(|p| [p[0], p[1], 0.0])
            .collect();
        let line: Vec<_> = (0..50).map(|_| [random.next(), 0.0, 0.0]).collect();
        let spot = vec![[0.3, 0.2, 0.1]; 50];
        for scale in [1e-3, 1.0, 100.0] {
            for points in [&flat, &line, &spot] {
                let points = placed(points, turn, scale, [0.0; 3]);
                assert_eq!(refused(&points), HullError::Degenerate);
            }
        }
    }
    assert_eq!(refused(&[[0.0; 3]; 4]), HullError::Degenerate);
    assert_eq!(
        refused(&[[1e-45; 3], [0.0; 3], [0.0; 3], [-1e-42; 3]]),
        HullError::Degenerate
    );
}

#[test]
fn equal_input_gives_equal_bits_whatever_was_built_before() {
    let mut random = Random::new(7);
    let points: Vec<Point> = (0..80).map(|_| narrow(random.point())).collect();
    let ball = placed(&ball(), random.rotation(), 1.0, [0.0; 3]);
    let text = |hull: HullView| format!("{hull:?}");
    let mut used = HullBuilder::new();
    used.build(&ball).unwrap();
    let again = text(used.build(&points).unwrap());
    assert_eq!(again, text(HullBuilder::new().build(&points).unwrap()));
}

#[test]
fn a_cuboid_is_the_hull_of_its_corners() {
    let mut builder = HullBuilder::new();
    let half = Vec3::new(0.1, 2.0, 0.03);
    let hull = builder.cuboid(half).unwrap();
    let points: Vec<Point> = vertices(&hull).into_iter().map(narrow).collect();
    check(&hull, &points);
    assert_eq!(counts(&hull), (8, 6, 12));
    assert_eq!((hull.centre, hull.half_extents), (Vec3::ZERO, half));
    let normals: Vec<_> = hull.faces.iter().map(|f| f.normal).collect();
    let axes = [
        Vec3::NEG_X,
        Vec3::X,
        Vec3::NEG_Y,
        Vec3::Y,
        Vec3::NEG_Z,
        Vec3::Z,
    ];
    assert_eq!(normals, axes);
    for (face, offset) in hull.faces.iter().zip([0.1, 0.1, 2.0, 2.0, 0.03, 0.03]) {
        assert_eq!(face.offset, offset);
    }
}

#[test]
fn bad_cuboids_are_refused() {
    let refused = |half: Vec3| HullBuilder::new().cuboid(half).unwrap_err();
    assert_eq!(refused(Vec3::new(1.0, 0.0, 1.0)), HullError::Degenerate);
    assert_eq!(refused(Vec3::new(1.0, -1.0, 1.0)), HullError::Degenerate);
    assert_eq!(refused(Vec3::new(1.0, 1e-8, 1.0)), HullError::Degenerate);
    assert_eq!(refused(Vec3::new(1.0, f32::NAN, 1.0)), HullError::NotFinite);
    assert_eq!(refused(Vec3::new(1.0, 1e30, 1.0)), HullError::TooLarge);
}

#[test]
fn spheres_and_capsules() {
    let mut builder = HullBuilder::new();
    let a = Vec3::new(1.0, 2.0, 3.0);
    let sphere = builder.sphere(a).unwrap();
    assert_eq!(counts(&sphere), (1, 0, 0));
    assert_eq!((sphere.centre, sphere.half_extents), (a, Vec3::ZERO));
    check_vertices(&sphere, &[a.to_array()]);
    let b = Vec3::new(1.0, 2.0, 5.0);
    let capsule = builder.capsule(a, b).unwrap();
    assert_eq!(counts(&capsule), (2, 0, 1));
    assert_eq!(
        capsule.edges[0],
        Edge {
            vertices: [0, 1],
            faces: [0, 0]
        }
    );
    check_vertices(&capsule, &[a.to_array(), b.to_array()]);
    check_box(&capsule);
    assert_eq!(counts(&builder.capsule(a, a).unwrap()), (1, 0, 0));
    assert_eq!(builder.sphere(Vec3::NAN).unwrap_err(), HullError::NotFinite);
    assert_eq!(
        builder.capsule(a, Vec3::INFINITY).unwrap_err(),
        HullError::NotFinite
    );
}

const _: () = assert!(HullBuilder::BYTES < 150_000, "the builder fits a stack");
