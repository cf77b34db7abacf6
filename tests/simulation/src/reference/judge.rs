//! The deepest overlap in a scene, frame by frame.

use super::{Placed, Pose, Solid, overlap_depth};
use std::sync::Arc;

/// Pieces of a scene, added once, and the overlaps between them at the poses of a frame.
///
/// Pieces of one group are never measured against each other, nor are two fixed pieces.
#[derive(Debug, Default)]
pub struct Judge {
    pieces: Vec<Piece>,
    moving: Vec<usize>,
    fixed: Vec<Fixed>,
}

#[derive(Debug)]
struct Piece {
    solid: Arc<Solid>,
    group: u32,
    category: String,
    name: String,
}

#[derive(Debug)]
struct Fixed {
    piece: usize,
    pose: Pose,
    bounds: Bounds,
}

type Bounds = [glam::DVec3; 2];

struct Moved<'a> {
    piece: usize,
    group: u32,
    placed: Placed<'a>,
    bounds: Bounds,
}

/// Two pieces, by the numbers that [`Judge`] gave them, and how deep they overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Penetration depth in metres, above zero.
    pub depth_m: f64,
    /// The pieces' numbers, smaller first.
    pub pieces: [usize; 2],
}

/// The overlaps of one frame, or the deepest of several.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// The deepest of all.
    pub deepest: Option<Overlap>,
    /// The deepest per pair of categories that overlap at all; names in alphabetical order.
    pub by_category: Vec<([String; 2], Overlap)>,
    /// Pairs whose boxes met and which were measured.
    pub pairs_measured: usize,
}

impl Judge {
    /// A judge without pieces.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a piece that stays at `pose` and returns its number.
    pub fn add_fixed(
        &mut self,
        solid: impl Into<Arc<Solid>>,
        group: u32,
        category: &str,
        name: &str,
        pose: Pose,
    ) -> usize {
        let piece = self.add(solid.into(), group, category, name);
        let bounds = Placed::at(&self.pieces[piece].solid, pose).bounds();
        self.fixed.push(Fixed {
            piece,
            pose,
            bounds,
        });
        piece
    }

    /// Adds a piece that moves and returns its number. Frames list the poses of moving pieces in
    /// the order in which these were added.
    pub fn add_moving(
        &mut self,
        solid: impl Into<Arc<Solid>>,
        group: u32,
        category: &str,
        name: &str,
    ) -> usize {
        let piece = self.add(solid.into(), group, category, name);
        self.moving.push(piece);
        piece
    }

    fn add(&mut self, solid: Arc<Solid>, group: u32, category: &str, name: &str) -> usize {
        let (category, name) = (category.to_owned(), name.to_owned());
        self.pieces.push(Piece {
            solid,
            group,
            category,
            name,
        });
        self.pieces.len() - 1
    }

    /// The piece's name.
    pub fn name(&self, piece: usize) -> &str {
        &self.pieces[piece].name
    }

    /// The piece's category.
    pub fn category(&self, piece: usize) -> &str {
        &self.pieces[piece].category
    }

    /// How many poses a frame needs.
    pub fn moving_count(&self) -> usize {
        self.moving.len()
    }

    /// The overlaps with the moving pieces at `poses`.
    ///
    /// # Panics
    /// If the number of poses is not that of the moving pieces.
    pub fn frame(&self, poses: &[Pose]) -> Verdict {
        assert_eq!(poses.len(), self.moving.len(), "one pose per moving piece");
        let moved = self.moved(poses);
        let mut verdict = Verdict::default();
        for (i, one) in moved.iter().enumerate() {
            self.against_fixed(one, &mut verdict);
            for other in &moved[i + 1..] {
                if one.group != other.group && meet(&one.bounds, &other.bounds) {
                    self.measure(
                        [one.piece, other.piece],
                        [&one.placed, &other.placed],
                        &mut verdict,
                    );
                }
            }
        }
        verdict
    }

    fn moved(&self, poses: &[Pose]) -> Vec<Moved<'_>> {
        let place = |(&piece, &pose): (&usize, &Pose)| {
            let placed = Placed::at(&self.pieces[piece].solid, pose);
            Moved {
                piece,
                group: self.pieces[piece].group,
                placed,
                bounds: placed.bounds(),
            }
        };
        self.moving.iter().zip(poses).map(place).collect()
    }

    fn against_fixed(&self, one: &Moved, verdict: &mut Verdict) {
        for fixed in self
            .fixed
            .iter()
            .filter(|fixed| meet(&one.bounds, &fixed.bounds))
        {
            let piece = &self.pieces[fixed.piece];
            if piece.group != one.group {
                let placed = Placed::at(&piece.solid, fixed.pose);
                self.measure([one.piece, fixed.piece], [&one.placed, &placed], verdict);
            }
        }
    }

    fn measure(&self, pieces: [usize; 2], placed: [&Placed; 2], verdict: &mut Verdict) {
        verdict.pairs_measured += 1;
        let depth_m = overlap_depth(placed[0], placed[1]);
        if depth_m > 0.0 {
            let pieces = [pieces[0].min(pieces[1]), pieces[0].max(pieces[1])];
            let categories = ordered(pieces.map(|p| self.category(p)));
            verdict.note(categories, Overlap { depth_m, pieces });
        }
    }
}

impl Verdict {
    /// The deepest overlap between two categories, in metres; zero if they do not overlap.
    pub fn depth_between(&self, one: &str, other: &str) -> f64 {
        let key = ordered([one, other]);
        let found = self.by_category.iter().find(|(names, _)| same(names, key));
        found.map_or(0.0, |(_, overlap)| overlap.depth_m)
    }

    /// Keeps the deeper of both, overall and per pair of categories, and adds up the counts.
    pub fn absorb(&mut self, other: &Self) {
        self.pairs_measured += other.pairs_measured;
        for (names, overlap) in &other.by_category {
            self.note([&names[0], &names[1]], *overlap);
        }
    }

    fn note(&mut self, categories: [&str; 2], overlap: Overlap) {
        if self
            .deepest
            .is_none_or(|deepest| overlap.depth_m > deepest.depth_m)
        {
            self.deepest = Some(overlap);
        }
        match self
            .by_category
            .iter_mut()
            .find(|(names, _)| same(names, categories))
        {
            Some((_, deepest)) if overlap.depth_m <= deepest.depth_m => {}
            Some((_, deepest)) => *deepest = overlap,
            None => self
                .by_category
                .push((categories.map(str::to_owned), overlap)),
        }
    }
}

fn ordered([one, other]: [&str; 2]) -> [&str; 2] {
    if one <= other {
        [one, other]
    } else {
        [other, one]
    }
}

fn same(names: &[String; 2], key: [&str; 2]) -> bool {
    names[0] == key[0] && names[1] == key[1]
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all()
}
