//! Keeps the echo before a ping that missed a person: a sonar that pings once a second receives only a few echoes of a
//! person who crosses the robot's way.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, PINGS_KEPT, Ping, SONARS, SonarId};

/// Returns the sonars that face ahead or to a side.
pub(crate) fn forward_sonars() -> impl Iterator<Item = SonarId> {
    let faces = |sonar: &SonarId| sonar.bearing().wrapped().0.abs() <= core::f64::consts::FRAC_PI_2;
    (0..SONARS as u8).map(SonarId::new).filter(faces)
}

/// The last ping of each sonar that had an echo when it was the oldest of the pings that an output keeps; `None` if
/// there was no such ping, or if two pings in a row after it had no echo.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct BeforeMissed([Option<Ping>; SONARS]);

impl BeforeMissed {
    /// Updates the stored pings; must be called in every turn. If the oldest kept ping of a sonar has an echo, that
    /// ping is stored. If it has none, it is the missed ping, and the ping stored before remains.
    pub(crate) fn take<Y: SonarRing>(&mut self, y: &Y) {
        for sonar in forward_sonars() {
            let Some(stored) = self.0.get_mut(sonar.number()) else { continue };
            let [middle, old] = [1, 2].map(|place| y.pings(sonar).newest_first().nth(place));
            let has_echo = |ping: Option<&Ping>| ping.is_some_and(|ping| ping.range.is_some());
            *stored = if has_echo(old) { old.copied() } else { stored.filter(|_| has_echo(middle)) };
        }
    }

    /// Returns the three newest echoes of `sonar`, newest first, each with its range; `None` if more than one ping
    /// since the oldest of them had no echo, or if the missed ping is not the oldest kept one.
    pub(crate) fn newest<'a, Y: SonarRing>(&'a self, y: &'a Y, sonar: SonarId) -> Option<[(&'a Ping, Meters); 3]> {
        const { assert!(PINGS_KEPT == 3) };
        let mut pings = y.pings(sonar).newest_first();
        let [new, middle, old] = [pings.next()?, pings.next()?, pings.next()?];
        let old = if old.range.is_some() { old } else { self.0.get(sonar.number())?.as_ref()? };
        Some([(new, new.range?), (middle, middle.range?), (old, old.range?)])
    }
}
