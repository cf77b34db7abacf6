//! Vectors in double precision, for what is computed once when a piece is made.

use glam::Vec3;

use crate::math::sqrt_f64;

/// Three numbers in double precision.
pub(crate) type Vec3d = [f64; 3];

#[inline]
pub(crate) fn from_vec3(v: Vec3) -> Vec3d {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

#[inline]
pub(crate) fn from_array(v: [f32; 3]) -> Vec3d {
    [f64::from(v[0]), f64::from(v[1]), f64::from(v[2])]
}

/// The nearest vector in single precision; a negative zero becomes positive.
#[inline]
pub(crate) fn to_vec3(v: Vec3d) -> Vec3 {
    Vec3::new(
        (v[0] + 0.0) as f32,
        (v[1] + 0.0) as f32,
        (v[2] + 0.0) as f32,
    )
}

#[inline]
pub(crate) fn add(a: Vec3d, b: Vec3d) -> Vec3d {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(crate) fn sub(a: Vec3d, b: Vec3d) -> Vec3d {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn scale(a: Vec3d, s: f64) -> Vec3d {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline]
pub(crate) fn dot(a: Vec3d, b: Vec3d) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Vec3d, b: Vec3d) -> Vec3d {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
pub(crate) fn length(a: Vec3d) -> f64 {
    sqrt_f64(dot(a, a))
}

/// The unit vector along `a`, or zero when `a` is zero.
#[inline]
pub(crate) fn unit(a: Vec3d) -> Vec3d {
    let length = length(a);
    if length > 0.0 {
        scale(a, 1.0 / length)
    } else {
        [0.0; 3]
    }
}
