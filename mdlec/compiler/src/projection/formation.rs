//! Projects formations. `formation SHAPE SPACING (LAW)` becomes the law of the first robot, and a `slot` for each of
//! the other robots.

use super::build::Build;
use crate::alphabet::{Alphabet, Param, ParameterKind, Unit, did_you_mean};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{Arg, Call};

/// Word that begins a formation.
pub(super) const FORMATION: &str = "formation";
/// Name of the law with which the first robot leaves room for the other robots.
const LEAD: &str = "lead";
/// Height of a triangle with sides of length 1.
const HEIGHT: f64 = 0.866_025_403_784_438_6;
/// Minimum distance between robots, in metres.
const LEAST: f64 = 0.01;
const EXAMPLE: &str = "a formation is written `formation triangle 1m (goAvoid 0 7m 20)`";

/// Laws of a formation.
pub(super) struct Formation<'s> {
    /// Law of the first robot.
    pub(super) first: &'s Call<'s>,
    /// Laws of the other robots, in the order of the group.
    pub(super) others: Vec<&'s Call<'s>>,
}

/// Shape of a formation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    Line,
    Column,
    Triangle,
}

const SHAPES: [(&str, Shape); 3] = [("line", Shape::Line), ("column", Shape::Column), ("triangle", Shape::Triangle)];

impl Shape {
    /// Returns the position of a robot relative to the first robot, as distances ahead and to the left, for a spacing
    /// of
    /// 1. `number` counts the robots after the first, from 0.
    fn slot(self, number: u32) -> (f64, f64) {
        let (row, side) = (f64::from(number / 2 + 1), if number.is_multiple_of(2) { 1.0 } else { -1.0 });
        match self {
            Self::Line => (0.0, side * row),
            Self::Column => (-f64::from(number + 1), 0.0),
            Self::Triangle => (-HEIGHT, side * 0.5),
        }
    }

    /// Returns the width that must be free beside the first robot for `others` more robots, for a spacing of 1. A
    /// column needs some width because it swings out in bends.
    fn width(self, others: u32) -> f64 {
        match self {
            Self::Line => f64::from(others.div_ceil(2)),
            Self::Column | Self::Triangle => 0.5,
        }
    }
}

/// Reads a formation of the group's robots. Reports an invalid formation and returns `None` for it.
pub(super) fn read<'s>(call: &Call<'s>, build: &mut Build<'_, 's>) -> Option<Formation<'s>> {
    let others = u32::try_from(build.robots.len().saturating_sub(1)).unwrap_or(u32::MAX);
    let shape = shape(call, others);
    let spacing = call.args.get(1).ok_or_else(|| incomplete(call, "no distance of its robots")).and_then(spacing);
    let law = law(call);
    let (shape, (metres, span), law) = match (shape, spacing, law) {
        (Ok(shape), Ok(spacing), Ok(law)) => (shape, spacing, law),
        (shape, spacing, law) => {
            // If one part is missing, the parts after it are missing as well.
            let errors = [shape.err(), spacing.err(), law.err()];
            build.found.extend(errors.into_iter().flatten().take(if call.args.len() < 3 { 1 } else { 3 }));
            return None;
        }
    };
    let room = build.length(shape.width(others) * metres, span);
    let first = match law.name {
        // If the arguments do not fit, the law stays as written, so that the errors name the written law.
        "goAvoid" if fit(law.args, build.alphabet) => {
            let args: Vec<_> = std::iter::once(room).chain(law.args.iter().copied()).collect();
            build.call(LEAD, &args, law.span)
        }
        _ => build.call(law.name, law.args, law.span),
    };
    let slots = (0..others).map(|number| {
        let (ahead, left) = shape.slot(number);
        let args = [build.first(span), build.length(ahead * metres, span), build.length(left * metres, span)];
        build.call("slot", &args, call.span)
    });
    Some(Formation { first, others: slots.collect() })
}

/// Returns `true` if these arguments of `goAvoid` fit the parameters of `lead` that follow the width.
fn fit(args: &[Arg<'_>], alphabet: &Alphabet) -> bool {
    let fits = |arg: &Arg<'_>, param: &Param| match arg {
        Arg::Number(number) => {
            let unit = number.unit().map(Unit::from_name);
            unit.is_none_or(|unit| unit.is_some_and(|unit| unit.kind == param.kind))
        }
        Arg::Infinity(_) | Arg::String(_) | Arg::Name(_) | Arg::Module(_) => false,
    };
    alphabet.declarations_of(LEAD).any(|lead| {
        let params = lead.params.get(1..).unwrap_or(&[]);
        args.len() <= params.len()
            && params.iter().skip(args.len()).all(|param| param.default.is_some())
            && args.iter().zip(params).all(|(arg, param)| fits(arg, param))
    })
}

