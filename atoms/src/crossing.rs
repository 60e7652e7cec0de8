//! Detects a person who is about to cross the robot's way, or to reach the robot from ahead and from the side: the
//! echoes of a sonar that does not face along the way come nearer faster than the robot drives.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, Ping, Pose, Radians, SonarId};

use crate::between::between;
use crate::directions::{AHEAD, CONE};
use crate::missed::{BeforeMissed, forward_sonars};

/// Minimum and maximum speed, in m/s, of a person who crosses the way. A slower object is treated as fixed, and faster
/// echoes belong to different objects.
const SPEEDS: [f64; 2] = [0.25, 2.0];
/// Maximum ratio of the two speeds of one person. If one is greater, the echoes belong to different objects.
const STEADY: f64 = 4.0;
/// Maximum turn rate of the robot, in rad/s, between compared echoes: as the robot turns, the echo of a wall
/// moves along the wall.
const TURNS: f64 = 0.02;
/// Maximum angle, in radians, by which the robot may turn between compared echoes, at any rate. A turn by this angle
/// hardly moves an echo, and skidding wheels turn the robot to and fro by this much.
const TURNED: f64 = 0.01;
/// Maximum turn rate of the robot, in rad/s, between echoes that are compared more strictly: a robot that gets back to
/// its way after a random range turns by some degrees between its pings.
const TURNS_MOST: f64 = 0.2;
/// Minimum speed, in m/s, of a person between such echoes, and maximum ratio of the two speeds.
const IN_TURNS: (f64, f64) = (0.35, 1.5);
/// Minimum decrease, in metres, of the distance of a crossing person from the first compared echo to the last. A
/// smaller decrease may be an error of the ranges.
const NEARER: f64 = 0.075;
/// The radius of a person, in metres.
const PERSON: f64 = 0.25;
/// Distance, in metres, that the robot leaves between a person and its body, because the direction of an echo within
/// the cone of its sonar is not known.
const CLEAR: f64 = 0.2;
/// Minimum distance, in metres, between a person and the robot's way: from a nearer person, the robot does not back
/// off. Echoes of the rough walls of a hallway, whose ranges may decrease by chance, are nearer.
const FAR: f64 = 1.2;
/// Maximum time, in seconds, before a person reaches the robot's way: if the person needs longer, the robot does not
/// back off.
const BACK: f64 = 5.0;
/// Minimum distance, in metres, between a crossing person and the way. A person nearer to the way is an obstacle, or
/// walks along the way.
const ASIDE: f64 = 0.45;
/// Maximum distance, in metres, between the wall ahead of the robot and the edge of a sonar's cone at which the echoes
/// of this sonar may come from the wall. The place on a rough wall from which they come moves along the wall faster
/// than the robot drives.
const OF_WALL: f64 = 0.5;
/// Maximum time, in seconds, before a person reaches the robot's way: if the person needs longer, the robot does not
/// react. A sonar that pings once a second takes two seconds until three pings agree, and the direction of its echoes
/// is uncertain by several degrees. A robot that stops later may already be where the person walks.
const SOON: f64 = 8.0;
/// Time, in seconds, before a person could reach the robot, from which the robot stops wherever the person's way
/// leads: it need not cross the robot's way at a right angle.
const STOPS: f64 = 3.5;

/// An echo: its time in seconds, and its distance along the way and to the left of it, in metres.
struct Echo {
    at: f64,
    along: f64,
    across: f64,
}

impl Echo {
    /// Returns the distance, in metres, from the centre of the robot.
    fn range(&self) -> f64 {
        libm::hypot(self.along, self.across)
    }

    /// Returns the distance along the way if the echo is turned by `angle` around the robot.
    fn along_turned(&self, angle: Radians) -> f64 {
        let (sin, cos) = libm::sincos(angle.0);
        self.along * cos - self.across * sin
    }
}

/// A person who is about to cross the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Time, in seconds, until the person has crossed the way.
    pub(crate) passed: f64,
    /// Distance, in metres, by which the robot has to back off so that the person passes ahead of it; 0 if the person
    /// passes ahead of it anyway.
    pub(crate) back: f64,
}

/// Motion of a robot whose way a person may cross.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Driving {
    /// Speed, in m/s, at which the robot drives on.
    pub(crate) speed: f64,
    /// `true` if the robot already waits for a person. A robot at rest may be met by a person who comes abreast.
    pub(crate) waits: bool,
}

/// Returns the person who comes from a side and may meet the robot; `None` if no such person comes. If there are
/// several such persons, the result has the longest of their times and the longest of their distances.
pub(crate) fn crosses<Y: DiffDrive + SonarRing>(
    y: &Y,
    before: &BeforeMissed,
    here: Pose,
    driving: Driving,
) -> Option<Crossing> {
    let ahead = libm::sincos(here.theta.0);
    let all = forward_sonars().filter_map(|sonar| comes(y, sonar, before.newest(y, sonar)?, (here, ahead), driving));
    all.reduce(|one, other| Crossing { passed: one.passed.max(other.passed), back: one.back.max(other.back) })
}

