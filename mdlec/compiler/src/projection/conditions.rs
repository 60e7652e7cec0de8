//! Projects the conditions of a group: its first robot reads them. In the head, a robot's own signals guard its plan;
//! the others hear by `past` that it has left.

use super::build::{Build, begin};
use crate::alphabet::nearest;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{After, Arg, Call, Compared, Condition, ConditionNode, Operand, Plan};

/// The interrupt by which robots meet.
const MEETING: &str = "rendezvous";

/// Place of a condition, which decides what it may read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// An operand of the group's own condition.
    Head,
    /// The condition of an atom.
    Atom,
    /// The condition of a behavior in place.
    Behavior,
}

/// Robots to which a quark belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Owner {
    /// A timer, which each robot has alike.
    Timer,
    /// One robot, by its index in the group.
    One(usize),
    /// Any robot of the group.
    Any,
    /// All robots of the group.
    All,
}

/// A quark without its robot.
struct Owned<'s> {
    owner: Owner,
    call: Call<'s>,
}

/// Returns the guards of the robots' plans, in the order of the group.
pub(super) fn guards<'s>(plan: &Plan<'s>, build: &mut Build<'_, 's>) -> Vec<Option<Condition<'s>>> {
    let whole = plan.condition.filter(|condition| condition.node != ConditionNode::Null);
    let span = whole.map_or(plan.name.span, |condition| condition.span);
    let operands: &[Condition<'s>] = match &whole {
        None => &[],
        Some(Condition { node: ConditionNode::Or(operands), .. }) => operands,
        Some(only) => std::slice::from_ref(only),
    };
    let mut guards = vec![Vec::new(); build.robots.len()];
    for operand in operands {
        for robot in build.guarded(operand) {
            let condition = build.read(operand, Place::Head, robot);
            guards.get_mut(robot).into_iter().for_each(|guard| guard.push(condition));
        }
    }
    if !operands.iter().any(is_timer) {
        build.found.push(untimed(plan, whole.as_ref()));
    }
    let last = build.last_number();
    let left: Vec<_> = build.robots.iter().skip(1).map(|robot| build.past(robot, last, begin(span))).collect();
    guards.first_mut().into_iter().for_each(|first| first.extend(&left));
    let joined = |guard: &Vec<_>| (!guard.is_empty()).then(|| build.join(guard, span, ConditionNode::Or));
    guards.iter().map(joined).collect()
}

/// Projects the condition of an atom, which the first robot reads.
pub(super) fn of_atom<'s>(condition: &Condition<'s>, build: &mut Build<'_, 's>) -> Condition<'s> {
    build.read(condition, Place::Atom, 0)
}

/// Projects the condition of a behavior in place, which the first robot reads.
pub(super) fn of_behavior<'s>(condition: &Condition<'s>, build: &mut Build<'_, 's>) -> Condition<'s> {
    build.read(condition, Place::Behavior, 0)
}

fn is_timer(operand: &Condition<'_>) -> bool {
    matches!(operand.node, ConditionNode::Call(call) if call.name == "wait")
}

/// Warns of a group without a timer: a robot that is off would be waited for without end.
fn untimed(plan: &Plan<'_>, whole: Option<&Condition<'_>>) -> Diagnostic {
    let message = format!("if a robot of the group `{}` is off, the others wait for ever", plan.name.node);
    let span = whole.map_or(plan.name.span, |condition| condition.span);
    let lint = Diagnostic::new(Code::W0209, message, span, "no timer ends the group");
    lint.help("give it a time: `OR wait 2min` after its condition, or `(wait 2min)` after its name")
}

