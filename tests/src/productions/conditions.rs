//! Counts the productions of conditions and calls.

use mdle_compiler::syntax::tree::{Arg, Call, Comparison, Condition, ConditionNode, Operand};

use super::Counter;

impl Counter<'_> {
    pub(super) fn parenthesized(&mut self, condition: &Condition<'_>) {
        self.met("Parenthesized = \"(\" Or \")\"");
        self.or(condition);
    }

    /// Returns `true` if parentheses enclose the whole condition and are part of it.
    fn is_parenthesized(&self, condition: &Condition<'_>) -> bool {
        self.written(condition.span).starts_with('(')
            && match &condition.node {
                // An initial parenthesis may belong to the first operand only.
                ConditionNode::Or(operands) | ConditionNode::And(operands) => {
                    operands.first().is_some_and(|first| first.span.start > condition.span.start)
                }
                ConditionNode::Not(_) | ConditionNode::Rising(_) | ConditionNode::Call(_) => true,
                ConditionNode::Comparison(_) | ConditionNode::Null | ConditionNode::After(_) => true,
                ConditionNode::Broken => false,
            }
    }

    /// Counts the productions of a condition. Parentheses around the whole condition count as those of a test.
    pub(super) fn or_inside(&mut self, condition: &Condition<'_>) {
        if self.is_parenthesized(condition) {
            self.wrapped();
            self.parenthesized(condition);
        } else {
            self.or(condition);
        }
    }

    /// Counts the productions that lead from a condition to a test in parentheses.
    fn wrapped(&mut self) {
        self.met("Or = And");
        self.met("And = Not");
        self.met("Not = Test");
        self.met("Test = Parenthesized");
    }

    pub(super) fn or(&mut self, condition: &Condition<'_>) {
        if let ConditionNode::Or(operands) = &condition.node {
            self.met("Or = And OrRest");
            self.list(operands.len() - 1, "OrRest = \"OR\" And", "OrRest = OrRest \"OR\" And");
            operands.iter().for_each(|operand| self.and(operand));
        } else {
            self.met("Or = And");
            self.and_of(condition);
        }
    }

    /// Counts the productions of an operand of OR.
    fn and(&mut self, condition: &Condition<'_>) {
        if self.is_parenthesized(condition) {
            self.met("And = Not");
            self.not(condition);
        } else {
            self.and_of(condition);
        }
    }

    fn and_of(&mut self, condition: &Condition<'_>) {
        if let ConditionNode::And(operands) = &condition.node {
            self.met("And = Not AndRest");
            self.list(operands.len() - 1, "AndRest = \"AND\" Not", "AndRest = AndRest \"AND\" Not");
            operands.iter().for_each(|operand| self.not(operand));
        } else {
            self.met("And = Not");
            self.not_of(condition);
        }
    }

    /// Counts the productions of an operand of AND.
    fn not(&mut self, condition: &Condition<'_>) {
        if self.is_parenthesized(condition) {
            self.met("Not = Test");
            self.test(condition);
        } else {
            self.not_of(condition);
        }
    }

    fn not_of(&mut self, condition: &Condition<'_>) {
        match &condition.node {
            ConditionNode::Not(operand) => {
                self.met("Not = \"NOT\" Test");
                self.test(operand);
            }
            ConditionNode::Rising(operand) => {
                self.met("Not = \"RISING\" Test");
                self.test(operand);
            }
            ConditionNode::Or(_)
            | ConditionNode::And(_)
            | ConditionNode::Call(_)
            | ConditionNode::Comparison(_)
            | ConditionNode::Null
            | ConditionNode::After(_)
            | ConditionNode::Broken => {
                self.met("Not = Test");
                self.test_of(condition);
            }
        }
    }

    fn test(&mut self, condition: &Condition<'_>) {
        if self.is_parenthesized(condition) {
            self.met("Test = Parenthesized");
            self.parenthesized(condition);
        } else {
            self.test_of(condition);
        }
    }

    fn test_of(&mut self, condition: &Condition<'_>) {
        match &condition.node {
            ConditionNode::Call(call) => {
                self.met("Test = Call");
                self.call(call);
            }
            ConditionNode::Comparison(compared) => {
                self.met("Test = Call Comparison Operand");
                self.call(compared.left);
                self.met(match compared.operator {
                    Comparison::Equal => "Comparison = \"==\"",
                    Comparison::Less => "Comparison = \"<\"",
                    Comparison::LessOrEqual => "Comparison = \"<=\"",
                    Comparison::Greater => "Comparison = \">\"",
                    Comparison::GreaterOrEqual => "Comparison = \">=\"",
                });
                match &compared.right {
                    Operand::Signal(signal) => {
                        self.met("Operand = Call");
                        self.call(signal);
                    }
                    Operand::Number(number) => {
                        self.met("Operand = Number");
                        self.number(number);
                    }
                    Operand::Infinity(_) => self.met("Operand = Infinity"),
                }
            }
            ConditionNode::Null => self.met("Test = \"null\""),
            ConditionNode::After(after) => {
                self.met("Test = \"after\" Name Cause?");
                if let Some(cause) = &after.cause {
                    self.met("Test … Cause?");
                    self.cause(cause);
                }
            }
            // As operands, these are in parentheses.
            ConditionNode::Or(_) | ConditionNode::And(_) => self.or(condition),
            ConditionNode::Not(_) | ConditionNode::Rising(_) => self.or(condition),
            ConditionNode::Broken => {}
        }
    }

    fn cause(&mut self, cause: &Condition<'_>) {
        if self.is_parenthesized(cause) {
            self.met("Cause = Parenthesized");
            self.parenthesized(cause);
        } else if let ConditionNode::Call(call) = &cause.node {
            self.met("Cause = Call");
            self.call(call);
        }
    }

    /// Returns `true` if the arguments are in parentheses that directly follow the name.
    pub(super) fn touches(&self, call: &Call<'_>) -> bool {
        self.written(call.span)[call.name.len()..].starts_with('(')
    }

    pub(super) fn reference(&mut self, call: &Call<'_>) {
        if self.touches(call) {
            self.met("Ref = Name \"touching (\" ArgList? \")\"");
            if !call.args.is_empty() {
                self.met("Ref … ArgList?");
            }
            self.args(call, call.args);
        } else {
            self.met("Ref = Name");
        }
    }

    pub(super) fn call(&mut self, call: &Call<'_>) {
        if self.touches(call) || call.args.is_empty() {
            self.met("Call = Ref");
            self.reference(call);
        } else {
            self.met("Call = Name Args");
            self.args(call, call.args);
        }
    }

    pub(super) fn args(&mut self, call: &Call<'_>, args: &[Arg<'_>]) {
        let (written, touches) = (self.written(call.span), self.touches(call));
        let group = written[call.name.len() + usize::from(touches)..].find('(');
        if group.is_some() {
            self.met("Arg = \"(\" ArgList \")\"");
        }
        if touches || group.is_some() {
            self.list(args.len(), "ArgList = Arg", "ArgList = ArgList \",\"? Arg");
            if written.contains(',') {
                self.met("ArgList … \",\"?");
            }
        }
        if !touches {
            self.list(args.len(), "Args = Arg", "Args = Args Arg");
        }
        for arg in args {
            if let Arg::Number(number) = arg {
                self.number(number);
            }
            self.met(match arg {
                Arg::Number(_) => "Arg = Number",
                Arg::Infinity(_) => "Arg = Infinity",
                Arg::String(_) => "Arg = Str",
                Arg::Name(_) => "Arg = Name",
                Arg::Module(_) => "Arg = Name \"module\"",
            });
        }
    }
}
