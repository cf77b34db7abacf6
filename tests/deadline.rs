//! Budgets in units and in time: what is spent, what a frame that is cut leaves behind, and who goes first.

mod common;
#[path = "common/loose.rs"]
mod loose;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/shapes.rs"]
mod shapes;

use std::cell::Cell;

use common::{Block, add_box, add_piece};
use loose::{ball, floor, position};
use palpable::frame::{Budget, CostTable, Deadline, FrameInput, FrameReport};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, DrivenReport};
use palpable::world::{BodyDef, PieceDef, Shape, World};
use scenes::{FRAME_S, Scene};
use shapes::Random;

type Named = (&'static str, fn() -> Scene);

const SCENES: [Named; 5] = [
    ("falling sphere", scenes::falling_sphere),
    ("pushed stack", scenes::pushed_stack),
    ("sliding hand", scenes::sliding_hand),
    ("compound in a corner", scenes::compound_in_a_corner),
    ("two arms", scenes::two_arms),
];

/// Prices that are not alike, so that it matters which stage a unit belongs to.
const COSTS: CostTable = CostTable {
    frame_ns: 700,
    body_ns: 40,
    piece_ns: 15,
    chain_ns: 90,
    boxes_ns: 300,
    advance_unit_ns: 2300,
    impulse_unit_ns: 3100,
    reach_step_ns: 5900,
};

fn deadline(time_ns: u64) -> Deadline {
    Deadline {
        time_ns,
        costs: COSTS,
    }
}

/// Less than a bound.
fn below(random: &mut Random, bound: u32) -> u32 {
    (random.bits() % u64::from(bound)) as u32
}

/// What must be said of every frame with a deadline.
fn check_accounts(report: &FrameReport, time_ns: u64) {
    let of = |price: u32, count: u32| u64::from(price) * u64::from(count);
    let units = of(COSTS.advance_unit_ns, report.advance_units)
        + of(COSTS.impulse_unit_ns, report.impulse_units)
        + of(COSTS.reach_step_ns, report.reach_steps);
    assert_eq!(report.priced_ns, report.floor_ns + units);
    let is_below = report.flags & FrameReport::BELOW_FLOOR != 0;
    assert_eq!(is_below, time_ns < report.floor_ns);
    assert!(units <= time_ns.saturating_sub(report.floor_ns));
}

/// Runs a scene beside its twin, which is stepped with the units that the first one reported and nothing
/// else; how many frames were cut.
fn replays(
    name: &str,
    make: fn() -> Scene,
    step: &mut dyn FnMut(&mut Scene) -> FrameReport,
) -> u32 {
    let (mut first, mut twin) = (make(), make());
    let mut cut = 0;
    for frame in 0..200 {
        let report = step(&mut first);
        let again = twin.step_with(&FrameInput {
            budget: report.spent(),
            ..FrameInput::unlimited(FRAME_S)
        });
        assert_eq!(again.spent(), report.spent(), "{name}, frame {frame}");
        assert_eq!(
            first.world.hash(),
            twin.world.hash(),
            "{name}, frame {frame}"
        );
        let says = FrameReport::OUT_OF_TIME | FrameReport::LATE;
        cut += u32::from(report.flags & says != 0);
    }
    cut
}

#[test]
fn the_reported_units_replay_a_frame_that_a_deadline_cut() {
    for (name, make) in SCENES {
        let mut random = Random(7);
        let cut = replays(name, make, &mut |scene| {
            let time_ns = u64::from(below(&mut random, 120_000));
            let report = scene.step_with(&FrameInput::within(FRAME_S, deadline(time_ns)));
            check_accounts(&report, time_ns);
            report
        });
        assert!(cut > 10, "{name}: {cut} frames were cut");
    }
}

#[test]
fn the_reported_units_replay_a_frame_that_a_clock_cut() {
    for (name, make) in SCENES {
        let mut random = Random(8);
        let cut = replays(name, make, &mut |scene| {
            let now = Cell::new(0);
            // Time passes between any two looks at the clock.
            let clock = || {
                now.set(now.get() + 1);
                now.get()
            };
            scene.tell();
            let input = FrameInput::unlimited(FRAME_S);
            scene
                .world
                .step_by_clock(&input, &clock, u64::from(below(&mut random, 40)))
        });
        assert!(cut > 10, "{name}: {cut} frames were cut");
    }
}

#[test]
fn the_reported_units_replay_any_budget() {
    for (name, make) in SCENES {
        let mut random = Random(9);
        replays(name, make, &mut |scene| {
            let mut few = || match below(&mut random, 4) {
                0 => u32::MAX,
                _ => below(&mut random, 30),
            };
            let budget = Budget {
                advance_units: few(),
                impulse_units: few(),
                reach_steps: few(),
            };
            let report = scene.step_with(&FrameInput {
                budget,
                ..FrameInput::unlimited(FRAME_S)
            });
            assert!(report.advance_units <= budget.advance_units, "{name}");
            assert!(report.impulse_units <= budget.impulse_units, "{name}");
            assert!(report.reach_steps <= budget.reach_steps, "{name}");
            report
        });
    }
}

#[test]
fn a_deadline_that_is_long_enough_changes_nothing() {
    for (name, make) in SCENES {
        let (mut first, mut twin) = (make(), make());
        for _ in 0..100 {
            let report = first.step_with(&FrameInput::within(FRAME_S, deadline(1 << 40)));
            assert_eq!(report.flags & FrameReport::OUT_OF_TIME, 0, "{name}");
            twin.step();
        }
        assert_eq!(first.world.hash(), twin.world.hash(), "{name}");
    }
}

#[test]
fn the_floor_is_known_before_the_frame() {
    for (name, make) in SCENES {
        let mut scene = make();
        let floor_ns = scene.world.floor_ns(&COSTS);
        let report = scene.step_with(&FrameInput::within(FRAME_S, deadline(floor_ns)));
        assert_eq!(report.floor_ns, floor_ns, "{name}");
        assert_eq!(report.spent().advance_units, 0, "{name}");
        assert_eq!(report.flags & FrameReport::BELOW_FLOOR, 0, "{name}");
    }
}

/// A world with room, and a fixed wall whose face is at x = 0.
/// Who stays behind others is looked for, and paid for, only where there are others and what could stop them.
#[test]
fn a_lone_driven_body_pays_for_no_others() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    for count in 1..4_u64 {
        add_box(
            &mut world,
            BodyKind::Driven,
            Pose::at(count as f32, 1.0, 0.0),
            [0.1; 3],
        );
        assert_eq!(world.census().box_tests(), count * count);
    }
    add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 5.0, 0.0),
        [0.1; 3],
    );
    let among_all = 3 * 4;
    let islands = 2 * 4;
    assert_eq!(world.census().box_tests(), among_all + islands + 3 * 3);
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 1.0, 0.0),
        [0.1; 3],
    );
    add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 5.0, 0.0),
        [0.1; 3],
    );
    assert_eq!(world.census().box_tests(), 2 + 2 * 2);
}

