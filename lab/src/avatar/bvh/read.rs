//! Reading BVH text, with line numbers in every error.

use std::fmt;
use std::path::Path;

use glam::{DQuat, DVec3};

/// Most joints of a file.
const JOINTS_MAX: usize = 1024;

/// Most frames of a file: three hours at 100 Hz.
const FRAMES_MAX: usize = 1_100_000;

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The file could not be read.
    Unreadable(String),
    /// The text ends in the middle.
    Ends,
    /// Another word was expected: first what, then what was found.
    Expected(&'static str, String),
    /// Not a finite number.
    Number(String),
    /// Not a channel, or a channel twice.
    Channel(String),
    /// More joints or frames than this reads.
    TooMany(&'static str),
    /// A frame has so many numbers instead of that many.
    FrameLength(usize, usize),
    /// So many frames are there, and that many were announced.
    FrameCount(usize, usize),
    /// No joint is named like this.
    Missing(&'static str),
    /// A bone has no length, or two hips are in one place.
    Flat(&'static str),
}

/// Why a BVH file was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BvhError {
    /// Line in the file, from 1; 0 when it is about the file as a whole.
    pub line: usize,
    /// What is wrong.
    pub fault: Fault,
}

impl BvhError {
    pub(super) const fn whole(fault: Fault) -> Self {
        Self { line: 0, fault }
    }
}

impl fmt::Display for BvhError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        match &self.fault {
            Fault::Unreadable(why) => write!(f, "cannot be read: {why}"),
            Fault::Ends => write!(f, "the text ends too early"),
            Fault::Expected(what, found) => write!(f, "expected {what}, found {found:?}"),
            Fault::Number(text) => write!(f, "{text:?} is no finite number"),
            Fault::Channel(text) => write!(f, "{text:?} is no channel, or is there twice"),
            Fault::TooMany(what) => write!(f, "too many {what}"),
            Fault::FrameLength(found, wanted) => {
                write!(f, "{found} numbers in a frame of {wanted} channels")
            }
            Fault::FrameCount(found, wanted) => write!(f, "{found} frames instead of {wanted}"),
            Fault::Missing(what) => write!(f, "no joint for {what}"),
            Fault::Flat(what) => write!(f, "{what} has no length"),
        }
    }
}

impl std::error::Error for BvhError {}

/// A joint, or the end of a branch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Joint {
    /// Empty for an end.
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    pub(super) offset: DVec3,
    channels: Vec<Channel>,
    /// Index of the first channel in a frame.
    first: usize,
}

/// Axis 0 to 2 of a position or a rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Position(usize),
    Rotation(usize),
}

/// A BVH file: joints in the order of the file, parents first, and the numbers of every frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    pub(super) joints: Vec<Joint>,
    /// Seconds from one frame to the next.
    pub frame_s: f64,
    channel_count: usize,
    values: Vec<f64>,
}

impl Motion {
    /// The number of frames.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.values.len() / self.channel_count
    }

    /// Names of the joints; ends of branches have none.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let joints = self.joints.iter().map(|joint| joint.name.as_str());
        joints.filter(|name| !name.is_empty())
    }

    /// Where joints and ends are in a frame, in the file's unit.
    pub(super) fn positions(&self, frame: usize) -> Vec<DVec3> {
        let values = &self.values[frame * self.channel_count..][..self.channel_count];
        let mut placed: Vec<(DQuat, DVec3)> = Vec::new();
        for joint in &self.joints {
            let (mut offset, mut turn) = (joint.offset, DQuat::IDENTITY);
            for (channel, &value) in joint.channels.iter().zip(&values[joint.first..]) {
                match *channel {
                    Channel::Position(axis) => offset[axis] += value,
                    Channel::Rotation(axis) => {
                        turn *= DQuat::from_axis_angle(DVec3::AXES[axis], value.to_radians());
                    }
                }
            }
            let (parent_turn, parent_at) = joint
                .parent
                .map_or((DQuat::IDENTITY, DVec3::ZERO), |parent| placed[parent]);
            placed.push((
                (parent_turn * turn).normalize(),
                parent_at + parent_turn * offset,
            ));
        }
        placed.into_iter().map(|(_, at)| at).collect()
    }
}

/// Reads a file.
///
/// # Errors
/// [`BvhError`] with the line that is wrong.
pub fn read(path: &Path) -> Result<Motion, BvhError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| BvhError::whole(Fault::Unreadable(error.to_string())))?;
    parse(&text)
}

/// Reads the text of a file.
///
/// # Errors
/// [`BvhError`] with the line that is wrong.
pub fn parse(text: &str) -> Result<Motion, BvhError> {
    let mut words = Words::new(text);
    words.expect("HIERARCHY")?;
    words.expect("ROOT")?;
    let joints = hierarchy(&mut words)?;
    words.expect("MOTION")?;
    words.expect("Frames:")?;
    let frames = words.count("frames", FRAMES_MAX)?;
    words.expect("Frame")?;
    words.expect("Time:")?;
    let frame_s = words.number()?;
    if frame_s <= 0.0 {
        return Err(words.fault(Fault::Expected("a time above zero", frame_s.to_string())));
    }
    let channel_count = joints.iter().map(|joint| joint.channels.len()).sum();
    if channel_count == 0 {
        return Err(words.fault(Fault::Missing("any channel")));
    }
    let values = numbers(text, words.line, channel_count, frames)?;
    Ok(Motion {
        joints,
        frame_s,
        channel_count,
        values,
    })
}

