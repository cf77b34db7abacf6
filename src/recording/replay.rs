//! Making the calls of a log again.

use core::fmt;

use bytemuck::{Pod, Zeroable};

use super::outcome::Outcome;
use super::pen::Checksum;
use super::words::Words;
use super::{CallKind, FORMAT_VERSION, HEAD_BYTES, MAGIC, OUTCOME, calls};
use crate::memory::header::LAYOUT_VERSION;
use crate::memory::{Capacities, CreateError, SnapshotError};
use crate::world::World;

/// Bytes of a record beside its payload.
const RECORD_BYTES: usize = 4 + 8 + CHECKSUM_BYTES;

const CHECKSUM_BYTES: usize = 4;

/// A call that was made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Replayed {
    /// Its number in the log, counted from one.
    pub call: u64,
    /// The number of the frame in the log, counted from one, that it belongs to: the frame of a step, the
    /// next one for what is told before it. A rollback does not count backwards.
    pub frame: u64,
    /// Which call.
    pub kind: CallKind,
    /// What it came to when it was recorded.
    pub recorded: Outcome,
    /// What it came to now.
    pub replayed: Outcome,
}

/// Why a log was refused, or where it went another way. Places are bytes from the log's start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayError {
    /// The bytes do not start as a log does.
    NotALog,
    /// The log is of another [`FORMAT_VERSION`], this one.
    OtherVersion(u32),
    /// The log was recorded from a world of another [`LAYOUT_VERSION`], this one.
    OtherLayout(u32),
    /// The head, the snapshot or the record that begins here contradicts its checksum.
    Damaged {
        /// Where it begins.
        at: usize,
    },
    /// The log ends within the head, the snapshot or the record that begins here, or before the outcome of
    /// a call, which is to begin here. Such a call was made; nothing follows.
    CutShort {
        /// Where that begins.
        at: usize,
    },
    /// The record that begins here is of no known kind, or an outcome where a call is to be or the other way
    /// round.
    UnknownCall {
        /// Where it begins.
        at: usize,
        /// The kind's number.
        kind: u32,
    },
    /// The payload of the record that begins here is not what its kind has.
    Malformed {
        /// Where it begins.
        at: usize,
    },
    /// The block for the world was refused.
    Memory(CreateError),
    /// The call came to something else. It was made, and the replay can go on.
    Differs(Replayed),
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotALog => f.write_str("this is no log"),
            Self::OtherVersion(version) => write!(
                f,
                "the log has format {version}, this library reads {FORMAT_VERSION}"
            ),
            Self::OtherLayout(version) => write!(
                f,
                "the log has worlds of layout {version}, this library's is {LAYOUT_VERSION}"
            ),
            Self::Damaged { at } => write!(f, "what begins at byte {at} is damaged"),
            Self::CutShort { at } => write!(f, "the log ends within what begins at byte {at}"),
            Self::UnknownCall { at, kind } => {
                write!(
                    f,
                    "the record at byte {at} is of the unexpected kind {kind}"
                )
            }
            Self::Malformed { at } => {
                write!(f, "the payload of the record at byte {at} is no call")
            }
            Self::Memory(why) => write!(f, "the block was refused: {why:?}"),
            Self::Differs(call) => write!(
                f,
                "call {} ({}) in frame {} differs",
                call.call,
                call.kind.name(),
                call.frame
            ),
        }
    }
}

impl core::error::Error for ReplayError {}

/// How far a replay has come. Plain data, for a host that cannot keep a [`Replay`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct ReplayPosition {
    /// Where the next record begins, in bytes from the log's start; zero for the first.
    pub at: u64,
    /// Calls made.
    pub calls: u64,
    /// Frames stepped.
    pub frames: u64,
}

