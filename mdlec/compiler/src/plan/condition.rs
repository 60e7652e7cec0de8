//! Conditions of a resolved plan (docs/src/reference/semantics.md, 2), and their evaluation for a given state of the
//! robot and the plan.

use super::{QuarkId, RecordId};

/// A condition, which is `true` when it has fired.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// Never fires: `null`, `wait inf`, or a condition that was replaced because an outer scope has the same condition.
    Null,
    /// An interrupt quark.
    Quark(QuarkId),
    /// Fires once this many nanoseconds have passed since the scope of the interrupt was entered.
    Wait {
        /// Time to wait, in nanoseconds.
        nanos: u64,
        /// Quark of the timer, which provides its text and its exact value.
        quark: QuarkId,
    },
    /// Fires while the time since the scope of the interrupt was entered is in this interval: a comparison of `t`.
    Elapsed {
        /// Nanoseconds at which the interval begins.
        from: u64,
        /// Nanoseconds at which the interval ends, not included; `None` if it never ends.
        until: Option<u64>,
        /// Quark of the comparison, which provides its text.
        quark: QuarkId,
    },
    /// Fires while the length of the driven path since the scope of the interrupt was entered is in this interval: a
    /// comparison of `way`.
    Driven {
        /// Nanometres at which the interval begins.
        from: u64,
        /// Nanometres at which the interval ends, not included; `None` if it never ends.
        until: Option<u64>,
        /// Quark of the comparison, which provides its text.
        quark: QuarkId,
    },
    /// Fires when at least one of two or more operands has fired.
    Or(Vec<Condition>),
    /// Fires when all of two or more operands have fired.
    And(Vec<Condition>),
    /// Fires when the operand has not fired.
    Not(Box<Condition>),
    /// RISING: fires when the operand fires, if the memory records that the operand was false before.
    Rising {
        /// Index of the memory among the memories of the interrupt.
        memory: u32,
        /// Operand of RISING.
        operand: Box<Condition>,
    },
    /// Fires if the labelled element is among the elements that ended last.
    After(After),
}

/// A condition `after L` or `after L c`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct After {
    /// Record that the condition reads; it belongs to one use of a definition.
    pub record: RecordId,
    /// Number of the fact that the condition reads.
    pub fact: u32,
    /// Text of the condition.
    pub text: String,
}

/// State of the machine that runs a plan, as far as a condition of one scope reads it.
pub trait Situation {
    /// Returns `true` if the quark has fired.
    fn quark(&self, quark: QuarkId) -> bool;
    /// Returns `true` if at least `nanos` nanoseconds have passed since the scope was entered.
    fn waited(&self, nanos: u64) -> bool;
    /// Returns `true` if the robot has driven at least `nanometers` nanometres since the scope was entered.
    fn driven(&self, nanometers: u64) -> bool;
    /// Returns `true` if this memory of the scope's interrupt is set.
    fn remembers(&self, memory: u32) -> bool;
    /// Returns `true` if this fact is set in the record.
    fn recorded(&self, record: RecordId, fact: u32) -> bool;
}

impl Condition {
    /// Returns `true` if the condition has fired in this situation. Evaluates every operand.
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

    /// Returns the operands of the outermost OR, in the order of the text; the condition itself if it is not an OR.
    #[must_use]
    pub fn operands(&self) -> &[Self] {
        if let Self::Or(operands) = self { operands } else { std::slice::from_ref(self) }
    }

    /// Returns the index of the first operand of the outermost OR that has fired; 0 if the condition is not an
    /// OR.
    pub fn cause(&self, at: &impl Situation) -> u32 {
        (0..).zip(self.operands()).find(|(_, operand)| operand.fired(at)).map_or(0, |(number, _)| number)
    }

    /// Returns the direct operands of the condition, from left to right; empty for a quark, a timer or `after`.
    #[must_use]
    pub fn children(&self) -> &[Self] {
        match self {
            Self::Or(operands) | Self::And(operands) => operands,
            Self::Not(operand) | Self::Rising { operand, .. } => std::slice::from_ref(operand),
            Self::Null | Self::Quark(_) | Self::Wait { .. } | Self::Elapsed { .. } => &[],
            Self::Driven { .. } | Self::After(_) => &[],
        }
    }

    /// Folds a function over the condition and all its operands. An operator comes before its operands.
    pub fn fold<'c, T>(&'c self, first: T, join: &mut impl FnMut(T, &'c Self) -> T) -> T {
        let own = join(first, self);
        self.children().iter().fold(own, |folded, operand| operand.fold(folded, join))
    }

    /// Returns `true` if `is_so` returns `true` for the condition or any of its operands.
    pub fn any(&self, is_so: &impl Fn(&Self) -> bool) -> bool {
        is_so(self) || self.children().iter().any(|operand| operand.any(is_so))
    }

    /// Replaces the condition and all its operands with the results of `replace`. Operands are replaced before their
    /// operator.
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

    /// Returns the parts that AND and OR join, from left to right. Reports name the parts that have fired. A
    /// NOT or RISING is one part together with its operand.
    #[must_use]
    pub fn joined(&self) -> Vec<&Self> {
        if self.lasting().is_none() && matches!(self, Self::Or(_) | Self::And(_)) {
            self.children().iter().flat_map(Self::joined).collect()
        } else {
            vec![self]
        }
    }

    /// Returns the condition of `stuck T`. It fires when its quark has fired and the time `T` has passed since its
    /// scope was entered.
    pub(super) fn stuck(quark: QuarkId, nanos: u64) -> Self {
        Self::And(vec![Self::Quark(quark), Self::Wait { nanos, quark }])
    }

    /// Returns the condition of `rendezvous R`. It fires when its quark has fired and its scope was entered in an
    /// earlier turn.
    pub(super) fn later(quark: QuarkId) -> Self {
        Self::stuck(quark, 1)
    }

    /// Returns the quark and the duration of the timer, in nanoseconds, if this is the condition of `stuck T` or
    /// `rendezvous R`: an AND of a quark and its timer. Returns `None` for any other condition.
    #[must_use]
    pub fn lasting(&self) -> Option<(QuarkId, u64)> {
        let Self::And(operands) = self else { return None };
        match operands.as_slice() {
            [Self::Quark(own), Self::Wait { nanos, quark }] if own == quark => Some((*own, *nanos)),
            _ => None,
        }
    }

    /// Returns `true` if the condition depends on the time since its scope was entered.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.any(&|part| matches!(part, Self::Wait { .. } | Self::Elapsed { .. }))
    }

    /// Returns `true` if the condition contains a `stuck` or a `rendezvous`.
    #[must_use]
    pub fn lasts(&self) -> bool {
        self.any(&|part| part.lasting().is_some())
    }

    /// Returns `true` if the condition depends on the path that was driven since its scope was entered.
    #[must_use]
    pub fn drives(&self) -> bool {
        self.any(&|part| matches!(part, Self::Driven { .. }))
    }

    /// Calls `visit` for every RISING in the condition, with the index of its memory and its operand.
    pub fn each_rising(&self, visit: &mut impl FnMut(u32, &Self)) {
        self.fold((), &mut |(), part| {
            if let Self::Rising { memory, operand } = part {
                visit(*memory, operand);
            }
        });
    }

    /// Calls `visit` for every quark in the condition except the quarks of timers.
    pub fn each_quark(&self, visit: &mut impl FnMut(QuarkId)) {
        self.fold((), &mut |(), part| {
            if let Self::Quark(id) = part {
                visit(*id);
            }
        });
    }

    /// Returns the number of parts of the condition: quarks, timers and operators.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.fold(0, &mut |parts, _| parts + 1)
    }
}
