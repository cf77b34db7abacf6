//! Mass properties against closed forms and against sums over many small parts.

use std::f64::consts::PI;

use glam::{Mat3, Quat, Vec3};
use palpable::geometry::convex::Convex;
use palpable::geometry::hull::{HullBuilder, HullView};
use palpable::geometry::mass::{MassError, MassProperties, MassSum};
use palpable::math::Pose;

const DENSITY: f32 = 700.0;

fn near(found: f32, expected: f64, scale: f64) {
    let error = (f64::from(found) - expected).abs() / scale;
    assert!(error < 1e-6, "{found} is not {expected}, off by {error:e}");
}

fn near_vec(found: Vec3, expected: [f64; 3], scale: f64) {
    for axis in 0..3 {
        near(found[axis], expected[axis], scale);
    }
}

fn near_mat(found: Mat3, expected: Mat3, scale: f64) {
    for column in 0..3 {
        let expected = expected.col(column).to_array().map(f64::from);
        near_vec(found.col(column), expected, scale);
    }
}

fn near_diagonal(found: Mat3, expected: [f64; 3]) {
    let scale = expected.iter().fold(0.0, |a: f64, b| a.max(*b));
    for column in 0..3 {
        let mut exact = [0.0; 3];
        exact[column] = expected[column];
        near_vec(found.col(column), exact, scale);
    }
}

fn of(hull: HullView, radius: f32) -> MassProperties {
    MassProperties::of_piece(&hull.convex(radius), DENSITY).unwrap()
}

fn tetrahedron(scale: f32, at: Vec3) -> Vec<[f32; 3]> {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    corners
        .iter()
        .map(|&c| (c * scale + at).to_array())
        .collect()
}

#[test]
fn boxes_of_every_size() {
    for size in [1e-3, 1.0, 100.0] {
        let half = Vec3::new(0.5, 0.3, 0.2) * size;
        let found = of(HullBuilder::new().cuboid(half).unwrap(), 0.0);
        let [x, y, z] = half.to_array().map(f64::from);
        let mass = 8.0 * x * y * z * f64::from(DENSITY);
        let third = mass / 3.0;
        near(found.mass_kg, mass, mass);
        near_vec(found.centre, [0.0; 3], f64::from(size));
        let squares = [y * y + z * z, x * x + z * z, x * x + y * y];
        near_diagonal(found.inertia, squares.map(|s| s * third));
    }
}

#[test]
fn spheres_and_capsules() {
    let mut builder = HullBuilder::new();
    let (radius, density) = (0.02f32, f64::from(DENSITY));
    let r = f64::from(radius);
    let centre = Vec3::new(1.0, -2.0, 3.0);
    let ball = of(builder.sphere(centre).unwrap(), radius);
    let ball_mass = 4.0 / 3.0 * PI * r.powi(3) * density;
    near(ball.mass_kg, ball_mass, ball_mass);
    assert_eq!(ball.centre, centre);
    near_diagonal(ball.inertia, [0.4 * ball_mass * r * r; 3]);

    let l = 0.25;
    let capsule = of(
        builder.capsule(centre, centre + Vec3::Y * 0.25).unwrap(),
        radius,
    );
    let rod_mass = PI * r * r * l * density;
    near(capsule.mass_kg, rod_mass + ball_mass, rod_mass);
    near_vec(capsule.centre, [1.0, -1.875, 3.0], 1.0);
    let along = rod_mass * r * r / 2.0 + ball_mass * 0.4 * r * r;
    let ends = 0.4 * r * r + l * l / 4.0 + 3.0 / 8.0 * l * r;
    let across = rod_mass * (l * l / 12.0 + r * r / 4.0) + ball_mass * ends;
    near_diagonal(capsule.inertia, [across, along, across]);
}

#[test]
fn a_tetrahedron_wherever_it_is() {
    let mut builder = HullBuilder::new();
    for (scale, at) in [(1e-3, 0.0), (1.0, 0.0), (100.0, 0.0), (1.0, 1024.0)] {
        let points = tetrahedron(scale, Vec3::splat(at));
        let found = of(builder.build(&points).unwrap(), 0.0);
        let s = f64::from(scale);
        let mass = s.powi(3) / 6.0 * f64::from(DENSITY);
        near(found.mass_kg, mass, mass);
        near_vec(
            found.centre,
            [f64::from(at) + 0.25 * s; 3],
            s.max(f64::from(at)),
        );
        let [on, off] = [3.0 / 40.0, 1.0 / 80.0].map(|k| (k * mass * s * s) as f32);
        let exact = Mat3::from_cols_array(&[on, off, off, off, on, off, off, off, on]);
        near_mat(found.inertia, exact, f64::from(on));
    }
}

