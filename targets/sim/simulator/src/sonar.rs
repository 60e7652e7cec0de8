//! Simulates the sonars: the order in which they ping, and the ranges that they measure, including errors of
//! measurement.

mod echo;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use mdle_runtime::{Meters, Mount, Nanos, Ping, Pings, Pose, Radians, SONARS};

use crate::model::{FiringOrder, Hearing, Transducer};
use crate::noise::{Noise, Purpose};
use crate::point::Point;
use crate::walls::Walls;

/// The sonars and their last pings.
#[derive(Debug, Clone)]
pub(crate) struct Ring {
    pub(crate) pings: [Pings; SONARS],
    /// Model of the sonars, which all robots with the same body share.
    pub(crate) hearing: Arc<Hearing>,
    /// Latest ping of each transducer. The range is measured from the transducer itself.
    pub(crate) heard: Vec<Heard>,
    errors: Option<SonarErrors>,
    /// Next group to ping, and the time of its ping; not used if all sonars ping in every turn.
    next: (usize, Nanos),
}

/// Last ping of a transducer; several transducers may belong to one sonar.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Heard {
    /// Range from the transducer; `None` if no echo returned.
    pub range: Option<Meters>,
    /// Time of the ping.
    pub at: Nanos,
}

/// Random errors of the ranges of a run.
#[derive(Debug, Clone)]
struct SonarErrors {
    ranges: Noise,
    outliers: Noise,
    fading: Noise,
    /// Factor by which all ranges of the run are multiplied.
    scale: f64,
}

impl Ring {
    /// Returns sonars with the errors of `seed`, or without errors.
    pub(crate) fn new(hearing: impl Into<Arc<Hearing>>, seed: Option<u64>) -> Self {
        let hearing = hearing.into();
        let errors = seed.map(|seed| {
            let mut outliers = Noise::of(seed, Purpose::Outliers);
            let scale = 1.0 + hearing.scale * (2.0 * outliers.uniform() - 1.0);
            SonarErrors {
                ranges: Noise::of(seed, Purpose::Ranges),
                outliers,
                fading: Noise::of(seed, Purpose::Fading),
                scale,
            }
        });
        let count = hearing.transducers.len();
        let heard = vec![Heard::default(); count];
        Self { pings: [Pings::default(); SONARS], hearing, heard, errors, next: (0, Nanos::ZERO) }
    }

    /// Returns the time of the next ping; `None` if all sonars ping in every turn.
    pub(crate) fn due(&self) -> Option<Nanos> {
        self.hearing.order.as_ref().map(|_| self.next.1)
    }

    /// Returns the numbers of the sonars in the order in which they ping; `None` if all sonars ping in every turn.
    pub(crate) fn order(&self) -> Option<Vec<u8>> {
        let groups = &self.hearing.order.as_ref()?.groups;
        let sonar = |group: &Vec<usize>| match group.as_slice() {
            [only] => u8::try_from(self.hearing.transducers.get(*only)?.sonar.number()).ok(),
            [..] => None,
        };
        groups.iter().map(sonar).collect()
    }

    /// Sets the sonars that ping from now on, one after another. Has no effect if all sonars ping in every turn.
    pub(crate) fn reorder(&mut self, sonars: &[u8]) {
        let transducers = &self.hearing.transducers;
        let of = |sonar: &u8| transducers.iter().position(|known| known.sonar.number() == usize::from(*sonar));
        let groups: Vec<Vec<usize>> = sonars.iter().filter_map(of).map(|number| vec![number]).collect();
        if let Some(order) = Arc::make_mut(&mut self.hearing).order.as_mut().filter(|_| !groups.is_empty()) {
            order.groups = groups;
            self.next.0 = 0;
        }
    }

    /// Makes the sonars ping that are due at the time `at`. The robot is at `pose`, and its odometry reports
    /// `odometry`.
    pub(crate) fn ping(&mut self, pose: &Pose, odometry: Pose, at: Nanos, walls: &Walls) {
        let Some(FiringOrder { groups, gap }) = &self.hearing.order else {
            for number in 0..self.heard.len() {
                self.listen(number, pose, at, walls);
            }
            for (sonar, pings) in (0..).zip(&mut self.pings) {
                pings.push(nearest(&self.hearing, &self.heard, sonar, at, odometry));
            }
            return;
        };
        let (group, when) = self.next;
        self.next = ((group + 1) % groups.len(), Nanos(when.0.saturating_add(gap.0)));
        let count = groups.get(group).map_or(0, Vec::len);
        for place in 0..count {
            let Some(number) = self.grouped(group, place) else { continue };
            self.listen(number, pose, at, walls);
            // A sonar with several transducers has pinged when the last of them has pinged.
            if let Some(sonar) = self.completed(group, number) {
                self.pings[sonar].push(nearest(&self.hearing, &self.heard, sonar, at, odometry));
            }
        }
    }

    /// Returns the number of the transducer at index `place` of a group; `None` if there is no such transducer.
    fn grouped(&self, group: usize, place: usize) -> Option<usize> {
        self.hearing.order.as_ref()?.groups.get(group)?.get(place).copied()
    }

    /// Makes the sonars ping until each sonar has made as many pings as an output stores, as if the robot had been
    /// switched on some time before the plan began.
    pub(crate) fn warm_up(&mut self, pose: &Pose, odometry: Pose, walls: &Walls) {
        let Some(order) = &self.hearing.order else { return };
        for _ in 0..order.groups.len() * mdle_runtime::PINGS_KEPT {
            self.ping(pose, odometry, Nanos::ZERO, walls);
        }
        self.next.1 = self.hearing.order.as_ref().map_or(Nanos::ZERO, |order| order.gap);
    }

