//! Random hosts in random scenes, every frame judged: as long as one likes, from one seed.

use std::time::{Duration, Instant};

use comfy_table::{CellAlignment, Table};
use palpable_simulation::host::Call;
use palpable_simulation::overlap::Class;
use palpable_simulation::play::{Finding, play_seed};
use palpable_simulation::tally::Tally;

/// What to simulate. It ends with the first of its bounds.
#[derive(Clone, Copy, Debug)]
pub struct SimulatePlan {
    /// Seed of the first scene; each has the next one.
    pub seed: u64,
    /// Scenes.
    pub scenes: u64,
    /// Frames a scene.
    pub frames: u32,
    /// How long to begin new scenes.
    pub time: Option<Duration>,
    /// Whether to go on after a finding.
    pub goes_on: bool,
}

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Simulated {
    /// Counts and deepest overlaps.
    pub tally: Tally,
    /// Seeds of scenes in which something did not hold, and what.
    pub findings: Vec<(u64, Finding)>,
    /// The seed behind the last one that was played.
    pub next_seed: u64,
    /// All hashes at the ends of scenes in one number: equal for equal plans.
    pub hash: u64,
    /// How long it took.
    pub took: Duration,
}

/// Simulates; `found` is told of findings as they come, `done` after every scene.
pub fn run(
    plan: &SimulatePlan,
    mut found: impl FnMut(u64, &Finding),
    mut done: impl FnMut(&Tally),
) -> Simulated {
    let begun = Instant::now();
    let mut simulated = Simulated::default();
    let end = plan.seed.saturating_add(plan.scenes);
    simulated.next_seed = plan.seed;
    while simulated.next_seed < end && plan.time.is_none_or(|time| begun.elapsed() < time) {
        let seed = simulated.next_seed;
        simulated.next_seed += 1;
        match play_seed(seed, plan.frames, &mut simulated.tally) {
            Ok(hash) => simulated.hash = simulated.hash.rotate_left(1) ^ hash,
            Err(finding) => {
                found(seed, &finding);
                simulated.findings.push((seed, finding));
                if !plan.goes_on {
                    break;
                }
            }
        }
        done(&simulated.tally);
    }
    simulated.took = begun.elapsed();
    simulated
}

/// The command that replays a finding.
#[must_use]
pub fn replay_command(seed: u64, finding: &Finding) -> String {
    format!(
        "cargo run --release -p palpable-lab -- simulate --seed {seed} --scenes 1 --frames {}",
        finding.frame + 1
    )
}

/// The counts as tables.
#[must_use]
pub fn tables(simulated: &Simulated) -> String {
    let tally = &simulated.tally;
    let share = |count: u64| format!("{:.2} %", 100.0 * count as f64 / tally.frames.max(1) as f64);
    let seconds = simulated.took.as_secs_f64();
    let mut text = format!(
        "{} scenes, {} frames, all judged in f64, in {seconds:.1} s: {:.0} frames/s\n\
         seeds up to {}, hash {:016x}\n\
         in contact {}, cut by a budget {}, pool full {}, without a time step {}, overlapping where the host put \
         things {}\n\
         {} frames were stepped twice more, from a snapshot elsewhere\n\n",
        tally.scenes,
        tally.frames,
        tally.frames as f64 / seconds.max(1e-9),
        simulated.next_seed.saturating_sub(1),
        simulated.hash,
        share(tally.touching),
        share(tally.cut),
        share(tally.full),
        share(tally.still),
        share(tally.overlapping),
        tally.replayed,
    );
    text += &format!("{}\n\n{}\n", overlaps(tally), calls(tally));
    text
}

fn overlaps(tally: &Tally) -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::ASCII_MARKDOWN);
    table.set_header([
        "deepest overlap, mm",
        "promised",
        "seen",
        "where the host made it",
        "not promised",
    ]);
    let mm = |metres: f64| format!("{:.4}", 1e3 * metres);
    for class in Class::ALL {
        let index = class as usize;
        table.add_row([
            class.name().to_owned(),
            mm(class.limit_m()),
            mm(tally.worst.clean_m[index]),
            mm(tally.worst.made_m[index]),
            mm(tally.worst.excused_m[index]),
        ]);
    }
    align(&mut table);
    table
}

fn calls(tally: &Tally) -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::ASCII_MARKDOWN);
    table.set_header(["call", "taken", "refused"]);
    for (call, [taken, refused]) in Call::ALL.iter().zip(tally.calls) {
        table.add_row([
            call.name().to_owned(),
            taken.to_string(),
            refused.to_string(),
        ]);
    }
    align(&mut table);
    table
}

fn align(table: &mut Table) {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}
