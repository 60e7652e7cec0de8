//! Interface between a plan and the machine: the plan determines which enclosing scope ends, and the cause
//! (docs/src/reference/semantics.md, 5.2).

use crate::{Begin, Cursor, Entries, Follows, Fsm, Measured, Meeting, ModuleRead, Nanos, Output, Slots, Source, Words};

/// Conditions and laws of one robot's plan, with the tables of the plan's machine. `mdlec` emits a plan as code, or a
/// program loads it from text.
///
/// A plan does not determine the order of atoms: [`Cursor`] does, or [`Fsm::follows`] in advance.
pub trait Plan {
    /// Output of the robot.
    type Output: Output;
    /// Input of the robot; the default is the null input.
    type Input: Default;
    /// Storage for the entry of the scope at each level.
    type Entered: Entries;
    /// Storage for the counter of the loop at each level.
    type Left: Slots<u64>;

    /// Returns the machine's tables.
    fn fsm(&self) -> Fsm<'_>;
    /// Returns storage for a cursor; the initial values do not matter.
    fn slots(&self) -> (Self::Entered, Self::Left);
    /// Creates the law of `atom`, which is now the current atom. Called once for each atom entered.
    fn enter(&mut self, atom: u32, y: &Self::Output, begin: Begin);
    /// Evaluates the interrupts of the scopes that enclose the current atom, and then the completion of the law.
    /// Returns the ending of the outermost scope whose interrupt has fired, or of the atom's own scope if the law is
    /// done; `None` if the atom continues.
    fn next(&self, cursor: &Cursor<Self::Entered, Self::Left>, y: &Self::Output, t: Nanos) -> Option<Ending>;

    /// Returns `false` if the plan stores neither odometry nor progress nor memories; the machine then does not call
    /// [`Entries::observe`], [`Plan::leave`] and [`Plan::settle`]. The value never changes while the plan runs.
    #[inline(always)]
    fn observes(&self) -> bool {
        true
    }

    /// Returns how long the current atom's law has made no progress towards its goal ([`Law::stalled`]); `None`
    /// in a plan without `stuck`.
    ///
    /// [`Law::stalled`]: crate::Law::stalled
    #[inline(always)]
    fn stalled(&self, _y: &Self::Output, _t: Nanos) -> Option<Nanos> {
        None
    }

    /// Called before the cursor leaves a scope. A plan with memories records, for `after`, which elements end and why,
    /// and clears the memories of all scopes that end. [`Cursor::ending`] returns the brackets of the elements that
    /// end.
    #[inline(always)]
    fn leave(&mut self, _cursor: &Cursor<Self::Entered, Self::Left>, _cause: Cause, _y: &Self::Output, _t: Nanos) {}

    /// Called after the transitions of a turn, before the law of the current atom is applied. A plan with RISING
    /// records which operands of RISING have not fired.
    #[inline(always)]
    fn settle(&mut self, _cursor: &Cursor<Self::Entered, Self::Left>, _y: &Self::Output, _t: Nanos) {}

    /// Returns the input that the current atom's law computes.
    fn input(&mut self, y: &Self::Output, t: Nanos) -> Self::Input;

    /// Calls `tell` with the number and the values of each fired operand in the interrupt of `scope`, which encloses
    /// the current atom. Operands are numbered as in [`Words::operand`]. The machine calls this function only for a
    /// [`Watch`](crate::Watch), before the scope is left. A plan written by hand may report no operands.
    fn operands(
        &self,
        _cursor: &Cursor<Self::Entered, Self::Left>,
        _scope: u32,
        _y: &Self::Output,
        _t: Nanos,
        _tell: &mut dyn FnMut(u32, Measured),
    ) {
    }

    /// Returns the quark text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// Returns the condition text of a scope's interrupt; `scope` is the number of its bracket.
    fn condition(&self, scope: u32) -> &str;
    /// Returns the name of a scope, given the number of its bracket; an empty text for an atom.
    fn name(&self, scope: u32) -> &str;

    /// Returns the plan's source text for reports; it may be empty.
    fn source(&self) -> &dyn Words {
        &Source::NONE
    }

    /// Returns the names of the paths that the plan's laws replay. The caller loads these paths before the plan
    /// begins.
    fn paths(&self) -> &[&'static str] {
        &[]
    }

    /// Returns the attributes of modules that the plan reads. The plan begins once all of them have been
    /// published.
    fn reads(&self) -> &'static [ModuleRead] {
        &[]
    }

    /// Returns the names of the other robots whose states the plan reads over the state link.
    fn robots(&self) -> &[&'static str] {
        &[]
    }

    /// Returns the scopes that wait for other robots with `rendezvous`, in order.
    fn meetings(&self) -> &[Meeting] {
        &[]
    }
}

/// Cause of the end of a scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The interrupt of the scope at this level has fired.
    Fired(u16),
    /// The law of the atom is done, and no enclosing interrupt has fired. Contains the level of the atom's scope.
    Completed(u16),
}

impl Cause {
    /// Returns the level of the scope that ends; the plan has level 0.
    #[must_use]
    pub const fn level(self) -> u16 {
        match self {
            Self::Fired(level) | Self::Completed(level) => level,
        }
    }
}

/// A scope that ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ending {
    /// Cause of the end, with the level of the enclosing scope that ends.
    pub cause: Cause,
    /// Successor of the scope, if it is known before the plan runs; `None` if the cursor has to find it.
    pub follows: Option<Follows>,
}

impl From<Cause> for Ending {
    fn from(cause: Cause) -> Self {
        Self { cause, follows: None }
    }
}

impl Cause {
    /// Creates the ending of a scope with this cause and the successor `follows`.
    #[must_use]
    pub const fn then(self, follows: Follows) -> Ending {
        Ending { cause: self, follows: Some(follows) }
    }
}
