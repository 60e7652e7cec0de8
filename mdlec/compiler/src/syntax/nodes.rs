//! Constructors of the tree's nodes, one for each action of the grammar.
//!
//! The parser moves the values on its stack with every token, so they are small and need no destructor. Large nodes are
//! therefore already in the arena, and the members of a list wait in separate stacks until the list is complete.

use std::borrow::Cow;
use std::ops::Range;

use bumpalo::Bump;
use lalrpop_util::ErrorRecovery;

use super::label::label;
use super::source::{FileText, Location};
use super::token::{Tok, Token};
use super::tree::{
    Arg, Atom, Call, Condition, ConditionNode, Count, Element, Exec, File, Formal, Frame, Marks, Name, Number, Param,
    Plan, Primary, Spanned,
};
use super::waiting::{First, WaitingNodes, complete};
use crate::diagnostic::{Code, Diagnostic, Span};

/// An error from which the parser has recovered.
pub(super) type Recovery<'s> = ErrorRecovery<Location, Tok<'s>, std::convert::Infallible>;

/// Head of a plan: everything before its elements.
#[derive(Default, Clone, Copy)]
pub(super) struct Head<'s> {
    pub(super) name: Option<Name<'s>>,
    pub(super) group: Option<&'s [Arg<'s>]>,
    pub(super) params: &'s [Param<'s>],
    pub(super) condition: Option<Condition<'s>>,
}

/// State of the constructors: the input, and the nodes and errors that have been created so far.
pub(super) struct Nodes<'t, 's> {
    pub(super) source: FileText<'s>,
    /// Arena of the tree.
    arena: &'s Bump,
    /// Tokens of the text. Nodes of broken elements are created from these tokens.
    pub(super) tokens: &'t [Token<'s>],
    /// Doc comments, each with the index of the token that follows it.
    docs: &'t [(usize, &'s str)],
    /// Nodes of lists that are not complete yet.
    pub(super) waiting: WaitingNodes<'s>,
    /// Tree of the file.
    pub(super) file: File<'s>,
    /// Errors from which the parser has recovered, in the order of the text.
    pub(super) errors: Vec<Recovery<'s>>,
    /// Messages about empty bodies, each with the range of the body's tokens.
    pub(super) empty: Vec<(Range<usize>, Diagnostic)>,
}

