//! Stepping.

use palpable_kernel::frame::FrameReport;

use crate::arguments::{judge_versioned, put_versioned, versioned};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{
    PALP_BAD_TIME_STEP, PALP_CUT_ADVANCE, PALP_CUT_IMPULSES, PALP_CUT_REACH, PALP_FULL_CONTACTS,
    PALP_FULL_PAIRS, PALP_OK, PALP_OVERLAP, PALP_TIME_STEP_CLAMPED, palp_status,
};
use crate::types::{palp_frame_input, palp_frame_report, palp_world};

/// Flags and what they are as a status, the gravest first.
const STATUSES: [(u32, palp_status); 8] = [
    (FrameReport::BAD_TIME_STEP, PALP_BAD_TIME_STEP),
    (FrameReport::OVERLAP, PALP_OVERLAP),
    (FrameReport::FULL_PAIRS, PALP_FULL_PAIRS),
    (FrameReport::FULL_CONTACTS, PALP_FULL_CONTACTS),
    (FrameReport::ADVANCE_CUT, PALP_CUT_ADVANCE),
    (FrameReport::REACH_CUT, PALP_CUT_REACH),
    (FrameReport::IMPULSES_CUT, PALP_CUT_IMPULSES),
    (FrameReport::TIME_STEP_CLAMPED, PALP_TIME_STEP_CLAMPED),
];

fn frame_status(flags: u32) -> palp_status {
    STATUSES
        .iter()
        .find(|(flag, _)| flags & flag != 0)
        .map_or(PALP_OK, |(_, status)| *status)
}

/// Steps the world by one frame, spending at most the input's units. Several things may have been cut;
/// the status is the gravest of them (overlap, pairs, contacts, advance, reach, impulses, time step),
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
        for bit in 0..8 {
            assert_ne!(frame_status(1 << bit), PALP_OK);
        }
    }
}