/// Reports a formation that lacks a part.
fn incomplete(call: &Call<'_>, lack: &str) -> Diagnostic {
    Diagnostic::new(Code::E0306, format!("this formation has {lack}"), call.span, "a part is missing").help(EXAMPLE)
}

fn shape(call: &Call<'_>, others: u32) -> Result<Shape, Diagnostic> {
    let names = SHAPES.map(|(name, _)| name);
    let known = "the shapes are `line`, `column` and `triangle`";
    let Some(first) = call.args.first() else { return Err(incomplete(call, "no shape")) };
    let Arg::Name(name) = first else {
        let report = Diagnostic::new(Code::E0306, "a formation begins with its shape", first.span(), "not a shape");
        return Err(report.help(known));
    };
    let Some((_, shape)) = SHAPES.iter().find(|(known, _)| *known == name.node) else {
        let message = format!("there is no formation `{}`{}", name.node, did_you_mean(name.node, &names));
        return Err(Diagnostic::new(Code::E0306, message, name.span, "not a shape").help(known));
    };
    if *shape == Shape::Triangle && others != 2 {
        let message = format!("a triangle has three robots, and this group has {}", u64::from(others) + 1);
        let report = Diagnostic::new(Code::E0306, message, name.span, "not for this group");
        return Err(report.help("`line` and `column` are for two robots or more"));
    }
    Ok(*shape)
}

/// Returns the distance between the robots in metres, and the span of the argument.
fn spacing(arg: &Arg<'_>) -> Result<(f64, Span), Diagnostic> {
    let span = arg.span();
    let wrong = |message: String, here: &str| Diagnostic::new(Code::E0306, message, span, here);
    let Arg::Number(number) = arg else {
        let message = "the distance of the robots follows the shape".to_owned();
        return Err(wrong(message, "not a length").help(EXAMPLE));
    };
    let (digits, value) = (number.digits(), number.digits().parse().unwrap_or(f64::NAN));
    let Some(unit) = number.unit() else {
        let report = wrong(format!("the distance `{digits}` of the robots has no unit"), "no unit");
        return Err(report.fix("write {}", span, format!("{digits}m")));
    };
    let Some(unit) = Unit::from_name(unit).filter(|unit| unit.kind == ParameterKind::Length) else {
        let message = format!("the distance of the robots is a length, found `{digits}{unit}`");
        return Err(wrong(message, "not a length").help("lengths are in `m`, `cm`, `mm`, `in` or `ft`"));
    };
    let metres = unit.to_si(value);
    if !(LEAST..=f64::MAX).contains(&metres) {
        let message = format!("the robots of a formation are 1 cm apart or more, found `{digits}{}`", unit.name);
        return Err(
            wrong(message, "too small").help("it is the distance of their centres, and a Scout is 0.41 m across")
        );
    }
    Ok((metres, span))
}

/// Returns the law of the first robot.
fn law<'s>(call: &Call<'s>) -> Result<Call<'s>, Diagnostic> {
    let Some(first) = call.args.get(2) else { return Err(incomplete(call, "no law for its first robot")) };
    let Arg::Name(name) = first else {
        let report =
            Diagnostic::new(Code::E0306, "a formation ends with the law of its first robot", first.span(), "not a law");
        return Err(report.help(EXAMPLE));
    };
    let args = call.args.get(3..).unwrap_or(&[]);
    let refuse = |message: &str, help: &str| {
        Err(Diagnostic::new(Code::E0306, message, name.span, "not expected here").help(help))
    };
    if name.node == FORMATION {
        return refuse("a formation cannot lead a formation", "the law of the first robot moves that robot alone");
    }
    if name.node == "goAvoid" && matches!(args, [Arg::Module(_), ..]) {
        let help = "give it a point: `goAvoid 0 7m 20`";
        return refuse("a formation cannot follow a module: `goAvoid` with one leaves no room for the others", help);
    }
    let end = args.last().map_or(name.span, Arg::span);
    Ok(Call { name: name.node, args, span: name.span.to(end) })
}
