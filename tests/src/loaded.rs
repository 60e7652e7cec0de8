//! Plans loaded at run time: rows whose quarks the bound alphabet of the target `scripted` makes by their names.

use mdle_compiler::alphabet::{self, family_to_si};
use mdle_compiler::fsm::{Element, Machine};
use mdle_compiler::plan::{self, Compared, Quark, Value};
use mdle_runtime::{
    Alphabet, Argument, BracketWords, Comparison, Condition, Fact, Guard, Here, InRows, LawRow, MarkRow, Memories,
    Meters, MetersPerSecond, Nanometers, Nanos, Operand, OperandWords, Operator, Radians, RadiansPerSecond, Rows,
    SonarId, Source, SourceLine, Stamp, Stamps, Texts, Volts,
};
use mdle_scripted::alphabet::{self as scripted, AnyControl, AnyInterrupt};

/// A plan's rows, owned.
pub struct Loaded<'l> {
    lowered: &'l Machine,
    guards: Vec<Guard<AnyInterrupt>>,
    operands: Vec<Condition<AnyInterrupt>>,
    laws: Vec<LawRow<AnyControl>>,
    texts: [Vec<&'l str>; 3],
    /// The texts of the operands of each bracket's condition, in order, and where each bracket's begin.
    words: Vec<String>,
    first: Vec<usize>,
}

/// The texts of operands and the labels, as rows borrow them.
pub struct Borrowed<'l> {
    operands: Vec<OperandWords<'l>>,
    brackets: Vec<BracketWords<'l>>,
    marks: Vec<MarkRow>,
    facts: Vec<Fact>,
}

/// The files and modules of the quarks that scripts report.
const NAMES: &[&str] = &["horn", "bell.mid", "sun"];

/// A plan that borrows them: storage for levels and loops is made when its size is known.
pub type LoadedPlan<'l> = InRows<&'l Rows<'l, scripted::Alphabet>, Entered<'l>, Box<[u64]>, Memories<Box<[bool]>>>;

/// The entries of a plan's scopes.
pub type Entered<'l> = Stamps<Box<[Stamp]>, &'l [Option<Here>]>;

impl<'l> Loaded<'l> {
    /// Makes the rows of a plan. Without `foresight` they do not contain the successors of scopes.
    ///
    /// # Panics
    /// If the alphabet does not know a quark of the plan.
    #[must_use]
    pub fn new(lowered: &'l Machine, foresight: bool) -> Self {
        let laws = lowered.atoms().map(|atom| LawRow {
            control: by_name(atom.law(), scripted::Alphabet::control),
            frame: Radians(atom.turned()),
        });
        let texts = [
            lowered.atoms().map(|atom| atom.law().text.as_str()).collect(),
            lowered.elements().map(Element::condition_text).collect(),
            lowered.elements().map(Element::name).collect(),
        ];
        let mut loaded = Self {
            lowered,
            guards: Vec::new(),
            operands: Vec::new(),
            laws: laws.collect(),
            texts,
            words: Vec::new(),
            first: vec![0],
        };
        for element in lowered.elements() {
            if let Some(interrupt) = element.interrupt() {
                let text = |(number, part)| interrupt.operand_text(number, part, &|id| lowered.quark(id).text.clone());
                loaded.words.extend(element.condition().joined().into_iter().enumerate().map(text));
            }
            loaded.first.push(loaded.words.len());
            let condition = loaded.condition(element.condition());
            let level = element.level().unwrap_or(0);
            let follows = element.follows().filter(|_| foresight);
            // Every element around it is asked, whether it can fire or not.
            let around = element.parent().map_or(0, Element::number);
            loaded.guards.push(Guard { condition, level, around, follows });
        }
        loaded
    }

