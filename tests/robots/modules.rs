//! Tests plans that read modules: a robot follows the attributes that a module publishes, and without published values
//! the plan ends or never begins.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::compile;
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::load::{self, Loaded, LoadedPlan};
use mdle_engine::{
    Background, Declare, Engine, EngineAlphabet, Exchange, Fault, In, Library, Module, ModuleState, Modules, Out,
    PlanEvent, Relevance, Turn, When,
};
use mdle_host::{Microphones, Pace, Pilot, PilotFault, PilotTurn, Refusal, RunTerms, StopRequest, Time, Transitions};
use mdle_runtime::{self as runtime, Meters, Nanos, Pose, Radians, Robot, Sensed, Turn as PlanTurn, Twist};
use mdle_sim::alphabet::Alphabet;
use mdle_sim::{Simulated, World};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::golden;

pub(super) const PERIOD: Duration = Duration::from_millis(100);
/// A plan that drives to the point that the module `heading` publishes.
const FOLLOW: &str = "{ Sound (bumper OR age(heading module) > 5s)
  (Atom (range(heading module) < 60cm) goAvoid(heading module))
  (Atom (wait 1) stop)
}";
/// Place of the sound source, in metres.
const SOURCE: (f64, f64) = (3.0, 1.0);

/// A module that publishes the pose of the robot.
struct Place(Out<Pose>);

impl Module<Sensed> for Place {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        turn.publish(self.0, turn.y.odometry);
        Ok(())
    }
}

/// A background module that publishes the bearing and range of the sound source with a delay.
struct Ears {
    place: In<Pose>,
    bearing: Out<Radians>,
    range: Out<Meters>,
}

impl Background for Ears {
    fn run(self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        let Self { place, bearing, range } = *self;
        let hear = move |offer: &mut mdle_engine::Offer<'_>| {
            let Some(pose) = offer.get(place) else { return };
            let (x, y) = (SOURCE.0 - pose.x.0, SOURCE.1 - pose.y.0);
            offer.publish(bearing, Radians(libm::atan2(y, x) - pose.theta.0).wrapped());
            offer.publish(range, Meters(libm::hypot(x, y)));
        };
        while exchange.exchange(hear).is_ok() {}
        Ok(())
    }
}

/// A module that publishes new values of `ears`.
struct Heading {
    heard: (In<Radians>, In<Meters>),
    bearing: Out<Radians>,
    range: Out<Meters>,
}

impl Module<Sensed> for Heading {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let (bearing, range) = self.heard;
        if let (Some(bearing), Some(range)) = (turn.get(bearing), turn.get(range)) {
            turn.publish(self.bearing, bearing);
            turn.publish(self.range, range);
        }
        Ok(())
    }
}

/// Returns the modules that make a robot follow a sound.
fn followers() -> Library<Sensed> {
    let mut library = Library::new();
    library.registered("place", |declare| Place(declare.publishes("pose")));
    library.background("ears", |declare| {
        declare.latency(Nanos(150_000_000));
        Ears {
            place: declare.reads("place", "pose"),
            bearing: declare.publishes("bearing"),
            range: declare.publishes("range"),
        }
    });
    library.registered("heading", |declare| {
        declare.relevance(Relevance::WhenRead);
        Heading {
            heard: (declare.reads("ears", "bearing"), declare.reads("ears", "range")),
            bearing: declare.publishes("bearing"),
            range: declare.publishes("range"),
        }
    });
    library
}

/// Compiles and loads the only plan of a text.
pub(super) fn loaded<A: runtime::Alphabet>(text: &str) -> Arc<Loaded<A>> {
    let alphabet = golden::alphabet(Some("sim"));
    let mut sources = Sources::default();
    let (mut compiled, found) = compile(sources.add("plan.mdle", text), text, &alphabet, None);
    let machine = compiled.pop().unwrap_or_else(|| panic!("{found:?}")).machine;
    load::load(&machine, &sources, &alphabet).map(Arc::new).unwrap()
}

/// A simulated robot in the hall, and the engine that drives it.
pub(super) struct Run<A: EngineAlphabet = Alphabet> {
    robot: Simulated,
    pub(super) engine: Engine<A>,
    pub(super) input: Twist,
    /// Pose of the robot by odometry.
    place: Pose,
    pub(super) turns: u64,
}

impl Run {
    fn of(text: &str, library: &Library<Sensed>) -> Self {
        Self::begin(text, library, Time::Stepped(Pace::Max)).unwrap()
    }
}