/// Steiner: V + r A + r^2 (sum of length times half angle) + 4/3 pi r^3.
#[test]
fn the_rounded_box_has_the_volume_of_steiner() {
    let half = Vec3::new(0.5, 0.3, 0.2);
    for radius in [1e-4f32, 0.01, 0.1, 1.0, 10.0] {
        let found = of(HullBuilder::new().cuboid(half).unwrap(), radius);
        let r = f64::from(radius);
        let [x, y, z] = half.to_array().map(|h| 2.0 * f64::from(h));
        let area = 2.0 * (x * y + y * z + z * x);
        let edges = PI * r * r * (x + y + z);
        let volume = x * y * z + area * r + edges + 4.0 / 3.0 * PI * r.powi(3);
        near(
            found.mass_kg,
            volume * f64::from(DENSITY),
            volume * f64::from(DENSITY),
        );
        near_vec(found.centre, [0.0; 3], 1.0 + r);
    }
}

/// A rounded box by hand: the moments of its cross, of quarter cylinders and of eighths of a ball.
#[test]
fn the_rounded_box_has_the_inertia_of_its_parts() {
    let half = [0.5, 0.3, 0.2];
    let r = 0.15f32;
    let found = of(HullBuilder::new().cuboid(Vec3::from(half)).unwrap(), r);
    let r = f64::from(r);
    let h = half.map(f64::from);
    // Integral of x_i^2 by pieces: inside, on faces, along edges, at corners.
    let second = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let body = 8.0 * h[0] * h[1] * h[2] * h[i] * h[i] / 3.0;
        let cap = 8.0 * h[j] * h[k] * ((h[i] + r).powi(3) - h[i].powi(3)) / 3.0;
        let sides = 8.0 * h[i].powi(3) / 3.0 * r * (h[j] + h[k]);
        let along = 2.0 * h[i].powi(3) / 3.0 * PI * r * r;
        // Four quarter discs (or eight eighths of a ball) moved out by h[i] together.
        let disc = PI * r * r * h[i] * h[i] + 8.0 / 3.0 * r.powi(3) * h[i] + PI / 4.0 * r.powi(4);
        let ball = 4.0 / 3.0 * PI * r.powi(3) * h[i] * h[i]
            + PI * r.powi(4) * h[i]
            + 4.0 / 15.0 * PI * r.powi(5);
        body + cap + sides + along + disc * 2.0 * (h[j] + h[k]) + ball
    };
    let [x, y, z] = [second(0), second(1), second(2)].map(|s| s * f64::from(DENSITY));
    near_diagonal(found.inertia, [y + z, x + z, x + y]);
}

/// A box of any size rounded by almost its whole size is nearly a ball about its centre.
#[test]
fn a_rounded_hull_tends_to_its_ball() {
    let mut builder = HullBuilder::new();
    let points = tetrahedron(1e-3, Vec3::ZERO);
    let found = of(builder.build(&points).unwrap(), 10.0);
    let mass = 4.0 / 3.0 * PI * 1000.0 * f64::from(DENSITY);
    assert!((f64::from(found.mass_kg) / mass - 1.0).abs() < 1e-3);
    for k in 0..3 {
        let moment = f64::from(found.inertia.col(k)[k]);
        assert!((moment / (0.4 * mass * 100.0) - 1.0).abs() < 1e-3);
    }
}

/// Moments of a rounded tetrahedron by summing over a fine lattice of its bounding box.
#[test]
fn a_rounded_lopsided_hull_agrees_with_a_lattice_sum() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 0.8, 0.1],
        [0.3, 0.2, 0.9],
    ];
    let mut builder = HullBuilder::new();
    let hull = builder.build(&corners).unwrap();
    let radius = 0.3;
    let found = of(hull, radius);
    let sum = lattice(&hull, f64::from(radius), 90);
    let mass = sum[0] * f64::from(DENSITY);
    assert!((f64::from(found.mass_kg) / mass - 1.0).abs() < 1e-3);
    let centre = [sum[1] / sum[0], sum[2] / sum[0], sum[3] / sum[0]];
    for k in 0..3 {
        assert!((f64::from(found.centre[k]) - centre[k]).abs() < 3e-4);
    }
    let mut cell = 4;
    let mut spread = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in i..3 {
            spread[i][j] = sum[cell] / sum[0] - centre[i] * centre[j];
            spread[j][i] = spread[i][j];
            cell += 1;
        }
    }
    let trace = spread[0][0] + spread[1][1] + spread[2][2];
    for i in 0..3 {
        for j in 0..3 {
            let inertia = if i == j {
                trace - spread[i][j]
            } else {
                -spread[i][j]
            };
            let error = f64::from(found.inertia.col(i)[j]) / mass - inertia;
            assert!(error.abs() < 1e-3 * trace, "{i}{j}: {error:e} of {trace}");
        }
    }
}

