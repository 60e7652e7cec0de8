//! Makes the nodes of the tree: one constructor for each action of the grammar.

use std::ops::Range;

use lalrpop_util::ErrorRecovery;

use super::source::{Place, Source};
use super::token::{Digits, Tok, Token, label};
use super::tree::{
    Arg, Call, Condition, ConditionNode, Count, Element, File, Name, Number, Param, Plan, Primary, Spanned,
};
use crate::diagnostic::{Code, Diagnostic, Span};

/// An error that the parser has recovered from.
pub(super) type Recovery<'s> = ErrorRecovery<usize, Tok<'s>, std::convert::Infallible>;

/// What a file holds.
pub(super) enum Item {
    Use(Name),
    Plan(Box<Plan>),
    Broken,
}

/// What the constructors know, and what they find out.
pub(super) struct Nodes<'s> {
    source: Source<'s>,
    tokens: &'s [Token<'s>],
    docs: &'s [(usize, &'s str)],
    /// The parser's errors, in the order of the text.
    pub(super) errors: Vec<Recovery<'s>>,
    /// The bodies that are empty, each with its tokens.
    pub(super) empty: Vec<(Range<usize>, Diagnostic)>,
}

impl<'s> Nodes<'s> {
    /// Constructors for the tokens of a text.
    pub(super) fn new(source: Source<'s>, tokens: &'s [Token<'s>], docs: &'s [(usize, &'s str)]) -> Self {
        Self { source, tokens, docs, errors: Vec::new(), empty: Vec::new() }
    }

    // ---- Files and plans ----

    pub(super) fn file(items: Vec<Item>) -> File {
        let mut file = File::default();
        for item in items {
            match item {
                Item::Use(text) => file.uses.push(text),
                Item::Plan(plan) => file.plans.push(*plan),
                Item::Broken => {}
            }
        }
        file
    }

    pub(super) fn plan(
        &mut self,
        start: usize,
        label: Option<Name>,
        head: (Option<Name>, Vec<Param>, Option<Condition>),
        elements: Vec<Element>,
        end: usize,
    ) -> Plan {
        let span = self.between(start, end);
        let (name, params, condition) = head;
        if let (true, Some(name)) = (elements.is_empty(), &name) {
            let message = format!("plan `{}` has nothing to run", name.node);
            self.empty(start..end, message, name.span, "no element follows", "give it an atom: `(Atom (wait 5) stop)`");
        }
        let name = name.or_else(|| self.name_before(start)).unwrap_or_else(|| Spanned { node: String::new(), span });
        Plan { docs: self.docs_of(start), label, name, params, condition, elements, span }
    }

    /// The name before a brace, `A { … }`: reported already, but others may refer to it.
    fn name_before(&self, brace: usize) -> Option<Name> {
        let before = brace.checked_sub(1)?;
        let Tok::Name(name) = self.tokens.get(before)?.kind else { return None };
        Some(self.name(before, name))
    }

    /// The doc comment directly before a plan.
    fn docs_of(&self, start: usize) -> Vec<String> {
        let first = self.docs.partition_point(|(token, _)| *token < start);
        let lines = self.docs.get(first..).unwrap_or(&[]).iter();
        lines.take_while(|(token, _)| *token == start).map(|(_, line)| (*line).to_owned()).collect()
    }

    pub(super) fn type_name(&self, start: usize, name: Name, length: Option<Number>, end: usize) -> Name {
        let node = match length {
            Some(length) => format!("{}[{}]", name.node, length.digits),
            None => name.node,
        };
        Spanned { node, span: self.between(start, end) }
    }

    // ---- Elements ----

    pub(super) fn element(
        &self,
        start: usize,
        label: Option<Name>,
        frame: Option<Number>,
        primary: Primary,
        power: Option<Count>,
        end: usize,
    ) -> Element {
        Element { label, frame, primary, power, span: self.between(start, end) }
    }

    /// An element that is a call and nothing else.
    pub(super) fn single(call: Call) -> Element {
        let span = call.span;
        Element { label: None, frame: None, primary: Primary::Ref(call), power: None, span }
    }

    pub(super) fn atom(condition: Condition, control: Option<Call>) -> Primary {
        match control {
            Some(control) => Primary::Atom { condition, control },
            None => Primary::Broken,
        }
    }

    pub(super) fn exec(&mut self, start: usize, count: Count, body: Vec<Element>, end: usize) -> Primary {
        if body.is_empty() {
            let help = "put elements between its braces: `ExecPlan 3 { (Atom (wait 5) stop) }`";
            self.empty(start..end, "this loop has nothing to run", self.between(start, end), "no element inside", help);
        }
        Primary::Exec { count, body }
    }

    pub(super) fn exec_ref(count: Count, call: Call) -> Primary {
        Primary::Exec { count, body: vec![Self::single(call)] }
    }

    pub(super) fn string(&mut self, start: usize, elements: Vec<Element>, end: usize) -> Primary {
        if elements.is_empty() {
            let help = "put elements between the parentheses, or take these out";
            self.empty(
                start..end,
                "these parentheses hold nothing to run",
                self.between(start, end),
                "no element inside",
                help,
            );
        }
        Primary::String(elements)
    }

    pub(super) fn formal(
        &mut self,
        start: usize,
        body: Vec<Element>,
        condition: Condition,
        time: Option<Arg>,
        end: usize,
    ) -> Primary {
        if body.is_empty() {
            let help = "a scope is written `(elements, condition)`, an atom `(law, condition)`";
            self.empty(
                start..end,
                "this scope has nothing to run",
                self.between(start, end),
                "nothing before the comma",
                help,
            );
        }
        Primary::Formal { body, condition, time }
    }

    fn empty(&mut self, range: Range<usize>, message: impl Into<String>, span: Span, here: &str, help: &str) {
        self.empty.push((range, Diagnostic::new(Code::E0108, message, span, here).help(help)));
    }

    // ---- Conditions ----

    pub(super) fn condition(&self, start: usize, node: ConditionNode, end: usize) -> Condition {
        Condition { node, span: self.between(start, end) }
    }

    pub(super) fn parenthesized(&self, start: usize, inner: Condition, end: usize) -> Condition {
        self.condition(start, inner.node, end)
    }

    /// Several operands joined by one operator; a single one stays what it is.
    pub(super) fn joined(
        first: Condition,
        rest: Vec<Condition>,
        join: fn(Vec<Condition>) -> ConditionNode,
    ) -> Condition {
        let Some(last) = rest.last() else { return first };
        let span = first.span.to(last.span);
        Condition { node: join(Self::first_and_rest(first, rest)), span }
    }

    // ---- Calls ----

    pub(super) fn call(&self, start: usize, name: Name, args: Vec<Vec<Arg>>, end: usize) -> Call {
        Call { name, args: Self::flattened(args), span: self.between(start, end) }
    }

    pub(super) fn law_call(&self, start: usize, name: Name, first: Arg, rest: Vec<Vec<Arg>>, end: usize) -> Call {
        let args = Self::first_and_rest(first, Self::flattened(rest));
        Call { name, args, span: self.between(start, end) }
    }

    /// Parentheses around several arguments mean nothing.
    pub(super) fn flattened(args: Vec<Vec<Arg>>) -> Vec<Arg> {
        args.into_iter().flatten().collect()
    }

    pub(super) fn first_and_rest<T>(first: T, mut rest: Vec<T>) -> Vec<T> {
        rest.insert(0, first);
        rest
    }

    // ---- Tokens ----

    pub(super) fn name(&self, at: usize, text: &str) -> Name {
        Spanned { node: text.to_owned(), span: self.span(at) }
    }

    pub(super) fn label(&self, at: usize, text: &str) -> Name {
        Spanned { node: label(text), span: self.span(at) }
    }

    pub(super) fn number(&self, at: usize, digits: Digits<'_>) -> Number {
        let unit = (!digits.tail.is_empty()).then(|| digits.tail.to_owned());
        Number { digits: digits.number.to_owned(), unit, span: self.span(at) }
    }

    pub(super) fn span(&self, at: usize) -> Span {
        self.between(at, at + 1)
    }

    /// The stretch from one token to the one before another.
    fn between(&self, start: usize, end: usize) -> Span {
        let first = self.tokens.get(start).map_or(self.source.text.len(), |token| token.place.start);
        let last = end.checked_sub(1).and_then(|last| self.tokens.get(last)).map_or(first, |token| token.place.end);
        self.source.span(Place::new(first, last.max(first)))
    }

    // ---- What could not be read ----

    pub(super) fn broken_item(&mut self, error: Recovery<'s>) -> Item {
        self.errors.push(error);
        Item::Broken
    }

    pub(super) fn broken_head(&mut self, error: Recovery<'s>) -> (Option<Name>, Vec<Param>, Option<Condition>) {
        self.errors.push(error);
        (None, Vec::new(), None)
    }

    pub(super) fn broken_list<T>(&mut self, error: Recovery<'s>) -> Vec<T> {
        self.errors.push(error);
        Vec::new()
    }

    pub(super) fn broken_params(&mut self, first: Param, rest: Vec<Param>, error: Recovery<'s>) -> Vec<Param> {
        self.errors.push(error);
        Self::first_and_rest(first, rest)
    }

    pub(super) fn broken_args(
        &mut self,
        start: usize,
        name: Name,
        args: Option<Vec<Vec<Arg>>>,
        error: Recovery<'s>,
        end: usize,
    ) -> Call {
        self.errors.push(error);
        self.call(start, name, args.unwrap_or_default(), end)
    }

    pub(super) fn broken_condition(&mut self, start: usize, error: Recovery<'s>, end: usize) -> Condition {
        self.errors.push(error);
        self.condition(start, ConditionNode::Broken, end)
    }

    pub(super) fn broken_element(&mut self, start: usize, error: Recovery<'s>, end: usize) -> Element {
        let primary = self.broken_primary(error);
        self.element(start, None, None, primary, None, end)
    }

    pub(super) fn broken_primary(&mut self, error: Recovery<'s>) -> Primary {
        self.errors.push(error);
        Primary::Broken
    }

    pub(super) fn broken_call(&mut self, error: Recovery<'s>) -> Option<Call> {
        self.errors.push(error);
        None
    }
}
