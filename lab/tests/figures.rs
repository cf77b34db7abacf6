//! What must hold of avatars and hands with joints, in shorter versions of the lab's scenes.

use palpable::geometry::chain::{Hinge, JointDef};
use palpable::math::Pose;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, World};
use palpable_lab::avatar::motions::{MOTION_HEIGHT_M, MotionKind};
use palpable_lab::avatar::{AvatarPlan, Style, Trunk};
use palpable_lab::figures::capture::{CaptureError, Clip};
use palpable_lab::figures::grasps::Grasps;
use palpable_lab::figures::judge::{Judge, add_things};
use palpable_lab::figures::play::{CAPACITIES, Scene, Thing, play};
use palpable_lab::figures::scenes::{AVATAR_OPTIONS, of_motion};
use palpable_lab::figures::suite::Suite;
use palpable_lab::figures::summary::summary;
use palpable_lab::figures::{Figure, FigureChain, FigurePiece, add, wrist};
use palpable_lab::hand::Hand;
use palpable_lab::memory::Block;
use palpable_lab::report::{BEYOND_LIMITS_RAD_MAX, FigureScene, WRIST_OFF_MM_MAX};

/// Frames of a scene: the first push of the wall, and all but the end of the others.
const FRAMES: u32 = 540;

/// How far the published pieces may be from forward kinematics in f64: rounding of f32 at some metres.
const ASTRAY_MM_MAX: f64 = 0.01;

fn played(scene: &mut Scene) -> FigureScene {
    scene.frames = scene.frames.min(FRAMES);
    let done = play(scene, || ()).unwrap();
    summary("figure", scene, &done).unwrap()
}

/// What holds in every scene, whatever the method.
fn assert_kept(scene: &FigureScene) {
    let name = &scene.name;
    assert!(
        scene.overlap_fixed_mm_max <= 0.1,
        "{name}: {} mm",
        scene.overlap_fixed_mm_max
    );
    assert!(
        scene.overlap_own_mm_max <= 1.0,
        "{name}: {} mm",
        scene.overlap_own_mm_max
    );
    assert!(
        scene.overlap_loose_mm_max <= 1.0,
        "{name}: {} mm",
        scene.overlap_loose_mm_max
    );
    let beyond = scene.beyond_limits_rad_max;
    assert!(beyond <= BEYOND_LIMITS_RAD_MAX, "{name}: {beyond} rad");
    assert!(
        scene.astray_mm_max <= ASTRAY_MM_MAX,
        "{name}: {} mm",
        scene.astray_mm_max
    );
    assert_eq!(scene.steps_untouched, 0, "{name}: steps without touch");
    assert!(scene.contacts_max > 0, "{name}: nothing touches");
}

fn avatar(style: Style) -> Figure {
    Figure::of_avatar(&AvatarPlan::new(MOTION_HEIGHT_M, style, Trunk::Rigid))
}

fn assert_motions_kept(style: Style) {
    let figure = avatar(style);
    for kind in MotionKind::ALL {
        let scene = played(&mut of_motion(&figure, kind, AVATAR_OPTIONS));
        assert_kept(&scene);
        assert!(
            scene.jump_deg_max <= 3.0,
            "{}: {}",
            scene.name,
            scene.jump_deg_max
        );
        assert!(
            scene.root_off_mm_max <= 5.0,
            "{}: {}",
            scene.name,
            scene.root_off_mm_max
        );
        if let Some(rest) = scene.rest {
            assert!(rest.moving_frames < rest.frames, "{}: {rest:?}", scene.name);
        }
    }
}

#[test]
fn an_avatar_of_hulls_keeps_out() {
    assert_motions_kept(Style::Hulls);
}

#[test]
fn an_avatar_of_capsules_keeps_out() {
    assert_motions_kept(Style::Capsules);
}

