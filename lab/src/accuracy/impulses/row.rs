//! One result: what was measured, what is exact, and what it cost.

use clap::ValueEnum;
use serde::Serialize;

use super::engine::{Setup, Spent, Subject};

/// A family of cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Case {
    /// A ball dropped from a metre.
    Bounce,
    /// A block that friction stops.
    Slide,
    /// A ball that slides and then rolls.
    Roll,
    /// Five balls in a row.
    Cradle,
    /// A box on a slope that just holds or just slides.
    Slope,
    /// A plate that turns freely about its middle axis.
    Tumble,
    /// The spring that couples a body and its tracker.
    Coupling,
    /// Random impacts of two bodies.
    Impacts,
    /// Large ratios of mass, slender rods, long and short frames.
    Robustness,
    /// A heap and a stack of boxes.
    Piles,
    /// The order in which the kernel's solver gives impulses, beside no other engine.
    Orders,
}

impl Case {
    /// All that engines are compared by.
    pub const ALL: [Self; 10] = [
        Self::Bounce,
        Self::Slide,
        Self::Roll,
        Self::Cradle,
        Self::Slope,
        Self::Tumble,
        Self::Coupling,
        Self::Impacts,
        Self::Robustness,
        Self::Piles,
    ];

    /// The name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bounce => "bounce",
            Self::Slide => "slide",
            Self::Roll => "roll",
            Self::Cradle => "cradle",
            Self::Slope => "slope",
            Self::Tumble => "tumble",
            Self::Coupling => "coupling",
            Self::Impacts => "impacts",
            Self::Robustness => "robustness",
            Self::Piles => "piles",
            Self::Orders => "orders",
        }
    }
}

/// How a value is compared with the exact one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judged {
    /// By the difference over the exact value.
    Relative,
    /// By the difference, in the value's unit.
    Absolute,
    /// There is nothing exact to compare with.
    Reported,
}

/// Something that is measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Its case.
    pub case: Case,
    /// What it is.
    pub name: String,
    /// Its unit; empty for a share.
    pub unit: &'static str,
    /// The exact value.
    pub exact: f64,
    /// How the error is taken.
    pub judged: Judged,
    /// The most that the error may be; none where nothing is promised.
    pub bound: Option<f64>,
}

impl Quantity {
    /// Something that may be off by a share of the exact value.
    pub fn relative(case: Case, name: impl Into<String>, unit: &'static str, exact: f64) -> Self {
        Self {
            case,
            name: name.into(),
            unit,
            exact,
            judged: Judged::Relative,
            bound: None,
        }
    }

    /// Something that may be off by so much in its unit.
    pub fn absolute(case: Case, name: impl Into<String>, unit: &'static str, exact: f64) -> Self {
        Self {
            judged: Judged::Absolute,
            ..Self::relative(case, name, unit, exact)
        }
    }

    /// Something without an exact value.
    pub fn reported(case: Case, name: impl Into<String>, unit: &'static str) -> Self {
        Self {
            judged: Judged::Reported,
            ..Self::relative(case, name, unit, 0.0)
        }
    }

    /// What the error must not exceed.
    pub fn within(self, bound: f64) -> Self {
        Self {
            bound: Some(bound),
            ..self
        }
    }

    /// A result.
    pub fn row(&self, setup: &Setup, value: f64, spent: &Spent) -> Row {
        let off = (value - self.exact).abs();
        let error = match self.judged {
            Judged::Relative => Some(off / self.exact.abs()),
            Judged::Absolute => Some(off),
            Judged::Reported => None,
        };
        Row {
            quantity: self.clone(),
            subject: setup.subject,
            rate_hz: setup.rate_hz,
            value,
            error,
            passes: self
                .bound
                .zip(error)
                .map(|(bound, error)| value.is_finite() && error <= bound),
            frame_us: spent.median_us(),
            total_ms: spent.total_ms(),
        }
    }
}

/// A result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What was measured.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// Whose it is.
    pub subject: Subject,
    /// Frames a second.
    pub rate_hz: f64,
    /// What was measured, in the quantity's unit.
    pub value: f64,
    /// How far off it is: a share, or in the quantity's unit.
    pub error: Option<f64>,
    /// Whether the error is within its bound, where there is one.
    pub passes: Option<bool>,
    /// Median CPU time of a frame in microseconds, when times were taken.
    pub frame_us: Option<f64>,
    /// CPU time of all frames in milliseconds.
    pub total_ms: f64,
}
