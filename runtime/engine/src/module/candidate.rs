//! Modules that have been created and can be loaded at a turn break.

use std::any::Any;
use std::fmt;
use std::ops::Deref;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use super::{Background, Declare, Declared, Exchange, Fault, Gate, Module, Ports, ThreadEnd};
use crate::attribute::{AttributeKind, AttributeName, is_name};

/// Name of the module that makes the turns of plans; no other module may have it.
pub const PLAN: &str = "mdle";
/// Name under which the robot is in the tree of attributes, beside the modules; no module may have this name.
pub(crate) const ROBOT: &str = "robot";

/// A module that has been created and not yet loaded. The robot's turns do not wait while it is being created.
pub struct Candidate<Y> {
    pub(crate) name: Arc<str>,
    pub(crate) declared: Declared,
    pub(crate) form: Form<Y>,
}

/// The code of a module.
pub(crate) enum Form<Y> {
    /// A module that makes a turn in every turn of the engine.
    Registered(Box<dyn Module<Y>>, Ports),
    /// A module with a thread of its own.
    Background(ThreadGate),
}

/// Gate of a background module's thread, and the maximum wait for the end of the thread. Dropping the gate asks the
/// thread to end, and waits for this.
#[derive(Debug)]
pub(crate) struct ThreadGate(Arc<Gate>, Duration);

impl Deref for ThreadGate {
    type Target = Gate;

    fn deref(&self) -> &Gate {
        &self.0
    }
}

impl Drop for ThreadGate {
    fn drop(&mut self) {
        self.0.stop();
        if !self.1.is_zero() {
            self.0.wait_for_end(self.1);
        }
    }
}

/// Reason why a module cannot be loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// Another loaded module has this name.
    NameTaken(String),
    /// No module may have this name.
    BadName(String),
    /// The name is reserved for a part of the engine.
    Reserved(String),
    /// No module of this name is loaded.
    Unknown(String),
    /// The module of this name makes no further turn.
    Over(String),
    /// A module has no setting of this name: the names of the module and the setting.
    NoSetting(String, String),
    /// A setting has another kind than the value: the path of the setting, its kind, and the kind of the value.
    OtherSetting(AttributeName, AttributeKind, AttributeKind),
    /// The value for a setting is NaN: the path of the setting.
    NotANumber(AttributeName),
    /// The declaration of the module is invalid: the name of the module, and a sentence.
    Declaration(String, String),
    /// The function that creates the module panicked: the name of the module, and the message.
    Panicked(String, String),
    /// A module reads an attribute as another kind than the attribute has.
    OtherKind {
        /// Name of the module that reads the attribute.
        reader: String,
        /// Name of the attribute.
        name: AttributeName,
        /// Kind that the reader expects.
        read: AttributeKind,
        /// Kind of the attribute as published.
        published: AttributeKind,
    },
    /// Another robot publishes an attribute as another kind than before: the path of the attribute, the kind
    /// before, and the kind now.
    ChangedKind(AttributeName, AttributeKind, AttributeKind),
    /// Other robots share too many attributes: the maximum.
    TooMany(usize),
    /// The system could not create a thread for the module: the name of the module, and the system's message.
    NoThread(String, String),
    /// The child process of the module breaks the protocol: the name of the module, and a sentence.
    Process(String, String),
    /// The run was asked to end while the module was being created.
    Ended,
}