impl<A: EngineAlphabet<Output = Sensed, Input = Twist>> Run<A> {
    pub(super) fn begin(text: &str, library: &Library<Sensed>, time: Time) -> Result<Self, Refusal> {
        let world = World::named("hall").unwrap().unwrap();
        let robot = Simulated::new(&world, world.start, Some(3), PERIOD).unwrap();
        let terms =
            RunTerms { time, period: PERIOD, request: StopRequest::default(), microphones: Microphones::default() };
        let engine = Engine::new(loaded::<A>(text).plan(), library, &terms)?;
        Ok(Self { robot, engine, input: Twist::default(), place: Pose::ORIGIN, turns: 0 })
    }

    pub(super) fn turn(&mut self) -> Result<PlanTurn<Twist>, PilotFault> {
        let y = self.robot.exchange(&self.input).unwrap();
        self.place = y.odometry;
        let t = Nanos(self.turns * 100_000_000);
        let moment = PilotTurn { y: &y, t, number: self.turns };
        let turn = self.engine.turn(moment, &mut Transitions::default())?;
        self.turns += 1;
        self.input = turn.input();
        Ok(turn)
    }

    /// Replaces the plan at once, as a safety rule does.
    pub(super) fn divert(&mut self, plan: LoadedPlan<A>) {
        let y = self.robot.exchange(&self.input).unwrap();
        let t = Nanos(self.turns * 100_000_000);
        self.engine.divert(plan, PilotTurn { y: &y, t, number: self.turns });
    }

    /// Drives until the plan is over, for at most a minute, and returns the inputs.
    fn drive(&mut self) -> Vec<Twist> {
        let mut inputs = Vec::new();
        while self.turns < 600 {
            match self.turn().unwrap() {
                PlanTurn::Over => return inputs,
                PlanTurn::Law(_) | PlanTurn::Cut => inputs.push(self.input),
            }
        }
        panic!("the plan goes on")
    }

    fn distance(&self) -> f64 {
        libm::hypot(SOURCE.0 - self.place.x.0, SOURCE.1 - self.place.y.0)
    }
}

#[test]
fn a_robot_follows_what_a_module_publishes() {
    let mut run = Run::of(FOLLOW, &followers());
    let inputs = run.drive();
    assert!(run.distance() < 0.6, "{} m away after {} turns", run.distance(), run.turns);
    // The ears read the pose from break 2 on and publish at break 4, 150 ms later; the heading publishes at break 5.
    let first = inputs.iter().position(|input| *input != Twist::default());
    assert_eq!(first, Some(6));
    assert_eq!(run.engine.zero(), Nanos(600_000_000), "the plan's time begins with it");
    // The threads of background modules do not affect the result.
    assert_eq!(Run::of(FOLLOW, &followers()).drive(), inputs);
}

#[test]
fn a_plan_that_waits_in_vain_never_begins() {
    let mut run = Run::of(FOLLOW, &Library::new());
    let fault = std::iter::repeat_with(|| run.turn()).find_map(Result::err).unwrap();
    let sentence = "the plan reads /usr/heading/bearing and /usr/heading/range, which no module has published within 2 s\n\
                    help: no module `heading` is loaded: `--module heading=COMMAND` loads one";
    assert_eq!((fault, run.turns, run.input), (PilotFault::Stopped(sentence.into()), 20, Twist::default()));
}

/// A module that publishes a range until a certain turn, and a bearing in all turns.
struct Echo {
    range: Out<Meters>,
    bearing: Out<Radians>,
    until: u64,
}

impl Module<Sensed> for Echo {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        if turn.number < self.until {
            turn.publish(self.range, Meters(1.0));
        }
        turn.publish(self.bearing, Radians(0.0));
        Ok(())
    }
}

/// Returns a library with a module `echo`, which publishes no range from the turn `until` on.
fn echo(until: u64) -> Library<Sensed> {
    let mut library = Library::new();
    let make = move |declare: &mut Declare| Echo {
        range: declare.publishes("range"),
        bearing: declare.publishes("bearing"),
        until,
    };
    library.registered("echo", make);
    library
}

#[test]
fn an_age_is_that_of_what_the_plan_reads() {
    let over = |interrupt: &str| {
        let plan = format!("{{ Listen ({interrupt}) (Atom (null) (go 1 0)) }}");
        let mut run = Run::of(&plan, &echo(20));
        (0..60).find(|_| run.turn().unwrap() == PlanTurn::Over).map(|_| run.turns)
    };
    // The last range is published at the break of turn 19.
    assert_eq!(over("age(echo module) > 500ms OR range(echo module) < 1cm"), Some(26));
    assert_eq!(over("age(echo module) > 500ms OR bearing(echo module) > 90deg"), None);
    assert_eq!(over("age(echo module) > 500ms"), None, "the module still publishes");
}

