//! Finds the robot to which a quark in the text of a group belongs: `any q`, `all q` and `robot1.q`.

use super::build::Build;
use crate::alphabet::{ParameterKind, nearest};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{Arg, Call};

/// The interrupt with which robots meet.
pub(super) const MEETING: &str = "rendezvous";
/// Word before a quark that each robot reads for itself.
pub(super) const ANY: &str = "any";
/// Help message about the data that the state link carries.
pub(super) const LINK: &str =
    "the link carries where each robot and its plan are: for these there are `all rendezvous` and formations";

/// Context of a condition, which determines the quarks that the condition may contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConditionContext {
    /// An operand of the group's own condition.
    Head,
    /// The condition of an atom.
    Atom,
    /// The condition of a behavior in place.
    Behavior,
}

/// Robots to which a quark belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Owner {
    /// A timer, which runs alike on every robot.
    Timer,
    /// One robot, by its index in the group.
    One(usize),
    /// Any robot of the group.
    Any,
    /// All robots of the group.
    All,
}

/// A quark, separated from the name of its robot.
pub(super) struct Owned<'s> {
    pub(super) owner: Owner,
    pub(super) call: Call<'s>,
}

impl<'s> Build<'_, 's> {
    /// Separates a quark from the name of its robot. Reports an invalid quark and returns `None` for it.
    pub(super) fn owned(&mut self, call: &Call<'s>, place: ConditionContext) -> Option<Owned<'s>> {
        match call.name {
            "wait" => Some(Owned { owner: Owner::Timer, call: *call }),
            ANY => self.of_several(call, Owner::Any),
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

    /// Parses `any q` and `all q`.
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

    /// Parses `robot1.x`.
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

    /// Reports a quark that does not name its robot.
    fn whose(&self, call: &Call<'s>, place: ConditionContext) -> Diagnostic {
        let (name, here) = (call.name, call.name_span());
        let report = Diagnostic::new(Code::E0209, format!("`{name}` of which robot?"), here, "no robot is named");
        if name == MEETING {
            return report.fix("of all robots: {}", here, format!("all {name}"));
        }
        let first = self.robots.first().map_or("", |first| first.node);
        let report = report.fix("of the first robot: {}", here, format!("{first}.{name}"));
        match place {
            ConditionContext::Head => report.fix("of any robot: {}", here, format!("any {name}")),
            ConditionContext::Atom | ConditionContext::Behavior => report,
        }
    }

    /// Returns `true`, and reports an error, if a robot would apply or read a quark that names this robot itself.
    pub(super) fn names_itself(&mut self, call: &Call<'s>, robot: usize) -> bool {
        let Some(own) = self.robots.get(robot) else { return false };
        let names_robot = |index: usize| {
            let mut declarations = self.alphabet.declarations_of(call.name);
            declarations.any(|known| known.params.get(index).is_some_and(|param| param.kind == ParameterKind::Robot))
        };
        let itself = call.args.iter().enumerate().find_map(|(index, arg)| {
            let Arg::Name(name) = arg else { return None };
            (name.node == own.node && names_robot(index)).then_some(name.span)
        });
        let Some(span) = itself else { return false };
        let message = format!("in the plan of `{0}`, `{1} {0}` names that robot itself", own.node, call.name);
        let report = Diagnostic::new(Code::E0209, message, span, "the robot itself");
        self.found.push(report.help("a robot has no state link with itself: name a robot that is not in the group"));
        true
    }
}
