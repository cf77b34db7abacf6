//! The promises of loose bodies on cases with exact answers, each on its own, and the run's output.
//! Times are taken nowhere here.

use palpable_lab::accuracy::impulses::cradle::{GAPS_M, VELOCITY_BOUND_M_S, largest_off_m_s};
use palpable_lab::accuracy::impulses::engine::{RATES_HZ, Setup, Subject};
use palpable_lab::accuracy::impulses::impacts::{
    MOMENTUM_BOUND, RISE_BOUND, impact, impacts, scene,
};
use palpable_lab::accuracy::impulses::orders::{ORDERS, Posed};
use palpable_lab::accuracy::impulses::piles::{
    CREEP_BOUND_M, OVERLAP_BOUND_M, heap, stack_creep_m,
};
use palpable_lab::accuracy::impulses::robust::{self, Hard, rise};
use palpable_lab::accuracy::impulses::row::{Case, Row};
use palpable_lab::accuracy::impulses::slope::{self, Tilted, creep_m};
use palpable_lab::accuracy::impulses::{
    ImpulsePlan, bounce, coupling, error_time_svg, failures, glide, orders_svg, run, tables, tumble,
};

const SEED: u64 = 1;

fn kernel(rate_hz: f64) -> Setup {
    Setup {
        subject: Subject::Palpable,
        rate_hz,
        timed: false,
    }
}

/// All rates, each told apart when one fails.
fn at_all_rates(check: impl Fn(&Setup)) {
    for rate_hz in RATES_HZ {
        println!("{rate_hz} Hz");
        check(&kernel(rate_hz));
    }
}

/// Asserts what is promised of the rows whose name begins so.
fn promised(rows: &[Row], name: &str) {
    let of = rows
        .iter()
        .filter(|row| row.quantity.name.starts_with(name));
    let mut count = 0;
    for row in of {
        println!("{row:?}");
        assert_eq!(row.passes, Some(true), "{row:?}");
        count += 1;
    }
    assert!(count > 0, "no row is called {name}");
}

fn rest_is_in_time(restitution: f64) {
    at_all_rates(|setup| {
        let exact = bounce::rest_s(restitution);
        let (rest, ..) = bounce::measure(setup, restitution);
        let off = (rest / exact - 1.0).abs();
        assert!(off <= bounce::REST_BOUND, "{rest} s, off by {off}");
    });
}

#[test]
fn a_dropped_ball_rests_in_time_with_a_restitution_of_three_tenths() {
    rest_is_in_time(0.3);
}

#[test]
fn a_dropped_ball_rests_in_time_with_a_restitution_of_a_half() {
    rest_is_in_time(0.5);
}

#[test]
fn a_dropped_ball_rests_in_time_with_a_restitution_of_nine_tenths() {
    rest_is_in_time(0.9);
}

#[test]
fn a_block_stops_when_it_should() {
    at_all_rates(|setup| promised(&glide::slide_rows(setup), "time to stop"));
}

#[test]
fn a_block_stops_where_it_should() {
    at_all_rates(|setup| promised(&glide::slide_rows(setup), "way to stop"));
}

#[test]
fn a_ball_rolls_as_fast_as_it_should() {
    at_all_rates(|setup| promised(&glide::roll_rows(setup), "rolling speed"));
}

#[test]
fn a_ball_rolls_as_far_as_it_should() {
    at_all_rates(|setup| promised(&glide::roll_rows(setup), "x after 1 s"));
}

fn as_many_go_as_came(coming: usize, gap_m: f64) {
    at_all_rates(|setup| {
        let (off, _) = largest_off_m_s(setup, coming, gap_m);
        assert!(off <= VELOCITY_BOUND_M_S, "{off} m/s");
    });
}

#[test]
fn one_ball_in_one_out_of_a_row_that_touches() {
    as_many_go_as_came(1, GAPS_M[0]);
}

#[test]
fn one_ball_in_one_out_of_a_row_with_gaps() {
    as_many_go_as_came(1, GAPS_M[1]);
}

