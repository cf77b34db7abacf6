//! What one answer about a pair leaves for the next: where the search ended.
//!
//! It is never an answer itself. Every plane and every distance is computed again at the new poses,
//! from the pieces' own vertices, so a start that no longer fits costs time and changes nothing.

use bytemuck::{Pod, Zeroable};

use super::difference::{Corner, Difference};

/// Most corners that are remembered; an answer that took more is begun afresh next time.
pub(crate) const WARM_CORNERS_MAX: usize = 24;

/// Most facets: a closed surface of triangles with V corners has 2 V - 4 (Euler).
pub(crate) const WARM_FACETS_MAX: usize = 2 * WARM_CORNERS_MAX - 4;

/// Where the last search about a pair of pieces ended; all zero when there was none.
///
/// Plain data of 232 bytes: keep one for every pair that is asked about again and again. It fits the
/// pair in the order it was asked in; for other pieces it is useless and harmless.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct WarmStart {
    /// Vertices of A and B; those of the nearest feature first.
    corners: [[u16; 2]; WARM_CORNERS_MAX],
    /// Triangles of corners around the origin when the cores overlapped.
    facets: [[u8; 3]; WARM_FACETS_MAX],
    corner_count: u8,
    facet_count: u8,
    /// How many of the corners make up the nearest feature.
    nearest_count: u8,
    padding: u8,
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

    pub(crate) fn forget(&mut self) {
        self.corner_count = 0;
        self.facet_count = 0;
        self.nearest_count = 0;
    }

    /// Forgets the surface, but not the nearest feature.
    pub(crate) fn forget_facets(&mut self) {
        self.corner_count = self.nearest_count;
        self.facet_count = 0;
    }

    pub(crate) fn corner_count(&self) -> u8 {
        self.corner_count
    }

    /// Remembers a corner; false when there is no room.
    pub(crate) fn remember(&mut self, corner: &Corner) -> bool {
        let place = usize::from(self.corner_count);
        if place == WARM_CORNERS_MAX {
            return false;
        }
        self.corners[place] = [corner.vertex_a, corner.vertex_b];
        self.corner_count += 1;
        true
    }

    /// Marks the corners remembered so far as those of the nearest feature.
    pub(crate) fn mark_nearest(&mut self) {
        self.nearest_count = self.corner_count;
    }

    /// Remembers a facet; false when there is no room.
    pub(crate) fn remember_facet(&mut self, corners: [u8; 3]) -> bool {
        let place = usize::from(self.facet_count);
        if place == WARM_FACETS_MAX {
            return false;
        }
        self.facets[place] = corners;
        self.facet_count += 1;
        true
    }

    /// The corners at the poses of `pair`; nothing if a vertex does not exist.
    pub(crate) fn corners<'s>(
        &'s self,
        pair: &'s Difference,
    ) -> impl Iterator<Item = Option<Corner>> + 's {
        let known = &self.corners[..usize::from(self.corner_count)];
        known.iter().map(|&[a, b]| {
            let (a, b) = (usize::from(a), usize::from(b));
            let exist = a < pair.a.vertex_count && b < pair.b.vertex_count;
            exist.then(|| pair.corner(a, b))
        })
    }

    /// How many corners make up the nearest feature: at most three.
    pub(crate) fn nearest_count(&self) -> usize {
        usize::from(self.nearest_count)
    }

    /// The facets; none when the cores were apart.
    pub(crate) fn facets(&self) -> &[[u8; 3]] {
        &self.facets[..usize::from(self.facet_count)]
    }
}
