//! Reports of a script, and inputs of the robot. Each quark is represented by the index of its text.

use mdle_runtime::{Nanometers, Nanos, Pose, Radians};

/// Texts of all interrupts that a script can report, with arguments for interrupts that take arguments.
pub const INTERRUPTS: &[&str] = &[
    "a",
    "b",
    "c",
    "d",
    "e",
    "f",
    "farOff 2",
    "farOff 0.25",
    "faster 20",
    "faster 0.5",
    "facing 90",
    "facing -22.5",
    "spinning 0.36",
    "spinning -1",
    "low_battery 10.8",
    "pattern 0100",
    "pattern 1011",
    "echo 7",
    "echo 15",
    "beyond 0.125 -3",
    "farOff 0.0254",
    "farOff 0.3048",
    "faster 2.54",
    "spinning 1.5707963267948966",
    "played horn",
    "played \"bell.mid\"",
    "stuck 0.3",
    "stuck 1",
];

/// Texts of all laws.
pub const LAWS: &[&str] = &[
    "seek",
    "climb",
    "veer 90",
    "veer -45",
    "wander 3 1.5",
    "wander 0.5 0.02",
    "idle",
    "drift",
    "drive 20 0",
    "drive -5 0.36",
    "veer 57.29577951308232",
    "hold 0.5",
    "hold inf",
    "replay \"bell.mid\"",
    "chase sun module",
];

/// Signals that have a value; all other sonars have no echo.
pub const SIGNALS: [&str; 5] = ["r3", "r5", "x", "theta", "v"];

/// Output of a turn: the reports of the script.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// Interrupts that have fired: bit `i` stands for `INTERRUPTS[i]`.
    pub fired: u64,
    /// Laws that have completed: bit `i` stands for `LAWS[i]`.
    pub completed: u64,
    /// Values of [`SIGNALS`], in SI units.
    pub signals: [f64; SIGNALS.len()],
    /// Reading of the odometer.
    pub way: Nanometers,
    /// Heading by odometry.
    pub heading: Radians,
}

impl mdle_runtime::Output for Output {
    fn here(&self) -> Pose {
        Pose { theta: self.heading, ..Pose::ORIGIN }
    }

    fn way(&self) -> Option<Nanometers> {
        Some(self.way)
    }
}

impl Output {
    /// Returns `true` if the interrupt with this name and these arguments, in its default units, has fired.
    pub(crate) fn has_fired(&self, name: &str, arguments: &[Argument]) -> bool {
        number(INTERRUPTS, name, arguments).is_some_and(|bit| self.fired >> bit & 1 == 1)
    }

    /// Returns the value of a signal; infinity for a signal without a value.
    pub(crate) fn signal(&self, name: &str) -> f64 {
        let known = SIGNALS.iter().zip(self.signals).find(|(signal, _)| **signal == name);
        known.map_or(f64::INFINITY, |(_, value)| value)
    }

    /// Returns `true` if the law with this number has completed.
    pub(crate) fn is_completed(&self, law: usize) -> bool {
        self.completed >> law & 1 == 1
    }
}

/// Input of a turn, which identifies the law that computed it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Input {
    /// Index of the law in [`LAWS`]; `None` for the null input.
    pub law: Option<usize>,
    /// Time at which the law's atom began.
    pub began: Nanos,
    /// Frame in which the law's atom began.
    pub frame: Radians,
    /// Number of inputs that the law has computed since the atom began, this one included.
    pub computed: u32,
}

/// Argument of a quark, in its default unit.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Argument {
    /// A number.
    Number(f64),
    /// The name of a file or a module.
    Name(&'static str),
}

impl From<f64> for Argument {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&'static str> for Argument {
    fn from(name: &'static str) -> Self {
        Self::Name(name)
    }
}

/// Returns a time in seconds; infinite for [`Nanos::MAX`].
pub(crate) fn duration(time: Nanos) -> f64 {
    if time == Nanos::MAX { f64::INFINITY } else { time.seconds() }
}

/// Returns the index of the text with this name and these arguments, or `None` if there is none. Numbers are compared
/// with a tolerance, because they were converted to SI units and back.
pub(crate) fn number(texts: &[&str], name: &str, arguments: &[Argument]) -> Option<usize> {
    texts.iter().position(|text| {
        // The name is compared first, because splitting the text and parsing numbers is slow.
        let Some(rest) = text.strip_prefix(name).filter(|rest| rest.is_empty() || rest.starts_with(' ')) else {
            return false;
        };
        let mut words = rest.split(' ').skip(1).filter(|word| *word != "module");
        let mut given = arguments.iter();
        let same = words.all(|word| match given.next() {
            Some(Argument::Number(number)) => {
                word.parse::<f64>().is_ok_and(|word| word == *number || (word - number).abs() < 1e-9)
            }
            Some(Argument::Name(name)) => word.trim_matches('"') == *name,
            None => false,
        });
        same && given.next().is_none()
    })
}