/// A log that is replayed.
///
/// ```
/// # use palpable::memory::Capacities;
/// # use palpable::{recording::Replay, world::World};
/// fn is_equal(log: &[u8], memory: &mut [u8]) -> bool {
///     let Ok(mut replay) = Replay::open(log) else { return false };
///     let Ok(mut world) = replay.start(memory) else { return false };
///     loop {
///         match replay.next_call(&mut world) {
///             Ok(Some(_)) => {}
///             Ok(None) => return true,
///             Err(_) => return false,
///         }
///     }
/// }
/// # let mut memory = vec![0; Capacities::ROOM.bytes() + 64];
/// # let start = memory.as_ptr().align_offset(64);
/// # let mut log = vec![];
/// # let mut sink = |bytes: &[u8]| log.extend_from_slice(bytes);
/// # let mut world = World::create(&mut memory[start..], &Capacities::ROOM).unwrap();
/// # world.record_to(&mut sink);
/// # world.set_gravity([0.0; 3]);
/// # assert!(is_equal(&log, &mut memory[start..]));
/// # let last = log.len() - 1;
/// # assert!(!is_equal(&log[..last], &mut memory[start..]));
/// ```
#[derive(Clone, Debug)]
pub struct Replay<'l> {
    log: &'l [u8],
    capacities: Capacities,
    snapshot_bytes: usize,
    position: ReplayPosition,
}

impl<'l> Replay<'l> {
    /// Judges the head of a log.
    ///
    /// # Errors
    /// [`ReplayError::NotALog`], [`ReplayError::OtherVersion`], [`ReplayError::OtherLayout`],
    /// [`ReplayError::Damaged`], [`ReplayError::CutShort`].
    pub fn open(log: &'l [u8]) -> Result<Self, ReplayError> {
        let cut = ReplayError::CutShort { at: 0 };
        let known = log.len().min(MAGIC.len());
        if log[..known] != MAGIC[..known] || known == 0 {
            return Err(ReplayError::NotALog);
        }
        let mut words = Words::new(log.get(MAGIC.len()..).ok_or(cut)?);
        let version: u32 = words.pod().ok_or(cut)?;
        if version != FORMAT_VERSION {
            return Err(ReplayError::OtherVersion(version));
        }
        let layout: u32 = words.pod().ok_or(cut)?;
        if layout != LAYOUT_VERSION {
            return Err(ReplayError::OtherLayout(layout));
        }
        let capacities: Capacities = words.pod().ok_or(cut)?;
        let snapshot_bytes = words.long().ok_or(cut)?;
        let head = log.get(..HEAD_BYTES).ok_or(cut)?;
        if !is_whole(head) || !capacities.are_within_bounds() {
            return Err(ReplayError::Damaged { at: 0 });
        }
        let cut = ReplayError::CutShort { at: HEAD_BYTES };
        let snapshot_bytes = usize::try_from(snapshot_bytes).map_err(|_| cut)?;
        if log.len() - HEAD_BYTES < snapshot_bytes {
            return Err(cut);
        }
        let first = HEAD_BYTES + snapshot_bytes;
        Ok(Self {
            log,
            capacities,
            snapshot_bytes,
            position: ReplayPosition {
                at: first as u64,
                ..ReplayPosition::default()
            },
        })
    }

    /// The capacities of the world that was recorded; [`Capacities::bytes`] says what block it takes.
    #[must_use]
    pub const fn capacities(&self) -> Capacities {
        self.capacities
    }

