//! Finds attributes that a loaded module reads but no loaded module publishes.

use mdle_compiler::alphabet::nearest;

use crate::attribute::AttributeName;
use crate::board::Board;
use crate::module::{Declared, ValueSource};
use crate::tree::listed;

/// Returns a sentence about the attributes that a module reads but no loaded module publishes; `None` if there are no
/// such attributes.
pub(super) fn unpublished(reader: &str, declared: &Declared, board: &Board) -> Option<String> {
    let names = declared.reads.iter().filter_map(|source| match source {
        ValueSource::Attribute(name, _) => Some(name),
        ValueSource::Setting(..) => None,
    });
    let names: Vec<_> = names.filter(|name| board.place(&name.module, &name.attribute).is_none()).collect();
    let paths: Vec<_> = names.iter().map(ToString::to_string).collect();
    let near = names
        .iter()
        .find_map(|name| near(name, board))
        .map_or_else(String::new, |near| format!("; did you mean {near}?"));
    (!names.is_empty()).then(|| format!("module `{reader}` reads {}, which no module publishes{near}", listed(&paths)))
}

/// Returns the attribute with the most similar name. Searches the module that `name` names or, if that module publishes
/// nothing, the module with the most similar name. Returns `None` if no name is similar.
fn near(name: &AttributeName, board: &Board) -> Option<AttributeName> {
    let is_loaded = board.of(&name.module).next().is_some();
    let modules = board.posts().iter().map(|post| &*post.name.module);
    let module = if is_loaded { &*name.module } else { nearest(&name.module, modules)? };
    let attributes = board.of(module).map(|post| &*post.name.attribute);
    nearest(&name.attribute, attributes).map(|attribute| AttributeName::new(module, attribute))
}
