//! Resolves a tree to plans: resolves names, arguments and units, and copies in each plan that is used by name.

mod misread;

use std::collections::{BTreeMap, BTreeSet};

use super::definitions::Definitions;
use super::labels::{EndCauses, Labels};
use super::parameters::{self, DefinitionNames, Parameter, Parameters};
use super::plan_arguments::with_arguments;
use super::quarks::ResolvedQuarks;
use super::resolve_conditions::{self, ConditionScope};
use super::size::Bounds;
use super::{Atom, Decimal, Interrupt, Loop, Node, Plan, RecordId, Scope};
use crate::alphabet::{Alphabet, DeclarationKind, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic, Span, has_errors};
use crate::syntax::Files;
use crate::syntax::tree::{self, Arg, Call, ConditionNode, Count, Element, Formal, Frame, Number, Primary};

/// Maximum angle of a FRAME, in its unit. It is far beyond a full circle, and small enough for exact sums.
const FRAME: f64 = 100_000.0;

/// Returns the names of the plans of a file to which no other plan refers. Does not copy plans into each other.
#[must_use]
pub fn roots(files: &Files, alphabet: &Alphabet) -> Vec<String> {
    let (definitions, _) = Definitions::collect(files, alphabet, Bounds::FILES);
    let roots = definitions.roots().into_iter().filter(|plan| plan.params.is_empty());
    roots.map(|plan| plan.name.node.to_owned()).collect()
}

/// Resolves the plans of a file and of the files that it uses: the file's plans to which no other plan refers,
/// or only the plan `wanted`.
///
/// All plans are checked; if any plan has an error, or exceeds the bounds, no plan is returned.
#[must_use]
pub fn resolve(
    files: &Files,
    alphabet: &Alphabet,
    wanted: Option<&str>,
    bounds: Bounds,
) -> (Vec<Plan>, Vec<Diagnostic>) {
    let (definitions, mut found) = Definitions::collect(files, alphabet, bounds);
    let roots = || definitions.roots().into_iter().filter(|plan| plan.params.is_empty());
    let asked: Vec<_> = wanted.map_or_else(|| roots().collect(), |name| definitions.get(name).into_iter().collect());
    let names: BTreeSet<_> = asked.iter().map(|plan| plan.name.node).collect();
    let mut alone = BTreeMap::new();
    // Each plan is checked by itself, so that its errors are reported once, however often it is used.
    for (index, plan) in definitions.plans.iter().enumerate() {
        let parameters = Parameters::declared(plan, alphabet, &mut found);
        let mut resolver = Resolver::new(&definitions, alphabet, Uses::Check);
        let (root, _) = resolver.plan(plan, parameters, Framing::PLAN);
        found.append(&mut resolver.found);
        // A plan that uses no other plan is already complete.
        if names.contains(plan.name.node) && definitions.stands_alone(index) {
            alone.insert(plan.name.node, Plan { root, quarks: resolver.quarks.into_vec() });
        }
    }
    if has_errors(&found) {
        return (Vec::new(), found);
    }
    if let Some(plan) = asked.iter().find(|plan| !plan.params.is_empty()) {
        found.push(parameters::missing(plan, "it is the one that was asked for"));
        return (Vec::new(), found);
    }
    let mut copy = |plan: &&tree::Plan| {
        if let Some(plan) = alone.remove(plan.name.node) {
            return (plan, Vec::new());
        }
        let mut resolver = Resolver::new(&definitions, alphabet, Uses::Copy);
        let (root, _) = resolver.plan(plan, Parameters::default(), Framing::PLAN);
        (Plan { root, quarks: resolver.quarks.into_vec() }, resolver.found)
    };
    let (plans, more): (Vec<_>, Vec<_>) = asked.iter().map(&mut copy).unzip();
    found.extend(more.into_iter().flatten());
    if wanted.is_some() && definitions.plans.iter().any(|plan| !plan.params.is_empty()) {
        // An argument may be out of the range of a quark to which a plan passes it, and only a copy of the plan shows
        // this.
        found.extend(roots().flat_map(|plan| copy(&plan).1));
    }
    if has_errors(&found) { (Vec::new(), found) } else { (plans, found) }
}

