//! Mass, centre of mass and inertia of convex pieces and of bodies made of several.
//!
//! Exact for every piece, rounded hulls included. A rounded hull is cut as Steiner's formula cuts
//! it: the core, a prism on every face, a sector of a cylinder along every edge, a sector of a ball at
//! every vertex. Every integral has a closed form (stated where it is used), computed in
//! double precision about the piece's bounding-box centre. What remains is rounding: angles are
//! taken from f32 arctangents (1e-7 relative), results are f32.
//!
//! Where a piece is not quite a polytope, because its faces are flat only within the hull
//! builder's tolerance, the prisms and sectors overlap or gape by that tolerance, 1e-6 relative.

use core::fmt;

use glam::{Mat3, Quat, Vec3};

use super::convex::{Convex, Edge, Face};
use super::double::{self, Vec3d};
use crate::math::{Pose, atan2, sqrt_f64};

const PI: f64 = core::f64::consts::PI;

/// Why a piece has no mass properties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MassError {
    /// The density is not a positive finite number.
    Density,
    /// The radius is negative or not finite.
    Radius,
    /// The volume is zero, or so small or large that a result is not a normal f32.
    Volume,
}

impl fmt::Display for MassError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Density => "the density is not a positive number",
            Self::Radius => "the radius is negative or not finite",
            Self::Volume => "the volume is zero or out of range",
        })
    }
}

impl core::error::Error for MassError {}

/// What a rigid body resists motion with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass in kilograms.
    pub mass_kg: f32,
    /// Centre of mass in metres.
    pub centre: Vec3,
    /// Inertia about the centre of mass, along the frame's axes, in kg m^2; symmetric.
    pub inertia: Mat3,
}

/// Principal moments and the axes they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// Moments about the turned axes, in kg m^2, in no particular order.
    pub moments: Vec3,
    /// Turns the frame's axes into the principal ones; exactly the identity when the inertia is
    /// diagonal to within rounding.
    pub rotation: Quat,
}

impl MassProperties {
    /// Of a piece (sphere, capsule, hull, rounded hull) with a density in kg/m^3.
    ///
    /// # Errors
    /// See [`MassError`].
    ///
    /// # Cost
    /// One step per loop entry and per edge.
    pub fn of_piece(piece: &Convex, density_kg_per_m3: f32) -> Result<Self, MassError> {
        if !(density_kg_per_m3 > 0.0 && density_kg_per_m3.is_finite()) {
            return Err(MassError::Density);
        }
        if !(piece.radius >= 0.0 && piece.radius.is_finite()) {
            return Err(MassError::Radius);
        }
        let origin = double::from_vec3(piece.centre);
        let mut moments = moments_of(piece, origin);
        moments.scale(f64::from(density_kg_per_m3));
        moments.properties(origin).ok_or(MassError::Volume)
    }

    /// The same body seen from the frame that `pose` is given in.
    #[must_use]
    pub fn placed(&self, pose: &Pose) -> Self {
        let mut sum = MassSum::new();
        sum.add(pose, self);
        sum.total().unwrap_or(*self)
    }

    /// Principal moments and axes: six sweeps of Jacobi's method, in double precision.
    ///
    /// Golub and Van Loan, "Matrix Computations", section 8.5. Convergence is quadratic; five
    /// sweeps bring any 3x3 matrix to rounding.
    #[must_use]
    pub fn principal(&self) -> Principal {
        let mut matrix = columns(&self.inertia);
        let mut axes = IDENTITY;
        for _ in 0..JACOBI_SWEEPS {
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                annihilate(&mut matrix, &mut axes, p, q);
            }
        }
        Principal {
            moments: double::to_vec3([matrix[0][0], matrix[1][1], matrix[2][2]]),
            rotation: quat_of(&axes),
        }
    }
}

/// Adds up the parts of a compound body, in double precision.
#[derive(Clone, Copy, Debug, Default)]
pub struct MassSum {
    moments: Moments,
}

impl MassSum {
    /// Nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            moments: Moments::ZERO,
        }
    }

    /// Adds a part whose own frame is at `pose` in the body's frame.
    pub fn add(&mut self, pose: &Pose, part: &MassProperties) {
        let turn = rotation(pose);
        let mass = f64::from(part.mass_kg);
        let centre = apply(&turn, double::from_vec3(part.centre));
        let centre = double::add(centre, double::from_array(pose.position));
        let spread = similar(&turn, &spread_of(&part.inertia));
        self.moments.add_at(centre, mass, [0.0; 3], &spread);
    }

    /// The whole, in the body's frame; `None` while there is no mass.
    #[must_use]
    pub fn total(&self) -> Option<MassProperties> {
        self.moments.properties([0.0; 3])
    }
}

