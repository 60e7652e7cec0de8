//! The board, which contains the last value of every attribute of every module and changes only between turns.
//! Positions on the board are fixed when modules are loaded or unloaded, so no turn has to look up names.

use std::sync::Arc;

use mdle_compiler::alphabet::ParameterKind;
use mdle_runtime::{ModuleRead, Nanos};

use crate::attribute::{AGE, AttributeKind, AttributeName, Reading, Value};
use crate::module::{About, Declared, Ports, Refusal, ValueSource};

/// All attributes of the loaded modules, in the order in which the modules were loaded.
#[derive(Debug, Default)]
pub struct Board {
    posts: Vec<Post>,
    /// Attributes whose first value with NaN was rejected since the last call of [`Board::newly_refused`].
    refused: Vec<AttributeName>,
}

/// An attribute on the board, with its last value.
#[derive(Debug, Clone, PartialEq)]
pub struct Post {
    /// Name of the attribute.
    pub name: AttributeName,
    /// Kind, unit and description of the attribute.
    pub about: About,
    /// The value that was published last; `None` before the first publication.
    pub reading: Option<Reading>,
    /// Latency of the module: the declared time between two of its exchanges.
    pub latency: Nanos,
    /// Number of values that were not published because they contain NaN.
    pub refused: u64,
}

/// Board position of each value that a module reads, in the order of the module's declaration. The entry is `None` for
/// a setting, and for an attribute that no module publishes.
pub(crate) type Wires = Vec<Option<usize>>;

impl Board {
    /// Returns the attributes in the order in which their modules were loaded.
    #[must_use]
    pub fn posts(&self) -> &[Post] {
        &self.posts
    }

    /// Returns the attributes of a module.
    pub fn of(&self, module: &str) -> impl Iterator<Item = &Post> {
        self.posts.iter().filter(move |post| &*post.name.module == module)
    }

    /// Returns an attribute; `None` if it is not on the board.
    #[must_use]
    pub fn post(&self, module: &str, attribute: &str) -> Option<&Post> {
        self.place(module, attribute).and_then(|place| self.posts.get(place))
    }

    /// Returns the position of an attribute; `None` if it is not on the board.
    pub(crate) fn place(&self, module: &str, attribute: &str) -> Option<usize> {
        self.posts.iter().position(|post| &*post.name.module == module && &*post.name.attribute == attribute)
    }

    /// Returns the position of an attribute that a plan reads; for `age`, returns the position of the module's first
    /// attribute. Returns `None` if the attribute is not on the board.
    pub(crate) fn place_of(&self, read: &ModuleRead) -> Option<usize> {
        if read.attribute == AGE {
            return self.posts.iter().position(|post| &*post.name.module == read.module);
        }
        self.place(read.module, read.attribute)
    }

    /// Adds the attributes of a module.
    pub(crate) fn add(&mut self, module: &str, declared: &Declared) {
        self.posts.extend(declared.publishes.iter().map(|about| Post {
            name: AttributeName::new(module, &about.name),
            about: about.clone(),
            reading: None,
            latency: declared.latency,
            refused: 0,
        }));
    }

    /// Removes the attributes of a module.
    pub(crate) fn remove(&mut self, module: &str) {
        self.posts.retain(|post| &*post.name.module != module);
    }

    /// Returns the position of a module's first attribute; if the module has none, returns the number of all
    /// attributes.
    pub(crate) fn first(&self, module: &str) -> usize {
        self.posts.iter().position(|post| &*post.name.module == module).unwrap_or(self.posts.len())
    }

    /// Adds an attribute whose module is not loaded in this engine, because the attribute belongs to another robot or
    /// to a recorded run that is being replayed. Replaces an earlier attribute with this name.
    pub(crate) fn restore(&mut self, name: AttributeName, kind: AttributeKind) {
        self.forget(&name);
        let unit = kind.quantity().and_then(ParameterKind::base_unit);
        let about = About { name: Arc::clone(&name.attribute), kind, unit, doc: "" };
        self.posts.push(Post { name, about, reading: None, latency: Nanos::ZERO, refused: 0 });
    }

    /// Sets the value of a restored attribute to its value in the recorded run.
    pub(crate) fn restore_reading(&mut self, name: &AttributeName, reading: Reading) {
        if let Some(post) = self.posts.iter_mut().find(|post| post.name == *name) {
            post.reading = Some(reading);
        }
    }

    /// Removes one attribute.
    pub(crate) fn forget(&mut self, name: &AttributeName) {
        self.posts.retain(|post| post.name != *name);
    }

    /// Returns the positions on the board of all values that a module reads.
    ///
    /// # Errors
    /// Fails if an attribute does not have the kind that the module expects.
    pub(crate) fn wires(&self, reader: &str, declared: &Declared) -> Result<Wires, Refusal> {
        let wire = |source: &ValueSource| {
            let ValueSource::Attribute(name, read) = source else { return Ok(None) };
            let Some(place) = self.place(&name.module, &name.attribute) else { return Ok(None) };
            match self.posts.get(place).map(|post| post.about.kind) {
                Some(published) if published != *read => {
                    Err(Refusal::OtherKind { reader: reader.to_owned(), name: name.clone(), read: *read, published })
                }
                Some(_) | None => Ok(Some(place)),
            }
        };
        declared.reads.iter().map(wire).collect()
    }

    /// Publishes the values of a module whose attributes begin at position `first`; calls `published` with the position
    /// of each published value, and the value.
    pub(crate) fn publish(
        &mut self,
        first: usize,
        ports: &mut Ports,
        now: Nanos,
        mut published: impl FnMut(usize, &Value),
    ) {
        for (place, out) in (first..).zip(&mut ports.outs) {
            if let Some(value) = out.take() {
                published(place, &value);
                self.put(place, value, now);
            }
        }
    }

    /// Publishes one value, unless it contains NaN.
    pub(crate) fn put(&mut self, place: usize, value: Value, now: Nanos) {
        let Some(post) = self.posts.get_mut(place) else { return };
        if value.has_nan() {
            post.refused = post.refused.saturating_add(1);
            if post.refused == 1 {
                self.refused.push(post.name.clone());
            }
        } else {
            post.reading = Some(Reading { value, at: now });
        }
    }

    /// Returns the attributes whose first value with NaN was rejected since the last call.
    pub(crate) fn newly_refused(&mut self) -> impl Iterator<Item = AttributeName> {
        self.refused.drain(..)
    }

    /// Updates a module's copies of the values that it reads. A removed attribute has no value any more.
    pub(crate) fn hand(&self, declared: &Declared, wires: &[Option<usize>], ports: &mut Ports) {
        for ((source, wire), copy) in declared.reads.iter().zip(wires).zip(&mut ports.ins) {
            let reading = match source {
                ValueSource::Setting(_, reading) => Some(reading),
                ValueSource::Attribute(..) => wire.and_then(|place| self.posts.get(place)?.reading.as_ref()),
            };
            if copy.as_ref() != reading {
                *copy = reading.cloned();
            }
        }
    }
}
