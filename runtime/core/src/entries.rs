//! Stores the entry of each scope for a cursor: its time, and in plans with `way`, `FRAME here` or `stuck` also the
//! odometer reading and the heading (docs/src/reference/semantics.md, 3.2 to 3.4).

use crate::{Nanometers, Nanos, Output, Pose, Radians, Slots};

/// Storage for the entry of the scope at each level: either only times, or [`Stamps`].
pub trait Entries {
    /// Returns `true` if no level is stored.
    fn is_empty(&self) -> bool;
    /// Returns the time at which the scope of this level was entered; `None` if the level is not stored.
    fn time(&self, level: u16) -> Option<Nanos>;
    /// Records that the scope of this level is entered at time `t`.
    fn note(&mut self, level: u16, t: Nanos);
    /// Records the output of a turn, and the time for which the law of the previous turn has made no progress
    /// ([`Law::stalled`](crate::Law::stalled)). Called first in each turn, before a condition is read or a scope is
    /// entered.
    #[inline(always)]
    fn observe<Y: Output>(&mut self, _y: &Y, _stalled: Option<Nanos>) {}
    /// Returns the time for which the law of the previous turn has made no progress; `None` if the law has no goal, or
    /// if this time is not stored.
    #[inline(always)]
    fn stalled(&self) -> Option<Nanos> {
        None
    }
    /// Records the output of the first turn after the plan was suspended. The path driven during the suspension does
    /// not count.
    fn resume<Y: Output>(&mut self, _y: &Y) {}
    /// Returns the length of the path driven since the scope of this level was entered.
    #[inline(always)]
    fn way(&self, _level: u16) -> Nanometers {
        Nanometers::ZERO
    }
    /// Returns the frame of the atom with this index, in the order of the plan's text; `None` if the atom is not inside
    /// a `FRAME here`.
    #[inline(always)]
    fn here(&self, _atom: u32) -> Option<Here> {
        None
    }
    /// Returns the heading, by odometry, at which the scope of this level was entered.
    #[inline(always)]
    fn heading(&self, _level: u16) -> Radians {
        Radians(0.0)
    }
}

/// Entries that store only times.
impl<S: AsRef<[Nanos]> + AsMut<[Nanos]>> Entries for S {
    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.as_ref().is_empty()
    }

    #[inline(always)]
    fn time(&self, level: u16) -> Option<Nanos> {
        self.as_ref().get(usize::from(level)).copied()
    }

    #[inline(always)]
    fn note(&mut self, level: u16, t: Nanos) {
        if let Some(entered) = self.as_mut().get_mut(usize::from(level)) {
            *entered = t;
        }
    }
}

/// Frame of an atom inside a `FRAME here`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Here {
    /// Level of the scope whose entry determines the heading.
    pub level: u16,
    /// Sum of the angles, counter-clockwise, of all `FRAME a` that enclose the atom and are inside the scope at
    /// `level`.
    pub turned: Radians,
}

/// Entry of a scope: time, odometer reading and heading.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stamp {
    /// Time of the entry.
    pub time: Nanos,
    /// Reading of the odometer.
    pub way: Nanometers,
    /// Heading by odometry.
    pub heading: Radians,
}

impl Stamp {
    /// The start of a plan, before the first output.
    pub const START: Self = Self { time: Nanos::ZERO, way: Nanometers::ZERO, heading: Radians(0.0) };
}

/// Entries of scopes with times, odometer readings and headings, together with the current odometer reading and
/// heading, and the progress of the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamps<S, F = &'static [Option<Here>]> {
    slots: S,
    /// The frame of each atom, in the order of the atoms.
    frames: F,
    /// Odometer reading and heading in this turn; the `time` is not used.
    now: Stamp,
    /// Pose in the previous turn; `None` before the first turn.
    last: Option<Pose>,
    /// Time for which the law of the previous turn has made no progress.
    stalled: Option<Nanos>,
}

impl<S: Slots<Stamp>, F: AsRef<[Option<Here>]>> Stamps<S, F> {
    /// Creates storage for as many levels as `slots` has; the initial values do not matter. `frames` contains the frame
    /// of each atom, in the order of the plan's text; it may be empty for a plan without `FRAME here`.
    #[must_use]
    pub const fn new(slots: S, frames: F) -> Self {
        Self { slots, frames, now: Stamp::START, last: None, stalled: None }
    }
}

impl<S: Slots<Stamp>, F: AsRef<[Option<Here>]>> Entries for Stamps<S, F> {
    fn is_empty(&self) -> bool {
        self.slots.as_ref().is_empty()
    }

    fn time(&self, level: u16) -> Option<Nanos> {
        self.slots.as_ref().get(usize::from(level)).map(|stamp| stamp.time)
    }

