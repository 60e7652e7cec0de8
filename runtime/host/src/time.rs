//! Time of a run: the wall clock, or stepped time.

/// Time of a robot: real or stepped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Time {
    /// Time of the wall clock, read after each exchange.
    Wall,
    /// Turn `k` takes place exactly at the time of `k` periods, independent of the wall clock, as in a simulated world.
    Stepped(Pace),
}

/// Pace of stepped time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// A multiple of the wall clock's speed; the factor is positive and finite.
    Times(f64),
    /// The fastest possible pace.
    Max,
}