type Matrix = [Vec3d; 3];

const ZERO: Matrix = [[0.0; 3]; 3];
const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const JACOBI_SWEEPS: usize = 6;

/// Entries off the diagonal that count as zero, relative to the trace: as f32 rounds. Without it
/// the axes of a cube would be decided by rounding.
const DIAGONAL: f64 = 6e-8;

/// Integrals of 1, x and x x^T over a solid (times its density).
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    zeroth: f64,
    first: Vec3d,
    second: Matrix,
}

impl Moments {
    const ZERO: Self = Self {
        zeroth: 0.0,
        first: [0.0; 3],
        second: ZERO,
    };

    /// Adds a solid given by its moments about its own `apex`.
    fn add_at(&mut self, apex: Vec3d, zeroth: f64, first: Vec3d, second: &Matrix) {
        self.zeroth += zeroth;
        self.first = double::add(self.first, double::add(first, double::scale(apex, zeroth)));
        for i in 0..3 {
            for j in 0..3 {
                self.second[i][j] += second[i][j]
                    + apex[i] * first[j]
                    + first[i] * apex[j]
                    + zeroth * apex[i] * apex[j];
            }
        }
    }

    /// Adds a tetrahedron, negative when its corners run the wrong way round.
    ///
    /// With s the sum of the corners: volume V = det / 6, first moment V s / 4, second moment
    /// V (s s^T + sum of p p^T) / 20.
    fn add_tetrahedron(&mut self, corners: [Vec3d; 4]) {
        let [a, b, c, d] = corners;
        let edges = [double::sub(b, a), double::sub(c, a), double::sub(d, a)];
        let volume = double::dot(edges[0], double::cross(edges[1], edges[2])) / 6.0;
        let sum = double::add(edges[0], double::add(edges[1], edges[2]));
        let mut second = scaled_outer(sum, sum, volume / 20.0);
        for edge in edges {
            accumulate(&mut second, edge, edge, volume / 20.0);
        }
        self.add_at(a, volume, double::scale(sum, volume / 4.0), &second);
    }

    /// Adds the prism on a triangle; `up` is the third side.
    fn add_prism(&mut self, [a, b, c]: [Vec3d; 3], up: Vec3d) {
        let [top_a, top_b, top_c] = [a, b, c].map(|p| double::add(p, up));
        self.add_tetrahedron([a, b, c, top_a]);
        self.add_tetrahedron([b, c, top_a, top_b]);
        self.add_tetrahedron([c, top_a, top_b, top_c]);
    }

    /// Adds a ball about `centre`, or the given fraction of one whose cut faces make no
    /// difference to its first and second moments.
    fn add_ball(&mut self, centre: Vec3d, radius: f64, fraction: f64) {
        let volume = fraction * 4.0 / 3.0 * PI * radius * radius * radius;
        let second = scaled(&IDENTITY, volume * radius * radius / 5.0);
        self.add_at(centre, volume, [0.0; 3], &second);
    }

    fn scale(&mut self, factor: f64) {
        self.zeroth *= factor;
        self.first = double::scale(self.first, factor);
        self.second = scaled(&self.second, factor);
    }

    /// Mass, centre and inertia, with the moments' origin at `origin`.
    fn properties(&self, origin: Vec3d) -> Option<MassProperties> {
        let mass_kg = self.zeroth as f32;
        if !mass_kg.is_normal() || mass_kg < 0.0 {
            return None;
        }
        let centre = double::scale(self.first, 1.0 / self.zeroth);
        let mut spread = self.second;
        accumulate(&mut spread, centre, centre, -self.zeroth);
        Some(MassProperties {
            mass_kg,
            centre: double::to_vec3(double::add(centre, origin)),
            inertia: inertia_of(&spread),
        })
    }
}

fn moments_of(piece: &Convex, origin: Vec3d) -> Moments {
    let radius = f64::from(piece.radius);
    let mut moments = Moments::ZERO;
    match piece.vertex_count {
        1 => moments.add_ball(at(piece, 0, origin), radius, 1.0),
        2 => add_capsule(&mut moments, piece, origin, radius),
        _ => add_hull(&mut moments, piece, origin, radius),
    }
    moments
}

