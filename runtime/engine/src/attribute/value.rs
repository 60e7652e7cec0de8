//! Values of attributes, with their kinds and times.

use std::sync::Arc;

use mdle_compiler::alphabet::ParameterKind;
use mdle_runtime::{Meters, MetersPerSecond, Nanos, Pose, Radians, RadiansPerSecond, Volts};

/// Kind of an attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeKind {
    /// Boolean.
    Flag,
    /// Whole number.
    Integer,
    /// Number without a unit.
    Number,
    /// Length, in metres.
    Length,
    /// Speed, in metres per second.
    Speed,
    /// Angle, in radians.
    Angle,
    /// Turn rate, in radians per second.
    AngularRate,
    /// Voltage, in volts.
    Voltage,
    /// Time, in nanoseconds.
    Time,
    /// Position and heading in the plane.
    Pose,
    /// Text.
    Text,
    /// List of numbers without a unit.
    Numbers,
    /// List of bytes.
    Bytes,
}

/// Value of an attribute with its kind, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Boolean value.
    Flag(bool),
    /// Whole number.
    Integer(i64),
    /// Number without a unit.
    Number(f64),
    /// Length, in metres.
    Length(Meters),
    /// Speed, in metres per second.
    Speed(MetersPerSecond),
    /// Angle, in radians.
    Angle(Radians),
    /// Turn rate, in radians per second.
    AngularRate(RadiansPerSecond),
    /// Voltage, in volts.
    Voltage(Volts),
    /// Time, in nanoseconds.
    Time(Nanos),
    /// Position and heading in the plane.
    Pose(Pose),
    /// Text.
    Text(Arc<str>),
    /// List of numbers without a unit.
    Numbers(Arc<[f64]>),
    /// List of bytes.
    Bytes(Arc<[u8]>),
}

/// A value with the time at which it was published, on the engine's clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The published value.
    pub value: Value,
    /// Start time of the turn whose turn break published the value.
    pub at: Nanos,
}

impl AttributeKind {
    /// All kinds, in the order of their numbers in records of runs.
    const ALL: [Self; 13] = [
        Self::Flag,
        Self::Integer,
        Self::Number,
        Self::Length,
        Self::Speed,
        Self::Angle,
        Self::AngularRate,
        Self::Voltage,
        Self::Time,
        Self::Pose,
        Self::Text,
        Self::Numbers,
        Self::Bytes,
    ];

    /// Returns the number of the kind in records.
    pub(crate) fn number(self) -> u8 {
        (0..).zip(Self::ALL).find(|(_, kind)| *kind == self).map_or(u8::MAX, |(number, _)| number)
    }

    /// Returns the kind with this number in records; `None` if no kind has the number.
    pub(crate) fn of_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Returns the kind in words, with an article: "an angle".
    #[must_use]
    pub fn words(self) -> String {
        match (self, self.quantity()) {
            (Self::Flag, _) => "a flag".into(),
            (Self::Pose, _) => "a pose".into(),
            (Self::Text, _) => "a text".into(),
            (Self::Numbers, _) => "a list of numbers".into(),
            (Self::Bytes, _) => "bytes".into(),
            (_, Some(kind)) => kind.words(),
            (_, None) => "a value".into(),
        }
    }

    /// Returns the corresponding kind in an alphabet, or `None` if plans cannot read values of this kind as numbers.
    #[must_use]
    pub fn quantity(self) -> Option<ParameterKind> {
        match self {
            Self::Integer => Some(ParameterKind::Integer),
            Self::Number => Some(ParameterKind::Number),
            Self::Length => Some(ParameterKind::Length),
            Self::Speed => Some(ParameterKind::Speed),
            Self::Angle => Some(ParameterKind::Angle),
            Self::AngularRate => Some(ParameterKind::AngularRate),
            Self::Voltage => Some(ParameterKind::Voltage),
            Self::Time => Some(ParameterKind::Time),
            Self::Flag | Self::Pose | Self::Text | Self::Numbers | Self::Bytes => None,
        }
    }
}

