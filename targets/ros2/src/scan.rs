//! Converts a laser scan to ranges in the sixteen directions of a robot.

use mdle_runtime::{Meters, Mount, Pose, Radians, SONARS, SonarId};

use crate::config::Config;
use crate::messages::LaserScan;

/// Indices of the virtual sonars that point ahead.
const AHEAD: [usize; 3] = [SONARS - 1, 0, 1];
/// Value that marks a direction ahead for which a ray has been found.
const SEEN: usize = SONARS;

/// Result of a scan in one of the sixteen directions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Direction {
    /// No ray in this direction was valid.
    #[default]
    Unknown,
    /// All valid rays in this direction met no obstacle.
    Free,
    /// At least one ray in this direction met an obstacle; only the nearest obstacle is used.
    Echo {
        /// Distance of the obstacle from the ring of virtual sonars, in metres.
        range: Meters,
        /// Mount of a virtual sonar that points at the obstacle.
        mount: Mount,
    },
}

/// Mounting and settings of a laser scanner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scanner {
    /// Pose of the scanner on the body.
    mount: Pose,
    ring_radius: f64,
    zero_is_free: bool,
}

impl Scanner {
    /// Creates the scanner that `config` describes.
    #[must_use]
    pub fn of(config: &Config) -> Self {
        let (x, y, theta) = (Meters(config.scan_x), Meters(config.scan_y), Radians(config.scan_yaw));
        let (ring_radius, zero_is_free) = (config.ring_radius, config.scan_zero_is_free);
        Self { mount: Pose { x, y, theta }, ring_radius, zero_is_free }
    }

    /// Returns the result of `scan` in each of the sixteen directions.
    #[must_use]
    pub fn directions(&self, scan: &LaserScan) -> [Direction; SONARS] {
        let mut directions = [Direction::Unknown; SONARS];
        for (angle, range) in self.rays(scan) {
            let Some(range) = range else {
                let direction = &mut directions[sonar_at(angle).number()];
                if *direction == Direction::Unknown {
                    *direction = Direction::Free;
                }
                continue;
            };
            let (x, y) = self.place(angle, range);
            let bearing = Radians(libm::atan2(y, x));
            let sonar = sonar_at(bearing);
            let range = Meters((libm::hypot(x, y) - self.ring_radius).max(0.0));
            let direction = &mut directions[sonar.number()];
            let is_nearer = match direction {
                Direction::Echo { range: nearest, .. } => range < *nearest,
                Direction::Unknown | Direction::Free => true,
            };
            if is_nearer {
                *direction = Direction::Echo { range, mount: Mount::of(0.0, 0.0, bearing, sonar) };
            }
        }
        directions
    }

    /// Returns `true` if a ray in one of the three directions ahead is valid.
    #[must_use]
    pub fn sees_ahead(directions: &[Direction; SONARS]) -> bool {
        AHEAD.iter().any(|sonar| directions.get(*sonar).is_some_and(|direction| *direction != Direction::Unknown))
    }

    /// Returns the positions of obstacles in the body's frame, as distances ahead and to the left of the centre, in
    /// metres.
    pub fn obstacles<'s>(&'s self, scan: &'s LaserScan) -> impl Iterator<Item = (f64, f64)> + 's {
        self.rays(scan).filter_map(|(angle, range)| Some(self.place(angle, range?)))
    }

    /// Checks that `scan` has rays, whether valid or not, in the three directions ahead.
    ///
    /// # Errors
    /// Returns the reason, as the end of a sentence about the scan, if a direction has no ray.
    pub fn looks_ahead(&self, scan: &LaserScan) -> Result<(), String> {
        let mut missing = AHEAD;
        for number in 0..scan.ranges.len() {
            let angle = self.angle(scan, number);
            if angle.0.is_finite() {
                let sonar = sonar_at(angle).number();
                missing.iter_mut().filter(|direction| **direction == sonar).for_each(|direction| *direction = SEEN);
                if missing == [SEEN; 3] {
                    return Ok(());
                }
            }
        }
        let (apart, wide) = (f64::from(scan.angle_increment).to_degrees().abs(), 360.0 / SONARS as f64);
        Err(if scan.ranges.is_empty() {
            "it has no rays".to_owned()
        } else if !(scan.angle_min.is_finite() && scan.angle_increment.is_finite()) {
            "the angles of its rays are no numbers".to_owned()
        } else if apart == 0.0 {
            "its `angle_increment` is 0, so that all its rays have the same angle".to_owned()
        } else if apart > wide {
            format!("its rays are {apart:.1}° apart, and each of the three directions ahead is {wide}° wide")
        } else {
            let ends = [0, scan.ranges.len() - 1].map(|number| self.angle(scan, number).0.to_degrees());
            let [from, to] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            format!(
                "its rays reach from {from:.0}° to {to:.0}° on the body, and the three directions ahead from -34° to \
                 34°; see `scan-yaw`"
            )
        })
    }

