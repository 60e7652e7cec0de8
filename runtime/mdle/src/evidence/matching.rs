//! Finds the pose of a robot in an evidence grid. At this pose, the echoes that the robot received while it turned on
//! the spot fit the grid best (docs/src/navigation.md).

use mdle_runtime::{Meters, Pose, Radians};

use super::grid::{EvidenceGrid, GridPing};

/// Fraction of a range at which the space should be free.
const BEFORE: f64 = 0.6;
/// Weight of the evidence at the position that should be free.
pub(super) const BEFORE_WEIGHT: f64 = 0.3;
/// Steps of the first search, in metres and radians.
const COARSE: (f64, f64) = (0.10, 3.0 * DEGREE);
/// Number of angles to either side in the first search.
const COARSE_ANGLES: i16 = 8;
/// Steps, in metres and radians, of the later searches, each around the best pose so far.
const FINE: [(f64, f64); 3] = [(0.05, 1.5 * DEGREE), (0.025, 0.75 * DEGREE), (0.0125, 0.5 * DEGREE)];
/// Tolerance, in metres or radians, for a pose at the edge of the search. It is needed because adding up the steps
/// causes rounding errors.
const ROUNDING: f64 = 1e-9;
/// A degree, in radians.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// A pose in a grid, and a score that tells how well the echoes fit the grid at this pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fit {
    /// Pose, in grid coordinates, at which the robot's odometry was zero.
    pub(crate) origin: Pose,
    /// Mean evidence per echo.
    pub(crate) score: f64,
    /// `true` if the pose is at the edge of the search, so that the best pose may be outside.
    pub(crate) is_at_edge: bool,
}

/// Two positions in the coordinates of a ping: the position of the echo, and a position between the transducer and the
/// echo that should be free.
pub(super) struct Echo {
    pub(super) at: (f64, f64),
    pub(super) before: (f64, f64),
}

impl Echo {
    pub(super) fn of(ping: &GridPing) -> Option<Self> {
        let range = ping.range?;
        let (ahead, left) = (range * libm::cos(ping.theta), range * libm::sin(ping.theta));
        let at = (ping.x + ahead, ping.y + left);
        Some(Self { at, before: (ping.x + BEFORE * ahead, ping.y + BEFORE * left) })
    }
}

/// Finds the pose at which the echoes of `pings` fit the grid best. The search covers distances up to `ways` times 10
/// cm from `near` along each axis, and headings up to 24° from the heading of `near`. The pings are in odometry
/// coordinates; the search rotates them about the origin. Returns `None` if no ping has an echo.
pub(crate) fn fit(grid: &EvidenceGrid, pings: &[GridPing], near: Pose, ways: i16) -> Option<Fit> {
    let echoes: Vec<Echo> = pings.iter().filter_map(Echo::of).collect();
    if echoes.is_empty() {
        return None;
    }
    let scored = |origin: Pose| Fit { origin, score: score(grid, &echoes, &origin), is_at_edge: false };
    let mut best = better(scored(near), near, COARSE, (ways, COARSE_ANGLES), &scored);
    for steps in FINE {
        best = better(best, best.origin, steps, (1, 1), &scored);
    }
    let reaches = [f64::from(ways) * COARSE.0, f64::from(ways) * COARSE.0, f64::from(COARSE_ANGLES) * COARSE.1];
    let Pose { x, y, theta } = best.origin;
    let off = [x.0 - near.x.0, y.0 - near.y.0, theta.0 - near.theta.0];
    let is_at_edge = off.iter().zip(reaches).any(|(off, reach)| off.abs() > reach - ROUNDING);
    Some(Fit { is_at_edge, ..best })
}

