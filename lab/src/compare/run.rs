//! All scenes on all engines.

use super::arm::{Arm, ArmFound};
use super::drive::Drive;
use super::judging::{Reading, judge};
use super::kernel::{self, Kernel};
use super::measures::{Measure, measures, timed, within};
use super::peer::Peer;
use super::peer_arm;
use super::play::{Shot, play};
use super::scenes::Scene;
use super::setting::{Perturbation, Setting, perturbations};
use super::slaps::{Slap, Slapped, slaps};
use super::summary::{Comparison, Curve, ENGINES, Found, Row, TimeRow};
use crate::hand::Hand;
use crate::hand_scene::SceneError;
use crate::memory::Block;
use crate::report::{Machine, Quantiles};

/// How much is played.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ComparePlan {
    /// Of the trackers and the slaps.
    pub seed: u64,
    /// Trackers a scene.
    pub trackers: usize,
    /// Slaps of the kernel; of each drive of the peer a tenth.
    pub slaps: usize,
}

impl ComparePlan {
    /// Slaps of each engine.
    #[must_use]
    pub fn slaps_of(&self) -> [usize; ENGINES.len()] {
        let fewer = self.slaps.div_ceil(10);
        [self.slaps, fewer, fewer]
    }

    /// How often [`run`] calls its `tick`.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        let scenes = Scene::ALL.len() * ENGINES.len() + 2;
        (scenes * self.trackers + self.slaps_of().iter().sum::<usize>()) as u64
    }
}

/// Plays a setting on the engine of an index into [`ENGINES`].
///
/// # Errors
/// [`SceneError`] names what the engine refused.
pub fn play_on(engine: usize, setting: &Setting) -> Result<Vec<Shot>, SceneError> {
    match engine {
        0 => {
            let mut block = Block::new(&kernel::CAPACITIES);
            play(setting, &mut Kernel::new(block.bytes(), setting)?)
        }
        1 => play(setting, &mut Peer::new(setting, Drive::Soft)?),
        _ => play(setting, &mut Peer::new(setting, Drive::Stiff)?),
    }
}

/// Plays everything; `tick` is called after every tracker of every engine, and every slap.
///
/// # Errors
/// [`SceneError`] names what an engine refused.
pub fn run(
    hand: &Hand,
    plan: &ComparePlan,
    mut tick: impl FnMut(),
) -> Result<Comparison, SceneError> {
    let trackers = perturbations(plan.seed, plan.trackers);
    let mut found = Comparison {
        machine: Machine::detect(),
        seed: plan.seed,
        trackers: plan.trackers,
        slaps: plan.slaps_of(),
        rows: Vec::new(),
        times: Vec::new(),
        curves: Vec::new(),
    };
    for scene in Scene::ALL {
        let mut gathered = Gathered::default();
        for tracker in &trackers {
            let setting = scene.setting(hand, tracker);
            // One engine right after the other: whatever else the machine does meets them alike.
            for engine in 0..ENGINES.len() {
                gathered.play(scene, engine, &setting)?;
                tick();
            }
        }
        gathered.finish(scene, &mut found);
    }
    found.rows.extend(slap_rows(
        hand,
        &slaps(plan.seed, plan.slaps),
        plan,
        &mut tick,
    )?);
    arms(&trackers, &mut found, &mut tick)?;
    Ok(found)
}

/// Scenes that are drawn.
pub const DRAWN: [Scene; 3] = [Scene::Press, Scene::Squeeze, Scene::Carry];

/// What the trackers of a scene showed so far, by engine.
#[derive(Default)]
struct Gathered {
    values: [Vec<Vec<(Measure, f64)>>; ENGINES.len()],
    /// One list a stretch.
    times_us: [Vec<Vec<f64>>; ENGINES.len()],
    curves: Vec<Curve>,
}

impl Gathered {
    fn play(&mut self, scene: Scene, engine: usize, setting: &Setting) -> Result<(), SceneError> {
        let shots = play_on(engine, setting)?;
        let readings = judge(setting, &shots)?;
        let stretches = timed(scene);
        let times_us = &mut self.times_us[engine];
        times_us.resize(stretches.len(), Vec::new());
        for (times, stretch) in times_us.iter_mut().zip(stretches) {
            let frames = within(&readings, stretch.frames);
            times.extend(frames.iter().map(|r| r.time_us));
        }
        if self.values[engine].is_empty() && DRAWN.contains(&scene) {
            self.curves.push(curve(scene, engine, &readings));
        }
        self.values[engine].push(measures(scene, setting, &shots, &readings));
        Ok(())
    }

