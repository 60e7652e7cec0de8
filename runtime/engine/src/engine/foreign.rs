//! Attributes of other robots, which the state link puts on the board before a turn.

use mdle_runtime::ModuleRead;

use super::modules::Modules;
use crate::attribute::{AttributeName, Reading};
use crate::board::Post;
use crate::link::Foreign;
use crate::module::Refusal;

/// Maximum number of attributes of other robots.
const MOST: usize = 320;

impl<Y: Send + Sync + 'static> Foreign for Modules<Y> {
    fn put_foreign(&mut self, name: &AttributeName, reading: Reading) -> Result<(), Refusal> {
        let kind = reading.value.kind();
        if self.loaded.iter().any(|module| module.name == name.module) {
            return Err(Refusal::NameTaken(name.module.to_string()));
        }
        match self.board.post(&name.module, &name.attribute).map(|post| post.about.kind) {
            Some(known) if known != kind => return Err(Refusal::ChangedKind(name.clone(), known, kind)),
            Some(_) => {}
            None if self.foreign().count() >= MOST => return Err(Refusal::TooMany(MOST)),
            None => {
                self.board.restore(name.clone(), kind);
                let refused = self.loaded.iter().find_map(|module| self.rewired(module).err());
                if let Some(refusal) = refused {
                    self.board.forget(name);
                    return Err(refusal);
                }
                self.rewire();
            }
        }
        self.board.restore_reading(name, reading);
        Ok(())
    }
}

impl<Y: Send + Sync + 'static> Modules<Y> {
    /// Returns the attributes of other robots.
    pub(crate) fn foreign(&self) -> impl Iterator<Item = &Post> {
        let is_own = |post: &&Post| self.loaded.iter().any(|module| module.name == post.name.module);
        self.board.posts().iter().filter(move |post| !is_own(post))
    }

    /// Checks that all modules named in `reads` are loaded.
    ///
    /// # Errors
    /// Fails if a module is not loaded.
    pub(super) fn check_loaded(&self, reads: &[ModuleRead]) -> Result<(), Refusal> {
        let missing = reads.iter().find(|read| !self.loaded.iter().any(|module| *module.name == *read.module));
        missing.map_or(Ok(()), |read| Err(Refusal::Unknown(read.module.to_owned())))
    }
}
