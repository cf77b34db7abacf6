//! What one answer about a pair leaves for the next: where the search ended.
//!
//! It is never an answer itself. Every plane and every distance is computed again at the new poses,
//! from the pieces' own vertices, so a start that no longer fits costs time and changes nothing.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};

use super::difference::{Corner, Difference};

/// Most corners that are remembered; an answer that took more is begun afresh next time.
pub(crate) const WARM_CORNERS_MAX: usize = 24;

/// Most facets: a closed surface of triangles with V corners has 2 V - 4 (Euler).
pub(crate) const WARM_FACETS_MAX: usize = 2 * WARM_CORNERS_MAX - 4;

/// The nearest feature that the last search about a pair of pieces found; all zero when there was
/// none. Plain data of 16 bytes, enough while the cores are apart.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct WarmFeature {
    /// Vertices of A and B.
    corners: [[u16; 2]; 3],
    count: u16,
    padding: u16,
}

impl WarmFeature {
    /// Nothing remembered.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Remembers up to three corners.
    pub(crate) fn remember(&mut self, corners: &[Corner]) {
        self.count = 0;
        for (place, corner) in self.corners.iter_mut().zip(corners) {
            *place = [corner.vertex_a, corner.vertex_b];
            self.count += 1;
        }
    }

    /// The corners at the poses of `pair`; nothing if a vertex does not exist.
    pub(crate) fn corners(&self, pair: &Difference) -> Option<ArrayVec<Corner, 3>> {
        let known = self.corners.iter().take(self.count.into());
        let corners: Option<ArrayVec<Corner, 3>> =
            known.map(|&place| corner(pair, place)).collect();
        corners.filter(|corners| !corners.is_empty())
    }
}

/// The corner of two vertices, if there are such.
fn corner(pair: &Difference, [a, b]: [u16; 2]) -> Option<Corner> {
    let (a, b) = (usize::from(a), usize::from(b));
    let exist = a < pair.a.vertex_count && b < pair.b.vertex_count;
    exist.then(|| pair.corner(a, b))
}

/// Where the last search about a pair of pieces ended; all zero when there was none.
///
/// Plain data of 248 bytes: keep one for every pair that is asked about again and again. It fits the
/// pair in the order it was asked in; for other pieces it is useless and harmless.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct WarmStart {
    /// The nearest feature.
    pub feature: WarmFeature,
    /// Vertices of A and B that the facets are made of.
    corners: [[u16; 2]; WARM_CORNERS_MAX],
    /// Triangles of corners around the origin when the cores overlapped.
    facets: [[u8; 3]; WARM_FACETS_MAX],
    corner_count: u8,
    facet_count: u8,
    padding: [u8; 2],
}

impl Default for WarmStart {
    fn default() -> Self {
        Self::zeroed()
    }
}

impl WarmStart {
    /// Nothing remembered.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets the surface around the origin.
    pub(crate) fn forget_surface(&mut self) {
        self.corner_count = 0;
        self.facet_count = 0;
    }

    /// Remembers a corner of the surface and returns its place; `None` when there is no room.
    pub(crate) fn remember_corner(&mut self, corner: &Corner) -> Option<u8> {
        let place = self.corner_count;
        *self.corners.get_mut(usize::from(place))? = [corner.vertex_a, corner.vertex_b];
        self.corner_count += 1;
        Some(place)
    }

    /// Remembers a facet; `None` when there is no room.
    pub(crate) fn remember_facet(&mut self, corners: [u8; 3]) -> Option<()> {
        *self.facets.get_mut(usize::from(self.facet_count))? = corners;
        self.facet_count += 1;
        Some(())
    }

    /// The surface's corners at the poses of `pair`; nothing where a vertex does not exist.
    pub(crate) fn corners<'s>(
        &'s self,
        pair: &'s Difference,
    ) -> impl Iterator<Item = Option<Corner>> + 's {
        let known = &self.corners[..usize::from(self.corner_count)];
        known.iter().map(|&place| corner(pair, place))
    }

    /// The facets; none when the cores were apart.
    pub(crate) fn facets(&self) -> &[[u8; 3]] {
        &self.facets[..usize::from(self.facet_count)]
    }
}