#[test]
fn two_balls_in_two_out_of_a_row_that_touches() {
    as_many_go_as_came(2, GAPS_M[0]);
}

#[test]
fn two_balls_in_two_out_of_a_row_with_gaps() {
    as_many_go_as_came(2, GAPS_M[1]);
}

fn holds_on_a_slope(tilted: Tilted) {
    at_all_rates(|setup| {
        let (creep, _) = creep_m(setup, tilted);
        assert!(creep <= slope::CREEP_BOUND_M, "{creep} m");
    });
}

fn slides_down_a_slope(tilted: Tilted) {
    at_all_rates(|setup| {
        let (found, _) = slope::acceleration(setup, tilted);
        let off = (found / slope::exact_acceleration() - 1.0).abs();
        assert!(off <= slope::SLIDING_BOUND, "{found} m/s2, off by {off}");
    });
}

#[test]
fn a_box_holds_under_tilted_gravity() {
    holds_on_a_slope(Tilted::Gravity);
}

#[test]
fn a_box_holds_on_a_tilted_plane() {
    holds_on_a_slope(Tilted::Plane);
}

#[test]
fn a_box_slides_under_tilted_gravity() {
    slides_down_a_slope(Tilted::Gravity);
}

#[test]
fn a_box_slides_down_a_tilted_plane() {
    slides_down_a_slope(Tilted::Plane);
}

/// Steps of the free body: a hundredth of the million of the full run, or as many as its flips take.
fn steps(setup: &Setup) -> u32 {
    setup.frames(120.0)
}

#[test]
fn a_free_body_flips_in_time() {
    at_all_rates(|setup| promised(&tumble::rows(setup, steps(setup)), "time between flips"));
}

#[test]
fn a_free_body_keeps_its_angular_momentum() {
    at_all_rates(|setup| promised(&tumble::rows(setup, steps(setup)), "|L|"));
}

#[test]
fn a_free_body_keeps_its_energy() {
    at_all_rates(|setup| promised(&tumble::rows(setup, steps(setup)), "energy"));
}

#[test]
fn the_spring_is_exact_however_it_is_split() {
    at_all_rates(|setup| {
        for name in ["x after", "v after"] {
            promised(&coupling::rows(setup), name);
        }
    });
}

#[test]
fn random_impacts_gain_no_energy() {
    at_all_rates(|setup| {
        let (found, _) = impacts(setup, SEED, 300);
        println!("{found:?}");
        assert!(found.met >= 200, "{found:?}");
        assert_eq!(found.not_finite, 0, "{found:?}");
        assert!(found.rise_max <= RISE_BOUND, "{found:?}");
    });
}

/// The impacts with these indices, all spins times `spun`.
fn gain_no_energy_and_lose_no_momentum(setup: &Setup, indices: &[u32], spun: f64) {
    for &index in indices {
        let (mut scene, seconds) = scene(SEED, index);
        for body in &mut scene.bodies {
            body.spin *= spun;
        }
        let (found, _) = impact(setup, &scene, seconds);
        assert!(found.rise <= RISE_BOUND, "{index}: {found:?}");
        assert!(found.momentum_off <= MOMENTUM_BOUND, "{index}: {found:?}");
    }
}

#[test]
fn what_turns_by_radians_in_a_frame_gains_no_energy() {
    let at_60_hz = [785, 807, 1334, 1488, 2345, 2789, 4143, 4231, 4246, 4511];
    gain_no_energy_and_lose_no_momentum(&kernel(60.0), &at_60_hz, 1.0);
    let at_90_hz = [785, 807, 936, 2755, 2789, 4720, 5341, 9639];
    gain_no_energy_and_lose_no_momentum(&kernel(90.0), &at_90_hz, 1.0);
}

#[test]
fn what_turns_faster_than_its_way_gains_no_energy() {
    let indices: Vec<u32> = (2900..3000).collect();
    gain_no_energy_and_lose_no_momentum(&kernel(60.0), &indices, 100.0);
    gain_no_energy_and_lose_no_momentum(&kernel(90.0), &indices, 100.0);
}