    fn finish(mut self, scene: Scene, found: &mut Comparison) {
        let measures = self.values[0].first().map_or(0, Vec::len);
        for index in 0..measures {
            let (measure, _) = self.values[0][0][index];
            let of = |engine: usize| {
                let values: Vec<f64> = self.values[engine].iter().map(|v| v[index].1).collect();
                Some(Found::of(&measure, &values))
            };
            found
                .rows
                .push(row(scene.name(), &measure, [0, 1, 2].map(of)));
        }
        for (index, stretch) in timed(scene).into_iter().enumerate() {
            let times = self.times_us.each_mut();
            found.times.push(TimeRow {
                scene: stretch.name,
                promised_us: stretch.promised_us,
                found: times.map(|times| Quantiles::from_samples(times.get_mut(index)?)),
            });
        }
        found.curves.append(&mut self.curves);
    }
}

fn row(scene: &'static str, measure: &Measure, found: [Option<Found>; ENGINES.len()]) -> Row {
    Row {
        scene,
        measure: measure.name,
        unit: measure.unit,
        promised: measure.promised,
        found,
    }
}

fn curve(scene: Scene, engine: usize, readings: &[Reading]) -> Curve {
    let overlap = |r: &Reading| r.hand_fixed_mm.max(r.hand_loose_mm);
    Curve {
        scene: scene.name(),
        engine,
        overlap_mm: readings.iter().map(overlap).collect(),
        displacement_mm: readings.iter().map(|r| r.lag_mm).collect(),
    }
}

/// Plays slaps on one engine.
///
/// # Errors
/// [`SceneError`] names what the engine refused.
pub fn slap(
    hand: &Hand,
    engine: usize,
    slaps: &[Slap],
    mut tick: impl FnMut(),
) -> Result<Slapped, SceneError> {
    let mut total = Slapped::default();
    for slap in slaps {
        let setting = slap.setting(hand);
        let shots = play_on(engine, &setting)?;
        let readings = judge(&setting, &shots)?;
        total = total.and(Slapped::of(&setting, &shots, &readings));
        tick();
    }
    Ok(total)
}

fn slap_rows(
    hand: &Hand,
    slaps: &[Slap],
    plan: &ComparePlan,
    tick: &mut impl FnMut(),
) -> Result<Vec<Row>, SceneError> {
    let mut found = [Slapped::default(); ENGINES.len()];
    for (engine, count) in plan.slaps_of().into_iter().enumerate() {
        found[engine] = slap(hand, engine, &slaps[..count], &mut *tick)?;
    }
    let count = |name, promised| Measure {
        name,
        unit: "",
        promised,
        is_count: true,
    };
    let overlap = Measure {
        name: "hand in plate",
        unit: "mm",
        promised: Some(0.1),
        is_count: false,
    };
    let of = |measure: &Measure, value: fn(&Slapped) -> f64| {
        let found = found.each_ref().map(|slapped| {
            Some(Found {
                worst: value(slapped),
                median: None,
            })
        });
        row("slaps at a plate of 20 mm", measure, found)
    };
    Ok(vec![
        of(&count("parts left behind", Some(0.0)), |s| {
            f64::from(s.left_behind)
        }),
        of(&count("parts ever seen behind", Some(0.0)), |s| {
            f64::from(s.seen_behind)
        }),
        of(&overlap, |s| s.overlap_mm),
    ])
}

const ARM: &str = "arm into a wall";

fn arms(
    trackers: &[Perturbation],
    found: &mut Comparison,
    tick: &mut impl FnMut(),
) -> Result<(), SceneError> {
    let arm = Arm::default();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for tracker in trackers {
        ours.push(arm.play(*tracker)?);
        tick();
        theirs.push(peer_arm::play(&arm, *tracker)?);
        tick();
    }
    let measure = |name, unit, promised| Measure {
        name,
        unit,
        promised,
        is_count: false,
    };
    let mut add = |measure: Measure, value: fn(&ArmFound) -> f64| {
        let of = |arms: &[ArmFound]| {
            let values: Vec<f64> = arms.iter().map(value).collect();
            Some(Found::of(&measure, &values))
        };
        found
            .rows
            .push(row(ARM, &measure, [of(&ours), of(&theirs), None]));
    };
    add(measure("arm in wall", "mm", Some(0.1)), |a| a.overlap_mm);
    add(measure("joint beyond its range", "deg", None), |a| {
        a.beyond_deg
    });
    add(
        measure("jitter under a still tracker", "deg", Some(0.0)),
        |a| a.jitter_deg,
    );
    let times = |arms: &[ArmFound]| {
        let mut times: Vec<f64> = arms.iter().flat_map(|arm| arm.times_us.clone()).collect();
        Quantiles::from_samples(&mut times)
    };
    found.times.push(TimeRow {
        scene: ARM,
        promised_us: None,
        found: [times(&ours), times(&theirs), None],
    });
    Ok(())
}
