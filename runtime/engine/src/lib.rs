//! The Modular Engine (section III of the paper): modules and plans that make a robot's turns together.
#![forbid(unsafe_code)]

mod attribute;

pub use attribute::{Attribute, AttributeKind, AttributeName, In, Out, Reading, Value};
