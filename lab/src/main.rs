//! `palpable-lab`: runs the paper's hand scene on the kernel, judges it and writes a report.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use palpable::recording::Sink;
use palpable_lab::accuracy;
use palpable_lab::accuracy::impulses::row::Case;
use palpable_lab::avatar::Style;
use palpable_lab::avatar::motions::SLAP_COUNT;
use palpable_lab::compare;
use palpable_lab::deadline::{self, Kit, Prices, Trial};
use palpable_lab::figures::capture::{Clip, Obstacles};
use palpable_lab::figures::suite::Suite;
use palpable_lab::hand::Hand;
use palpable_lab::replay::{self, LogFile};
use palpable_lab::report::{self, ArmSlaps, Ball, FigureScene, HandCoverage, Machine, Report};
use palpable_lab::run::{RunPlan, run_into};
use palpable_lab::script::FRAMES;
use palpable_lab::simulate::{self, SimulatePlan};
use palpable_lab::slaps;

/// Distance of the samples that the hand's parts are measured with, in metres.
const COVERAGE_SPACING_M: f64 = 0.002;

/// Runs the paper's hand scene (Schmidl and Lin 2004) on the Palpable kernel: a tracked hand in an art
/// gallery, idle, sliding over a table, and pushing a ball. Every frame is judged by an independent
/// reference in f64.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// What to run.
    #[arg(long, value_enum, default_value_t = Scene::All)]
    scene: Scene,
    /// How many frames of the script to run.
    #[arg(long, default_value_t = FRAMES, value_parser = clap::value_parser!(u32).range(1..=i64::from(FRAMES)))]
    frames: u32,
    /// Where report.json, index.html and the figures go.
    #[arg(long, default_value = "out")]
    out: PathBuf,
    /// A file for the log of the world's calls, to be replayed; for one scene of the hand. Frame times have
    /// the recording in them then.
    #[arg(long)]
    record: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// Makes the calls of a log again, and names the first frame that comes to another state.
    Replay {
        /// The log.
        file: PathBuf,
    },
    /// Scores queries against an independent reference in f64, and times them beside other libraries.
    Accuracy {
        #[command(subcommand)]
        of: Measured,
    },
    /// Plays seven scenes on the kernel and on Rapier, side by side.
    Compare {
        /// Perturbed trackers a scene.
        #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
        trackers: u32,
        /// Slaps of the kernel; the peer gets a tenth.
        #[arg(long, default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..=100_000))]
        slaps: u32,
        /// Seed of trackers and slaps.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Where compare.json and the figures go.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
    /// Measures what work costs on this machine, for deadlines in time.
    Calibrate {
        /// Frames of each part.
        #[arg(long, default_value_t = 6000, value_parser = clap::value_parser!(u32).range(100..=10_000_000))]
        frames: u32,
        /// Where costs.json goes.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
    /// Plays adversarial scenes at deadlines from 50 us up: times, misses, and error against time.
    Deadline {
        /// Frames of each scene at each deadline.
        #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=10_000_000))]
        frames: u32,
        /// Only scenes with this in their names.
        #[arg(long, default_value = "")]
        only: String,
        /// A costs.json; measured first when there is none.
        #[arg(long)]
        costs: Option<PathBuf>,
        /// Where deadline.json and the figure go.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
    /// Plays random hosts in random scenes and judges every frame; fails when something does not hold.
    Simulate {
        /// Seed of the first scene; each has the next one.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Scenes, or as many as the time allows; 1000 when neither is told.
        #[arg(long)]
        scenes: Option<u64>,
        /// Frames a scene.
        #[arg(long, default_value_t = 300)]
        frames: u32,
        /// Seconds in which scenes are begun.
        #[arg(long)]
        seconds: Option<u64>,
        /// Whether to go on with the next scene after a finding.
        #[arg(long)]
        go_on: bool,
    },
    /// Plays a BVH file of motion capture with the avatar, on a floor.
    Bvh {
        /// The file.
        file: PathBuf,
        /// What the avatar is made of.
        #[arg(long, value_enum, default_value_t = Pieces::Hulls)]
        style: Pieces,
        /// What stands near the path.
        #[arg(long, value_enum, default_value_t = Obstacle::Both)]
        obstacle: Obstacle,
        /// Where the figure goes.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
}

#[derive(Clone, Copy, ValueEnum)]
enum Pieces {
    /// Lofted hulls of 3648 triangles in all.
    Hulls,
    /// Capsules.
    Capsules,
}

#[derive(Clone, Copy, ValueEnum)]
enum Obstacle {
    /// The floor alone.
    None,
    /// A box as high as a table.
    Table,
    /// A wall.
    Wall,
    /// Both.
    Both,
}

#[derive(Subcommand)]
enum Measured {
    /// Penetration depth and distance of convex pairs, and least translations of unions.
    Penetration {
        /// Pairs in each class.
        #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
        pairs: u32,
        /// Seed of all pairs; a failure is replayed by it.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Where accuracy-penetration.json and the figure go.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
    /// Inverse kinematics: goals met, nearness to the optimum, limits, drift and time.
    Reach {
        /// Cases in each class; pushes of the arm are ten times as many.
        #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
        cases: u32,
        /// Seed of all cases.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Where accuracy-reach.json and the figures go.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
    /// Loose bodies: analytic cases, random impacts and piles, beside rapier3d, with their times.
    Impulses {
        /// The only case to measure.
        #[arg(long, value_enum)]
        case: Option<Case>,
        /// Seed of the random impacts and of the heap.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Where accuracy-impulses.json and the figures go.
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Scene {
    /// Everything below.
    All,
    /// The ball is a sphere; the tracker is exact.
    Sphere,
    /// The ball is a sphere; the tracker has 0.2 mm and 0.1 degrees of noise.
    SphereNoise,
    /// The ball is the paper's hull of 960 triangles; the tracker is exact.
    Hull,
    /// The ball is the hull; the tracker is noisy.
    HullNoise,
    /// Avatars and hands with joints, without the hand in the gallery.
    Figures,
}

impl Scene {
    fn plans(self, frames: u32) -> Vec<RunPlan> {
        let all = [
            (Self::Sphere, Ball::Sphere, false),
            (Self::SphereNoise, Ball::Sphere, true),
            (Self::Hull, Ball::Hull, false),
            (Self::HullNoise, Ball::Hull, true),
        ];
        all.into_iter()
            .filter(|(scene, ..)| self == Self::All || self == *scene)
            .map(|(_, ball, noise)| RunPlan {
                ball,
                noise,
                frames,
            })
            .collect()
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    let done = match &args.command {
        None => lab(&args),
        Some(Command::Accuracy {
            of: Measured::Penetration { pairs, seed, out },
        }) => accuracy_of_penetration(*pairs, *seed, out),
        Some(Command::Accuracy {
            of: Measured::Reach { cases, seed, out },
        }) => accuracy_of_reach(*cases, *seed, out),
        Some(Command::Accuracy {
            of: Measured::Impulses { case, seed, out },
        }) => accuracy_of_impulses(*case, *seed, out),
        Some(Command::Compare {
            trackers,
            slaps,
            seed,
            out,
        }) => compared(*trackers, *slaps, *seed, out),
        Some(Command::Calibrate { frames, out }) => calibrated(*frames, out).map(drop),
        Some(Command::Deadline {
            frames,
            only,
            costs,
            out,
        }) => deadlines(*frames, only, costs.as_deref(), out),
        Some(Command::Replay { file }) => replayed(file),
        Some(Command::Simulate {
            seed,
            scenes,
            frames,
            seconds,
            go_on,
        }) => simulated(&SimulatePlan {
            seed: *seed,
            scenes: scenes.unwrap_or(if seconds.is_some() { u64::MAX } else { 1000 }),
            frames: *frames,
            time: seconds.map(Duration::from_secs),
            goes_on: *go_on,
        }),
        Some(Command::Bvh {
            file,
            style,
            obstacle,
            out,
        }) => capture(file, *style, *obstacle, out),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("palpable-lab: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Unions in each of the random classes: shallow and deep.
const UNIONS: u32 = 100;

fn accuracy_of_penetration(
    pairs: u32,
    seed: u64,
    out: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let plan = accuracy::Plan {
        seed,
        pairs,
        unions: UNIONS,
        timed: true,
    };
    let bar = progress(plan.ticks(), "pairs")?;
    let found = accuracy::run(&plan, || bar.inc(1));
    bar.finish_and_clear();
    println!("{}", accuracy::tables(&found));
    accuracy::write(&found, out)?;
    println!("wrote {}", out.join("accuracy-penetration.svg").display());
    Ok(())
}

/// Closed loops that are drawn.
const LOOPS: u32 = 60;

fn accuracy_of_reach(cases: u32, seed: u64, out: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let plan = accuracy::reach::ReachPlan {
        seed,
        cases,
        loops: LOOPS,
        timed: true,
    };
    let bar = progress(plan.ticks(), "classes")?;
    let found = accuracy::reach::run(&plan, || bar.inc(1));
    bar.finish_and_clear();
    println!("{}", accuracy::reach::tables(&found));
    accuracy::reach::write(&found, out)?;
    println!("wrote {}", out.join("accuracy-reach-steps.svg").display());
    println!("wrote {}", out.join("accuracy-reach-time.svg").display());
    Ok(())
}

fn accuracy_of_impulses(
    only: Option<Case>,
    seed: u64,
    out: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let plan = accuracy::impulses::ImpulsePlan {
        only,
        ..accuracy::impulses::ImpulsePlan::full(seed)
    };
    let bar = progress(plan.ticks(), "cases")?;
    let found = accuracy::impulses::run(&plan, || bar.inc(1));
    bar.finish_and_clear();
    println!("{}", accuracy::impulses::tables(&found));
    println!("\n{}", accuracy::impulses::failures(&found));
    accuracy::impulses::write(&found, out)?;
    println!("wrote {}", out.join("accuracy-impulses.json").display());
    Ok(())
}

fn compared(
    trackers: u32,
    slaps: u32,
    seed: u64,
    out: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let plan = compare::ComparePlan {
        seed,
        trackers: trackers as usize,
        slaps: slaps as usize,
    };
    let bar = progress(plan.ticks(), "plays")?;
    let found = compare::run(&Hand::load()?, &plan, || bar.inc(1))?;
    bar.finish_and_clear();
    println!("{}", compare::tables(&found));
    compare::write(&found, out)?;
    println!("wrote {}", out.join("compare-times.svg").display());
    Ok(())
}

fn simulated(plan: &SimulatePlan) -> Result<(), Box<dyn std::error::Error>> {
    let bar = ProgressBar::no_length().with_style(ProgressStyle::with_template(
        "{pos} frames, {per_sec}, {elapsed}",
    )?);
    let found = simulate::run(
        plan,
        |seed, finding| {
            let again = simulate::replay_command(seed, finding);
            bar.suspend(|| println!("seed {seed}, {finding}\n  {again}"));
        },
        |tally| bar.set_position(tally.frames),
    );
    bar.finish_and_clear();
    println!("{}", simulate::tables(&found));
    match found.findings.len() {
        0 => Ok(()),
        count => Err(format!("{count} scenes broke something").into()),
    }
}

fn lab(args: &Args) -> Result<(), Box<dyn std::error::Error>> {
    let hand = Hand::load()?;
    let coverage = hand.coverage(COVERAGE_SPACING_M)?;
    println!("hand: {} parts\n{coverage}", hand.parts.len());
    let plans = args.scene.plans(args.frames);
    let bar = progress(plans.len() as u64 * u64::from(args.frames), "frames")?;
    let mut log = match (&args.record, plans.len()) {
        (Some(path), 1) => Some(LogFile::create(path)?),
        (Some(_), _) => return Err("--record needs --scene with one scene of the hand".into()),
        (None, _) => None,
    };
    let mut runs = Vec::new();
    for plan in &plans {
        let sink = log.as_mut().map(|log| log as &mut dyn Sink);
        let (run, high_water) = run_into(&hand, plan, sink, || bar.inc(1))?;
        bar.suspend(|| println!("{}: used {high_water:?}", run.name));
        runs.push(run);
    }
    bar.finish_and_clear();
    if let Some(log) = log {
        println!("recorded {} bytes", log.finish()?);
    }
    let slapped = slaps::run(&hand, &slaps::slaps())?;
    let (figures, arm_slaps) = match args.scene {
        Scene::All | Scene::Figures => figures(&hand, args.frames)?,
        _ => (Vec::new(), None),
    };
    let report = Report {
        title: "The hand in the art gallery".to_owned(),
        machine: Machine::detect(),
        hand: HandCoverage {
            parts: hand.parts.len() as u32,
            uncovered_share: coverage.uncovered_share,
            uncovered_mm_max: 1e3 * coverage.uncovered_m_max,
            sticking_out_mm_max: 1e3 * coverage.outside_m_max,
            sticking_out_mm_mean: 1e3 * coverage.outside_m_mean,
        },
        runs,
        slaps: Some(slapped),
        figures,
        arm_slaps,
    };
    println!("{}", report::table(&report));
    report::write(&report, &args.out)?;
    println!("wrote {}", args.out.join("index.html").display());
    Ok(())
}

fn replayed(file: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let log = std::fs::read(file).map_err(|why| format!("{}: {why}", file.display()))?;
    let bar = ProgressBar::new_spinner();
    let found = replay::replay(&log, || bar.inc(1));
    bar.finish_and_clear();
    let verdict = found.map_err(|why| format!("{}: {why}", file.display()))?;
    println!("{verdict}");
    if verdict.is_equal() {
        Ok(())
    } else {
        Err("the replay differs".into())
    }
}

/// Slaps of the arm that are played with so many frames of every scene: with few frames, few.
fn slap_count(frames: u32) -> usize {
    let count = SLAP_COUNT as u64 * u64::from(frames) / u64::from(FRAMES);
    usize::try_from(count.max(1)).unwrap_or(SLAP_COUNT)
}

fn figures(
    hand: &Hand,
    frames: u32,
) -> Result<(Vec<FigureScene>, Option<ArmSlaps>), Box<dyn std::error::Error>> {
    let suite = Suite::new(hand)?;
    let bar = progress(suite.frames(frames)?, "frames of figures")?;
    let scenes = suite.run(frames, || bar.inc(1))?;
    bar.finish_and_clear();
    let count = slap_count(frames);
    let bar = progress(count as u64, "slaps of the arm")?;
    let slapped = suite.slaps(count, || bar.inc(1))?;
    bar.finish_and_clear();
    Ok((scenes, Some(slapped)))
}

/// Measures this machine's prices and writes them down.
fn calibrated(frames: u32, out: &Path) -> Result<Prices, Box<dyn std::error::Error>> {
    let kit = Kit::new(Hand::load()?);
    let bar = progress(2 + Trial::ALL.len() as u64, "parts of the calibration")?;
    let found = deadline::calibrate(&kit, frames, || bar.inc(1))?;
    bar.finish_and_clear();
    println!(
        "{}\n",
        deadline::table::of_prices(&found.prices, Some(&found))
    );
    std::fs::create_dir_all(out)?;
    let path = out.join("costs.json");
    std::fs::write(&path, serde_json::to_string_pretty(&found.prices)?)?;
    println!("wrote {}", path.display());
    Ok(found.prices)
}

fn deadlines(
    frames: u32,
    only: &str,
    costs: Option<&Path>,
    out: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let prices = match costs {
        Some(file) => serde_json::from_str(&std::fs::read_to_string(file)?)
            .map_err(|why| format!("{}: {why}", file.display()))?,
        None => calibrated(6000, out)?,
    };
    let kit = Kit::new(Hand::load()?);
    let is_asked = |trial: &Trial| trial.name().contains(only);
    let trials: Vec<Trial> = Trial::ALL.into_iter().filter(is_asked).collect();
    if trials.is_empty() {
        let names = Trial::ALL.map(Trial::name).join(", ");
        return Err(format!("no scene has {only:?} in its name: {names}").into());
    }
    let runs = trials.len() * (1 + deadline::DEADLINES_US.len());
    let bar = progress(runs as u64, "runs")?;
    let outcomes = deadline::run(&kit, &trials, frames, prices, |_| bar.inc(1))?;
    bar.finish_and_clear();
    println!("{}\n", deadline::table::of_prices(&prices, None));
    println!("{}\n", deadline::table::of_times(&outcomes));
    println!("{}\n", deadline::table::of_overlaps(&outcomes));
    let overall = deadline::overall(&outcomes);
    println!("{}\n", deadline::table::of_errors(&outcomes, &overall));
    let findings = deadline::Findings {
        prices: &prices,
        outcomes: &outcomes,
        overall: &overall,
    };
    println!("wrote {}", deadline::write(&findings, out)?.display());
    Ok(())
}

fn capture(
    file: &Path,
    style: Pieces,
    obstacle: Obstacle,
    out: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let style = match style {
        Pieces::Hulls => Style::Hulls,
        Pieces::Capsules => Style::Capsules,
    };
    let obstacles = match obstacle {
        Obstacle::None => Obstacles::None,
        Obstacle::Table => Obstacles::Table,
        Obstacle::Wall => Obstacles::Wall,
        Obstacle::Both => Obstacles::Both,
    };
    let clip = Clip::read(file, style).map_err(|why| format!("{}: {why}", file.display()))?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let bar = progress(clip.frames().into(), "frames")?;
    let scene = clip.play(&name, obstacles, || bar.inc(1))?;
    bar.finish_and_clear();
    let scene = scene.ok_or("the file has no frames")?;
    println!(
        "{}\n",
        report::figure_tables(std::slice::from_ref(&scene), None)
    );
    println!(
        "{} angles of the file were beyond the avatar's limits",
        clip.clamped
    );
    println!(
        "in itself {:.3} mm in the first frame, afterwards deeper by at most {:.3} mm a frame",
        scene.overlap_own_first_mm, scene.overlap_own_grown_mm_max
    );
    println!("wrote {}", report::write_joints(&scene, out)?.display());
    Ok(())
}

fn progress(steps: u64, of: &str) -> Result<ProgressBar, Box<dyn std::error::Error>> {
    let template = format!("{{bar:40}} {{pos}}/{{len}} {of}, {{elapsed}} of {{duration}}");
    let style = ProgressStyle::with_template(&template)?;
    Ok(ProgressBar::new(steps).with_style(style))
}
