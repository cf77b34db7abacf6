//! The paper's hand scene keeps the promises, and its judge would see if it did not.

use palpable::frame::FrameInput;
use palpable::world::World;
use palpable_lab::hand::Hand;
use palpable_lab::hand_scene::{self, BALL, CAPACITIES, FIXED, HAND, Ids};
use palpable_lab::memory::Block;
use palpable_lab::report::{BALL_OVERLAP_MM_MAX, Ball, HAND_FIXED_OVERLAP_MM_MAX, Run};
use palpable_lab::run::{RunPlan, run};
use palpable_lab::script::{FRAMES, Script};
use palpable_lab::{gallery, slaps};

fn scene(hand: &Hand, ball: Ball, noise: bool) -> Run {
    let plan = RunPlan {
        ball,
        noise,
        frames: FRAMES,
    };
    run(hand, &plan, || ()).unwrap().0
}

fn assert_promises(run: &Run) {
    assert_eq!(run.frames, FRAMES);
    assert_eq!(run.beyond_walls, 0);
    for phase in &run.phases {
        let at = format!("{}, {}", run.name, phase.name);
        assert!(
            phase.overlap_hand_fixed_mm_max <= HAND_FIXED_OVERLAP_MM_MAX,
            "{at}"
        );
        assert!(
            phase.overlap_ball_fixed_mm_max <= BALL_OVERLAP_MM_MAX,
            "{at}"
        );
        assert!(
            phase.overlap_hand_ball_mm_max <= BALL_OVERLAP_MM_MAX,
            "{at}"
        );
        assert_eq!(phase.free_lag_mm_max.unwrap_or(0.0), 0.0, "{at}");
        assert_eq!(phase.jitter_mm_max.unwrap_or(0.0), 0.0, "{at}");
    }
    let contacts: u32 = run.phases.iter().map(|phase| phase.contacts_max).sum();
    assert!(contacts > 0, "the hand touched nothing");
}

#[test]
fn the_hand_scene_keeps_its_promises() {
    let hand = Hand::load().unwrap();
    for ball in [Ball::Sphere, Ball::Hull] {
        for noise in [false, true] {
            assert_promises(&scene(&hand, ball, noise));
        }
    }
}

#[test]
fn the_gallery_is_as_large_as_the_papers() {
    let objects = gallery::gallery();
    assert_eq!(gallery::triangles(&objects), 476);
    assert!((18..=24).contains(&objects.len()), "{}", objects.len());
}

fn step(world: &mut World, hand: &Hand, ids: &Ids, script: &mut Script, frame: u32) {
    let target = script.target(frame);
    world
        .set_target(ids.hand, &hand_scene::wrist(&target))
        .unwrap();
    world
        .set_piece_targets(ids.hand, &hand_scene::locals(hand, &target))
        .unwrap();
    world.step(&FrameInput::unlimited(1.0 / 60.0));
}

#[test]
fn the_judge_sees_a_hand_that_is_moved_into_the_table() {
    let hand = Hand::load().unwrap();
    let mut block = Block::new(&CAPACITIES);
    let mut world = World::create(block.bytes(), &CAPACITIES).unwrap();
    let mut script = Script::new(None);
    let ids = hand_scene::fill(&mut world, &hand, Ball::Sphere, &script.target(0)).unwrap();
    for frame in 0..1400 {
        step(&mut world, &hand, &ids, &mut script, frame);
    }
    let judge = hand_scene::judge(&hand, Ball::Sphere).unwrap();
    let mut poses = hand_scene::published(&world, &ids).unwrap();
    assert_eq!(judge.frame(&poses).depth_between(HAND, FIXED), 0.0);
    for pose in &mut poses {
        pose.position.y -= 1e-3;
    }
    let verdict = judge.frame(&poses);
    let depth = verdict.depth_between(HAND, FIXED);
    assert!(
        (0.9e-3..=1e-3).contains(&depth),
        "the hand rests at {depth}"
    );
    let ball = verdict.depth_between(BALL, FIXED);
    assert!((0.95e-3..=1e-3).contains(&ball), "the ball rests at {ball}");
}

#[test]
fn a_snapshot_goes_on_at_another_address_with_the_same_bits() {
    let hand = Hand::load().unwrap();
    let mut block = Block::new(&CAPACITIES);
    let mut world = World::create(block.bytes(), &CAPACITIES).unwrap();
    let mut script = Script::new(None);
    let ids = hand_scene::fill(&mut world, &hand, Ball::Hull, &script.target(0)).unwrap();
    let mut copy = None;
    let mut saved = Vec::new();
    for frame in 0..FRAMES {
        if frame == 1000 {
            saved = vec![0; world.snapshot_bytes()];
            world.save(&mut saved).unwrap();
            copy = Some(Block::new(&CAPACITIES));
        }
        step(&mut world, &hand, &ids, &mut script, frame);
    }
    let mut copy = copy.unwrap();
    let mut other = World::create(copy.bytes(), &CAPACITIES).unwrap();
    other.load(&saved).unwrap();
    assert_ne!(other.hash(), world.hash());
    for frame in 1000..FRAMES {
        step(&mut other, &hand, &ids, &mut script, frame);
    }
    assert_eq!(other.hash(), world.hash());
}

#[test]
fn nothing_is_slapped_through_a_wall() {
    let hand = Hand::load().unwrap();
    let all = slaps::slaps();
    assert_eq!(all.len(), 60);
    let found = slaps::run(&hand, &all).unwrap();
    assert_eq!(found.parts_behind, 0);
    assert!(found.overlap_mm_max <= HAND_FIXED_OVERLAP_MM_MAX);
}
