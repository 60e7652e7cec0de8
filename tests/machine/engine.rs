//! Tests plans that are replaced while the robot runs: when the new plan begins, its trial, and the return to the
//! previous plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::load::{self, Loaded};
use mdle_engine::{CompiledPlans, Engine, Library, NoTrial, PlanEvent, PlanFacts, PlanSource, Plans, StoredPlan, When};
use mdle_host::{Microphones, Pace, Pilot, PilotTurn, RunTerms, StopRequest, Time, Transitions};
use mdle_runtime::{Nanometers, Nanos, Turn};
use mdle_scripted::alphabet::Alphabet;
use mdle_scripted::{INTERRUPTS, LAWS, Output};
use mdle_tests::pipeline::{compile, scripted, sources};

/// Compiles and loads the plan `Main` of a text.
pub(crate) fn loaded(text: &str) -> Result<Arc<Loaded<Alphabet>>, String> {
    let machine = compile(text)?.machine;
    load::load(&machine, &sources(text), scripted()).map(Arc::new).map_err(|error| error.to_string())
}

/// A run of an engine in stepped time.
pub(crate) struct Run {
    pub(crate) engine: Engine<Alphabet>,
    pub(crate) turns: u64,
    /// Reading of the robot's odometer.
    pub(crate) way: Nanometers,
    pub(crate) journal: Vec<PlanEvent>,
}

const FIRST: &str = "{ Main (b) (Atom (a) seek) (Atom (d OR wait 1) climb) (Atom (e) idle) }";
const SECOND: &str = "{ Main (c OR wait 5) (Atom (f) drift) }";

impl Run {
    pub(crate) fn of(text: &str) -> Self {
        let terms = RunTerms {
            time: Time::Stepped(Pace::Max),
            period: Duration::from_millis(100),
            request: StopRequest::default(),
            microphones: Microphones::default(),
        };
        let engine = Engine::new(loaded(text).unwrap().plan(), &Library::new(), &terms).unwrap();
        Self { engine, turns: 0, way: Nanometers::ZERO, journal: Vec::new() }
    }

    pub(crate) fn plans(&mut self) -> &mut Plans<Alphabet> {
        self.engine.plans_mut()
    }

    /// Runs a turn in which this interrupt fires. Returns, as text, the number of the plan, the applied law, the time
    /// at which the law's atom began by the clock of its plan, and the number of inputs that the law has computed.
    pub(crate) fn turn(&mut self, interrupt: &str) -> String {
        let bit = INTERRUPTS.iter().position(|known| *known == interrupt);
        let y = Output { fired: bit.map_or(0, |bit| 1 << bit), way: self.way, ..Output::default() };
        let t = Nanos(self.turns * 100_000_000);
        let moment = PilotTurn { y: &y, t, number: self.turns };
        let turn = self.engine.turn(moment, &mut Transitions::default()).unwrap();
        self.turns += 1;
        self.journal.extend(self.engine.plans_mut().take_events());
        match turn {
            Turn::Law(input) => {
                let law = LAWS[input.law.unwrap()];
                format!("{} {law} since {} input {}", self.plans().number(), input.began.seconds(), input.computed)
            }
            Turn::Cut => "cut".to_owned(),
            Turn::Over => "over".to_owned(),
        }
    }

    /// Runs a turn after the robot has driven this distance.
    fn drive(&mut self, millimetres: u64) -> String {
        self.way = Nanometers(self.way.0 + millimetres * 1_000_000);
        self.turn("")
    }

    /// Runs turns in which no interrupt fires, and returns the result of the last one.
    pub(crate) fn turns(&mut self, count: u64) -> String {
        (0..count).map(|_| self.turn("")).last().unwrap()
    }
}

#[test]
fn now_is_the_next_turn() {
    let mut run = Run::of(FIRST);
    assert_eq!(run.turns(3), "1 seek since 0 input 3");
    let number = run.plans().replace(loaded(SECOND).unwrap().plan(), When::Now);
    assert_eq!((run.turn(""), number), ("2 drift since 0 input 1".to_owned(), 2));
    assert_eq!(run.engine.zero(), Nanos(300_000_000), "its time begins with it");
    assert_eq!(run.turn(""), "2 drift since 0 input 2");
}

#[test]
fn the_end_of_an_atom_is_the_first_turn_of_the_next_plan() {
    let mut run = Run::of(FIRST);
    run.turns(2);
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::AtomEnds);
    assert_eq!(run.turns(2), "1 seek since 0 input 4");
    assert_eq!(run.turn("a"), "2 drift since 0 input 1");
    assert_eq!(run.journal, [PlanEvent::Armed(2), PlanEvent::Began(2)]);
}

#[test]
fn the_end_of_a_plan_is_the_first_turn_of_the_next() {
    let mut run = Run::of(FIRST);
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::PlanEnds);
    assert_eq!([run.turn("a"), run.turn("")], ["1 climb since 0 input 1", "1 climb since 0 input 2"]);
    assert_eq!(run.turn("b"), "2 drift since 0 input 1");
    assert_eq!(run.turn("c"), "over");
}

