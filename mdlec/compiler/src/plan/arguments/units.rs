//! Reports units that are separated from their numbers by a space, and so were read as separate arguments.

use super::Arguments;
use crate::alphabet::Unit;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::nearest_unit;
use crate::syntax::tree::{Arg, Call, Number};

/// Reports the units in `call` that are separated from their numbers, and the errors that remain after each unit is
/// joined to its number; `None` if no unit is separated.
pub(super) fn apart(
    call: &Call,
    fitted: impl Fn(&Call) -> Result<Arguments, Vec<Diagnostic>>,
) -> Option<Vec<Diagnostic>> {
    let mut texts = Vec::new();
    let mut args = call.args.iter().peekable();
    while let Some(arg) = args.next() {
        let unit = args.peek().and_then(|next| unit_of(arg, next));
        texts.push((arg, unit));
        if unit.is_some() {
            args.next();
        }
    }
    let pairs: Vec<_> = texts.iter().filter_map(|(_, unit)| *unit).collect();
    if pairs.is_empty() {
        return None;
    }
    let written =
        |(arg, unit): &(&Arg<'_>, Option<Apart<'_>>)| unit.map(|unit| (arg.span().to(unit.span), unit.text()));
    let joined: Vec<_> = texts.iter().map(written).collect();
    let touching = texts.iter().zip(&joined).map(|((arg, _), joined)| match joined {
        Some((span, text)) => Arg::Number(Number::new(text, *span)),
        None => **arg,
    });
    let touching: Vec<_> = touching.collect();
    let wrong = fitted(&Call { args: &touching, ..*call }).err().unwrap_or_default();
    // If the number of arguments is wrong, it is not known which argument belongs to which parameter.
    let wrong: Vec<_> = wrong.into_iter().filter(|wrong| wrong.code != Code::E0301).collect();
    let is_wrong = |span: Span| wrong.iter().any(|wrong| wrong.span() == Some(span));
    let apart = pairs.iter().filter(|pair| !is_wrong(pair.whole())).map(Apart::report);
    Some(apart.chain(wrong.iter().cloned()).collect())
}

/// A number whose unit follows after a space.
#[derive(Clone, Copy)]
struct Apart<'s> {
    number: Number<'s>,
    unit: &'static str,
    /// Span of the unit.
    span: Span,
}

fn unit_of<'s>(number: &Arg<'s>, unit: &Arg<'s>) -> Option<Apart<'s>> {
    let (Arg::Number(number), Arg::Name(unit)) = (number, unit) else { return None };
    let name = Unit::from_name(nearest_unit(unit.node)?)?.name;
    number.unit().is_none().then_some(Apart { number: *number, unit: name, span: unit.span })
}

impl Apart<'_> {
    fn text(self) -> String {
        format!("{}{}", self.number.digits(), self.unit)
    }

    fn whole(&self) -> Span {
        self.number.span.to(self.span)
    }

    fn report(&self) -> Diagnostic {
        let message = format!("there is a space between `{}` and its unit `{}`", self.number.digits(), self.unit);
        let diagnostic = Diagnostic::new(Code::E0104, message, self.span, "remove the space before this unit");
        diagnostic.fix("write {}", self.whole(), self.text())
    }
}
