//! Recording the calls that change a world, and making them again.

use core::ffi::{CStr, c_char, c_void};
use core::slice;

use palpable_kernel::recording::{CallKind, Replay, ReplayError, ReplayPosition, Replayed};

use crate::arguments::{judge, judge_outside, judge_versioned, put, put_versioned, versioned};
use crate::block::{Block, block_bytes, judge_address};
use crate::panic::{guarded, guarded_or};
use crate::status::{
    PALP_DAMAGED, PALP_LOG_CUT_SHORT, PALP_MALFORMED_CALL, PALP_MEMORY_TOO_SMALL, PALP_NOT_A_LOG,
    PALP_NULL, PALP_OK, PALP_OTHER_LAYOUT, PALP_OTHER_LOG_VERSION, PALP_REPLAY_DIFFERS,
    PALP_REPLAY_END, PALP_UNKNOWN_CALL, palp_status,
};
use crate::types::{palp_capacities, palp_world};
use crate::world::{cleared, create_status};

/// Takes the next `size` bytes of a log, which are good during the call alone. What it does when there is no
/// room for them is the host's. It must return, and must not use the world that is recorded: a call with it
/// gives `PALP_INSIDE_SINK`.
#[allow(non_camel_case_types, reason = "the name in C")]
pub type palp_sink =
    Option<unsafe extern "C" fn(user: *mut c_void, bytes: *const c_void, size: usize)>;

/// A log that is replayed. Start from `PALP_REPLAY_INIT`; the library fills it in, and the host may copy it
/// to come back to where it was.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct palp_replay {
    /// `sizeof(palp_replay)`.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// The log, which stays the host's.
    pub log: *const c_void,
    /// Its bytes.
    pub size: usize,
    /// Where the next call begins in it, in bytes; behind a negative status the call that was refused.
    pub at: u64,
    /// Calls made.
    pub calls: u64,
    /// Frames stepped.
    pub frames: u64,
}

/// A call that was made again. Start from `PALP_REPLAYED_INIT`.
///
/// A value is what the call gave: for a frame `palp_state_hash` behind it; an id as its index plus its
/// generation times 2^32; the bits of a float. A refusal is 0 for a call that was accepted, and else tells
/// reasons apart. Flags are those of a frame's report.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct palp_replayed {
    /// `sizeof(palp_replayed)`.
    pub struct_size: u32,
    /// Which call: `palp_call_name` knows it.
    pub kind: u32,
    /// Its number in the log, counted from 1.
    pub call: u64,
    /// The number of the frame that it belongs to in the log, counted from 1: what is told before a frame
    /// belongs to it.
    pub frame: u64,
    /// When it was recorded.
    pub recorded_value: u64,
    /// Now.
    pub replayed_value: u64,
    /// When it was recorded.
    pub recorded_refusal: u32,
    /// Now.
    pub replayed_refusal: u32,
    /// When it was recorded.
    pub recorded_flags: u32,
    /// Now.
    pub replayed_flags: u32,
}

impl palp_replay {
    pub(crate) const NONE: Self = Self {
        struct_size: 0,
        reserved: 0,
        log: core::ptr::null(),
        size: 0,
        at: 0,
        calls: 0,
        frames: 0,
    };

    const fn put_position(&mut self, position: ReplayPosition) {
        self.at = position.at;
        self.calls = position.calls;
        self.frames = position.frames;
    }

    /// The log, opened.
    ///
    /// # Safety
    /// A log that is not null is readable while `'a` lasts, and nobody writes to it meanwhile.
    unsafe fn open<'a>(&self) -> Result<Replay<'a>, palp_status> {
        judge(self.log.cast::<u8>())?;
        if isize::try_from(self.size).is_err() {
            return Err(PALP_LOG_CUT_SHORT);
        }
        // SAFETY: readable by contract, of any alignment, not too long.
        let log = unsafe { slice::from_raw_parts(self.log.cast::<u8>(), self.size) };
        Replay::open(log).map_err(replay_status)
    }
}

