//! Interface to a robot's alphabet 𝒜 = U ∪ B′, which consists of the laws U and the interrupts B′ (paper, Definition
//! 1). Plans that refer to quarks only by name use this interface.

use crate::{
    Bits, Comparison, Completes, Control, Interrupt, Law, Meters, MetersPerSecond, Nanos, Output, Radians,
    RadiansPerSecond, Signal, SonarId, Volts,
};

/// Alphabet of one robot, with one type for each kind of quark. [`alphabet!`](crate::alphabet!) implements this trait
/// from the tables that `mdlec bind` writes for the robot's `alphabet.mdle`.
///
/// The interrupt `wait` is not part of an alphabet, because the machine itself measures time.
pub trait Alphabet {
    /// Output of the robot.
    type Output: Output;
    /// Input of the robot; its default is the null input.
    type Input: Default;
    /// An interrupt of the alphabet with its arguments.
    type Interrupt: Interrupt<Self::Output>;
    /// A signal of the alphabet with its arguments.
    type Signal: Signal<Self::Output>;
    /// A law of the alphabet with its arguments.
    type Control: Control<Self::Output, Law = Self::Law>;
    /// A running law of the alphabet. A law without a completion condition never completes.
    type Law: Law<Self::Output, Input = Self::Input> + Completes<Self::Output>;

