//! A robot's alphabet 𝒜 = U ∪ B′ as types, for plans whose quarks are known by name only (paper, Definition 1).

use crate::{
    Bits, Comparison, Completes, Control, Interrupt, Law, Meters, MetersPerSecond, Nanos, Output, Radians,
    RadiansPerSecond, Signal, SonarId, Volts,
};

/// The quarks of one robot, each kind as one type; `mdlec bind` writes it from the robot's `alphabet.mdle`.
///
/// `wait` is not among its interrupts: time is the machine's business.
pub trait Alphabet {
    /// The robot's output.
    type Output: Output;
    /// Its input; the default is the null input.
    type Input: Default;
    /// Any of its interrupts, with its arguments.
    type Interrupt: Interrupt<Self::Output>;
    /// Any of its signals, with its arguments.
    type Signal: Signal<Self::Output>;
    /// Any of its laws, with its arguments.
    type Control: Control<Self::Output, Law = Self::Law>;
    /// Any of its laws as it runs; one that never completes says so by never being done.
    type Law: Law<Self::Output, Input = Self::Input> + Completes<Self::Output>;

    /// What the robot can do, in the alphabet's words, such as `sonar[16]`.
    const CAPABILITIES: &'static [&'static str];
    /// What plans may ask of its quarks, where the alphabet limits that.
    const LIMITS: &'static [Limit];

    /// The interrupt of this name with these arguments; `None` if the alphabet has no such signature.
    fn interrupt(name: &str, arguments: &[Argument<'_>]) -> Option<Self::Interrupt>;
    /// The signal of this name with these arguments; `None` if the alphabet has no such signature.
    fn signal(name: &str, arguments: &[Argument<'_>]) -> Option<Self::Signal>;
    /// A comparison of its signals as one of its interrupts; `None` if it has no signals.
    fn comparison(comparison: Comparison<Self::Signal, Self::Signal>) -> Option<Self::Interrupt>;
    /// The law of this name with these arguments; `None` if the alphabet has no such signature.
    fn control(name: &str, arguments: &[Argument<'_>]) -> Option<Self::Control>;
}

/// The range of a parameter that the alphabet declares with one, in SI units; both ends may be asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The quark.
    pub quark: &'static str,
    /// The parameter.
    pub parameter: &'static str,
    /// The lowest value.
    pub least: f64,
    /// The highest.
    pub most: f64,
}

/// An argument of a quark, of the kind that the alphabet declares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Argument<'a> {
    /// A `length`.
    Length(Meters),
    /// A `speed`.
    Speed(MetersPerSecond),
    /// An `angle`.
    Angle(Radians),
    /// An `angular_rate`.
    AngularRate(RadiansPerSecond),
    /// A `time`; [`Nanos::MAX`] for ever.
    Time(Nanos),
    /// A `voltage`.
    Voltage(Volts),
    /// A `number`.
    Number(f64),
    /// An `integer`.
    Integer(i64),
    /// A `count`; [`u64::MAX`] without end.
    Count(u64),
    /// A word of `bits`, the one written first in front.
    Bits(&'a [bool]),
    /// A `sonar`.
    Sonar(SonarId),
    /// The name of a `robot`, a `module` or a `file`.
    Name(&'static str),
}

impl<const N: usize> Bits<N> {
    /// These bits, if there are `N`.
    #[must_use]
    pub fn from_slice(bits: &[bool]) -> Option<Self> {
        bits.try_into().ok().map(Self)
    }
}
