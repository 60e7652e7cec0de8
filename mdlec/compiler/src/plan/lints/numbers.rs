//! Warns about numbers without a unit that the author probably meant in another unit. For example, a speed of `0.5`
//! means 0.5 cm/s (W0401).

use std::collections::BTreeMap;

use crate::alphabet::{Alphabet, DeclarationKind, Param, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::parameters::Parameters;
use crate::syntax::Files;
use crate::syntax::tree::{
    self, Arg, Call, Compared, Condition, ConditionNode, Element, Frame, Number, Operand, Primary,
};

/// Warns about numbers that are doubtful in their unit. The plans of the files must resolve without errors.
#[must_use]
pub fn bare_numbers(files: &Files, alphabet: &Alphabet) -> Vec<Diagnostic> {
    let with_parameters = files.plans.iter().filter(|plan| !plan.params.is_empty());
    let parameters = with_parameters.map(|plan| (plan.name.node, plan)).collect();
    let mut numbers = Numbers { alphabet, parameters, found: Vec::new() };
    for plan in &files.plans {
        numbers.plan(plan);
    }
    numbers.found
}

/// A range, in metres, that is beyond the range of every sonar.
const SONAR: f64 = 20.0;
/// A length, in metres, that hardly any plan drives.
const FAR: f64 = 100.0;
/// A length, in metres, that is unusual for a single law.
const UNUSUAL: f64 = 50.0;

struct Numbers<'a> {
    alphabet: &'a Alphabet,
    /// Plans that take arguments.
    parameters: BTreeMap<&'a str, &'a tree::Plan<'a>>,
    found: Vec<Diagnostic>,
}

impl Numbers<'_> {
    fn plan(&mut self, plan: &tree::Plan) {
        plan.condition.iter().for_each(|condition| self.condition(condition));
        self.elements(plan.elements);
    }

    fn elements(&mut self, elements: &[Element]) {
        for element in elements {
            if let Some(Frame::Turned(number)) = element.frame() {
                self.number(number, ParameterKind::Angle, "deg", "a frame");
            }
            match &element.primary {
                Primary::Atom(atom) => {
                    self.condition(&atom.condition);
                    self.call(atom.control);
                }
                Primary::Plan(plan) => self.plan(plan),
                Primary::Exec(exec) => self.elements(exec.body),
                Primary::String(body) => self.elements(body),
                Primary::Formal(formal) => {
                    self.condition(&formal.condition);
                    self.elements(formal.body);
                }
                Primary::Ref(call) => match self.parameters.get(call.name).copied() {
                    Some(plan) => self.given(call, plan),
                    // In formal notation, a law is parsed as a plan used by name.
                    None => self.call(call),
                },
                Primary::Broken => {}
            }
        }
    }

    fn condition(&mut self, condition: &Condition) {
        match condition.node {
            ConditionNode::Or(operands) | ConditionNode::And(operands) => {
                operands.iter().for_each(|operand| self.condition(operand));
            }
            ConditionNode::Not(operand) | ConditionNode::Rising(operand) => self.condition(operand),
            ConditionNode::Call(call) => self.call(call),
            ConditionNode::Comparison(compared) => self.compared(compared),
            // The cause in `after` is also an operand of the labelled element's condition, and is checked there.
            ConditionNode::After(_) | ConditionNode::Null | ConditionNode::Broken => {}
        }
    }

    /// Checks a value with which a signal is compared.
    fn compared(&mut self, compared: &Compared) {
        let Operand::Number(number) = &compared.right else { return };
        let name = compared.left.name;
        let base = name.trim_end_matches(|letter: char| letter.is_ascii_digit() || letter == '_');
        let declarations = [name, base].into_iter().flat_map(|name| self.alphabet.declarations_of(name));
        let Some(signal) = declarations.into_iter().find(|found| found.kind == DeclarationKind::Signal) else { return };
        let Some((unit, _)) = signal.unit else { return };
        let is_sonar =
            matches!(signal.params.as_slice(), [Param { kind: ParameterKind::Sonar, .. }]) && unit.name == "m";
        let value = number.digits().parse::<f64>().unwrap_or(0.0);
        let what = format!("the value of `{name}`");
        if name == "theta"
            && unit.kind == ParameterKind::Angle
            && let Some(found) = beyond_half_a_turn(number, value)
        {
            self.found.push(found);
            return;
        }
        if is_sonar && number.unit().is_none() && (SONAR..=FAR).contains(&value) {
            self.doubtful(number, "m", &what, ("cm", "farther than a sonar measures"));
        } else {
            self.number(number, unit.kind, unit.name, &what);
        }
    }

    fn call(&mut self, call: &Call) {
        let is_meant = |params: &[Param]| {
            let fits = |(arg, param): (&Arg, &Param)| !matches!(arg, Arg::Number(_)) || param.unit.is_some();
            call.args.len() <= params.len() && call.args.iter().zip(params).all(fits)
        };
        let meant = self.alphabet.declarations_of(call.name).find(|declaration| is_meant(&declaration.params));
        let Some(declaration) = meant else { return };
        for (arg, param) in call.args.iter().zip(&declaration.params) {
            if let (Arg::Number(number), Some(unit)) = (arg, param.unit) {
                self.argument(number, param.kind, unit.name, &format!("`{}` of `{}`", param.name, call.name));
            }
        }
    }

    /// Checks the arguments that are passed to a plan.
    fn given(&mut self, call: &Call, plan: &tree::Plan) {
        let parameters = Parameters::declared(plan, self.alphabet, &mut Vec::new());
        for (arg, param) in call.args.iter().zip(plan.params) {
            let parameter = parameters.get(param.name.node);
            if let (Arg::Number(number), Some((kind, Some(unit)))) =
                (arg, parameter.map(|parameter| (parameter.kind, parameter.unit())))
            {
                self.argument(number, kind, unit.name, &format!("`{}` of `{}`", param.name.node, call.name));
            }
        }
    }

    /// Checks an argument. In an argument, a length is a distance to drive, so its limit is lower than the limit of a
    /// position.
    fn argument(&mut self, number: &Number, kind: ParameterKind, unit: &str, what: &str) {
        let size = number.digits().parse::<f64>().map_or(0.0, f64::abs);
        if kind == ParameterKind::Length && unit == "m" && number.unit().is_none() && (UNUSUAL..=FAR).contains(&size) {
            self.doubtful(number, unit, what, ("cm", "far for one law"));
        } else {
            self.number(number, kind, unit, what);
        }
    }

    fn number(&mut self, number: &Number, kind: ParameterKind, unit: &str, what: &str) {
        let digits = number.digits();
        let Some(value) = digits.parse::<f64>().ok().filter(|_| number.unit().is_none()) else { return };
        if let Some(doubt) = doubt(kind, unit, value) {
            self.doubtful(number, unit, what, doubt);
        }
    }

    fn doubtful(&mut self, number: &Number, unit: &str, what: &str, (meant, why): (&str, &str)) {
        let digits = number.digits();
        let message = format!("{what} is {digits} {unit}, which is {why}");
        self.found.push(
            Diagnostic::new(Code::W0401, message, number.span, format!("a number without a unit is in {unit} here"))
                .fix("write {} if that is meant", number.span, format!("{digits}{meant}"))
                .fix("or {} if the unit is right", number.span, format!("{digits}{unit}")),
        );
    }
}

