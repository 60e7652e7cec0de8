//! Clock of a run, which determines the start and the time of each turn (docs/src/reference/semantics.md, 3.1).
//!
//! Turns begin at absolute deadlines, so that lateness does not add up. With a real robot, turns that were missed are
//! skipped: the robot is never sent a burst of inputs. In stepped time no turn is skipped: late turns follow each other
//! at once.

use std::time::Duration;

use mdle_runtime::Nanos;
use rustix::time::{ClockId, clock_gettime};

use crate::run_end::RunEnd;
use crate::signals::Signals;
use crate::timing::Timing;
use crate::{Pace, Time, scheduling};

/// Maximum sleep between two checks for signals.
const SLICE: Duration = Duration::from_millis(20);
/// Maximum lateness that stepped time catches up, in nanoseconds. After a longer delay, such as a suspension of the
/// process, turns continue from the current time.
const CATCH_UP: u64 = 250_000_000;

/// Maximum delay of a turn, if the robot does not limit the time without a command.
const GAP: Duration = Duration::from_secs(2);

/// Source of real time, which a test can control.
pub(crate) trait Instants {
    /// Returns the time since a moment before the first turn; it never goes back.
    fn now(&mut self) -> Duration;
    /// Sleeps for approximately `time`.
    fn sleep(&mut self, time: Duration);
    /// Requests from the system that it wakes this thread on time.
    ///
    /// # Errors
    /// Returns a sentence if the system does not permit that.
    fn keep_time(&mut self) -> Result<(), String> {
        Ok(())
    }
}

/// Clock of the time since the computer was started, including suspensions.
#[derive(Debug)]
pub(crate) struct SinceBoot;

impl Instants for SinceBoot {
    fn now(&mut self) -> Duration {
        let now = clock_gettime(ClockId::Boottime);
        Duration::new(now.tv_sec.try_into().unwrap_or(0), now.tv_nsec.try_into().unwrap_or(0))
    }

    fn sleep(&mut self, time: Duration) {
        std::thread::sleep(time);
    }

    fn keep_time(&mut self) -> Result<(), String> {
        scheduling::claim()
    }
}

/// Clock of a run.
#[derive(Debug)]
pub(crate) struct Clock<I> {
    instants: I,
    time: Time,
    /// Period of a turn in nanoseconds; at least 1.
    period: u64,
    /// Start of turn 0, or of the turn in which the pace was changed, in real nanoseconds. In stepped time, lateness
    /// that is not caught up is added.
    origin: u64,
    /// Real time of the first output, in nanoseconds: time 0 of the plan.
    zero: u64,
    /// Number of periods from the start of turn 0 to the start of the current turn.
    place: u64,
    /// Number of periods from the start of turn 0 to the last change of the pace.
    paced_from: u64,
    /// Start of the current turn, in real nanoseconds.
    begun: u64,
    /// Maximum time between two commands to a robot in real time, in nanoseconds.
    longest_gap: u64,
    timing: Timing,
}

impl<I: Instants> Clock<I> {
    /// Returns the clock of a run whose turn 0 begins now. The robot can be without a command for `longest_gap`; the
    /// default is two seconds more than a period.
    pub(crate) fn begin(mut instants: I, time: Time, period: Duration, longest_gap: Option<Duration>) -> Self {
        let origin = nanos(instants.now());
        let longest_gap = nanos(longest_gap.unwrap_or(period.saturating_add(GAP)));
        let period = nanos(period).max(1);
        let timing = Timing::new(period);
        Self {
            instants,
            time,
            period,
            origin,
            zero: origin,
            place: 0,
            paced_from: 0,
            begun: origin,
            longest_gap,
            timing,
        }
    }

    /// Records that the first output has been read, at the plan's time 0.
    pub(crate) fn zero(&mut self) -> Nanos {
        self.zero = nanos(self.instants.now());
        Nanos::ZERO
    }

    /// Returns the plan's time of the output that has just been read.
    pub(crate) fn taken(&mut self) -> Nanos {
        match self.time {
            Time::Wall => Nanos(nanos(self.instants.now()).saturating_sub(self.zero)),
            Time::Stepped(_) => Nanos(self.place.saturating_mul(self.period)),
        }
    }

    /// Changes the pace of stepped time: the next turn begins one period after now. The wall clock has only one pace.
    pub(crate) fn set_pace(&mut self, pace: Pace) {
        let Time::Stepped(before) = &mut self.time else { return };
        *before = pace;
        self.origin = nanos(self.instants.now());
        self.paced_from = self.place;
    }

    /// Returns the lateness and the durations of the turns, if a robot in real time has made any turns.
    pub(crate) fn timing(&self) -> Option<&Timing> {
        Some(&self.timing).filter(|timing| self.time == Time::Wall && timing.has_turns())
    }

