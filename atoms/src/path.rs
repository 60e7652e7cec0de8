//! `path file`: replays the headings and forward speeds of a file (paper, section IV-A).
//!
//! Between two setpoints, heading and speed are interpolated linearly, the heading along the shorter turn. The replay
//! therefore depends neither on the period of the recording nor on the period of the replay. Without interpolation,
//! heading and speed would lag by half the time between two setpoints, and the heading would change in steps.

use mdle_runtime::capability::{DiffDrive, Odometry, Paths};
use mdle_runtime::{
    Begin, Completes, Control, Frame, Law, MetersPerSecond, Nanos, Radians, RadiansPerSecond, Setpoint, Twist,
};

use crate::heading::turning;

/// The control `path`: `u_f = v_s(t)`, `u_θ = dα_s/dt + k(α_s(t) − θ)`. Without the first term of `u_θ`, the heading
/// would lag by half a second in every bend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Path {
    file: &'static str,
}

impl Path {
    /// Creates the quark `path file`; the headings in the file are relative to the frame in which the atom begins.
    #[must_use]
    pub const fn new(file: &'static str) -> Self {
        Self { file }
    }
}

/// The law of [`Path`], which is done at the time of the last setpoint. If there is no path of this name, the robot
/// stands still and the law is never done, because the elements of the plan after it assume that the path has been
/// driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replaying {
    file: &'static str,
    frame: Frame,
    /// Time at which the path began.
    begun: Nanos,
    /// Time of the previous request for an input; `None` before the first.
    before: Option<Nanos>,
}

/// The heading, turn rate and speed that a path contains for a certain time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Asked {
    heading: Radians,
    /// Rate at which the heading changes.
    turn_rate: RadiansPerSecond,
    speed: MetersPerSecond,
}

impl Asked {
    /// Returns the interpolated setpoint of `path` at the time `at`, counted from the beginning of the path; `None`
    /// before its first setpoint and from its last one on.
    fn of(path: &[Setpoint], at: Nanos) -> Option<Self> {
        let next = path.partition_point(|setpoint| setpoint.at <= at);
        let (from, to) = (path.get(next.checked_sub(1)?)?, path.get(next)?);
        // Not zero: `from` is not later than `at`, and `to` is later.
        let seconds = to.at.since(from.at).seconds();
        let part = at.since(from.at).seconds() / seconds;
        let turn = Radians(to.heading.0 - from.heading.0).wrapped().0;
        Some(Self {
            heading: Radians(from.heading.0 + part * turn),
            turn_rate: RadiansPerSecond(turn / seconds),
            speed: MetersPerSecond(from.speed.0 + part * (to.speed.0 - from.speed.0)),
        })
    }
}

impl<Y: DiffDrive + Odometry + Paths> Control<Y> for Path {
    type Law = Replaying;

    fn begin(&self, _: &Y, begin: Begin) -> Replaying {
        Replaying { file: self.file, frame: begin.frame, begun: begin.now, before: None }
    }
}

impl<Y: DiffDrive + Odometry + Paths> Law<Y> for Replaying {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let before = self.before.replace(t);
        let path = y.path(self.file).unwrap_or_default();
        let Some(asked) = Asked::of(path, t.since(self.begun)) else { return Twist::default() };
        let left = Radians(self.frame.outward(asked.heading).0 - y.pose().theta.0).wrapped();
        let back = turning(left, y.steering().rotate, before, t);
        Twist { v: asked.speed, omega: RadiansPerSecond(asked.turn_rate.0 + back.omega.0) }
    }
}

