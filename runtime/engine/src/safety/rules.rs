//! The rules of a safety file, in SI units.

use std::ops::Range;

use mdle_quantity::Quantity;
use mdle_runtime::{Nanos, Radians};

use super::Fence;

/// The rules of a safety file. Without rules, every input that consists of numbers passes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rules {
    /// Limits of inputs.
    pub limits: Limits,
    /// Areas that the robot must not leave.
    pub fences: Vec<Fence>,
    /// Consequence of contact of a bumper; `None` without this rule.
    pub contact: Option<Then>,
    /// Age of the measurements in an output from which it is stale, and the consequence.
    pub stale: Option<(Nanos, Then)>,
    /// Maximum age of a module's value that the plan or a guard reads, and the consequence if it is older; `None`
    /// without this rule.
    pub stale_module: Option<(Nanos, Then)>,
    /// Number of consecutive late turns, and the consequence; `None` without this rule.
    pub overrun: Option<(u64, Then)>,
    /// Guards, whose conditions are in the plan language, in the order of the file.
    pub guards: Vec<Guard>,
    /// Plans to which rules divert, each once.
    pub plans: Vec<PlanEntry>,
}

/// A plan to which rules divert.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanEntry {
    /// File of the plan, as the safety file names it.
    pub file: String,
    /// Line of the safety file that first names the plan, from 1.
    pub line: usize,
}

/// Limits of inputs. A limit that is absent is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The maximum speed, forwards and backwards, in metres per second; above 0.
    pub speed: f64,
    /// The maximum turn rate in either direction, in radians per second; above 0.
    pub turn_rate: f64,
    /// The maximum increase of the speed, in metres per second squared; above 0. Braking has no limit.
    pub acceleration: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { speed: f64::INFINITY, turn_rate: f64::INFINITY, acceleration: f64::INFINITY }
    }
}

/// A guard of the safety file.
#[derive(Debug, Clone, PartialEq)]
pub struct Guard {
    /// Name of the guard.
    pub name: String,
    /// The condition on the output.
    pub when: Condition,
    /// Consequence while the condition is true.
    pub then: Then,
}

/// The text of a condition, and its place in the safety file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    /// The text, in the plan language.
    pub text: String,
    /// Line of the text, from 1.
    pub line: usize,
    /// Byte range of the text in the safety file; the range of the whole value if the file writes the text with
    /// escapes.
    pub bytes: Range<usize>,
}

/// Consequence of a rule, the weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Then {
    /// The robot gets no forward speed.
    HoldForward,
    /// The robot gets the null input.
    Hold,
    /// Another plan takes over: its index in [`Rules::plans`]. The rule is off from then on.
    Divert(usize),
    /// The plan is ended.
    End,
}

/// The quantities of the rules that can be changed by name while a plan runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Maximum speed: [`Limits::speed`].
    Speed,
    /// Maximum turn rate: [`Limits::turn_rate`].
    TurnRate,
    /// Maximum acceleration: [`Limits::acceleration`].
    Acceleration,
}

impl Measure {
    /// All quantities.
    pub const ALL: [Self; 3] = [Self::Speed, Self::TurnRate, Self::Acceleration];

    /// Returns the key of the quantity in a safety file.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::TurnRate => "turn_rate",
            Self::Acceleration => "acceleration",
        }
    }

    /// Returns the kind of the quantity, and the unit in which it is written.
    #[must_use]
    pub fn quantity(self) -> (Quantity, &'static str) {
        match self {
            Self::Speed => (Quantity::Speed, "m/s"),
            Self::TurnRate => (Quantity::TurnRate, "deg/s"),
            Self::Acceleration => (Quantity::Acceleration, "m/s2"),
        }
    }

    /// Converts a value from the unit of [`Measure::quantity`] to SI.
    #[must_use]
    pub fn in_si(self, value: f64) -> f64 {
        match self {
            Self::TurnRate => Radians::from_degrees(value).0,
            Self::Speed | Self::Acceleration => value,
        }
    }

    /// Converts a value from SI to the unit of [`Measure::quantity`].
    #[must_use]
    pub fn in_its_unit(self, value: f64) -> f64 {
        match self {
            Self::TurnRate => Radians(value).degrees(),
            Self::Speed | Self::Acceleration => value,
        }
    }

    /// Returns the limit of this quantity.
    #[must_use]
    pub fn of(self, limits: &mut Limits) -> &mut f64 {
        match self {
            Self::Speed => &mut limits.speed,
            Self::TurnRate => &mut limits.turn_rate,
            Self::Acceleration => &mut limits.acceleration,
        }
    }
}
