//! Determines from a message which bumper switches are active.

use crate::config::Config;
use crate::messages::HazardDetectionVector;
use crate::scan::Scanner;

/// Value of the field `type` of a hazard that is a contact.
const BUMP: u8 = 1;

/// Frames of the zones of a Create 3's bumper, from left to right and in the order of the switches.
const ZONES: [&str; 5] = ["bump_left", "bump_front_left", "bump_front_center", "bump_front_right", "bump_right"];

/// Returns the switches that `hazards` activates: one bit for each bumper zone of a Create 3, and one bit for any other
/// contact.
#[must_use]
pub fn of_hazards(hazards: &HazardDetectionVector) -> u32 {
    let bumps = hazards.detections.iter().filter(|hazard| hazard.kind == BUMP);
    bumps.fold(0, |switches, bump| {
        let zone = ZONES.iter().position(|zone| bump.header.frame_id.ends_with(zone)).unwrap_or(ZONES.len());
        switches | 1 << zone
    })
}

/// Returns the switches that the rays of `scan` activate. There is one bit for each quarter of the body (front, left,
/// back and right); it is set if an obstacle in this quarter is closer to the body than the margin.
#[must_use]
pub fn of_scan(config: &Config, scanner: &Scanner, scan: &crate::messages::LaserScan) -> u32 {
    let (margin, shape) = (config.bumper_margin, config.shape());
    let is_round = config.half_length == 0.0 && config.half_width == 0.0;
    let touches = |x: f64, y: f64| {
        if is_round {
            libm::hypot(x, y) < config.body_radius + margin
        } else {
            x.abs() < shape.half_length.0 + margin && y.abs() < shape.half_width.0 + margin
        }
    };
    scanner.obstacles(scan).filter(|(x, y)| touches(*x, *y)).fold(0, |switches, (x, y)| {
        let quarter = match (x >= y, x >= -y) {
            (true, true) => 0,
            (false, true) => 1,
            (false, false) => 2,
            (true, false) => 3,
        };
        switches | 1 << quarter
    })
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::*;
    use crate::config::Configured;
    use crate::messages::{HazardDetection, LaserScan};

    #[test]
    fn only_bumps_are_contacts() {
        let hazards = |detections: &[(u8, &str)]| {
            let mut hazards = HazardDetectionVector::default();
            for (kind, frame) in detections {
                let mut hazard = HazardDetection { kind: *kind, ..HazardDetection::default() };
                hazard.header.frame_id = (*frame).to_owned();
                hazards.detections.push(hazard);
            }
            of_hazards(&hazards)
        };
        assert_eq!(hazards(&[]), 0);
        assert_eq!(hazards(&[(2, "cliff_front_left"), (0, "base_link")]), 0);
        assert_eq!(hazards(&[(1, "bump_left"), (1, "robot/bump_right"), (1, "elsewhere")]), 0b11_0001);
    }

    #[test]
    fn rays_within_the_body_are_contacts() {
        let mut config = Configured::read(None).unwrap().config;
        let pressed = |config: &Config, ray: usize, range: f32| {
            let (angle_min, angle_increment, range_min, range_max) = (-PI, PI / 2.0, 0.01, 9.0);
            let mut scan = LaserScan { angle_min, angle_increment, range_min, range_max, ..LaserScan::default() };
            scan.ranges = vec![f32::INFINITY; 4];
            scan.ranges[ray] = range;
            of_scan(config, &Scanner::of(config), &scan)
        };
        assert_eq!([0, 1, 2, 3].map(|ray| pressed(&config, ray, 0.19)), [4, 8, 1, 2]);
        assert_eq!(pressed(&config, 2, 0.21), 0);
        (config.half_length, config.half_width) = (0.5, 0.3);
        assert_eq!([0, 1, 2, 3].map(|ray| pressed(&config, ray, 0.45)), [4, 0, 1, 0]);
    }
}
