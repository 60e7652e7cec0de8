//! Reports unknown plan names, and common mistakes that the parser accepts; proposes the element that the user probably
//! meant.

use super::Resolver;
use crate::alphabet::{self, DeclarationKind, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::arguments::{completed, kind_words, sonar, written};
use crate::syntax::tree::{self, Arg, Call, ConditionNode, Element, Frame, Name, Primary};
use crate::syntax::{foreign, nearest_unit};

impl<'a> Resolver<'_, 'a> {
    /// Reports a name of two words, as in `{ My Plan (bumper) …`. Returns the number of elements that belong to the
    /// mistake.
    pub(super) fn words_of_name(&mut self, plan: &tree::Plan<'a>) -> usize {
        let [Element { primary: Primary::Ref(word), .. }, Element { primary: Primary::String(group), .. }, ..] =
            plan.elements
        else {
            return 0;
        };
        let [Element { primary: Primary::Ref(condition), .. }] = group else { return 0 };
        let kind = |name| self.quarks.alphabet().declarations_of(name).next().map(|declaration| declaration.kind);
        let is_plan = self.definitions.get(word.name).is_some() || self.definitions.is_incomplete;
        let is_condition = kind(condition.name) == Some(DeclarationKind::Interrupt);
        let is_beside = plan.condition.is_none() && word.span.start == plan.name.span.end + 1;
        if is_plan || !is_condition || !is_beside || kind(word.name).is_some() {
            return 0;
        }
        let name = format!("{}{}", plan.name.node, word.name);
        let span = plan.name.span.to(word.span);
        let found = Diagnostic::new(Code::E0201, "the name of a plan is one word", span, "two words");
        self.found.push(found.fix("write {}", span, name));
        2
    }

    /// Reports robots without brackets, as in `{ Group robot1 robot2 Round (bumper) …`. Returns the number of elements
    /// that belong to the mistake.
    pub(super) fn robots_without_brackets(&mut self, plan: &tree::Plan<'a>) -> usize {
        if plan.name.node != "Group" || plan.condition.is_some() {
            return 0;
        }
        let name = |element: &Element<'a>| {
            let Element { primary: Primary::Ref(call), marks: None, .. } = element else { return None };
            (call.args.is_empty() && self.definitions.get(call.name).is_none()).then_some(*call)
        };
        let names: Vec<_> = plan.elements.iter().map_while(name).collect();
        // The last name is the name of the group.
        let Some((_, robots @ [first, .., last])) = names.split_last() else { return 0 };
        let span = first.span.to(last.span);
        let list = format!("[{}]", robots.iter().map(|robot| robot.name).collect::<Vec<_>>().join(" "));
        let found = Diagnostic::new(Code::E0208, "no brackets are around the robots of this group", span, "robots");
        self.found.push(found.fix("write {}", span, list));
        // All elements count, because the condition after the names was read as an element.
        plan.elements.len()
    }

    /// Reports a condition without parentheses, as in `{ Plan bumper (Atom …`. Returns the number of elements that
    /// belong to the mistake.
    pub(super) fn bare_condition(&mut self, plan: &tree::Plan<'a>) -> usize {
        let [Element { primary: Primary::Ref(call), marks: None, .. }, _, ..] = plan.elements else { return 0 };
        let mut declarations = self.quarks.alphabet().declarations_of(call.name);
        let is_interrupt = declarations.any(|declaration| declaration.kind == DeclarationKind::Interrupt);
        let is_beside = plan.condition.is_none() && call.span.start == plan.name.span.end + 1;
        if !is_interrupt || !is_beside || self.definitions.get(call.name).is_some() {
            return 0;
        }
        let message = format!(
            "`{}` is {}, but an atom or a plan is expected here",
            call.name,
            kind_words(DeclarationKind::Interrupt)
        );
        let found = Diagnostic::new(Code::E0204, message, call.span, "no parentheses around this");
        let words = "the condition of a plan is written in parentheses after its name: {}";
        self.found.push(found.fix(words, call.span, format!("({})", written(call))));
        1
    }

    /// Reports a law outside of an atom whose sonars are written as their ranges, as in `align r_7 r_9` and
    /// `align r_7(t) r_9(t)`, where all three are read as plans used by name. Returns the number of elements that
    /// belong to the mistake.
    pub(super) fn bare_law(&mut self, elements: &[Element<'a>]) -> usize {
        let [Element { primary: Primary::Ref(law), marks: None, .. }, ranges @ ..] = elements else { return 0 };
        let mut declarations = self.quarks.alphabet().declarations_of(law.name);
        let is_plan = |name| self.definitions.get(name).is_some();
        let is_law = declarations.any(|declaration| declaration.kind == DeclarationKind::Control);
        if !is_law || !law.args.is_empty() || is_plan(law.name) {
            return 0;
        }
        let range = |element: &Element<'a>| {
            let Element { primary: Primary::Ref(range), marks: None, .. } = element else { return None };
            let name = Name { node: range.name, span: range.name_span() };
            let is_time = matches!(range.args, [] | [Arg::Name(Name { node: "t", .. })]);
            (is_time && !is_plan(range.name) && sonar(&name).is_some()).then_some((Arg::Name(name), range.span))
        };
        let (args, spans): (Vec<_>, Vec<_>) = ranges.iter().map_while(range).unzip();
        let Some(last) = spans.last() else { return 0 };
        let unknown = self.unknown_plan(&Call { args: &args, span: law.span.to(*last), ..**law });
        self.found.push(unknown);
        1 + args.len()
    }

    /// Reports a unit after a space, as in `FRAME 90 deg (Atom …)`, where it is read as a plan used by name.
    pub(super) fn unit_apart(&self, element: &Element<'a>) -> Option<Diagnostic> {
        let (Some(Frame::Turned(number)), Primary::Ref(call)) = (element.frame(), &element.primary) else {
            return None;
        };
        let unit =
            nearest_unit(call.name).and_then(Unit::from_name).filter(|unit| unit.kind == ParameterKind::Angle)?.name;
        if !call.args.is_empty() || number.unit().is_some() || self.definitions.get(call.name).is_some() {
            return None;
        }
        let (digits, span) = (number.digits(), call.name_span());
        let message = format!("there is a space between `{digits}` and its unit `{unit}`");
        let found = Diagnostic::new(Code::E0104, message, span, "remove the space before this unit");
        Some(found.fix("write {}", number.span.to(span), format!("{digits}{unit}")))
    }

    /// Reports `(Atom (u) ξ)`, in which law and condition are exchanged.
    pub(super) fn swapped(&self, atom: &tree::Atom<'a>) -> Option<Diagnostic> {
        let ConditionNode::Call(law) = atom.condition.node else { return None };
        let kind = |name| self.quarks.alphabet().declarations_of(name).next().map(|declaration| declaration.kind);
        let is_swapped = kind(law.name) == Some(DeclarationKind::Control)
            && kind(atom.control.name) == Some(DeclarationKind::Interrupt);
        let message = format!("`{}` is a law, but an interrupt is expected here", law.name);
        let found = Diagnostic::new(Code::E0204, message, law.name_span(), "a law");
        let (law, interrupt) = (written(law), written(atom.control));
        is_swapped.then(|| found.help(format!("the condition comes first: `(Atom ({interrupt}) ({law}))`")))
    }

    /// Reports an unknown name where an element is expected.
    pub(super) fn unknown_plan(&self, call: &Call) -> Diagnostic {
        let name = call.name;
        let span = call.name_span();
        if let Some(quark) = self.quarks.alphabet().declarations_of(name).next() {
            let message = format!("`{name}` is {}, but an atom or a plan is expected here", kind_words(quark.kind));
            let report = Diagnostic::new(Code::E0204, message, span, "a quark runs in an atom");
            let written = completed(call, quark).unwrap_or_else(|| written(call));
            let (words, element) = match quark.kind {
                DeclarationKind::Control => ("say when it ends: {}", format!("(Atom (wait 10) {written})")),
                DeclarationKind::Interrupt => ("say what runs until then: {}", format!("(Atom ({written}) stop)")),
                DeclarationKind::Signal => ("compare it in an atom: {}", format!("(Atom ({written} < 1) stop)")),
            };
            let report = report.fix(words, call.span, element);
            return match quark.kind {
                DeclarationKind::Interrupt | DeclarationKind::Signal => report.help(
                    "the condition of a plan is written in parentheses after the name of the plan: `{ Name (bumper) … }`",
                ),
                DeclarationKind::Control => report,
            };
        }
        if let Some(advice) = foreign::advice(name) {
            let message = format!("MDLe has no `{name}`, and there is no plan of this name");
            return Diagnostic::new(Code::E0201, message, span, "no plan of this name").help(advice);
        }
        let message = format!("there is no plan called `{name}`");
        let report = Diagnostic::new(Code::E0201, message, span, "no plan of this name");
        if let Some(keyword) = ["Atom", "ExecPlan", "FRAME"].iter().find(|keyword| name.eq_ignore_ascii_case(keyword)) {
            return report.fix("the keyword is spelled {}", span, *keyword);
        }
        match alphabet::nearest(name, self.definitions.names.iter().copied()) {
            Some(near) => report.fix("did you mean {}?", span, near),
            None if Unit::from_name(name).is_some() => {
                report.help(format!("`{name}` is a unit, which touches its number: `5{name}`"))
            }
            None if ParameterKind::NAMES.contains(&name) => {
                report.help(format!("`{name}` is a type, which follows a parameter's name: `{{ Leg (x: {name}) … }}`"))
            }
            None if name == "here" => report.help("`here` follows `FRAME`: `FRAME here (Atom (bumper) stop)`"),
            None if is_joining(name) => report.fix("elements follow each other without a word: remove it", span, ""),
            None if call.args.is_empty() && self.next.is_some_and(|next| next.start == span.end + 1) => {
                report.fix("a label of what follows it has a colon: {}", span, format!("{name}:"))
            }
            None => report.help(format!("write a plan of this name: `{{ {name} (bumper) … }}`")),
        }
    }
}

/// Returns `true` if a name is a word that joins steps in other languages, such as `then`.
fn is_joining(name: &str) -> bool {
    ["then", "and", "next", "followed", "do", "begin", "end"].iter().any(|word| name.eq_ignore_ascii_case(word))
}
