//! `align i j`: turns until two sonars return equal ranges, `u_θ = k(r_i − r_j)` (paper, section IV-A).

#[cfg(test)]
mod tests;

use core::f64::consts::TAU;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Begin, Completes, Control, Law, Nanos, Ping, Radians, RadiansPerSecond, SONARS, SonarId, Twist};

use crate::gains::{Gains, fire_in_turn};

/// Minimum turn rate, in rad/s; a lower rate does not move the wheels.
const SLOWEST: f64 = 0.08;
/// Maximum change, in metres, of the difference of the ranges from one sample to the next. If the sign changes and the
/// change is smaller, the ranges are equal at a heading between the two samples. If it is larger, one of the sonars
/// points past an edge, or has measured a wrong range.
const CONTINUOUS: f64 = 0.1;
/// Number of sign changes of the difference after which the law stops looking for a heading with equal ranges.
const CHANGES: u8 = 5;
/// Duration of a full circle at the minimum turn rate, in seconds, after which the robot has tried every heading.
const LONGEST: f64 = TAU / SLOWEST;
/// Maximum angle between the robot's heading and the final heading at which the law stops the robot.
const NEAR: Radians = Radians::from_degrees(1.0);

/// The control `align`: `u_θ = k(r_i − r_j)`, `u_f = 0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Align {
    first: SonarId,
    second: SonarId,
}

impl Align {
    /// Creates the quark `align first second`.
    #[must_use]
    pub const fn new(first: SonarId, second: SonarId) -> Self {
        Self { first, second }
    }
}

/// The law of [`Align`], which is done when the ranges are equal and, if every turn brings a ping, the robot is
/// at rest at that heading.
///
/// Beside a jamb, a corner or a door, there may be no heading with equal ranges: on one side of it the first range is
/// longer, and on the other side the second range is longer. The law is then done at the heading at which the ranges
/// differed by the smallest amount; the signals `r` of the two sonars show the remaining difference.
///
/// The law waits for a sonar that occasionally misses an echo. If a sonar receives no echo for a longer time, the robot
/// turns to search for the wall, by at most one full circle. If it has found no wall after the time of a slow full
/// circle, the law is done at the current heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aligning {
    sonars: Align,
    began: Nanos,
    /// Time at which both sonars last received an echo; `None` before that.
    heard: Option<Nanos>,
    last: Option<Sample>,
    /// Sample with the smallest difference so far. If several samples are equal, this is the last of them; `None`
    /// before the first sample.
    best: Option<Sample>,
    /// Number of times that the sign of the difference has changed.
    changes: u8,
    end: Option<End>,
}

/// The difference of the ranges of both sonars, and the heading to which it belongs.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    /// Range of the first sonar minus the range of the second, in metres.
    difference: f64,
    /// Mean of the headings at which the sonars pinged. If the ranges change at a constant rate, the difference belongs
    /// to this heading.
    heading: Radians,
}

/// The heading at which the law ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    heading: Radians,
    /// `true` if the last input that the law returned stops the robot at this heading.
    stands: bool,
}

impl Aligning {
    /// Returns the sample of the newest echoes, which are confirmed by earlier pings as in `atIsection`; `None` if one
    /// of the sonars receives no echo.
    fn sample<Y: SonarRing>(&self, y: &Y) -> Option<Sample> {
        let Align { first, second } = self.sonars;
        let ((first, near), (second, far)) = (nearest(y, first)?, nearest(y, second)?);
        let (from, to) = (first.pose.theta, second.pose.theta);
        Some(Sample { difference: near - far, heading: between(from, to, 0.5) })
    }

    /// Returns the sample if the ranges of both sonars are equal; `None` otherwise.
    fn equal<Y: DiffDrive + SonarRing>(&self, y: &Y) -> Option<Sample> {
        self.sample(y).filter(|sample| sample.difference.abs() <= Gains::of(y).align_equal)
    }

    /// Stores a sample. If the robot has just passed a heading with equal ranges, the law will end at this heading.
    ///
    /// Pings of sonars that fire in turn belong to headings that are degrees apart, and their ranges may be wrong by an
    /// inch, so a change of sign alone does not mean equal ranges.
    fn take(&mut self, sample: Sample, in_turn: bool) {
        let Some(last) = self.last.replace(sample).filter(|last| *last != sample) else {
            self.best = self.best.or(Some(sample));
            return;
        };
        if self.best.is_none_or(|best| sample.difference.abs() <= best.difference.abs()) {
            self.best = Some(sample);
        }
        if last.difference * sample.difference >= 0.0 {
            return;
        }
        self.changes = self.changes.saturating_add(1);
        let apart = (last.difference - sample.difference).abs();
        if apart <= CONTINUOUS && !in_turn {
            self.ends_at(between(last.heading, sample.heading, last.difference.abs() / apart));
        }
    }