impl palp_replayed {
    pub(crate) const NONE: Self = Self {
        struct_size: 0,
        kind: 0,
        call: 0,
        frame: 0,
        recorded_value: 0,
        replayed_value: 0,
        recorded_refusal: 0,
        replayed_refusal: 0,
        recorded_flags: 0,
        replayed_flags: 0,
    };

    const fn new(made: &Replayed) -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            kind: made.kind as u32,
            call: made.call,
            frame: made.frame,
            recorded_value: made.recorded.value(),
            replayed_value: made.replayed.value(),
            recorded_refusal: made.recorded.refusal,
            replayed_refusal: made.replayed.refusal,
            recorded_flags: made.recorded.flags,
            replayed_flags: made.replayed.flags,
        }
    }
}

const fn replay_status(error: ReplayError) -> palp_status {
    match error {
        ReplayError::NotALog => PALP_NOT_A_LOG,
        ReplayError::OtherVersion(_) => PALP_OTHER_LOG_VERSION,
        ReplayError::OtherLayout(_) => PALP_OTHER_LAYOUT,
        ReplayError::Damaged { .. } => PALP_DAMAGED,
        ReplayError::CutShort { .. } => PALP_LOG_CUT_SHORT,
        ReplayError::UnknownCall { .. } => PALP_UNKNOWN_CALL,
        ReplayError::Malformed { .. } => PALP_MALFORMED_CALL,
        ReplayError::Memory(why) => create_status(why),
        ReplayError::Differs(_) => PALP_REPLAY_DIFFERS,
    }
}

/// Begins a log: hands `sink` the state as it is, and from now on every call that changes the world, before
/// and after it is made. `user` goes to the sink as it is. Both are kept until `palp_recording_stop` or
/// `palp_world_attach`; a recording that goes on is ended. A call that is refused before it reaches the world,
/// for a null pointer or a wrong size, is not in the log.
///
/// Costs a hash of the state a frame, of as many bytes as `palp_state_bytes` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_recording_start(
    world: *mut palp_world,
    sink: palp_sink,
    user: *mut c_void,
) -> palp_status {
    guarded(|| {
        let sink = sink.ok_or(PALP_NULL)?;
        // SAFETY: the header's rules for pointers, threads and sinks.
        unsafe { Block::of(world)?.start_recording(sink, user)? };
        Ok(PALP_OK)
    })
}

/// Ends a recording. The log is whole as it is. Fine without a recording.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_recording_stop(world: *mut palp_world) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe { Block::of(world)?.stop_recording() };
        Ok(PALP_OK)
    })
}

/// Judges the head of a log of `size` bytes, of any alignment, which is to stay where it is until it is
/// replayed. `replay->struct_size` is set by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_replay_open(
    log: *const c_void,
    size: usize,
    replay: *mut palp_replay,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers.
        unsafe {
            let stated = judge_versioned(replay)?;
            let mut opened = palp_replay {
                log,
                size,
                ..palp_replay::NONE
            };
            let position = opened.open()?.position();
            opened.put_position(position);
            put_versioned(replay, stated, &opened);
        }
        Ok(PALP_OK)
    })
}

/// The capacities of the world that was recorded, for `palp_memory_bytes`. `capacities->struct_size` is set
/// by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_replay_capacities(
    replay: *const palp_replay,
    capacities: *mut palp_capacities,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers.
        unsafe {
            let stated = judge_versioned(capacities)?;
            let found = versioned(replay)?.open()?.capacities();
            put_versioned(capacities, stated, &palp_capacities::new(&found));
        }
        Ok(PALP_OK)
    })
}

/// Makes the world as it was when the recording began, in `memory` as for `palp_world_create`, and goes to the
/// first call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_replay_start(
    replay: *mut palp_replay,
    memory: *mut c_void,
    bytes: usize,
    world: *mut *mut palp_world,
) -> palp_status {
    guarded(|| {
        judge(world)?;
        judge_address(memory.cast())?;
        // SAFETY: the header's rules for pointers.
        unsafe {
            let stated = judge_versioned(replay)?;
            let mut begun = versioned(replay)?;
            let opened = begun.open()?;
            let capacities = opened.capacities();
            let end = memory.addr().checked_add(block_bytes(&capacities));
            let end = end.ok_or(PALP_MEMORY_TOO_SMALL)?;
            judge_outside(&(memory.addr()..end), begun.log.addr(), begun.size)?;
            let block = cleared(memory.cast(), bytes, &capacities)?;
            opened.start(block).map_err(replay_status)?;
            begun.put_position(opened.position());
            put_versioned(replay, stated, &begun);
            put(world, memory.cast());
        }
        Ok(PALP_OK)
    })
}

