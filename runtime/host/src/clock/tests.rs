//! Tests the clock with a time that each test advances by hand.

use super::*;
use crate::signals::ProcessSignal;

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

/// Returns the real time, in milliseconds, at which the next turn begins if the current turn takes `took` milliseconds.
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
    assert_eq!(clock.timing().map(|timing| timing.lateness().missed), Some(3));
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
    // Clock of a robot that gives no maximum time without a command.
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
    signals.raise(ProcessSignal::TERMINATE);
    for time in [Time::Wall, Time::Stepped(Pace::Times(0.001)), Time::Stepped(Pace::Max)] {
        let mut clock = Clock::begin(ByHand::default(), time, PERIOD, None);
        assert_eq!(clock.next_turn(&signals), Err(RunEnd::Signal(ProcessSignal::TERMINATE)));
        assert_eq!(clock.instants.0, Duration::ZERO);
    }
}
