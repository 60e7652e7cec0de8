//! Keeps the echo before a missed ping: of a person who comes from a side, a sonar that pings once a second receives
//! few echoes, and misses some.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, PINGS_KEPT, Ping, SONARS, SonarId};

/// Returns the sonars that face ahead or to a side.
pub(crate) fn beside() -> impl Iterator<Item = SonarId> {
    let faces = |sonar: &SonarId| sonar.bearing().wrapped().0.abs() <= core::f64::consts::FRAC_PI_2;
    (0..SONARS as u8).map(SonarId::new).filter(faces)
}

/// For each sonar, the ping before those that an output keeps, or the oldest of these; `None` if it received no echo,
/// and after two missed pings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Heard([Option<Ping>; SONARS]);

impl Heard {
    /// Stores the oldest kept ping of each sonar if it received an echo. When the next one is the oldest and received
    /// none, the stored ping is the one before the missed ping.
    pub(crate) fn take<Y: SonarRing>(&mut self, y: &Y) {
        for sonar in beside() {
            let Some(heard) = self.0.get_mut(sonar.number()) else { continue };
            let [middle, old] = [1, 2].map(|place| y.pings(sonar).newest_first().nth(place));
            let has_echo = |ping: Option<&Ping>| ping.is_some_and(|ping| ping.range.is_some());
            *heard = if has_echo(old) { old.copied() } else { heard.filter(|_| has_echo(middle)) };
        }
    }

    /// Returns the three newest echoes of `sonar`, newest first; `None` if they are not the last three pings, or those
    /// before and after a missed one.
    pub(crate) fn newest<'a, Y: SonarRing>(&'a self, y: &'a Y, sonar: SonarId) -> Option<[(&'a Ping, Meters); 3]> {
        const { assert!(PINGS_KEPT == 3) };
        let mut pings = y.pings(sonar).newest_first();
        let [new, middle, old] = [pings.next()?, pings.next()?, pings.next()?];
        let old = if old.range.is_some() { old } else { self.0.get(sonar.number())?.as_ref()? };
        Some([(new, new.range?), (middle, middle.range?), (old, old.range?)])
    }
}
