//! Creates the quarks of a plan from their names.

use mdle_runtime::{
    Alphabet, Argument, Comparison, Condition, Meters, MetersPerSecond, Nanos, Operand, Operator, Radians,
    RadiansPerSecond, SonarId, Volts,
};

use super::{LoadError, NameBudget, names};
use crate::alphabet::{self, ParameterKind};
use crate::fsm::Machine;
use crate::plan::{self, Compared, Quark, QuarkId, Value};

/// Creates the quarks of a machine.
#[derive(Clone, Copy)]
pub(super) struct QuarkMaker<'m> {
    pub(super) machine: &'m Machine,
    pub(super) alphabet: &'m alphabet::Alphabet,
    pub(super) budget: &'m NameBudget,
}

impl QuarkMaker<'_> {
    /// Converts a condition with the id of a quark to a condition with the quark itself.
    pub(super) fn condition<A: Alphabet>(
        self,
        condition: Condition<QuarkId>,
    ) -> Result<Condition<A::Interrupt>, LoadError> {
        Ok(match condition {
            Condition::Quark(id) => Condition::Quark(self.interrupt::<A>(id)?),
            Condition::Lasting(id, time) => Condition::Lasting(self.interrupt::<A>(id)?, time),
            Condition::Null => Condition::Null,
            Condition::Wait(time) => Condition::Wait(time),
            Condition::Elapsed(from, until) => Condition::Elapsed(from, until),
            Condition::Driven(from, until) => Condition::Driven(from, until),
            Condition::Or(first, count) => Condition::Or(first, count),
            Condition::And(first, count) => Condition::And(first, count),
            Condition::Not(number) => Condition::Not(number),
            Condition::Rising(memory, number) => Condition::Rising(memory, number),
            Condition::After(level, memory) => Condition::After(level, memory),
        })
    }

    fn interrupt<A: Alphabet>(self, id: QuarkId) -> Result<A::Interrupt, LoadError> {
        let quark = self.machine.quark(id);
        let Some(comparison) = &quark.comparison else { return self.by_name(id, A::interrupt) };
        let signal = |id| self.by_name(id, A::signal);
        let with = match &comparison.with {
            Compared::Signal(other) => Operand::Signal(signal(*other)?),
            Compared::Value(value) => Operand::Value(value.in_si()),
        };
        let made = Comparison::new(signal(comparison.signal)?, operator(comparison), with);
        A::comparison(made).ok_or_else(|| LoadError::Unbound(quark.text.clone()))
    }

    /// Creates the quark with this id; `make` creates it from its name and arguments.
    pub(super) fn by_name<Q>(self, id: QuarkId, make: fn(&str, &[Argument<'_>]) -> Option<Q>) -> Result<Q, LoadError> {
        let Quark { name, overload, args, text, .. } = self.machine.quark(id);
        let declaration = self.alphabet.declarations_of(name).nth(*overload);
        let kinds = declaration.iter().flat_map(|declaration| declaration.params.iter().map(|param| param.kind));
        let arguments = args.iter().zip(kinds).map(|(value, kind)| argument(value, kind, self.budget));
        let arguments: Vec<_> = arguments.collect::<Result<_, _>>()?;
        make(name, &arguments).ok_or_else(|| LoadError::Unbound(text.clone()))
    }
}

fn operator(comparison: &plan::Comparison) -> Operator {
    let tolerance = comparison.tolerance.in_si();
    let is_angle = matches!(comparison.tolerance, Value::Quantity { kind: ParameterKind::Angle, .. });
    match comparison.operator {
        plan::Operator::Equal if is_angle => Operator::SameDirection(tolerance),
        plan::Operator::Equal => Operator::Equal(tolerance),
        plan::Operator::Less => Operator::Less,
        plan::Operator::LessOrEqual => Operator::LessOrEqual,
        plan::Operator::Greater => Operator::Greater,
        plan::Operator::GreaterOrEqual => Operator::GreaterOrEqual,
    }
}

/// Converts a value to an argument for a parameter of this kind.
fn argument<'v>(value: &'v Value, parameter: ParameterKind, budget: &NameBudget) -> Result<Argument<'v>, LoadError> {
    let si = value.in_si();
    Ok(match value {
        Value::Quantity { kind, exact, .. } => match kind {
            ParameterKind::Length => Argument::Length(Meters(si)),
            ParameterKind::Speed => Argument::Speed(MetersPerSecond(si)),
            ParameterKind::Angle => Argument::Angle(Radians(si)),
            ParameterKind::AngularRate => Argument::AngularRate(RadiansPerSecond(si)),
            ParameterKind::Voltage => Argument::Voltage(Volts(si)),
            ParameterKind::Time => Argument::Time(Nanos(exact.to_nanos().unwrap_or(u64::MAX))),
            ParameterKind::Frequency
            | ParameterKind::Number
            | ParameterKind::Integer
            | ParameterKind::Count
            | ParameterKind::Bits(_)
            | ParameterKind::Sonar
            | ParameterKind::Robot
            | ParameterKind::Module
            | ParameterKind::File => Argument::Number(si),
        },
        Value::Infinity(ParameterKind::Time) => Argument::Time(Nanos::MAX),
        Value::Infinity(_) => Argument::Count(u64::MAX),
        Value::Bits(bits) => Argument::Bits(bits),
        Value::Integer(whole) => match u64::try_from(*whole) {
            Ok(count) if parameter == ParameterKind::Count => Argument::Count(count),
            Ok(_) | Err(_) => Argument::Integer(*whole),
        },
        Value::Sonar(sonar) => Argument::Sonar(SonarId::new(*sonar)),
        Value::Name(_, name) => Argument::Name(names::interned(name, budget)?),
    })
}
