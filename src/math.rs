//! The only home of square roots, transcendental functions and poses.
//!
//! Everything here gives the same bits on every processor: `libm` instead of the platform's
//! library, no fused multiply-add, comparisons written out where the sign of zero could matter.

use core::hint::black_box;

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Quat, Vec3};

/// Width of a lane: how many vertices one vector operation handles.
pub const LANE_WIDTH: usize = 8;

/// Whether the calling thread has its processor put numbers below [`f32::MIN_POSITIVE`] to zero: as results,
/// as operands, or both. Audio engines switch that on.
#[must_use]
pub fn flushes_to_zero() -> bool {
    // What the compiler knows it computes itself, and it keeps such numbers.
    let smallest = black_box(f32::MIN_POSITIVE);
    let below = black_box(f32::from_bits(f32::MIN_POSITIVE.to_bits() / 2));
    let result = black_box(smallest * 0.5);
    let of_operand = black_box(below * 4.0);
    // Bits, because a comparison would put the number itself to zero.
    result.to_bits() == 0 || of_operand.to_bits() == 0
}

/// Square root, correctly rounded.
#[inline]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Square root in double precision, correctly rounded.
#[inline]
#[must_use]
pub fn sqrt_f64(x: f64) -> f64 {
    libm::sqrt(x)
}

/// Sine of an angle in radians.
#[inline]
#[must_use]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of an angle in radians.
#[inline]
#[must_use]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Sine and cosine of an angle in radians: those of [`sin`] and [`cos`], to the bit.
#[inline]
#[must_use]
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}

/// The angle of the vector (x, y) in radians, in (-pi, pi].
#[inline]
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Sine and cosine of an angle in radians, in double precision.
#[inline]
#[must_use]
pub fn sin_cos_f64(x: f64) -> (f64, f64) {
    (libm::sin(x), libm::cos(x))
}

/// The exponential function.
#[inline]
#[must_use]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Hyperbolic cosine and sine of `x`.
#[inline]
#[must_use]
pub fn cosh_sinh(x: f32) -> (f32, f32) {
    (libm::coshf(x), libm::sinhf(x))
}

/// The smaller of two numbers; `b` when either is not a number.
#[inline]
#[must_use]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers; `b` when either is not a number.
#[inline]
#[must_use]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers in double precision; `b` when either is not a number.
#[inline]
#[must_use]
pub fn min_f64(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers in double precision; `b` when either is not a number.
#[inline]
#[must_use]
pub fn max_f64(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `x` kept between `low` and `high`; `low` when `x` is not a number.
#[inline]
#[must_use]
pub fn clamp(x: f32, low: f32, high: f32) -> f32 {
    min(max(x, low), high)
}

/// Length of a vector.
#[inline]
#[must_use]
pub fn length(v: Vec3) -> f32 {
    sqrt(v.length_squared())
}

/// The unit vector along `v`, or `None` when `v` is too short or too long to have a direction.
#[inline]
#[must_use]
pub fn direction(v: Vec3) -> Option<Vec3> {
    let largest = max(v.x.abs(), max(v.y.abs(), v.z.abs()));
    if !(largest > 1e-30 && largest < 1e30) {
        return None;
    }
    let scaled = v / largest;
    let length = length(scaled);
    // A coordinate that is not a number may hide behind the largest one.
    (length > 0.0).then(|| scaled / length)
}

/// Any unit vector at right angles to the unit vector `n`, continuous except at n.z = 0.
///
/// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
#[inline]
#[must_use]
pub fn perpendicular(n: Vec3) -> Vec3 {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    Vec3::new(
        1.0 + sign * n.x * n.x * a,
        sign * n.x * n.y * a,
        -sign * n.x,
    )
}

/// Where a thing is: orientation then position, 28 bytes, the layout of `XrPosef`.
///
/// The orientation is a unit quaternion (x y z w); the position is in metres.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Pose {
    /// Orientation, x y z w, unit length.
    pub rotation: [f32; 4],
    /// Position in metres.
    pub position: [f32; 3],
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// No rotation, no translation.
    pub const IDENTITY: Self = Self {
        rotation: [0.0, 0.0, 0.0, 1.0],
        position: [0.0; 3],
    };

    /// A pose from a unit quaternion and a position in metres.
    #[inline]
    #[must_use]
    pub const fn new(rotation: Quat, position: Vec3) -> Self {
        Self {
            rotation: [rotation.x, rotation.y, rotation.z, rotation.w],
            position: [position.x, position.y, position.z],
        }
    }

    /// A pose without rotation, position in metres.
    #[inline]
    #[must_use]
    pub const fn at(x: f32, y: f32, z: f32) -> Self {
        Self::new(Quat::IDENTITY, Vec3::new(x, y, z))
    }

    /// The orientation as a quaternion.
    #[inline]
    #[must_use]
    pub const fn quat(&self) -> Quat {
        Quat::from_xyzw(
            self.rotation[0],
            self.rotation[1],
            self.rotation[2],
            self.rotation[3],
        )
    }

    /// The position in metres.
    #[inline]
    #[must_use]
    pub const fn translation(&self) -> Vec3 {
        Vec3::new(self.position[0], self.position[1], self.position[2])
    }

    /// Whether every number is finite.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.quat().is_finite() && self.translation().is_finite()
    }

    /// The pose `inner` seen from where `self` is seen: `self` after `inner`.
    #[inline]
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        let rotation = self.quat();
        Self::new(
            rotation * inner.quat(),
            self.translation() + rotation * inner.translation(),
        )
    }

    /// The pose of `self` seen from `frame`: `frame` then the result is `self`.
    #[inline]
    #[must_use]
    pub fn seen_from(&self, frame: &Self) -> Self {
        let back = frame.quat().conjugate();
        Self::new(
            back * self.quat(),
            back * (self.translation() - frame.translation()),
        )
    }

    /// A point of this pose's frame, in the frame the pose is given in.
    #[inline]
    #[must_use]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.quat() * p + self.translation()
    }

    /// The same orientation at a position moved by `offset` metres.
    #[inline]
    #[must_use]
    pub fn moved(&self, offset: Vec3) -> Self {
        Self::new(self.quat(), self.translation() + offset)
    }

    /// The rotation as a matrix whose columns are the turned axes.
    #[inline]
    #[must_use]
    pub fn matrix(&self) -> Mat3 {
        Mat3::from_quat(self.quat())
    }

    /// The nearest pose with a unit quaternion, or `None` when there is none: a number is not
    /// finite, a coordinate is beyond `reach_m`, or the quaternion's length is outside
    /// 1e-3 to 1e3.
    #[must_use]
    pub fn normalised(&self, reach_m: f32) -> Option<Self> {
        let q = self.quat();
        let length_squared = q.length_squared();
        let p = self.translation();
        let near = p.x.abs() <= reach_m && p.y.abs() <= reach_m && p.z.abs() <= reach_m;
        if !near || !(1e-6..=1e6).contains(&length_squared) {
            return None;
        }
        if (length_squared - 1.0).abs() <= 4.0 * f32::EPSILON {
            return Some(*self);
        }
        Some(Self::new(renormalised(q), p))
    }
}

