//! Plans loaded at run time: rows whose quarks the bound alphabet of the target `scripted` makes by their names.

use mdle_runtime::fsm::Kind;
use mdle_runtime::{
    Alphabet, Argument, Condition, Guard, InRows, LawRow, Meters, MetersPerSecond, Nanos, Radians, RadiansPerSecond,
    Rows, SonarId, Texts, Volts,
};
use mdle_scripted::alphabet::{self as scripted, AnyControl, AnyInterrupt};
use mdlec::alphabet::{self, family_to_si};
use mdlec::fsm::Lowered;
use mdlec::plan::{self, Quark, Value};

/// A plan's rows, owned.
pub struct Loaded<'l> {
    lowered: &'l Lowered,
    guards: Vec<Guard<AnyInterrupt>>,
    operands: Vec<Condition<AnyInterrupt>>,
    laws: Vec<LawRow<AnyControl>>,
    texts: [Vec<&'l str>; 3],
}

/// A plan that borrows them: storage for levels and loops is made when its size is known.
pub type LoadedPlan<'l> = InRows<'l, scripted::Alphabet, Box<[Nanos]>, Box<[u64]>>;

impl<'l> Loaded<'l> {
    /// Makes the rows of a plan. Without `foresight` they do not say what follows when a scope ends.
    ///
    /// # Panics
    /// If the alphabet does not know a quark of the plan.
    #[must_use]
    pub fn new(lowered: &'l Lowered, foresight: bool) -> Self {
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
        let mut loaded = Self { lowered, guards: Vec::new(), operands: Vec::new(), laws: laws.collect(), texts };
        for (number, scope) in (0..).zip(scopes()) {
            let condition = loaded.condition(scope.map_or(&plan::Condition::Null, |scope| &scope.interrupt.condition));
            let bracket = lowered.brackets[number as usize];
            let level = if let Kind::Scope { level } = bracket.kind { level } else { 0 };
            let follows = lowered.tables().follows(number).filter(|_| foresight);
            // Every bracket around it is asked, whether it can fire or not.
            loaded.guards.push(Guard { condition, level, around: bracket.parent, follows });
        }
        loaded
    }

    /// The rows as a plan takes them.
    #[must_use]
    pub fn rows(&self) -> Rows<'_, scripted::Alphabet> {
        let [laws, conditions, names] = &self.texts;
        let texts = Texts { laws, conditions, names };
        Rows { fsm: self.lowered.tables(), guards: &self.guards, operands: &self.operands, laws: &self.laws, texts }
    }

    /// The plan of these rows before it begins.
    #[must_use]
    pub fn plan<'r>(&self, rows: &'r Rows<'r, scripted::Alphabet>) -> LoadedPlan<'r> {
        let (levels, slots) = (self.lowered.levels, self.lowered.slots);
        InRows::new(rows, vec![Nanos::ZERO; levels].into(), vec![0; slots].into())
    }

    /// A condition; its operands go behind all operands that there are so far, and theirs behind them.
    fn condition(&mut self, written: &plan::Condition) -> Condition<AnyInterrupt> {
        match written {
            plan::Condition::Null => Condition::Null,
            plan::Condition::Quark(id) => {
                Condition::Quark(by_name(self.lowered.quark(*id), scripted::Alphabet::interrupt))
            }
            plan::Condition::Wait { nanos, .. } => Condition::Wait(Nanos(*nanos)),
            plan::Condition::Elapsed { from, until, .. } => {
                Condition::Elapsed(Nanos(*from), Nanos(until.unwrap_or(u64::MAX)))
            }
            plan::Condition::Rising { .. } | plan::Condition::After(_) => panic!("no plan is loaded with these yet"),
            plan::Condition::Or(operands) => {
                let (first, count) = self.operands(operands);
                Condition::Or(first, count)
            }
            plan::Condition::And(operands) => {
                let (first, count) = self.operands(operands);
                Condition::And(first, count)
            }
            plan::Condition::Not(operand) => Condition::Not(self.operands(std::slice::from_ref(&**operand)).0),
        }
    }

    fn operands(&mut self, written: &[plan::Condition]) -> (u32, u32) {
        let first = self.operands.len();
        self.operands.extend(written.iter().map(|_| Condition::Null));
        for (place, operand) in written.iter().enumerate() {
            self.operands[first + place] = self.condition(operand);
        }
        (u32::try_from(first).unwrap(), u32::try_from(written.len()).unwrap())
    }
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
                alphabet::Kind::Length => Argument::Length(Meters(si)),
                alphabet::Kind::Speed => Argument::Speed(MetersPerSecond(si)),
                alphabet::Kind::Angle => Argument::Angle(Radians(si)),
                alphabet::Kind::AngularRate => Argument::AngularRate(RadiansPerSecond(si)),
                alphabet::Kind::Voltage => Argument::Voltage(Volts(si)),
                alphabet::Kind::Time => Argument::Time(Nanos(exact.to_nanos().unwrap())),
                alphabet::Kind::Number => Argument::Number(si),
                alphabet::Kind::Frequency
                | alphabet::Kind::Integer
                | alphabet::Kind::Count
                | alphabet::Kind::Bits(_)
                | alphabet::Kind::Sonar
                | alphabet::Kind::Robot
                | alphabet::Kind::Module
                | alphabet::Kind::File => panic!("no quantity is {kind:?}"),
            }
        }
        Value::Infinity(alphabet::Kind::Time) => Argument::Time(Nanos::MAX),
        Value::Infinity(_) => Argument::Count(u64::MAX),
        Value::Bits(bits) => Argument::Bits(bits),
        Value::Integer(whole) => Argument::Integer(*whole),
        Value::Sonar(sonar) => Argument::Sonar(SonarId::new(*sonar)),
        Value::Name(..) => panic!("no quark of `scripted` takes a name"),
    }
}
