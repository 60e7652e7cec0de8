//! The values of the options that load modules.

use mdle_quantity::Quantity;

/// Reads the name and the command line of a module.
pub(super) fn module(text: &str) -> Result<(String, String), String> {
    let split = text.split_once('=').filter(|(name, command)| !name.is_empty() && !command.trim().is_empty());
    let (name, command) = split.ok_or("write NAME=COMMAND, as in `--module 'ears=python3 ears.py'`")?;
    Ok((name.to_owned(), command.to_owned()))
}

/// Reads a point, in metres.
pub(super) fn point(text: &str) -> Result<(f64, f64), String> {
    let (x, y) = text.split_once(',').ok_or("write X,Y, as in `--point 3,0.5`")?;
    let metres = |text: &str| Quantity::Length.read(text.trim(), "m");
    Ok((metres(x)?, metres(y)?))
}