/// Returns the best fit on a lattice of poses around `around`; `best` if no fit is better.
fn better(
    mut best: Fit,
    around: Pose,
    (way, angle): (f64, f64),
    (ways, angles): (i16, i16),
    scored: &dyn Fn(Pose) -> Fit,
) -> Fit {
    for turned in -angles..=angles {
        for column in -ways..=ways {
            for row in -ways..=ways {
                let here = scored(Pose {
                    x: Meters(around.x.0 + f64::from(column) * way),
                    y: Meters(around.y.0 + f64::from(row) * way),
                    theta: Radians(around.theta.0 + f64::from(turned) * angle),
                });
                if here.score > best.score {
                    best = here;
                }
            }
        }
    }
    best
}

/// Returns the mean evidence for the echoes, assuming that the robot's odometry was zero at `origin`.
fn score(grid: &EvidenceGrid, echoes: &[Echo], origin: &Pose) -> f64 {
    let (sin, cos) = libm::sincos(origin.theta.0);
    let odds = |(x, y): (f64, f64)| grid.odds_at(origin.x.0 + x * cos - y * sin, origin.y.0 + x * sin + y * cos);
    let evidence = echoes.iter().map(|echo| odds(echo.at) - BEFORE_WEIGHT * odds(echo.before));
    evidence.sum::<f64>() / echoes.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the pings of a robot that turns on the spot at a pose in a room of 3 m by 2 m around the origin;
    /// its odometry begins there.
    fn turn(at: Pose) -> Vec<GridPing> {
        let theta = |number: i32| f64::from(number) * 5.0 * DEGREE;
        let pings = (0..72).map(|number| {
            let (sin, cos) = libm::sincos(at.theta.0 + theta(number));
            let along =
                |way: f64, half: f64, from: f64| if way == 0.0 { 1e9 } else { (half.copysign(way) - from) / way };
            let range = along(cos, 1.5, at.x.0).min(along(sin, 1.0, at.y.0));
            GridPing { x: 0.0, y: 0.0, theta: theta(number), range: Some(range) }
        });
        pings.collect()
    }

    fn pose(x: f64, y: f64, degrees: f64) -> Pose {
        Pose { x: Meters(x), y: Meters(y), theta: Radians(degrees * DEGREE) }
    }

    #[test]
    fn a_turn_is_found_where_it_was_made() {
        let mut grid = EvidenceGrid::new();
        turn(Pose::ORIGIN).iter().for_each(|ping| grid.take(ping));
        for (x, y, degrees) in [(0.0, 0.0, 0.0), (0.2, -0.15, 10.0), (-0.3, 0.1, -14.0)] {
            let there = pose(x, y, degrees);
            let Fit { origin, .. } = fit(&grid, &turn(there), Pose::ORIGIN, 4).unwrap();
            let off = libm::hypot(origin.x.0 - x, origin.y.0 - y);
            let turned = (origin.theta.0 - there.theta.0).abs() / DEGREE;
            assert!(off < 0.05 && turned < 2.0, "({x}, {y}, {degrees}): {off} m and {turned} degrees off");
        }
    }

    #[test]
    fn a_pose_outside_the_search_is_at_its_edge() {
        let mut grid = EvidenceGrid::new();
        turn(Pose::ORIGIN).iter().for_each(|ping| grid.take(ping));
        let is_at_edge = |x, y, degrees| fit(&grid, &turn(pose(x, y, degrees)), Pose::ORIGIN, 4).unwrap().is_at_edge;
        assert!(!is_at_edge(0.3, -0.3, 20.0));
        for (x, y, degrees) in [(0.5, 0.0, 0.0), (0.0, -0.5, 0.0), (0.0, 0.0, 30.0), (0.0, 0.0, -30.0)] {
            assert!(is_at_edge(x, y, degrees), "({x}, {y}, {degrees})");
        }
    }

    #[test]
    fn silence_is_nowhere() {
        let silent = GridPing { x: 0.0, y: 0.0, theta: 0.0, range: None };
        assert_eq!(fit(&EvidenceGrid::new(), &[silent], Pose::ORIGIN, 4), None);
    }
}
