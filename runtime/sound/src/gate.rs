//! Rejects uncertain estimates while better ones are available.

/// Limit of the ratio immediately after an estimate was kept.
const HIGHEST: f64 = 7.0;
/// Lowest limit of the ratio, which is reached if no estimate is kept for some time.
const LOWEST: f64 = 3.5;
/// Decrease of the limit in each second in which no estimate is kept.
const FALL: f64 = 1.4;

/// Keeps an estimate if the ratio of the maximum of its correlation to the root mean square exceeds a limit.
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
    /// Returns `true` if an estimate with this ratio is kept. `seconds` is the time since the previous samples. While
    /// no estimate is kept, the limit decreases with this time.
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
