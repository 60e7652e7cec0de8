//! Tests the order of a turn and its turn break, settings, and relevance.

use std::sync::{Arc, Mutex};

use mdle_runtime::ModuleRead;

use super::{number, sequential, turn};
use crate::{
    Candidate, Event, Fault, In, Module, ModuleState, Modules, Out, Refusal, Relevance, Service, Threads, Turn, Value,
};

/// A module that publishes its input plus one.
struct Next {
    read: In<f64>,
    out: Out<f64>,
}

impl Module<f64> for Next {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        if let Some(read) = turn.get(self.read) {
            turn.publish(self.out, read + 1.0);
        }
        Ok(())
    }
}

fn next(name: &str, of: &str) -> Candidate<f64> {
    let make = |declare: &mut crate::Declare| Next { read: declare.reads(of, "out"), out: declare.publishes("out") };
    Candidate::registered(name, make).unwrap()
}

/// A module that publishes the robot's output.
struct Source(Out<f64>);

impl Module<f64> for Source {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        turn.publish(self.0, *turn.y);
        Ok(())
    }
}

fn source(name: &str) -> Candidate<f64> {
    Candidate::registered(name, |declare| Source(declare.publishes("out"))).unwrap()
}

#[test]
fn each_link_of_a_chain_costs_a_turn() {
    // The order in which the modules are loaded has no effect.
    let mut modules = sequential();
    for candidate in [next("second", "first"), next("first", "source"), source("source")] {
        modules.load(candidate).unwrap();
    }
    modules.prepare();
    let mut seen = Vec::new();
    for turns in 0..4 {
        turn(&mut modules, turns);
        seen.push(["source", "first", "second"].map(|name| number(&modules, name, "out")));
    }
    let (y, one, two) = (|turn| Some((0.5 * turn as f64, turn)), Some((1.0, 1)), Some((2.0, 2)));
    assert_eq!(
        seen,
        [[y(0), None, None], [y(1), one, None], [y(2), Some((1.5, 2)), two], [y(3), Some((2.0, 3)), Some((2.5, 3))]]
    );
}

#[test]
fn an_attribute_vanishes_with_its_module() {
    let mut modules = sequential();
    for candidate in [source("source"), next("first", "source")] {
        modules.load(candidate).unwrap();
    }
    modules.prepare();
    (0..2).for_each(|number| turn(&mut modules, number));
    modules.unload("source").unwrap();
    modules.prepare();
    (2..5).for_each(|number| turn(&mut modules, number));
    assert_eq!((modules.board().post("source", "out"), number(&modules, "first", "out")), (None, Some((1.0, 1))));
    // The reader is connected to a new module with the same name.
    modules.load(source("source")).unwrap();
    modules.prepare();
    (5..8).for_each(|number| turn(&mut modules, number));
    assert_eq!(number(&modules, "first", "out"), Some((4.0, 7)));
}

#[test]
fn wrong_kinds_and_names_are_refused_at_load() {
    struct Idle;
    impl Module<f64> for Idle {
        fn turn(&mut self, _: &mut Turn<'_, f64>) -> Result<(), Fault> {
            Ok(())
        }
    }
    let mut modules = sequential();
    modules.load(source("source")).unwrap();
    assert_eq!(modules.load(source("source")), Err(Refusal::NameTaken("source".into())));
    let reader = |name: &str| {
        let make = |declare: &mut crate::Declare| {
            let _: In<bool> = declare.reads("source", "out");
            Idle
        };
        Candidate::registered(name, make).unwrap()
    };
    let refusal = modules.load(reader("reader")).unwrap_err();
    assert_eq!(refusal.to_string(), "module `reader` reads /usr/source/out as a flag, and it is published as a number");
    // In the opposite order, the module that publishes the attribute is refused.
    modules.unload("source").unwrap();
    modules.load(reader("reader")).unwrap();
    assert_eq!(modules.load(source("source")).unwrap_err(), refusal);
    assert_eq!(modules.names().map(|(name, _)| name).collect::<Vec<_>>(), ["reader"]);
    assert!(modules.board().posts().is_empty());
    let declared = |name: &str, declare: fn(&mut crate::Declare)| {
        let candidate = Candidate::<f64>::registered(name, |to| {
            declare(to);
            Idle
        });
        candidate.map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(
        declared("2nd", |_| ()),
        "`2nd` is no name of a module: ASCII letters, digits and `_`, and no digit first"
    );
    assert_eq!(
        declared("twice", |declare| {
            let _: (Out<f64>, In<f64>) = (declare.publishes("a"), declare.setting("a", 1.0));
        }),
        "the declaration of module `twice` is wrong: `a` is declared twice"
    );
    assert_eq!(
        declared("unit", |declare| {
            let _: Out<mdle_runtime::Meters> = declare.publishes("far");
            declare.describe("far", "deg", "The distance.");
        }),
        "the declaration of module `unit` is wrong: `deg` is no unit for `far`, which is a length"
    );
}

/// A module that publishes its setting and keeps a journal.
struct Journal {
    gain: In<f64>,
    out: Out<f64>,
    journal: Arc<Mutex<String>>,
}

impl Module<f64> for Journal {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        turn.publish(self.out, turn.get(self.gain).unwrap());
        self.journal.lock().unwrap().push('t');
        Ok(())
    }

    fn start(&mut self) {
        self.journal.lock().unwrap().push('(');
    }

    fn stop(&mut self) {
        self.journal.lock().unwrap().push(')');
    }
}

