//! Positions and directions of the sonars on the two known ATRV-minis, and assignment of these sonars to the paper's
//! sixteen directions.

use mdle_runtime::{Mount, Radians, SONARS, SonarId};

/// Maximum number of sonars that an ATRV-mini has.
pub(crate) const MOST: usize = 24;
/// Radius, in metres, of the ring on which laws assume the sonars to be.
pub(crate) const RING_RADIUS: f64 = 0.28;

/// A sonar on the robot's body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transducer {
    /// Id of the sonar: its board times 16, plus its channel.
    pub(crate) id: u8,
    /// Distance of the sonar ahead of the body's centre, in metres.
    x: f64,
    /// Distance of the sonar to the left of the body's centre, in metres.
    y: f64,
    /// Direction of the sonar's axis, in degrees counter-clockwise from the front.
    degrees: f64,
    /// Directions for which the sonar is used: bit `i` for direction `i`.
    pub(crate) directions: u16,
}

/// Sonars of the front left board of a robot with 24 sonars: x and y in millimetres, axis in degrees, and the direction
/// for which the sonar is used.
const QUARTER: [(f64, f64, f64, usize); 6] = [
    (258.17, 114.70, 0.0, 0),
    (252.24, 152.17, 18.0, 1),
    (235.01, 185.98, 36.0, 2),
    (208.19, 212.81, 54.0, 2),
    (174.38, 230.03, 72.0, 3),
    (136.91, 235.97, 90.0, 4),
];

/// Sonars of the left board of a robot with 16 sonars: x and y in millimetres, axis in degrees, and the directions for
/// which the sonar is used. Between 90° and 180° there is only one sonar.
const HALF: [(f64, f64, f64, &[usize]); 8] = [
    (258.17, 114.70, 0.0, &[0]),
    (252.24, 152.17, 18.0, &[1]),
    (235.01, 185.98, 36.0, &[2]),
    (208.19, 212.81, 54.0, &[2]),
    (174.38, 230.03, 72.0, &[]),
    (136.91, 235.97, 90.0, &[3, 4]),
    (-258.17, 235.97, 180.0, &[7, 8]),
    (-225.43, 230.03, 90.0, &[4, 5, 6]),
];

/// Returns all sonars of a robot that has `sonars` sonars.
pub(crate) fn transducers(sonars: u8) -> [Option<Transducer>; MOST] {
    let mut all = [None; MOST];
    let known = if sonars == 16 { two_boards } else { four_boards };
    for (place, number) in all.iter_mut().zip(0..) {
        *place = known(number);
    }
    all
}

/// Returns the sonar with this index, for a robot with four boards of six sonars: front left, rear left, rear right,
/// front right.
fn four_boards(number: usize) -> Option<Transducer> {
    let (x, y, degrees, direction) = *QUARTER.get(number % 6)?;
    let board = number / 6;
    let (x, y, degrees, direction) = match board {
        0 => (x, y, degrees, direction),
        1 => (-x, y, 180.0 - degrees, 8 - direction),
        2 => (-x, -y, degrees - 180.0, 8 + direction),
        _ => (x, -y, -degrees, (SONARS - direction) % SONARS),
    };
    Some(at(board * 16 + number % 6, (x, y, degrees), &[direction]))
}

/// Returns the sonar with this index, for a robot with two boards of eight sonars. The right board mirrors the left
/// one.
fn two_boards(number: usize) -> Option<Transducer> {
    let (board, channel) = (number / 8, number % 8);
    // On the right board, the last two channels are swapped.
    let twin = if board == 1 { *[0, 1, 2, 3, 4, 5, 7, 6].get(channel)? } else { channel };
    let (x, y, degrees, directions) = *HALF.get(twin)?;
    let left = at(board * 16 + channel, (x, y, degrees), directions);
    match board {
        0 => Some(left),
        1 => Some(Transducer {
            y: -left.y,
            degrees: -left.degrees,
            // Mirrors the directions: bit i becomes bit 16 - i.
            directions: left.directions.reverse_bits().rotate_left(1),
            ..left
        }),
        _ => None,
    }
}

fn at(id: usize, (x, y, degrees): (f64, f64, f64), directions: &[usize]) -> Transducer {
    let directions = directions.iter().fold(0, |bits, direction| bits | 1 << direction);
    Transducer { id: id as u8, x: x / 1000.0, y: y / 1000.0, degrees, directions }
}

impl Transducer {
    /// Converts a range of this sonar to a range from the ring, in metres. The result is measured along the sonar's
    /// axis, from the point of the axis that is nearest to the body's centre, and then reduced by the ring's radius.
    pub(crate) fn on_the_ring(&self, range: f64) -> f64 {
        let (sin, cos) = libm::sincos(self.degrees.to_radians());
        (self.x * cos + self.y * sin + range - RING_RADIUS).max(0.0)
    }

