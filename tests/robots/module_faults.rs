//! Tests faults of modules that a plan reads: the plan ends because of the age of the values, the robot then stops, the
//! operator gets a message, and no turn hangs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::thread;
use std::time::Duration;

use mdle_engine::{Background, Declare, Exchange, Fault, In, Library, Module, Offer, Out, Turn};
use mdle_host::{Pace, Pilot as _, PilotFault, Refusal, Time};
use mdle_runtime::{Radians, Sensed, Turn as PlanTurn, Twist};

use super::modules::Run;

/// A plan that drives while a module publishes.
const PLAN: &str = "{ Listen (age(ears module) > 500ms) (Atom (null) (go 20 0)) }";
/// Number of the turn in which the fault begins.
const FAULT: u64 = 20;

/// A fault of a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Deed {
    None,
    Fails,
    Panics,
    PanicsInStart,
    PanicsInDeclaration,
    NeverReturns,
    PublishesNan,
}

/// A module that publishes a bearing.
struct Ears {
    bearing: Out<Radians>,
    deed: Deed,
}

impl Ears {
    fn declare(declare: &mut Declare, deed: Deed) -> Self {
        if deed == Deed::PanicsInDeclaration {
            panic!("no microphone");
        }
        Self { bearing: declare.publishes("bearing"), deed }
    }
}

impl Module<Sensed> for Ears {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let deed = if turn.number < FAULT { Deed::None } else { self.deed };
        match deed {
            Deed::None | Deed::PanicsInStart | Deed::PanicsInDeclaration => turn.publish(self.bearing, Radians(0.0)),
            Deed::Fails => return Err(Fault("the microphone is unplugged".to_owned())),
            Deed::Panics => panic!("index 7 of 3"),
            Deed::NeverReturns => loop {
                thread::park_timeout(Duration::from_secs(1));
            },
            Deed::PublishesNan => turn.publish(self.bearing, Radians(f64::NAN)),
        }
        Ok(())
    }

    fn start(&mut self) {
        if self.deed == Deed::PanicsInStart {
            panic!("no sound card");
        }
    }
}

/// A background module with a fault that begins in the exchange with the number [`FAULT`].
struct Listens {
    bearing: Out<Radians>,
    deed: &'static str,
}

impl Background for Listens {
    fn run(self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        let publish = |offer: &mut Offer<'_>| offer.publish(self.bearing, Radians(0.0));
        for number in 0.. {
            let is_early = number < FAULT;
            let ended = match self.deed {
                "panics in an exchange" if !is_early => exchange.exchange(|_| panic!("the line is broken")),
                "fails" if !is_early => return Err(Fault("the line is cut".to_owned())),
                "returns" if !is_early => return Ok(()),
                "exchanges no more" if !is_early => {
                    while !exchange.is_stopped() {
                        thread::sleep(Duration::from_millis(5));
                    }
                    return Ok(());
                }
                _ => exchange.exchange(publish),
            };
            if ended.is_err() {
                break;
            }
        }
        Ok(())
    }
}

/// Runs the plan with these modules. Returns all messages with their turns, the end of the plan, and the number of
/// turns from the fault to the null input.
fn story(library: &Library<Sensed>, time: Time, mut each: impl FnMut(&mut Run)) -> String {
    let mut run = match Run::begin(PLAN, library, time) {
        Ok(run) => run,
        Err(Refusal::Usage(sentence)) => return format!("  refused, exit status 2: {sentence}\n"),
        Err(refusal) => panic!("{refusal:?}"),
    };
    let (mut story, mut stands) = (String::new(), None);
    while run.turns < 60 {
        each(&mut run);
        let (number, turn) = (run.turns, run.turn());
        run.engine.messages(&mut |message| writeln!(story, "  turn {number}: {message}").unwrap());
        match turn {
            Ok(PlanTurn::Over) => {
                stands = Some(number);
                writeln!(story, "  turn {number}: the plan is over").unwrap();
                break;
            }
            Ok(PlanTurn::Law(input)) => assert_ne!(input, Twist::default()),
            Ok(PlanTurn::Cut) => {}
            Err(PilotFault::Stopped(sentence)) => {
                writeln!(story, "  turn {number}: stopped, exit status 3: {sentence}").unwrap();
                return story;
            }
            Err(PilotFault::Panicked(message)) => panic!("{message}"),
        }
    }
    match stands.and_then(|turn| turn.checked_sub(FAULT)) {
        Some(turns) => writeln!(story, "  the robot stands {turns} turns after the fault").unwrap(),
        None => story += "  the robot drives on\n",
    }
    story
}

#[test]
fn a_robot_stands_soon_after_a_module_has_failed() {
    let deeds =
        [Deed::None, Deed::Fails, Deed::Panics, Deed::PanicsInStart, Deed::PanicsInDeclaration, Deed::PublishesNan];
    let report = |time: Time, deeds: &[Deed]| {
        let each = deeds.iter().map(|deed| {
            let (deed, mut library) = (*deed, Library::new());
            library.registered("ears", move |declare| Ears::declare(declare, deed));
            format!("{deed:?}\n{}", story(&library, time, |_| ()))
        });
        each.collect::<Vec<_>>().join("\n")
    };
    let stepped = report(Time::Stepped(Pace::Max), &deeds);
    assert_eq!(report(Time::Wall, &deeds), stepped, "workers");
    // This fault is tested in real time only: in stepped time the engine waits for a late module.
    insta::assert_snapshot!(format!("{stepped}\n{}", report(Time::Wall, &[Deed::NeverReturns])));
}

#[test]
fn a_robot_stands_soon_after_a_background_module_ends() {
    let deeds = ["exchanges without end", "panics in an exchange", "fails", "returns", "exchanges no more"];
    let reports = deeds.map(|deed| {
        let mut library = Library::new();
        library.background("ears", move |declare| Listens { bearing: declare.publishes("bearing"), deed });
        format!("{deed}\n{}", story(&library, Time::Stepped(Pace::Max), |_| ()))
    });
    insta::assert_snapshot!(reports.join("\n"));
}

/// A module that reads an attribute of another module.
struct Reader {
    read: In<Radians>,
    bearing: Out<Radians>,
}

impl Module<Sensed> for Reader {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        if let Some(bearing) = turn.get(self.read) {
            turn.publish(self.bearing, bearing);
        }
        Ok(())
    }
}

#[test]
fn a_robot_stands_when_what_a_module_reads_vanishes() {
    let library = |names: &[&'static str]| {
        let mut library = Library::new();
        library.registered("source", |declare| Ears::declare(declare, Deed::None));
        for name in names {
            let make = |declare: &mut Declare| Reader {
                read: declare.reads("source", "bearing"),
                bearing: declare.publishes("bearing"),
            };
            library.registered(name, make);
        }
        library
    };
    let vanishes = |name: &'static str| {
        move |run: &mut Run| {
            if run.turns == FAULT {
                run.engine.modules_mut().unload(name).unwrap();
            }
        }
    };
    let time = Time::Stepped(Pace::Max);
    let stories = [
        ("its source vanishes", story(&library(&["ears"]), time, vanishes("source"))),
        ("it vanishes itself", story(&library(&["ears"]), time, vanishes("ears"))),
        ("two of one name", story(&library(&["ears", "ears"]), time, |_| ())),
        ("the name of the plan's module", story(&library(&["mdle"]), time, |_| ())),
    ];
    insta::assert_snapshot!(stories.map(|(what, story)| format!("{what}\n{story}")).join("\n"));
}