/// Treatment of a plan that is used by name.
#[derive(Debug, Clone, Copy)]
enum Uses {
    /// Only check that the plan exists.
    Check,
    /// Insert a copy of the plan. This is safe once all plans are known to be valid and no plan contains itself.
    Copy,
}

/// Coordinate frame of an element, as set by the `FRAME` of the element and those of the enclosing elements.
#[derive(Clone, Copy)]
struct Framing {
    /// Sum of the angles by which the frame is turned, in radians, relative to the innermost `FRAME here`.
    turned: f64,
    /// `true` if `FRAME here` is written directly before this element.
    here: bool,
}

impl Framing {
    /// Frame of a plan that no other plan uses.
    const PLAN: Self = Self { turned: 0.0, here: false };

    /// Returns the frame for the nested elements.
    fn inside(self) -> Self {
        Self { here: false, ..self }
    }
}

/// Wraps a sequence in a scope that has its own frame; an empty sequence stays empty.
fn framed(body: Vec<Node>, span: Span) -> Vec<Node> {
    if body.is_empty() {
        return body;
    }
    let (name, interrupt) = (String::new(), Interrupt::none(span));
    vec![Node::Scope(Scope { name, interrupt, body, here: true, record: None, marks: Vec::new(), span })]
}

struct Resolver<'r, 'a> {
    definitions: &'r Definitions<'a>,
    quarks: ResolvedQuarks<'r>,
    uses: Uses,
    /// Parameters of the definition that is being resolved.
    parameters: Parameters<'a>,
    /// Labels of the definition that is being resolved.
    labels: Labels,
    /// Number of definitions that have been begun so far.
    begun: u32,
    /// Span of the element that follows the current element; `None` if no element follows.
    next: Option<Span>,
    found: Vec<Diagnostic>,
}

impl<'r, 'a> Resolver<'r, 'a> {
    fn new(definitions: &'r Definitions<'a>, alphabet: &'r Alphabet, uses: Uses) -> Self {
        let quarks = ResolvedQuarks::new(alphabet);
        let (parameters, labels) = (Parameters::default(), Labels::new(RecordId(0)));
        Self { definitions, quarks, uses, parameters, labels, begun: 0, next: None, found: Vec::new() }
    }

    /// Resolves a plan of the file, with its own labels and parameters.
    fn plan(&mut self, plan: &tree::Plan<'a>, parameters: Parameters<'a>, frame: Framing) -> (Scope, EndCauses) {
        let labels = std::mem::replace(&mut self.labels, Labels::new(RecordId(self.begun)));
        self.begun = self.begun.saturating_add(1);
        let parameters = std::mem::replace(&mut self.parameters, parameters);
        let (mut scope, ends) = self.scope(plan, frame);
        self.parameters = parameters;
        std::mem::replace(&mut self.labels, labels).finish(&mut scope, &mut self.found);
        (scope, ends)
    }

    /// Resolves a behavior that is defined inside a string.
    fn behavior(&mut self, plan: &tree::Plan<'a>, frame: Framing) -> (Scope, EndCauses) {
        if !plan.params.is_empty() {
            self.found.push(parameters::missing(plan, "it is written in place"));
            let own = Parameters::declared(plan, self.quarks.alphabet(), &mut self.found);
            self.parameters.extend(own);
        }
        self.scope(plan, frame)
    }

    fn scope(&mut self, plan: &tree::Plan<'a>, frame: Framing) -> (Scope, EndCauses) {
        let (interrupt, ends) = self.interrupt(plan.condition.as_ref(), plan.name.span);
        let first = self.words_of_name(plan).max(self.bare_condition(plan)).max(self.robots_without_brackets(plan));
        let body = self.sequence(plan.elements.get(first..).unwrap_or(&[]), frame);
        let (name, span) = (plan.name.node.to_owned(), plan.name.span);
        (Scope { name, interrupt, body, here: frame.here, record: None, marks: Vec::new(), span }, ends)
    }

