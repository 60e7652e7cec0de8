//! Rejects estimates that are uncertain, or may be of a reflection, while better ones are available.

use crate::Estimate;

/// Limit of the ratio immediately after an estimate was kept.
const HIGHEST: f64 = 7.0;
/// Lowest limit of the ratio, which is reached if no estimate is kept for some time.
const LOWEST: f64 = 3.5;
/// Decrease of the limit in each second in which no estimate is kept.
const FALL: f64 = 1.4;
/// Ratio of another maximum to the maximum from which the maximum may belong to a reflection.
const RIVAL: f64 = 0.5;
/// Limit of the ratio at which estimates that may be of a reflection are kept too. It is reached if no estimate is kept
/// for 1.2 seconds: a plan that reads a bearing is stopped if there is none for two seconds.
const PATIENT: f64 = HIGHEST - 1.2 * FALL;

/// Keeps an estimate if the ratio of the maximum of its correlation to the root mean square exceeds a limit, and if no
/// other maximum is nearly as high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatioGate {
    limit: f64,
}

impl Default for RatioGate {
    fn default() -> Self {
        Self { limit: HIGHEST }
    }
}

impl RatioGate {
    /// Returns `true` if an estimate is kept. `seconds` is the time since the previous samples. While no estimate is
    /// kept, the limit decreases with this time.
    pub fn keeps(&mut self, estimate: &Estimate, seconds: f64) -> bool {
        let keeps = estimate.ratio > self.limit && (estimate.rival < RIVAL || self.limit <= PATIENT);
        self.limit = if keeps { HIGHEST } else { (self.limit - FALL * seconds).max(LOWEST) };
        keeps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns an estimate with this ratio of its maximum to the root mean square, and of another maximum to it.
    fn of(ratio: f64, rival: f64) -> Estimate {
        Estimate { angle: 0.0, ratio, rival }
    }

    #[test]
    fn the_gate_falls_while_nothing_is_kept() {
        let mut gate = RatioGate::default();
        let dropped = (0..100).take_while(|_| !gate.keeps(&of(4.2, 0.0), 0.1)).count();
        assert!((20..=22).contains(&dropped), "{dropped}");
        assert!(!gate.keeps(&of(6.9, 0.0), 0.1), "closed again");
        assert!((0..1000).all(|_| !gate.keeps(&of(3.5, 0.0), 0.1)), "never below its least");
    }

    #[test]
    fn estimates_that_may_be_of_a_reflection_are_kept_after_a_while() {
        assert!(RatioGate::default().keeps(&of(9.0, 0.49), 0.1));
        let mut gate = RatioGate::default();
        let dropped = (0..100).take_while(|_| !gate.keeps(&of(9.0, 0.5), 0.1)).count();
        assert!((12..=13).contains(&dropped), "{dropped}");
    }
}