/// A vertex relative to the origin of the moments.
fn at(piece: &Convex, index: u16, origin: Vec3d) -> Vec3d {
    double::sub(double::from_vec3(piece.vertex(index as usize)), origin)
}

/// A cylinder and two half balls.
///
/// Half a ball about its own centre has half the ball's second moment, and pi r^4 / 4 for a first
/// moment along its axis.
fn add_capsule(moments: &mut Moments, piece: &Convex, origin: Vec3d, radius: f64) {
    let ends = [at(piece, 0, origin), at(piece, 1, origin)];
    let along = double::sub(ends[1], ends[0]);
    let length = double::length(along);
    let axis = double::unit(along);
    let square = radius * radius;
    let bulge = PI / 4.0 * square * square;
    for (end, side) in [(ends[0], -1.0), (ends[1], 1.0)] {
        moments.add_ball(end, radius, 0.5);
        moments.add_at(end, 0.0, double::scale(axis, side * bulge), &ZERO);
    }
    let volume = PI * square * length;
    let mut second = scaled(&IDENTITY, volume * square / 4.0);
    accumulate(
        &mut second,
        axis,
        axis,
        volume * (length * length / 12.0 - square / 4.0),
    );
    let middle = double::scale(double::add(ends[0], ends[1]), 0.5);
    moments.add_at(middle, volume, [0.0; 3], &second);
}

fn add_hull(moments: &mut Moments, piece: &Convex, origin: Vec3d, radius: f64) {
    for face in piece.faces {
        add_face(moments, piece, face, origin, radius);
    }
    if radius > 0.0 {
        for index in 0..piece.vertex_count {
            moments.add_ball(at(piece, index as u16, origin), radius, 0.5);
        }
        for edge in piece.edges {
            add_edge(moments, piece, edge, origin, radius);
        }
    }
}

/// Adds the cone from the origin to a face and the prism on it, and takes from the balls at
/// its corners what belongs to its angles.
///
/// The sector of the ball at a vertex has the solid angle 2 pi less the sum of its faces' angles
/// (Descartes' defect), so half a ball per vertex less angle / 4 pi of one per corner.
fn add_face(moments: &mut Moments, piece: &Convex, face: &Face, origin: Vec3d, radius: f64) {
    let corners = piece.face_loop(face);
    let count = corners.len();
    let up = double::scale(face_normal(piece, face), radius);
    let first = at(piece, corners[0], origin);
    for i in 0..count {
        let [a, b, c] = [i, i + 1, i + 2].map(|k| at(piece, corners[k % count], origin));
        if i + 2 < count {
            moments.add_tetrahedron([[0.0; 3], first, b, c]);
        }
        if i + 2 < count && radius > 0.0 {
            moments.add_prism([first, b, c], up);
        }
        if radius > 0.0 {
            let angle = angle_between(double::sub(a, b), double::sub(c, b));
            moments.add_ball(b, radius, -angle / (4.0 * PI));
        }
    }
}

/// Newell's normal in double precision; the stored one is rounded.
fn face_normal(piece: &Convex, face: &Face) -> Vec3d {
    let corners = piece.face_loop(face);
    let origin = double::from_vec3(piece.vertex(corners[0] as usize));
    let mut sum = [0.0; 3];
    for pair in corners[1..].windows(2) {
        let [a, b] = [at(piece, pair[0], origin), at(piece, pair[1], origin)];
        sum = double::add(sum, double::cross(a, b));
    }
    double::unit(sum)
}

/// Adds the sector of a cylinder along an edge, and what its two ends add to the sectors of the
/// balls there.
fn add_edge(moments: &mut Moments, piece: &Convex, edge: &Edge, origin: Vec3d, radius: f64) {
    let normals = edge
        .faces
        .map(|f| face_normal(piece, &piece.faces[f as usize]));
    let ends = edge.vertices.map(|v| at(piece, v, origin));
    let arc = Arc::new(normals);
    arc.add_cylinder_sector(moments, ends, radius);
    // Seen from outside, the faces around an edge's first end follow each other second to first.
    arc.reversed().add_ball_side(moments, ends[0], radius);
    arc.add_ball_side(moments, ends[1], radius);
}