#[test]
fn a_plan_that_waits_in_vain_names_the_modules() {
    let fault = |plan: &str| {
        let mut run = Run::of(&format!("{{ Wait ({plan}) (Atom (null) stop) }}"), &echo(0));
        match std::iter::repeat_with(|| run.turn()).find_map(Result::err).unwrap() {
            PilotFault::Stopped(sentence) => sentence,
            PilotFault::Panicked(message) => panic!("{message}"),
        }
    };
    let faults = ["range(ecko module) < 1m", "range(echo module) < 1m", "age(nose module) > 1s"].map(fault);
    insta::assert_snapshot!(faults.join("\n"), @"
    the plan reads /usr/ecko/range, which no module has published within 2 s; did you mean `echo`?
    help: no module `ecko` is loaded: `--module ecko=COMMAND` loads one; `range` is published by `echo`
    the plan reads /usr/echo/range, which no module has published within 2 s
    help: a module in the background that needs longer declares its `latency`, and the plan waits 2 s longer than that; if the module publishes only while the robot moves, or only what it hears or sees, begin with another plan and `swap` this one in
    the plan reads /usr/nose/age, which no module has published within 2 s
    help: no module `nose` is loaded: `--module nose=COMMAND` loads one
    ");
}

/// Returns a library with a module `heading` whose bearing is not an angle.
fn wrong() -> Library<Sensed> {
    struct Wrong;
    impl Module<Sensed> for Wrong {
        fn turn(&mut self, _: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
            Ok(())
        }
    }
    let mut library = Library::new();
    library.registered("heading", |declare: &mut Declare| {
        let _: Out<Meters> = declare.publishes("bearing");
        Wrong
    });
    library
}

#[test]
fn a_plan_and_a_module_agree_on_kinds() {
    let refusal = Run::begin(FOLLOW, &wrong(), Time::Stepped(Pace::Max)).map(|_: Run| ()).unwrap_err();
    let sentence = "the plan reads /usr/heading/bearing in rad, and it is a length";
    assert!(matches!(&refusal, Refusal::Usage(found) if found == sentence), "{refusal:?}");
}

#[test]
fn a_plan_that_reads_nothing_new_takes_over_at_once() {
    let mut run = Run::of("{ Stand (wait 60) (Atom (null) stop) }", &followers());
    (0..10).for_each(|_| _ = run.turn().unwrap());
    let standing = |modules: &Modules<Sensed>| modules.names().find(|(name, _)| *name == "heading").unwrap().1;
    assert_eq!(standing(run.engine.modules()), ModuleState::Stopped, "nothing reads it");
    run.engine.plans_mut().replace(loaded(FOLLOW).plan(), When::Now);
    // The module is started for the next plan, which takes over once the module has published.
    let taken = (0..10).position(|_| {
        run.turn().unwrap();
        run.engine.plans().number() == 2
    });
    assert_eq!((taken, standing(run.engine.modules())), (Some(2), ModuleState::Active));
    run.drive();
    assert!(run.distance() < 0.6);
}

#[test]
fn a_plan_that_cannot_take_over_is_refused() {
    let mut run = Run::of("{ Stand (wait 60) (Atom (null) stop) }", &Library::new());
    run.engine.plans_mut().replace(loaded(FOLLOW).plan(), When::Now);
    (0..25).for_each(|_| _ = run.turn().unwrap());
    let events: Vec<_> = run.engine.plans_mut().take_events().collect();
    let [PlanEvent::Armed(2), PlanEvent::Refused(2, sentence)] = &events[..] else { panic!("{events:?}") };
    assert!(sentence.contains("/usr/heading/range, which no module has published"), "{sentence}");
    assert_eq!(run.engine.plans().number(), 1);
}

#[test]
fn an_executable_has_no_modules() {
    let folder = folder("modules");
    fs::write(folder.join("follow.mdle"), FOLLOW).unwrap();
    let checked = run_mdlec(&folder, &["check", "follow.mdle", "--target", "sim"]);
    assert_eq!(String::from_utf8(checked.stderr).unwrap(), "");
    let built = run_mdlec(&folder, &["follow.mdle", "--target", "sim"]);
    assert_eq!(built.status.code(), Some(1));
    insta::assert_snapshot!(String::from_utf8(built.stderr).unwrap());
}
