//! The point of a simplex that is nearest the origin: the step of Gilbert, Johnson and Keerthi 1988,
//! by the regions that the newest vertex leaves possible (van den Bergen 2003; Ericson 2005, chapter 9).
//!
//! Everything is f64 on vertices whose coordinates are f32 or turned f32: degenerate simplices do no
//! harm, because a corner that does not lead nearer ends the search.

use glam::DVec3;

use super::difference::Corner;

/// A triangle counts as a segment when its area is at most this part of the product of two sides.
const FLAT_SQUARED: f64 = 1e-24;

/// Up to four corners, the newest last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex {
    corners: [Corner; 4],
    count: usize,
}

/// A sub-simplex and its point nearest the origin.
///
/// The point is told by its direction and distance: neither needs a division or a root before the
/// next corner can be asked for.
pub(crate) struct Nearest {
    /// From the origin toward the point, of any length.
    pub direction: DVec3,
    /// Squared distance of the point.
    pub squared: f64,
    /// Places of the corners, ascending.
    places: [u8; 3],
    count: u8,
}

impl Simplex {
    #[inline]
    pub(crate) fn new(corner: Corner) -> Self {
        Self {
            corners: [corner; 4],
            count: 1,
        }
    }

    #[inline]
    pub(crate) fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    #[inline]
    pub(crate) fn holds(&self, corner: &Corner) -> bool {
        self.corners().iter().any(|held| held.is_same(corner))
    }

    /// Adds a corner to at most three.
    #[inline]
    pub(crate) fn push(&mut self, corner: Corner) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    /// Takes the newest corner out again.
    #[inline]
    pub(crate) fn pop(&mut self) {
        self.count -= 1;
    }

    /// The smallest sub-simplex that holds the point nearest the origin; `None` if the origin is inside
    /// four corners.
    #[inline]
    pub(crate) fn nearest(&self) -> Option<Nearest> {
        match self.count {
            1 => Some(self.point(0)),
            2 => Some(self.segment(0, 1)),
            3 => Some(self.triangle(0, 1, 2, None)),
            _ => self.tetrahedron(),
        }
    }

    /// As [`Simplex::nearest`], for up to three corners of which the last need not be the newest.
    pub(crate) fn nearest_of_any(&self) -> Option<Nearest> {
        if self.count < 3 {
            return self.nearest();
        }
        let [p, q, r] = [0, 1, 2].map(|i| self.corners[i].at);
        if barycentric(p, q, r).iter().all(|&weight| weight >= 0.0) {
            return self.nearest();
        }
        let mut best = self.segment(0, 1);
        for older in [0, 1] {
            let found = self.segment(older, 2);
            if found.squared < best.squared {
                best = found;
            }
        }
        Some(best)
    }

    /// Keeps a sub-simplex only.
    #[inline]
    pub(crate) fn keep(&mut self, nearest: &Nearest) {
        // The places ascend, so none is overwritten before it is taken.
        for slot in 0..usize::from(nearest.count) {
            self.corners[slot] = self.corners[usize::from(nearest.places[slot])];
        }
        self.count = nearest.count.into();
    }

    fn point(&self, place: usize) -> Nearest {
        let at = self.corners[place].at;
        Nearest {
            direction: at,
            squared: at.length_squared(),
            places: [place as u8, 0, 0],
            count: 1,
        }
    }

    /// The newest corner and one other.
    #[inline]
    fn segment(&self, older: usize, newest: usize) -> Nearest {
        let q = self.corners[newest].at;
        let along = self.corners[older].at - q;
        let (part, span) = (-q.dot(along), along.length_squared());
        if part <= 0.0 {
            return self.point(newest);
        }
        if part >= span {
            return self.point(older);
        }
        let direction = q * span + along * part;
        Nearest {
            direction,
            squared: direction.length_squared() / (span * span),
            places: [older as u8, newest as u8, 0],
            count: 2,
        }
    }

    /// The newest corner and two others; `normal` is (first - newest) x (second - newest) if known.
    #[inline]
    fn triangle(
        &self,
        first: usize,
        second: usize,
        newest: usize,
        normal: Option<DVec3>,
    ) -> Nearest {
        let corner = self.corners[newest].at;
        let u = self.corners[first].at - corner;
        let v = self.corners[second].at - corner;
        let normal = normal.unwrap_or_else(|| u.cross(v));
        let area = normal.length_squared();
        let flat = area <= FLAT_SQUARED * u.length_squared() * v.length_squared();
        let beyond_u = u.cross(normal).dot(corner) < 0.0;
        let beyond_v = normal.cross(v).dot(corner) < 0.0;
        if !(flat || beyond_u || beyond_v) {
            let height = normal.dot(corner);
            return Nearest {
                direction: if height < 0.0 { -normal } else { normal },
                squared: height * height / area,
                places: [first as u8, second as u8, newest as u8],
                count: 3,
            };
        }
        match (beyond_u, beyond_v) {
            (true, false) if !flat && u.dot(corner) < 0.0 => self.segment(first, newest),
            (false, true) if !flat && v.dot(corner) < 0.0 => self.segment(second, newest),
            _ => {
                let (on_u, on_v) = (self.segment(first, newest), self.segment(second, newest));
                if on_v.squared < on_u.squared {
                    on_v
                } else {
                    on_u
                }
            }
        }
    }

    /// Four corners. The origin is on the inner side of the face without the newest.
    fn tetrahedron(&self) -> Option<Nearest> {
        let corner = self.corners[3].at;
        let [u, v, w] = [0, 1, 2].map(|i| self.corners[i].at - corner);
        let sides = [
            (0, 1, u.cross(v), w),
            (1, 2, v.cross(w), u),
            (0, 2, u.cross(w), v),
        ];
        let mut best: Option<Nearest> = None;
        for (first, second, normal, opposite) in sides {
            let inner = normal.dot(opposite);
            if normal.dot(corner) * inner < 0.0 {
                continue;
            }
            let found = self.triangle(first, second, 3, Some(normal));
            if best
                .as_ref()
                .is_none_or(|best| found.squared < best.squared)
            {
                best = Some(found);
            }
        }
        best
    }

    /// The weights with which the corners make up the point nearest the origin; for four corners with
    /// the origin inside, equal ones.
    pub(crate) fn weights(&self) -> [f64; 4] {
        let p = |i: usize| self.corners[i].at;
        match self.count {
            1 => [1.0, 0.0, 0.0, 0.0],
            2 => {
                let along = p(0) - p(1);
                let share = -p(1).dot(along) / along.length_squared();
                [share, 1.0 - share, 0.0, 0.0]
            }
            3 => {
                let [first, second, last] = barycentric(p(0), p(1), p(2));
                [first, second, last, 0.0]
            }
            _ => [0.25; 4],
        }
    }
}

/// Barycentric coordinates of the foot of the origin on the plane of a triangle (Ericson 2005,
/// section 3.4).
pub(crate) fn barycentric(p: DVec3, q: DVec3, r: DVec3) -> [f64; 3] {
    let (u, v) = (p - r, q - r);
    let normal = u.cross(v);
    let area = normal.length_squared();
    let first = v.cross(r).dot(normal) / area;
    let second = r.cross(u).dot(normal) / area;
    [first, second, 1.0 - first - second]
}
