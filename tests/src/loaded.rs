//! Plans loaded at run time: rows whose quarks the bound alphabet of the target `scripted` makes by their names.

use mdle_runtime::{
    Alphabet, Argument, Condition, InRows, LawRow, Meters, MetersPerSecond, Nanos, Radians, RadiansPerSecond, Rows,
    SonarId, Texts, Volts,
};
use mdle_scripted::alphabet::{self as scripted, AnyControl, AnyInterrupt};
use mdlec::alphabet::{Kind, family_to_si};
use mdlec::fsm::Lowered;
use mdlec::plan::{self, Quark, Value};

/// A plan's rows, owned.
pub struct Loaded<'l> {
    lowered: &'l Lowered,
    conditions: Vec<Condition<AnyInterrupt>>,
    laws: Vec<LawRow<AnyControl>>,
    texts: [Vec<&'l str>; 3],
}

/// A plan that borrows them: storage for levels and loops is made when its size is known.
pub type LoadedPlan<'l> = InRows<'l, scripted::Alphabet, Box<[Nanos]>, Box<[u64]>>;

impl<'l> Loaded<'l> {
    /// Makes the rows of a plan.
    ///
    /// # Panics
    /// If the alphabet does not know a quark of the plan.
    #[must_use]
    pub fn new(lowered: &'l Lowered) -> Self {
        let laws = lowered.laws.iter().map(|law| LawRow {
            control: by_name(lowered.quark(law.quark), scripted::Alphabet::control),
            frame: Radians(law.frame),
        });
        let scopes = || lowered.scopes.iter().map(Option::as_ref);
        let texts = [
            lowered.laws.iter().map(|law| lowered.quark(law.quark).text.as_str()).collect(),
            scopes().map(|scope| scope.map_or("", |scope| scope.interrupt.text.as_str())).collect(),
            scopes().map(|scope| scope.map_or("", |scope| scope.name.as_str())).collect(),
        ];
        Self { lowered, conditions: conditions(lowered), laws: laws.collect(), texts }
    }

    /// The plan before it begins.
    #[must_use]
    pub fn plan(&self) -> LoadedPlan<'_> {
        let [laws, conditions, names] = &self.texts;
        let texts = Texts { laws, conditions, names };
        let rows = Rows { fsm: self.lowered.tables(), conditions: &self.conditions, laws: &self.laws, texts };
        let (levels, slots) = (self.lowered.levels, self.lowered.slots);
        InRows::new(rows, vec![Nanos::ZERO; levels].into(), vec![0; slots].into())
    }
}

/// The conditions of the brackets; the operands of each condition behind all that there is so far.
fn conditions(lowered: &Lowered) -> Vec<Condition<AnyInterrupt>> {
    let scopes = lowered.scopes.iter().map(Option::as_ref);
    let of_scopes = scopes.map(|scope| scope.map_or(&plan::Condition::Null, |scope| &scope.interrupt.condition));
    let mut written: Vec<&plan::Condition> = of_scopes.collect();
    let mut rows = Vec::new();
    while let Some(condition) = written.get(rows.len()).copied() {
        let first = u32::try_from(written.len()).unwrap();
        let count = |operands: &[plan::Condition]| u32::try_from(operands.len()).unwrap();
        rows.push(match condition {
            plan::Condition::Null => Condition::Null,
            plan::Condition::Quark(id) => Condition::Quark(by_name(lowered.quark(*id), scripted::Alphabet::interrupt)),
            plan::Condition::Wait { nanos, .. } => Condition::Wait(Nanos(*nanos)),
            plan::Condition::Or(operands) => Condition::Or(first, count(operands)),
            plan::Condition::And(operands) => Condition::And(first, count(operands)),
            plan::Condition::Not(_) => Condition::Not(first),
        });
        match condition {
            plan::Condition::Or(operands) | plan::Condition::And(operands) => written.extend(operands),
            plan::Condition::Not(operand) => written.push(operand),
            plan::Condition::Null | plan::Condition::Quark(_) | plan::Condition::Wait { .. } => {}
        }
    }
    rows
}

fn by_name<Q>(quark: &Quark, make: fn(&str, &[Argument<'_>]) -> Option<Q>) -> Q {
    let arguments: Vec<_> = quark.args.iter().map(argument).collect();
    make(&quark.name, &arguments).unwrap_or_else(|| panic!("no quark `{}` {arguments:?}", quark.text))
}

fn argument(value: &Value) -> Argument<'_> {
    match value {
        Value::Quantity { kind, exact, family } => {
            let si = exact.to_f64() * family_to_si(family);
            match kind {
                Kind::Length => Argument::Length(Meters(si)),
                Kind::Speed => Argument::Speed(MetersPerSecond(si)),
                Kind::Angle => Argument::Angle(Radians(si)),
                Kind::AngularRate => Argument::AngularRate(RadiansPerSecond(si)),
                Kind::Voltage => Argument::Voltage(Volts(si)),
                Kind::Time => Argument::Time(Nanos(exact.to_nanos().unwrap())),
                Kind::Number => Argument::Number(si),
                Kind::Frequency
                | Kind::Integer
                | Kind::Count
                | Kind::Bits(_)
                | Kind::Sonar
                | Kind::Robot
                | Kind::Module
                | Kind::File => panic!("no quantity is {kind:?}"),
            }
        }
        Value::Infinity(Kind::Time) => Argument::Time(Nanos::MAX),
        Value::Infinity(_) => Argument::Count(u64::MAX),
        Value::Bits(bits) => Argument::Bits(bits),
        Value::Integer(whole) => Argument::Integer(*whole),
        Value::Sonar(sonar) => Argument::Sonar(SonarId::new(*sonar)),
        Value::Name(..) => panic!("no quark of `scripted` takes a name"),
    }
}
