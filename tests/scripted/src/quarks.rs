//! The quarks of `alphabet.mdle`: interrupts that read the script, and laws that write their number to the input.

use mdle_runtime::{
    Begin, Bits, Completes, Control, Interrupt, Law, Meters, MetersPerSecond, Nanos, Radians, RadiansPerSecond, Signal,
    SonarId, Volts,
};

use crate::reports::{duration, number};
use crate::{Input, LAWS, Output};

/// Declares interrupts: the type, the name in the alphabet, the parameters, and the arguments in default units.
macro_rules! interrupts {
    ($($name:ident $text:literal ($($arg:ident: $type:ty),*) [$($value:expr),*];)*) => {$(
        #[doc = concat!("The interrupt `", $text, "`.")]
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name { $($arg: $type),* }

        impl $name {
            /// The interrupt with its arguments.
            #[must_use]
            #[allow(clippy::new_without_default, reason = "as bound alphabets have it")]
            pub const fn new($($arg: $type),*) -> Self {
                Self { $($arg),* }
            }
        }

        impl Interrupt<Output> for $name {
            fn fired(&self, y: &Output) -> bool {
                let Self { $($arg),* } = *self;
                y.has_fired($text, &[$($value.into()),*])
            }
        }
    )*};
}

interrupts! {
    A "a" () [];
    B "b" () [];
    C "c" () [];
    D "d" () [];
    E "e" () [];
    F "f" () [];
    FarOff "farOff" (range: Meters) [range.0];
    Faster "faster" (than: MetersPerSecond) [than.0 * 100.0];
    Facing "facing" (bearing: Radians) [bearing.degrees()];
    Spinning "spinning" (rate: RadiansPerSecond) [rate.0];
    LowBattery "low_battery" (limit: Volts) [limit.0];
    Pattern "pattern" (bits: Bits<4>) [bits.0.iter().fold(0.0, |digits, bit| digits * 10.0 + f64::from(u8::from(*bit)))];
    Echo "echo" (sonar: SonarId) [sonar.number() as f64];
    Beyond "beyond" (ratio: f64, times: i64) [ratio, times as f64];
    Played "played" (tune: &'static str) [tune];
    Stuck "stuck" (time: Nanos) [duration(time)];
}

/// The signal `r`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct R(SonarId);

impl R {
    /// Returns the signal `r` of this sonar.
    #[must_use]
    pub const fn new(which: SonarId) -> Self {
        Self(which)
    }
}

impl Signal<Output> for R {
    fn value(&self, y: &Output) -> f64 {
        match self.0.number() {
            3 => y.signal("r3"),
            5 => y.signal("r5"),
            _ => f64::INFINITY,
        }
    }
}

/// Declares signals: the type and the name in the alphabet.
macro_rules! signals {
    ($($name:ident $text:literal;)*) => {$(
        #[doc = concat!("The signal `", $text, "`.")]
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name;

        impl $name {
            /// The signal.
            #[must_use]
            #[allow(clippy::new_without_default, reason = "as bound alphabets have it")]
            pub const fn new() -> Self {
                Self
            }
        }

        impl Signal<Output> for $name {
            fn value(&self, y: &Output) -> f64 {
                y.signal($text)
            }
        }
    )*};
}

signals! {
    X "x";
    Theta "theta";
    V "v";
}

/// Declares laws. The arguments are those of `interrupts!`, followed by the type of the law while its atom runs.
macro_rules! laws {
    ($($name:ident $text:literal ($($arg:ident: $type:ty),*) [$($value:expr),*] $law:ident;)*) => {$(
        #[doc = concat!("The law `", $text, "`.")]
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name { $($arg: $type),* }

        impl $name {
            /// The law with its arguments.
            #[must_use]
            #[allow(clippy::new_without_default, reason = "as bound alphabets have it")]
            pub const fn new($($arg: $type),*) -> Self {
                Self { $($arg),* }
            }
        }

        impl Control<Output> for $name {
            type Law = $law;

            fn begin(&self, _: &Output, begin: Begin) -> $law {
                let Self { $($arg),* } = *self;
                let number = number(LAWS, $text, &[$($value.into()),*]);
                $law(Input { law: number, began: begin.now, frame: begin.frame.0, computed: 0 })
            }
        }
    )*};
}

laws! {
    Idle "idle" () [] Endless;
    Drift "drift" () [] Endless;
    Drive "drive" (v: MetersPerSecond, omega: RadiansPerSecond) [v.0 * 100.0, omega.0] Endless;
    Seek "seek" () [] Finite;
    Climb "climb" () [] Finite;
    Veer "veer" (by: Radians) [by.degrees()] Finite;
    Wander "wander" (radius: Meters, pause: Nanos) [radius.0, pause.seconds()] Finite;
    Hold "hold" (pause: Nanos) [duration(pause)] Finite;
    Replay "replay" (tune: &'static str) [tune] Finite;
    Chase "chase" (leader: &'static str) [leader] Endless;
}

/// A law that runs until an interrupt fires.
#[derive(Debug, Clone, Copy)]
pub struct Endless(Input);

/// A law that runs until the script reports that it has completed.
#[derive(Debug, Clone, Copy)]
pub struct Finite(Input);

impl Law<Output> for Endless {
    type Input = Input;

    fn input(&mut self, _: &Output, _: Nanos) -> Input {
        self.0.computed = self.0.computed.saturating_add(1);
        self.0
    }
}

impl Law<Output> for Finite {
    type Input = Input;

    fn input(&mut self, _: &Output, _: Nanos) -> Input {
        self.0.computed = self.0.computed.saturating_add(1);
        self.0
    }
}

impl Completes<Output> for Finite {
    fn completed(&self, y: &Output, _: Nanos) -> bool {
        self.0.law.is_some_and(|law| y.is_completed(law))
    }
}
