//! Tests supervisors: the inputs that are passed to them, the breaks at which they are called, and how they end a run.

use mdle_runtime::Cause::Fired;
use mdle_runtime::Nanos;

use super::toy::{Act, Alone, Makes, Run, Sensed, Stage};
use crate::{Break, BreakOrders, Intervention, LimitedQuantity, Pace, RunTerms, Supervisor, Time, Verdict};

/// A supervisor that adds 10 to each input, replaces the input by 0 in one turn, and ends the run at a break.
#[derive(Default)]
struct Strict {
    verdict: Option<(u64, Verdict)>,
    end: Option<u64>,
    pace: Option<Pace>,
    turn: u64,
    requests: Vec<String>,
}

impl Supervisor<Alone> for Strict {
    fn filter(&mut self, asked: u32, _: &Sensed, t: Nanos) -> u32 {
        self.turn = t.0 / 100_000_000;
        if Supervisor::intervention(self).is_some() { 0 } else { asked + 10 }
    }

    fn intervention(&self) -> Option<Intervention<'_>> {
        let (turn, verdict) = self.verdict?;
        (turn == self.turn).then_some(Intervention { verdict, rule: "rule", limited: None })
    }

    fn at_break(&mut self, moment: &mut Break<'_, Alone>) -> BreakOrders {
        let is_begun = moment.position().is_some();
        assert_eq!((is_begun, moment.t.0), (moment.turns > 0, moment.turns.saturating_sub(1) * 100_000_000));
        BreakOrders { pace: self.pace.take(), end: self.end == Some(moment.turns) }
    }

    fn take_requests(&mut self) -> Vec<String> {
        std::mem::take(&mut self.requests)
    }
}

/// Returns a supervisor with this verdict on turn 1.
fn strict(verdict: Verdict) -> Box<dyn Supervisor<Alone>> {
    Box::new(Strict { verdict: Some((1, verdict)), ..Strict::default() })
}

fn run(supervisor: Makes, arguments: &[&str]) -> Run {
    let quiet = || Act::Senses(vec![]);
    let script = [quiet(), quiet(), quiet(), Act::Senses(vec![(0, Fired(0))])];
    Stage { supervisor: Some(supervisor), ..Stage::script(script) }.run(arguments)
}

/// Returns the robot's journal, the report, the exit status and standard error, for a snapshot.
fn shown(run: &Run) -> String {
    format!("{}\n{}status {}\n{}", run.journal, run.out, run.status, run.err)
}

