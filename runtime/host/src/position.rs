//! A plan and the position in it, behind interfaces without the types of either.

use mdle_runtime::{Frame, Fsm, Machine, Nanos, Plan, Words};

/// Texts and tables of a plan, for reports: [`Plan`] without the types of its robot.
pub trait Texts {
    /// The machine's tables.
    fn fsm(&self) -> Fsm<'_>;
    /// The quark text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// The condition text of a scope's interrupt, by its bracket.
    fn condition(&self, scope: u32) -> &str;
    /// The name of a scope, by its bracket; empty for an atom.
    fn name(&self, scope: u32) -> &str;
    /// The words and places of the plan's text, if it has one.
    fn source(&self) -> &dyn Words;
    /// Returns the names of the paths that its laws replay.
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

/// The position in a plan that runs, for reports: [`Machine`] without the types of its plan.
pub(crate) trait Position {
    /// The plan's texts.
    fn texts(&self) -> &dyn Texts;
    /// The number of the current state in the expanded plan.
    fn state(&self) -> u64;
    /// Returns the index of the current atom in source order, from 0; `None` when the plan is over.
    fn atom(&self) -> Option<u32>;
    /// Frame of the current atom if a `FRAME here` encloses it.
    fn frame(&self) -> Option<Frame>;
    /// The bracket of the enclosing scope at this level.
    fn scope(&self, level: u16) -> u32;
    /// Time since the enclosing scope of this level was entered, at time `t`.
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
