//! Playing a random scene: the host acts, the world steps, and every frame is judged.

use std::cell::Cell;
use std::fmt;

use palpable::frame::{FrameInput, FrameReport};
use palpable::memory::Capacities;
use palpable::world::World;

use crate::draw::{Draw, Seeded};
use crate::host::Host;
use crate::invariants::{Broken, Checker};
use crate::memory::Block;
use crate::scene::Style;
use crate::tally::Tally;

/// Once in so many frames a frame is stepped again from a snapshot.
const REPLAYED_EVERY: u64 = 61;

/// An invariant that did not hold, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The frame of the scene, from zero.
    pub frame: u32,
    /// What did not hold.
    pub broken: Broken,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "frame {}: {}", self.frame, self.broken)
    }
}

impl std::error::Error for Finding {}

/// Plays the scene of a seed; its hash at the end.
///
/// # Errors
/// The first invariant that did not hold.
pub fn play_seed(seed: u64, frames: u32, tally: &mut Tally) -> Result<u64, Finding> {
    play(&mut Seeded::new(seed), frames, tally)
}

/// Plays a scene for at most so many frames, or until there is nothing more to draw; its hash at the end.
///
/// # Errors
/// The first invariant that did not hold.
pub fn play(draw: &mut impl Draw, frames: u32, tally: &mut Tally) -> Result<u64, Finding> {
    let style = Style::draw(draw);
    let capacities = style.capacities(draw);
    tally.scenes += 1;
    let mut blocks = [(); 2].map(|()| Block::new(&capacities));
    let mut game = {
        let mut world = World::create(blocks[0].bytes(), &capacities).expect("a block that fits");
        Game {
            host: Host::new(draw, style, &mut world),
            checker: Checker::default(),
            frame: 0,
            frames,
            buffer: vec![0; world.snapshot_bytes()],
        }
    };
    let end = loop {
        let [here, there] = &mut blocks;
        let stay = game.stay(draw, here, there, &capacities, tally);
        match stay {
            Err(broken) => {
                break Err(Finding {
                    frame: game.frame,
                    broken,
                });
            }
            Ok(Stay::Over(hash)) => break Ok(hash),
            Ok(Stay::Moves) => {
                there.bytes().copy_from_slice(here.bytes());
                here.bytes().fill(0xa5);
                blocks.swap(0, 1);
            }
        }
    };
    tally.note_worst(&game.checker.worst);
    end
}

/// Why a host leaves a block.
enum Stay {
    /// All frames are through; the hash of the world.
    Over(u64),
    /// It goes on in a copy of the block.
    Moves,
}

struct Game {
    host: Host,
    checker: Checker,
    frame: u32,
    frames: u32,
    /// Room for a snapshot.
    buffer: Vec<u8>,
}

impl Game {
    /// Plays in one block, until the host moves to another.
    fn stay(
        &mut self,
        draw: &mut impl Draw,
        here: &mut Block,
        there: &mut Block,
        capacities: &Capacities,
        tally: &mut Tally,
    ) -> Result<Stay, Broken> {
        let taken = World::attach(here.bytes());
        let mut world = taken.map_err(|error| Broken::new("a world was not taken up", error))?;
        let mut other = World::create(there.bytes(), capacities).expect("a block that fits");
        while self.frame < self.frames && !draw.is_over() {
            self.step(draw, &mut world, &mut other, tally)?;
            self.frame += 1;
            if std::mem::take(&mut self.host.moves_house) {
                return Ok(Stay::Moves);
            }
        }
        Ok(Stay::Over(world.hash()))
    }

    fn step(
        &mut self,
        draw: &mut impl Draw,
        world: &mut World,
        other: &mut World,
        tally: &mut Tally,
    ) -> Result<(), Broken> {
        self.host.act(draw, world, tally)?;
        if let Some(frames) = self.host.rolled_back.take() {
            self.checker.start_from(world, &self.host.cast, frames);
        }
        let input = self.host.input(draw);
        self.checker.before(world, &self.host.cast, &input);
        let replays = u64::from(self.frame) % REPLAYED_EVERY == REPLAYED_EVERY / 2;
        if replays {
            let saved = world.save(&mut self.buffer);
            saved.map_err(|error| Broken::new("a snapshot was not taken", error))?;
        }
        let before = (!is_step(&input)).then(|| world.hash());
        let ends = (draw.below(8) == 0).then(|| u64::from(draw.below(60)));
        let report = match ends {
            Some(ends) => step_by_ticks(world, &input, ends),
            None => world.step(&input),
        };
        if before.is_some_and(|before| before != world.hash()) {
            return Err(Broken::new("a time step of none changed the world", input));
        }
        self.host.frames = report.frame;
        tally.note(&report);
        self.checker
            .after(world, &self.host.cast, &input, &report)?;
        if replays {
            tally.replayed += 1;
            replay(other, &self.buffer, (&input, ends), world, &report)?;
        }
        Ok(())
    }
}

fn is_step(input: &FrameInput) -> bool {
    input.dt_s > 0.0 && input.dt_s.is_finite()
}

/// A frame with a clock that ticks whenever it is asked.
fn step_by_ticks(world: &mut World, input: &FrameInput, ends: u64) -> FrameReport {
    let ticks = Cell::new(0);
    let clock = || {
        ticks.set(ticks.get() + 1);
        ticks.get()
    };
    world.step_by_clock(input, &clock, ends)
}

/// A frame from a snapshot gives the same bits in another block, and so it does with what was spent as its
/// budget, without a deadline or a clock.
fn replay(
    other: &mut World,
    snapshot: &[u8],
    (input, ends): (&FrameInput, Option<u64>),
    world: &World,
    report: &FrameReport,
) -> Result<(), Broken> {
    let loaded = other.load(snapshot);
    loaded.map_err(|error| Broken::new("a snapshot was not loaded", error))?;
    let again = match ends {
        Some(ends) => step_by_ticks(other, input, ends),
        None => other.step(input),
    };
    if again != *report || other.hash() != world.hash() {
        return Err(Broken::new(
            "a frame from a snapshot differs",
            (input, report, again),
        ));
    }
    let spent = FrameInput {
        budget: report.spent(),
        deadline: None,
        ..*input
    };
    let loaded = other.load(snapshot);
    loaded.map_err(|error| Broken::new("a snapshot was not loaded", error))?;
    let again = other.step(&spent);
    if again.spent() != report.spent() || other.hash() != world.hash() {
        let what = "a frame with what was spent as its budget differs";
        return Err(Broken::new(what, (input, report, again)));
    }
    Ok(())
}
