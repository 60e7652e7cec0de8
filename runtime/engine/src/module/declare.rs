//! Declaration of a module: the attributes that the module publishes, the attributes that it reads, its settings, and
//! the condition under which it makes turns.

use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::alphabet::Unit;
use mdle_runtime::Nanos;

use crate::attribute::{AGE, Attribute, AttributeKind, AttributeName, In, Out, Reading, Value, is_name};

/// Declares the attributes of a module while the module is being created.
#[derive(Debug, Default)]
pub struct Declare {
    pub(crate) declared: Declared,
    pub(crate) ports: Ports,
    /// First error in the declaration, as a sentence; `None` if there is none.
    pub(crate) fault: Option<String>,
}

/// The declaration of a module.
#[derive(Debug, Default)]
pub(crate) struct Declared {
    pub(crate) doc: &'static str,
    pub(crate) publishes: Vec<About>,
    pub(crate) reads: Vec<ValueSource>,
    /// Priority of the module: modules with higher priority begin their turns first.
    pub(crate) priority: i32,
    pub(crate) relevance: Relevance,
    pub(crate) latency: Nanos,
    /// `true` if the first exchange is due at the first turn break, even if the latency has not passed.
    pub(crate) begins_at_once: bool,
    /// Maximum time for which the engine waits for the module's thread to end.
    pub(crate) farewell: Duration,
}

/// Source of a value that a module reads.
#[derive(Debug)]
pub(crate) enum ValueSource {
    /// An attribute of another module: its name, and the kind that the module expects.
    Attribute(AttributeName, AttributeKind),
    /// A setting of the module itself: its description and its value.
    Setting(About, Reading),
}

/// Description of an attribute or of a setting, for people.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// Name of the attribute or setting in its module.
    pub name: Arc<str>,
    /// Kind of the values.
    pub kind: AttributeKind,
    /// Unit in which users read and write the value; `None` for a kind without units.
    pub unit: Option<Unit>,
    /// Description of the attribute or setting, as a sentence.
    pub doc: &'static str,
}

/// Condition under which a module makes turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Relevance {
    /// The module makes a turn in every turn of the engine.
    #[default]
    Always,
    /// The module makes turns only while it is read by the active plan, a plan that may become active, a safety rule,
    /// another robot, or a module that makes turns.
    WhenRead,
}

/// Values of a module: values to publish at the next turn break, and copies of the attributes that the module reads.
#[derive(Debug, Default)]
pub(crate) struct Ports {
    pub(crate) outs: Vec<Option<Value>>,
    pub(crate) ins: Vec<Option<Reading>>,
    /// Time of the last turn break, for a background module.
    pub(crate) now: Nanos,
}

impl Ports {
    pub(crate) fn get<T: Attribute>(&self, attribute: In<T>) -> Option<T> {
        self.reading(attribute).and_then(|reading| T::from_value(&reading.value))
    }

    pub(crate) fn reading<T>(&self, attribute: In<T>) -> Option<&Reading> {
        self.ins.get(attribute.place()).and_then(Option::as_ref)
    }

    pub(crate) fn publish<T: Attribute>(&mut self, attribute: Out<T>, value: T) {
        if let Some(out) = self.outs.get_mut(attribute.place()) {
            *out = Some(value.into_value());
        }
    }
}

impl Declare {
    /// Declares an attribute that the module publishes. The name must be a valid MDLe name that no other attribute or
    /// setting of the module has.
    pub fn publishes<T: Attribute>(&mut self, name: &str) -> Out<T> {
        Out::new(self.publishes_as(name, T::KIND, None))
    }

    /// Declares an attribute of this kind, and returns its index. Users read the attribute in `unit`, or in the SI unit
    /// if `unit` is `None`.
    pub(crate) fn publishes_as(&mut self, name: &str, kind: AttributeKind, unit: Option<Unit>) -> usize {
        let about = self.about(name, kind);
        self.declared.publishes.push(About { unit: unit.or(about.unit), ..about });
        self.ports.outs.push(None);
        self.ports.outs.len().saturating_sub(1)
    }

    /// Declares that this module reads an attribute of another module. The other module may be loaded later or never.
    /// If that module publishes the attribute with another kind, the one of the two modules that is loaded last is
    /// refused.
    pub fn reads<T: Attribute>(&mut self, module: &str, attribute: &str) -> In<T> {
        In::new(self.reads_as(module, attribute, T::KIND))
    }

    /// Declares that this module reads an attribute of another module, and expects its values to have the kind `kind`;
    /// returns the index of the attribute.
    pub(crate) fn reads_as(&mut self, module: &str, attribute: &str, kind: AttributeKind) -> usize {
        for name in [module, attribute] {
            self.check_name(name);
        }
        self.input(ValueSource::Attribute(AttributeName::new(module, attribute), kind), None)
    }

