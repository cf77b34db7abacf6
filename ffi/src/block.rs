//! From a handle to the world in its block.
//!
//! Behind the kernel's block lies a tail of the library's own: where the world's calls are recorded. It is
//! not a part of the world: snapshots and hashes leave it out.

use core::ffi::c_void;
use core::ops::Range;

use palpable_kernel::memory::{AttachError, BLOCK_ALIGNMENT, BlockHead, Capacities, HEADER_BYTES};
use palpable_kernel::recording::Sink;
use palpable_kernel::world::World;

use crate::status::{
    PALP_DAMAGED, PALP_INSIDE_SINK, PALP_MEMORY_TOO_SMALL, PALP_MISALIGNED, PALP_NOT_A_WORLD,
    PALP_NULL, PALP_OTHER_LAYOUT, palp_status,
};
use crate::types::palp_world;

pub(crate) const fn attach_status(error: AttachError) -> palp_status {
    match error {
        AttachError::Misaligned => PALP_MISALIGNED,
        AttachError::TooSmall => PALP_MEMORY_TOO_SMALL,
        AttachError::NotAWorld => PALP_NOT_A_WORLD,
        AttachError::OtherLayout => PALP_OTHER_LAYOUT,
        AttachError::Damaged => PALP_DAMAGED,
    }
}

/// Refuses an address that no block can have.
pub(crate) fn judge_address(memory: *const u8) -> Result<(), palp_status> {
    if memory.is_null() {
        return Err(PALP_NULL);
    }
    if !memory.addr().is_multiple_of(BLOCK_ALIGNMENT) {
        return Err(PALP_MISALIGNED);
    }
    Ok(())
}

/// What a sink is when there is one.
pub(crate) type SinkFunction = unsafe extern "C" fn(*mut c_void, *const c_void, usize);

/// What the library keeps behind the kernel's block.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct Tail {
    /// Address of the block that the rest is about: a copy of the block elsewhere records nothing.
    own: usize,
    sink: Option<SinkFunction>,
    user: *mut c_void,
    /// One while the sink runs.
    busy: usize,
}

/// Bytes of the tail; what is not used is zero.
pub(crate) const TAIL_BYTES: usize = BLOCK_ALIGNMENT;

const _: () = assert!(size_of::<Tail>() <= TAIL_BYTES && align_of::<Tail>() <= BLOCK_ALIGNMENT);

/// Bytes of the block that a world with these capacities needs, the tail included. The capacities are
/// within bounds.
pub(crate) const fn block_bytes(capacities: &Capacities) -> usize {
    capacities.bytes().saturating_add(TAIL_BYTES)
}

/// The host's sink while a call runs.
pub(crate) struct HostSink {
    sink: SinkFunction,
    user: *mut c_void,
    tail: *mut Tail,
}

// SAFETY: made for one call and dropped at its end, on the host's thread.
unsafe impl Send for HostSink {}
// SAFETY: the same.
unsafe impl Sync for HostSink {}

impl Sink for HostSink {
    fn bytes(&mut self, bytes: &[u8]) {
        // SAFETY: the tail lies behind the world that the call has; the host gave the sink for this, and
        // the header says what it may do.
        unsafe {
            (*self.tail).busy = 1;
            (self.sink)(self.user, bytes.as_ptr().cast(), bytes.len());
            (*self.tail).busy = 0;
        }
    }
}

/// A world's block: where it starts, and how long its own head says that it is.
#[derive(Clone, Copy)]
pub(crate) struct Block {
    start: *mut u8,
    head: BlockHead,
}

impl Block {
    /// The block behind a handle; refused while its own sink runs.
    ///
    /// # Safety
    /// A handle that is neither null nor misaligned is readable for a header; if a whole header lies
    /// there, then so does the block that it tells of, and its tail.
    pub(crate) unsafe fn of(world: *const palp_world) -> Result<Self, palp_status> {
        // SAFETY: the same contract.
        let block = unsafe { Self::any(world) }?;
        // SAFETY: readable by contract.
        if unsafe { block.own_tail() }.is_some_and(|tail| tail.busy != 0) {
            return Err(PALP_INSIDE_SINK);
        }
        Ok(block)
    }

