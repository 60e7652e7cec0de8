//! The signals that plans compare: sonar ranges and their age, and odometry (paper, section IV-A: `r_i`).

use mdle_runtime::capability::{Odometry, SonarRing};
use mdle_runtime::{Signal, SonarId};

/// The signal `r`: the last range of a sonar, in metres; infinite without an echo, or before the first ping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct R(SonarId);

impl R {
    /// Creates the signal of this sonar.
    #[must_use]
    pub const fn new(which: SonarId) -> Self {
        Self(which)
    }
}

impl<Y: SonarRing> Signal<Y> for R {
    fn value(&self, y: &Y) -> f64 {
        let newest = y.pings(self.0).newest_first().next();
        newest.and_then(|ping| ping.range).map_or(f64::INFINITY, |range| range.0)
    }
}

/// The signal `age`: the age of a sonar's last ping, in seconds; infinite before its first ping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Age(SonarId);

impl Age {
    /// Creates the signal of this sonar.
    #[must_use]
    pub const fn new(which: SonarId) -> Self {
        Self(which)
    }
}

impl<Y: SonarRing> Signal<Y> for Age {
    fn value(&self, y: &Y) -> f64 {
        let newest = y.pings(self.0).newest_first().next();
        newest.map_or(f64::INFINITY, |ping| y.now().since(ping.at).seconds())
    }
}

/// Declares odometry signals. Takes, for each signal, the name of its type, a doc comment, and an expression for its
/// value.
macro_rules! signals {
    ($($name:ident $doc:literal |$y:ident| $value:expr;)*) => {$(
        #[doc = $doc]
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name;

        impl $name {
            /// Creates the signal.
            #[must_use]
            #[allow(clippy::new_without_default, reason = "as bound alphabets have it")]
            pub const fn new() -> Self {
                Self
            }
        }

        impl<O: Odometry> Signal<O> for $name {
            fn value(&self, $y: &O) -> f64 {
                $value
            }
        }
    )*};
}

signals! {
    X "The place along the first axis of odometry, in metres." |y| y.pose().x.0;
    Y "The place along the second axis of odometry, in metres." |y| y.pose().y.0;
    Theta "The heading by odometry, in radians between -π and π." |y| y.pose().theta.wrapped().0;
    V "The measured forward speed, in metres a second." |y| y.velocity().v.0;
    Omega "The measured turn rate, in radians a second." |y| y.velocity().omega.0;
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Nanos, Radians, RadiansPerSecond};

    use super::*;
    use crate::trial::Sensed;

    #[test]
    fn the_last_ping_of_a_sonar_is_its_range() {
        let mut y = Sensed::default();
        let range = |y: &Sensed| R::new(SonarId::new(3)).value(y);
        assert_eq!(range(&y), f64::INFINITY);
        y.ping(SonarId::new(3), Some(2.5));
        y.ping(SonarId::new(4), Some(1.0));
        assert_eq!(range(&y), 2.5);
        y.ping(SonarId::new(3), None);
        assert_eq!(range(&y), f64::INFINITY);
    }

    #[test]
    fn a_sonar_is_as_old_as_its_last_ping_echo_or_not() {
        let mut y = Sensed { now: Nanos(2_500_000_000), ..Sensed::default() };
        let age = |y: &Sensed| Age::new(SonarId::new(3)).value(y);
        assert_eq!(age(&y), f64::INFINITY);
        y.ping_at(SonarId::new(3), Some(2.5), Nanos(1_000_000_000));
        assert_eq!(age(&y), 1.5);
        y.ping_at(SonarId::new(3), None, Nanos(2_000_000_000));
        assert_eq!(age(&y), 0.5);
    }

    #[test]
    fn odometry_is_read_in_its_own_axes() {
        let mut y = Sensed::default();
        y.pose.x.0 = 1.0;
        y.pose.y.0 = -2.0;
        y.pose.theta = Radians::from_degrees(270.0);
        y.velocity.v.0 = 0.25;
        y.velocity.omega = RadiansPerSecond(-0.5);
        assert_eq!((X::new().value(&y), Y::new().value(&y)), (1.0, -2.0));
        assert!((Theta::new().value(&y) - Radians::from_degrees(-90.0).0).abs() < 1e-12);
        assert_eq!((V::new().value(&y), Omega::new().value(&y)), (0.25, -0.5));
    }
}