#[test]
fn bodies_that_slide_on_each_other_do_not_stop_in_the_air() {
    at_all_rates(|setup| {
        let (found, _) = impacts(setup, SEED, 300);
        assert!(found.momentum_off_max <= MOMENTUM_BOUND, "{found:?}");
    });
}

#[test]
fn equal_seeds_give_equal_impacts() {
    assert_eq!(scene(SEED, 3), scene(SEED, 3));
    assert_ne!(scene(SEED, 3), scene(SEED, 4));
    let again = [0, 1].map(|_| impacts(&kernel(90.0), SEED, 20).0);
    assert_eq!(again[0], again[1]);
}

fn no_energy_is_gained(hard: Hard) {
    for rate_hz in robust::RATES_HZ {
        let setup = kernel(rate_hz);
        let (rise_j, start_j, _) = rise(&setup, hard);
        println!("{rate_hz} Hz: {rise_j} J of {start_j} J");
        assert!(
            rise_j <= robust::restored_j(hard),
            "{rate_hz} Hz: {rise_j} J"
        );
    }
}

#[test]
fn a_heavy_box_on_a_light_one_gains_no_energy() {
    no_energy_is_gained(Hard::HeavyOnLight);
}

#[test]
fn a_light_box_on_a_heavy_one_gains_no_energy() {
    no_energy_is_gained(Hard::LightOnHeavy);
}

#[test]
fn a_jammed_rod_gains_no_energy() {
    no_energy_is_gained(Hard::Rod);
}

#[test]
fn a_thrown_rod_gains_no_energy() {
    no_energy_is_gained(Hard::RodThrown);
}

#[test]
fn an_elastic_rod_gains_no_energy() {
    no_energy_is_gained(Hard::RodElastic);
}

#[test]
fn a_heap_comes_to_rest() {
    for rate_hz in [60.0, 90.0] {
        let (found, _) = heap(&kernel(rate_hz), SEED, 6.0);
        assert!(found.rest_s.is_some(), "{rate_hz} Hz");
    }
}

#[test]
fn a_heap_does_not_overlap() {
    for rate_hz in [60.0, 90.0] {
        let (found, _) = heap(&kernel(rate_hz), SEED, 3.0);
        let overlap_m = found.overlap_m;
        assert!(overlap_m <= OVERLAP_BOUND_M, "{rate_hz} Hz: {overlap_m} m");
    }
}

#[test]
fn a_stack_of_eight_does_not_creep() {
    at_all_rates(|setup| {
        let (creep, _) = stack_creep_m(setup, 60.0);
        assert!(creep <= CREEP_BOUND_M, "{creep} m");
    });
}

/// Short cases: the peer is not optimised in tests.
#[test]
fn a_run_is_told_in_tables_and_a_figure() {
    for case in [Case::Slide, Case::Cradle, Case::Orders] {
        let plan = ImpulsePlan {
            only: Some(case),
            timed: false,
            ..ImpulsePlan::full(SEED)
        };
        let mut ticks = 0;
        let found = run(&plan, || ticks += 1);
        assert_eq!(ticks, plan.ticks());
        let text = tables(&found) + &failures(&found);
        assert!(text.contains(case.name()), "{case:?} is missing");
        if case == Case::Orders {
            for posed in Posed::ALL {
                assert!(text.contains(posed.name()), "{posed:?} is missing");
            }
            let svg = orders_svg(&found.orders);
            let document = roxmltree::Document::parse(&svg).unwrap();
            let lines = document
                .descendants()
                .filter(|n| n.has_tag_name("polyline"));
            assert!(lines.count() >= Posed::ALL.len() * ORDERS.len());
            continue;
        }
        for subject in Subject::ALL {
            assert!(found.rows.iter().any(|row| row.subject == subject));
        }
        let svg = error_time_svg(&found);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let dots = document.descendants().filter(|n| n.has_tag_name("circle"));
        assert!(dots.count() >= 9);
    }
}