    fn interrupt(&mut self, condition: Option<&tree::Condition<'_>>, scope: Span) -> (Interrupt, EndCauses) {
        let names = DefinitionNames { plans: &self.definitions.names, parameters: &self.parameters };
        let around =
            ConditionScope { quarks: &mut self.quarks, names, labels: &mut self.labels, found: &mut self.found };
        let (interrupt, operands) = resolve_conditions::interrupt(condition, scope, around);
        (interrupt, EndCauses::Operands(operands))
    }

    fn sequence(&mut self, elements: &[Element<'a>], frame: Framing) -> Vec<Node> {
        let mut nodes = Vec::with_capacity(elements.len());
        let mut rest = elements;
        while let [element, others @ ..] = rest {
            let read = self.bare_law(rest);
            if read == 0 {
                self.next = others.first().filter(|_| element.marks.is_none()).map(|next| next.span);
                self.element(element, frame, &mut nodes);
            }
            rest = rest.get(read.max(1)..).unwrap_or(&[]);
        }
        nodes
    }

    fn element(&mut self, element: &Element<'a>, frame: Framing, nodes: &mut Vec<Node>) {
        if let Some(apart) = self.unit_apart(element) {
            self.found.push(apart);
            return;
        }
        let first = nodes.len();
        if let Some(label) = element.label() {
            self.labels.add(label, &mut self.found);
        }
        let frame = match element.frame() {
            None => frame.inside(),
            Some(Frame::Turned(number)) => Framing { turned: frame.turned + self.angle(number), here: false },
            Some(Frame::Here) => Framing { turned: 0.0, here: true },
        };
        let ends = match element.power() {
            None => self.primary(element, frame, nodes),
            Some(power) => self.power(power, element, frame, nodes),
        };
        if let Some(label) = element.label() {
            self.labels.ends(label.node, ends);
            // An open string ends with its last element.
            if let Some(last) = nodes.get_mut(first..).and_then(<[Node]>::last_mut) {
                last.marks_mut().push(self.labels.mark(label.node));
            }
        }
    }

    /// Resolves an element without its label and its frame. Each form of element has its own function, which saves
    /// stack space when plans use plans.
    fn primary(&mut self, element: &Element<'a>, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        match &element.primary {
            Primary::Atom(atom) => self.written(atom, element.span, frame, nodes),
            Primary::Plan(plan) => self.in_place(plan, frame, nodes),
            Primary::Ref(call) => self.used(call, frame, nodes),
            Primary::Exec(exec) => self.exec(exec, element.span, frame, nodes),
            Primary::String(elements) => self.string(elements, element.span, frame, nodes),
            Primary::Formal(formal) => self.formal(formal, element.span, frame, nodes),
            Primary::Broken => EndCauses::Unknown,
        }
    }

    /// Resolves `(s)`: an open string, which becomes a scope if it has `FRAME here`.
    fn string(&mut self, elements: &[Element<'a>], span: Span, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        if frame.here {
            nodes.extend(framed(self.sequence(elements, frame), span));
        } else {
            elements.iter().for_each(|inner| self.element(inner, frame, nodes));
        }
        EndCauses::WithItsLast
    }

    /// Resolves `s^n`, a loop.
    fn power(&mut self, power: &Count, element: &Element<'a>, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        let mut body = Vec::new();
        self.primary(element, frame, &mut body);
        let times = self.count(power);
        nodes.push(Node::Loop(Loop { times, body, marks: Vec::new(), span: element.span }));
        EndCauses::WithItsLast
    }

    /// Resolves `ExecPlan n { s }`, a loop.
    fn exec(&mut self, exec: &tree::Exec<'a>, span: Span, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        let times = self.count(&exec.count);
        let mut body = self.sequence(exec.body, frame);
        if frame.here {
            // The frame is set anew in each pass.
            body = framed(body, span);
        }
        nodes.push(Node::Loop(Loop { times, body, marks: Vec::new(), span }));
        EndCauses::WithItsLast
    }

