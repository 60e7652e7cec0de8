//! Simulates the sonars: the order in which they ping, and the ranges that they measure, including errors of
//! measurement.

mod echo;
mod kept;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use mdle_runtime::{Meters, Nanos, Pings, Pose, Radians, SONARS};

use crate::model::{FiringOrder, Hearing, Transducer};
use crate::noise::{Noise, Purpose};
use crate::point::Point;
use crate::walls::Walls;
use kept::KeptPings;

/// The sonars and their last pings.
#[derive(Debug, Clone)]
pub(crate) struct Ring {
    kept: KeptPings,
    /// Model of the sonars, which all robots with the same body share.
    pub(crate) hearing: Arc<Hearing>,
    /// Latest ping of each transducer, with the range measured from the transducer itself; empty if every sonar has a
    /// single transducer.
    pub(crate) heard: Box<[Heard]>,
    errors: Option<SonarErrors>,
    /// Next group to ping, and the time of its ping; not used if all sonars ping in every turn.
    next: (usize, Nanos),
    /// Unit of the times of stored pings: the time between two pings, or the duration of a turn if all sonars ping in
    /// every turn.
    tick: Nanos,
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
    /// Returns sonars with the errors of `seed`, or without errors. `period` is the duration of a turn.
    pub(crate) fn new(hearing: impl Into<Arc<Hearing>>, seed: Option<u64>, period: Nanos) -> Self {
        let hearing = hearing.into();
        let errors = seed.map(|seed| {
            let mut outliers = Noise::of(seed, Purpose::Outliers);
            let scale = 1.0 + hearing.scale * (2.0 * outliers.uniform() - 1.0);
            outliers.release();
            SonarErrors {
                ranges: Noise::of(seed, Purpose::Ranges),
                outliers,
                fading: Noise::of(seed, Purpose::Fading),
                scale,
            }
        });
        let count = hearing.transducers.len();
        let heard = vec![Heard::default(); if count > SONARS { count } else { 0 }].into_boxed_slice();
        let tick = hearing.order.as_ref().map_or(period, |order| order.gap);
        let tick = Nanos(tick.0.max(1));
        Self { kept: KeptPings::empty(hearing.step), hearing, heard, errors, next: (0, Nanos::ZERO), tick }
    }

    /// Returns the last pings of each sonar.
    pub(crate) fn pings(&self) -> [Pings; SONARS] {
        self.kept.pings(&self.hearing, self.tick)
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
            for number in 0..self.hearing.transducers.len() {
                self.transmit(number, pose, odometry, at, walls);
            }
            return;
        };
        let (group, when) = self.next;
        self.next = ((group + 1) % groups.len(), Nanos(when.0.saturating_add(gap.0)));
        let count = groups.get(group).map_or(0, Vec::len);
        for place in 0..count {
            let Some(number) = self.grouped(group, place) else { continue };
            self.transmit(number, pose, odometry, at, walls);
        }
    }

    /// Returns the number of the transducer at index `place` of a group; `None` if there is no such transducer.
    fn grouped(&self, group: usize, place: usize) -> Option<usize> {
        self.hearing.order.as_ref()?.groups.get(group)?.get(place).copied()
    }

    /// Frees memory that is needed only during a turn.
    pub(crate) fn release(&mut self) {
        if let Some(SonarErrors { ranges, outliers, fading, .. }) = &mut self.errors {
            [ranges, outliers, fading].into_iter().for_each(Noise::release);
        }
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

    /// Makes one transducer ping, on a robot at `pose` whose odometry reports `odometry`.
    fn transmit(&mut self, number: usize, pose: &Pose, odometry: Pose, at: Nanos, walls: &Walls) {
        let range = self.listen(number, pose, walls);
        if let Some(last) = self.heard.get_mut(number) {
            *last = Heard { range: range.map(Meters), at };
        }
        // A sonar with several transducers has pinged when the last of them has pinged.
        let Some(sonar) = self.completed(number) else { return };
        let echo = if self.heard.is_empty() { range.map(|range| (range, number)) } else { self.nearest(sonar) };
        let ticks = u32::try_from(at.0 / self.tick.0).unwrap_or(u32::MAX);
        self.kept.push(sonar, echo, ticks, odometry, self.hearing.step);
    }

    /// Returns the sonar to which this transducer belongs; `None` if another transducer of the same sonar pings later
    /// in the firing order.
    fn completed(&self, number: usize) -> Option<usize> {
        let sonar = |number: usize| self.hearing.transducers[number].sonar.number();
        let own = sonar(number);
        if self.heard.is_empty() {
            return Some(own);
        }
        let last = match &self.hearing.order {
            Some(order) => order.groups.iter().flatten().copied().rfind(|other| sonar(*other) == own),
            None => (0..self.heard.len()).rfind(|other| sonar(*other) == own),
        };
        (last == Some(number)).then_some(own)
    }

    /// Returns the nearest of the last echoes of a sonar's transducers, as the range from the transducer and the number
    /// of the transducer; `None` without an echo.
    fn nearest(&self, sonar: usize) -> Option<(f64, usize)> {
        let of_sonar = |number: &usize| self.hearing.transducers[*number].sonar.number() == sonar;
        let heard = (0..self.heard.len()).filter(of_sonar);
        let echoes = heard.filter_map(|number| self.heard[number].range.map(|range| (range.0, number)));
        let of_ring = |(range, number): (f64, usize)| self.hearing.of_ring(range, number);
        echoes.reduce(|one, other| if of_ring(other) < of_ring(one) { other } else { one })
    }

    /// Makes one transducer ping, and returns the range from it; `None` without an echo.
    fn listen(&mut self, number: usize, pose: &Pose, walls: &Walls) -> Option<f64> {
        let Self { hearing, errors, .. } = self;
        let transducer = &hearing.transducers[number];
        let fade = match errors {
            Some(errors) if hearing.fading > 0.0 => hearing.fading * errors.fading.normal(),
            Some(_) | None => 0.0,
        };
        let (from, axis) = placed(transducer, pose, hearing.ring_radius);
        let exact = echo::echo(walls, from, axis, hearing, fade);
        let heard = errors.as_mut().map_or(exact, |errors| errors.of(exact, hearing));
        let heard = heard.map(|range| stepped(range.max(hearing.least), hearing.step));
        heard.filter(|range| *range < hearing.most)
    }
}

impl SonarErrors {
    /// Returns the measured range for the exact range `exact`; `None` if there is no echo. Every ping uses the same
    /// number of random numbers, regardless of its result.
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
    if transducer.mount.is_none() {
        return (Point::of(&pose.towards(axis, Meters(ring_radius))), axis);
    }
    let (sin, cos) = libm::sincos(pose.theta.0);
    let Transducer { x, y, .. } = transducer;
    (Point { x: pose.x.0 + x * cos - y * sin, y: pose.y.0 + x * sin + y * cos }, axis)
}

fn stepped(range: f64, step: f64) -> f64 {
    // Prevents rounding errors from reducing a whole number of steps by one.
    if step > 0.0 { libm::floor(range / step + 1e-9) * step } else { range }
}