    /// Declares a setting of the module with its initial value; users can change the setting.
    pub fn setting<T: Attribute>(&mut self, name: &str, initial: T) -> In<T> {
        let about = self.about(name, T::KIND);
        let value = initial.into_value();
        if value.has_nan() {
            self.refuse(format!("the setting `{name}` is NaN at first"));
        }
        let reading = Reading { value, at: Nanos::ZERO };
        In::new(self.input(ValueSource::Setting(about, reading.clone()), Some(reading)))
    }

    /// Describes an attribute or a setting that was declared before: the unit in which users read and write it, and a
    /// sentence. `unit` is empty for the SI unit, and for a kind without units.
    pub fn describe(&mut self, name: &str, unit: &str, doc: &'static str) {
        let known = self.declared.abouts_mut().find(|about| &*about.name == name);
        let Some(about) = known else {
            return self.refuse(format!("`{name}` is described, and no attribute or setting of this name is declared"));
        };
        about.doc = doc;
        if unit.is_empty() {
            return;
        }
        let quantity = about.kind.quantity();
        match Unit::from_name(unit).filter(|unit| Some(unit.kind) == quantity) {
            Some(unit) => about.unit = Some(unit),
            None => {
                let sentence = format!("`{unit}` is no unit for `{name}`, which is {}", about.kind.words());
                self.refuse(sentence);
            }
        }
    }

    /// Describes the module in a sentence.
    pub fn doc(&mut self, doc: &'static str) {
        self.declared.doc = doc;
    }

    /// Sets the priority of the module, 0 by default. Modules with higher priority begin their turns first. If the time
    /// for a turn is too short, the priority decides which modules are late; it has no other effect on results.
    pub fn priority(&mut self, priority: i32) {
        self.declared.priority = priority;
    }

    /// Sets the condition under which the module makes turns.
    pub fn relevance(&mut self, relevance: Relevance) {
        self.declared.relevance = relevance;
    }

    /// Sets the time that a background module needs for one exchange, 0 by default. In stepped time, the module's next
    /// exchange takes place at the first turn break after this time has passed on the engine's clock, regardless of the
    /// computer's speed. A plan that reads the module waits this much longer for the module's first values.
    pub fn latency(&mut self, latency: Nanos) {
        self.declared.latency = latency;
    }

    /// Makes the first exchange due at the first turn break, even if the latency has not passed. The first exchange
    /// publishes nothing, but supplies the values that the module reads.
    pub(crate) fn begins_at_once(&mut self) {
        self.declared.begins_at_once = true;
    }

    /// Sets the maximum time for which the engine waits for the module's thread to end, 0 by default.
    pub(crate) fn farewell(&mut self, farewell: Duration) {
        self.declared.farewell = farewell;
    }

    fn input(&mut self, source: ValueSource, reading: Option<Reading>) -> usize {
        self.declared.reads.push(source);
        self.ports.ins.push(reading);
        self.ports.ins.len().saturating_sub(1)
    }

    fn about(&mut self, name: &str, kind: AttributeKind) -> About {
        self.check_name(name);
        if self.declared.abouts().any(|about| &*about.name == name) {
            self.refuse(format!("`{name}` is declared twice"));
        }
        if name == AGE {
            self.refuse(format!("`{AGE}` is the time since a module published, which every module has"));
        }
        let unit = kind.quantity().and_then(mdle_compiler::alphabet::ParameterKind::base_unit);
        About { name: name.into(), kind, unit, doc: "" }
    }

    fn check_name(&mut self, name: &str) {
        if !is_name(name) {
            self.refuse(format!("`{name}` is no name of a module or an attribute"));
        }
    }

    /// Records an error in the declaration, unless an earlier error is recorded.
    fn refuse(&mut self, sentence: String) {
        self.fault.get_or_insert(sentence);
    }
}

impl Declared {
    /// Returns the descriptions of the attributes that the module publishes, and of its settings.
    pub(crate) fn abouts(&self) -> impl Iterator<Item = &About> {
        self.publishes.iter().chain(self.settings().map(|(about, _)| about))
    }

    /// Returns the settings with their values.
    pub(crate) fn settings(&self) -> impl Iterator<Item = (&About, &Reading)> {
        self.reads.iter().filter_map(|source| match source {
            ValueSource::Setting(about, reading) => Some((about, reading)),
            ValueSource::Attribute(..) => None,
        })
    }

    /// Changes a setting; returns `false` if there is no such setting.
    pub(crate) fn set(&mut self, name: &str, new: Reading) -> bool {
        let mut readings = self.reads.iter_mut().filter_map(|source| match source {
            ValueSource::Setting(about, reading) if &*about.name == name => Some(reading),
            ValueSource::Setting(..) | ValueSource::Attribute(..) => None,
        });
        readings.next().map(|reading| *reading = new).is_some()
    }

    fn abouts_mut(&mut self) -> impl Iterator<Item = &mut About> {
        let settings = self.reads.iter_mut().filter_map(|source| match source {
            ValueSource::Setting(about, _) => Some(about),
            ValueSource::Attribute(..) => None,
        });
        self.publishes.iter_mut().chain(settings)
    }
}