fn walled() -> World<'static> {
    let block = Box::leak(Box::new(Block::new(&Capacities::ROOM)));
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(-0.5, 0.0, 0.0),
        [0.5, 5.0, 5.0],
    );
    world
}

/// Driven boxes in front of the wall, their trackers behind it, `count` of them one above the other.
fn pressing(world: &mut World, count: usize) -> Vec<BodyId> {
    (0..count)
        .map(|index| {
            let y = 0.5 * index as f32;
            let body = world
                .add_body(&BodyDef::new(BodyKind::Driven, Pose::at(0.4, y, 0.0)))
                .unwrap();
            add_piece(world, body, &PieceDef::new(Shape::Box([0.05; 3]), 0.0));
            body
        })
        .collect()
}

fn press(world: &mut World, bodies: &[BodyId]) {
    for (index, &body) in bodies.iter().enumerate() {
        let y = 0.5 * index as f32;
        world.set_target(body, &Pose::at(-0.3, y, 0.0)).unwrap();
    }
}

fn is_cut(world: &World, body: BodyId) -> bool {
    world.driven_report(body).unwrap().flags & DrivenReport::CUT != 0
}

#[test]
fn driven_bodies_take_turns_when_there_is_time_for_one() {
    let mut world = walled();
    let bodies = pressing(&mut world, 6);
    let input = FrameInput {
        budget: Budget {
            advance_units: 6,
            ..Budget::UNLIMITED
        },
        ..FrameInput::unlimited(FRAME_S)
    };
    let mut waits = vec![0; bodies.len()];
    let (mut longest, mut frames_cut) = (0, 0);
    for frame in 0..240 {
        // Targets that slide along the wall, so that nobody is ever through with it.
        let z = 0.004 * frame as f32;
        for (index, &body) in bodies.iter().enumerate() {
            let y = 0.5 * index as f32;
            world.set_target(body, &Pose::at(-0.3, y, z)).unwrap();
        }
        let report = world.step(&input);
        frames_cut += u32::from(report.driven_cut > 0);
        for (wait, &body) in waits.iter_mut().zip(&bodies) {
            *wait = if is_cut(&world, body) { *wait + 1 } else { 0 };
            longest = longest.max(*wait);
        }
    }
    assert!(frames_cut > 200, "{frames_cut} frames were cut");
    assert!(
        longest <= 2 * bodies.len() as u32,
        "one waited {longest} frames"
    );
    for &body in &bodies {
        let [x, _, z] = world.pose(body).unwrap().position;
        assert!((0.0499..0.0502).contains(&x), "{x}");
        assert!(z > 0.8, "one is left behind at {z}");
    }
}