/// Makes the next call of the log on the world that `palp_replay_start` made. `PALP_OK` when it came to what
/// it came to when it was recorded, `PALP_REPLAY_DIFFERS` when not, `PALP_REPLAY_END` when there is none.
/// `call`, which may be null, says which call it was; nothing is written there at the end. `replay` says how
/// far it has come, whatever the status. The replay may go on behind a call that differs.
///
/// No bytes of a log break the world; a state that was forged with its checksum may.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_replay_next(
    replay: *mut palp_replay,
    world: *mut palp_world,
    call: *mut palp_replayed,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let stated_call = match call.is_null() {
                true => None,
                false => Some(judge_versioned(call)?),
            };
            let stated = judge_versioned(replay)?;
            let mut now = versioned(replay)?;
            let block = Block::of(world)?;
            judge_outside(&block.range(), now.log.addr(), now.size)?;
            let position = ReplayPosition {
                at: now.at,
                calls: now.calls,
                frames: now.frames,
            };
            let mut opened = now.open()?.resumed(position);
            let made = block.change(|world| Ok(opened.next_call(world)))?;
            now.put_position(opened.position());
            put_versioned(replay, stated, &now);
            let (status, made) = outcome(made)?;
            if let (Some(stated), Some(made)) = (stated_call, made) {
                put_versioned(call, stated, &palp_replayed::new(&made));
            }
            Ok(status)
        }
    })
}

/// What a call that was asked for came to, and the call.
fn outcome(
    made: Result<Option<Replayed>, ReplayError>,
) -> Result<(palp_status, Option<Replayed>), palp_status> {
    match made {
        Ok(None) => Ok((PALP_REPLAY_END, None)),
        Ok(made) => Ok((PALP_OK, made)),
        Err(ReplayError::Differs(made)) => Ok((PALP_REPLAY_DIFFERS, Some(made))),
        Err(why) => Err(replay_status(why)),
    }
}

const NAMES: [&CStr; 26] = [
    c"step",
    c"load",
    c"set_gravity",
    c"add_material",
    c"set_surface",
    c"add_body",
    c"remove_body",
    c"place_body",
    c"set_velocity",
    c"set_target",
    c"set_piece_targets",
    c"set_joints",
    c"apply_force",
    c"apply_impulse",
    c"set_hosted",
    c"add_piece",
    c"add_link_piece",
    c"remove_piece",
    c"set_groups",
    c"add_chain",
    c"remove_chain",
    c"set_chain_options",
    c"set_angles",
    c"set_link_poses",
    c"set_tip",
    c"place_angles",
];

/// The name of a call in a log, as the kernel in Rust has it. Never null; lasts as long as the library is
/// loaded.
#[unsafe(no_mangle)]
pub extern "C" fn palp_call_name(kind: u32) -> *const c_char {
    guarded_or(c"unknown call".as_ptr(), || {
        let index = CallKind::ALL.iter().position(|&known| known as u32 == kind);
        let name = index.and_then(|index| NAMES.get(index));
        name.map_or(c"unknown call", |name| name).as_ptr()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_call_has_its_name() {
        let kernel: Vec<_> = CallKind::ALL.iter().map(|kind| kind.name()).collect();
        let here: Vec<_> = NAMES.iter().map(|name| name.to_str().unwrap()).collect();
        assert_eq!(here, kernel);
        for kind in CallKind::ALL {
            // SAFETY: a name of the table above.
            let name = unsafe { CStr::from_ptr(palp_call_name(*kind as u32)) };
            assert_eq!(name.to_str().unwrap(), kind.name());
        }
        // SAFETY: a literal.
        let none = unsafe { CStr::from_ptr(palp_call_name(u32::MAX)) };
        assert_eq!(none, c"unknown call");
    }
}
