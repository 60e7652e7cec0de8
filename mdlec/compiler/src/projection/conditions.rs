//! Projects the conditions of a group. The first robot evaluates the conditions of atoms and behaviors. If an operand
//! of the group's own condition is about a single robot, it becomes part of the condition of this robot's plan; the
//! first robot uses `past` to detect that another robot has left its plan.

use super::build::{Build, begin};
use super::owners::{ANY, ConditionContext, LINK, MEETING, Owned, Owner};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{After, Arg, Call, Compared, Condition, ConditionNode, Operand, Plan};

/// Returns, for each robot in the order of the group, the condition that guards the robot's plan. When the condition
/// fires, only the final stop of the plan remains. The entry is `None` for a robot without such a condition.
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
            let condition = build.read(operand, ConditionContext::Head, robot);
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

/// Projects the condition of an atom. The first robot evaluates the condition.
pub(super) fn of_atom<'s>(condition: &Condition<'s>, build: &mut Build<'_, 's>) -> Condition<'s> {
    build.read(condition, ConditionContext::Atom, 0)
}

/// Projects the condition of a behavior that is defined inside another plan. The first robot evaluates the condition.
pub(super) fn of_behavior<'s>(condition: &Condition<'s>, build: &mut Build<'_, 's>) -> Condition<'s> {
    build.read(condition, ConditionContext::Behavior, 0)
}

/// Returns `true` if the operand is a timer that ends the group: a `wait` with a finite time.
fn is_timer(operand: &Condition<'_>) -> bool {
    matches!(operand.node, ConditionNode::Call(call) if call.name == "wait" && !matches!(call.args, [Arg::Infinity(_)]))
}

/// Returns `true` if the condition contains an `any` within an odd number of NOTs. `is_negated` is `true` if an odd
/// number of NOTs encloses the condition itself.
fn negates_any(condition: &Condition<'_>, is_negated: bool) -> bool {
    match condition.node {
        ConditionNode::Or(operands) | ConditionNode::And(operands) => {
            operands.iter().any(|operand| negates_any(operand, is_negated))
        }
        ConditionNode::Not(operand) => negates_any(operand, !is_negated),
        ConditionNode::Rising(operand) => negates_any(operand, is_negated),
        ConditionNode::Call(call) => is_negated && call.name == ANY,
        ConditionNode::Comparison(compared) => is_negated && compared.left.name == ANY,
        ConditionNode::After(_) | ConditionNode::Null | ConditionNode::Broken => false,
    }
}

/// Returns a warning about a group without a timer, in which the other robots wait forever if one robot is off.
fn untimed(plan: &Plan<'_>, whole: Option<&Condition<'_>>) -> Diagnostic {
    let message = format!("if a robot of the group `{}` is off, the others wait for ever", plan.name.node);
    let span = whole.map_or(plan.name.span, |condition| condition.span);
    let lint = Diagnostic::new(Code::W0209, message, span, "no timer ends the group");
    lint.help("give it a time: `OR wait 2min` after its condition, or `(wait 2min)` after its name")
}

