//! Estimates the direction of an echo within the cone of its sonar from the echoes of the two adjacent sonars.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Ping, Radians, SONARS, SonarId};

use crate::directions::after;

/// Half the angle between two adjacent sonars.
const HALF: Radians = Radians::from_degrees(11.25);
/// Maximum time, in seconds, between the newest pings of two sonars whose echoes are compared. A Scout's ring takes
/// 0.96 s.
const APART: f64 = 1.1;
/// Maximum difference of two ranges of the same object, in metres, and the speed, in m/s, at which this maximum
/// increases with the time between the pings: the object may come nearer.
const SAME: (f64, f64) = (0.15, 0.6);

/// Returns the angle from the axis of `sonar` to the probable direction of the echo of its newest ping, `new`. If one
/// of the two adjacent sonars has received the echo of the same object, the object is between both axes. If both have
/// received one, or neither has, it is near the axis of `sonar`, and the angle is 0.
pub(crate) fn between<Y: SonarRing>(y: &Y, sonar: SonarId, new: &Ping, range: Meters) -> Radians {
    let hears = |further| {
        let ping = y.pings(after(sonar, further)).newest_first().next();
        ping.and_then(|ping| Some((ping, ping.range?))).is_some_and(|(ping, heard)| {
            let seconds = (ping.at.seconds() - new.at.seconds()).abs();
            seconds < APART && (heard.0 - range.0).abs() < SAME.0 + SAME.1 * seconds
        })
    };
    match (hears(1), hears(SONARS - 1)) {
        (true, false) => HALF,
        (false, true) => Radians(-HALF.0),
        _ => Radians(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::Nanos;

    /// Returns the angle, in degrees, from the axis of sonar 3 to an echo 2 m away. The sonars 2 and 4 have these
    /// ranges, and sonar 4 pings this number of seconds later.
    fn degrees(ranges: [Option<f64>; 2], later: f64) -> f64 {
        let mut y = Sensed::default();
        for (sonar, range, at) in [(2, ranges[0], 1.0), (3, Some(2.0), 1.0), (4, ranges[1], 1.0 + later)] {
            y.ping_at(SonarId::new(sonar), range, Nanos((at * 1e9) as u64));
        }
        let new = y.pings(SonarId::new(3)).newest_first().next().expect("a ping");
        between(&y, SonarId::new(3), new, Meters(2.0)).degrees()
    }

    #[test]
    fn what_two_sonars_hear_is_between_them() {
        assert!((degrees([None, Some(2.1)], 0.1) - 11.25).abs() < 1e-9);
        assert!((degrees([Some(1.9), None], 0.1) + 11.25).abs() < 1e-9);
        assert_eq!(degrees([None, None], 0.1), 0.0);
        assert_eq!(degrees([Some(2.1), Some(2.1)], 0.1), 0.0, "three hear it");
    }

    #[test]
    fn another_object_and_an_old_echo_do_not_count() {
        assert_eq!(degrees([None, Some(1.7)], 0.1), 0.0, "another object");
        assert!(degrees([None, Some(1.7)], 0.9) > 11.0, "a person who has come nearer since");
        assert_eq!(degrees([None, Some(1.7)], 1.2), 0.0, "an old echo");
    }
}