impl<Y> Candidate<Y> {
    /// Creates a registered module of this name.
    ///
    /// # Errors
    /// Fails if the name or the declaration is invalid, or if `make` panicked.
    pub fn registered<M: Module<Y> + 'static>(
        name: &str,
        make: impl FnOnce(&mut Declare) -> M,
    ) -> Result<Self, Refusal> {
        let (module, Declare { declared, ports, .. }) = made(name, make)?;
        Ok(Self { name: name.into(), declared, form: Form::Registered(Box::new(module), ports) })
    }

    /// Creates a background module of this name. Its thread waits until the module is loaded.
    ///
    /// # Errors
    /// Fails if the name or the declaration is invalid, if `make` panicked, or if the system cannot create the thread.
    pub fn background<M: Background>(name: &str, make: impl FnOnce(&mut Declare) -> M) -> Result<Self, Refusal> {
        let (module, Declare { declared, ports, .. }) = made(name, make)?;
        let gate = Arc::new(Gate::default());
        let exchange = Exchange::new(Arc::clone(&gate), ports);
        let own = Arc::clone(&gate);
        let run = move || {
            let has_begun = own.wait_for_begin();
            let run = || if has_begun { Box::new(module).run(exchange) } else { Ok(()) };
            own.has_ended(match catch_unwind(AssertUnwindSafe(run)) {
                Ok(Ok(())) => ThreadEnd::Returned,
                Ok(Err(Fault(sentence))) => ThreadEnd::Failed(sentence),
                Err(payload) => ThreadEnd::Panicked(panicked(payload)),
            });
        };
        let thread = thread::Builder::new().name(name.to_owned()).spawn(run);
        thread.map_err(|error| Refusal::NoThread(name.to_owned(), error.to_string()))?;
        let gate = ThreadGate(gate, declared.farewell);
        Ok(Self { name: name.into(), declared, form: Form::Background(gate) })
    }

    /// Returns the name of the module.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Calls the function that creates a module.
fn made<M>(name: &str, make: impl FnOnce(&mut Declare) -> M) -> Result<(M, Declare), Refusal> {
    if !is_name(name) {
        return Err(Refusal::BadName(name.to_owned()));
    }
    let mut declare = Declare::default();
    let module = catch_unwind(AssertUnwindSafe(|| make(&mut declare)));
    let module = module.map_err(|payload| Refusal::Panicked(name.to_owned(), panicked(payload)))?;
    match declare.fault.take() {
        Some(sentence) => Err(Refusal::Declaration(name.to_owned(), sentence)),
        None => Ok((module, declare)),
    }
}

/// Returns the message of a panic.
pub(crate) fn panicked(payload: Box<dyn Any + Send>) -> String {
    let message = match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
        (Some(message), _) => (*message).to_owned(),
        (None, Some(message)) => message.clone(),
        (None, None) => "no message".to_owned(),
    };
    // A payload may panic once more when it is dropped.
    std::mem::forget(payload);
    message
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NameTaken(name) => write!(f, "a module `{name}` is loaded already"),
            Self::BadName(name) => {
                write!(f, "`{name}` is no name of a module: ASCII letters, digits and `_`, and no digit first")
            }
            Self::Reserved(name) => {
                write!(f, "the name `{name}` is reserved for `/usr/{name}`: give the module another name")
            }
            Self::Over(name) => {
                write!(
                    f,
                    "module `{name}` makes no further turn: unload it with `call /usr/{name}/.unload`, and load it again"
                )
            }
            Self::Unknown(name) => write!(f, "no module `{name}` is loaded"),
            Self::NoSetting(name, setting) => write!(f, "module `{name}` has no setting `{setting}`"),
            Self::OtherSetting(name, kind, other) => {
                write!(f, "{name} is {}, and the value is {}", kind.words(), other.words())
            }
            Self::NotANumber(name) => write!(f, "{name} cannot be NaN"),
            Self::Declaration(name, sentence) => write!(f, "the declaration of module `{name}` is wrong: {sentence}"),
            Self::Panicked(name, message) => {
                write!(f, "module `{name}` panicked while it was made, which is a bug: {message}")
            }
            Self::OtherKind { reader, name, read, published } => write!(
                f,
                "module `{reader}` reads {name} as {}, and it is published as {}",
                read.words(),
                published.words()
            ),
            Self::ChangedKind(name, before, now) => {
                write!(f, "{name} was {} before, and is {} now", before.words(), now.words())
            }
            Self::TooMany(most) => write!(f, "other robots share {most} attributes already, which is the most"),
            Self::NoThread(name, message) => write!(f, "the system gives no thread for module `{name}`: {message}"),
            Self::Process(name, sentence) => write!(f, "module `{name}` cannot be loaded: {sentence}"),
            Self::Ended => f.write_str("the run was asked to end while its modules were made"),
        }
    }
}

impl std::error::Error for Refusal {}
