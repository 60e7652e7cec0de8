//! Reads FSM files (docs/src/reference/interfaces.md, 5), which contain states, and interrupts with their transitions.
//!
//! In the resulting machine, every transition connects two states of the file, and each state has at most one
//! transition per interrupt.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};

use super::{Machine, NamedInterrupt, State, number};
use mdle_compiler::alphabet::nearest;
use mdle_compiler::syntax::{is_law, operands};

/// Reason why a file cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileError {
    /// Line of the error, counted from 1; `None` if the error is not in a single line.
    pub line: Option<usize>,
    /// Description of the error.
    pub message: String,
}

/// Contents of an FSM file; unknown fields are ignored.
#[derive(Deserialize)]
#[serde(expecting = "an object with `states` and `interrupts`")]
struct Written {
    states: Vec<String>,
    interrupts: Vec<WrittenInterrupt>,
    start: Option<String>,
    laws: Option<Vec<String>>,
}

#[derive(Deserialize)]
#[serde(expecting = "an interrupt: an object with `name` and `moves`")]
struct WrittenInterrupt {
    name: String,
    moves: Moves,
    text: Option<String>,
}

/// Transitions of an interrupt. The key is the name of the state from which a transition leads; the value is the name
/// of its destination.
struct Moves(BTreeMap<String, String>);

impl<'de> Deserialize<'de> for Moves {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(MovesVisitor)
    }
}

struct MovesVisitor;

impl<'de> Visitor<'de> for MovesVisitor {
    type Value = Moves;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object from states to states")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Moves, A::Error> {
        let mut moves = BTreeMap::new();
        while let Some((from, to)) = map.next_entry::<String, String>()? {
            match moves.get(&from) {
                Some(other) if *other != to => {
                    return Err(A::Error::custom(format!(
                        "this interrupt leads from `{from}` to `{other}` and to `{to}`: it can lead to one of them only"
                    )));
                }
                Some(_) => {}
                None => drop(moves.insert(from, to)),
            }
        }
        Ok(Moves(moves))
    }
}

/// Reads a machine. Entries with the same name form one interrupt.
///
/// # Errors
/// Fails if the text is not JSON, has no state, names unknown states, or gives an interrupt two destinations for a
/// state; if `start` is the last state; if `laws` does not have one law for each state but the last; or if the text of
/// an interrupt is not exactly one condition.
pub fn read(text: &str) -> Result<Machine, FileError> {
    let written: Written = serde_json::from_str(text).map_err(|error| reason(&error))?;
    let states = States::new(&written.states)?;
    let mut interrupts: Vec<(NamedInterrupt, BTreeMap<State, State>)> = Vec::new();
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    for WrittenInterrupt { name, moves, text } in written.interrupts {
        let place = *known.entry(name.clone()).or_insert(interrupts.len());
        if place == interrupts.len() {
            interrupts.push((NamedInterrupt { name, text: None }, BTreeMap::new()));
        }
        if let Some(text) = text.as_ref().filter(|text| operands(text).is_none()) {
            return Err(refused(format!(
                "the `text` of interrupt `{name}` is not one condition and nothing else: `{text}`\nhelp: write it as in a plan, \
                 such as `bumper OR wait 5`, or leave `text` out: the interrupt is called by its name then",
                name = interrupts[place].0.name
            )));
        }
        let (named, all) = &mut interrupts[place];
        named.text = named.text.take().or(text);
        for (from, to) in &moves.0 {
            let asks = || format!("interrupt `{}`", named.name);
            let (state, to) = (states.find(from, asks)?, states.find(to, asks)?);
            if let Some(other) = all.insert(state, to).filter(|other| *other != to) {
                let [other, to] = [other, to].map(|state| &written.states[state.0 as usize]);
                return Err(refused(format!(
                    "interrupt `{}` leads from `{from}` to `{other}` and to `{to}`: it can lead to one of them only",
                    named.name
                )));
            }
        }
    }
    let start = written.start.map(|start| states.find(&start, || "`start`".to_owned())).transpose()?;
    let interrupts = interrupts.into_iter().map(|(named, moves)| (named, moves.into_iter().collect()));
    let machine = Machine { start, ..Machine::new(written.states, interrupts.collect()) };
    let atoms = machine.end().0 as usize;
    if start == Some(machine.end()) {
        return Err(refused("`start` names the last state, in which the plan is over".to_owned()));
    }
    match written.laws {
        Some(laws) if laws.len() != atoms => Err(refused(format!(
            "`laws` has to have a law for each state but the last: {atoms}, and there are {}",
            laws.len()
        ))),
        laws => {
            let named = machine.states().iter().zip(laws.iter().flatten());
            match named.into_iter().find(|(_, law)| !is_law(law)) {
                Some((state, law)) => Err(refused(format!(
                    "the law of state `{state}` is not one law and nothing else: `{law}`\nhelp: write it as in a plan, such as \
                     `go 20 0`, or leave `laws` out: laws are called by their states' names then"
                ))),
                None => Ok(Machine { laws, ..machine }),
            }
        }
    }
}

/// States of a file, by name.
struct States<'n>(BTreeMap<&'n str, State>);

impl<'n> States<'n> {
    fn new(names: &'n [String]) -> Result<Self, FileError> {
        match names {
            [] => {
                return Err(refused(
                    "`states` is empty: the last state is the one in which the plan is over".to_owned(),
                ));
            }
            [only] => {
                return Err(refused(format!(
                    "`{only}` is the only state, in which the plan is over: a plan has an atom"
                )));
            }
            [..] => {}
        }
        let mut states = BTreeMap::new();
        for (place, name) in names.iter().enumerate() {
            if states.insert(name.as_str(), State(number(place))).is_some() {
                return Err(refused(format!("there are two states `{name}`")));
            }
        }
        Ok(Self(states))
    }

    /// Returns the state with this name. `asks` describes the entry that contains the name, for the error message.
    fn find(&self, name: &str, asks: impl Fn() -> String) -> Result<State, FileError> {
        self.0.get(name).copied().ok_or_else(|| {
            let near = nearest(name, self.0.keys().copied());
            let near = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            refused(format!("{} names the state `{name}`, which is not among `states`{near}", asks()))
        })
    }
}

fn refused(message: String) -> FileError {
    FileError { line: None, message }
}

/// Converts an error of the JSON parser; the message contains the column.
fn reason(error: &serde_json::Error) -> FileError {
    let message = error.to_string();
    let message = match message.rsplit_once(" at line ") {
        Some((message, _)) => format!("{message} (column {})", error.column()),
        None => message,
    };
    FileError { line: (error.line() > 0).then(|| error.line()), message }
}
