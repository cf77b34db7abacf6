//! Points on an integer grid as fine as the hull's size allows, so that every predicate is exact.
//!
//! The bounding box is centred and scaled by a power of two until its largest half extent lies in
//! [2^28, 2^29) cells. Then with differences below 2^30 and cross products below 2^61
//! everything up to a plane's normal fits i64, and a signed volume (below 2^93) fits i128. One cell
//! is at most 2^-28 of the half extent, sixteen times finer than f32 resolves there.

use arrayvec::ArrayVec;

use super::HullError;
use crate::geometry::double::{self, Vec3d};
use crate::limits::{PIECE_REACH_M, PIECE_VERTICES_MAX};

/// A point, or a difference of two, in cells.
pub(super) type Cell = [i64; 3];

const HALF_EXTENT_BITS: u64 = 28;
const DIFFERENCE_BITS: u32 = HALF_EXTENT_BITS as u32 + 2;
const _: () = assert!(2 * DIFFERENCE_BITS + 1 < i64::BITS - 1);
const _: () = assert!(3 * DIFFERENCE_BITS + 3 < i128::BITS - 1);

#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub cells: ArrayVec<Cell, PIECE_VERTICES_MAX>,
    /// Diagonal of the bounding box, in cells.
    pub size: f64,
    /// Diagonal of the bounding box, in metres.
    pub size_m: f64,
}

impl Grid {
    pub const fn new() -> Self {
        Self {
            cells: ArrayVec::new_const(),
            size: 0.0,
            size_m: 0.0,
        }
    }

    /// Puts the points on the grid.
    pub fn fill(&mut self, points: &[[f32; 3]], size_m_min: f64) -> Result<(), HullError> {
        check(points)?;
        let (centre, half) = bounds(points);
        self.size_m = 2.0 * double::length(half);
        if self.size_m < size_m_min {
            return Err(HullError::Degenerate);
        }
        let cells_per_m = cells_per_metre(half);
        self.size = self.size_m * cells_per_m;
        self.cells.clear();
        for &p in points {
            let offset = double::sub(double::from_array(p), centre);
            self.cells.push(offset.map(|x| round(x * cells_per_m)));
        }
        Ok(())
    }
}

fn check(points: &[[f32; 3]]) -> Result<(), HullError> {
    if points.len() > PIECE_VERTICES_MAX {
        return Err(HullError::TooMany);
    }
    if points.as_flattened().iter().any(|x| !x.is_finite()) {
        return Err(HullError::NotFinite);
    }
    let far = |x: &f32| x.abs() > PIECE_REACH_M;
    if points.as_flattened().iter().any(far) {
        return Err(HullError::TooLarge);
    }
    if points.len() < 4 {
        return Err(HullError::TooFew);
    }
    Ok(())
}

/// Centre and half extents of the bounding box.
pub(super) fn bounds(points: &[[f32; 3]]) -> (Vec3d, Vec3d) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for &p in points {
        let p = double::from_array(p);
        for axis in 0..3 {
            low[axis] = if p[axis] < low[axis] {
                p[axis]
            } else {
                low[axis]
            };
            high[axis] = if p[axis] > high[axis] {
                p[axis]
            } else {
                high[axis]
            };
        }
    }
    let centre = double::scale(double::add(low, high), 0.5);
    (centre, double::scale(double::sub(high, low), 0.5))
}

/// The power of two that brings the largest half extent into [2^28, 2^29).
fn cells_per_metre(half: Vec3d) -> f64 {
    let larger = if half[0] > half[1] { half[0] } else { half[1] };
    let largest = if larger > half[2] { larger } else { half[2] };
    let biased_exponent = largest.to_bits() >> 52;
    f64::from_bits((2 * 1023 + HALF_EXTENT_BITS - biased_exponent) << 52)
}

fn round(x: f64) -> i64 {
    let half = if x < 0.0 { -0.5 } else { 0.5 };
    (x + half) as i64
}

#[inline]
pub(super) fn sub(a: Cell, b: Cell) -> Cell {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(super) fn cross(a: Cell, b: Cell) -> Cell {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
pub(super) fn dot(a: Cell, b: Cell) -> i128 {
    i128::from(a[0]) * i128::from(b[0])
        + i128::from(a[1]) * i128::from(b[1])
        + i128::from(a[2]) * i128::from(b[2])
}

#[inline]
pub(super) fn to_double(a: Cell) -> Vec3d {
    [a[0] as f64, a[1] as f64, a[2] as f64]
}