impl<'s> Build<'_, 's> {
    /// Returns the robots whose plans an operand of the group's condition guards.
    fn guarded(&mut self, operand: &Condition<'s>) -> Vec<usize> {
        let all = 0..self.robots.len();
        let mut owners = Vec::new();
        self.owners(operand, &mut owners);
        owners.retain(|owner| *owner != Owner::Timer);
        match owners.as_slice() {
            [] => all.collect(),
            // Each robot reads its own.
            [Owner::Any] => all.collect(),
            [Owner::One(first), others @ ..] if others.iter().all(|owner| *owner == Owner::One(*first)) => vec![*first],
            _ => {
                let message = "one condition of several robots: none of them can read it";
                let report = Diagnostic::new(Code::E0209, message, operand.span, "not on the state link");
                self.found.push(report.help(
                    "in the head of a group, OR joins conditions of one robot each, and `any bumper` is one of each robot",
                ));
                Vec::new()
            }
        }
    }

    /// Adds the owners of the quarks of a condition.
    fn owners(&mut self, condition: &Condition<'s>, owners: &mut Vec<Owner>) {
        match condition.node {
            ConditionNode::Or(operands) | ConditionNode::And(operands) => {
                operands.iter().for_each(|operand| self.owners(operand, owners));
            }
            ConditionNode::Not(operand) | ConditionNode::Rising(operand) => self.owners(operand, owners),
            ConditionNode::Call(call) => owners.extend(self.silently(call)),
            ConditionNode::Comparison(compared) => owners.extend(self.silently(compared.left)),
            ConditionNode::After(_) => owners.push(Owner::One(0)),
            ConditionNode::Null | ConditionNode::Broken => owners.push(Owner::Timer),
        }
    }

    /// Returns the owner of a quark; one that is wrong counts as the first robot's, which reports it.
    fn silently(&mut self, call: &Call<'s>) -> Option<Owner> {
        let first = self.found.len();
        let owned = self.owned(call, Place::Head);
        self.found.truncate(first);
        Some(owned.map_or(Owner::One(0), |owned| owned.owner))
    }

    /// Projects a condition for this robot.
    fn read(&mut self, condition: &Condition<'s>, place: Place, robot: usize) -> Condition<'s> {
        let span = condition.span;
        let node = match condition.node {
            ConditionNode::Or(operands) => self.all_of(operands, place, robot, ConditionNode::Or),
            ConditionNode::And(operands) => self.all_of(operands, place, robot, ConditionNode::And),
            ConditionNode::Not(operand) => ConditionNode::Not(self.inner(operand, place, robot)),
            ConditionNode::Rising(operand) => ConditionNode::Rising(self.inner(operand, place, robot)),
            ConditionNode::Call(call) => return self.quark(call, place, robot, span),
            ConditionNode::Comparison(compared) => self.comparison(compared, place, robot),
            ConditionNode::After(after) => {
                let cause = after.cause.map(|cause| self.read(&cause, place, robot));
                ConditionNode::After(self.arena.alloc(After { cause, ..*after }))
            }
            ConditionNode::Null | ConditionNode::Broken => condition.node,
        };
        Condition { node, span }
    }

    fn all_of(
        &mut self,
        operands: &[Condition<'s>],
        place: Place,
        robot: usize,
        join: fn(&'s &'s [Condition<'s>]) -> ConditionNode<'s>,
    ) -> ConditionNode<'s> {
        let operands: Vec<_> = operands.iter().map(|operand| self.read(operand, place, robot)).collect();
        join(self.arena.alloc(&*self.arena.alloc_slice_copy(&operands)))
    }

    fn inner(&mut self, operand: &Condition<'s>, place: Place, robot: usize) -> &'s Condition<'s> {
        let inner = self.read(operand, place, robot);
        self.arena.alloc(inner)
    }

    /// Projects an interrupt for this robot.
    fn quark(&mut self, call: &Call<'s>, place: Place, robot: usize, span: Span) -> Condition<'s> {
        let broken = Condition { node: ConditionNode::Broken, span };
        let Some(Owned { owner, call: own }) = self.owned(call, place) else { return broken };
        if own.name == MEETING && own.args.is_empty() {
            return self.meeting(owner, place, span).unwrap_or(broken);
        }
        if !self.may_read(call, owner, place, robot) {
            return broken;
        }
        Condition { node: ConditionNode::Call(self.arena.alloc(own)), span }
    }

    /// Projects `all rendezvous` and `robot2.rendezvous`: the others are at this atom.
    fn meeting(&mut self, owner: Owner, place: Place, span: Span) -> Option<Condition<'s>> {
        let met = match owner {
            _ if place != Place::Atom => Err("robots meet in an atom"),
            Owner::All => Ok(1..self.robots.len()),
            Owner::One(robot) if robot > 0 => Ok(robot..robot + 1),
            Owner::One(_) => Err("the first robot of a group waits for the others, and not for itself"),
            Owner::Any | Owner::Timer => Err("robots meet when all of them are there"),
        };
        match met {
            Ok(robots) => {
                let number = self.own_number();
                let robots = self.robots.get(robots).unwrap_or(&[]);
                let there: Vec<_> = robots.iter().map(|robot| self.past(robot, number, span)).collect();
                Some(self.join(&there, span, ConditionNode::And))
            }
            Err(message) => {
                let report = Diagnostic::new(Code::E0209, message, span, "not expected here");
                self.found.push(report.help("robots wait for each other by `(Atom (all rendezvous) stop)`"));
                None
            }
        }
    }

    /// Projects a comparison for this robot.
    fn comparison(&mut self, compared: &Compared<'s>, place: Place, robot: usize) -> ConditionNode<'s> {
        let Some(Owned { owner, call: left }) = self.owned(compared.left, place) else { return ConditionNode::Broken };
        if !self.may_read(compared.left, owner, place, robot) {
            return ConditionNode::Broken;
        }
        let right = match compared.right {
            Operand::Signal(signal) if owner == Owner::Any && !signal.name.contains('.') => Operand::Signal(signal),
            Operand::Signal(signal) => match self.owned(signal, place) {
                Some(right) if right.owner == owner => Operand::Signal(self.arena.alloc(right.call)),
                Some(_) => {
                    let message = "one comparison of two robots: neither of them can read it";
                    self.found.push(Diagnostic::new(Code::E0209, message, signal.span, "another robot's").help(LINK));
                    return ConditionNode::Broken;
                }
                None => return ConditionNode::Broken,
            },
            value @ (Operand::Number(_) | Operand::Infinity(_)) => value,
        };
        ConditionNode::Comparison(self.arena.alloc(Compared { left: self.arena.alloc(left), right, ..*compared }))
    }

    /// Returns `true` if a robot reads quarks of this owner; reports it otherwise.
    fn may_read(&mut self, call: &Call<'s>, owner: Owner, place: Place, robot: usize) -> bool {
        let others = match owner {
            Owner::Timer => return true,
            Owner::One(one) if one == robot => return true,
            Owner::Any if place == Place::Head => return true,
            Owner::One(one) => format!("`{}`", self.robots.get(one).map_or("", |robot| robot.node)),
            Owner::Any | Owner::All => "other robots".to_owned(),
        };
        let first = self.robots.first().map_or("", |first| first.node);
        let message = format!("`{first}` reads this condition, and the state link does not carry it from {others}");
        let report = Diagnostic::new(Code::E0209, message, call.span, "a quark of another robot").help(LINK);
        let report = match place {
            Place::Head => report,
            Place::Atom | Place::Behavior => {
                report.help("in the condition after the group's name, each robot reads its own")
            }
        };
        self.found.push(report);
        false
    }

    /// Returns a quark without its robot; `None` if it was reported.
    fn owned(&mut self, call: &Call<'s>, place: Place) -> Option<Owned<'s>> {
        match call.name {
            "wait" => Some(Owned { owner: Owner::Timer, call: *call }),
            "any" => self.of_several(call, Owner::Any),
            "all" => self.of_several(call, Owner::All),
            _ => match call.name.split_once('.') {
                Some((robot, name)) => self.of_one(call, robot, name),
                None => {
                    self.found.push(self.whose(call, place));
                    None
                }
            },
        }
    }

    /// Reads `any q` and `all q`.
    fn of_several(&mut self, call: &Call<'s>, owner: Owner) -> Option<Owned<'s>> {
        match call.args {
            [Arg::Name(name), args @ ..] if !name.node.contains('.') => {
                let span = name.span.to(call.span);
                Some(Owned { owner, call: Call { name: name.node, args, span } })
            }
            _ => {
                let message = format!("`{}` is followed by an interrupt or a signal of each robot", call.name);
                let report = Diagnostic::new(Code::E0209, message, call.span, "no quark follows");
                self.found.push(report.help("write `any bumper`, `any x > 7m` or `all rendezvous`"));
                None
            }
        }
    }

    /// Reads `robot1.x`.
    fn of_one(&mut self, call: &Call<'s>, robot: &'s str, name: &'s str) -> Option<Owned<'s>> {
        let start = call.span.start + u32::try_from(robot.len()).unwrap_or(0);
        let place = Span { end: start, ..call.span };
        let Some(index) = self.robots.iter().position(|known| known.node == robot) else {
            let message = format!("the group has no robot `{robot}`");
            let report = Diagnostic::new(Code::E0201, message, place, "not in the group");
            let known: Vec<&str> = self.robots.iter().map(|robot| robot.node).collect();
            self.found.push(match nearest(robot, known.iter().copied()) {
                Some(near) => report.fix("did you mean {}?", place, near),
                None => report.help(format!("its robots are {}", known.join(", "))),
            });
            return None;
        };
        let span = Span { start: start + 1, ..call.span };
        Some(Owned { owner: Owner::One(index), call: Call { name, span, ..*call } })
    }

    /// Reports a quark of which nobody knows whose it is.
    fn whose(&self, call: &Call<'s>, place: Place) -> Diagnostic {
        let (name, here) = (call.name, call.name_span());
        let report = Diagnostic::new(Code::E0209, format!("`{name}` of which robot?"), here, "no robot is named");
        if name == MEETING {
            return report.fix("of all robots: {}", here, format!("all {name}"));
        }
        let first = self.robots.first().map_or("", |first| first.node);
        let report = report.fix("of the first robot: {}", here, format!("{first}.{name}"));
        match place {
            Place::Head => report.fix("of any robot: {}", here, format!("any {name}")),
            Place::Atom | Place::Behavior => report,
        }
    }
}

/// Help about what the state link carries.
const LINK: &str =
    "the link carries where each robot and its plan are: for these there are `all rendezvous` and formations";