    /// Resolves `(Atom (ξ) u)`, an atom.
    fn written(&mut self, atom: &tree::Atom<'a>, span: Span, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        if let Some(swapped) = self.swapped(atom) {
            self.found.push(swapped);
            return EndCauses::Unknown;
        }
        let (interrupt, ends) = self.interrupt(Some(&atom.condition), span);
        self.atom(atom.control, interrupt, frame, span, nodes);
        ends
    }

    /// Resolves a behavior `{ Behavior … }` inside a string to a scope.
    fn in_place(&mut self, plan: &tree::Plan<'a>, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        let (scope, ends) = self.behavior(plan, frame);
        nodes.push(Node::Scope(scope));
        ends
    }

    /// Resolves the use of a plan by name.
    fn used(&mut self, call: &Call<'a>, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        let Some((plan, parameters)) = self.reference(call) else { return EndCauses::Unknown };
        let (scope, ends) = self.plan(plan, parameters, frame);
        nodes.push(Node::Scope(scope));
        ends
    }

    fn atom(&mut self, law: &Call<'a>, interrupt: Interrupt, frame: Framing, span: Span, nodes: &mut Vec<Node>) {
        let names = DefinitionNames { plans: &self.definitions.names, parameters: &self.parameters };
        match self.quarks.resolve(law, DeclarationKind::Control, names) {
            Ok(law) => nodes.push(Node::Atom(Atom {
                law,
                interrupt,
                frame: frame.turned,
                here: frame.here,
                marks: Vec::new(),
                span,
            })),
            Err(found) => self.found.extend(found),
        }
    }

    /// Resolves `(u, ξ, T)` or `(s, ξ, T)`. The result is an atom if the body is a single law, and a scope without a
    /// name otherwise.
    fn formal(&mut self, formal: &Formal<'a>, span: Span, frame: Framing, nodes: &mut Vec<Node>) -> EndCauses {
        let (interrupt, ends) = self.timed(formal, span);
        match formal.body {
            [Element { primary: Primary::Ref(law), marks: None, .. }] if self.is_law(law) => {
                self.atom(law, interrupt, frame, span, nodes);
            }
            elements => {
                let (name, body) = (String::new(), self.sequence(elements, frame));
                let here = frame.here;
                nodes.push(Node::Scope(Scope { name, interrupt, body, here, record: None, marks: Vec::new(), span }));
            }
        }
        ends
    }

    /// Returns `true` if a name that may be a law or a plan is treated as a law, because the alphabet has this law, or
    /// because the name has arguments and no plan has this name.
    fn is_law(&self, call: &Call<'a>) -> bool {
        let mut declarations = self.quarks.alphabet().declarations_of(call.name);
        let is_bare = !call.args.is_empty() && self.definitions.get(call.name).is_none();
        is_bare || declarations.any(|declaration| declaration.kind == DeclarationKind::Control)
    }

    /// Resolves the interrupt of a scope in formal notation: `ξ OR wait T`.
    fn timed(&mut self, formal: &Formal<'a>, span: Span) -> (Interrupt, EndCauses) {
        let Some(time) = formal.time else { return self.interrupt(Some(&formal.condition), span) };
        let (args, here) = ([time], time.span());
        let wait = Call { name: "wait", args: &args, span: here };
        let wait = tree::Condition { node: ConditionNode::Call(&wait), span: here };
        let whole = |node| tree::Condition { node, span: formal.condition.span.to(here) };
        let operands = match formal.condition.node {
            ConditionNode::Null => return self.interrupt(Some(&whole(wait.node)), span),
            ConditionNode::Or(operands) => operands,
            ConditionNode::And(_)
            | ConditionNode::Not(_)
            | ConditionNode::Rising(_)
            | ConditionNode::Call(_)
            | ConditionNode::Comparison(_)
            | ConditionNode::After(_)
            | ConditionNode::Broken => std::slice::from_ref(&formal.condition),
        };
        let operands: Vec<_> = operands.iter().copied().chain([wait]).collect();
        let operands = operands.as_slice();
        self.interrupt(Some(&whole(ConditionNode::Or(&operands))), span)
    }

    /// Returns the plan that `call` names, with its arguments; `None` if no copy has to be inserted.
    fn reference(&mut self, call: &Call<'a>) -> Option<(&'r tree::Plan<'a>, Parameters<'a>)> {
        let Some(plan) = self.definitions.get(call.name) else {
            let unknown = self.unknown_plan(call);
            // The plan may be in a used file that is missing, which has been reported.
            if unknown.code != Code::E0201 || !self.definitions.is_incomplete {
                self.found.push(unknown);
            }
            return None;
        };
        match (with_arguments(plan, call, &self.parameters, self.quarks.alphabet()), self.uses) {
            (Ok(parameters), Uses::Copy) => Some((plan, parameters)),
            (Ok(_), Uses::Check) => None,
            (Err(found), _) => {
                self.found.extend(found);
                None
            }
        }
    }

    /// Resolves the number of passes of a loop, which is at least 1; returns `None` for an endless loop.
    fn count(&mut self, count: &Count) -> Option<u64> {
        let number = match count {
            Count::Infinity(_) => return None,
            Count::Name(name) => {
                match self.parameters.get(name.node).filter(|found| found.kind == ParameterKind::Count) {
                    Some(Parameter { given: Some(Arg::Number(number)), .. }) => number,
                    Some(Parameter { given: Some(Arg::Infinity(_)), .. }) => return None,
                    // Until the plan is used, the parameter has no argument; any count is valid.
                    Some(_) => return Some(1),
                    None if self.parameters.is_untyped(name.node) => return Some(1),
                    None => {
                        self.found.push(parameters::no_count(*name, &self.parameters));
                        return Some(1);
                    }
                }
            }
            Count::Number(number) => number,
        };
        let whole = Decimal::parse(number.digits()).filter(Decimal::is_whole).filter(|_| number.unit().is_none());
        let times = whole.map(|whole| {
            let positive = whole.to_f64() > 0.0;
            // A count that exceeds a u64 causes too many states, which is reported where states are counted.
            if positive { whole.to_string().parse().unwrap_or(u64::MAX) } else { 0_u64 }
        });
        if let Some(times) = times.filter(|times| *times > 0) {
            return Some(times);
        }
        let written = format!("{}{}", number.digits(), number.unit().unwrap_or_default());
        let message = format!("a loop runs a whole number of times, at least once; found `{written}`");
        self.found.push(
            Diagnostic::new(Code::E0305, message, number.span, "not a count")
                .help("write `1` or more, or `inf` for a loop without end; to run it not at all, leave it out"),
        );
        Some(1)
    }

    /// Resolves the angle of a FRAME, in radians.
    fn angle(&mut self, number: &Number) -> f64 {
        let unit = number.unit().unwrap_or("deg");
        let decimal = Decimal::parse(number.digits());
        match (Unit::from_name(unit).filter(|unit| unit.kind == ParameterKind::Angle), decimal) {
            (Some(unit), Some(decimal)) if decimal.to_f64().abs() <= FRAME => decimal.to_f64() * unit.family_to_si(),
            (Some(_), Some(_)) => {
                let message = format!("a frame is turned by an angle up to {FRAME}, found `{}`", number.digits());
                self.found.push(Diagnostic::new(Code::E0304, message, number.span, "out of range"));
                0.0
            }
            _ => {
                let message = format!("expected an angle, found `{}{unit}`", number.digits());
                self.found.push(
                    Diagnostic::new(Code::E0303, message, number.span, "a frame is turned by an angle")
                        .help("its unit is deg or rad: `FRAME 180deg`"),
                );
                0.0
            }
        }
    }
}
