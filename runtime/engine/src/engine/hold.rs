//! Stops and starts modules on a user's request.

use super::loaded::ModuleState;
use super::modules::Modules;
use crate::module::Refusal;

/// Effect of a request to stop or to start a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HoldEffect {
    /// The request has no effect, because the module was already in the requested state.
    None,
    /// The module stops: it makes no turns from the next turn on.
    Stops,
    /// The module already makes no turns because nothing reads it. From now on, it makes no turns even if something
    /// reads it.
    StaysStopped,
    /// The module starts: it makes turns from the next turn on.
    Starts,
    /// The module makes no turns until something reads it.
    WaitsForReaders,
    /// The module is late, and is stopped when its current turn ends.
    StopsWhenDone,
    /// The module is late, and makes turns again when its current turn ends.
    StartsWhenDone,
}

impl<Y: Send + Sync + 'static> Modules<Y> {
    /// Stops a module on a user's request if `is_held` is `true`, or lets it make turns again; returns the effect of
    /// the request.
    ///
    /// # Errors
    /// Fails if no module has this name, or if the module will never make a turn again.
    pub fn hold(&mut self, name: &str, is_held: bool) -> Result<HoldEffect, Refusal> {
        let number = self.number(name)?;
        let is_relevant = self.relevant().get(number).copied().unwrap_or_default();
        let Some(module) = self.loaded.get_mut(number).filter(|module| !module.state.is_final()) else {
            return Err(Refusal::Over(name.to_owned()));
        };
        let was_held = std::mem::replace(&mut module.is_held, is_held);
        let is_late = matches!(module.state, ModuleState::Late(..));
        self.has_changed = true;
        Ok(match (is_held, was_held) {
            (true, true) => HoldEffect::None,
            (true, false) if is_late => HoldEffect::StopsWhenDone,
            (true, false) if is_relevant => HoldEffect::Stops,
            (true, false) => HoldEffect::StaysStopped,
            (false, _) if !is_relevant => HoldEffect::WaitsForReaders,
            (false, true) if is_late => HoldEffect::StartsWhenDone,
            (false, true) => HoldEffect::Starts,
            (false, false) => HoldEffect::None,
        })
    }
}
