//! The promises of the chains' solvers, from the outside, and the run's output.

use palpable_lab::accuracy::reach::cases::{Class, case};
use palpable_lab::accuracy::reach::chains::Model;
use palpable_lab::accuracy::reach::measure::{Judged, Method, Row, STEPS, judged, rows};
use palpable_lab::accuracy::reach::motion::drifts;
use palpable_lab::accuracy::reach::{
    ReachPlan, run, solved_by_steps_svg, solved_by_time_svg, tables,
};

const SEED: u64 = 1;

/// How far limits and cones may be left, in radians.
const OUTSIDE_RAD: f64 = 1e-5;

fn measured(model: Model, class: Class, cases: u32) -> Vec<Row> {
    let judged: Vec<Judged> = judged(&model.chain(), class, SEED, cases);
    assert_eq!(judged.len() as u32, cases);
    let rows = rows(model, class, &judged, false);
    for row in &rows {
        println!("{row:?}");
        if row.method != Method::Jacobian {
            assert!(row.violation_rad <= OUTSIDE_RAD, "{row:?}");
        }
    }
    rows
}

fn share(row: &Row, steps: u32) -> f64 {
    row.solved[STEPS.iter().position(|&s| s == steps).unwrap()]
}

fn of(rows: &[Row], method: Method) -> &Row {
    rows.iter().find(|row| row.method == method).unwrap()
}

#[test]
fn equal_seeds_give_equal_cases() {
    for class in Class::ALL {
        let chain = Model::BallArm.chain();
        assert_eq!(case(&chain, class, SEED, 3), case(&chain, class, SEED, 3));
        assert_ne!(case(&chain, class, SEED, 3), case(&chain, class, SEED, 4));
    }
}

#[test]
fn pushes_are_met_in_four_steps_near_the_optimum() {
    let rows = measured(Model::Arm, Class::Push, 2000);
    let least = of(&rows, Method::LeastDeviation);
    // These pushes begin anywhere within the limits and are possible from some posture; three of the
    // 2000 need more than four steps or another posture. Those of `tests/reach.rs` begin a tenth of the
    // ranges inside and are possible from the tracked posture: all are met within four.
    assert!(
        share(least, 4) >= 0.998 && share(least, 8) >= 0.999,
        "{least:?}"
    );
    assert!(least.ratio.unwrap().p95 <= 1.03, "{least:?}");
    let descent = of(&rows, Method::CyclicDescent);
    for (steps, aim) in [(2, 0.11), (4, 0.33), (8, 0.64), (16, 0.83), (64, 0.975)] {
        assert!(share(descent, steps) >= aim, "{steps}: {descent:?}");
    }
}

#[test]
fn far_reaches_are_all_met() {
    let rows = measured(Model::Arm, Class::Reach, 200);
    let least = of(&rows, Method::LeastDeviation);
    assert!(share(least, 64) >= 1.0, "{least:?}");
}

#[test]
fn hard_reaches_are_met() {
    for class in [Class::Straight, Class::Limits] {
        let rows = measured(Model::Arm, class, 150);
        let least = of(&rows, Method::LeastDeviation);
        assert!(share(least, 64) >= 0.97, "{least:?}");
    }
}

#[test]
fn cones_are_kept_in_and_out_of_reach() {
    for class in [Class::Push, Class::Reach, Class::Limits, Class::Beyond] {
        measured(Model::BallArm, class, 60);
    }
}

#[test]
fn closed_loops_do_not_drift() {
    let drifts = drifts(SEED, 6);
    let least = &drifts[1];
    assert_eq!(least.method, Method::LeastDeviation);
    assert!(least.drift_deg.unwrap().median < 0.1, "{least:?}");
}

#[test]
fn a_run_is_told_in_tables_and_figures() {
    let plan = ReachPlan {
        seed: SEED,
        cases: 4,
        loops: 1,
        timed: true,
    };
    let mut ticks = 0;
    let found = run(&plan, || ticks += 1);
    assert_eq!(ticks, plan.ticks());
    let text = tables(&found);
    for class in Class::ALL {
        let names = text.contains(class.name()) || class == Class::Beyond;
        assert!(names, "{class:?} is missing");
    }
    for svg in [solved_by_steps_svg(&found), solved_by_time_svg(&found)] {
        let document = roxmltree::Document::parse(&svg).unwrap();
        let dots = document.descendants().filter(|n| n.has_tag_name("circle"));
        assert!(dots.count() >= 13 * 3 * STEPS.len());
    }
}
