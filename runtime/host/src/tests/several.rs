//! Several runs: what is said of them, whatever the number of threads, and what a signal leaves.

use std::num::{NonZeroU64, NonZeroUsize};
use std::time::Duration;

use mdle_runtime::{Cause, Robot};

use super::plan::ToyPlan;
use super::toy::Sensed;
use crate::batch::{self, Batch, Terms};
use crate::signals::{Signal, Signals};
use crate::turns::Limits;
use crate::{Hosted, Judgement};

/// A robot whose run is decided by its seed: the plan's outermost interrupt fires in turn `seed`, if ever.
struct Seeded {
    seed: u64,
    exchanges: u64,
    signals: Option<Signals>,
}

impl Robot for Seeded {
    type Output = Sensed;
    type Input = u32;
    type Error = &'static str;

    fn exchange(&mut self, _: &u32) -> Result<Sensed, &'static str> {
        self.exchanges += 1;
        if let Some(signals) = self.signals.as_ref().filter(|_| self.seed == 4) {
            signals.raise(Signal::INTERRUPT);
        }
        match (self.seed % 9, self.exchanges == self.seed) {
            (6, true) => Err("a wheel came off"),
            (7, true) => panic!("seven"),
            (8, _) | (_, false) => Ok(Sensed::default()),
            (_, true) => Ok(Sensed(vec![(0, Cause::Fired(0))])),
        }
    }

    fn stop(&mut self) -> Result<(), &'static str> {
        if self.seed == 13 { Err("no brakes") } else { Ok(()) }
    }
}

impl Hosted for Seeded {
    fn judged(&self) -> Judgement {
        match self.seed % 9 {
            2 => Judgement::Bumped,
            3 => Judgement::Astray("in the \"yard\"".to_owned()),
            _ => Judgement::Arrived,
        }
    }

    fn contacts(&self) -> u64 {
        self.seed % 3
    }
}

/// The status of runs with the seeds from `first` on, and what is said of them.
fn runs(first: u64, runs: u64, jobs: usize, json: bool, signals: &Signals) -> (u8, String) {
    let heard = signals.share();
    let heard = std::sync::Mutex::new(heard);
    let batch = Batch {
        first,
        runs: NonZeroU64::new(runs).unwrap(),
        jobs: NonZeroUsize::new(jobs).unwrap(),
        json,
        robot: Box::new(move |seed| {
            let signals = Some(heard.lock().unwrap().share());
            if seed == 14 { Err("no room".to_owned()) } else { Ok(Seeded { seed, exchanges: 0, signals }) }
        }),
        alone: Box::new(|seed| ["--world", "my floor.toml", "--seed", &seed.to_string()].map(str::to_owned).into()),
    };
    let limits = Limits { timeout: None, turns: Some(100) };
    let terms = Terms { period: Duration::from_millis(100), limits, signals, program: "./it's" };
    let mut out = Vec::new();
    let (status, unwritten) = batch::run(&batch, &ToyPlan::lab, &terms, &mut out, None);
    assert!(unwritten.is_none());
    (status, String::from_utf8(out).unwrap())
}

#[test]
fn every_way_to_miss_is_told_with_the_command_to_see_it() {
    let (status, said) = runs(5, 10, 1, false, &Signals::unheard());
    assert_eq!(status, 3);
    insta::assert_snapshot!(said);
}

#[test]
fn json_tells_of_each_run() {
    let (status, said) = runs(9, 4, 1, true, &Signals::unheard());
    assert_eq!(status, 1);
    insta::assert_snapshot!(said);
}

#[test]
fn the_status_says_whether_all_arrived() {
    let status = |first, count| runs(first, count, 2, false, &Signals::unheard()).0;
    assert_eq!([status(18, 2), status(18, 4), status(24, 1)], [0, 1, 3]);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for json in [false, true] {
        let once = runs(15, 200, 1, json, &Signals::unheard());
        for jobs in [2, 3, 64] {
            assert_eq!(runs(15, 200, jobs, json, &Signals::unheard()), once);
        }
    }
}

#[test]
fn a_signal_ends_the_batch_and_what_was_done_is_told() {
    let signals = Signals::unheard();
    // Listens, as a process does.
    let (status, said) = runs(1, 50, 1, false, &signals);
    assert_eq!(status, 130);
    assert!(said.starts_with("3 of 50 runs, seeds 1 to 50: 1 arrived, 1 bumped, 1 astray\n"), "{said}");
}
