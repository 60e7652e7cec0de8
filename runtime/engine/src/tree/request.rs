//! Requests to the tree and their answers, in the form that all front ends use.

use std::fmt;

use super::Role;

/// A request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Path of a node or a folder, such as `/clock/pace`.
    pub path: String,
    /// Operation on the node or folder.
    pub operation: Operation,
    /// Role of the user.
    pub role: Role,
}

/// Operation on a node or folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Operation {
    /// List the names in a folder.
    List,
    /// Read the value of an attribute.
    Get,
    /// Set an attribute or call a method at the next turn break.
    Change(Change),
    /// Start (`true`) or stop (`false`) reporting changes of an attribute, from the next turn break on. See
    /// [`Hub::report`](super::Hub::report).
    Watch(bool),
}

impl fmt::Display for Request {
    /// Writes the request as a command of the shell.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, operation, .. } = self;
        match operation {
            Operation::List => write!(f, "ls {path}"),
            Operation::Get => write!(f, "get {path}"),
            Operation::Change(Change::Set(text)) => write!(f, "set {path} {text}"),
            Operation::Change(Change::Call(arguments)) => {
                write!(f, "call {path}")?;
                arguments.iter().try_for_each(|argument| write!(f, " {argument}"))
            }
            Operation::Watch(true) => write!(f, "watch {path}"),
            Operation::Watch(false) => write!(f, "unwatch {path}"),
        }
    }
}

/// A change that a turn break carries out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Change {
    /// Set an attribute to the value that this text represents.
    Set(String),
    /// Call a method with these arguments.
    Call(Vec<String>),
}

/// The answer to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Names in a folder; folder names end with `/`.
    Entries(Vec<String>),
    /// A value.
    Value(String),
    /// Sentence about a change that was carried out; may be empty.
    Done(String),
    /// Sentence with the reason why the request was refused.
    Refused(String),
    /// No desk answers, because the run has ended or has not begun.
    Ended,
}
