//! Interfaces to a plan and to the position in a plan, independent of the types of the plan and the robot.

use mdle_runtime::{Frame, Fsm, Machine, Nanos, Plan, Words};

/// Texts and tables of a plan, for reports: like [`Plan`], but without the types of its robot.
pub trait Texts {
    /// Returns the tables of the state machine.
    fn fsm(&self) -> Fsm<'_>;
    /// Returns the text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// Returns the condition text of a scope's interrupt, given the number of the scope's bracket.
    fn condition(&self, scope: u32) -> &str;
    /// Returns the name of a scope, given the number of its bracket; an empty text for an atom.
    fn name(&self, scope: u32) -> &str;
    /// Returns the plan's source text for reports; it may be empty.
    fn source(&self) -> &dyn Words;
    /// Returns the names of the paths that the plan's laws replay.
    fn paths(&self) -> &[&'static str];
}

impl<P: Plan> Texts for P {
    fn fsm(&self) -> Fsm<'_> {
        Plan::fsm(self)
    }

    fn law(&self, atom: u32) -> &str {
        Plan::law(self, atom)
    }

    fn condition(&self, scope: u32) -> &str {
        Plan::condition(self, scope)
    }

    fn name(&self, scope: u32) -> &str {
        Plan::name(self, scope)
    }

    fn source(&self) -> &dyn Words {
        Plan::source(self)
    }

    fn paths(&self) -> &[&'static str] {
        Plan::paths(self)
    }
}

/// The position in a running plan, for reports: like [`Machine`], but without the types of its plan.
pub(crate) trait Position {
    /// Returns the texts of the plan.
    fn texts(&self) -> &dyn Texts;
    /// Returns the number of the current state in the expanded plan.
    fn state(&self) -> u64;
    /// Returns the index of the current atom in the order of the plan's text; `None` when the plan has ended.
    fn atom(&self) -> Option<u32>;
    /// Returns the frame of the current atom, if a `FRAME here` encloses the atom.
    fn frame(&self) -> Option<Frame>;
    /// Returns the number of the bracket of the enclosing scope at this level.
    fn scope(&self, level: u16) -> u32;
    /// Returns the time, at time `t`, since the enclosing scope of this level was entered.
    fn since(&self, level: u16, t: Nanos) -> Nanos;
}

impl<P: Plan> Position for Machine<P> {
    fn texts(&self) -> &dyn Texts {
        self.plan()
    }

    fn state(&self) -> u64 {
        self.state()
    }

    fn atom(&self) -> Option<u32> {
        self.atom()
    }

    fn frame(&self) -> Option<Frame> {
        self.frame()
    }

    fn scope(&self, level: u16) -> u32 {
        self.cursor().scope(self.plan().fsm(), level)
    }

    fn since(&self, level: u16, t: Nanos) -> Nanos {
        self.cursor().since(level, t)
    }
}
