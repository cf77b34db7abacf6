//! The spring between tracker and body, against closed forms and an independent integration.

use palpable::couple::SpringMap;
use palpable::state::bodies::Coupling;

fn coupling(mass: f32, stiffness: f32, damping: f32) -> Coupling {
    Coupling {
        mass_kg: mass,
        stiffness_n_per_m: stiffness,
        damping_n_s_per_m: damping,
        ..Coupling::DEFAULT
    }
}

/// Displacement and rate after one map, in f64 so that only the map's own rounding counts.
fn apply(map: &SpringMap, [x, v]: [f64; 2]) -> [f64; 2] {
    [
        f64::from(map.xx) * x + f64::from(map.xv) * v,
        f64::from(map.vx) * x + f64::from(map.vv) * v,
    ]
}

/// Classical Runge-Kutta of m x'' = -K x - R x' with steps no longer than a hundredth of the
/// fastest time constant: relative error below 1e-9 over the times used here.
fn integrate(c: &Coupling, start: [f64; 2], seconds: f64) -> [f64; 2] {
    let k = f64::from(c.stiffness_n_per_m) / f64::from(c.mass_kg);
    let r = f64::from(c.damping_n_s_per_m) / f64::from(c.mass_kg);
    let steps = (seconds * (k.sqrt() + r) * 100.0).ceil().max(16.0);
    let h = seconds / steps;
    let rate = |[x, v]: [f64; 2]| [v, -k * x - r * v];
    let shifted = |s: [f64; 2], d: [f64; 2], h: f64| [s[0] + h * d[0], s[1] + h * d[1]];
    let mut s = start;
    for _ in 0..steps as u64 {
        let a = rate(s);
        let b = rate(shifted(s, a, 0.5 * h));
        let c = rate(shifted(s, b, 0.5 * h));
        let d = rate(shifted(s, c, h));
        for i in 0..2 {
            s[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        }
    }
    s
}

/// Distance of two states in metres, with rates weighed by the time in which the spring answers.
fn apart(c: &Coupling, a: [f64; 2], b: [f64; 2]) -> f64 {
    let k = f64::from(c.stiffness_n_per_m / c.mass_kg).max(1e-30);
    (a[0] - b[0]).abs() + (a[1] - b[1]).abs() / k.sqrt()
}

#[test]
fn the_hard_cases_values_are_met() {
    // x0 = 0.1 m, v0 = 0, K = 1000, R = 40, after 0.1 s. The map's entries are sums of two terms of
    // order one, each rounded about ten times: 1e-6 relative to 0.1 m, and to 0.1 w for the rate.
    let [x, v] = apply(
        &SpringMap::new(&coupling(1.0, 1000.0, 40.0), 0.1),
        [0.1, 0.0],
    );
    assert!((x - -0.003_367_848).abs() < 1e-7, "{x}");
    assert!((v - -0.352_584_633).abs() < 3e-6, "{v}");
    let [x, _] = apply(
        &SpringMap::new(&coupling(0.4, 1000.0, 40.0), 0.1),
        [0.1, 0.0],
    );
    assert!((x - 0.004_042_768).abs() < 1e-7, "{x}");
}

#[test]
fn critical_damping_has_its_closed_form() {
    // x = (x0 + (v0 + a x0) t) e^-at with a = R / 2m = 50 / s.
    let c = coupling(0.4, 1000.0, 40.0);
    let (a, x0, v0) = (50.0, 0.03, -0.4);
    for t in [0.001_f32, 1.0 / 120.0, 1.0 / 60.0, 0.05, 0.1, 0.3] {
        let seconds = f64::from(t);
        let decay = (-a * seconds).exp();
        let slope = v0 + a * x0;
        let expected = [
            (x0 + slope * seconds) * decay,
            (slope - a * (x0 + slope * seconds)) * decay,
        ];
        let got = apply(&SpringMap::new(&c, t), [x0, v0]);
        // 1e-6 of the start: about ten roundings of f32.
        assert!(
            apart(&c, got, expected) < 4e-8,
            "{t} s: {got:?}, not {expected:?}"
        );
    }
}

#[test]
fn all_dampings_match_an_independent_integration() {
    for (mass, stiffness, damping) in [
        (0.4, 1000.0, 0.0),
        (0.4, 1000.0, 4.0),
        (0.4, 1000.0, 39.9),
        (0.4, 1000.0, 40.0),
        (0.4, 1000.0, 40.1),
        (0.4, 1000.0, 80.0),
        (0.4, 1000.0, 400.0),
        (10.0, 50.0, 3.0),
        (0.01, 20.0, 1.0),
    ] {
        let c = coupling(mass, stiffness, damping);
        for t in [1e-4, 1.0 / 1000.0, 1.0 / 90.0, 1.0 / 60.0, 0.1] {
            for start in [[0.1, 0.0], [0.0, 1.0], [-0.02, 3.0]] {
                let got = apply(&SpringMap::new(&c, t), start);
                let expected = integrate(&c, start, f64::from(t));
                // The phase wt and the decay at (up to 50 here) are rounded to f32 before the
                // sine and the exponential see them: 50 * 6e-8 relative, and a few roundings more.
                let bound = 5e-6 * apart(&c, start, [0.0; 2]);
                assert!(
                    apart(&c, got, expected) < bound,
                    "{c:?} after {t} s: {got:?}, not {expected:?}"
                );
            }
        }
    }
}

#[test]
fn a_step_cut_into_parts_is_the_same_step() {
    for c in [
        coupling(1.0, 1000.0, 40.0),
        coupling(0.4, 1000.0, 40.0),
        coupling(0.4, 1000.0, 400.0),
        coupling(2.0, 300.0, 1.0),
    ] {
        for n in [2_u32, 3, 10, 100] {
            let h = 1.0 / 30.0;
            let start = [0.1, -0.7];
            let whole = apply(&SpringMap::new(&c, h), start);
            let part = SpringMap::new(&c, h / n as f32);
            let parts = (0..n).fold(start, |s, _| apply(&part, s));
            // Each of the n maps is rounded to f32 once, in four entries.
            let bound = 4e-7 * f64::from(n) * apart(&c, start, [0.0; 2]);
            assert!(
                apart(&c, whole, parts) < bound,
                "{c:?} in {n} parts: {parts:?}, not {whole:?}"
            );
        }
    }
}

/// The spring's energy over m/2, in f64.
fn energy(c: &Coupling, [x, v]: [f64; 2]) -> f64 {
    f64::from(c.stiffness_n_per_m) / f64::from(c.mass_kg) * x * x + v * v
}

#[test]
fn any_time_step_is_finite_and_takes_energy() {
    for c in [
        coupling(0.4, 1000.0, 40.0),
        coupling(1.0, 1000.0, 40.0),
        coupling(0.4, 1000.0, 400.0),
        coupling(0.4, 1000.0, 1.0),
        coupling(100.0, 1000.0, 40.0),
        coupling(0.001, 1000.0, 40.0),
    ] {
        let mut t = 1e-6_f32;
        while t <= 10.0 {
            let map = SpringMap::new(&c, t);
            for start in [[0.1, 0.0], [0.0, 1.0], [0.1, 1.0], [0.1, -5.0]] {
                let end = apply(&map, start);
                assert!(end[0].is_finite() && end[1].is_finite(), "{c:?} over {t} s");
                // Four rounded entries.
                let rounding = 1.0 + 1e-6;
                assert!(
                    energy(&c, end) <= energy(&c, start) * rounding,
                    "{c:?} over {t} s: {start:?} becomes {end:?}"
                );
            }
            t *= 1.25;
        }
    }
}

#[test]
fn ten_seconds_of_the_default_leave_nothing() {
    let map = SpringMap::new(&Coupling::DEFAULT, 10.0);
    let [x, v] = apply(&map, [1.0, 10.0]);
    // e^-500 underflows.
    assert_eq!([x, v], [0.0, 0.0]);
}

#[test]
fn no_time_changes_nothing() {
    for damping in [0.0, 40.0, 400.0] {
        let map = SpringMap::new(&coupling(0.4, 1000.0, damping), 0.0);
        assert_eq!([map.xx, map.xv, map.vv], [1.0, 0.0, 1.0]);
        assert_eq!(map.vx, 0.0);
    }
}

#[test]
fn an_undamped_spring_neither_gains_nor_loses() {
    let c = coupling(0.4, 1000.0, 0.0);
    let map = SpringMap::new(&c, 1.0 / 60.0);
    let start = [0.1, 0.0];
    let end = (0..1000).fold(start, |s, _| apply(&map, s));
    // A thousand maps whose entries are rounded to f32, at worst all the same way.
    let ratio = energy(&c, end) / energy(&c, start);
    assert!((ratio - 1.0).abs() < 2e-4, "{ratio}");
}

#[test]
fn without_a_spring_a_displacement_only_coasts_to_rest() {
    // K = 0: v decays with time constant m / R = 10 ms, x gains v0 m / R.
    let c = coupling(0.4, 0.0, 40.0);
    let [x, v] = apply(&SpringMap::new(&c, 0.02), [0.1, 1.0]);
    let decay = (-2.0_f64).exp();
    assert!((v - decay).abs() < 1e-6, "{v}");
    assert!((x - (0.1 + 0.01 * (1.0 - decay))).abs() < 1e-6, "{x}");
}

#[test]
fn springs_that_cannot_be_integrated_are_not_valid() {
    assert!(Coupling::DEFAULT.is_valid());
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(!coupling(bad, 1000.0, 40.0).is_valid());
    }
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(!coupling(0.4, bad, 40.0).is_valid());
        assert!(!coupling(0.4, 1000.0, bad).is_valid());
    }
    for bad in [0.0, -1.0, f32::NAN] {
        let c = Coupling {
            divergence_m: bad,
            ..Coupling::DEFAULT
        };
        assert!(!c.is_valid());
    }
    for bad in [-1.0, f32::NAN] {
        let c = Coupling {
            grace_s: bad,
            ..Coupling::DEFAULT
        };
        assert!(!c.is_valid());
    }
    let c = Coupling {
        snap: 3,
        ..Coupling::DEFAULT
    };
    assert!(!c.is_valid());
}