/// The search for a way out takes 64 units and more, all or none.
#[test]
fn what_overlaps_gets_out_though_a_frame_has_less_than_the_search_takes() {
    const RADIUS_M: f32 = 0.05;
    const DEEP_M: f64 = 0.03;
    for tracker_y in [0.0, 0.5] {
        let mut world = walled();
        floor(&mut world);
        let at = |y: f32| Pose::at(0.0, y, 3.0);
        let body = ball(
            &mut world,
            BodyKind::Driven,
            [0.0, RADIUS_M - DEEP_M as f32, 3.0],
            RADIUS_M,
        );
        world.set_target(body, &at(tracker_y)).unwrap();
        let few = FrameInput {
            budget: Budget {
                advance_units: 12,
                ..Budget::UNLIMITED
            },
            ..FrameInput::unlimited(FRAME_S)
        };
        let mut deepest = DEEP_M + 1e-6;
        for frame in 0..120 {
            world.step(&few);
            let deep = f64::from(RADIUS_M) - position(&world, body)[1];
            assert!(
                deep <= deepest.max(1e-4),
                "frame {frame}: {deep} after {deepest}"
            );
            deepest = deep;
        }
        assert!(deepest <= 1e-4, "still {deepest}");
    }
}

#[test]
fn what_the_viewer_looks_at_goes_first() {
    for near in 0..4 {
        let mut world = walled();
        let bodies = pressing(&mut world, 4);
        press(&mut world, &bodies);
        let report = world.step(&FrameInput {
            budget: Budget {
                advance_units: 6,
                ..Budget::UNLIMITED
            },
            focus: Some([0.4, 0.5 * near as f32, 0.0]),
            ..FrameInput::unlimited(FRAME_S)
        });
        assert!(report.driven_cut > 0);
        assert!(!is_cut(&world, bodies[near]), "body {near} was cut");
    }
}

/// A heap of spheres that touch each other: one island.
fn heap(world: &mut World) -> Vec<BodyId> {
    floor(world);
    let mut spheres = vec![];
    for index in 0..12 {
        let at = [
            0.09 * (index % 3) as f32,
            0.06 + 0.105 * (index / 3) as f32,
            0.01 * index as f32,
        ];
        spheres.push(ball(world, BodyKind::Dynamic, at, 0.05));
    }
    spheres
}

#[test]
fn an_island_that_is_too_large_for_the_frame_moves_on_in_turns() {
    let block = Box::leak(Box::new(Block::new(&Capacities::ROOM)));
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let spheres = heap(&mut world);
    let before: Vec<_> = spheres.iter().map(|&body| position(&world, body)).collect();
    let input = FrameInput {
        budget: Budget {
            impulse_units: 40,
            ..Budget::UNLIMITED
        },
        ..FrameInput::unlimited(FRAME_S)
    };
    let mut stuck = 0;
    for _ in 0..900 {
        let report = world.step(&input);
        assert!(report.impulse_units <= 40);
        stuck += u32::from(report.kept as usize == spheres.len());
    }
    assert!(stuck > 0, "the budget is not small enough to show anything");
    assert!(stuck < 300, "nothing moved in {stuck} of 900 frames");
    for (&body, before) in spheres.iter().zip(&before) {
        let now = position(&world, body);
        let moved: f64 = (0..3).map(|i| (now[i] - before[i]).powi(2)).sum();
        assert!(moved.sqrt() > 1e-4, "a sphere stayed at {before:?}");
        assert!(now[1] > 0.049, "a sphere sank to {now:?}");
    }
}

