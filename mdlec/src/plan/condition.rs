//! Conditions as a machine reads them (docs/src/reference/semantics.md, 2): what they are made of, and their value in a
//! situation.

use super::{QuarkId, RecordId};

/// A condition; `true` is "has fired".
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// Never fires: `null`, `wait inf`, or what degeneracy removal left.
    Null,
    /// An interrupt quark.
    Quark(QuarkId),
    /// Fires once this many nanoseconds have passed since the scope of the interrupt was entered.
    Wait {
        /// The nanoseconds.
        nanos: u64,
        /// The quark, for its text and its exact value.
        quark: QuarkId,
    },
    /// Fires while the time since the scope of the interrupt was entered is in this interval: a comparison of `t`.
    Elapsed {
        /// From so many nanoseconds on ...
        from: u64,
        /// ... and until so many have passed.
        until: Option<u64>,
        /// The comparison, for its text.
        quark: QuarkId,
    },
    /// Fires while the length of the path driven since the scope of the interrupt was entered is in this interval: a
    /// comparison of `way`.
    Driven {
        /// From so many nanometres on ...
        from: u64,
        /// ... and until so many have been driven.
        until: Option<u64>,
        /// The comparison, for its text.
        quark: QuarkId,
    },
    /// At least one of these, two or more.
    Or(Vec<Condition>),
    /// All of these, two or more.
    And(Vec<Condition>),
    /// Not this.
    Not(Box<Condition>),
    /// This, and the memory is set that it had once not fired.
    Rising {
        /// The number of the memory among those of the interrupt.
        memory: u32,
        /// This.
        operand: Box<Condition>,
    },
    /// A labelled element has ended last.
    After(After),
}

/// `after L`, or `after L c`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct After {
    /// Whose record it asks.
    pub record: RecordId,
    /// What it asks of it.
    pub fact: u32,
    /// Its text.
    pub text: String,
}

/// What a condition asks of the machine that runs the plan, about one scope.
pub trait Situation {
    /// Whether a quark has fired.
    fn quark(&self, quark: QuarkId) -> bool;
    /// Whether so many nanoseconds have passed since the scope was entered.
    fn waited(&self, nanos: u64) -> bool;
    /// Returns `true` if so many nanometres have been driven since the scope was entered.
    fn driven(&self, nanometers: u64) -> bool;
    /// Whether a memory of the scope's interrupt is set.
    fn remembers(&self, memory: u32) -> bool;
    /// Whether this is so of a record.
    fn recorded(&self, record: RecordId, fact: u32) -> bool;
}

impl Condition {
    /// Its value in a situation. Reads every operand.
    pub fn fired(&self, at: &impl Situation) -> bool {
        match self {
            Self::Null => false,
            Self::Quark(id) => at.quark(*id),
            Self::Wait { nanos, .. } => at.waited(*nanos),
            Self::Elapsed { from, until, .. } => at.waited(*from) & !until.is_some_and(|until| at.waited(until)),
            Self::Driven { from, until, .. } => at.driven(*from) & !until.is_some_and(|until| at.driven(until)),
            Self::Or(operands) => operands.iter().fold(false, |fired, operand| fired | operand.fired(at)),
            Self::And(operands) => operands.iter().fold(true, |fired, operand| fired & operand.fired(at)),
            Self::Not(operand) => !operand.fired(at),
            Self::Rising { memory, operand } => at.remembers(*memory) & operand.fired(at),
            Self::After(after) => at.recorded(after.record, after.fact),
        }
    }

    /// The operands of its outermost OR, as written; itself where it is none.
    #[must_use]
    pub fn operands(&self) -> &[Self] {
        if let Self::Or(operands) = self { operands } else { std::slice::from_ref(self) }
    }

    /// The first operand of its outermost OR that has fired, as written; the first and only one where it is no OR.
    pub fn cause(&self, at: &impl Situation) -> u32 {
        (0..).zip(self.operands()).find(|(_, operand)| operand.fired(at)).map_or(0, |(number, _)| number)
    }

    /// The conditions that it is made of, from left to right; a quark, a timer or `after` has none.
    #[must_use]
    pub fn children(&self) -> &[Self] {
        match self {
            Self::Or(operands) | Self::And(operands) => operands,
            Self::Not(operand) | Self::Rising { operand, .. } => std::slice::from_ref(operand),
            Self::Null | Self::Quark(_) | Self::Wait { .. } | Self::Elapsed { .. } => &[],
            Self::Driven { .. } | Self::After(_) => &[],
        }
    }

    /// Folds over the condition and all that it is made of: an operator comes before its operands.
    pub fn fold<'c, T>(&'c self, first: T, join: &mut impl FnMut(T, &'c Self) -> T) -> T {
        let own = join(first, self);
        self.children().iter().fold(own, |folded, operand| operand.fold(folded, join))
    }

    /// Returns `true` if this is so of the condition or of anything that it is made of.
    pub fn any(&self, is_so: &impl Fn(&Self) -> bool) -> bool {
        is_so(self) || self.children().iter().any(|operand| operand.any(is_so))
    }

    /// Replaces the condition and all that it is made of: operands before their operator.
    #[must_use]
    pub fn map(self, replace: &impl Fn(Self) -> Self) -> Self {
        let all = |operands: Vec<Self>| operands.into_iter().map(|operand| operand.map(replace)).collect();
        replace(match self {
            Self::Or(operands) => Self::Or(all(operands)),
            Self::And(operands) => Self::And(all(operands)),
            Self::Not(operand) => Self::Not(Box::new(operand.map(replace))),
            Self::Rising { memory, operand } => Self::Rising { memory, operand: Box::new(operand.map(replace)) },
            leaf @ (Self::Null | Self::Quark(_) | Self::Wait { .. } | Self::Elapsed { .. }) => leaf,
            leaf @ (Self::Driven { .. } | Self::After(_)) => leaf,
        })
    }

    /// Returns the parts that AND and OR join, from left to right: what a report names of a condition that has fired. NOT
    /// and RISING belong to their operands.
    #[must_use]
    pub fn joined(&self) -> Vec<&Self> {
        if matches!(self, Self::Or(_) | Self::And(_)) {
            self.children().iter().flat_map(Self::joined).collect()
        } else {
            vec![self]
        }
    }

    /// Whether it asks when its scope was entered.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.any(&|part| matches!(part, Self::Wait { .. } | Self::Elapsed { .. }))
    }

    /// Returns `true` if it asks where its scope was entered.
    #[must_use]
    pub fn drives(&self) -> bool {
        self.any(&|part| matches!(part, Self::Driven { .. }))
    }

    /// Visits every RISING in it: the number of its memory, and its operand.
    pub fn each_rising(&self, visit: &mut impl FnMut(u32, &Self)) {
        self.fold((), &mut |(), part| {
            if let Self::Rising { memory, operand } = part {
                visit(*memory, operand);
            }
        });
    }

    /// Visits every quark in it; timers are none.
    pub fn each_quark(&self, visit: &mut impl FnMut(QuarkId)) {
        self.fold((), &mut |(), part| {
            if let Self::Quark(id) = part {
                visit(*id);
            }
        });
    }

    /// The number of its parts: quarks, timers, operators.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.fold(0, &mut |parts, _| parts + 1)
    }
}