/// Volume, first moments, and second moments xx xy xz yy yz zz.
fn lattice(hull: &HullView, radius: f64, steps: usize) -> [f64; 10] {
    let piece = hull.convex(0.0);
    let low = (hull.centre - hull.half_extents)
        .to_array()
        .map(|x| f64::from(x) - radius);
    let high = (hull.centre + hull.half_extents)
        .to_array()
        .map(|x| f64::from(x) + radius);
    let step = [0, 1, 2].map(|k| (high[k] - low[k]) / steps as f64);
    let mut sum = [0.0; 10];
    for cell in 0..steps.pow(3) {
        let index = [cell % steps, cell / steps % steps, cell / steps / steps];
        let p = [0, 1, 2].map(|k| low[k] + (index[k] as f64 + 0.5) * step[k]);
        if core_distance(&piece, p) <= radius {
            let [x, y, z] = p;
            let terms = [1.0, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z];
            for (total, term) in sum.iter_mut().zip(terms) {
                *total += term * step[0] * step[1] * step[2];
            }
        }
    }
    sum
}

/// Distance of a point from a small hull: the nearest of all its faces' triangles.
fn core_distance(piece: &Convex, p: [f64; 3]) -> f64 {
    let p = narrow(p);
    let mut nearest = f32::INFINITY;
    let mut inside = true;
    for face in piece.faces {
        inside &= face.normal.dot(p) <= face.offset;
        let corners = piece.face_loop(face);
        let [a, b, c] = [0, 1, 2].map(|k| piece.vertex(corners[k] as usize));
        nearest = nearest.min((closest_on_triangle(p, a, b, c) - p).length());
    }
    if inside { 0.0 } else { f64::from(nearest) }
}

fn narrow(p: [f64; 3]) -> Vec3 {
    Vec3::from_array(p.map(|x| x as f32))
}

fn closest_on_triangle(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let normal = (b - a).cross(c - a).normalize();
    let flat = p - normal * normal.dot(p - a);
    let sides = [(a, b), (b, c), (c, a)];
    let inside = |(s, e): &(Vec3, Vec3)| (*e - *s).cross(flat - *s).dot(normal) >= 0.0;
    if sides.iter().all(inside) {
        return flat;
    }
    let on = |(s, e): &(Vec3, Vec3)| {
        let t = (p - *s).dot(*e - *s) / (*e - *s).length_squared();
        *s + (*e - *s) * t.clamp(0.0, 1.0)
    };
    let ends = sides.iter().map(on);
    let nearer = |x: Vec3, y: Vec3| {
        if (x - p).length() <= (y - p).length() {
            x
        } else {
            y
        }
    };
    ends.reduce(nearer).unwrap()
}

#[test]
fn two_half_boxes_make_a_whole_one() {
    let mut builder = HullBuilder::new();
    let half = of(builder.cuboid(Vec3::new(0.25, 0.3, 0.2)).unwrap(), 0.0);
    let mut sum = MassSum::new();
    assert_eq!(sum.total(), None);
    sum.add(&Pose::at(10.25, 5.0, -3.0), &half);
    sum.add(&Pose::at(9.75, 5.0, -3.0), &half);
    let whole = of(builder.cuboid(Vec3::new(0.5, 0.3, 0.2)).unwrap(), 0.0);
    let found = sum.total().unwrap();
    near(
        found.mass_kg,
        f64::from(whole.mass_kg),
        f64::from(whole.mass_kg),
    );
    near_vec(found.centre, [10.0, 5.0, -3.0], 1.0);
    near_mat(
        found.inertia,
        whole.inertia,
        f64::from(whole.inertia.y_axis.y),
    );
}