impl<Y: DiffDrive + Odometry + Paths> Completes<Y> for Replaying {
    fn completed(&self, y: &Y, t: Nanos) -> bool {
        y.path(self.file).is_some_and(|path| path.last().is_none_or(|last| t.since(self.begun) >= last.at))
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{PathStore, StoredPath};

    use super::*;
    use crate::trial::{PERIOD, Sensed, framed};

    const fn setpoint(millis: u64, degrees: f64, speed: f64) -> Setpoint {
        Setpoint {
            at: Nanos(millis * 1_000_000),
            heading: Radians::from_degrees(degrees),
            speed: MetersPerSecond(speed),
        }
    }

    /// A path that consists of 1 s straight ahead, half a circle to the left through the heading 180° in 2 s, and 1 s
    /// straight ahead.
    static BEND: [Setpoint; 4] =
        [setpoint(0, 90.0, 0.2), setpoint(1000, 90.0, 0.2), setpoint(3000, -100.0, 0.4), setpoint(4000, -100.0, 0.0)];
    static PATHS: [StoredPath; 1] = [StoredPath { name: "bend", setpoints: &BEND }];

    fn facing(degrees: f64) -> Sensed {
        Sensed { paths: PathStore::new(&PATHS), ..Sensed::heading(degrees) }
    }

    /// Runs an atom that replays the path `file` and begins at the time `from`. Returns the number of turns until its
    /// law is done, at most 1000.
    fn replayed(file: &'static str, y: &mut Sensed, mut begin: Begin, from: u64) -> u64 {
        let millis = |number: u64| Nanos((from + number * 100) * 1_000_000);
        begin.now = millis(0);
        let mut law = Path::new(file).begin(&*y, begin);
        for number in 0..1000 {
            if law.completed(&*y, millis(number)) {
                assert_eq!(law.input(&*y, millis(number)), Twist::default(), "beyond its end");
                return number;
            }
            let input = law.input(&*y, millis(number));
            y.drive(input);
            y.pose.theta = y.pose.theta.wrapped();
        }
        1000
    }

    #[test]
    fn what_is_asked_for_lies_between_the_setpoints_the_heading_the_short_way_round() {
        let at = |millis: u64| Asked::of(&BEND, Nanos(millis * 1_000_000));
        let near = |millis, degrees: f64, rate: f64, speed: f64| {
            let Some(Asked { heading, turn_rate, speed: asked }) = at(millis) else {
                panic!("{millis} is in the path")
            };
            let off = [heading.degrees() - degrees, turn_rate.0.to_degrees() - rate, asked.0 - speed];
            assert!(off.iter().all(|off| off.abs() < 1e-9), "{millis}: {off:?}");
        };
        near(0, 90.0, 0.0, 0.2);
        near(500, 90.0, 0.0, 0.2);
        near(1000, 90.0, 85.0, 0.2);
        near(2000, 175.0, 85.0, 0.3);
        near(2999, 259.915, 85.0, 0.3999);
        near(3500, -100.0, 0.0, 0.2);
        assert_eq!([4000, 4001].map(at), [None, None]);
        assert_eq!(Asked::of(&[], Nanos(0)), None);
        assert_eq!(Asked::of(&BEND[1..], Nanos(0)), None, "it has not begun");
    }

    #[test]
    fn ends_at_the_time_of_its_last_setpoint_whenever_the_atom_began() {
        for from in [0, 100, 12_345] {
            assert_eq!(replayed("bend", &mut facing(90.0), framed(0.0), from), 40, "{from}");
        }
    }

    #[test]
    fn an_ideal_robot_ends_where_the_setpoints_lead() {
        for frame in [0.0, 77.0, 180.0, -90.0] {
            let mut y = facing(90.0 + frame);
            replayed("bend", &mut y, framed(frame), 0);
            // Drives each turn straight, with the heading and the speed that the path has at the beginning of the turn.
            let (mut x, mut side) = (0.0, 0.0);
            for turn in 0..40 {
                let (heading, speed) = match turn {
                    0..10 => (90.0, 0.2),
                    10..30 => (90.0 + 8.5 * f64::from(turn - 10), 0.2 + 0.01 * f64::from(turn - 10)),
                    _ => (260.0, 0.4 - 0.04 * f64::from(turn - 30)),
                };
                let heading = (heading + frame).to_radians();
                x += speed * PERIOD * libm::cos(heading);
                side += speed * PERIOD * libm::sin(heading);
            }
            let away = libm::hypot(y.pose.x.0 - x, y.pose.y.0 - side);
            let turned = Radians(y.pose.theta.0 - (260.0 + frame).to_radians()).wrapped().degrees();
            assert!(away < 1e-9 && turned.abs() < 1e-9, "{frame}: {away} m, {turned}°");
        }
    }

    #[test]
    fn a_heading_that_is_off_is_turned_back_to_no_faster_than_rotate_does() {
        for off in [-170.0, -10.0, 10.0, 170.0] {
            let mut y = facing(90.0 + off);
            let mut law = Path::new("bend").begin(&y, framed(0.0));
            let Twist { v, omega } = law.input(&y, Nanos(0));
            assert_eq!(v.0, 0.2);
            assert!(omega.0 * off < 0.0 && omega.0.abs() <= 0.8, "{off}: {omega:?}");
            replayed("bend", &mut y, framed(0.0), 0);
            let left = Radians(y.pose.theta.0 + 100f64.to_radians()).wrapped().degrees();
            assert!(left.abs() < 10.0, "{off}: {left}");
        }
    }

    #[test]
    fn without_its_path_it_stands_and_is_never_done() {
        let mut y = facing(90.0);
        assert_eq!(replayed("hall", &mut y, framed(0.0), 0), 1000);
        assert_eq!(y.pose, facing(90.0).pose);
    }
}