/// The arc of unit normals from one face to its neighbour.
#[derive(Clone, Copy)]
struct Arc {
    normals: [Vec3d; 2],
    half_angle: f64,
    /// Cosine and sine of the half angle.
    cosine: f64,
    sine: f64,
    /// Unit vector to the arc's middle.
    middle: Vec3d,
}

impl Arc {
    fn new(normals: [Vec3d; 2]) -> Self {
        let sum = double::add(normals[0], normals[1]);
        let difference = double::sub(normals[1], normals[0]);
        let cosine = 0.5 * double::length(sum);
        let sine = 0.5 * double::length(difference);
        Self {
            normals,
            half_angle: f64::from(atan2(sine as f32, cosine as f32)),
            cosine,
            sine,
            middle: double::unit(sum),
        }
    }

    fn reversed(self) -> Self {
        Self {
            normals: [self.normals[1], self.normals[0]],
            ..self
        }
    }

    /// With h the half angle, u the arc's middle, w at right angles to it and to the edge: the
    /// sector's area is r^2 h, its first moment 2/3 r^3 sin h along u, its second moments
    /// r^4 (h + sin h cos h) / 4 along u and r^4 (h - sin h cos h) / 4 along w.
    fn add_cylinder_sector(&self, moments: &mut Moments, ends: [Vec3d; 2], radius: f64) {
        let along = double::sub(ends[1], ends[0]);
        let length = double::length(along);
        let square = radius * radius;
        let area = square * self.half_angle;
        let quarter = 0.25 * square * square * length;
        let mixed = self.sine * self.cosine;
        let across = double::unit(double::sub(self.normals[1], self.normals[0]));
        let mut second = scaled_outer(along, along, area * length / 12.0);
        accumulate(
            &mut second,
            self.middle,
            self.middle,
            quarter * (self.half_angle + mixed),
        );
        accumulate(
            &mut second,
            across,
            across,
            quarter * (self.half_angle - mixed),
        );
        let first = double::scale(
            self.middle,
            2.0 / 3.0 * square * radius * self.sine * length,
        );
        let centre = double::scale(double::add(ends[0], ends[1]), 0.5);
        moments.add_at(centre, area * length, first, &second);
    }

    /// One side's share in the moments of a ball's sector over a spherical polygon.
    ///
    /// By the divergence theorem over the sector, with a and b the ends of each side, counter-
    /// clockwise: the integral of n over the polygon is the sum of angle / 2 times the unit vector
    /// along a x b, and that of n n^T is a third of (solid angle + sum of
    /// (a x b)(a + b)^T / (1 + a.b)). The solid angle's part is added with the faces' corners.
    fn add_ball_side(&self, moments: &mut Moments, vertex: Vec3d, radius: f64) {
        let [a, b] = self.normals;
        let normal = double::cross(a, b);
        let square = radius * radius;
        let first = double::scale(
            double::unit(normal),
            0.25 * square * square * self.half_angle,
        );
        let weight = square * square * radius / 15.0 / (2.0 * self.cosine * self.cosine);
        let sum = double::add(a, b);
        let mut second = scaled_outer(normal, sum, 0.5 * weight);
        accumulate(&mut second, sum, normal, 0.5 * weight);
        moments.add_at(vertex, 0.0, first, &second);
    }
}

/// The angle between two vectors in radians.
fn angle_between(a: Vec3d, b: Vec3d) -> f64 {
    let sine = double::length(double::cross(a, b));
    let scale = double::length(a) * double::length(b);
    f64::from(atan2(
        (sine / scale) as f32,
        (double::dot(a, b) / scale) as f32,
    ))
}

fn accumulate(matrix: &mut Matrix, a: Vec3d, b: Vec3d, factor: f64) {
    for i in 0..3 {
        for j in 0..3 {
            matrix[i][j] += factor * a[i] * b[j];
        }
    }
}

fn scaled_outer(a: Vec3d, b: Vec3d, factor: f64) -> Matrix {
    let mut matrix = ZERO;
    accumulate(&mut matrix, a, b, factor);
    matrix
}

fn scaled(matrix: &Matrix, factor: f64) -> Matrix {
    matrix.map(|row| double::scale(row, factor))
}

/// The inertia of a second moment about the centre: trace - second moment.
fn inertia_of(spread: &Matrix) -> Mat3 {
    let trace = spread[0][0] + spread[1][1] + spread[2][2];
    let entry = |i: usize, j: usize| {
        let mean = 0.5 * (spread[i][j] + spread[j][i]);
        if i == j { trace - mean } else { 0.0 - mean }
    };
    let column = |j: usize| double::to_vec3([entry(0, j), entry(1, j), entry(2, j)]);
    Mat3::from_cols(column(0), column(1), column(2))
}