/// The tree behind the word ROOT.
fn hierarchy(words: &mut Words) -> Result<Vec<Joint>, BvhError> {
    let mut joints: Vec<Joint> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut first = 0;
    let mut word = "ROOT".to_owned();
    loop {
        match word.as_str() {
            "ROOT" | "JOINT" | "End" => {
                let name = words.next()?;
                let name = if word == "End" { String::new() } else { name };
                words.expect("{")?;
                words.expect("OFFSET")?;
                let offset = DVec3::new(words.number()?, words.number()?, words.number()?);
                let parent = open.last().copied();
                open.push(joints.len());
                joints.push(Joint {
                    name,
                    parent,
                    offset,
                    channels: Vec::new(),
                    first,
                });
                if joints.len() > JOINTS_MAX {
                    return Err(words.fault(Fault::TooMany("joints")));
                }
            }
            "CHANNELS" => {
                let channels = channels(words)?;
                let joint = &mut joints[open[open.len() - 1]];
                if !joint.channels.is_empty() {
                    return Err(words.fault(Fault::Channel("CHANNELS".to_owned())));
                }
                joint.first = first;
                first += channels.len();
                joint.channels = channels;
            }
            "}" => {
                open.pop();
                if open.is_empty() {
                    return Ok(joints);
                }
            }
            _ => return Err(words.fault(Fault::Expected("JOINT, End, CHANNELS or }", word))),
        }
        word = words.next()?;
    }
}

fn channels(words: &mut Words) -> Result<Vec<Channel>, BvhError> {
    let count = words.count("channels", 6)?;
    let mut found = Vec::new();
    for _ in 0..count {
        let word = words.next()?;
        let axis = |kind: &str| {
            let letter = word.strip_suffix(kind)?;
            ["X", "Y", "Z"].iter().position(|axis| *axis == letter)
        };
        let channel = axis("position")
            .map(Channel::Position)
            .or_else(|| axis("rotation").map(Channel::Rotation));
        match channel {
            Some(channel) if !found.contains(&channel) => found.push(channel),
            _ => return Err(words.fault(Fault::Channel(word))),
        }
    }
    Ok(found)
}

/// The frames behind a line.
fn numbers(text: &str, after: usize, channels: usize, frames: usize) -> Result<Vec<f64>, BvhError> {
    let mut values = Vec::new();
    let mut found = 0;
    for (index, line) in text.lines().enumerate().skip(after) {
        let before = values.len();
        for word in line.split_whitespace() {
            let value = finite(word);
            values.push(value.ok_or_else(|| BvhError {
                line: index + 1,
                fault: Fault::Number(word.to_owned()),
            })?);
        }
        let length = values.len() - before;
        if length != 0 && length != channels {
            return Err(BvhError {
                line: index + 1,
                fault: Fault::FrameLength(length, channels),
            });
        }
        found += usize::from(length > 0);
    }
    if found == frames && found > 0 {
        Ok(values)
    } else {
        Err(BvhError::whole(Fault::FrameCount(found, frames)))
    }
}

fn finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| value.is_finite())
}

/// The words of a text and their lines.
struct Words<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    /// Line of the last word, from 1.
    line: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Self {
        let lines = text.lines().enumerate();
        let words =
            lines.flat_map(|(index, line)| line.split_whitespace().map(move |w| (index + 1, w)));
        Self {
            words: Box::new(words),
            line: 1,
        }
    }

    fn fault(&self, fault: Fault) -> BvhError {
        BvhError {
            line: self.line,
            fault,
        }
    }

    fn next(&mut self) -> Result<String, BvhError> {
        let (line, word) = self.words.next().ok_or_else(|| self.fault(Fault::Ends))?;
        self.line = line;
        Ok(word.to_owned())
    }

    fn expect(&mut self, wanted: &'static str) -> Result<(), BvhError> {
        let word = self.next()?;
        if word == wanted {
            Ok(())
        } else {
            Err(self.fault(Fault::Expected(wanted, word)))
        }
    }

    fn number(&mut self) -> Result<f64, BvhError> {
        let word = self.next()?;
        finite(&word).ok_or_else(|| self.fault(Fault::Number(word)))
    }

    fn count(&mut self, what: &'static str, most: usize) -> Result<usize, BvhError> {
        let word = self.next()?;
        let count: usize = word.parse().map_err(|_| self.fault(Fault::Number(word)))?;
        if count > most {
            return Err(self.fault(Fault::TooMany(what)));
        }
        Ok(count)
    }
}