#[test]
fn a_plan_that_is_rolled_back_to_has_lost_no_time() {
    let mut run = Run::of(FIRST);
    run.turn("a");
    assert_eq!(run.turns(3), "1 climb since 0 input 4");
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::Now);
    assert_eq!(run.turns(20), "2 drift since 0 input 20");
    run.engine.rollback("asked for").unwrap();
    // The plan continues with its turn at 0.4 s, with a new law.
    assert_eq!(run.turn(""), "1 climb since 0.4 input 1");
    assert_eq!(run.turns(5), "1 climb since 0.4 input 6");
    // The atom ends 1 s after it began.
    assert_eq!(run.turn(""), "1 idle since 1 input 1");
    assert_eq!(run.engine.rollback("again"), Err(NoTrial));
    let back = PlanEvent::RolledBack { from: 2, to: 1, why: "asked for".to_owned() };
    assert_eq!(run.journal, [PlanEvent::Armed(2), PlanEvent::Began(2), back]);
}

#[test]
fn the_way_of_another_plan_does_not_count() {
    let mut run = Run::of("{ Main (b) (Atom (way >= 1m) seek) (Atom (null) climb) }");
    assert_eq!([run.drive(0), run.drive(300)], ["1 seek since 0 input 1", "1 seek since 0 input 2"]);
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::Now);
    // The distance until the first output of the new plan still belongs to the previous plan, whose last input caused
    // it.
    assert_eq!([run.drive(300), run.drive(5000)], ["2 drift since 0 input 1", "2 drift since 0 input 2"]);
    run.engine.rollback("asked for").unwrap();
    assert_eq!([run.drive(5000), run.drive(399)], ["1 seek since 0.2 input 1", "1 seek since 0.2 input 2"]);
    assert_eq!(run.drive(1), "1 climb since 0.4 input 1");
}

#[test]
fn a_trial_ends_after_its_time() {
    let mut run = Run::of(FIRST);
    run.plans().set_trial(Nanos(500_000_000));
    run.turn("");
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::Now);
    run.turns(5);
    assert_eq!(run.journal, [PlanEvent::Armed(2), PlanEvent::Began(2)]);
    run.turn("");
    assert_eq!(run.journal.last(), Some(&PlanEvent::Accepted(2)));
    assert_eq!(run.engine.rollback("too late"), Err(NoTrial));
}

#[test]
fn a_plan_can_replace_itself_in_every_turn() {
    let mut run = Run::of(FIRST);
    let plan = loaded(SECOND).unwrap();
    for number in 2..50 {
        run.plans().replace(plan.plan(), When::Now);
        assert_eq!(run.turn(""), format!("{number} drift since 0 input 1"));
    }
}

/// Compiles the plan `Main` of a text.
fn compiled(source: &PlanSource) -> Result<CompiledPlans<Alphabet>, String> {
    let PlanSource::Text(text) = source else { return Err("there is no such file".to_owned()) };
    let (files, facts) = ([("main".to_owned(), text.clone())].into(), PlanFacts::default());
    let plan = StoredPlan { name: "Main".into(), files, loaded: loaded(text)?, facts };
    Ok(CompiledPlans { plans: vec![plan], warnings: String::new() })
}

fn typed(text: &str) -> PlanSource {
    PlanSource::Text(text.to_owned())
}

/// Runs turns until the compiler has answered; returns the answer.
fn answer(run: &mut Run) -> PlanEvent {
    loop {
        run.turn("");
        if let Some(answer) = run.journal.pop() {
            return answer;
        }
        std::thread::yield_now();
    }
}

#[test]
fn a_text_is_compiled_beside_the_turns() {
    let mut run = Run::of(FIRST);
    run.plans().compile_with(Box::new(compiled)).unwrap();
    let number = run.plans().swap(typed("{ Main (a) (Atom (wiat 1) seek) }"), When::Now);
    let PlanEvent::Refused(2, diagnostics) = answer(&mut run) else { panic!("{:?}", run.journal) };
    assert!(number == 2 && diagnostics.contains("there is no interrupt called `wiat`"), "{diagnostics}");
    let now = Nanos(run.turns * 100_000_000).seconds();
    assert_eq!(run.turn("a"), format!("1 climb since {now} input 1"), "the plan before goes on");
    run.plans().swap(typed(SECOND), When::Now);
    assert_eq!(answer(&mut run), PlanEvent::Armed(3));
    assert_eq!(run.turn(""), "2 drift since 0 input 1");
    assert_eq!(run.plans().stored().map(|plan| &*plan.name).collect::<Vec<_>>(), ["Main"], "and it is stored");
}

#[test]
fn a_request_can_be_cancelled() {
    let mut run = Run::of(FIRST);
    run.turn("");
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::AtomEnds);
    run.plans().cancel();
    assert_eq!(run.turn("a"), "1 climb since 0.1 input 1");
    assert_eq!(run.journal, [PlanEvent::Armed(2), PlanEvent::Cancelled(2)]);
    // A newer request replaces an older one.
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::PlanEnds);
    run.plans().replace(loaded(SECOND).unwrap().plan(), When::Now);
    assert_eq!(run.turn(""), "2 drift since 0 input 1");
}