    fn note(&mut self, level: u16, t: Nanos) {
        if let Some(stamp) = self.slots.as_mut().get_mut(usize::from(level)) {
            *stamp = Stamp { time: t, ..self.now };
        }
    }

    fn observe<Y: Output>(&mut self, y: &Y, stalled: Option<Nanos>) {
        self.stalled = stalled;
        let here = y.here();
        let step = self.last.replace(here).map_or(Nanometers::ZERO, |last| Nanometers::round(last.distance(&here)));
        self.now.way = y.way().unwrap_or(self.now.way.plus(step));
        self.now.heading = here.theta;
    }

    fn stalled(&self) -> Option<Nanos> {
        self.stalled
    }

    fn resume<Y: Output>(&mut self, y: &Y) {
        let here = y.here();
        if let Some(reading) = y.way() {
            let meanwhile = reading.since(self.now.way);
            self.slots.as_mut().iter_mut().for_each(|stamp| stamp.way = stamp.way.plus(meanwhile));
            self.now.way = reading;
        }
        self.now.heading = here.theta;
        self.last = Some(here);
    }

    fn way(&self, level: u16) -> Nanometers {
        let entered = self.slots.as_ref().get(usize::from(level)).map_or(self.now.way, |stamp| stamp.way);
        self.now.way.since(entered)
    }

    fn here(&self, atom: u32) -> Option<Here> {
        self.frames.as_ref().get(atom as usize).copied().flatten()
    }

    fn heading(&self, level: u16) -> Radians {
        self.slots.as_ref().get(usize::from(level)).map_or(self.now.heading, |stamp| stamp.heading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Meters;

    /// Output of a robot: its pose, and the reading of its odometer if it has one.
    struct At(Pose, Option<Nanometers>);

    impl Output for At {
        fn here(&self) -> Pose {
            self.0
        }

        fn way(&self) -> Option<Nanometers> {
            self.1
        }
    }

    fn at(x: f64, y: f64, degrees: f64) -> At {
        At(Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) }, None)
    }

    #[test]
    fn the_way_is_the_sum_of_steps_there_and_back() {
        let mut stamps = Stamps::new([Stamp::START; 2], []);
        stamps.observe(&at(5.0, 0.0, 90.0), None);
        stamps.note(0, Nanos(0));
        stamps.observe(&at(5.3, 0.4, 90.0), None);
        stamps.note(1, Nanos(1));
        stamps.observe(&at(5.0, 0.0, 40.0), None);
        assert_eq!([0, 1, 7].map(|level| stamps.way(level).0), [1_000_000_000, 500_000_000, 0]);
        assert_eq!([0, 1, 7].map(|level| libm::round(stamps.heading(level).degrees())), [90.0, 90.0, 40.0]);
        assert_eq!([0, 1, 7].map(|level| stamps.time(level)), [Some(Nanos(0)), Some(Nanos(1)), None]);
    }

    #[test]
    fn a_robot_with_an_odometer_of_its_own_is_believed() {
        let mut stamps = Stamps::new([Stamp::START; 1], []);
        stamps.observe(&At(Pose::ORIGIN, Some(Nanometers(70))), None);
        stamps.note(0, Nanos(0));
        stamps.observe(&At(at(3.0, 0.0, 0.0).0, Some(Nanometers(100))), None);
        assert_eq!(stamps.way(0), Nanometers(30));
        stamps.resume(&At(Pose::ORIGIN, Some(Nanometers(500))));
        stamps.observe(&At(Pose::ORIGIN, Some(Nanometers(507))), None);
        assert_eq!(stamps.way(0), Nanometers(37), "400 were driven while the plan was suspended");
    }

    #[test]
    fn the_way_of_another_plan_does_not_count() {
        let mut stamps = Stamps::new([Stamp::START; 1], []);
        stamps.observe(&at(5.0, 0.0, 90.0), None);
        stamps.note(0, Nanos(0));
        stamps.observe(&at(5.3, 0.4, 90.0), None);
        stamps.resume(&at(9.0, 9.0, 30.0));
        assert_eq!((stamps.way(0).0, libm::round(stamps.heading(7).degrees())), (500_000_000, 30.0));
        stamps.observe(&at(9.0, 9.1, 30.0), None);
        assert_eq!(stamps.way(0), Nanometers(600_000_000));
    }

    #[test]
    fn progress_is_kept_beside_the_odometer_alone() {
        let mut stamps = Stamps::new([Stamp::START; 1], []);
        stamps.observe(&at(5.0, 0.0, 90.0), Some(Nanos(7)));
        assert_eq!(stamps.stalled(), Some(Nanos(7)));
        stamps.observe(&at(5.0, 0.0, 90.0), None);
        assert_eq!(stamps.stalled(), None);
        let mut times = [Nanos(0)];
        times.observe(&at(5.0, 0.0, 90.0), Some(Nanos(7)));
        assert_eq!(times.stalled(), None);
    }
}