    /// The rows as a plan takes them.
    #[must_use]
    pub fn rows<'r>(&'r self, borrowed: &'r Borrowed<'r>) -> Rows<'r, scripted::Alphabet> {
        let [laws, conditions, names] = &self.texts;
        let Borrowed { operands, brackets, marks, facts } = borrowed;
        let source = Source { files: &[], brackets, operands };
        let texts = Texts { laws, conditions, names, source, paths: &[] };
        let (fsm, guards, operands) = (self.lowered.tables(), &self.guards, &self.operands);
        Rows { fsm, guards, operands, laws: &self.laws, marks, facts, texts }
    }

    /// The texts of operands and the labels, as rows take them.
    #[must_use]
    pub fn borrowed(&self) -> Borrowed<'_> {
        const AT: SourceLine = SourceLine { file: 0, line: 0 };
        let bracket = |range: &[usize]| {
            let [first, count] = [range[0], range[1] - range[0]].map(|number| u32::try_from(number).unwrap());
            BracketWords { at: AT, condition: "", first, count }
        };
        let operands = self.words.iter().map(|text| OperandWords { text, written: text, at: AT, values: &[] });
        let brackets = self.first.windows(2).map(bracket);
        let (mut marks, mut facts) = (Vec::new(), Vec::new());
        for (element, mark) in self.lowered.elements().flat_map(|it| it.marks().iter().map(move |mark| (it, mark))) {
            let Some(record) = self.lowered.record(mark.record) else { continue };
            let [first_fact, count] = [facts.len(), mark.facts.len()].map(|number| u32::try_from(number).unwrap());
            facts.extend(
                mark.facts.iter().map(|fact| Fact { memory: record.first + fact.number, operand: fact.operand }),
            );
            let (bracket, level, first) = (element.number(), record.level, record.first);
            marks.push(MarkRow { bracket, level, first, count: record.facts, first_fact, facts: count });
        }
        Borrowed { operands: operands.collect(), brackets: brackets.collect(), marks, facts }
    }

    /// The plan of these rows before it begins.
    #[must_use]
    pub fn plan<'r>(&'r self, rows: &'r Rows<'r, scripted::Alphabet>) -> LoadedPlan<'r> {
        let (levels, slots) = (self.lowered.sizes().levels, self.lowered.sizes().slots);
        // No plan has more levels than brackets.
        let memories = vec![false; self.lowered.elements().len() * self.lowered.sizes().memories];
        let memory = Memories::new(u32::try_from(self.lowered.sizes().memories).unwrap(), memories.into());
        let entered = Stamps::new(vec![Stamp::START; levels].into(), self.lowered.frames());
        InRows::remembering(rows, entered, vec![0; slots].into(), memory)
    }

    /// Returns a condition; its operands are added after all earlier operands, and the operands of these after them.
    fn condition(&mut self, written: &plan::Condition) -> Condition<AnyInterrupt> {
        match written {
            plan::Condition::Null => Condition::Null,
            plan::Condition::Quark(id) => Condition::Quark(self.interrupt(self.lowered.quark(*id))),
            plan::Condition::Wait { nanos, .. } => Condition::Wait(Nanos(*nanos)),
            plan::Condition::Elapsed { from, until, .. } => {
                Condition::Elapsed(Nanos(*from), Nanos(until.unwrap_or(u64::MAX)))
            }
            plan::Condition::Driven { from, until, .. } => {
                Condition::Driven(Nanometers(*from), Nanometers(until.unwrap_or(u64::MAX)))
            }
            plan::Condition::Rising { memory, operand } => {
                Condition::Rising(*memory, self.operands(std::slice::from_ref(&**operand)).0)
            }
            plan::Condition::After(after) => {
                let record = self.lowered.record(after.record).unwrap();
                Condition::After(record.level, record.first + after.fact)
            }
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

    fn interrupt(&self, quark: &Quark) -> AnyInterrupt {
        let Some(comparison) = &quark.comparison else { return by_name(quark, scripted::Alphabet::interrupt) };
        let signal = |id| by_name(self.lowered.quark(id), scripted::Alphabet::signal);
        let si = |value: &Value| match value {
            Value::Quantity { exact, family, .. } => exact.to_f64() * family_to_si(family),
            Value::Infinity(_) | Value::Bits(_) | Value::Integer(_) | Value::Sonar(_) | Value::Name(..) => {
                panic!("{value:?} is compared with a signal")
            }
        };
        let tolerance = si(&comparison.tolerance);
        let is_angle = matches!(comparison.tolerance, Value::Quantity { kind: alphabet::Kind::Angle, .. });
        let operator = match comparison.operator {
            plan::Operator::Equal if is_angle => Operator::SameDirection(tolerance),
            plan::Operator::Equal => Operator::Equal(tolerance),
            plan::Operator::Less => Operator::Less,
            plan::Operator::LessOrEqual => Operator::LessOrEqual,
            plan::Operator::Greater => Operator::Greater,
            plan::Operator::GreaterOrEqual => Operator::GreaterOrEqual,
        };
        let with = match &comparison.with {
            Compared::Signal(other) => Operand::Signal(signal(*other)),
            Compared::Value(value) => Operand::Value(si(value)),
        };
        let comparison = Comparison::new(signal(comparison.signal), operator, with);
        scripted::Alphabet::comparison(comparison).expect("a robot with signals")
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
        Value::Name(_, name) => {
            let known = NAMES.iter().find(|known| *known == name);
            Argument::Name(known.unwrap_or_else(|| panic!("no script says anything of `{name}`")))
        }
    }
}