    /// Returns the angle, in the body's frame, of the ray with this index.
    fn angle(&self, scan: &LaserScan, number: usize) -> Radians {
        Radians(self.mount.theta.0 + f64::from(scan.angle_min) + f64::from(scan.angle_increment) * number as f64)
    }

    /// Returns the position, in metres in the body's frame, of an obstacle at this angle and range.
    fn place(&self, angle: Radians, range: f64) -> (f64, f64) {
        let (sin, cos) = libm::sincos(angle.0);
        (self.mount.x.0 + range * cos, self.mount.y.0 + range * sin)
    }

    /// Returns the valid rays of `scan`. For each ray, returns the angle in the body's frame, and the range in metres;
    /// `None` if the ray met no obstacle.
    fn rays<'s>(&'s self, scan: &'s LaserScan) -> impl Iterator<Item = (Radians, Option<f64>)> + 's {
        let (least, most) = (f64::from(scan.range_min), f64::from(scan.range_max));
        scan.ranges.iter().enumerate().filter_map(move |(number, range)| {
            let angle = self.angle(scan, number);
            let range = f64::from(*range);
            let is_free = range == f64::INFINITY || (self.zero_is_free && range == 0.0);
            let is_valid = is_free || (range.is_finite() && range >= least && range <= most && range > 0.0);
            (is_valid && angle.0.is_finite()).then_some((angle, (!is_free).then_some(range)))
        })
    }
}