#[test]
fn every_input_but_the_first_passes_the_supervisor() {
    let run = run(|_| Box::new(Strict::default()), &[]);
    insta::assert_snapshot!(shown(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 11, exchange 11, exchange 11, exchange 10, stop, finish
    0.3 s  plan over: bumper (Lab)
    status 0
    ");
}

#[test]
fn a_hold_is_reported_when_it_begins_and_ends() {
    let run = run(|_| strict(Verdict::Held), &[]);
    insta::assert_snapshot!(shown(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 11, exchange 0, exchange 11, exchange 10, stop, finish
    0.1 s  safety: rule holds the robot
    0.2 s  safety: the plan goes on
    0.3 s  plan over: bumper (Lab)
    status 0
    ");
}

/// A supervisor that holds the robot in these turns.
struct Flickers {
    turns: &'static [u64],
    turn: u64,
}

impl Supervisor<Alone> for Flickers {
    fn filter(&mut self, asked: u32, _: &Sensed, t: Nanos) -> u32 {
        self.turn = t.0 / 100_000_000;
        asked
    }

    fn intervention(&self) -> Option<Intervention<'_>> {
        let is_held = self.turns.contains(&self.turn);
        is_held.then_some(Intervention { verdict: Verdict::Held, rule: "rule", limited: None })
    }
}

#[test]
fn a_rule_that_holds_again_and_again_is_reported_thrice() {
    let supervisor = |_: &RunTerms| -> Box<dyn Supervisor<Alone>> {
        Box::new(Flickers { turns: &[1, 3, 5, 6, 8, 10, 12, 112], turn: 0 })
    };
    let quiet = (0..114).map(|_| Act::Senses(vec![]));
    let script = quiet.chain([Act::Senses(vec![(0, Fired(0))])]);
    let run = Stage { supervisor: Some(supervisor), ..Stage::script(script) }.run(&[]);
    insta::assert_snapshot!(run.out, @"
    0.1 s  safety: rule holds the robot
    0.2 s  safety: the plan goes on
    0.3 s  safety: rule holds the robot
    0.4 s  safety: the plan goes on
    0.5 s  safety: rule holds the robot, again and again: reported anew once it has paused for 10 s
    11.2 s  safety: rule holds the robot
    11.3 s  safety: the plan goes on
    11.4 s  plan over: bumper (Lab)
    ");
}

#[test]
fn a_plan_that_is_over_does_not_go_on() {
    let held = |_: &RunTerms| -> Box<dyn Supervisor<Alone>> {
        Box::new(Strict { verdict: Some((2, Verdict::Held)), ..Strict::default() })
    };
    insta::assert_snapshot!(shown(&run(held, &[])), @"
    exchange 0, began 1 go 20 0 at 0, exchange 11, exchange 11, exchange 0, exchange 10, stop, finish
    0.2 s  safety: rule holds the robot
    0.3 s  plan over: bumper (Lab)
    status 0
    ");
}

#[test]
fn a_limit_is_reported_with_its_values() {
    let limited = LimitedQuantity { name: "speed", unit: "m/s", asked: 0.600_04, sent: -0.000_1 };
    let reported = |rule| Intervention { verdict: Verdict::Limited, rule, limited: Some(limited) }.to_string();
    assert_eq!(reported("speed"), "speed 0.6 m/s limited to 0 m/s");
    assert_eq!(reported("acceleration"), "acceleration limits speed 0.6 m/s to 0 m/s");
}

#[test]
fn a_supervisor_ends_the_plan() {
    let run = run(|_| strict(Verdict::Ended), &[]);
    insta::assert_snapshot!(shown(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 11, exchange 0, stop, finish
    0.1 s  safety: rule ends the plan
    status 6
    stopped by the safety rules: rule
    ");
}

#[test]
fn a_supervisor_replaces_the_plan() {
    let run = run(|_| strict(Verdict::Diverted(0)), &[]);
    insta::assert_snapshot!(shown(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 11, exchange 0, began 1 go 20 0 at 0.2, exchange 11, exchange 10, stop, finish
    0.1 s  safety: rule replaces the plan
    0.2 s  go 20 0  <- safety: rule
    0.3 s  plan over: bumper (Lab)
    status 6
    stopped by the safety rules: rule
    ");
}

#[test]
fn a_run_ends_at_a_break_if_the_supervisor_asks() {
    let ended = run(|_| Box::new(Strict { end: Some(0), ..Strict::default() }), &[]);
    insta::assert_snapshot!(shown(&ended), @"
    exchange 0, exchange 10, stop, finish
    status 0
    ");
    let ended = run(|_| Box::new(Strict { end: Some(2), ..Strict::default() }), &[]);
    insta::assert_snapshot!(shown(&ended), @"
    exchange 0, began 1 go 20 0 at 0, exchange 11, exchange 10, stop, finish
    status 0
    ");
}

#[test]
fn a_supervisor_changes_the_pace() {
    let slow = |terms: &RunTerms| -> Box<dyn Supervisor<Alone>> {
        assert_eq!((terms.period.as_millis(), terms.time), (100, Time::Stepped(Pace::Max)));
        Box::new(Strict { pace: Some(Pace::Times(0.5)), ..Strict::default() })
    };
    assert_eq!(run(slow, &[]).slept.as_millis(), 600);
}

/// Returns the log of a run with this supervisor.
fn log(test: &str, supervisor: Makes) -> String {
    let log = std::env::temp_dir().join(format!("mdle-{test}-{}", std::process::id()));
    run(supervisor, &["--log", log.to_str().expect("a temporary folder of letters")]);
    let lines = std::fs::read_to_string(&log).expect("a log");
    std::fs::remove_file(&log).expect("a log");
    lines
}

#[test]
fn a_log_has_interventions() {
    insta::assert_snapshot!(log("a_log_has_interventions", |_| strict(Verdict::Limited)), @r#"
    {"turn":0,"t":0.0,"state":1,"law":"go 20 0","fired":[]}
    {"turn":1,"t":0.1,"state":1,"law":"go 20 0","fired":[],"safety":{"verdict":"limited","rule":"rule"}}
    {"turn":2,"t":0.2,"state":1,"law":"go 20 0","fired":[]}
    {"turn":3,"t":0.3,"state":5,"law":null,"fired":[{"from":1,"level":0,"by":"bumper","operands":[]}]}
    "#);
}

#[test]
fn a_log_has_the_requests_before_a_turn() {
    let asked = |_: &RunTerms| -> Box<dyn Supervisor<Alone>> {
        let requests = ["set /a \"b\"", "call /c"].map(str::to_owned).to_vec();
        Box::new(Strict { requests, ..Strict::default() })
    };
    let lines = log("a_log_has_the_requests_before_a_turn", asked);
    let [first, second] = [0, 1].map(|line| lines.lines().nth(line).expect("two turns"));
    assert!(first.ends_with(r#","fired":[],"requests":["set /a \"b\"","call /c"]}"#), "{first}");
    assert!(second.ends_with(r#","fired":[]}"#), "{second}");
}

#[test]
fn a_log_has_the_number_of_a_second_plan() {
    insta::assert_snapshot!(log("a_log_has_the_number_of_a_second_plan", |_| strict(Verdict::Diverted(0))), @r#"
    {"turn":0,"t":0.0,"state":1,"law":"go 20 0","fired":[]}
    {"turn":1,"t":0.1,"state":1,"law":"go 20 0","fired":[],"safety":{"verdict":"diverted","rule":"rule"}}
    {"turn":2,"t":0.2,"state":1,"law":"go 20 0","fired":[],"plan":2}
    {"turn":3,"t":0.3,"state":5,"law":null,"fired":[{"from":1,"level":0,"by":"bumper","operands":[]}],"plan":2}
    "#);
}