    /// Returns the sonar to which this transducer belongs; `None` if another transducer of the same sonar pings later
    /// in the firing order, or if there is no firing order.
    fn completed(&self, group: usize, number: usize) -> Option<usize> {
        let speaks_for =
            |number: usize| self.hearing.transducers.get(number).map(|transducer| transducer.sonar.number());
        let sonar = speaks_for(number)?;
        let order = self.hearing.order.as_ref()?;
        let here = order.groups.get(group)?.iter().skip_while(|other| **other != number).skip(1);
        let later = order.groups.iter().skip(group + 1).flatten();
        here.chain(later).all(|other| speaks_for(*other) != Some(sonar)).then_some(sonar)
    }

    /// Makes one transducer ping.
    fn listen(&mut self, number: usize, pose: &Pose, at: Nanos, walls: &Walls) {
        let Self { hearing, errors, heard: all, .. } = self;
        let (Some(transducer), Some(last)) = (hearing.transducers.get(number), all.get_mut(number)) else { return };
        let fade = match errors {
            Some(errors) if hearing.fading > 0.0 => hearing.fading * errors.fading.normal(),
            Some(_) | None => 0.0,
        };
        let (from, axis) = placed(transducer, pose, hearing.ring_radius);
        let exact = echo::echo(walls, from, axis, hearing, fade);
        let heard = errors.as_mut().map_or(exact, |errors| errors.of(exact, hearing));
        let heard = heard.map(|range| stepped(range.max(hearing.least), hearing.step));
        let heard = heard.filter(|range| *range < hearing.most);
        *last = Heard { range: heard.map(Meters), at };
    }
}

impl SonarErrors {
    /// Returns the measured range for the exact range `exact`; `None` if there is no echo. Every ping uses the same
    /// number of random numbers, whatever its result is.
    fn of(&mut self, exact: Option<f64>, hearing: &Hearing) -> Option<f64> {
        let missed = self.ranges.uniform() < hearing.misses;
        let error = hearing.spread * self.ranges.normal();
        let (strays, anywhere) = (self.outliers.uniform() < hearing.outliers, self.outliers.uniform());
        if strays {
            return Some(hearing.least + anywhere * (hearing.most - hearing.least));
        }
        exact.filter(|_| !missed).map(|range| (range * self.scale + error).max(0.0))
    }
}

/// Returns the position and the direction of a transducer.
fn placed(transducer: &Transducer, pose: &Pose, ring_radius: f64) -> (Point, Radians) {
    let axis = Radians(pose.theta.0 + transducer.bearing.0);
    if is_on_the_ring(transducer, ring_radius) {
        return (Point::of(&pose.towards(axis, Meters(ring_radius))), axis);
    }
    let (sin, cos) = libm::sincos(pose.theta.0);
    let Transducer { x, y, .. } = transducer;
    (Point { x: pose.x.0 + x * cos - y * sin, y: pose.y.0 + x * sin + y * cos }, axis)
}

fn is_on_the_ring(transducer: &Transducer, ring_radius: f64) -> bool {
    transducer.bearing == transducer.sonar.bearing()
        && (libm::hypot(transducer.x, transducer.y) - ring_radius).abs() < 1e-9
}

/// Converts a range from a transducer to a range from the ring of sonars. The result is measured along the transducer's
/// axis, from the point of the axis that is nearest to the robot's centre, and is reduced by the ring's radius.
fn as_of_the_ring(range: f64, transducer: &Transducer, hearing: &Hearing) -> f64 {
    if is_on_the_ring(transducer, hearing.ring_radius) {
        return range;
    }
    let (sin, cos) = libm::sincos(transducer.bearing.0);
    (transducer.x * cos + transducer.y * sin + range - hearing.ring_radius).max(0.0)
}

fn mount(transducer: &Transducer, ring_radius: f64) -> Mount {
    let Transducer { x, y, bearing, sonar } = *transducer;
    if is_on_the_ring(transducer, ring_radius) { Mount::default() } else { Mount::of(x, y, bearing, sonar) }
}

fn stepped(range: f64, step: f64) -> f64 {
    // Prevents rounding errors from reducing a whole number of steps by one.
    if step > 0.0 { libm::floor(range / step + 1e-9) * step } else { range }
}

/// Returns the ping of this sonar. Its range is the shortest of the last ranges of its transducers, measured from the
/// ring; `None` if none of them received an echo.
fn nearest(hearing: &Hearing, heard: &[Heard], sonar: usize, at: Nanos, odometry: Pose) -> Ping {
    let speaking = hearing.transducers.iter().zip(heard).filter(|(transducer, _)| transducer.sonar.number() == sonar);
    let heard = speaking.filter_map(|(transducer, last)| {
        let Meters(range) = last.range?;
        Some((transducer, as_of_the_ring(range, transducer, hearing)))
    });
    let nearest = heard.reduce(|one, other| if other.1 < one.1 { other } else { one });
    let mount = nearest.map_or(Mount::default(), |(transducer, _)| mount(transducer, hearing.ring_radius));
    Ping { range: nearest.map(|(_, range)| Meters(range)), at, pose: odometry, mount }
}