#[test]
fn a_busy_island_does_not_starve_a_small_one() {
    let block = Box::leak(Box::new(Block::new(&Capacities::ROOM)));
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    heap(&mut world);
    // The last island by number rolls far away.
    let far = ball(&mut world, BodyKind::Dynamic, [9.0, 0.051, 0.0], 0.05);
    let (linear, angular) = ([0.0, 0.0, 1.0], [20.0, 0.0, 0.0]);
    world.set_velocity(far, linear, angular).unwrap();
    let input = FrameInput {
        budget: Budget {
            impulse_units: 30,
            ..Budget::UNLIMITED
        },
        ..FrameInput::unlimited(FRAME_S)
    };
    for _ in 0..180 {
        world.step(&input);
    }
    // Two seconds at 1 m/s, of which the heap may have most.
    let rolled = position(&world, far)[2];
    assert!(rolled > 0.5, "rolled by {rolled} m");
}

#[test]
fn loose_bodies_have_their_share_of_a_frame_that_driven_ones_would_use_up() {
    let mut world = walled();
    let bodies = pressing(&mut world, 8);
    let sphere = ball(&mut world, BodyKind::Dynamic, [3.0, 3.0, 0.0], 0.05);
    let free = CostTable {
        advance_unit_ns: 1000,
        impulse_unit_ns: 1000,
        reach_step_ns: 1000,
        ..CostTable::default()
    };
    let input = FrameInput::within(
        FRAME_S,
        Deadline {
            time_ns: 16_000,
            costs: free,
        },
    );
    let mut short = 0;
    for frame in 0..30 {
        // Targets that move keep the driven bodies busy.
        for (index, &body) in bodies.iter().enumerate() {
            let y = 0.5 * index as f32 + 0.002 * frame as f32;
            world.set_target(body, &Pose::at(-0.3, y, 0.0)).unwrap();
        }
        short += u32::from(world.step(&input).flags & FrameReport::OUT_OF_TIME != 0);
    }
    assert!(short > 20, "{short} frames were short");
    let fallen = 3.0 - position(&world, sphere)[1];
    let free_fall = 0.5 * 9.81 * (30.0 * f64::from(FRAME_S)).powi(2);
    assert!((fallen - free_fall).abs() < 0.01, "fell by {fallen} m");
}

#[test]
fn a_clock_that_is_over_publishes_the_last_safe_poses() {
    for (name, make) in SCENES {
        let mut scene = make().after(60);
        let before = scene.world.pose(scene.shown).unwrap();
        scene.tell();
        let input = FrameInput::unlimited(FRAME_S);
        let report = scene.world.step_by_clock(&input, &|| 1, 1);
        assert_eq!(report.spent().impulse_units, 0, "{name}");
        let after = scene.world.pose(scene.shown).unwrap();
        let moved: f32 = (0..3)
            .map(|i| (after.position[i] - before.position[i]).abs())
            .sum();
        assert!(moved < 0.05, "{name}: moved by {moved} m");
    }
}

#[test]
fn nobody_moves_twice_in_a_frame() {
    let block = Box::leak(Box::new(Block::new(&Capacities::ROOM)));
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    // One that touches, so that its frames are cut, and one that flies away from what is looked at.
    let rolling = ball(&mut world, BodyKind::Dynamic, [0.0, 0.0501, 0.0], 0.05);
    let flying = ball(&mut world, BodyKind::Dynamic, [0.0, 9.0, 0.0], 0.05);
    let speed = [1.0, 0.0, 0.0];
    world
        .set_velocity(rolling, speed, [0.0, 0.0, -20.0])
        .unwrap();
    world.set_velocity(flying, speed, [0.0; 3]).unwrap();
    let mut cut = 0;
    for frame in 0..120 {
        let before = [rolling, flying].map(|body| position(&world, body)[0]);
        // Frames that are cut and frames that are not: who waited does not wait any more.
        let costs = CostTable {
            impulse_unit_ns: 1000,
            ..CostTable::default()
        };
        let time_ns = [2_000, 60_000, 60_000][frame % 3];
        let report = world.step(&FrameInput {
            focus: Some([-1.0, 0.0, 0.0]),
            ..FrameInput::within(FRAME_S, Deadline { time_ns, costs })
        });
        cut += report.loose_cut;
        for (body, before) in [rolling, flying].into_iter().zip(before) {
            let way = position(&world, body)[0] - before;
            let most = 1.001 * f64::from(FRAME_S);
            assert!(way < most, "frame {frame}: moved by {way} m");
        }
    }
    assert!(cut > 20, "{cut} bodies were cut");
    let flown = position(&world, flying)[0];
    assert!(flown > 0.5, "flew by {flown} m");
}