    fn ends_at(&mut self, heading: Radians) {
        self.end = self.end.or(Some(End { heading, stands: false }));
    }

    /// Returns the turn rate, in rad/s, for a turn in which at most one sonar receives an echo. The robot turns towards
    /// that sonar.
    fn unheard<Y: DiffDrive + SonarRing>(&self, y: &Y, t: Nanos) -> f64 {
        let Gains { align_waits: waits, align_fastest: fastest, .. } = *Gains::of(y);
        let (since, waits) = self.heard.map_or((self.began, 0.0), |heard| (heard, waits));
        if !(waits..waits + TAU / fastest).contains(&t.since(since).seconds()) {
            return 0.0;
        }
        let heard = |sonar| y.pings(sonar).nearest(y.confirmation()).is_some();
        match (heard(self.sonars.first), heard(self.sonars.second)) {
            (false, true) => fastest,
            (true, false) => -fastest,
            // Neither sonar hears the wall, or both do, which `sample` handles.
            (false, false) | (true, true) => 0.0,
        }
    }

    /// Returns the turn rate, in rad/s, that reduces the difference of the ranges, as long as the heading at which the
    /// ranges are equal is not known.
    fn towards<Y: DiffDrive + SonarRing>(&self, y: &Y, sample: Option<Sample>, t: Nanos) -> f64 {
        let rate = sample.map_or_else(|| self.unheard(y, t), |sample| y.steering().align * sample.difference);
        self.sense() * bounded(rate, Gains::of(y).align_fastest)
    }

    /// Returns the sign of the turn rate. It is 1 if the second sonar is counter-clockwise of the first, as in all
    /// plans of the paper. Otherwise it is -1, because the paper's formula would then turn the robot away from equal
    /// ranges.
    fn sense(&self) -> f64 {
        let way = (SONARS + self.sonars.second.number() - self.sonars.first.number()) % SONARS;
        if way <= SONARS / 2 { 1.0 } else { -1.0 }
    }
}

/// Returns the ping with the smallest range among the last pings of a sonar that confirm each other, and its range in
/// metres; `None` if none of these pings has an echo.
fn nearest<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<(&Ping, f64)> {
    let pings = y.pings(sonar).newest_first().take(y.confirmation());
    let heard = pings.filter_map(|ping| ping.range.map(|range| (ping, range.0)));
    heard.reduce(|one, other| if other.1 < one.1 { other } else { one })
}

/// Returns the heading at the fraction `part` of the shorter turn from one heading to another.
fn between(from: Radians, to: Radians, part: f64) -> Radians {
    Radians(from.0 + part * Radians(to.0 - from.0).wrapped().0)
}

/// Returns `rate`, limited to absolute values that are high enough to move the wheels and at most `fastest`. A rate of
/// 0 remains 0.
fn bounded(rate: f64, fastest: f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate.abs().clamp(SLOWEST, fastest) * rate.signum() }
}

impl<Y: DiffDrive + SonarRing> Control<Y> for Align {
    type Law = Aligning;

    fn begin(&self, _: &Y, begin: Begin) -> Aligning {
        Aligning { sonars: *self, began: begin.now, heard: None, last: None, best: None, changes: 0, end: None }
    }
}

impl<Y: DiffDrive + SonarRing> Law<Y> for Aligning {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let sample = self.sample(y);
        if let Some(sample) = sample {
            self.heard = Some(t);
            self.take(sample, fire_in_turn(y));
        }
        if let Some(sample) = self.equal(y) {
            self.ends_at(sample.heading);
        }
        let is_late = t.since(self.began).seconds() > LONGEST;
        if self.changes >= CHANGES || is_late {
            let best = self.best.map(|best| best.heading);
            if let Some(heading) = best.or(is_late.then_some(y.here().theta)) {
                self.ends_at(heading);
            }
        }
        let Some(end) = &mut self.end else {
            let omega = RadiansPerSecond(self.towards(y, sample, t));
            return Twist { omega, ..Twist::default() };
        };
        let left = Radians(end.heading.0 - y.here().theta.0).wrapped();
        end.stands = left.0.abs() <= NEAR.0;
        let rate = if end.stands { 0.0 } else { bounded(y.steering().rotate * left.0, Gains::of(y).align_fastest) };
        Twist { omega: RadiansPerSecond(rate), ..Twist::default() }
    }
}

impl<Y: DiffDrive + SonarRing> Completes<Y> for Aligning {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        let is_near = |heading: Radians| Radians(heading.0 - y.here().theta.0).wrapped().0.abs() <= NEAR.0;
        self.end.is_some_and(|end| end.stands)
            || self.equal(y).is_some_and(|sample| fire_in_turn(y) || self.end.is_none() && is_near(sample.heading))
    }
}
