//! Proposes laws for movements that a user has written with commands of other languages. The laws are from the paper or
//! from this project.

use crate::alphabet::{ParameterKind, Unit};
use crate::syntax::tree::{Arg, Call, Number};

/// A law that the user probably meant.
pub(in crate::plan) struct Proposal {
    pub(in crate::plan) name: &'static str,
    pub(in crate::plan) call: String,
    /// Text of the help message, with `{}` in the place of the call.
    pub(in crate::plan) words: &'static str,
}

/// Returns the law that a call such as `turnLeft 90`, `backup 50cm` or `forward 20` probably means.
pub(in crate::plan) fn meant(call: &Call) -> Option<Proposal> {
    let word = call.name.to_ascii_lowercase().replace('_', "");
    let number = match call.args {
        [] => None,
        [Arg::Number(number)] => Some(number),
        _ => return None,
    };
    let amount = |number: &Number<'_>| format!("{}{}", number.digits(), number.unit().unwrap_or_default());
    let is = |kinds: &[ParameterKind]| {
        let kind = number.and_then(|number| number.unit()).map(|unit| Unit::from_name(unit).map(|unit| unit.kind));
        kind.is_none_or(|kind| kind.is_some_and(|kind| kinds.contains(&kind)))
    };
    let is_positive = number.is_none_or(|number| !number.digits().starts_with(['-', '+']));
    let law = |name, call, words| Some(Proposal { name, call, words });
    match word.as_str() {
        "left" | "turnleft" | "rotateleft" if is(&[ParameterKind::Angle]) && is_positive => {
            let angle = number.map_or("90deg".to_owned(), amount);
            law("turn", format!("turn {angle}"), "a turn to the left is positive: {}")
        }
        "right" | "turnright" | "rotateright" if is(&[ParameterKind::Angle]) && is_positive => {
            let angle = number.map_or("90deg".to_owned(), amount);
            law("turn", format!("turn -{angle}"), "a turn to the right is negative: {}")
        }
        "back" | "backup" | "backward" | "backwards" | "reverse" | "retreat"
            if is(&[ParameterKind::Length]) && is_positive =>
        {
            let way = number.map_or("50cm".to_owned(), amount);
            law("advance", format!("advance -{way}"), "a way back is negative: {}")
        }
        "forward" | "forwards" | "ahead" | "straight" | "drive" | "move" => {
            let number = number?;
            match number.unit().and_then(Unit::from_name).map(|unit| unit.kind) {
                Some(ParameterKind::Length) => {
                    law("advance", format!("advance {}", amount(number)), "a way straight ahead is {}")
                }
                None | Some(ParameterKind::Speed) => law(
                    "go",
                    format!("go {} 0", amount(number)),
                    "a speed and a turn rate are the arguments of `go`: {}",
                ),
                Some(_) => None,
            }
        }
        _ => None,
    }
}
