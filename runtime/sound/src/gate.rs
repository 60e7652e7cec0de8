//! Rejects uncertain estimates while better ones are available.

/// Limit of the ratio after an estimate was kept.
const HIGHEST: f64 = 7.0;
/// Minimum limit of the ratio, which is reached when no estimate is kept for some time.
const LOWEST: f64 = 3.5;
/// Decrease of the limit per second in which no estimate is kept.
const FALL: f64 = 1.4;

/// Gate that keeps an estimate if the ratio of the maximum of its correlation to the root mean square exceeds a limit.
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
    /// Returns `true` if an estimate with this ratio is kept. `seconds` is the time since the previous samples; the
    /// limit falls with this time while nothing is kept.
    pub fn keeps(&mut self, ratio: f64, seconds: f64) -> bool {
        let keeps = ratio > self.limit;
        self.limit = if keeps { HIGHEST } else { (self.limit - FALL * seconds).max(LOWEST) };
        keeps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gate_falls_while_nothing_is_kept() {
        let mut gate = RatioGate::default();
        let dropped = (0..100).take_while(|_| !gate.keeps(4.2, 0.1)).count();
        assert!((20..=22).contains(&dropped), "{dropped}");
        assert!(!gate.keeps(6.9, 0.1), "closed again");
        assert!((0..1000).all(|_| !gate.keeps(3.5, 0.1)), "never below its least");
    }
}
