//! The adversarial scenes at deadlines: what must hold whatever the machine and its load.

use palpable::frame::{Budget, FrameInput};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};
use palpable_lab::deadline::local::{HORIZONS, SAMPLED_EVERY, Sampler};
use palpable_lab::deadline::play::{Trace, play};
use palpable_lab::deadline::set::Cast;
use palpable_lab::deadline::{Kit, Prices, Trial};
use palpable_lab::hand::Hand;
use palpable_lab::hand_scene::SceneError;
use palpable_lab::memory::Block;

const FRAMES: u32 = 60;

/// About what a desktop takes.
const PRICES: Prices = Prices {
    frame_ns: 2000,
    body_ns: 100,
    piece_ns: 50,
    chain_ns: 2000,
    boxes_ns: 500,
    advance_unit_ns: 1500,
    impulse_unit_ns: 1500,
    reach_step_ns: 5000,
    pauses_ns: 20_000,
};

#[test]
fn no_deadline_brings_a_hand_into_anything_and_what_missed_is_replayed_to_the_bit() {
    let kit = Kit::new(Hand::load().unwrap());
    for trial in Trial::ALL {
        let mut trace = Trace::default();
        let whole = play(&kit, trial, FRAMES, None, &PRICES, &mut trace).unwrap();
        assert_eq!((whole.misses_cpu, whole.run_error.mean_mm), (0, 0.0));
        // A frame that does anything misses one microsecond, and then the run is replayed.
        for deadline_us in [1, 40, 400] {
            let at = play(&kit, trial, FRAMES, Some(deadline_us), &PRICES, &mut trace).unwrap();
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

const FRAME: FrameInput = FrameInput::unlimited(1.0 / 90.0);

fn of(units: u32) -> FrameInput {
    let budget = Budget {
        advance_units: units,
        impulse_units: units,
        reach_steps: units,
    };
    FrameInput { budget, ..FRAME }
}

/// A ball on a table, and its tracker below the table top goes 30 mm along x in each frame.
#[test]
fn the_error_of_one_frame_is_what_its_budget_takes_from_the_way() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let table = BodyDef::new(BodyKind::Fixed, Pose::at(0.0, -0.1, 0.0));
    let table = world.add_body(&table).unwrap();
    let top = PieceDef::new(Shape::Box([2.0, 0.1, 2.0]), 0.0);
    world.add_piece(table, &top).unwrap();
    let at = BodyDef::new(BodyKind::Driven, Pose::at(0.0, 0.06, 0.0));
    let hand = world.add_body(&at).unwrap();
    let ball = PieceDef::new(Shape::Point, 0.05);
    let ball = world.add_piece(hand, &ball).unwrap();
    let cast = Cast {
        driven: vec![hand],
        pieces: vec![ball],
        ..Cast::default()
    };
    let tell = |world: &mut World, frame: u32| {
        let seen = Pose::at(0.03 * frame as f32, 0.03, 0.0);
        let told = world.set_target(hand, &seen);
        told.map_err(|why| SceneError(format!("{why:?}")))
    };
    for _ in 0..3 {
        tell(&mut world, 0).unwrap();
        world.step(&FRAME);
    }
    let before = world.hash();
    // What the frame spends is known once it has been played.
    let mut snapshot = vec![0; world.snapshot_bytes()];
    world.save(&mut snapshot).unwrap();
    tell(&mut world, 1).unwrap();
    let spent = world.step(&FRAME).spent();
    world.load(&snapshot).unwrap();

    let exact = FrameInput {
        budget: spent,
        ..FRAME
    };
    let mut sampler = Sampler::new([exact, of(0)]);
    sampler.branch(&mut world, &cast, 1, tell).unwrap();
    assert_eq!(world.hash(), before);
    let stood = world.piece_pose(ball).unwrap().translation();
    tell(&mut world, 1).unwrap();
    world.step(&FRAME);
    sampler.compare(&world, &cast, 1).unwrap();
    let moved = world.piece_pose(ball).unwrap().translation();
    let way_mm = 1e3 * f64::from(moved.distance(stood));
    assert!((way_mm - 30.0).abs() < 1.0, "{way_mm} mm");

    let errors = sampler.errors();
    let [exact, none] = [&errors[0][0].driven, &errors[1][0].driven];
    assert_eq!((exact.count, exact.mean_mm), (1, 0.0));
    assert!((none.mean_mm - way_mm).abs() < 1e-3, "{none:?}");
    assert_eq!(errors[0][0].loose.count, 0);
    // The run has not come to the later horizon yet.
    assert_eq!(
        (errors[0][1].frames, errors[0][1].driven.count),
        (HORIZONS[1], 0)
    );
}

#[test]
fn the_error_of_one_frame_does_not_rise_with_the_budget() {
    let kit = Kit::new(Hand::load().unwrap());
    let trial = Trial::Teleports;
    let frames = 10 * SAMPLED_EVERY;
    let budgets = [0, 30, 100, 300, u32::MAX];
    let mut sampler = Sampler::new(budgets.map(of));
    let play = |sampler: &mut Sampler| {
        kit.stage(trial, |world, cast, _| {
            for frame in 0..frames {
                if sampler.is_due(frame, frames) {
                    let tell = |world: &mut World, frame| kit.tell(trial, world, cast, frame);
                    sampler.branch(world, cast, frame, tell)?;
                }
                kit.tell(trial, world, cast, frame)?;
                world.step(&FRAME);
                sampler.compare(world, cast, frame)?;
            }
            Ok(world.hash())
        })
    };
    let hash = play(&mut sampler).unwrap();
    // A run that is sampled comes to the bits of one that is not.
    assert_eq!(play(&mut Sampler::default()).unwrap(), hash);
    let errors = sampler.errors();
    let means: Vec<f64> = errors.iter().map(|at| at[0].driven.mean_mm).collect();
    assert!(
        errors.iter().all(|at| at[0].driven.count == 9),
        "{errors:?}"
    );
    assert!(means.is_sorted_by(|less, more| less >= more), "{means:?}");
    assert!(means[0] > 100.0 && means[4] == 0.0, "{means:?}");
    assert_eq!(errors[4][1].driven.mean_mm, 0.0);
}