    /// Waits for the beginning of the next turn.
    ///
    /// # Errors
    /// A signal has arrived, which ends the wait early; too many consecutive turns were longer than the period; or the
    /// robot was without a command for too long.
    pub(crate) fn next_turn(&mut self, signals: &Signals) -> Result<(), RunEnd> {
        if self.time == Time::Wall {
            let took = nanos(self.instants.now()).saturating_sub(self.begun);
            self.timing.took(took).map_err(RunEnd::Overrun)?;
        }
        let deadline = self.deadline();
        loop {
            if let Some(signal) = signals.caught() {
                return Err(RunEnd::Signal(signal));
            }
            let Some(deadline) = deadline else { return Ok(()) };
            let now = nanos(self.instants.now());
            let left = deadline.saturating_sub(now);
            if left == 0 {
                let gap = now.saturating_sub(self.begun);
                if self.time == Time::Wall && gap > self.longest_gap {
                    return Err(RunEnd::Suspended { gap, longest: self.longest_gap });
                }
                self.begun = now;
                self.timing.begins(now.saturating_sub(deadline));
                return Ok(());
            }
            self.instants.sleep(Duration::from_nanos(left).min(SLICE));
        }
    }

    /// Advances to the next turn; returns its start in real nanoseconds, or `None` if it starts without a wait.
    fn deadline(&mut self) -> Option<u64> {
        self.place = self.place.saturating_add(1);
        match self.time {
            Time::Wall => {
                let passed = nanos(self.instants.now()).saturating_sub(self.origin);
                self.place = self.place.max(passed.div_ceil(self.period));
                Some(self.origin.saturating_add(self.place.saturating_mul(self.period)))
            }
            Time::Stepped(Pace::Times(times)) => {
                // The conversion saturates, and 2^53 nanoseconds, up to which it is exact, are three months.
                let places = self.place.saturating_sub(self.paced_from);
                let after = (places as f64 * self.period as f64 / times) as u64;
                let late = nanos(self.instants.now()).saturating_sub(self.origin.saturating_add(after));
                if late > CATCH_UP {
                    self.origin = self.origin.saturating_add(late);
                }
                Some(self.origin.saturating_add(after))
            }
            Time::Stepped(Pace::Max) => None,
        }
    }
}