/// The second moment of an inertia: trace / 2 - inertia.
fn spread_of(inertia: &Mat3) -> Matrix {
    let inertia = columns(inertia);
    let half_trace = 0.5 * (inertia[0][0] + inertia[1][1] + inertia[2][2]);
    let mut spread = scaled(&inertia, -1.0);
    for i in 0..3 {
        spread[i][i] += half_trace;
    }
    spread
}

fn columns(matrix: &Mat3) -> Matrix {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(double::from_vec3)
}

/// Rows of the rotation matrix of a pose, from the quaternion normalised in double precision.
fn rotation(pose: &Pose) -> Matrix {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    [
        [
            1.0 - s * (y * y + z * z),
            s * (x * y - z * w),
            s * (x * z + y * w),
        ],
        [
            s * (x * y + z * w),
            1.0 - s * (x * x + z * z),
            s * (y * z - x * w),
        ],
        [
            s * (x * z - y * w),
            s * (y * z + x * w),
            1.0 - s * (x * x + y * y),
        ],
    ]
}

fn apply(matrix: &Matrix, v: Vec3d) -> Vec3d {
    matrix.map(|row| double::dot(row, v))
}

/// R M R^T for a symmetric M.
fn similar(turn: &Matrix, matrix: &Matrix) -> Matrix {
    let turned = turn.map(|row| apply(matrix, row));
    turn.map(|row| turned.map(|column| double::dot(row, column)))
}

/// One Jacobi rotation in the plane of axes p and q that clears the entry between them.
fn annihilate(matrix: &mut Matrix, axes: &mut Matrix, p: usize, q: usize) {
    let off = matrix[p][q];
    if off.abs() <= DIAGONAL * (matrix[0][0] + matrix[1][1] + matrix[2][2]) {
        return;
    }
    let ratio = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
    let sign = if ratio < 0.0 { -1.0 } else { 1.0 };
    let tangent = sign / (sign * ratio + sqrt_f64(1.0 + ratio * ratio));
    let cosine = 1.0 / sqrt_f64(1.0 + tangent * tangent);
    let sine = tangent * cosine;
    for column in matrix.iter_mut() {
        turn_pair(column, p, q, cosine, sine);
    }
    let [row_p, row_q] = [matrix[p], matrix[q]];
    for k in 0..3 {
        matrix[p][k] = cosine * row_p[k] - sine * row_q[k];
        matrix[q][k] = sine * row_p[k] + cosine * row_q[k];
    }
    matrix[p][q] = 0.0;
    matrix[q][p] = 0.0;
    for row in axes.iter_mut() {
        turn_pair(row, p, q, cosine, sine);
    }
}

fn turn_pair(row: &mut Vec3d, p: usize, q: usize, cosine: f64, sine: f64) {
    let [a, b] = [row[p], row[q]];
    row[p] = cosine * a - sine * b;
    row[q] = sine * a + cosine * b;
}

/// The unit quaternion of a rotation matrix given by rows: of the four forms of Shepperd 1978,
/// the one that divides by the largest number.
fn quat_of(m: &Matrix) -> Quat {
    let squares = [
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
        1.0 + m[0][0] + m[1][1] + m[2][2],
    ];
    let forms = [
        [
            squares[0],
            m[1][0] + m[0][1],
            m[0][2] + m[2][0],
            m[2][1] - m[1][2],
        ],
        [
            m[1][0] + m[0][1],
            squares[1],
            m[2][1] + m[1][2],
            m[0][2] - m[2][0],
        ],
        [
            m[0][2] + m[2][0],
            m[2][1] + m[1][2],
            squares[2],
            m[1][0] - m[0][1],
        ],
        [
            m[2][1] - m[1][2],
            m[0][2] - m[2][0],
            m[1][0] - m[0][1],
            squares[3],
        ],
    ];
    let mut best = 3;
    for i in 0..3 {
        best = if squares[i] > squares[best] { i } else { best };
    }
    let q = forms[best];
    let length = sqrt_f64(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    let sign = if q[3] < 0.0 { -1.0 } else { 1.0 };
    let [x, y, z, w] = q.map(|v| (v * sign / length + 0.0) as f32);
    Quat::from_xyzw(x, y, z, w)
}