/// Returns the minimum speed, in m/s, of a person with these three echoes, newest first, and the maximum ratio of the
/// two speeds between them; `None` if the robot has turned too fast to compare the echoes.
fn limits([new, middle, old]: [(&Ping, Meters); 3]) -> Option<(f64, f64)> {
    let turned = |(from, _): (&Ping, Meters), (to, _): (&Ping, Meters)| {
        let Radians(turned) = Radians(to.pose.theta.0 - from.pose.theta.0).wrapped();
        (turned.abs(), to.at.seconds() - from.at.seconds())
    };
    let turns = [turned(old, middle), turned(middle, new)];
    if turns.iter().all(|(turned, seconds)| *turned <= (TURNS * seconds).max(TURNED)) {
        return Some((SPEEDS[0], STEADY));
    }
    turns.iter().all(|(turned, seconds)| *turned <= TURNS_MOST * seconds).then_some(IN_TURNS)
}

/// Returns the distance, in metres, from the robot's centre to the object ahead of it; `None` if the newest ping ahead
/// had no echo.
fn wall_ahead<Y: SonarRing>(y: &Y) -> Option<Meters> {
    let range = y.pings(AHEAD).newest_first().next()?.range?;
    Some(Meters(y.ring_radius().0 + range.0))
}

/// Returns the distance, in metres along the heading of `here`, of the place where an echo of `sonar` came from if it
/// came from the edge of the sonar's cone that is nearer to the front.
fn edge(sonar: SonarId, (ping, range): (&Ping, Meters), here: Pose, ring_radius: Meters) -> f64 {
    let axis = ping.axis(sonar);
    let towards_front = libm::copysign(CONE.0, -sonar.bearing().wrapped().0);
    let place = axis.towards(Radians(axis.theta.0 + towards_front), Meters(ring_radius.0 + range.0));
    let (sin, cos) = libm::sincos(here.theta.0);
    (place.x.0 - here.x.0) * cos + (place.y.0 - here.y.0) * sin
}

/// Returns `true` if this echo of `sonar` may come from the wall ahead of the robot.
fn may_be_wall_ahead<Y: SonarRing>(y: &Y, sonar: SonarId, echo: (&Ping, Meters), here: Pose) -> bool {
    wall_ahead(y).is_some_and(|wall| wall.0 < edge(sonar, echo, here, y.ring_radius()) + OF_WALL)
}

/// Returns the person whose three newest echoes, newest first, `sonar` has received; `None` if they are not from such a
/// person. The conditions are those of [`crosses`]. `sin` and `cos` are the sine and the cosine of the heading of
/// `here`.
fn comes<Y: DiffDrive + SonarRing>(
    y: &Y,
    sonar: SonarId,
    echoes: [(&Ping, Meters); 3],
    (here, (sin, cos)): (Pose, (f64, f64)),
    Driving { speed, waits }: Driving,
) -> Option<Crossing> {
    let (slowest, steady) = limits(echoes)?;
    let [new, middle, old] = echoes;
    let echo = |(ping, range): (&Ping, Meters)| {
        let axis = ping.axis(sonar);
        let place = axis.towards(axis.theta, Meters(y.ring_radius().0 + range.0));
        let (x, y) = (place.x.0 - here.x.0, place.y.0 - here.y.0);
        Echo { at: ping.at.seconds(), along: x * cos + y * sin, across: y * cos - x * sin }
    };
    let approach = |from: &Echo, to: &Echo| (from.range() - to.range()) / (to.at - from.at);
    let moves = |speed: f64| (SPEEDS[0]..=SPEEDS[1]).contains(&speed);
    // Most echoes come from an obstacle in the way or from a fixed object. Their older places are not computed.
    let new = echo(new);
    let apart = y.body_radius().0 + PERSON;
    let is_far = new.across.abs() > FAR;
    let is_ahead = match (is_far, waits) {
        (true, true) => new.along > -CLEAR,
        (true, false) => new.along > CLEAR / 2.0,
        (false, _) => new.along > PERSON,
    };
    if !(is_ahead && new.across.abs() > ASIDE) {
        return None;
    }
    let middle = echo(middle);
    let second = approach(&middle, &new);
    if !moves(second) {
        return None;
    }
    let old = echo(old);
    let first = approach(&old, &middle);
    let mean = (first + second) / 2.0;
    let seconds = new.across.abs() / mean;
    let along = new.along_turned(between(y, sonar, echoes[0].0, echoes[0].1));
    let is_before = !waits && along + apart < speed * (seconds - apart / mean);
    let own = if waits { 0.0 } else { speed };
    let is_soon = new.range() - apart < STOPS * (mean + own * new.along / new.range());
    let meets = is_soon || along < apart + PERSON + speed * seconds && seconds < SOON && !is_before;
    let is_nearer = mean * (new.at - old.at) >= NEARER;
    let back = if is_far && seconds < BACK { (apart + CLEAR - along).max(0.0) } else { 0.0 };
    let crossing = Crossing { passed: seconds + apart / mean, back };
    let is_steady = first.min(second) >= slowest && first.max(second) <= steady * first.min(second);
    let comes = moves(first) && is_steady && is_nearer && meets;
    (comes && !may_be_wall_ahead(y, sonar, echoes[0], here)).then_some(crossing)
}

#[cfg(test)]
mod tests;
