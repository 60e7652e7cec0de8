//! `atIsection b`: fires where the ways front, left, back and right are as the bits say (paper, section IV-A).

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Bits, Interrupt, SonarId};

/// The sonars that look front, left, back and right: the order in which the bits are written.
const DIRECTIONS: [SonarId; 4] = [SonarId::new(0), SonarId::new(4), SonarId::new(8), SonarId::new(12)];

/// Fires while all four directions are as the bits say: 1 where an obstacle is near, 0 where the way is free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AtIsection {
    pattern: Bits<4>,
}

impl AtIsection {
    /// The quark `atIsection pattern`, with the bits front, left, back, right.
    #[must_use]
    pub const fn new(pattern: Bits<4>) -> Self {
        Self { pattern }
    }
}

impl<Y: SonarRing> Interrupt<Y> for AtIsection {
    fn fired(&self, y: &Y) -> bool {
        DIRECTIONS.iter().zip(self.pattern.0).all(|(sonar, obstacle)| blocked(y, *sonar) == Some(obstacle))
    }
}

/// Whether something is near in the direction of this one sonar; `None` before its first ping.
///
/// The smallest of the last pings decides, so "blocked" is believed at once and "free" only when they agree: a missed
/// echo opens no way. Only the sonar in that direction counts: its neighbours see the walls along a corridor.
fn blocked<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<bool> {
    let pings = y.pings(sonar);
    pings.newest_first().next()?;
    Some(pings.nearest(y.confirmation()).is_some_and(|range| range < y.blocked_within()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    const NEAR: Option<f64> = Some(1.14);
    const FAR: Option<f64> = Some(1.15);

    /// An output with these pings, oldest first, of the sonars front, left, back and right.
    fn seen(pings: [&[Option<f64>]; 4]) -> Sensed {
        let mut y = Sensed::default();
        for (sonar, ranges) in DIRECTIONS.iter().zip(pings) {
            for range in ranges {
                y.ping(*sonar, *range);
            }
        }
        y
    }

    fn fires(bits: &str, y: &Sensed) -> bool {
        let mut pattern = [false; 4];
        for (bit, digit) in pattern.iter_mut().zip(bits.chars()) {
            *bit = digit == '1';
        }
        AtIsection::new(Bits(pattern)).fired(y)
    }

    #[test]
    fn bits_are_front_left_back_right() {
        let y = seen([&[FAR; 3], &[NEAR; 3], &[None; 3], &[FAR; 3]]);
        assert!(fires("0100", &y));
        for other in ["0000", "1000", "0010", "0001", "1100", "0110", "0101"] {
            assert!(!fires(other, &y), "{other}");
        }
    }

    #[test]
    fn blocked_is_believed_at_once() {
        assert!(fires("1000", &seen([&[None, FAR, NEAR], &[FAR; 3], &[FAR; 3], &[FAR; 3]])));
    }

    #[test]
    fn free_is_believed_when_three_pings_agree() {
        let way = |pings| seen([pings, &[FAR; 3], &[FAR; 3], &[FAR; 3]]);
        assert!(!fires("0000", &way(&[NEAR, None, FAR])), "a missed echo must open nothing");
        assert!(fires("0000", &way(&[NEAR, FAR, None, FAR])));
    }

    #[test]
    fn free_is_believed_after_two_pings_where_sonars_fire_in_turn() {
        let mut y = seen([&[NEAR, None, FAR], &[FAR; 3], &[FAR; 3], &[FAR; 3]]);
        y.confirmation = 2;
        assert!(fires("0000", &y));
    }

    #[test]
    fn a_sonar_that_has_not_pinged_is_neither_blocked_nor_free() {
        let y = seen([&[], &[FAR; 3], &[FAR; 3], &[FAR; 3]]);
        assert!(!fires("0000", &y));
        assert!(!fires("1000", &y));
    }
}
