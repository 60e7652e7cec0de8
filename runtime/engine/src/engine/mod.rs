//! The engine: modules, their turns, and the turn breaks between the turns.

mod event;
mod foreign;
mod hold;
mod janitor;
mod loaded;
mod loading;
mod modules;
mod piloting;
mod relevance;
mod turns;
mod unpublished;

pub use event::{Arrivals, End, Event};
pub use hold::HoldEffect;
pub use loaded::ModuleState;
pub use modules::{Modules, Service};
pub use piloting::Engine;