    /// Name of the target, as in `--target`.
    const NAME: &'static str;
    /// Hash of the alphabet's text. A plan that was compiled for an alphabet with another hash is rejected.
    const HASH: u64;
    /// Capabilities of the robot, spelled as in the alphabet, such as `sonar[16]`.
    const CAPABILITIES: &'static [&'static str];
    /// Ranges of the parameters for which the alphabet declares a range.
    const LIMITS: &'static [Limit];

    /// Returns the interrupt with this name and these arguments; `None` if the alphabet has no such signature.
    fn interrupt(name: &str, arguments: &[Argument<'_>]) -> Option<Self::Interrupt>;
    /// Returns the signal with this name and these arguments; `None` if the alphabet has no such signature.
    fn signal(name: &str, arguments: &[Argument<'_>]) -> Option<Self::Signal>;
    /// Converts a comparison of signals to an interrupt of the alphabet; `None` if the alphabet has no signals.
    fn comparison(comparison: Comparison<Self::Signal, Self::Signal>) -> Option<Self::Interrupt>;
    /// Returns the law with this name and these arguments; `None` if the alphabet has no such signature.
    fn control(name: &str, arguments: &[Argument<'_>]) -> Option<Self::Control>;
}

/// Range that the alphabet declares for a parameter, in SI units, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Name of the quark.
    pub quark: &'static str,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Minimum value.
    pub least: f64,
    /// Maximum value.
    pub most: f64,
}

/// An argument of a quark. Each variant is a kind of argument that an alphabet can declare.
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
    /// A `time`; [`Nanos::MAX`] means forever.
    Time(Nanos),
    /// A `voltage`.
    Voltage(Volts),
    /// A `number`.
    Number(f64),
    /// An `integer`.
    Integer(i64),
    /// A `count`; [`u64::MAX`] means an unlimited count.
    Count(u64),
    /// The bits of a `bits` argument, in the order in which they are written.
    Bits(&'a [bool]),
    /// A `sonar`.
    Sonar(SonarId),
    /// The name of a `robot`, a `module` or a `file`.
    Name(&'static str),
}

impl<const N: usize> Bits<N> {
    /// Returns the bits if there are exactly `N`; `None` otherwise.
    #[must_use]
    pub const fn from_slice(bits: &[bool]) -> Option<Self> {
        match bits.first_chunk() {
            Some(word) if bits.len() == N => Some(Self(*word)),
            Some(_) | None => None,
        }
    }
}

/// Declares `Alphabet`, `AnyInterrupt`, `AnySignal`, `AnyControl` and `AnyLaw` from the tables of a robot's alphabet,
/// which `mdlec bind` writes.
///
/// `Output` and `Input` of the robot, and `NAME` and `HASH` of its alphabet, must be in scope. If `Output` must
/// implement a trait for a capability, the trait follows the capability. Limits are in SI units. Each quark is declared
/// by its name, its type, and a constant function. The function creates the quark from its arguments, and returns
/// `None` if the arguments fit another signature.
#[macro_export]
macro_rules! alphabet {
    (
        capabilities: [$($capability:literal $(as $needed:ident)?),* $(,)?];
        limits: [$($quark:literal $parameter:literal in $least:literal..$most:literal),* $(,)?];
        interrupts: [$($interrupt_name:literal => $interrupt:ident($interrupt_of:path)),* $(,)?];
        signals: [$($signal_name:literal => $signal:ident($signal_of:path)),* $(,)?];
        controls: [$($control_name:literal => $control:ident($control_of:path) $($completes:ident)?),* $(,)?];
    ) => {
        /// Any interrupt of this robot with its arguments.
        #[derive(Debug)]
        pub enum AnyInterrupt {
            $(#[doc = concat!("`", $interrupt_name, "`.")] $interrupt($interrupt),)*
            /// A comparison of signals.
            Comparison($crate::Comparison<AnySignal, AnySignal>),
        }

        impl $crate::Interrupt<Output> for AnyInterrupt {
            fn fired(&self, y: &Output) -> bool {
                match self {
                    $(Self::$interrupt(interrupt) => $crate::Interrupt::fired(interrupt, y),)*
                    Self::Comparison(comparison) => $crate::Interrupt::fired(comparison, y),
                }
            }

            fn fired_during(&self, y: &Output, stalled: ::core::option::Option<$crate::Nanos>) -> bool {
                match self {
                    $(Self::$interrupt(interrupt) => $crate::Interrupt::fired_during(interrupt, y, stalled),)*
                    Self::Comparison(comparison) => $crate::Interrupt::fired(comparison, y),
                }
            }

            fn measured(&self, y: &Output) -> $crate::Measured {
                match self {
                    $(Self::$interrupt(_) => $crate::Measured::Nothing,)*
                    Self::Comparison(comparison) => $crate::Interrupt::measured(comparison, y),
                }
            }
        }

        /// Any signal of this robot with its arguments.
        #[derive(Debug)]
        pub enum AnySignal {
            $(#[doc = concat!("`", $signal_name, "`.")] $signal($signal),)*
        }

        // Matches the value instead of the reference: a match on a reference to an enum without variants does not
        // compile.
        impl $crate::Signal<Output> for AnySignal {
            fn value(&self, y: &Output) -> f64 {
                match *self { $(Self::$signal(ref signal) => $crate::Signal::value(signal, y),)* }
            }
        }

        /// Any law of this robot with its arguments.
        #[derive(Debug)]
        pub enum AnyControl {
            $(#[doc = concat!("`", $control_name, "`.")] $control($control),)*
        }

        /// Any running law of this robot. Only one law runs at a time, so no allocator is needed.
        #[derive(Debug)]
        pub enum AnyLaw {
            $(#[doc = concat!("`", $control_name, "`.")] $control(<$control as $crate::Control<Output>>::Law),)*
        }

        impl $crate::Control<Output> for AnyControl {
            type Law = AnyLaw;

            fn begin(&self, y: &Output, begin: $crate::Begin) -> AnyLaw {
                match *self {
                    $(Self::$control(ref control) => AnyLaw::$control($crate::Control::begin(control, y, begin)),)*
                }
            }
        }

        impl $crate::Law<Output> for AnyLaw {
            type Input = Input;

            fn input(&mut self, y: &Output, t: $crate::Nanos) -> Input {
                match *self { $(Self::$control(ref mut law) => $crate::Law::input(law, y, t),)* }
            }

            fn stalled(&self, y: &Output, t: $crate::Nanos) -> ::core::option::Option<$crate::Nanos> {
                match *self { $(Self::$control(ref law) => $crate::Law::stalled(law, y, t),)* }
            }
        }

        impl $crate::Completes<Output> for AnyLaw {
            fn completed(&self, y: &Output, t: $crate::Nanos) -> bool {
                match *self {
                    $(Self::$control(ref law) => $crate::alphabet!(@completed law y t $($completes)?),)*
                }
            }
        }

        // Checks at compile time that the output implements the traits of the capabilities.
        const _: () = {
            const fn capable<Y: $($($crate::capability::$needed +)?)*>() {}
            capable::<Output>()
        };

        /// Alphabet of this robot, which finds quarks by name.
        #[derive(Debug)]
        pub struct Alphabet;

        impl $crate::Alphabet for Alphabet {
            type Output = Output;
            type Input = Input;
            type Interrupt = AnyInterrupt;
            type Signal = AnySignal;
            type Control = AnyControl;
            type Law = AnyLaw;

            const NAME: &'static str = NAME;
            const HASH: u64 = HASH;
            const CAPABILITIES: &'static [&'static str] = &[$($capability),*];
            const LIMITS: &'static [$crate::Limit] = &[
                $($crate::Limit { quark: $quark, parameter: $parameter, least: $least, most: $most }),*
            ];

            $crate::alphabet!(@by_name interrupt AnyInterrupt [$($interrupt_name $interrupt $interrupt_of,)*]);
            $crate::alphabet!(@by_name signal AnySignal [$($signal_name $signal $signal_of,)*]);
            $crate::alphabet!(@by_name control AnyControl [$($control_name $control $control_of,)*]);

            fn comparison(
                comparison: $crate::Comparison<AnySignal, AnySignal>,
            ) -> ::core::option::Option<AnyInterrupt> {
                ::core::option::Option::Some(AnyInterrupt::Comparison(comparison))
            }
        }
    };
    (@completed $law:ident $y:ident $t:ident) => { false };
    (@completed $law:ident $y:ident $t:ident completes) => { $crate::Completes::completed($law, $y, $t) };
    (@by_name $function:ident $any:ident [$($name:literal $kind:ident $of:path,)*]) => {
        fn $function(name: &str, arguments: &[$crate::Argument<'_>]) -> ::core::option::Option<$any> {
            // Several quarks may share a name.
            $(if name == $name && let ::core::option::Option::Some(quark) = $of(arguments) {
                return ::core::option::Option::Some($any::$kind(quark));
            })*
            ::core::option::Option::None
        }
    };
}