/// Returns the virtual sonar whose direction is nearest to `bearing`.
pub(crate) fn sonar_at(bearing: Radians) -> SonarId {
    let places = SONARS as f64 * bearing.0 / std::f64::consts::TAU;
    SonarId::new(libm::round(places).rem_euclid(SONARS as f64) as u8)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::config::Configured;

    /// Returns a scanner at the centre of the body, with a ring of virtual sonars without a radius; `change` adapts the
    /// configuration.
    fn scanner(change: impl Fn(&mut Config)) -> Scanner {
        let mut config = Configured::read(None).unwrap().config;
        config.ring_radius = 0.0;
        change(&mut config);
        Scanner::of(&config)
    }

    /// Returns a scan with these ranges at equal angles, counter-clockwise from the back.
    fn scan(ranges: Vec<f32>) -> LaserScan {
        let angle_increment = (2.0 * PI / ranges.len() as f64) as f32;
        let (angle_min, range_min, range_max) = (-PI as f32, 0.1, 10.0);
        LaserScan { angle_min, angle_increment, range_min, range_max, ranges, ..LaserScan::default() }
    }

    fn ranges(directions: [Direction; SONARS]) -> Vec<String> {
        let text = |direction: &Direction| match direction {
            Direction::Unknown => "?".to_owned(),
            Direction::Free => "free".to_owned(),
            Direction::Echo { range, .. } => format!("{:.2}", range.0),
        };
        directions.iter().map(text).collect()
    }

    #[test]
    fn a_scan_looks_ahead_with_rays_in_three_directions() {
        let looks =
            |yaw: f64, rays: usize| scanner(|config| config.scan_yaw = yaw).looks_ahead(&scan(vec![f32::NAN; rays]));
        assert!(looks(0.0, 16).is_ok() && looks(0.0, 360).is_ok() && looks(PI, 360).is_ok());
        assert!(looks(0.0, 1).is_err() && looks(PI, 1).is_err());
        assert_eq!(looks(0.0, 0), Err("it has no rays".to_owned()));
        let coarse = "its rays are 45.0° apart, and each of the three directions ahead is 22.5° wide";
        assert_eq!(looks(0.0, 8), Err(coarse.to_owned()));
        // A half circle that covers only the area behind the robot.
        let behind = "its rays reach from -270° to -91° on the body, and the three directions ahead from -34° to 34°; \
                      see `scan-yaw`";
        let half = LaserScan { angle_increment: (PI / 360.0) as f32, ..scan(vec![1.0; 360]) };
        let turned = |yaw: f64| scanner(|config| config.scan_yaw = yaw).looks_ahead(&half);
        assert_eq!(turned(PI / 2.0), Ok(()));
        assert_eq!(turned(-PI / 2.0), Err(behind.to_owned()));
        let increment = |angle_increment: f32| {
            scanner(|_| {}).looks_ahead(&LaserScan { angle_increment, ..half.clone() }).unwrap_err()
        };
        assert_eq!(increment(0.0), "its `angle_increment` is 0, so that all its rays have the same angle");
        assert_eq!(increment(f32::NAN), "the angles of its rays are no numbers");
    }

    #[test]
    fn each_direction_has_its_nearest_valid_ray() {
        let mut rays = vec![f32::INFINITY; 360];
        // Two rays of direction 4 (left), and one just outside it; angles count from the back.
        (rays[180 + 90], rays[180 + 95], rays[180 + 78]) = (3.0, 2.0, 1.0);
        // Direction 8 (back) includes both ends of the list.
        (rays[0], rays[359]) = (5.0, 4.0);
        // Direction 12 has only invalid rays.
        for ray in &mut rays[180 - 101..180 - 78] {
            *ray = f32::NAN;
        }
        let found = ranges(scanner(|_| {}).directions(&scan(rays)));
        let expected = ["free", "free", "free", "1.00", "2.00", "free", "free", "free", "4.00"];
        assert_eq!(found[..9], expected);
        assert_eq!(found[12], "?");
    }

    #[test]
    fn invalid_rays_count_for_nothing() {
        for invalid in [f32::NAN, f32::NEG_INFINITY, -1.0, 0.0, 0.05, 10.5] {
            let directions = scanner(|_| {}).directions(&scan(vec![invalid; 360]));
            assert_eq!(directions, [Direction::Unknown; SONARS], "{invalid}");
        }
        let zeros = scanner(|config| config.scan_zero_is_free = true).directions(&scan(vec![0.0; 360]));
        assert_eq!(zeros, [Direction::Free; SONARS]);
    }

    #[test]
    fn any_number_of_rays_is_taken() {
        assert_eq!(scanner(|_| {}).directions(&scan(Vec::new())), [Direction::Unknown; SONARS]);
        let one = ranges(scanner(|_| {}).directions(&scan(vec![2.0])));
        assert_eq!((one[8].as_str(), one.iter().filter(|range| *range == "?").count()), ("2.00", 15));
        let many = ranges(scanner(|_| {}).directions(&scan(vec![2.0; 40_000])));
        assert!(many.iter().all(|range| range == "2.00"));
    }

    #[test]
    fn a_scanner_may_be_turned_and_off_the_centre() {
        let mut rays = vec![f32::INFINITY; 360];
        rays[180] = 2.0;
        let turned = ranges(scanner(|config| config.scan_yaw = PI).directions(&scan(rays.clone())));
        assert_eq!((turned[8].as_str(), turned[0].as_str()), ("2.00", "free"));
        let ahead = ranges(scanner(|config| config.scan_x = 0.5).directions(&scan(rays.clone())));
        assert_eq!(ahead[0], "2.50");
        let ring = ranges(scanner(|config| config.ring_radius = 0.2).directions(&scan(rays.clone())));
        assert_eq!(ring[0], "1.80");
        // If the scanner is mounted upside down, angles count clockwise.
        let mut left = scan(vec![f32::INFINITY; 360]);
        (left.angle_min, left.angle_increment) = (-left.angle_min, -left.angle_increment);
        left.ranges[90] = 2.0;
        assert_eq!(ranges(scanner(|_| {}).directions(&left))[4], "2.00");
    }

    #[test]
    fn angles_that_are_no_numbers_have_no_rays() {
        let mut strange = scan(vec![2.0; 100]);
        strange.angle_increment = f32::NAN;
        assert_eq!(scanner(|_| {}).directions(&strange), [Direction::Unknown; SONARS]);
        strange.angle_increment = f32::MAX;
        let _ = scanner(|_| {}).directions(&strange);
    }
}
