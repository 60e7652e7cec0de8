//! Creates a plan for each robot of a group. The plan of the first robot keeps the group's conditions. In the plans of
//! all other robots, an atom ends when the first robot has reached its next atom.

use std::collections::{BTreeMap, BTreeSet};

use super::build::{Build, begin};
use super::conditions;
use super::formation::{self, FORMATION};
use super::part_name;
use super::robots::{part_used, used};
use crate::alphabet::{Alphabet, DeclarationKind, has_direction};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::Arena;
use crate::syntax::tree::{
    Arg, Atom, Condition, ConditionNode, Element, Frame, Marks, Name, Number, Plan, Primary, Spanned,
};

/// Time for which each robot stops before its plan ends. It is needed because a robot whose plan has ended sends
/// nothing, and messages on the state link may be lost.
const LAST_STOP: &str = "2s";

/// Elements of each robot, in the order of the group.
type RobotElements<'s> = Vec<Vec<Element<'s>>>;

/// Returns the plans of the robots, in the order of the group, and the meetings of the first robot.
pub(super) fn plans<'s>(
    plan: &Plan<'s>,
    robots: &[Name<'s>],
    arena: &'s Arena,
    alphabet: &Alphabet,
    found: &mut Vec<Diagnostic>,
) -> (Vec<Plan<'s>>, BTreeMap<String, BTreeSet<String>>) {
    let (mut numbers, mut labels) = (vec![1], BTreeMap::new());
    number(plan.elements, alphabet, &mut numbers, &mut labels);
    let (group, meetings) = (plan.name.node, BTreeMap::new());
    let mut build = Build { arena, robots, found, alphabet, group, numbers, done: 0, meetings, labels };
    let guards = conditions::guards(plan, &mut build);
    let parts = build.elements(plan.elements);
    let mut plans = Vec::new();
    for ((robot, guard), elements) in robots.iter().zip(guards).zip(parts) {
        plans.push(build.plan(plan, *robot, guard, &elements));
    }
    (plans, build.meetings)
}

/// For each atom, appends the number of the next atom to `numbers`. Also adds the labels of atoms to `labels`. An atom
/// whose law may complete is counted as two atoms, because a waiting atom follows it.
fn number<'s>(
    elements: &[Element<'s>],
    alphabet: &Alphabet,
    numbers: &mut Vec<usize>,
    labels: &mut BTreeMap<&'s str, usize>,
) {
    for element in elements {
        match element.primary {
            Primary::Atom(atom) => {
                labels.extend(element.label().map(|label| (label.node, numbers.len().saturating_sub(1))));
                let atoms = 1 + usize::from(completes(alphabet, atom.control.name));
                numbers.push(numbers.last().map_or(1, |last| last + atoms));
            }
            Primary::Plan(plan) => number(plan.elements, alphabet, numbers, labels),
            Primary::String(body) => number(body, alphabet, numbers, labels),
            Primary::Ref(_) | Primary::Exec(_) | Primary::Formal(_) | Primary::Broken => {}
        }
    }
}

/// Returns `true` if a law with this name may complete by itself.
fn completes(alphabet: &Alphabet, name: &str) -> bool {
    let mut declarations = alphabet.declarations_of(name);
    declarations.any(|declaration| declaration.kind == DeclarationKind::Control && declaration.completes)
}

/// Returns `true` if a law with this name may use a direction of its frame.
fn uses_frame(alphabet: &Alphabet, name: &str) -> bool {
    alphabet.declarations_of(name).any(|known| has_direction(name, known.params.iter().map(|param| param.kind)))
}

