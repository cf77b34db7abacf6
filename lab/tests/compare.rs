//! What the kernel promises in the scenes of the comparison, with few trackers and without timing; and
//! that its peer plays them at all.

use palpable_lab::compare::kernel::{CAPACITIES, Kernel};
use palpable_lab::compare::measures::{
    DROPPED, HELD, JITTER, LAG, Measure, PRESSED, PUSH_LAG, PUSHED, SLID, TRAPPED, WALLED, measures,
};
use palpable_lab::compare::play::play;
use palpable_lab::compare::run::{play_on, slap};
use palpable_lab::compare::scenes::Scene;
use palpable_lab::compare::setting::{Perturbation, perturbations};
use palpable_lab::compare::slaps::slaps;
use palpable_lab::compare::summary::{Found, Row, Standing};
use palpable_lab::compare::{arm::Arm, judging::judge, peer_arm};
use palpable_lab::hand::Hand;
use palpable_lab::memory::Block;

const SEED: u64 = 1;
const TRACKERS: usize = 2;

/// Enough for a ball that a finger presses to the floor: it is almost jammed.
const PUSH_TRACKERS: usize = 7;

/// Held boxes come to rest in ways of their own.
const HOLD_TRACKERS: usize = 10;

fn hand() -> Hand {
    Hand::load().unwrap()
}

/// Plays a scene on the kernel and holds it to its promises; the last ones name what else must be there.
fn keeps(scene: Scene, trackers: usize, promises: &[Measure]) {
    let hand = hand();
    for tracker in perturbations(SEED, trackers) {
        let setting = scene.setting(&hand, &tracker);
        let shots = play_on(0, &setting).unwrap();
        let readings = judge(&setting, &shots).unwrap();
        let found = measures(scene, &setting, &shots, &readings);
        for promise in promises {
            let (_, value) = found
                .iter()
                .find(|(measure, _)| measure == promise)
                .unwrap();
            let most = promise.promised.unwrap();
            assert!(
                *value <= most,
                "{}: {} is {value} {}, {most} are promised, with {tracker:?}",
                scene.name(),
                promise.name,
                promise.unit,
            );
        }
    }
}

#[test]
fn free_motion_has_no_lag() {
    keeps(Scene::Free, TRACKERS, &[LAG]);
    keeps(Scene::Idle, TRACKERS, &[LAG]);
}

#[test]
fn a_pressed_and_sliding_hand_stays_out_and_still() {
    keeps(Scene::Press, TRACKERS, &[PRESSED, JITTER, SLID]);
}

#[test]
fn a_pushed_ball_does_not_hold_the_hand_back() {
    keeps(Scene::Push, PUSH_TRACKERS, &[PUSH_LAG, PUSHED]);
}

#[test]
fn a_trapped_ball_is_still() {
    keeps(Scene::Trap, TRACKERS, &[TRAPPED, WALLED, JITTER]);
}

#[test]
fn two_hands_hold_a_box() {
    keeps(Scene::Squeeze, HOLD_TRACKERS, &[DROPPED, HELD, JITTER]);
}

#[test]
fn two_hands_carry_a_box() {
    keeps(Scene::Carry, HOLD_TRACKERS, &[DROPPED, HELD, JITTER]);
}

/// Where nothing comes forward any more, hands that keep what they do not reach are at rest as well as hands that
/// have nowhere to go.
#[test]
fn a_box_falls_asleep_in_the_hands_that_carried_it() {
    let hand = hand();
    for tracker in perturbations(SEED, HOLD_TRACKERS) {
        let setting = Scene::Carry.setting(&hand, &tracker);
        let mut block = Block::new(&CAPACITIES);
        let mut kernel = Kernel::new(block.bytes(), &setting).unwrap();
        play(&setting, &mut kernel).unwrap();
        assert!(kernel.is_asleep(0).unwrap(), "awake with {tracker:?}");
    }
}

#[test]
fn slaps_leave_nothing_behind() {
    let found = slap(&hand(), 0, &slaps(SEED, 60), || ()).unwrap();
    assert_eq!(found.left_behind, 0);
    assert_eq!(found.seen_behind, 0);
    assert!(found.overlap_mm <= 0.1, "{} mm", found.overlap_mm);
}

#[test]
fn an_arm_stays_out_of_the_wall_and_within_its_ranges() {
    let [tracker] = perturbations(SEED, 1)[..] else {
        unreachable!("one tracker was asked for");
    };
    let found = Arm::default().play(tracker).unwrap();
    assert!(found.overlap_mm <= 0.1, "{} mm", found.overlap_mm);
    assert!(found.beyond_deg <= 1e-4, "{} degrees", found.beyond_deg);
    assert_eq!(found.jitter_deg, 0.0);
}

/// Short: the peer is not optimised in tests.
#[test]
fn the_peer_plays_the_same_scenes() {
    let hand = hand();
    let mut setting = Scene::Press.setting(&hand, &Perturbation::NONE);
    setting.hands[0].wrist.truncate(60);
    for engine in [1, 2] {
        let shots = play_on(engine, &setting).unwrap();
        let readings = judge(&setting, &shots).unwrap();
        let last = readings.last().unwrap();
        assert!(last.hand_fixed_mm > 0.0, "a soft contact gives way");
        assert!(last.hand_fixed_mm < 5.0, "{} mm", last.hand_fixed_mm);
        assert!((90.0..120.0).contains(&last.lag_mm), "{} mm", last.lag_mm);
    }
}

/// The arm follows its tracker until the wall is in the way.
#[test]
fn the_peer_has_an_arm() {
    let found = peer_arm::play(&Arm::default(), Perturbation::NONE).unwrap();
    assert!(found.overlap_mm > 0.0, "it reaches the wall");
    assert!(found.overlap_mm < 5.0, "{} mm", found.overlap_mm);
    assert!(found.beyond_deg < 5.0, "{} degrees", found.beyond_deg);
}

#[test]
fn a_seed_gives_the_same_trackers_and_no_two_alike() {
    let [one, other] = [0, 1].map(|_| perturbations(SEED, 10));
    assert_eq!(one, other);
    for (index, tracker) in one.iter().enumerate() {
        assert!(!one[..index].contains(tracker));
    }
    assert_ne!(one, perturbations(SEED + 1, 10));
    assert_eq!(slaps(SEED, 12)[..6], slaps(SEED, 6));
}

#[test]
fn a_row_says_what_is_kept_and_who_is_better() {
    let row = |ours: f64, theirs: f64| Row {
        scene: "scene",
        measure: PRESSED.name,
        unit: PRESSED.unit,
        promised: PRESSED.promised,
        found: [
            Some(Found::of(&PRESSED, &[0.0, ours, 0.0])),
            Some(Found::of(&PRESSED, &[theirs])),
            None,
        ],
    };
    assert_eq!(row(0.1, 0.2).is_kept(), Some(true));
    assert_eq!(row(0.11, 0.2).is_kept(), Some(false));
    assert_eq!(row(0.1, 0.2).standing(), Some(Standing::Better));
    assert_eq!(row(0.1, 0.1).standing(), Some(Standing::Equal));
    assert_eq!(row(0.1, 0.0).standing(), Some(Standing::Worse));
    assert_eq!(row(f64::NAN, 0.2).is_kept(), Some(false));
    assert_eq!(Found::of(&DROPPED, &[1.0, 0.0, 1.0]).worst, 2.0);
    assert_eq!(Found::of(&PRESSED, &[3.0, 1.0, 2.0]).median, Some(2.0));
}