impl<'s> Build<'_, 's> {
    /// Returns the indices of the robots that evaluate this operand of the group's condition. Reports an error if no
    /// robot can evaluate it.
    fn guarded(&mut self, operand: &Condition<'s>) -> Vec<usize> {
        let all = 0..self.robots.len();
        if negates_any(operand, false) {
            let message = "NOT before `any`: none of the robots can read this of all of them";
            let report = Diagnostic::new(Code::E0209, message, operand.span, "not on the state link");
            self.found.push(report.help(
                "each robot reads its own quark, and one robot alone is asked by its name, as in `NOT robot1.bumper`",
            ));
            return Vec::new();
        }
        let mut owners = Vec::new();
        self.owners(operand, &mut owners);
        owners.retain(|owner| *owner != Owner::Timer);
        match owners.as_slice() {
            [] => all.collect(),
            // The quark is in the plan of each robot, and each robot reads its own value.
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

    /// Appends the owners of all quarks in a condition to `owners`.
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

    /// Returns the owner of a quark, without reporting errors. An invalid quark is treated as a quark of the first
    /// robot; the error is reported when the condition of that robot is projected.
    fn silently(&mut self, call: &Call<'s>) -> Option<Owner> {
        let first = self.found.len();
        let owned = self.owned(call, ConditionContext::Head);
        self.found.truncate(first);
        Some(owned.map_or(Owner::One(0), |owned| owned.owner))
    }

    /// Converts a condition of the group to the condition for this robot.
    fn read(&mut self, condition: &Condition<'s>, place: ConditionContext, robot: usize) -> Condition<'s> {
        let span = condition.span;
        let node = match condition.node {
            ConditionNode::Or(operands) => self.all_of(operands, place, robot, ConditionNode::Or),
            ConditionNode::And(operands) => self.all_of(operands, place, robot, ConditionNode::And),
            ConditionNode::Not(operand) => ConditionNode::Not(self.inner(operand, place, robot)),
            ConditionNode::Rising(operand) => ConditionNode::Rising(self.inner(operand, place, robot)),
            ConditionNode::Call(call) => return self.quark(call, place, robot, span),
            ConditionNode::Comparison(compared) => self.comparison(compared, place, robot),
            ConditionNode::After(after) => {
                let cause = after.cause.map(|cause| self.cause(after.label.node, &cause, place, robot));
                match cause {
                    // The error has been reported.
                    Some(Condition { node: ConditionNode::Broken, .. }) => ConditionNode::Broken,
                    Some(_) | None => ConditionNode::After(self.arena.alloc(After { cause, ..*after })),
                }
            }
            ConditionNode::Null | ConditionNode::Broken => condition.node,
        };
        Condition { node, span }
    }

    /// Projects the cause in `after LABEL CAUSE` in the same way as in the condition of the atom with this label.
    fn cause(&mut self, label: &str, cause: &Condition<'s>, place: ConditionContext, robot: usize) -> Condition<'s> {
        let labelled = self.labels.get(label).copied().unwrap_or(self.done);
        let done = std::mem::replace(&mut self.done, labelled);
        let cause = self.read(cause, place, robot);
        self.done = done;
        cause
    }

    fn all_of(
        &mut self,
        operands: &[Condition<'s>],
        place: ConditionContext,
        robot: usize,
        join: fn(&'s &'s [Condition<'s>]) -> ConditionNode<'s>,
    ) -> ConditionNode<'s> {
        let operands: Vec<_> = operands.iter().map(|operand| self.read(operand, place, robot)).collect();
        join(self.arena.alloc(&*self.arena.alloc_slice_copy(&operands)))
    }

    fn inner(&mut self, operand: &Condition<'s>, place: ConditionContext, robot: usize) -> &'s Condition<'s> {
        let inner = self.read(operand, place, robot);
        self.arena.alloc(inner)
    }

    /// Projects an interrupt for this robot.
    fn quark(&mut self, call: &Call<'s>, place: ConditionContext, robot: usize, span: Span) -> Condition<'s> {
        let broken = Condition { node: ConditionNode::Broken, span };
        let Some(Owned { owner, call: own }) = self.owned(call, place) else { return broken };
        if own.name == MEETING && own.args.is_empty() {
            return self.meeting(owner, place, span).unwrap_or(broken);
        }
        if !self.may_read(call, owner, place, robot) || self.names_itself(&own, robot) {
            return broken;
        }
        Condition { node: ConditionNode::Call(self.arena.alloc(own)), span }
    }

    /// Projects `all rendezvous` and `robot2.rendezvous` to the condition that the other robots have reached this atom.
    fn meeting(&mut self, owner: Owner, place: ConditionContext, span: Span) -> Option<Condition<'s>> {
        let met = match owner {
            _ if place != ConditionContext::Atom => Err("robots meet in an atom"),
            Owner::All => Ok(1..self.robots.len()),
            Owner::One(robot) if robot > 0 => Ok(robot..robot + 1),
            Owner::One(_) => Err("the first robot of a group waits for the others, and not for itself"),
            Owner::Any | Owner::Timer => Err("robots meet when all of them are there"),
        };
        match met {
            Ok(robots) => {
                let number = self.own_number();
                let robots = self.robots.get(robots).unwrap_or(&[]);
                let whose = match (owner, robots) {
                    (Owner::One(_), [one]) => format!("{}.", one.node),
                    _ => "all ".to_owned(),
                };
                let interrupts = robots.iter().map(|robot| format!("past {} {number}", robot.node));
                self.meetings.entry(format!("{whose}{MEETING}")).or_default().extend(interrupts);
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
    fn comparison(&mut self, compared: &Compared<'s>, place: ConditionContext, robot: usize) -> ConditionNode<'s> {
        let Some(Owned { owner, call: left }) = self.owned(compared.left, place) else { return ConditionNode::Broken };
        if !self.may_read(compared.left, owner, place, robot) || self.names_itself(&left, robot) {
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

    /// Returns `true` if a robot can read a quark with this owner; otherwise, reports an error.
    fn may_read(&mut self, call: &Call<'s>, owner: Owner, place: ConditionContext, robot: usize) -> bool {
        let others = match owner {
            Owner::Timer => return true,
            Owner::One(one) if one == robot => return true,
            Owner::Any if place == ConditionContext::Head => return true,
            Owner::One(one) => format!("`{}`", self.robots.get(one).map_or("", |robot| robot.node)),
            Owner::Any | Owner::All => "other robots".to_owned(),
        };
        let first = self.robots.first().map_or("", |first| first.node);
        let message = format!("`{first}` reads this condition, and the state link does not carry it from {others}");
        let report = Diagnostic::new(Code::E0209, message, call.span, "a quark of another robot").help(LINK);
        let report = match place {
            ConditionContext::Head => report,
            ConditionContext::Atom | ConditionContext::Behavior => {
                report.help("in the condition after the group's name, each robot reads its own")
            }
        };
        self.found.push(report);
        false
    }
}
