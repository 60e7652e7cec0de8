//! The rules of a safety file, in SI units.

use std::ops::Range;

use mdle_quantity::Quantity;
use mdle_runtime::{Nanos, Radians};

use super::Fence;

/// Rules of a safety file. Without rules, every input that consists of finite numbers is sent unchanged.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rules {
    /// Limits of inputs.
    pub limits: Limits,
    /// Areas that the robot must not leave.
    pub fences: Vec<Fence>,
    /// Consequence of a bumper contact; `None` without this rule.
    pub contact: Option<Then>,
    /// Maximum age of the measurements in an output, and the consequence for older (stale) measurements; `None` without
    /// this rule.
    pub stale: Option<(Nanos, Then)>,
    /// Maximum age of a module's value that the plan or a guard reads, and the consequence for an older value; `None`
    /// without this rule.
    pub stale_module: Option<(Nanos, Then)>,
    /// Number of consecutive late turns that triggers the rule, and the consequence; `None` without this rule.
    pub overrun: Option<(u64, Then)>,
    /// Guards in the order of the file; their conditions are written in the plan language.
    pub guards: Vec<Guard>,
    /// Plans that rules start in place of the running plan, without duplicates.
    pub plans: Vec<PlanEntry>,
}

/// A plan that a rule starts in place of the running plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanEntry {
    /// File of the plan, as written in the safety file.
    pub file: String,
    /// Line of the safety file, counted from 1, that first names the plan.
    pub line: usize,
}

/// Limits of inputs; an absent limit is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum speed, forwards and backwards, in metres per second; above 0.
    pub speed: f64,
    /// Maximum turn rate in either direction, in radians per second; above 0.
    pub turn_rate: f64,
    /// Maximum increase of the speed, in metres per second squared; above 0. Braking is not limited.
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
    /// Condition on the output.
    pub when: ConditionText,
    /// Consequence while the condition is true.
    pub then: Then,
}

/// Text of a condition, and its position in the safety file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConditionText {
    /// Text in the plan language.
    pub text: String,
    /// Line of the text, counted from 1.
    pub line: usize,
    /// Byte range of the text in the safety file. If the text contains escape sequences, this is the range of the whole
    /// value.
    pub bytes: Range<usize>,
}

/// Consequence of a rule. The order is the order of strictness; the weakest consequence comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Then {
    /// The robot gets no forward speed, but may drive backwards.
    HoldForward,
    /// The robot gets the null input.
    Hold,
    /// Another plan takes over, given by its index in [`Rules::plans`]; the rule is off afterwards.
    Divert(usize),
    /// The plan is ended.
    End,
}

/// Quantities of safety rules that can be changed by name while a plan runs.
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

    /// Returns the kind of the quantity, and the unit in which users write it.
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

    /// Returns the limit of this quantity, so that it can be changed.
    #[must_use]
    pub fn of(self, limits: &mut Limits) -> &mut f64 {
        match self {
            Self::Speed => &mut limits.speed,
            Self::TurnRate => &mut limits.turn_rate,
            Self::Acceleration => &mut limits.acceleration,
        }
    }
}
