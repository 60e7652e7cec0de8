//! Tests several runs: their report, which is equal for any number of threads, and the report after a signal.

use std::num::{NonZeroU64, NonZeroUsize};
use std::time::Duration;

use clap::Command;
use mdle_runtime::{Cause, Robot};

use super::plan::ToyPlan;
use super::toy::Sensed;
use crate::cycle::RunLimits;
use crate::drive::PilotOnRobot;
use crate::helm::Helm;
use crate::pilot::PlanAlone;
use crate::required::{self, Required};
use crate::runs::{self, BatchRuns, CommonTerms};
use crate::signals::{ProcessSignal, Signals};
use crate::turn_watch::TurnWatch;
use crate::{Batch, Judgement, Observer};

/// A robot whose run depends on its seed: the plan's outermost interrupt fires in turn `seed`, or never.
struct Seeded {
    seed: u64,
    exchanges: u64,
    signals: Option<Signals>,
    has_goal: bool,
}

impl Robot for Seeded {
    type Output = Sensed;
    type Input = u32;
    type Error = &'static str;

    fn exchange(&mut self, _: &u32) -> Result<Sensed, &'static str> {
        self.exchanges += 1;
        if let Some(signals) = self.signals.as_ref().filter(|_| self.seed == 4) {
            signals.raise(ProcessSignal::INTERRUPT);
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

impl Observer for Seeded {
    fn judged(&self) -> Option<Judgement> {
        self.has_goal.then(|| match self.seed % 9 {
            2 => Judgement::Bumped,
            3 => Judgement::Astray(format!("({}, 0) in the \"yard\"", self.seed)),
            _ => Judgement::Arrived,
        })
    }

    fn contacts(&self) -> u64 {
        self.seed % 3
    }
}

/// A batch with the seeds from `first` on.
#[derive(Clone, Copy)]
struct Several {
    first: u64,
    runs: u64,
    jobs: usize,
    json: bool,
    has_goal: bool,
    require: &'static [&'static str],
}

/// Five runs with a goal.
const FIVE: Several = Several { first: 1, runs: 5, jobs: 1, json: false, has_goal: true, require: &[] };

impl Several {
    /// Runs the batch; returns its exit status and its summary.
    fn run(self, signals: &Signals) -> (u8, String) {
        let Self { first, runs, jobs, json, has_goal, require } = self;
        let heard = signals.share();
        let heard = std::sync::Mutex::new(heard);
        let batch = Batch {
            first,
            runs: NonZeroU64::new(runs).unwrap(),
            jobs: NonZeroUsize::new(jobs).unwrap(),
            json,
            robot: Box::new(move |seed| {
                let signals = Some(heard.lock().unwrap().share());
                let robot = Seeded { seed, exchanges: 0, signals, has_goal };
                if seed == 14 { Err("no room".to_owned()) } else { Ok(robot) }
            }),
            alone: Box::new(|seed| ["--world", "my floor.toml", "--seed", &seed.to_string()].map(str::to_owned).into()),
        };
        let runs = BatchRuns::of(batch, |robot| {
            let pilot = PlanAlone::new(&ToyPlan::lab);
            Ok(Box::new(PilotOnRobot::new(robot, Some(|robot| robot), None, Helm::new(pilot, None))))
        });
        let limits = RunLimits { timeout: None, turns: Some(100) };
        let words = ["it"].iter().chain(require).copied();
        let matches = required::argument(Command::new("it")).try_get_matches_from(words).unwrap();
        let required = Required::of(&matches, &ToyPlan::lab()).unwrap();
        let period = Duration::from_millis(100);
        let watch = &TurnWatch::default();
        let terms = CommonTerms { period, limits, signals, watch, program: r"'./it'\''s'", required: &required };
        let mut out = Vec::new();
        let (status, unwritten) = runs::run(&runs, &terms, &mut out, None);
        assert!(unwritten.is_none());
        (status, String::from_utf8(out).unwrap())
    }
}

#[test]
fn runs_that_went_alike_are_a_line_with_a_command() {
    let (status, summary) = Several { first: 5, runs: 20, ..FIVE }.run(&Signals::unheard());
    assert_eq!(status, 3);
    insta::assert_snapshot!(summary);
}

#[test]
fn without_a_goal_runs_are_grouped_by_their_cause() {
    let (status, summary) = Several { first: 16, runs: 8, has_goal: false, ..FIVE }.run(&Signals::unheard());
    assert_eq!(status, 3);
    insta::assert_snapshot!(summary, @r#"
    8 runs, seeds 16 to 23: 6 ended, 1 timed out, 1 failed
    time: median 1.9 s, worst 2.2 s (seed 23)
    9 contacts in 6 runs

    1 failed: a panic, which is a bug: seven; seed 16 at 1.5 s
      './it'\''s' --world 'my floor.toml' --seed 16

    1 timed out; seed 17 at 9.9 s
      './it'\''s' --world 'my floor.toml' --seed 17

    6 ended by bumper (Lab); the first is seed 18 at 1.7 s
      './it'\''s' --world 'my floor.toml' --seed 18
    "#);
}

#[test]
fn a_run_that_ends_otherwise_is_counted_as_such() {
    let required =
        |require, has_goal| Several { first: 18, runs: 4, has_goal, require, ..FIVE }.run(&Signals::unheard());
    insta::assert_snapshot!(required(&["--require", "completed"], true).1, @r#"
    4 runs, seeds 18 to 21: 4 ended otherwise
    3 contacts in 2 runs

    4 ended otherwise, plan over: bumper (Lab); the first is seed 18 at 1.7 s
      './it'\''s' --world 'my floor.toml' --seed 18
    "#);
    let statuses = [(&["--require", "bumper"][..], false), (&["--require=heard \"stop\"", "--require=Lab"], false)];
    assert_eq!(statuses.map(|(require, has_goal)| required(require, has_goal).0), [0, 0]);
    assert_eq!(required(&["--require", "completed"], false).0, 1);
}

#[test]
fn json_tells_of_each_run() {
    let (status, json) = Several { first: 9, runs: 4, json: true, ..FIVE }.run(&Signals::unheard());
    assert_eq!(status, 1);
    insta::assert_snapshot!(json);
}

#[test]
fn the_status_says_whether_all_arrived() {
    let status = |first, runs| Several { first, runs, jobs: 2, ..FIVE }.run(&Signals::unheard()).0;
    assert_eq!([status(18, 2), status(18, 4), status(24, 1)], [0, 1, 3]);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for (json, has_goal) in [(false, true), (true, true), (false, false)] {
        let batch = Several { first: 15, runs: 200, json, has_goal, ..FIVE };
        let once = batch.run(&Signals::unheard());
        for jobs in [2, 3, 64] {
            assert_eq!(Several { jobs, ..batch }.run(&Signals::unheard()), once);
        }
    }
}

#[test]
fn a_signal_ends_the_batch_with_a_summary() {
    let signals = Signals::unheard();
    // This record can receive the signal that one of the runs raises.
    let (status, summary) = Several { runs: 50, ..FIVE }.run(&signals);
    assert_eq!(status, 130);
    assert!(summary.starts_with("3 of 50 runs, seeds 1 to 50: 1 arrived, 1 bumped, 1 astray\n"), "{summary}");
}
