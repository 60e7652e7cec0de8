//! The signals of the target `scripted`: the values that a script gives them, and comparisons that depend on these
//! values.

use std::collections::BTreeSet;

use crate::chance::Chance;

/// A comparison: its spellings, its canonical text, and a function that returns `true` if it holds.
type Comparison = (&'static [&'static str], &'static str, fn(&Values) -> bool);

/// Values of the signals in a turn. They are taken from the lists below, so that each value has a text.
#[derive(Debug, Clone, Copy)]
pub struct Values {
    /// Range of sonar 3, in metres.
    pub r3: f64,
    /// Range of sonar 5, in metres.
    pub r5: f64,
    /// The x coordinate of the robot's position, in metres.
    pub x: f64,
    /// Heading, in degrees.
    pub theta: f64,
    /// Forward speed, in centimetres per second.
    pub v: f64,
}

const RANGES: &[f64] = &[0.5, 1.0, 1.02, 2.0];
const PLACES: &[f64] = &[-1.0, 0.0, 0.4, 3.0];
const HEADINGS: &[f64] = &[-179.5, 0.0, 90.5, 179.75];
const SPEEDS: &[f64] = &[-20.0, 0.0, 20.5];

/// Comparisons in random conditions.
const COMPARISONS: &[Comparison] = &[
    (&["r3 == r5", "r_3 == r_5(t)", "r 3 == r(5)"], "r3 == r5", |s| (s.r3 - s.r5).abs() <= 0.026),
    (&["r3 < r5"], "r3 < r5", |s| s.r3 < s.r5),
    (&["r_5 >= 100cm", "r5 ≥ 1"], "r5 >= 1", |s| s.r5 >= 1.0),
    (&["x > 0.1m", "x(t) > 10cm"], "x > 0.1", |s| s.x > 0.1),
    (&["x == -1.009"], "x == -1.009", |s| (s.x + 1.009).abs() <= 0.01),
    (&["theta == 180", "theta == 180deg"], "theta == 180", |s| s.theta.abs() >= 179.0),
    (&["theta <= 0"], "theta <= 0", |s| s.theta <= 0.0),
    (&["v > 0.2m/s", "v > 20"], "v > 20", |s| s.v > 20.0),
    (&["v \\leq 0"], "v <= 0", |s| s.v <= 0.0),
];

/// Comparisons of `t`, some of them with the durations of timers.
const TIMES: &[&str] = &[
    "t >= 0.25",
    "t > 100ms",
    "t < 0.3s",
    "t <= 0.05",
    "t == 0.1",
    "t(t) > 1",
    "t > 0",
    "t ≤ 0.2",
    "t >= inf",
    "t < inf",
];

/// Comparisons of `way`, some of them with the steps of scripts.
const WAYS: &[&str] =
    &["way >= 0.25m", "way > 10cm", "way < 300mm", "way <= 0.05", "way == 0.1", "way(t) > 1", "way > 0", "way ≥ 0.2"];

/// Returns a random comparison, as it is written in a condition.
pub fn comparison(chance: &mut Chance) -> String {
    if chance.percent(25) {
        return chance.pick(WAYS).to_owned();
    }
    if chance.percent(40) {
        return chance.pick(TIMES).to_owned();
    }
    let (spellings, ..) = COMPARISONS[chance.below(COMPARISONS.len())];
    chance.pick(spellings).to_owned()
}

/// Returns the values of the signals, in SI units, that the texts of a script give; infinity for a signal without a
/// text.
pub fn values(comparisons: &BTreeSet<String>) -> [f64; 5] {
    let value = |name: &str, values: &[f64], unit: f64| {
        let value = values.iter().find(|value| comparisons.contains(&format!("{name} == {value}")));
        value.map_or(f64::INFINITY, |value| value * unit)
    };
    [
        value("r3", RANGES, 1.0),
        value("r5", RANGES, 1.0),
        value("x", PLACES, 1.0),
        value("theta", HEADINGS, std::f64::consts::PI / 180.0),
        value("v", SPEEDS, 0.01),
    ]
}

impl Values {
    /// Returns random values for a turn.
    pub fn new(chance: &mut Chance) -> Self {
        let mut one = |values: &[f64]| values[chance.below(values.len())];
        Self { r3: one(RANGES), r5: one(RANGES), x: one(PLACES), theta: one(HEADINGS), v: one(SPEEDS) }
    }

    /// Returns the texts of the comparisons that hold, and the texts of the values.
    pub fn texts(&self) -> Vec<String> {
        let hold = COMPARISONS.iter().filter(|(.., holds)| holds(self)).map(|(_, text, _)| (*text).to_owned());
        hold.chain(self.assignments()).collect()
    }

    fn assignments(&self) -> [String; 5] {
        let Self { r3, r5, x, theta, v } = self;
        [
            format!("r3 == {r3}"),
            format!("r5 == {r5}"),
            format!("x == {x}"),
            format!("theta == {theta}"),
            format!("v == {v}"),
        ]
    }
}
