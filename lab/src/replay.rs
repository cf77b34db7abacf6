//! Logs of worlds: writing one to a file while the lab runs, and making its calls again.

use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use palpable::recording::{CallKind, Replay, ReplayError, Replayed, Sink};

use crate::memory::Block;

/// A file that a log goes to. What goes wrong meanwhile is told at the end.
pub struct LogFile {
    to: BufWriter<File>,
    bytes: u64,
    failed: Option<io::Error>,
}

impl LogFile {
    /// Begins a file, over one that is there.
    ///
    /// # Errors
    /// What the file system says.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(Self {
            to: BufWriter::new(File::create(path)?),
            bytes: 0,
            failed: None,
        })
    }

    /// Ends the file; how many bytes it has.
    ///
    /// # Errors
    /// The first thing that went wrong.
    pub fn finish(mut self) -> io::Result<u64> {
        if let Some(why) = self.failed {
            return Err(why);
        }
        self.to.flush()?;
        Ok(self.bytes)
    }
}

impl Sink for LogFile {
    fn bytes(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        if self.failed.is_none() {
            self.failed = self.to.write_all(bytes).err();
        }
    }
}

/// A frame that came to another state.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherFrame {
    /// The frame's step.
    pub step: Replayed,
    /// The calls since the frame before, in their order.
    pub since: Vec<Replayed>,
}

/// What a replay came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Calls that were made.
    pub calls: u64,
    /// Frames that were stepped.
    pub frames: u64,
    /// The first call of any kind that came to something else.
    pub first_call: Option<Replayed>,
    /// The first frame that did. The replay ends there.
    pub first_frame: Option<OtherFrame>,
}

impl Verdict {
    /// Whether everything came to the same.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.first_call.is_none()
    }
}

/// Makes the calls of a log again, up to the first frame that comes to another state; `tick` is called after
/// every frame.
///
/// # Errors
/// [`ReplayError`], for a log that cannot be replayed to its end.
pub fn replay(log: &[u8], mut tick: impl FnMut()) -> Result<Verdict, ReplayError> {
    let mut replay = Replay::open(log)?;
    let mut block = Block::new(&replay.capacities());
    let mut world = replay.start(block.bytes())?;
    let mut verdict = Verdict::default();
    let mut since = Vec::new();
    loop {
        let (made, differs) = match replay.next_call(&mut world) {
            Ok(Some(made)) => (made, false),
            Err(ReplayError::Differs(made)) => (made, true),
            Ok(None) => return Ok(verdict),
            Err(why) => return Err(why),
        };
        verdict.calls = made.call;
        if differs && verdict.first_call.is_none() {
            verdict.first_call = Some(made);
        }
        if made.kind != CallKind::Step {
            since.push(made);
            continue;
        }
        verdict.frames = made.frame;
        tick();
        if differs {
            verdict.first_frame = Some(OtherFrame { step: made, since });
            return Ok(verdict);
        }
        since.clear();
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} calls, {} frames: ", self.calls, self.frames)?;
        let Some(first) = &self.first_call else {
            return f.write_str("equal");
        };
        write!(
            f,
            "call {} ({}) differs\n  recorded {}\n  replayed {}",
            first.call,
            first.kind.name(),
            Told(first, &first.recorded),
            Told(first, &first.replayed)
        )?;
        let Some(other) = &self.first_frame else {
            return f.write_str("\nno frame came to another state");
        };
        write!(
            f,
            "\nframe {} is the first that came to another state, by call {}\n  recorded {}\n  replayed {}",
            other.step.frame,
            other.step.call,
            Told(&other.step, &other.step.recorded),
            Told(&other.step, &other.step.replayed)
        )?;
        write!(f, "\ncalls since the frame before: {}", names(&other.since))
    }
}

/// What a call came to, for a reader.
struct Told<'a>(&'a Replayed, &'a palpable::recording::Outcome);

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(made, outcome) = self;
        if outcome.refusal != 0 {
            return write!(f, "refused, reason {}", outcome.refusal);
        }
        if made.kind != CallKind::Step {
            return write!(f, "accepted, {:#x}", outcome.value());
        }
        write!(
            f,
            "hash {:016x}, flags {:#x}, {} units for driven bodies, {} for loose ones, {} steps of chains",
            outcome.value(),
            outcome.flags,
            outcome.advance_units,
            outcome.impulse_units,
            outcome.reach_steps
        )
    }
}

/// The calls' names, equal ones in a row counted.
fn names(calls: &[Replayed]) -> String {
    if calls.is_empty() {
        return "none".to_owned();
    }
    let runs: Vec<String> = calls
        .chunk_by(|a, b| a.kind == b.kind)
        .map(|run| match run.len() {
            1 => run[0].kind.name().to_owned(),
            count => format!("{count} {}", run[0].kind.name()),
        })
        .collect();
    runs.join(", ")
}
