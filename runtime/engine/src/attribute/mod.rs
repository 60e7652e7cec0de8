//! Attributes: typed values that modules publish at turn breaks. Other modules, plans and people read them (paper,
//! section III-B).

mod value;

use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use mdle_runtime::{Meters, MetersPerSecond, Nanos, Pose, Radians, RadiansPerSecond, Volts};
pub use value::{AttributeKind, Reading, Value};

/// Name of the number that every module has: the time since its last publication, in seconds. No attribute may
/// have this name.
pub(crate) const AGE: &str = "age";

/// A Rust type that an attribute can have.
pub trait Attribute: Sized {
    /// Kind of the attributes that have this type.
    const KIND: AttributeKind;
    /// Converts this value into a [`Value`] of kind [`Attribute::KIND`].
    fn into_value(self) -> Value;
    /// Returns the content of `value`; `None` if `value` has another kind.
    fn from_value(value: &Value) -> Option<Self>;
}

macro_rules! attributes {
    ($($type:ty => $kind:ident),* $(,)?) => {$(
        impl Attribute for $type {
            const KIND: AttributeKind = AttributeKind::$kind;

            fn into_value(self) -> Value {
                Value::$kind(self)
            }

            fn from_value(value: &Value) -> Option<Self> {
                if let Value::$kind(content) = value { Some(content.clone()) } else { None }
            }
        }
    )*};
}

attributes! {
    bool => Flag,
    i64 => Integer,
    f64 => Number,
    Meters => Length,
    MetersPerSecond => Speed,
    Radians => Angle,
    RadiansPerSecond => AngularRate,
    Volts => Voltage,
    Nanos => Time,
    Pose => Pose,
    Arc<str> => Text,
    Arc<[f64]> => Numbers,
    Arc<[u8]> => Bytes,
}

/// Handle of an attribute that a module publishes; [`Declare::publishes`](crate::Declare::publishes) returns it.
pub struct Out<T>(usize, PhantomData<fn(T)>);

/// Handle of a value that a module reads: an attribute of another module, or a setting of the module itself.
pub struct In<T>(usize, PhantomData<fn() -> T>);

macro_rules! places {
    ($($place:ident),*) => {$(
        impl<T> $place<T> {
            pub(crate) const fn new(place: usize) -> Self {
                Self(place, PhantomData)
            }

            /// Returns the index among the module's own attributes.
            pub(crate) const fn place(self) -> usize {
                self.0
            }
        }

        impl<T> Clone for $place<T> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<T> Copy for $place<T> {}

        impl<T: Attribute> fmt::Debug for $place<T> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} {} of {:?}", stringify!($place), self.0, T::KIND)
            }
        }
    )*};
}

places!(Out, In);

/// Name of an attribute: the name of its module, and the attribute's name within the module.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AttributeName {
    /// Name of the module.
    pub module: Arc<str>,
    /// Name of the attribute in the module.
    pub attribute: Arc<str>,
}

impl AttributeName {
    /// Creates the name of the attribute `attribute` of the module `module`.
    #[must_use]
    pub fn new(module: &str, attribute: &str) -> Self {
        Self { module: module.into(), attribute: attribute.into() }
    }
}

impl fmt::Display for AttributeName {
    /// Writes the path of the attribute in the tree: `/usr/MODULE/ATTRIBUTE`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "/usr/{}/{}", self.module, self.attribute)
    }
}

/// Returns `true` if `text` is a valid name of a module or an attribute. A name consists of ASCII letters, digits and
/// underscores, and does not begin with a digit, as in MDLe.
pub(crate) fn is_name(text: &str) -> bool {
    let begins = text.starts_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_');
    begins && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}