#[test]
fn cyclic_descent_keeps_out_of_the_wall() {
    let options = ChainOptions {
        method: ChainOptions::CYCLIC_DESCENT,
        ..AVATAR_OPTIONS
    };
    let figure = avatar(Style::Hulls);
    assert_kept(&played(&mut of_motion(
        &figure,
        MotionKind::PushWall,
        options,
    )));
}

#[test]
fn hands_keep_out_of_tables_balls_and_handles() {
    let grasps = Grasps::new(&Hand::load().unwrap());
    for scene in &mut grasps.scenes().unwrap() {
        assert_kept(&played(scene));
    }
}

#[test]
fn fingers_slide_round_balls_and_handles_without_a_jump() {
    let grasps = Grasps::new(&Hand::load().unwrap());
    // The tracked fingers turn by 1.14 degrees a frame at most.
    for scene in &mut grasps.scenes().unwrap()[2..4] {
        let played = summary("hand", scene, &play(scene, || ()).unwrap()).unwrap();
        let jump = played.jump_deg_max;
        assert!(jump <= 3.0, "{}: {jump}", played.name);
    }
}

#[test]
fn fingers_stop_on_their_own() {
    let grasps = Grasps::new(&Hand::load().unwrap());
    for scene in &mut grasps.scenes().unwrap()[2..4] {
        // Closed, and held there.
        scene.frames = 200;
        let done = played(scene);
        let adjusted = done.samples.last().unwrap().adjusted;
        assert!(adjusted >= 8, "{}: {adjusted} hinges", scene.name);
        assert!(
            done.root_off_mm_max < 1.0,
            "{}: {}",
            scene.name,
            done.root_off_mm_max
        );
    }
}

#[test]
fn no_slap_of_the_arm_goes_through() {
    let suite = Suite::new(&Hand::load().unwrap()).unwrap();
    let slaps = suite.slaps(40, || ()).unwrap();
    assert_eq!(slaps.slaps, 40);
    assert!(slaps.tunnelled_speeds.is_empty(), "{slaps:?}");
    assert!(
        slaps.overlap_mm_max <= 0.1 && slaps.overlap_own_mm_max <= 1.0,
        "{slaps:?}"
    );
    assert!(
        slaps.beyond_limits_rad_max <= BEYOND_LIMITS_RAD_MAX,
        "{slaps:?}"
    );
    assert!(slaps.touched > 30, "{slaps:?}");
}

/// Whole avatars, and arms alone.
const WRISTS: [(Style, bool); 4] = [
    (Style::Hulls, false),
    (Style::Capsules, false),
    (Style::Hulls, true),
    (Style::Capsules, true),
];

/// Of a whole avatar, or of its arm alone.
fn wrist_in_a_wall(style: Style, alone: bool) -> FigureScene {
    let plan = AvatarPlan::new(MOTION_HEIGHT_M, style, Trunk::Rigid);
    let figure = Figure::of_avatar(&plan);
    let arm = wrist::right_arm(&plan, &figure).unwrap();
    let mut scene = if alone {
        wrist::arm_into_wall(&plan, &arm).unwrap()
    } else {
        wrist::into_wall(&plan, &figure).unwrap()
    };
    let done = play(&scene, || ()).unwrap();
    scene.name += ", all frames";
    summary("figure", &scene, &done).unwrap()
}

#[test]
fn an_arm_led_by_the_wrist_keeps_out() {
    for (style, alone) in WRISTS {
        let scene = wrist_in_a_wall(style, alone);
        assert_kept(&scene);
        assert!(scene.root_off_mm_max <= 1.0, "{}", scene.root_off_mm_max);
    }
}

#[test]
fn a_wrist_stays_nearest_to_its_tracker() {
    for (style, alone) in WRISTS {
        let scene = wrist_in_a_wall(style, alone);
        let (wrist, rest) = (scene.wrist.unwrap(), scene.rest.unwrap());
        assert!(wrist.off_mm_max <= WRIST_OFF_MM_MAX, "{style:?}: {wrist:?}");
        assert!(
            scene.jump_deg_max <= 3.0,
            "{style:?}: {}",
            scene.jump_deg_max
        );
        assert!(rest.moving_frames < 100, "{style:?}: {rest:?}");
    }
}

