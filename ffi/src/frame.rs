//! Stepping.

use core::ffi::c_void;

use palpable_kernel::frame::FrameReport;

use crate::arguments::{judge, judge_versioned, put, put_versioned, value, versioned};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{
    PALP_BAD_TIME_STEP, PALP_BELOW_FLOOR, PALP_CUT_ADVANCE, PALP_CUT_IMPULSES, PALP_CUT_REACH,
    PALP_FLUSHES_TO_ZERO, PALP_FULL_CONTACTS, PALP_FULL_PAIRS, PALP_LATE, PALP_NULL, PALP_OK,
    PALP_OUT_OF_TIME, PALP_OVERLAP, PALP_TIME_STEP_CLAMPED, palp_status,
};
use crate::types::{palp_costs, palp_frame_input, palp_frame_report, palp_world};

/// Flags and what they are as a status, the gravest first.
const STATUSES: [(u32, palp_status); 12] = [
    (FrameReport::BAD_TIME_STEP, PALP_BAD_TIME_STEP),
    (FrameReport::OVERLAP, PALP_OVERLAP),
    (FrameReport::FULL_PAIRS, PALP_FULL_PAIRS),
    (FrameReport::FULL_CONTACTS, PALP_FULL_CONTACTS),
    (FrameReport::ADVANCE_CUT, PALP_CUT_ADVANCE),
    (FrameReport::REACH_CUT, PALP_CUT_REACH),
    (FrameReport::IMPULSES_CUT, PALP_CUT_IMPULSES),
    (FrameReport::BELOW_FLOOR, PALP_BELOW_FLOOR),
    (FrameReport::OUT_OF_TIME, PALP_OUT_OF_TIME),
    (FrameReport::LATE, PALP_LATE),
    (FrameReport::TIME_STEP_CLAMPED, PALP_TIME_STEP_CLAMPED),
    (FrameReport::FLUSHES_TO_ZERO, PALP_FLUSHES_TO_ZERO),
];

fn frame_status(flags: u32) -> palp_status {
    STATUSES
        .iter()
        .find(|(flag, _)| flags & flag != 0)
        .map_or(PALP_OK, |(_, status)| *status)
}

/// Steps the world by one frame, spending at most the input's units. Several things may have been cut;
/// the status is the gravest of them (overlap, pairs, contacts, advance, reach, impulses, time, time step, flushing),
/// the report has them all. `report->struct_size` is set by the host; `report` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_frame_step(
    world: *mut palp_world,
    input: *const palp_frame_input,
    report: *mut palp_frame_report,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let stated = match report.is_null() {
                true => None,
                false => Some(judge_versioned(report)?),
            };
            let input = versioned(input)?.to_kernel();
            let did = Block::of(world)?.change(|world| Ok(world.step(&input)))?;
            if let Some(stated) = stated {
                put_versioned(report, stated, &palp_frame_report::new(&did));
            }
            Ok(frame_status(did.flags))
        }
    })
}

/// A clock of the host's that runs forward, in nanoseconds from any start. Called from the stepping thread,
/// before every unit; it must not call this library.
#[allow(non_camel_case_types, reason = "the name in C")]
pub type palp_clock = Option<unsafe extern "C" fn(user: *mut c_void) -> u64>;

/// Like `palp_frame_step`, with a clock as a backstop: no units are begun that would not be over before
/// `ends_ns` by it and by the prices of the input's costs; without prices they take no time. Closing the frame
/// comes after that: `ends_ns` is best set by `palp_frame_floor` before the frame is to be over, and by
/// what an interrupt takes. Where the clock cuts, the report says `PALP_FRAME_LATE`, and stepping with the report's
/// units and no deadline gives the same bits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_frame_step_by_clock(
    world: *mut palp_world,
    input: *const palp_frame_input,
    report: *mut palp_frame_report,
    clock: palp_clock,
    user: *mut c_void,
    ends_ns: u64,
) -> palp_status {
    guarded(|| {
        let clock = clock.ok_or(PALP_NULL)?;
        // SAFETY: the header's rules for pointers and threads; the clock is the host's own.
        unsafe {
            let stated = match report.is_null() {
                true => None,
                false => Some(judge_versioned(report)?),
            };
            let input = versioned(input)?.to_kernel();
            let now = || clock(user);
            let did =
                Block::of(world)?.change(|world| Ok(world.step_by_clock(&input, &now, ends_ns)))?;
            if let Some(stated) = stated {
                put_versioned(report, stated, &palp_frame_report::new(&did));
            }
            Ok(frame_status(did.flags))
        }
    })
}

/// What the next frame costs whatever happens, by `costs`, in nanoseconds.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_frame_floor(
    world: *const palp_world,
    costs: *const palp_costs,
    floor_ns: *mut u64,
) -> palp_status {
    guarded(|| {
        judge(floor_ns)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let costs = value(costs)?.to_kernel();
            let floor = Block::of(world)?.read(|world| Ok(world.floor_ns(&costs)))?;
            put(floor_ns, floor);
        }
        Ok(PALP_OK)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gravest_flag_is_the_status() {
        assert_eq!(frame_status(0), PALP_OK);
        assert_eq!(frame_status(u32::MAX), PALP_BAD_TIME_STEP);
        assert_eq!(
            frame_status(FrameReport::FULL_PAIRS | FrameReport::IMPULSES_CUT),
            PALP_FULL_PAIRS
        );
    }

    #[test]
    fn every_known_flag_has_a_status() {
        for bit in 0..12 {
            assert_ne!(frame_status(1 << bit), PALP_OK);
        }
    }
}
