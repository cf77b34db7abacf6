//! Links that the host put into each other by less than is promised.

use palpable::math::Pose;
use palpable::memory::PieceId;

use crate::overlap::{Class, Overlap};

/// A pair of links of one body that the host put into each other, and how deep.
#[derive(Clone, Copy, Debug)]
struct Pair {
    pieces: [PieceId; 2],
    depth_m: f64,
}

/// All of them. The kernel leaves them as they are in the body's frame; where the body goes, the poses in the world
/// are rounded anew.
#[derive(Clone, Debug, Default)]
pub struct Put {
    pairs: Vec<Pair>,
}

impl Put {
    /// Takes up pairs that are deeper after the host's calls than the frame before them left them. Those that are
    /// deeper than promised are not of this kind.
    pub fn note(&mut self, left: &[Overlap], now: &[Overlap]) {
        self.keep(now);
        for overlap in now.iter().filter(|o| o.class == Class::Links) {
            let before = left.iter().find(|o| o.pieces == overlap.pieces);
            if before.is_some_and(|before| before.depth_m >= overlap.depth_m) {
                continue;
            }
            self.pairs.retain(|pair| pair.pieces != overlap.pieces);
            if overlap.depth_m <= overlap.class.limit_m() {
                self.pairs.push(Pair {
                    pieces: overlap.pieces,
                    depth_m: overlap.depth_m,
                });
            }
        }
    }

    /// Whether a pair is one of them.
    #[must_use]
    pub fn has(&self, pieces: [PieceId; 2]) -> bool {
        self.pairs.iter().any(|pair| pair.pieces == pieces)
    }

    /// Forgets pairs that overlap no more.
    pub fn keep(&mut self, found: &[Overlap]) {
        let overlaps = |pair: &Pair| found.iter().any(|overlap| overlap.pieces == pair.pieces);
        self.pairs.retain(overlaps);
    }

    /// The most that a pair may show, in metres: what is promised, or as deep as the host put it with what rounding
    /// the two pieces' positions may do, then and now.
    #[must_use]
    pub fn most_m(&self, overlap: &Overlap, poses: &[Pose]) -> Option<f64> {
        let limit_m = overlap.class.limit_m();
        let mut pairs = self.pairs.iter();
        let pair = pairs.find(|pair| pair.pieces == overlap.pieces)?;
        let rounding = overlap.pieces.map(|piece| {
            let at = poses[piece.index1 as usize - 1].position;
            let half = at.map(|x| 0.5 * f64::from(x.abs().next_up() - x.abs()));
            half.iter().map(|x| x * x).sum::<f64>().sqrt()
        });
        Some(limit_m.max(pair.depth_m + 2.0 * (rounding[0] + rounding[1])))
    }
}

#[cfg(test)]
mod tests {
    use palpable::math::Pose;
    use palpable::memory::PieceId;

    use super::Put;
    use crate::overlap::{Class, Overlap};

    fn overlap(depth_m: f64) -> Overlap {
        let piece = |index1| PieceId {
            index1,
            generation: 1,
        };
        Overlap {
            pieces: [piece(1), piece(2)],
            places: [0, 1],
            class: Class::Links,
            depth_m,
        }
    }

    #[test]
    fn nothing_but_rounding_is_allowed_beyond_what_the_host_did() {
        let far = [Pose::at(880.0, 1.0, 0.0), Pose::at(880.1, 1.0, 0.0)];
        let near = [Pose::IDENTITY, Pose::at(0.1, 0.0, 0.0)];
        let mut put = Put::default();
        assert_eq!(put.most_m(&overlap(0.995e-3), &far), None);
        put.note(&[], &[overlap(0.995e-3)]);
        // Half of 2^-14 m along one axis, twice for each piece.
        let most_m = put.most_m(&overlap(1.1e-3), &far).unwrap();
        assert!((most_m - 0.995e-3 - 2.0 * 2.0_f64.powi(-14)).abs() < 1e-6);
        assert_eq!(put.most_m(&overlap(1.1e-3), &near), Some(1e-3));
        // What the frame left and nobody touched is nobody's but the kernel's.
        let mut put = Put::default();
        put.note(&[overlap(0.9e-3)], &[overlap(0.9e-3)]);
        assert_eq!(put.most_m(&overlap(0.9e-3), &far), None);
        put.note(&[overlap(0.9e-3)], &[overlap(0.95e-3)]);
        put.keep(&[overlap(0.2e-3)]);
        assert!(put.most_m(&overlap(0.9e-3), &far).is_some());
        assert!(put.has(overlap(0.0).pieces));
        put.note(&[overlap(0.2e-3)], &[overlap(1.2e-3)]);
        assert!(!put.has(overlap(0.0).pieces));
        put.note(&[], &[overlap(0.2e-3)]);
        put.keep(&[]);
        assert_eq!(put.most_m(&overlap(0.9e-3), &far), None);
    }
}