    /// Makes the world as it was when the recording began, in `memory`.
    ///
    /// # Errors
    /// [`ReplayError::Memory`], [`ReplayError::Damaged`] when the snapshot contradicts its checksum.
    pub fn start<'w>(&self, memory: &'w mut [u8]) -> Result<World<'w>, ReplayError> {
        let mut world = World::create(memory, &self.capacities).map_err(ReplayError::Memory)?;
        let damaged = ReplayError::Damaged { at: HEAD_BYTES };
        if world.snapshot_bytes() != self.snapshot_bytes {
            return Err(damaged);
        }
        let snapshot = &self.log[HEAD_BYTES..HEAD_BYTES + self.snapshot_bytes];
        world.load(snapshot).map_err(|why| match why {
            SnapshotError::TooSmall | SnapshotError::OtherLayout | SnapshotError::Damaged => {
                damaged
            }
        })?;
        Ok(world)
    }

    /// How far the replay has come.
    #[must_use]
    pub const fn position(&self) -> ReplayPosition {
        self.position
    }

    /// Goes on from a place that [`Replay::position`] gave for the same log.
    #[must_use]
    pub const fn resumed(mut self, position: ReplayPosition) -> Self {
        self.position = position;
        self
    }

    /// Makes the next call on the world that [`Replay::start`] made; `None` behind the last one. The world
    /// may be recorded meanwhile. Never panics, whatever the bytes are.
    ///
    /// Cost: the call's, and a hash of the state for a frame.
    ///
    /// # Errors
    /// [`ReplayError`]. But for [`ReplayError::Differs`] and [`ReplayError::CutShort`] at the outcome of a
    /// call, nothing was done, and asking again gives the same answer.
    pub fn next_call(&mut self, world: &mut World) -> Result<Option<Replayed>, ReplayError> {
        let at = usize::try_from(self.position.at).unwrap_or(usize::MAX);
        if at == self.log.len() {
            return Ok(None);
        }
        let call = Record::read(self.log, at)?;
        let unknown = ReplayError::UnknownCall {
            at,
            kind: call.kind,
        };
        let kind = CallKind::of(call.kind).ok_or(unknown)?;
        let recorded = match read_outcome(self.log, call.end) {
            Ok((outcome, end)) => Ok((outcome, end)),
            Err(cut @ ReplayError::CutShort { .. }) => Err(cut),
            Err(other) => return Err(other),
        };
        let mut words = Words::new(call.payload);
        let replayed = calls::make(world, kind, &mut words).ok_or(ReplayError::Malformed { at })?;
        self.finish(kind, replayed, recorded).map(Some)
    }

    /// Counts a call that was made, and compares what it came to.
    fn finish(
        &mut self,
        kind: CallKind,
        replayed: Outcome,
        recorded: Result<(Outcome, usize), ReplayError>,
    ) -> Result<Replayed, ReplayError> {
        let position = &mut self.position;
        position.calls = position.calls.saturating_add(1);
        let frame = position.frames.saturating_add(1);
        if kind == CallKind::Step {
            position.frames = frame;
        }
        let end = recorded.map_or(self.log.len(), |(_, end)| end);
        position.at = end as u64;
        let made = Replayed {
            call: position.calls,
            frame,
            kind,
            recorded: recorded?.0,
            replayed,
        };
        if made.recorded == made.replayed {
            Ok(made)
        } else {
            Err(ReplayError::Differs(made))
        }
    }
}

/// The outcome that begins at a place, and where it ends.
fn read_outcome(log: &[u8], at: usize) -> Result<(Outcome, usize), ReplayError> {
    let record = Record::read(log, at)?;
    if record.kind != OUTCOME {
        let kind = record.kind;
        return Err(ReplayError::UnknownCall { at, kind });
    }
    let mut words = Words::new(record.payload);
    let outcome = words.pod().filter(|_| words.end().is_some());
    let outcome = outcome.ok_or(ReplayError::Malformed { at })?;
    Ok((outcome, record.end))
}

/// One record of a log, whole.
struct Record<'l> {
    kind: u32,
    payload: &'l [u8],
    /// Where the next one begins.
    end: usize,
}

impl<'l> Record<'l> {
    fn read(log: &'l [u8], at: usize) -> Result<Self, ReplayError> {
        let cut = ReplayError::CutShort { at };
        let mut words = Words::new(log.get(at..).ok_or(cut)?);
        let kind = words.pod().ok_or(cut)?;
        let bytes = usize::try_from(words.long().ok_or(cut)?).map_err(|_| cut)?;
        let payload = words.bytes(bytes).ok_or(cut)?;
        words.bytes(CHECKSUM_BYTES).ok_or(cut)?;
        let end = at + RECORD_BYTES + bytes;
        if !is_whole(&log[at..end]) {
            return Err(ReplayError::Damaged { at });
        }
        Ok(Self { kind, payload, end })
    }
}

/// Whether bytes end in their checksum.
fn is_whole(bytes: &[u8]) -> bool {
    let (before, stated) = bytes.split_at(bytes.len() - CHECKSUM_BYTES);
    let mut checksum = Checksum::new();
    checksum.bytes(before);
    checksum.value() == stated
}
