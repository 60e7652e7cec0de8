//! Contains the signals that read the numbers that modules publish, and `goAvoid` towards a goal that a module
//! publishes (paper, sections III-B and IV-B).

use mdle_runtime::capability::{DiffDrive, Modules, Odometry, SonarRing};
use mdle_runtime::{Begin, Control, Law, Meters, MetersPerSecond, Nanos, Radians, Signal, Twist};

use crate::go_avoid::{GoAvoid, GoingRound};

/// Name of the attribute of a module that contains the direction to a point, in radians, relative to the robot's
/// heading.
const BEARING: &str = "bearing";
/// Name of the attribute of a module that contains the distance to a point, in metres.
const RANGE: &str = "range";
/// Name of an attribute that every module has: the time, in seconds, since the module published the attributes that the
/// plan reads.
const AGE: &str = "age";
/// Age from which a direction is stale.
const STALE: Nanos = Nanos(2_000_000_000);
/// Assumed distance to a goal whose module publishes no range.
const FAR: Meters = Meters(5.0);
/// Speed, in m/s, at which the robot drives where the way is free.
const SPEED: MetersPerSecond = MetersPerSecond(0.2);

/// Declares module signals. The macro takes, for each signal, the name of its type, a doc comment, and an expression
/// for its value.
macro_rules! signals {
    ($($name:ident $doc:literal |$y:ident, $module:ident| $value:expr;)*) => {$(
        #[doc = $doc]
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name(&'static str);

        impl $name {
            /// Creates the signal that reads what the module with the name `of` publishes.
            #[must_use]
            pub const fn new(of: &'static str) -> Self {
                Self(of)
            }
        }

        impl<O: Modules> Signal<O> for $name {
            fn value(&self, $y: &O) -> f64 {
                let $module = self.0;
                $value
            }
        }
    )*};
}

// A comparison with NaN never fires.
signals! {
    Bearing "The direction that a module publishes, in radians from where the robot heads; NaN before the first."
        |y, module| y.published(module, BEARING).map_or(f64::NAN, |number| number.value);
    Range "The distance that a module publishes, in metres; NaN before the first."
        |y, module| y.published(module, RANGE).map_or(f64::NAN, |number| number.value);
    Age2 "Time since a module published what the plan reads of it, in seconds; infinite before the first."
        |y, module| y.published(module, AGE).map_or(f64::INFINITY, |number| number.value);
}

/// The control `goAvoid` that drives around obstacles towards the goal that a module publishes; the goal may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GoAvoid2(&'static str);

impl GoAvoid2 {
    /// Creates the quark `goAvoid target`, where `target` names a module that publishes `bearing` and, optionally,
    /// `range`.
    #[must_use]
    pub const fn new(target: &'static str) -> Self {
        Self(target)
    }
}

/// The law of [`GoAvoid2`]: `goAvoid` to the latest published goal. The robot stands still while the bearing is
/// more than two seconds old.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Following {
    module: &'static str,
    begin: Begin,
    /// The law that drives to the goal, and the time at which the goal was published; `None` before a goal is known.
    towards: Option<(Nanos, GoingRound)>,
}

impl<Y: DiffDrive + Odometry + SonarRing + Modules> Control<Y> for GoAvoid2 {
    type Law = Following;

    fn begin(&self, _: &Y, begin: Begin) -> Following {
        Following { module: self.0, begin, towards: None }
    }
}

impl<Y: DiffDrive + Odometry + SonarRing + Modules> Law<Y> for Following {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let Some(bearing) = y.published(self.module, BEARING).filter(|bearing| bearing.age <= STALE) else {
            return Twist::default();
        };
        if self.towards.is_none_or(|(at, _)| at != bearing.at) {
            let range = y.published(self.module, RANGE).map_or(FAR, |range| Meters(range.value));
            let heading = Radians(y.pose().theta.0 + bearing.value - self.begin.frame.0.0);
            let goal = Control::<Y>::begin(&GoAvoid::new(heading, range, SPEED), y, Begin { now: t, ..self.begin });
            // The law keeps its memory of obstacles.
            let law = self.towards.map_or(goal, |(_, before)| before.with_goal_of(&goal, y.pose()));
            self.towards = Some((bearing.at, law));
        }
        self.towards.as_mut().map_or_else(Twist::default, |(_, law)| Law::<Y>::input(law, y, t))
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Frame, ModuleRead, Published, PublishedNumber};

    use super::*;
    use crate::trial::Sensed;

    static NAMES: [ModuleRead; 3] = [
        ModuleRead { module: "heading", attribute: AGE, unit: None },
        ModuleRead { module: "heading", attribute: BEARING, unit: None },
        ModuleRead { module: "heading", attribute: RANGE, unit: None },
    ];

    /// Returns an output in which the module `heading` has published these numbers.
    fn heard(bearing: f64, range: f64, at: Nanos, age: Nanos) -> Sensed {
        let mut published = Published::new(&NAMES);
        for (place, value) in [age.seconds(), bearing, range].into_iter().enumerate() {
            published.set(place, Some(PublishedNumber { value, at, age }));
        }
        Sensed { published, ..Sensed::default() }
    }

    #[test]
    fn signals_read_the_module_that_they_name() {
        let y = heard(0.5, 2.0, Nanos(7), Nanos(250_000_000));
        let values = |module| {
            [
                Signal::<Sensed>::value(&Bearing::new(module), &y),
                Signal::<Sensed>::value(&Range::new(module), &y),
                Signal::<Sensed>::value(&Age2::new(module), &y),
            ]
        };
        assert_eq!(values("heading"), [0.5, 2.0, 0.25]);
        let [bearing, range, age] = values("ears");
        assert!(bearing.is_nan() && range.is_nan() && age == f64::INFINITY);
    }

    #[test]
    fn the_robot_follows_what_is_fresh() {
        let begin = Begin { now: Nanos::ZERO, frame: Frame(Radians(0.0)) };
        let mut law = Control::<Sensed>::begin(&GoAvoid2::new("heading"), &Sensed::default(), begin);
        let mut turned = |y: &Sensed| Law::<Sensed>::input(&mut law, y, Nanos::ZERO).omega.0;
        let left = turned(&heard(1.5, 2.0, Nanos(1), Nanos(1)));
        // The goal moves to the other side.
        let right = turned(&heard(-1.5, 2.0, Nanos(2), Nanos(1)));
        let stale = turned(&heard(-1.5, 2.0, Nanos(2), Nanos(2_000_000_001)));
        assert!(left > 0.1 && right < -0.1 && stale == 0.0, "{left} {right} {stale}");
    }
}