fn journal(name: &str, relevance: Relevance) -> (Candidate<f64>, Arc<Mutex<String>>) {
    let journal = Arc::<Mutex<String>>::default();
    let make = |declare: &mut crate::Declare| {
        declare.relevance(relevance);
        Journal { gain: declare.setting("gain", 2.0), out: declare.publishes("out"), journal: Arc::clone(&journal) }
    };
    (Candidate::registered(name, make).unwrap(), journal)
}

#[test]
fn a_setting_holds_from_the_next_turn_on() {
    let mut modules = sequential();
    modules.load(journal("gained", Relevance::Always).0).unwrap();
    modules.prepare();
    turn(&mut modules, 0);
    assert_eq!(number(&modules, "gained", "out"), Some((2.0, 0)));
    modules.set("gained", "gain", Value::Number(3.0)).unwrap();
    modules.prepare();
    turn(&mut modules, 1);
    assert_eq!(number(&modules, "gained", "out"), Some((3.0, 1)));
    let refused = [
        modules.set("gained", "gain", Value::Flag(true)),
        modules.set("gained", "gain", Value::Number(f64::NAN)),
        modules.set("gained", "out", Value::Number(1.0)),
        modules.set("nobody", "gain", Value::Number(1.0)),
    ];
    insta::assert_snapshot!(refused.map(|refused| refused.unwrap_err().to_string()).join("\n"), @"
    /usr/gained/gain is a number, and the value is a flag
    /usr/gained/gain cannot be NaN
    module `gained` has no setting `out`
    no module `nobody` is loaded
    ");
    assert_eq!(modules.settings("gained").next().unwrap().1.value, Value::Number(3.0));
}

#[test]
fn a_module_stops_and_starts_between_turns() {
    let mut modules = sequential();
    let (held, of_held) = journal("held", Relevance::Always);
    modules.load(held).unwrap();
    modules.prepare();
    for (turns, is_held) in [(0, false), (1, true), (2, true), (3, true), (4, false), (5, true)] {
        turn(&mut modules, turns);
        modules.hold("held", is_held).unwrap();
        modules.prepare();
    }
    turn(&mut modules, 6);
    assert_eq!(*of_held.lock().unwrap(), "(tt)(t)");
    assert_eq!(modules.names().collect::<Vec<_>>(), [("held", ModuleState::Stopped)]);
}

#[test]
fn a_module_that_nothing_reads_makes_no_turns() {
    let mut modules = sequential();
    let (idle, of_idle) = journal("idle", Relevance::WhenRead);
    let (read, of_read) = journal("read", Relevance::WhenRead);
    let (planned, of_planned) = journal("planned", Relevance::WhenRead);
    for candidate in [idle, read, planned, next("reader", "read")] {
        modules.load(candidate).unwrap();
    }
    modules.prepare();
    turn(&mut modules, 0);
    static READ: ModuleRead = ModuleRead { module: "planned", attribute: "out", unit: None };
    modules.plan_reads([&READ].into_iter());
    modules.prepare();
    assert_eq!(modules.events(), [Event::Started("planned".into())]);
    turn(&mut modules, 1);
    modules.plan_reads([].into_iter());
    modules.unload("reader").unwrap();
    modules.prepare();
    (2..4).for_each(|number| turn(&mut modules, number));
    let journals = [of_idle, of_read, of_planned].map(|journal| journal.lock().unwrap().clone());
    assert_eq!(journals, ["", "(tt)", "(t)"]);
}

#[test]
fn workers_take_urgent_modules_first() {
    let journal = Arc::<Mutex<String>>::default();
    struct Named(char, Arc<Mutex<String>>);
    impl Module<f64> for Named {
        fn turn(&mut self, _: &mut Turn<'_, f64>) -> Result<(), Fault> {
            self.1.lock().unwrap().push(self.0);
            Ok(())
        }
    }
    // The modules are not sorted by cost before turn 128.
    for threads in [Threads::Sequential, super::workers(1)] {
        let mut modules = Modules::new(threads, Service::WhenDue).unwrap();
        for (name, priority) in [('a', 0), ('b', -1), ('c', 5), ('d', 0)] {
            let make = |declare: &mut crate::Declare| {
                declare.priority(priority);
                Named(name, Arc::clone(&journal))
            };
            modules.load(Candidate::registered(&name.to_string(), make).unwrap()).unwrap();
        }
        modules.prepare();
        turn(&mut modules, 0);
    }
    assert_eq!(*journal.lock().unwrap(), "cadbcadb");
}
