//! The robot of the playground: the target `sim`.

use std::sync::OnceLock;

use mdle_compiler::builtin::{self, ReadAlphabet};
use mdle_simulator::alphabet::NAME;

/// Returns the alphabet of the target `sim`, which is read once.
///
/// # Errors
/// Never: it is part of mdlec. A sentence all the same.
pub(crate) fn robot() -> Result<&'static ReadAlphabet, String> {
    static ROBOT: OnceLock<Result<ReadAlphabet, String>> = OnceLock::new();
    let read = || {
        let own = builtin::alphabets().iter().find(|alphabet| alphabet.target && alphabet.name == NAME);
        let own = own.map(|own| (own.file.to_owned(), own.text.to_owned()));
        builtin::read(own).map_err(|(_, found)| format!("the alphabet of `{NAME}` has {} errors", found.len()))
    };
    ROBOT.get_or_init(read).as_ref().map_err(Clone::clone)
}