/// Converts a duration to nanoseconds; saturates at `u64::MAX`, which is 584 years.
pub(crate) fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::Signal;

    /// Time that passes only in sleeps, and when the test advances it.
    #[derive(Debug, Default)]
    struct ByHand(Duration);

    impl Instants for ByHand {
        fn now(&mut self) -> Duration {
            self.0
        }

        fn sleep(&mut self, time: Duration) {
            assert!(time <= SLICE, "a signal would wait for {time:?}");
            self.0 += time;
        }
    }

    const PERIOD: Duration = Duration::from_millis(100);

    /// The real time in milliseconds at which the next turn begins, when the current one took `took` milliseconds.
    fn next_after(clock: &mut Clock<ByHand>, took: u64) -> u128 {
        clock.instants.0 += Duration::from_millis(took);
        clock.next_turn(&Signals::unheard()).expect("no signal");
        clock.instants.0.as_millis()
    }

    #[test]
    fn turns_begin_at_absolute_deadlines() {
        let mut clock = Clock::begin(ByHand::default(), Time::Wall, PERIOD, None);
        let begins = [30, 99, 0, 100].map(|took| next_after(&mut clock, took));
        assert_eq!(begins, [100, 200, 300, 400]);
    }

    #[test]
    fn a_late_robot_skips_ahead() {
        let mut clock = Clock::begin(ByHand::default(), Time::Wall, PERIOD, None);
        let begins = [101, 250, 10].map(|took| next_after(&mut clock, took));
        assert_eq!(begins, [200, 500, 600]);
    }

    #[test]
    fn the_tenth_turn_in_a_row_that_is_too_long_is_one_too_many() {
        let mut clock = Clock::begin(ByHand::default(), Time::Wall, PERIOD, None);
        next_after(&mut clock, 100);
        assert!(clock.timing().is_some_and(|timing| timing.to_string().starts_with("1 turn of 100ms, 0 longer\n")));
        for _ in 0..9 {
            next_after(&mut clock, 101);
        }
        clock.instants.0 += Duration::from_millis(101);
        let ending = clock.next_turn(&Signals::unheard()).expect_err("an overrun");
        let RunEnd::Overrun(sentence) = ending else { panic!("{ending:?}") };
        assert!(sentence.starts_with("10 turns in a row took longer than the period of 100ms, "), "{sentence}");
    }

    #[test]
    fn the_first_output_is_at_zero() {
        let mut clock = Clock::begin(ByHand(Duration::from_secs(7)), Time::Wall, PERIOD, None);
        clock.instants.0 += Duration::from_millis(30);
        assert_eq!(clock.zero(), Nanos::ZERO);
        clock.next_turn(&Signals::unheard()).expect("no signal");
        clock.instants.0 += Duration::from_millis(35);
        assert_eq!(clock.taken(), Nanos(105_000_000));
    }

    #[test]
    fn stepped_time_is_exact() {
        let third = Duration::from_nanos(33_333_333);
        let mut clock = Clock::begin(ByHand::default(), Time::Stepped(Pace::Max), third, None);
        assert_eq!(clock.zero(), Nanos::ZERO);
        for turn in 1..=1000 {
            next_after(&mut clock, 7);
            assert_eq!(clock.taken(), Nanos(turn * 33_333_333));
        }
        assert_eq!(clock.instants.0, Duration::from_secs(7), "the fastest pace never sleeps");
    }

    #[test]
    fn a_pace_of_four_is_four_times_as_fast() {
        let mut clock = Clock::begin(ByHand::default(), Time::Stepped(Pace::Times(4.0)), PERIOD, None);
        let begins = [5, 25, 0, 24].map(|took| next_after(&mut clock, took));
        assert_eq!(begins, [25, 50, 75, 100]);
    }

    #[test]
    fn a_changed_pace_holds_from_then_on() {
        let mut clock = Clock::begin(ByHand::default(), Time::Stepped(Pace::Max), PERIOD, None);
        assert_eq!([1, 1].map(|took| next_after(&mut clock, took)), [1, 2]);
        clock.set_pace(Pace::Times(2.0));
        assert_eq!([0, 10, 60].map(|took| next_after(&mut clock, took)), [52, 102, 162]);
        clock.set_pace(Pace::Times(0.5));
        assert_eq!([0, 0].map(|took| next_after(&mut clock, took)), [362, 562]);
        assert_eq!(clock.taken(), Nanos(700_000_000));
        let mut clock = Clock::begin(ByHand::default(), Time::Wall, PERIOD, None);
        clock.set_pace(Pace::Max);
        assert_eq!(next_after(&mut clock, 30), 100, "the wall clock has one pace");
    }

    #[test]
    fn stepped_time_catches_up_a_little_lateness() {
        let mut clock = Clock::begin(ByHand::default(), Time::Stepped(Pace::Times(1.0)), PERIOD, None);
        let begins = [250, 10, 10, 10].map(|took| next_after(&mut clock, took));
        assert_eq!(begins, [250, 260, 300, 400]);
        assert_eq!(clock.taken(), Nanos(400_000_000));
    }

    #[test]
    fn a_robot_that_went_without_a_command_for_too_long_is_not_driven_on() {
        let gap = |clock: &mut Clock<ByHand>, took| {
            clock.instants.0 += Duration::from_millis(took);
            clock.next_turn(&Signals::unheard())
        };
        let second = Duration::from_secs(1);
        let mut clock = Clock::begin(ByHand::default(), Time::Wall, PERIOD, Some(second));
        assert_eq!([900, 1000].map(|took| gap(&mut clock, took)), [Ok(()), Ok(())]);
        let Err(RunEnd::Suspended { gap: 1_100_000_000, longest }) = gap(&mut clock, 1001) else { panic!("a fault") };
        assert_eq!(longest, nanos(second));
        // Of a robot that does not say.
        let mut clock = Clock::begin(ByHand::default(), Time::Wall, PERIOD, None);
        assert_eq!(gap(&mut clock, 2100), Ok(()));
        assert!(gap(&mut clock, 2101).is_err());
    }

    #[test]
    fn stepped_time_goes_on_from_now_after_a_suspension() {
        let mut clock = Clock::begin(ByHand::default(), Time::Stepped(Pace::Times(1.0)), PERIOD, None);
        let begins = [600_000, 10, 10].map(|took| next_after(&mut clock, took));
        assert_eq!(begins, [600_000, 600_100, 600_200]);
        assert_eq!(clock.taken(), Nanos(300_000_000));
    }

    #[test]
    fn a_signal_cuts_the_wait_short() {
        let signals = Signals::unheard();
        signals.raise(Signal::TERMINATE);
        for time in [Time::Wall, Time::Stepped(Pace::Times(0.001)), Time::Stepped(Pace::Max)] {
            let mut clock = Clock::begin(ByHand::default(), time, PERIOD, None);
            assert_eq!(clock.next_turn(&signals), Err(RunEnd::Signal(Signal::TERMINATE)));
            assert_eq!(clock.instants.0, Duration::ZERO);
        }
    }
}
