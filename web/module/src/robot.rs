//! The robots for which the playground checks plans. It runs all plans on the target `sim`.

use std::sync::OnceLock;

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::builtin::{self, ReadAlphabet};
use mdle_simulator::alphabet::NAME;

/// An alphabet that is read once, when it is first needed.
type Once = OnceLock<Result<ReadAlphabet, String>>;

/// Returns the alphabet of a robot that is part of mdlec, or the alphabet of `sim` if `name` is empty.
///
/// # Errors
/// Fails if there is no such robot.
pub(crate) fn robot(name: &str) -> Result<&'static ReadAlphabet, String> {
    static ROBOTS: OnceLock<Vec<(&builtin::Alphabet, Once)>> = OnceLock::new();
    let name = if name.is_empty() { NAME } else { name };
    let targets = || builtin::alphabets().iter().filter(|alphabet| alphabet.target);
    let robots = ROBOTS.get_or_init(|| targets().map(|alphabet| (alphabet, Once::new())).collect());
    let (alphabet, once) = robots.iter().find(|(alphabet, _)| alphabet.name == name).ok_or_else(|| {
        let names: Vec<_> = targets().map(|alphabet| alphabet.name).collect();
        format!("robot: there is no robot {name:?}{}", did_you_mean(name, &names))
    })?;
    let read = || {
        let own = Some((alphabet.file.to_owned(), alphabet.text.to_owned()));
        builtin::read(own).map_err(|(_, found)| format!("the alphabet of `{name}` has {} errors", found.len()))
    };
    once.get_or_init(read).as_ref().map_err(Clone::clone)
}
