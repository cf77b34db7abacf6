//! Recording a world's calls to a log of bytes, and making them again.
//!
//! [`crate::world::World::record_to`] hands a host's [`Sink`] the whole state, then every call that
//! changes the world, with what it was given and what it came to: the id or the error, and for a frame
//! the hash of the state behind it. [`Replay`] makes the same calls on a world of its own and names the
//! first that comes to something else. What only reads is not recorded, nor is a call that the C library
//! refuses before it reaches the world.
//!
//! Recording costs a hash of the whole state a frame, of every byte that a snapshot has, and copies what
//! the calls are given. A world without a sink pays one branch a call.
//!
//! # The log
//!
//! Whole numbers and floats are words of 4 bytes, little endian; a number of 8 bytes is its low word, then
//! its high one. There is no padding. Snapshots hold the columns as memory has them: a log of a little-endian
//! processor is refused as damaged on a big-endian one, and the other way round.
//!
//! ```text
//! head      8 bytes   "PALPLOG\0"
//!           4         FORMAT_VERSION
//!           4         LAYOUT_VERSION
//!           32        the capacities, in the order of the struct
//!           8         bytes of the snapshot
//!           4         checksum of the head
//! snapshot            as World::save makes it
//! record    4         its kind: a CallKind, or 0 for what the call before came to
//!           8         bytes of the payload
//!           ...       payload
//!           4         checksum of the record
//! record    ...
//! ```
//!
//! Records come in twos: a call before it is made, and what it came to ([`Outcome`]) behind it. A log that
//! ends between them ends in a call that did not return. A checksum is FNV-1a of 32 bits over the bytes
//! before it in the head or record. It finds damage; nothing here withstands forgery.
//!
//! Payloads are the arguments in their order, structs field by field; a list is its length in 4 bytes, then
//! its entries; a choice is its number, then what belongs to it. `set_hosted` is one record for each body.
//! A list that is longer than any that can be accepted is cut behind the first entry too many: it is refused
//! for the same reason.

pub(crate) mod calls;
mod list;
mod outcome;
mod pen;
mod replay;
mod words;

pub use outcome::Outcome;
pub use replay::{Replay, ReplayError, ReplayPosition, Replayed};

pub(crate) use list::List;
pub(crate) use outcome::Told;
pub(crate) use pen::Put;

use crate::world::World;

/// Raised whenever a log means something else than before, an error's place in its enum included: another
/// version is refused.
pub const FORMAT_VERSION: u32 = 1;

/// The first bytes of every log.
pub const MAGIC: [u8; 8] = *b"PALPLOG\0";

/// Bytes of a log's head.
pub const HEAD_BYTES: usize = 60;

/// The kind of a record that says what the call before came to.
const OUTCOME: u32 = 0;

/// Where a log goes. Gets the log's bytes in order, in pieces of any length; what it makes of them, and what
/// it does when a disk is full, is the host's. Closures are sinks.
///
/// `Send` and `Sync` because a world is, with a sink or without.
pub trait Sink: Send + Sync {
    /// Takes the next bytes.
    fn bytes(&mut self, bytes: &[u8]);
}

impl<F: FnMut(&[u8]) + Send + Sync> Sink for F {
    fn bytes(&mut self, bytes: &[u8]) {
        self(bytes);
    }
}

macro_rules! calls {
    ($($kind:ident $number:literal $name:ident,)*) => {
        /// A call that changes a world. A number never gets a second meaning.
        #[repr(u32)]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum CallKind {
            $(
                #[doc = concat!("[`World::", stringify!($name), "`].")]
                $kind = $number,
            )*
        }

        impl CallKind {
            /// All of them, in the order of their numbers.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];

            /// The method's name.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$kind => stringify!($name),)* }
            }

            /// The kind with this number.
            #[must_use]
            pub const fn of(number: u32) -> Option<Self> {
                match number {
                    $($number => Some(Self::$kind),)*
                    _ => None,
                }
            }
        }
    };
}

calls! {
    Step 1 step,
    Load 2 load,
    SetGravity 3 set_gravity,
    AddMaterial 4 add_material,
    SetSurface 5 set_surface,
    AddBody 6 add_body,
    RemoveBody 7 remove_body,
    PlaceBody 8 place_body,
    SetVelocity 9 set_velocity,
    SetTarget 10 set_target,
    SetPieceTargets 11 set_piece_targets,
    SetJoints 12 set_joints,
    ApplyForce 13 apply_force,
    ApplyImpulse 14 apply_impulse,
    SetHosted 15 set_hosted,
    AddPiece 16 add_piece,
    AddLinkPiece 17 add_link_piece,
    RemovePiece 18 remove_piece,
    SetGroups 19 set_groups,
    AddChain 20 add_chain,
    RemoveChain 21 remove_chain,
    SetChainOptions 22 set_chain_options,
    SetAngles 23 set_angles,
    SetLinkPoses 24 set_link_poses,
    SetTip 25 set_tip,
    PlaceAngles 26 place_angles,
}

impl<'a> World<'a> {
    /// Begins a log: hands `sink` the head and the state as it is, and from now on every call that changes
    /// the world. Ends a recording that goes on.
    ///
    /// Cost: a snapshot.
    pub fn record_to(&mut self, sink: &'a mut dyn Sink) {
        pen::head(self, sink);
        self.sink = Some(sink);
    }

    /// Goes on with a log that [`World::record_to`] began: for a host that attaches to its block anew. What
    /// changed the world between is not in the log, and a replay will differ.
    pub fn record_on(&mut self, sink: &'a mut dyn Sink) {
        self.sink = Some(sink);
    }

    /// Ends a recording. The log is whole; there is nothing to write at its end.
    pub fn stop_recording(&mut self) {
        self.sink = None;
    }

    /// Whether calls are recorded.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.sink.is_some()
    }

    /// Makes a call, and records it if somebody wants that. `put` writes its arguments, always the same. The
    /// sink is out of the world while the call runs: what the call calls is a part of it.
    #[inline]
    pub(crate) fn recorded<R: Told>(
        &mut self,
        kind: CallKind,
        put: impl Fn(&mut dyn Put),
        act: impl FnOnce(&mut Self) -> R,
    ) -> R {
        match self.sink.take() {
            None => act(self),
            Some(sink) => self.record_call(sink, kind, put, act),
        }
    }

    /// Out of the way of worlds that are not recorded.
    #[cold]
    #[inline(never)]
    fn record_call<R: Told>(
        &mut self,
        sink: &'a mut dyn Sink,
        kind: CallKind,
        put: impl Fn(&mut dyn Put),
        act: impl FnOnce(&mut Self) -> R,
    ) -> R {
        pen::record(sink, kind as u32, &put);
        let told = act(self);
        let outcome = told.outcome(self);
        pen::record(sink, OUTCOME, &|to: &mut dyn Put| to.pod(&outcome));
        self.sink = Some(sink);
        told
    }
}