impl Value {
    /// Returns the kind of the value.
    #[must_use]
    pub fn kind(&self) -> AttributeKind {
        match self {
            Self::Flag(_) => AttributeKind::Flag,
            Self::Integer(_) => AttributeKind::Integer,
            Self::Number(_) => AttributeKind::Number,
            Self::Length(_) => AttributeKind::Length,
            Self::Speed(_) => AttributeKind::Speed,
            Self::Angle(_) => AttributeKind::Angle,
            Self::AngularRate(_) => AttributeKind::AngularRate,
            Self::Voltage(_) => AttributeKind::Voltage,
            Self::Time(_) => AttributeKind::Time,
            Self::Pose(_) => AttributeKind::Pose,
            Self::Text(_) => AttributeKind::Text,
            Self::Numbers(_) => AttributeKind::Numbers,
            Self::Bytes(_) => AttributeKind::Bytes,
        }
    }

    /// Returns the value as the number that plans read, in SI units, or `None` if plans cannot read values of this
    /// kind.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            // A whole number of more than 53 bits is rounded; a plan compares within a tolerance.
            Self::Integer(number) => Some(*number as f64),
            Self::Number(number)
            | Self::Length(Meters(number))
            | Self::Speed(MetersPerSecond(number))
            | Self::Angle(Radians(number))
            | Self::AngularRate(RadiansPerSecond(number))
            | Self::Voltage(Volts(number)) => Some(*number),
            Self::Time(time) => Some(time.seconds()),
            Self::Flag(_) | Self::Pose(_) | Self::Text(_) | Self::Numbers(_) | Self::Bytes(_) => None,
        }
    }

    /// Returns the bits of a value that plans can read as a number; 0 for any other value.
    pub(crate) fn bits(&self) -> u64 {
        match self {
            Self::Integer(number) => number.cast_unsigned(),
            Self::Time(time) => time.0,
            Self::Number(_)
            | Self::Length(_)
            | Self::Speed(_)
            | Self::Angle(_)
            | Self::AngularRate(_)
            | Self::Voltage(_) => self.number().map_or(0, f64::to_bits),
            Self::Flag(_) | Self::Pose(_) | Self::Text(_) | Self::Numbers(_) | Self::Bytes(_) => 0,
        }
    }

    /// Converts these bits to a value of kind `kind`. If plans cannot read values of this kind as numbers, returns a
    /// placeholder of a kind that they cannot read either.
    pub(crate) fn of_bits(kind: AttributeKind, bits: u64) -> Self {
        let number = f64::from_bits(bits);
        match kind {
            AttributeKind::Integer => Self::Integer(bits.cast_signed()),
            AttributeKind::Number => Self::Number(number),
            AttributeKind::Length => Self::Length(Meters(number)),
            AttributeKind::Speed => Self::Speed(MetersPerSecond(number)),
            AttributeKind::Angle => Self::Angle(Radians(number)),
            AttributeKind::AngularRate => Self::AngularRate(RadiansPerSecond(number)),
            AttributeKind::Voltage => Self::Voltage(Volts(number)),
            AttributeKind::Time => Self::Time(Nanos(bits)),
            AttributeKind::Flag
            | AttributeKind::Pose
            | AttributeKind::Text
            | AttributeKind::Numbers
            | AttributeKind::Bytes => Self::Flag(false),
        }
    }

    /// Returns `true` if the value contains NaN and must not be published.
    #[must_use]
    pub fn has_nan(&self) -> bool {
        match self {
            Self::Pose(pose) => pose.x.0.is_nan() || pose.y.0.is_nan() || pose.theta.0.is_nan(),
            Self::Numbers(numbers) => numbers.iter().any(|number| number.is_nan()),
            Self::Flag(_) | Self::Integer(_) | Self::Time(_) | Self::Text(_) | Self::Bytes(_) => false,
            Self::Number(_)
            | Self::Length(_)
            | Self::Speed(_)
            | Self::Angle(_)
            | Self::AngularRate(_)
            | Self::Voltage(_) => self.number().is_none_or(f64::is_nan),
        }
    }
}