/// Returns `true` if a law in these projected elements may use a direction of the enclosing frame.
fn use_frame(alphabet: &Alphabet, elements: &[Element<'_>]) -> bool {
    elements.iter().filter(|element| element.frame() != Some(&Frame::Here)).any(|element| match element.primary {
        Primary::Atom(atom) => uses_frame(alphabet, atom.control.name),
        Primary::String(body) => use_frame(alphabet, body),
        Primary::Plan(plan) => use_frame(alphabet, plan.elements),
        Primary::Ref(_) | Primary::Exec(_) | Primary::Formal(_) | Primary::Broken => false,
    })
}

impl<'s> Build<'_, 's> {
    /// Creates the plan of a robot: a behavior with the robot's elements and the condition `guard`, followed by the
    /// final stop.
    fn plan(&self, plan: &Plan<'s>, robot: Name<'s>, guard: Option<Condition<'s>>, body: &[Element<'s>]) -> Plan<'s> {
        let span = plan.name.span;
        let body = self.list(body);
        let guarded =
            Plan { docs: &[], label: None, group: None, params: &[], condition: guard, elements: body, ..*plan };
        let guarded = Element { primary: Primary::Plan(self.arena.alloc(guarded)), marks: None, span: plan.span };
        // The condition is not in the group's text, so its span is empty, and reports of runs show the condition's own
        // text.
        let at = begin(span);
        let wait = self.call("wait", &[Arg::Number(Number::new(LAST_STOP, at))], at);
        let condition = Condition { node: ConditionNode::Call(wait), span: at };
        let stop = self.atom(condition, self.call("stop", &[], span), None, span);
        let node = self.arena.alloc_str(&part_name(self.group, robot.node));
        let elements = self.list(&[guarded, stop]);
        let (docs, name) = (self.docs(robot), Spanned { node: &*node, span });
        Plan { docs, label: None, name, group: None, params: &[], condition: None, elements, span: plan.span }
    }

    /// Returns the doc comment of a robot's plan, which names the links that the robot needs.
    fn docs(&self, robot: Name<'s>) -> &'s [&'s str] {
        let (group, first) = (self.group, self.robots.first().map_or("", |first| first.node));
        let others: Vec<_> = self.robots.iter().skip(1).map(|other| format!("`{}`", other.node)).collect();
        let line = match robot.node == first {
            true => format!(" `{first}` decides for the group {group}: it hears {}.", others.join(" and ")),
            false => format!(" `{}` of the group {group} hears `{first}`.", robot.node),
        };
        self.arena.alloc_slice_copy(&[&*self.arena.alloc_str(&line)])
    }

    fn elements(&mut self, elements: &[Element<'s>]) -> RobotElements<'s> {
        let mut parts = vec![Vec::new(); self.robots.len()];
        for element in elements {
            if let Some(power) = element.power() {
                self.refuse("a group has no loops", power.span(), "write the elements as often as they run");
            }
            match element.primary {
                Primary::Atom(atom) => self.group_atom(atom, element, &mut parts),
                Primary::Plan(plan) if plan.group.is_none() => self.behavior(plan, element, &mut parts),
                Primary::String(body) => {
                    let inner = self.elements(body);
                    self.joined(inner, element, &mut parts);
                }
                Primary::Ref(call) if call.name == self.group => self.found.push(used(call)),
                Primary::Ref(call) if self.is_part(call.name) => self.found.push(part_used(call)),
                Primary::Ref(call) => {
                    let help = "write its elements here: the first robot decides when each of them ends";
                    self.refuse("a group uses no plan by name", call.span, help);
                }
                Primary::Exec(exec) => {
                    self.refuse("a group has no loops", exec.count.span(), "write the elements as often as they run");
                }
                Primary::Formal(formal) => {
                    self.refuse(
                        "a group has no formal notation",
                        formal.condition.span,
                        "write `(Atom (condition) law)`",
                    );
                }
                // A group in a group is reported like a group in any other plan.
                Primary::Plan(_) | Primary::Broken => {}
            }
        }
        parts
    }

    /// Returns `true` if `name` is the name of the plan of one of the group's robots.
    fn is_part(&self, name: &str) -> bool {
        self.robots.iter().any(|robot| part_name(self.group, robot.node) == name)
    }

    fn refuse(&mut self, message: &str, span: Span, help: &str) {
        self.found.push(Diagnostic::new(Code::E0208, message, span, "not in a group").help(help));
    }

    /// Projects an atom. In the plan of the first robot, the atom keeps its condition; in the plans of all other
    /// robots, it runs until the first robot has reached its next atom.
    fn group_atom(&mut self, atom: &Atom<'s>, element: &Element<'s>, parts: &mut RobotElements<'s>) {
        let condition = conditions::of_atom(&atom.condition, self);
        self.done += 1;
        let laws = match atom.control.name {
            FORMATION => formation::read(atom.control, self).map(|formation| (formation.first, formation.others)),
            _ => Some((atom.control, vec![atom.control; self.robots.len().saturating_sub(1)])),
        };
        let Some((first, others)) = laws else { return };
        let (span, until) = (element.span, self.past_first(self.done + 1, atom.condition.span));
        let marks = element.marks.map(|marks| &*self.arena.alloc(Marks { label: None, ..*marks }));
        let laws: Vec<_> = std::iter::once(first).chain(others).collect();
        for (robot, law) in laws.iter().enumerate() {
            self.names_itself(law, robot);
        }
        for (part, law) in parts.iter_mut().zip(laws).skip(1) {
            let marks = marks.filter(|_| uses_frame(self.alphabet, law.name));
            part.push(self.atom(until, law, marks, span));
            if completes(self.alphabet, law.name) {
                part.push(self.atom(until, self.call("stop", &[], law.span), None, span));
            }
        }
        if let Some(part) = parts.first_mut() {
            part.push(self.atom(condition, first, element.marks, span));
        }
    }

    /// Projects a behavior in place. The first robot evaluates its condition.
    fn behavior(&mut self, plan: &Plan<'s>, element: &Element<'s>, parts: &mut RobotElements<'s>) {
        if let [param, ..] = plan.params {
            self.refuse("a plan in a group has no parameters", param.name.span, "write the value in each place");
        }
        let condition = plan.condition.as_ref().map(|condition| conditions::of_behavior(condition, self));
        let mut inner = self.elements(plan.elements);
        if let (Some(first), Some(part)) = (inner.first_mut(), parts.first_mut()) {
            let plan = Plan { condition, params: &[], elements: self.list(first), ..*plan };
            first.clear();
            part.push(Element { primary: Primary::Plan(self.arena.alloc(plan)), ..*element });
        }
        self.joined(inner, element, parts);
    }

    /// Appends the projected elements of a string to the elements of each robot. The first robot's plan keeps the
    /// string's label and frame. Another robot's plan keeps the frame if a law in its elements may use it.
    fn joined(&self, inner: RobotElements<'s>, element: &Element<'s>, parts: &mut RobotElements<'s>) {
        for (robot, (part, inner)) in parts.iter_mut().zip(inner).enumerate() {
            let label = element.label().filter(|_| robot == 0);
            let frame = element.frame().filter(|_| robot == 0 || use_frame(self.alphabet, &inner));
            if inner.is_empty() || frame.is_none() && label.is_none() {
                part.extend(inner);
                continue;
            }
            let marks = Marks { label, frame: frame.copied(), power: None };
            let primary = Primary::String(self.arena.alloc(self.list(&inner)));
            part.push(Element { primary, marks: Some(self.arena.alloc(marks)), span: element.span });
        }
    }
}