    /// Returns the mount of this sonar when it is used for `direction`.
    pub(crate) fn mount(&self, direction: usize) -> Mount {
        Mount::of(self.x, self.y, Radians::from_degrees(self.degrees), SonarId::new(direction as u8))
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Meters, Nanos, Ping, Pose};

    use super::*;

    /// Returns the ids of the sonars that are used for each direction.
    fn speakers(sonars: u8) -> Vec<Vec<u8>> {
        let all = transducers(sonars);
        let of = |direction: usize| all.iter().flatten().filter(move |sonar| sonar.directions & (1 << direction) != 0);
        (0..SONARS).map(|direction| of(direction).map(|sonar| sonar.id).collect()).collect()
    }

    #[test]
    fn each_direction_has_its_sonars_on_both_robots() {
        let four: [&[u8]; 16] = [
            &[0, 48],
            &[1],
            &[2, 3],
            &[4],
            &[5, 21],
            &[20],
            &[18, 19],
            &[17],
            &[16, 32],
            &[33],
            &[34, 35],
            &[36],
            &[37, 53],
            &[52],
            &[50, 51],
            &[49],
        ];
        assert_eq!(speakers(24), four);
        let two: [&[u8]; 16] = [
            &[0, 16],
            &[1],
            &[2, 3],
            &[5],
            &[5, 7],
            &[7],
            &[7],
            &[6],
            &[6, 23],
            &[23],
            &[22],
            &[22],
            &[21, 22],
            &[21],
            &[18, 19],
            &[17],
        ];
        assert_eq!(speakers(16), two);
    }

    #[test]
    fn both_robots_are_as_their_owners_say() {
        // Some rows of the published lists of both robots.
        let found = |sonars: u8, id: u8| {
            let sonar = transducers(sonars).into_iter().flatten().find(|sonar| sonar.id == id).expect("such a sonar");
            [sonar.x * 1000.0, sonar.y * 1000.0, sonar.degrees].map(|number| libm::round(number * 100.0) / 100.0)
        };
        assert_eq!(found(24, 3), [208.19, 212.81, 54.0]);
        assert_eq!(found(24, 16), [-258.17, 114.70, 180.0]);
        assert_eq!(found(24, 20), [-174.38, 230.03, 108.0]);
        assert_eq!(found(24, 34), [-235.01, -185.98, -144.0]);
        assert_eq!(found(24, 53), [136.91, -235.97, -90.0]);
        assert_eq!(found(16, 7), [-225.43, 230.03, 90.0]);
        assert_eq!(found(16, 20), [174.38, -230.03, -72.0]);
        assert_eq!(found(16, 22), [-225.43, -230.03, -90.0]);
        assert_eq!(found(16, 23), [-258.17, -235.97, -180.0]);
        assert_eq!([24, 16].map(|sonars| transducers(sonars).iter().flatten().count()), [24, 16]);
    }

    #[test]
    fn a_wall_that_is_parallel_is_as_far_before_the_middle_as_behind() {
        for (sonars, (before, behind)) in [(24, (4, 20)), (24, (52, 36)), (16, (5, 7)), (16, (21, 22))] {
            let range = |id: u8| {
                let sonar = transducers(sonars).into_iter().flatten().find(|sonar| sonar.id == id).expect("a sonar");
                // Range along the sonar's axis to a wall 1 m beside the centre.
                let sin = libm::sin(sonar.degrees.to_radians());
                sonar.on_the_ring((sin.signum() - sonar.y) / sin)
            };
            assert!((range(before) - range(behind)).abs() < 1e-9, "{sonars} {before} {behind}");
        }
    }
    #[test]
    fn a_range_from_the_ring_is_one_along_the_axis_of_the_sonar() {
        let robot = Pose { x: Meters(2.0), y: Meters(-1.0), theta: Radians(0.7) };
        for sonar in transducers(24).into_iter().flatten() {
            let direction = (0..SONARS).find(|direction| sonar.directions & (1 << direction) != 0).expect("one");
            let range = Some(Meters(sonar.on_the_ring(1.0)));
            let ping = Ping { range, at: Nanos::ZERO, pose: robot, mount: sonar.mount(direction) };
            let axis = ping.axis(SonarId::new(direction as u8));
            let heard = axis.towards(axis.theta, Meters(RING_RADIUS + sonar.on_the_ring(1.0)));
            let bearing = sonar.degrees.to_radians();
            let (x, y) = (sonar.x + libm::cos(bearing), sonar.y + libm::sin(bearing));
            let place = robot.towards(Radians(0.7 + libm::atan2(y, x)), Meters(libm::hypot(x, y)));
            assert!(heard.distance(&place).0 < 1e-6, "{sonar:?}: {heard:?}");
        }
    }
}
