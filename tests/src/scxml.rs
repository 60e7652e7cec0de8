//! A small interpreter of flat SCXML machines (W3C, "State Chart XML", appendix D), for the machines that mdlec writes.
//! It takes transitions without an event first, in document order, until none is enabled, and then processes the next
//! event.

use std::collections::BTreeMap;

use crate::ecmascript::{Value, evaluate};
use crate::xml::Element;

/// A running machine.
#[derive(Debug)]
pub struct Machine<'e> {
    root: &'e Element,
    states: BTreeMap<&'e str, &'e Element>,
    state: &'e Element,
    /// Data of the machine, by name.
    pub data: BTreeMap<String, Value>,
}

/// Known elements, each with its allowed attributes and children.
const ELEMENTS: &[(&str, &[&str], &[&str])] = &[
    ("scxml", &["xmlns", "version", "datamodel", "name", "initial"], &["datamodel", "state", "final"]),
    ("datamodel", &[], &["data"]),
    ("data", &["id", "expr"], &[]),
    ("state", &["id"], &["onentry", "transition"]),
    ("final", &["id"], &["onentry"]),
    ("onentry", &[], &["assign", "if"]),
    ("transition", &["event", "cond", "target"], &["assign", "if"]),
    ("if", &["cond"], &["assign"]),
    ("assign", &["location", "expr"], &[]),
];

impl<'e> Machine<'e> {
    /// Starts a machine: sets the data to their initial values, and enters the initial state.
    #[must_use]
    pub fn new(root: &'e Element) -> Self {
        assert_valid(root);
        let children = || root.children.iter();
        let states: BTreeMap<_, _> =
            children().filter(|child| child.name != "datamodel").map(|state| (state.attribute("id"), state)).collect();
        assert_eq!(states.len() + 1, root.children.len(), "ids are there once");
        let mut data = BTreeMap::new();
        for datum in children().filter(|child| child.name == "datamodel").flat_map(|model| &model.children) {
            let value = evaluate(datum.attribute("expr"), &data);
            assert!(data.insert(datum.attribute("id").to_owned(), value).is_none());
        }
        let state = states[root.attribute("initial")];
        let mut machine = Self { root, states, state, data };
        machine.enter(state);
        assert_eq!(machine.settle(), [""; 0], "nothing happens before the first event");
        machine
    }

    /// Returns the identifier of the current state.
    #[must_use]
    pub fn state(&self) -> &'e str {
        self.state.attribute("id")
    }

    /// Processes an event; returns the states that the machine left afterwards, in order.
    pub fn event(&mut self, name: &str, data: Value) -> Vec<&'e str> {
        self.data.insert("_event".into(), Value::Object([("data".to_owned(), data)].into()));
        let taken =
            self.transitions().find(|transition| transition.attributes.get("event").is_some_and(|on| on == name));
        if let Some(transition) = taken {
            self.take(transition);
        }
        self.settle()
    }

    /// Returns `true` if the machine is in a final state.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.state.name == "final"
    }

    fn transitions(&self) -> impl Iterator<Item = &'e Element> + use<'e> {
        self.state.children.iter().filter(|child| child.name == "transition")
    }

    /// Takes transitions without an event while one is enabled; returns the states that were left.
    fn settle(&mut self) -> Vec<&'e str> {
        let mut left = Vec::new();
        loop {
            let without = |transition: &&Element| !transition.attributes.contains_key("event");
            let taken = self
                .transitions()
                .filter(without)
                .find(|transition| evaluate(transition.attribute("cond"), &self.data).is_true());
            let Some(transition) = taken else { return left };
            if transition.attributes.contains_key("target") {
                left.push(self.state());
            }
            self.take(transition);
        }
    }

    fn take(&mut self, transition: &'e Element) {
        self.execute(&transition.children);
        if let Some(target) = transition.attributes.get("target") {
            let state = self.states[target.as_str()];
            self.enter(state);
        }
    }

    fn enter(&mut self, state: &'e Element) {
        self.state = state;
        for entry in state.children.iter().filter(|child| child.name == "onentry") {
            self.execute(&entry.children);
        }
    }

    fn execute(&mut self, content: &[Element]) {
        for step in content {
            match step.name.as_str() {
                "assign" => {
                    let value = evaluate(step.attribute("expr"), &self.data);
                    let known = self.data.insert(step.attribute("location").to_owned(), value);
                    assert!(known.is_some(), "{step:?} assigns to what is not in the data of {}", self.root.name);
                }
                "if" => {
                    if evaluate(step.attribute("cond"), &self.data).is_true() {
                        self.execute(&step.children);
                    }
                }
                other => panic!("<{other}> cannot be executed"),
            }
        }
    }
}

/// Asserts that a document contains only known elements and attributes, each at an allowed place.
fn assert_valid(root: &Element) {
    assert_eq!(root.attribute("xmlns"), "http://www.w3.org/2005/07/scxml");
    assert_eq!((root.attribute("version"), root.attribute("datamodel")), ("1.0", "ecmascript"));
    for element in root.all() {
        let (_, attributes, children) = ELEMENTS.iter().find(|(name, ..)| *name == element.name).expect(&element.name);
        assert!(element.attributes.keys().all(|key| attributes.contains(&key.as_str())), "{element:?}");
        assert!(element.children.iter().all(|child| children.contains(&child.name.as_str())), "{element:?}");
        assert_eq!(element.text.trim(), "");
        let says_something = ["event", "cond", "target"].iter().any(|key| element.attributes.contains_key(*key));
        assert!(element.name != "transition" || says_something, "a transition needs an event, a condition or a target");
    }
    let states = root.children.iter().filter(|child| child.name != "datamodel");
    let ids: Vec<_> = states.map(|state| state.attribute("id")).collect();
    let targets = root.all().into_iter().filter_map(|element| element.attributes.get("target"));
    assert!(targets.into_iter().all(|target| ids.contains(&target.as_str())), "a target that is not there");
}