/// The quaternion scaled to unit length.
#[inline]
#[must_use]
pub fn renormalised(q: Quat) -> Quat {
    let scale = 1.0 / sqrt(q.length_squared());
    Quat::from_xyzw(q.x * scale, q.y * scale, q.z * scale, q.w * scale)
}

/// `q` or its negative, whichever lies in the half-space of `reference`.
#[inline]
#[must_use]
pub fn nearer_sign(q: Quat, reference: Quat) -> Quat {
    if q.dot(reference) < 0.0 { -q } else { q }
}

/// The rotation vector (axis times angle in radians, at most pi) of a unit quaternion.
#[must_use]
pub fn rotation_vector(q: Quat) -> Vec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let axis = Vec3::new(q.x, q.y, q.z);
    let sine = length(axis);
    if sine < 1e-6 {
        return 2.0 * axis;
    }
    axis * (2.0 * atan2(sine, q.w) / sine)
}

/// The unit quaternion of a rotation vector (axis times angle in radians).
#[must_use]
pub fn quat_from_rotation_vector(r: Vec3) -> Quat {
    let angle = length(r);
    if angle < 1e-6 {
        return renormalised(Quat::from_xyzw(0.5 * r.x, 0.5 * r.y, 0.5 * r.z, 1.0));
    }
    let s = sin(0.5 * angle) / angle;
    Quat::from_xyzw(r.x * s, r.y * s, r.z * s, cos(0.5 * angle))
}

/// The smaller of each coordinate; the sign of zero is that of `b`.
#[inline]
#[must_use]
pub fn min_each(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z))
}

/// The larger of each coordinate; the sign of zero is that of `b`.
#[inline]
#[must_use]
pub fn max_each(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z))
}

/// How far `pose` is from `target`: an offset in metres and a rotation vector in the world, which is
/// exactly zero where the rotations are equal.
#[must_use]
pub fn displacement_of(target: &Pose, pose: &Pose) -> (Vec3, Vec3) {
    let offset = pose.translation() - target.translation();
    let rotation = if pose.rotation == target.rotation {
        Vec3::ZERO
    } else {
        rotation_vector(pose.quat() * target.quat().conjugate())
    };
    (offset, rotation)
}
