//! The drift of a heading by odometry, measured by a wall beside the robot that runs along an axis of the frame.

use core::f64::consts::FRAC_PI_2;

use crate::{Meters, Pings, Radians, SONARS};

/// Greatest drift that is believed; at 45° a wall might as well run along the other axis.
const MOST: Radians = Radians::from_degrees(40.0);
/// Walls further away than this, in metres, are not looked at.
const WITHIN: f64 = 1.5;
/// Greatest difference, in metres, of the ranges to both sides of a wall to which the robot is nearly square.
const SQUARE: f64 = 0.12;
/// Greatest distance, in metres, of the middle of a straight wall from the mean of its sides.
const STRAIGHT: f64 = 0.1;

/// Returns the angle from the direction `axis` to the direction, of the four that are whole quarters from `axis`, that
/// is nearest to `way`.
#[must_use]
pub fn off_axis(way: Radians, axis: Radians) -> Radians {
    Radians(libm::round(Radians(way.0 - axis.0).wrapped().0 / FRAC_PI_2) * FRAC_PI_2)
}

/// Returns the angle from the frame's axes, one of which has the direction `axis` by odometry, to the nearest straight
/// wall that the sonars of a robot with this heading hear square to it; 0 where there is none. `apart` is the distance
/// between the places of a wall that the sonars before and behind the direction to it hear.
///
/// A wall to which the robot is square is as far before that direction as behind it.
pub(crate) fn drift(pings: &[Pings; SONARS], heading: Radians, axis: Radians, apart: Meters) -> Radians {
    // The nearest of two: few ranges that mean nothing are too short.
    let range = |sonar: usize| pings.get(sonar % SONARS)?.nearest(2).map(|range| range.0);
    let mut nearest = None;
    for sonar in (0..SONARS).step_by(4) {
        let around = [sonar.wrapping_add(SONARS - 1), sonar, sonar.wrapping_add(1)];
        let [Some(before), Some(middle), Some(behind)] = around.map(range) else {
            continue;
        };
        let is_wall = (before - behind).abs() < SQUARE && ((before + behind) / 2.0 - middle).abs() < STRAIGHT;
        if is_wall && middle < nearest.map_or(WITHIN, |(range, _)| range) {
            nearest = Some((middle, (before - behind) / apart.0));
        }
    }
    let Some((_, askew)) = nearest else { return Radians(0.0) };
    let wall = Radians(heading.0 + askew);
    let drift = Radians(wall.0 - axis.0 - off_axis(wall, axis).0).wrapped();
    if drift.0.abs() <= MOST.0 { drift } else { Radians(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Nanos, Ping, Pose};

    /// The drift of a robot with this heading that hears these ranges before, at and behind the direction of a sonar.
    fn measured(heading: f64, sonar: usize, ranges: [f64; 3]) -> f64 {
        let mut pings = [Pings::default(); SONARS];
        for (number, range) in [sonar + SONARS - 1, sonar, sonar + 1].into_iter().zip(ranges) {
            let ping = Ping { range: Some(Meters(range)), at: Nanos::ZERO, pose: Pose::ORIGIN };
            pings[number % SONARS].push(ping);
        }
        drift(&pings, Radians::from_degrees(heading), Radians(0.0), Meters(0.33)).degrees()
    }

    #[test]
    fn a_wall_beside_the_robot_measures_its_heading() {
        assert!((measured(20.0, 4, [0.5, 0.49, 0.5]) - 20.0).abs() < 1e-9);
        assert!((measured(-110.0, 12, [0.5, 0.49, 0.5]) + 20.0).abs() < 1e-9);
        // Further before than behind: the wall lies counter-clockwise of the robot's heading.
        assert!((measured(0.0, 4, [0.53, 0.5, 0.5]) - 5.2).abs() < 0.1);
    }

    #[test]
    fn edges_far_walls_and_slanting_ones_measure_nothing() {
        for ranges in [[0.5, 0.5, 0.7], [0.7, 0.5, 0.7], [1.7, 1.6, 1.7]] {
            assert_eq!(measured(10.0, 4, ranges), 0.0, "{ranges:?}");
        }
        assert_eq!(measured(43.0, 4, [0.5, 0.5, 0.5]), 0.0, "along which axis it runs is not known");
    }
}