/// A bar of 100 mm by 40 mm by 40 mm, 200 mm from a hinge about Z.
fn bar(name: &str, chain: usize) -> FigurePiece {
    FigurePiece {
        name: name.to_owned(),
        link: Some((chain, 0)),
        local: Pose::at(0.2, 0.0, 0.0),
        points: corners([0.05, 0.02, 0.02]),
        radius_m: 0.0,
    }
}

fn corners([x, y, z]: [f32; 3]) -> Vec<[f32; 3]> {
    let signs = [-1.0, 1.0];
    let mut all = Vec::new();
    for a in signs {
        for b in signs {
            for c in signs {
                all.push([a * x, b * y, c * z]);
            }
        }
    }
    all
}

fn two_bars() -> Figure {
    let chain = FigureChain {
        base: None,
        joints: vec![JointDef::Hinge(Hinge {
            rest: Pose::IDENTITY,
            axis: glam::Vec3::Z,
            low_rad: -1.0,
            high_rad: 1.0,
        })],
    };
    Figure {
        chains: vec![chain.clone(), chain],
        pieces: vec![bar("first", 0), bar("second", 1)],
        apart: vec![[0, 1]],
    }
}

/// A box whose top is at a height.
fn block(kind: BodyKind, top_m: f32) -> Thing {
    Thing {
        name: "block".to_owned(),
        kind,
        pose: Pose::at(0.0, top_m - 1.0, 0.0),
        pieces: vec![(Pose::IDENTITY, corners([2.0, 1.0, 2.0]), 0.0)],
    }
}

#[test]
fn the_judge_finds_what_was_put_there() {
    let figure = two_bars();
    let things = [
        block(BodyKind::Fixed, -0.013),
        block(BodyKind::Dynamic, -0.018),
    ];
    for angle in [0.0_f32, -0.1, 0.05, -0.3] {
        let mut memory = Block::new(&CAPACITIES);
        let mut world = World::create(memory.bytes(), &CAPACITIES).unwrap();
        let body = BodyDef::new(BodyKind::Driven, Pose::IDENTITY);
        let ids = add(&mut world, &figure, &body, &ChainOptions::DEFAULT).unwrap();
        let bodies = add_things(&mut world, &things).unwrap();
        world.place_angles(ids.chains[0], &[angle]).unwrap();
        world.place_angles(ids.chains[1], &[angle + 0.05]).unwrap();
        let mut judge = Judge::new(&figure, &things, &bodies).unwrap();
        let found = judge.frame(&world, &ids).unwrap();
        let (sin, cos) = f64::from(angle).sin_cos();
        // The lowest corner: the far one when the bar points down, else the near one.
        let low_m = (0.25 * sin).min(0.15 * sin) - 0.02 * cos;
        let near = |found: f64, depth_m: f64| (found - 1e3 * depth_m.max(0.0)).abs() < 1e-4;
        assert!(near(found.fixed_mm, -0.013 - low_m), "{angle}: {found:?}");
        assert!(near(found.loose_mm, -0.018 - low_m), "{angle}: {found:?}");
        // Nearly the same bar, 10 mm aside: out by its height less that.
        assert!(
            found.own_mm > 25.0 && found.own_mm < 35.0,
            "{angle}: {found:?}"
        );
        assert!(found.astray_mm < 1e-3, "{angle}: {found:?}");
    }
}

#[test]
fn a_broken_file_is_refused_with_its_line() {
    let path = std::env::temp_dir().join(format!("palpable-figures-{}.bvh", std::process::id()));
    std::fs::write(&path, "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0 nought\n").unwrap();
    let refused = Clip::read(&path, Style::Capsules);
    std::fs::remove_file(&path).unwrap();
    let Err(CaptureError::File(why)) = refused else {
        panic!("a broken file was read");
    };
    assert_eq!(why.line, 4, "{why}");
}