impl<'t, 's> Nodes<'t, 's> {
    /// Creates constructors for the tokens of a text.
    pub(super) fn new(
        source: FileText<'s>,
        arena: &'s Bump,
        tokens: &'t [Token<'s>],
        docs: &'t [(usize, &'s str)],
    ) -> Self {
        let (waiting, file) = (WaitingNodes::new(), File::default());
        Self { source, arena, tokens, docs, waiting, file, errors: Vec::new(), empty: Vec::new() }
    }

    /// Allocates a node in the arena.
    pub(super) fn put<T: Copy>(&self, node: T) -> &'s T {
        self.arena.alloc(node)
    }

    // ---- Files and plans ----

    pub(super) fn uses(&mut self, text: Name<'s>) {
        self.file.uses.push(text);
    }

    pub(super) fn file_plan(&mut self, plan: &'s Plan<'s>) {
        self.file.plans.push(*plan);
    }

    pub(super) fn plan(
        &mut self,
        start: Location,
        label: Option<Name<'s>>,
        head: &'s Head<'s>,
        first: Option<First>,
        end: Location,
    ) -> &'s Plan<'s> {
        let span = self.between(start, end);
        let Head { name, group, params, condition } = *head;
        if let (None, Some(name)) = (first, &name) {
            let message = format!("plan `{}` has nothing to run", name.node);
            let help = "give it an atom: `(Atom (wait 5) stop)`";
            self.empty((start, end), message, name.span, "no element follows", help);
        }
        let is_headless = name.is_none();
        let name = name.or_else(|| self.name_before(start)).unwrap_or(Spanned { node: "", span });
        let (docs, elements) = (self.docs_of(start), self.elements(first));
        let elements = match elements {
            // After a brace without a name, a parenthesis that looks like a string is the plan's condition.
            [Element { primary: Primary::String(_), .. }, behind @ ..] if is_headless => behind,
            all => all,
        };
        self.put(Plan { docs, label, name, group, params, condition, elements, span })
    }

    pub(super) fn head(&mut self, name: Name<'s>, condition: Option<Condition<'s>>) -> &'s Head<'s> {
        let params = match self.waiting.params.as_slice() {
            [] => &[],
            [..] => complete(&mut self.waiting.params, 0, self.arena),
        };
        self.put(Head { name: Some(name), group: None, params, condition })
    }

    /// Returns the head of a group's plan. The robots of the group are the waiting arguments from index `first` on.
    pub(super) fn group_head(
        &mut self,
        first: Option<First>,
        name: Name<'s>,
        condition: Option<Condition<'s>>,
    ) -> &'s Head<'s> {
        let robots = first.map_or(&[][..], |first| complete(&mut self.waiting.args, first, self.arena));
        let head = *self.head(name, condition);
        self.put(Head { group: Some(robots), ..head })
    }

    pub(super) fn param(&mut self, name: Name<'s>, type_name: Name<'s>) {
        self.waiting.params.push(Param { name, type_name });
    }

    /// Returns the name before a brace, as in `A { … }`. The name has already been reported as misplaced, but other
    /// plans may refer to it.
    fn name_before(&self, brace: Location) -> Option<Name<'s>> {
        let before = self.tokens.get((brace.token as usize).checked_sub(1)?)?;
        let Tok::Name(name) = before.kind else { return None };
        Some(Spanned { node: name, span: self.source.span(before.place) })
    }

    /// Returns the lines of the doc comment that directly precedes a plan.
    fn docs_of(&self, start: Location) -> &'s [&'s str] {
        let start = start.token as usize;
        let first = self.docs.partition_point(|(token, _)| *token < start);
        let lines = self.docs.get(first..).unwrap_or(&[]).iter();
        let lines: Vec<_> = lines.take_while(|(token, _)| *token == start).map(|(_, line)| *line).collect();
        self.arena.alloc_slice_copy(&lines)
    }

    pub(super) fn type_name(
        &self,
        start: Location,
        name: Name<'s>,
        length: Option<Number<'s>>,
        end: Location,
    ) -> Name<'s> {
        let node = match length {
            Some(length) => self.arena.alloc_str(&format!("{}[{}]", name.node, length.digits())),
            None => name.node,
        };
        Spanned { node, span: self.between(start, end) }
    }

    // ---- Elements ----

    pub(super) fn element(
        &mut self,
        start: Location,
        label: Option<Name<'s>>,
        frame: Option<Frame<'s>>,
        primary: Primary<'s>,
        power: Option<&'s Count<'s>>,
        end: Location,
    ) -> First {
        let is_marked = label.is_some() || frame.is_some() || power.is_some();
        let marks = is_marked.then(|| self.put(Marks { label, frame, power: power.copied() }));
        let span = self.between(start, end);
        self.waiting.element(Element { primary, marks, span })
    }

    /// Completes the list of elements that begins at the index `first`.
    fn elements(&mut self, first: Option<First>) -> &'s [Element<'s>] {
        first.map_or(&[][..], |first| complete(&mut self.waiting.elements, first, self.arena))
    }

    /// Returns a list with a single element: the law of an atom in formal notation.
    pub(super) fn law(&mut self, start: Location, name: Name<'s>, first: First, end: Location) -> Option<First> {
        let call = self.call(start, name, Some(first), end);
        Some(self.waiting.element(single(call)))
    }

    pub(super) fn atom(&self, condition: Condition<'s>, control: Option<&'s Call<'s>>) -> Primary<'s> {
        control.map_or(Primary::Broken, |control| Primary::Atom(self.put(Atom { condition, control })))
    }

    pub(super) fn exec(
        &mut self,
        start: Location,
        count: &'s Count<'s>,
        first: Option<First>,
        end: Location,
    ) -> Primary<'s> {
        if first.is_none() {
            let (message, here) = ("this loop has nothing to run", "no element inside");
            let help = "put elements between its braces: `ExecPlan 3 { (Atom (wait 5) stop) }`";
            self.empty((start, end), message, self.between(start, end), here, help);
        }
        let body = self.elements(first);
        Primary::Exec(self.put(Exec { count: *count, body }))
    }

    pub(super) fn exec_ref(&self, count: &'s Count<'s>, call: &'s Call<'s>) -> Primary<'s> {
        let body = self.arena.alloc_slice_copy(&[single(call)]);
        Primary::Exec(self.put(Exec { count: *count, body }))
    }

    pub(super) fn string(&mut self, start: Location, first: Option<First>, end: Location) -> Primary<'s> {
        if first.is_none() {
            let (message, here) = ("these parentheses are empty", "no element inside");
            let help = "put elements between the parentheses, or remove these";
            self.empty((start, end), message, self.between(start, end), here, help);
        }
        let body = self.elements(first);
        Primary::String(self.put(body))
    }

    pub(super) fn formal(
        &mut self,
        start: Location,
        first: Option<First>,
        condition: Condition<'s>,
        time: Option<&'s Arg<'s>>,
        end: Location,
    ) -> Primary<'s> {
        if first.is_none() {
            let (message, here) = ("this scope has nothing to run", "nothing before the comma");
            let help = "a scope is written `(elements, condition)`, an atom `(law, condition)`";
            self.empty((start, end), message, self.between(start, end), here, help);
        }
        let body = self.elements(first);
        Primary::Formal(self.put(Formal { body, condition, time: time.copied() }))
    }

    fn empty(
        &mut self,
        (start, end): (Location, Location),
        message: impl Into<String>,
        span: Span,
        here: &str,
        help: &str,
    ) {
        let tokens = start.token as usize..end.token as usize;
        self.empty.push((tokens, Diagnostic::new(Code::E0108, message, span, here).help(help)));
    }

    // ---- Conditions ----

    pub(super) fn condition(&self, start: Location, node: ConditionNode<'s>, end: Location) -> Condition<'s> {
        Condition { node, span: self.between(start, end) }
    }

    pub(super) fn parenthesized(&self, start: Location, inner: Condition<'s>, end: Location) -> Condition<'s> {
        self.condition(start, inner.node, end)
    }

    pub(super) fn operand(&mut self, operand: Condition<'s>) -> First {
        self.waiting.condition(operand)
    }

    /// Joins operands with an operator; `rest` is the index of the second operand.
    pub(super) fn joined(
        &mut self,
        first: Condition<'s>,
        rest: First,
        join: fn(&'s &'s [Condition<'s>]) -> ConditionNode<'s>,
    ) -> Condition<'s> {
        self.waiting.conditions.insert(rest, first);
        let operands = complete(&mut self.waiting.conditions, rest, self.arena);
        let span = operands.last().map_or(first.span, |last| first.span.to(last.span));
        Condition { node: join(self.put(operands)), span }
    }

    // ---- Calls ----

    /// Returns a call whose arguments are the waiting arguments from index `first` on.
    pub(super) fn call(
        &mut self,
        start: Location,
        name: Name<'s>,
        first: Option<First>,
        end: Location,
    ) -> &'s Call<'s> {
        let args = first.map_or(&[][..], |first| complete(&mut self.waiting.args, first, self.arena));
        self.put(Call { name: name.node, args, span: self.between(start, end) })
    }

    pub(super) fn arg(&mut self, arg: Arg<'s>) -> First {
        self.waiting.arg(arg)
    }

    // ---- Tokens ----

    pub(super) fn name(&self, start: Location, text: &'s str, end: Location) -> Name<'s> {
        Spanned { node: text, span: self.between(start, end) }
    }

    pub(super) fn label(&self, start: Location, text: &'s str, end: Location) -> Name<'s> {
        let node = match label(text) {
            Cow::Borrowed(plain) => plain,
            Cow::Owned(plain) => self.arena.alloc_str(&plain),
        };
        Spanned { node, span: self.between(start, end) }
    }

    pub(super) fn number(&self, start: Location, text: &'s str, end: Location) -> Number<'s> {
        Number::new(text, self.between(start, end))
    }

    pub(super) fn between(&self, start: Location, end: Location) -> Span {
        self.source.between(start, end)
    }
}

/// Returns an element that consists of a call only.
fn single<'s>(call: &'s Call<'s>) -> Element<'s> {
    Element { primary: Primary::Ref(call), marks: None, span: call.span }
}
