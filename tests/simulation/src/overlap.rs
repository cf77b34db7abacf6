//! How deep pieces overlap in f64, and which of it the host made.

use glam::{DMat3, DQuat, DVec3};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::PieceId;
use palpable::state::bodies::BodyKind;

use crate::cast::{Cast, PieceOf};
use crate::reference::{Placed, overlap_depth};

/// What a pair of pieces is, for the overlap that it may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// A driven piece and a fixed one: promise P1.
    DrivenFixed,
    /// Pieces of two driven bodies.
    DrivenDriven,
    /// Links of one body that keep out of each other.
    Links,
    /// A dynamic piece and a fixed one.
    DynamicFixed,
    /// Two dynamic pieces.
    DynamicDynamic,
    /// A dynamic piece and a driven one.
    DynamicDriven,
    /// A piece of the host's own engine and a driven or dynamic one.
    Hosted,
}

impl Class {
    /// How many there are.
    pub const COUNT: usize = 7;

    /// All, in the order of their numbers.
    pub const ALL: [Self; Self::COUNT] = [
        Self::DrivenFixed,
        Self::DrivenDriven,
        Self::Links,
        Self::DynamicFixed,
        Self::DynamicDynamic,
        Self::DynamicDriven,
        Self::Hosted,
    ];

    /// As a person reads it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DrivenFixed => "driven in fixed",
            Self::DrivenDriven => "driven in driven",
            Self::Links => "links of one body",
            Self::DynamicFixed => "dynamic in fixed",
            Self::DynamicDynamic => "dynamic in dynamic",
            Self::DynamicDriven => "dynamic in driven",
            Self::Hosted => "hosted in driven or dynamic",
        }
    }

    /// The overlap that is promised not to be exceeded, in metres.
    #[must_use]
    pub fn limit_m(self) -> f64 {
        match self {
            Self::DrivenFixed => f64::from(OVERLAP_SLOP_M),
            _ => 1e-3,
        }
    }

    /// The class of two pieces; nothing for those that may overlap as they like.
    fn of(cast: &Cast, a: &PieceOf, b: &PieceOf) -> Option<Self> {
        use BodyKind::{Driven, Dynamic, Fixed, Hosted};
        if a.body == b.body && a.kind != Driven {
            return None;
        }
        match (a.kind, b.kind) {
            (Driven, Fixed) | (Fixed, Driven) => Some(Self::DrivenFixed),
            (Driven, Driven) => cast.keep_out(a, b).then_some(if a.body == b.body {
                Self::Links
            } else {
                Self::DrivenDriven
            }),
            (Dynamic, Fixed) | (Fixed, Dynamic) => Some(Self::DynamicFixed),
            (Dynamic, Dynamic) => Some(Self::DynamicDynamic),
            (Dynamic, Driven) | (Driven, Dynamic) => Some(Self::DynamicDriven),
            (Hosted, Driven | Dynamic) | (Driven | Dynamic, Hosted) => Some(Self::Hosted),
            _ => None,
        }
    }
}

/// A pair of pieces that overlap.
#[derive(Clone, Copy, Debug)]
pub struct Overlap {
    /// The pieces, in the order they were added.
    pub pieces: [PieceId; 2],
    /// Their places among the pieces of the cast.
    pub places: [usize; 2],
    /// What they are.
    pub class: Class,
    /// How deep, in metres.
    pub depth_m: f64,
}

/// Where a piece was judged last.
#[derive(Clone, Copy, Debug)]
struct Seat {
    pose: Pose,
    rotation: DMat3,
    position: DVec3,
    bounds: [DVec3; 2],
    /// Whether it is elsewhere than when it was judged before.
    moved: bool,
}

impl Seat {
    fn at(piece: &PieceOf, pose: &Pose) -> Self {
        let turn = DQuat::from_array(pose.rotation.map(f64::from)).normalize();
        let rotation = DMat3::from_quat(turn);
        let position = DVec3::from_array(pose.position.map(f64::from));
        let bounds = Placed::turned(&piece.solid, rotation, position).bounds();
        Self {
            pose: *pose,
            rotation,
            position,
            bounds,
            moved: true,
        }
    }

    fn placed<'p>(&self, piece: &'p PieceOf) -> Placed<'p> {
        Placed::turned(&piece.solid, self.rotation, self.position)
    }
}

fn meet(a: &[DVec3; 2], b: &[DVec3; 2]) -> bool {
    a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all()
}

/// Measures overlaps; pairs of which neither piece moved are not measured again.
#[derive(Clone, Debug, Default)]
pub struct Overlaps {
    seats: Vec<Seat>,
    /// Overlaps deeper than nothing, as last measured.
    found: Vec<Overlap>,
}

impl Overlaps {
    /// Measures all overlaps of pieces at these poses, which are finite. `afresh` has all pairs measured, for when
    /// the cast changed.
    pub fn measure(&mut self, cast: &Cast, poses: &[Pose], afresh: bool) {
        self.seat(cast, poses, afresh);
        let before = std::mem::take(&mut self.found);
        for second in 0..cast.pieces.len() {
            let one = &self.seats[second];
            for first in 0..second {
                let other = &self.seats[first];
                if (one.moved || other.moved) && meet(&one.bounds, &other.bounds) {
                    let depth = self.depth(cast, [first, second]);
                    self.found.extend(depth);
                }
            }
        }
        let still = |overlap: &Overlap| overlap.places.iter().all(|&at| !self.seats[at].moved);
        if !afresh {
            self.found.extend(before.into_iter().filter(still));
        }
    }

    fn seat(&mut self, cast: &Cast, poses: &[Pose], afresh: bool) {
        if afresh {
            self.seats.clear();
        }
        for (place, piece) in cast.pieces.iter().enumerate() {
            let pose = &poses[piece.id.index1 as usize - 1];
            match self.seats.get_mut(place) {
                Some(seat) if seat.pose == *pose => seat.moved = false,
                Some(seat) => *seat = Seat::at(piece, pose),
                None => self.seats.push(Seat::at(piece, pose)),
            }
        }
    }

    fn depth(&self, cast: &Cast, places: [usize; 2]) -> Option<Overlap> {
        let [a, b] = places.map(|place| &cast.pieces[place]);
        let class = Class::of(cast, a, b)?;
        let [one, other] = places.map(|place| &self.seats[place]);
        let depth_m = overlap_depth(&one.placed(a), &other.placed(b));
        (depth_m > 0.0).then_some(Overlap {
            pieces: [a.id, b.id],
            places,
            class,
            depth_m,
        })
    }

    /// All overlaps as they were last measured.
    #[must_use]
    pub fn found(&self) -> &[Overlap] {
        &self.found
    }

    /// Whether the boxes around two pieces overlapped by more than `by_m` each way when they were measured.
    #[must_use]
    pub fn boxes_overlap(&self, [a, b]: [usize; 2], by_m: f64) -> bool {
        let (a, b) = (&self.seats[a].bounds, &self.seats[b].bounds);
        let by = DVec3::splat(by_m);
        a[0].cmple(b[1] - by).all() && b[0].cmple(a[1] - by).all()
    }
}