    /// The block behind a handle, whatever its tail says.
    ///
    /// # Safety
    /// As for [`Block::of`].
    pub(crate) unsafe fn any(world: *const palp_world) -> Result<Self, palp_status> {
        let start = world.cast_mut().cast::<u8>();
        judge_address(start)?;
        // SAFETY: readable by contract.
        let header = unsafe { core::slice::from_raw_parts(start, HEADER_BYTES) };
        let head = BlockHead::read(header).map_err(attach_status)?;
        Ok(Self { start, head })
    }

    /// Addresses of the block and its tail.
    pub(crate) fn range(&self) -> Range<usize> {
        self.start.addr()..self.start.addr() + self.head.bytes() + TAIL_BYTES
    }

    const fn tail(&self) -> *mut Tail {
        self.start.wrapping_add(self.head.bytes()).cast()
    }

    /// The tail, if it is about this block.
    ///
    /// # Safety
    /// The tail is readable.
    unsafe fn own_tail(&self) -> Option<Tail> {
        // SAFETY: readable by contract, aligned like the block, and any bits are a tail.
        let tail = unsafe { self.tail().read() };
        (tail.own == self.start.addr()).then_some(tail)
    }

    /// The sink of this block.
    ///
    /// # Safety
    /// The tail is readable.
    unsafe fn sink(&self) -> Option<HostSink> {
        // SAFETY: the same contract.
        let tail = unsafe { self.own_tail() }?;
        Some(HostSink {
            sink: tail.sink?,
            user: tail.user,
            tail: self.tail(),
        })
    }

    /// Hands the state to a sink, and from now on every call that changes the world.
    ///
    /// # Safety
    /// Nobody else uses the block meanwhile; the sink does what the header says for as long as it is kept.
    pub(crate) unsafe fn start_recording(
        &self,
        sink: SinkFunction,
        user: *mut c_void,
    ) -> Result<(), palp_status> {
        let mut kept = HostSink {
            sink,
            user,
            tail: self.tail(),
        };
        // SAFETY: the caller vouches.
        unsafe {
            self.tail().write(Tail {
                own: self.start.addr(),
                sink: Some(sink),
                user,
                busy: 0,
            });
            self.attach()?.record_to(&mut kept);
        }
        Ok(())
    }

    /// Keeps no sink any more.
    ///
    /// # Safety
    /// Nobody else uses the block meanwhile.
    pub(crate) unsafe fn stop_recording(&self) {
        // SAFETY: the caller vouches.
        unsafe { self.tail().cast::<u8>().write_bytes(0, TAIL_BYTES) };
    }

    /// The same column as the kernel sees it, through the host's own pointer.
    pub(crate) fn column<T, U>(&self, column: &[T]) -> *const U {
        let offset = column.as_ptr().addr() - self.start.addr();
        self.start.wrapping_add(offset).cast_const().cast::<U>()
    }

    /// Asks the world something.
    ///
    /// # Safety
    /// Nobody changes the block meanwhile.
    pub(crate) unsafe fn read<R>(
        &self,
        ask: impl FnOnce(&World) -> Result<R, palp_status>,
    ) -> Result<R, palp_status> {
        // SAFETY: the caller vouches; `ask` cannot change the world.
        let world = unsafe { self.attach() }?;
        ask(&world)
    }

    /// The world.
    ///
    /// # Safety
    /// Nobody else uses the block while `'a` lasts.
    unsafe fn attach<'a>(&self) -> Result<World<'a>, palp_status> {
        // SAFETY: the header vouched for the length, and the caller for nobody else being there.
        let memory = unsafe { core::slice::from_raw_parts_mut(self.start, self.head.bytes()) };
        World::attach_known(memory, &self.head).map_err(attach_status)
    }

    /// Does something to the world, and has it recorded if the host wants that.
    ///
    /// # Safety
    /// Nobody else uses the block meanwhile.
    pub(crate) unsafe fn change<R>(
        &self,
        act: impl FnOnce(&mut World) -> Result<R, palp_status>,
    ) -> Result<R, palp_status> {
        // SAFETY: the caller vouches.
        let mut sink = unsafe { self.sink() };
        // SAFETY: the caller vouches.
        let mut world = unsafe { self.attach() }?;
        if let Some(sink) = &mut sink {
            world.record_on(sink);
        }
        act(&mut world)
    }
}