/// Warns about a heading that `theta` never has, because the values of `theta` are between -180 and 180 degrees.
fn beyond_half_a_turn(number: &Number, value: f64) -> Option<Diagnostic> {
    let (half, unit) = match number.unit() {
        None | Some("deg") => (180.0, "deg"),
        Some("rad") => (std::f64::consts::PI, "rad"),
        Some(_) => return None,
    };
    if value.abs() <= half {
        return None;
    }
    let digits = number.digits();
    let message = format!("`theta` is a heading between -180 and 180 deg, and never {digits} {unit}");
    let found = Diagnostic::new(Code::W0401, message, number.span, "outside of the values of `theta`");
    if unit != "deg" || value.abs() > 1e6 {
        return Some(found.help("write the heading in deg, such as `theta > 90deg`"));
    }
    let same = ((value + 180.0).rem_euclid(360.0) * 1e4).round() / 1e4 - 180.0;
    Some(found.fix("the same heading is {}", number.span, format!("{same}deg")))
}

/// Returns the unit that the author probably meant, and the reason why a value of this kind is doubtful in `unit`;
/// `None` if the value is plausible.
fn doubt(kind: ParameterKind, unit: &str, value: f64) -> Option<(&'static str, &'static str)> {
    let size = value.abs();
    let is = |name: &str| Unit::from_name(name).is_some_and(|found| found.kind == kind) && unit == name;
    // The value is at most a full circle in radians.
    let is_circle = size <= std::f64::consts::TAU;
    Some(match () {
        () if size == 0.0 => return None,
        () if is("cm/s") && size < 1.0 => ("m/s", "slower than any robot drives"),
        () if is("cm/s") && size >= 500.0 => ("mm/s", "faster than a robot drives"),
        () if is("rad/s") && !is_circle => ("deg/s", "more than a full turn a second"),
        () if is("deg") && is_circle && value.fract() != 0.0 => ("rad", "a very small angle"),
        () if is("m") && size > 1000.0 => ("mm", "farther than a robot goes"),
        () if is("m") && size > FAR => ("cm", "farther than a robot goes"),
        () if is("s") && size > 10_000.0 => ("ms", "more than two hours"),
        () if is("s") && is_like_milliseconds(size) => ("ms", "more than a quarter of an hour"),
        () => return None,
    })
}

/// Returns `true` for a number of 1000 or more that is probably meant in milliseconds. A time in seconds of this size
/// is usually a whole number of minutes, such as 1800.
fn is_like_milliseconds(size: f64) -> bool {
    size >= 1000.0 && (size % 60.0 != 0.0 || size % 1000.0 == 0.0)
}
