//! The adversarial scenes at deadlines: what must hold whatever the machine and its load.

use palpable::frame::CostTable;
use palpable_lab::deadline::play::{Trace, play};
use palpable_lab::deadline::{Kit, Trial};
use palpable_lab::hand::Hand;

const FRAMES: u32 = 60;

/// About what a desktop takes.
const COSTS: CostTable = CostTable {
    frame_ns: 2000,
    body_ns: 100,
    piece_ns: 50,
    chain_ns: 2000,
    boxes_ns: 500,
    advance_unit_ns: 1500,
    impulse_unit_ns: 1500,
    reach_step_ns: 5000,
};

#[test]
fn no_deadline_brings_a_hand_into_anything_and_what_missed_is_replayed_to_the_bit() {
    let kit = Kit::new(Hand::load().unwrap());
    for trial in Trial::ALL {
        let mut trace = Trace::new();
        let whole = play(&kit, trial, FRAMES, None, &COSTS, &mut trace).unwrap();
        assert_eq!((whole.misses_cpu, whole.error_mm_mean), (0, 0.0));
        // A frame that does anything misses one microsecond, and then the run is replayed.
        for deadline_us in [1, 40, 400] {
            let at = play(&kit, trial, FRAMES, Some(deadline_us), &COSTS, &mut trace).unwrap();
            let name = at.trial;
            assert_eq!(at.frames, FRAMES, "{name}");
            assert!(at.judged > 0 && at.violations == 0, "{name}: {at:?}");
            assert!(at.misses_again <= at.misses_cpu, "{name}: {at:?}");
            if deadline_us == 1 {
                assert_eq!(at.below_floor, FRAMES, "{name}");
            }
        }
    }
}
