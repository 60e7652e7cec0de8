//! Time of a run: the wall clock, or steps.

/// Time of a robot: real or stepped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Time {
    /// Time of the wall clock, read after each exchange.
    Wall,
    /// Turn `k` is exactly at `k` periods, independent of the wall clock, as in a simulated world.
    Stepped(Pace),
}

/// Pace of stepped time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// A multiple of the wall clock's speed, positive and finite.
    Times(f64),
    /// The fastest possible pace.
    Max,
}
