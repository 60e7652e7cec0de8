//! Modules that were created and can be loaded at a turn break.

use std::any::Any;
use std::fmt;
use std::ops::Deref;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use super::{Background, Declare, Declared, Exchange, Fault, Gate, Module, Ports, ThreadEnd};
use crate::attribute::{AttributeKind, AttributeName, is_name};

/// Name of the module that makes the turns of plans; reserved.
pub const PLAN: &str = "mdle";
/// Name under which the tree of attributes lists the robot beside the modules; reserved.
pub(crate) const ROBOT: &str = "robot";

/// A module that was created but is not loaded yet. The robot's turns do not wait for the creation of a module.
pub struct Candidate<Y> {
    pub(crate) name: Arc<str>,
    pub(crate) declared: Declared,
    pub(crate) form: Form<Y>,
}

/// The code of a module.
pub(crate) enum Form<Y> {
    /// A module that makes a turn in every turn of the engine.
    Registered(Box<dyn Module<Y>>, Ports),
    /// A background module with its own thread.
    Background(ThreadGate),
}

/// Gate of a background module's thread, and the maximum time to wait for the end of the thread. Dropping this value
/// asks the thread to end, and waits for its end.
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
    /// The name is not a valid name of a module.
    BadName(String),
    /// The name is reserved for a part of the engine.
    Reserved(String),
    /// No module of this name is loaded.
    Unknown(String),
    /// A module with this name exists, but it will never make another turn.
    Over(String),
    /// A module has no such setting; contains the names of the module and of the setting.
    NoSetting(String, String),
    /// The new value for a setting has another kind than the setting. Contains the path and the kind of the setting,
    /// and the kind of the value.
    OtherSetting(AttributeName, AttributeKind, AttributeKind),
    /// The new value for a setting is NaN; contains the path of the setting.
    NotANumber(AttributeName),
    /// The declaration of the module is invalid; contains the name of the module, and a sentence.
    Declaration(String, String),
    /// The function that creates the module panicked; contains the name of the module, and the panic message.
    Panicked(String, String),
    /// A module that reads an attribute expects another kind than the attribute has.
    OtherKind {
        /// Name of the module that reads the attribute.
        reader: String,
        /// Name of the attribute.
        name: AttributeName,
        /// Kind that the reader expects.
        read: AttributeKind,
        /// Kind with which the attribute is published.
        published: AttributeKind,
    },
    /// Another robot has changed the kind of an attribute; contains the path of the attribute, the old kind, and the
    /// new kind.
    ChangedKind(AttributeName, AttributeKind, AttributeKind),
    /// Other robots share too many attributes; contains the maximum number.
    TooMany(usize),
    /// The system could not create a thread for the module; contains the name of the module, and the system's message.
    NoThread(String, String),
    /// The child process of the module violates the protocol; contains the name of the module, and a sentence.
    Process(String, String),
    /// The run was asked to end while the module was being created.
    Ended,
}

impl<Y> Candidate<Y> {
    /// Creates a registered module with this name.
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

    /// Creates a background module with this name. Its thread waits until the module is loaded.
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

/// Calls the function that creates a module; returns the module and its declaration.
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
    // Dropping a payload may panic again.
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