#[test]
fn a_dumbbell_obeys_the_parallel_axis_theorem() {
    let mut builder = HullBuilder::new();
    let ball = of(builder.sphere(Vec3::ZERO).unwrap(), 0.1);
    let rod = of(builder.cuboid(Vec3::new(0.5, 0.01, 0.01)).unwrap(), 0.0);
    let mut sum = MassSum::new();
    sum.add(&Pose::at(0.6, 0.0, 0.0), &ball);
    sum.add(&Pose::at(-0.6, 0.0, 0.0), &ball);
    sum.add(&Pose::IDENTITY, &rod);
    let found = sum.total().unwrap();
    let [m, i] = [f64::from(ball.mass_kg), f64::from(ball.inertia.x_axis.x)];
    let axial = 2.0 * i + f64::from(rod.inertia.x_axis.x);
    let across = 2.0 * (i + m * f64::from(0.6f32).powi(2)) + f64::from(rod.inertia.y_axis.y);
    near_diagonal(found.inertia, [axial, across, across]);
}

#[test]
fn turning_a_body_turns_its_inertia() {
    let mut builder = HullBuilder::new();
    let piece = of(builder.build(&tetrahedron(1.0, Vec3::ZERO)).unwrap(), 0.05);
    let turn = Quat::from_xyzw(0.1, -0.5, 0.3, 0.8).normalize();
    let pose = Pose::new(turn, Vec3::new(1.0, 2.0, 3.0));
    let found = piece.placed(&pose);
    let rotation = Mat3::from_quat(turn);
    let expected = rotation * piece.inertia * rotation.transpose();
    near_mat(found.inertia, expected, f64::from(piece.inertia.x_axis.x));
    near_vec(
        found.centre,
        pose.point(piece.centre).to_array().map(f64::from),
        4.0,
    );
}

#[test]
fn principal_axes_give_the_inertia_back() {
    let mut builder = HullBuilder::new();
    let plain = of(builder.cuboid(Vec3::new(0.5, 0.3, 0.2)).unwrap(), 0.0);
    for step in 0..100 {
        let t = step as f32 * 0.37;
        let turn = Quat::from_xyzw(t.sin(), (2.0 * t).cos(), (3.0 * t).sin(), t.cos() + 1.5);
        let turn = turn.normalize();
        let turned = plain.placed(&Pose::new(turn, Vec3::ZERO));
        let found = turned.principal();
        assert!((found.rotation.length() - 1.0).abs() < 1e-6);
        let axes = Mat3::from_quat(found.rotation);
        let back = axes * Mat3::from_diagonal(found.moments) * axes.transpose();
        near_mat(
            back,
            turned.inertia,
            2.0 * f64::from(plain.inertia.z_axis.z),
        );
        let mut moments = found.moments.to_array();
        moments.sort_by(f32::total_cmp);
        let exact = [
            plain.inertia.x_axis.x,
            plain.inertia.y_axis.y,
            plain.inertia.z_axis.z,
        ];
        for k in 0..3 {
            near(moments[k], f64::from(exact[k]), f64::from(exact[2]));
        }
    }
}

#[test]
fn principal_axes_of_a_diagonal_inertia_are_the_frames_own() {
    let found = of(
        HullBuilder::new().cuboid(Vec3::new(0.5, 0.3, 0.2)).unwrap(),
        0.0,
    );
    let principal = found.principal();
    assert_eq!(principal.rotation, Quat::IDENTITY);
    assert_eq!(principal.moments.x, found.inertia.x_axis.x);
    let ball = of(HullBuilder::new().sphere(Vec3::ONE).unwrap(), 0.1);
    assert_eq!(ball.principal().rotation, Quat::IDENTITY);
    let cube = of(HullBuilder::new().cuboid(Vec3::splat(0.1)).unwrap(), 0.03);
    assert_eq!(cube.principal().rotation, Quat::IDENTITY);
}

#[test]
fn what_has_no_mass_is_refused() {
    let mut builder = HullBuilder::new();
    let point = builder.sphere(Vec3::ZERO).unwrap();
    let with =
        |radius, density| MassProperties::of_piece(&point.convex(radius), density).unwrap_err();
    assert_eq!(with(0.0, 1000.0), MassError::Volume);
    assert_eq!(with(-1.0, 1000.0), MassError::Radius);
    assert_eq!(with(f32::NAN, 1000.0), MassError::Radius);
    assert_eq!(with(1e-30, 1000.0), MassError::Volume);
    for density in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(with(1.0, density), MassError::Density);
    }
}
