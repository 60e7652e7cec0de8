//! Answers of a plan to the machine: the enclosing scope that ends, and the cause (docs/src/reference/semantics.md,
//! 5.2).

use crate::{Begin, Cursor, Entries, Follows, Fsm, Measured, Meeting, ModuleRead, Nanos, Output, Slots, Source, Words};

/// Meaning of the atoms and the scopes of a plan on one robot: emitted by `mdlec`, or loaded from text.
///
/// The order of atoms is not its task: [`Cursor`] decides that, or [`Fsm::follows`] has done so beforehand.
pub trait Plan {
    /// The robot's output.
    type Output: Output;
    /// The robot's input; its default is the null input.
    type Input: Default;
    /// Storage for the entry of each level of scopes.
    type Entered: Entries;
    /// A place for the counter of each level of loops.
    type Left: Slots<u64>;

    /// The machine's tables.
    fn fsm(&self) -> Fsm<'_>;
    /// Storage for a cursor; values do not matter.
    fn slots(&self) -> (Self::Entered, Self::Left);
    /// Makes the law of `atom`, which is now the current one; called once for each atom entered.
    fn enter(&mut self, atom: u32, y: &Self::Output, begin: Begin);
    /// Asks the interrupts around the current atom, the outermost first, and the law's completion last. Returns the
    /// scope that ends, of the first that has fired; `None` if the atom goes on.
    fn next(&self, cursor: &Cursor<Self::Entered, Self::Left>, y: &Self::Output, t: Nanos) -> Option<Ending>;

    /// Returns how long the current atom's law has made no progress towards its goal ([`Law::stalled`]); `None` in a
    /// plan that does not ask.
    ///
    /// [`Law::stalled`]: crate::Law::stalled
    #[inline(always)]
    fn stalled(&self, _y: &Self::Output, _t: Nanos) -> Option<Nanos> {
        None
    }

    /// Called before the cursor leaves a scope: a plan that remembers endings records this one, and clears the memories
    /// of nested scopes. [`Cursor::ending`] returns the brackets that end.
    #[inline(always)]
    fn leave(&mut self, _cursor: &Cursor<Self::Entered, Self::Left>, _cause: Cause, _y: &Self::Output, _t: Nanos) {}

    /// Called when the atom of a turn is found, before its law is applied: a plan that remembers conditions that have
    /// not fired records them.
    #[inline(always)]
    fn settle(&mut self, _cursor: &Cursor<Self::Entered, Self::Left>, _y: &Self::Output, _t: Nanos) {}

    /// The input that the current atom's law computes.
    fn input(&mut self, y: &Self::Output, t: Nanos) -> Self::Input;

    /// Calls `tell` with each operand that has fired of the interrupt of `scope`, which encloses the current atom: its
    /// number, in the order of [`Words::operand`], and its values. The machine calls it only for a
    /// [`Watch`](crate::Watch), before the scope is left; a plan written by hand may know no operands.
    fn operands(
        &self,
        _cursor: &Cursor<Self::Entered, Self::Left>,
        _scope: u32,
        _y: &Self::Output,
        _t: Nanos,
        _tell: &mut dyn FnMut(u32, Measured),
    ) {
    }

    /// The quark text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// The condition text of a scope's interrupt, by its bracket.
    fn condition(&self, scope: u32) -> &str;
    /// The name of a scope, by its bracket; empty for an atom.
    fn name(&self, scope: u32) -> &str;

    /// The words and places of the plan's text, if it has one.
    fn source(&self) -> &dyn Words {
        &Source::NONE
    }

    /// Returns the names of the paths that its laws replay: the caller loads these paths before the plan begins.
    fn paths(&self) -> &[&'static str] {
        &[]
    }

    /// Returns the attributes of modules that it reads: it begins once all of them have been published.
    fn reads(&self) -> &'static [ModuleRead] {
        &[]
    }

    /// Returns the names of the other robots that it reads by the state link.
    fn robots(&self) -> &[&'static str] {
        &[]
    }

    /// Returns its scopes that wait for other robots by `rendezvous`, in their order.
    fn meetings(&self) -> &[Meeting] {
        &[]
    }
}

/// Cause of the end of a scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The interrupt of the scope of this level has fired.
    Fired(u16),
    /// The law of the atom, whose scope is of this level, is done, and no enclosing interrupt has fired.
    Completed(u16),
}

impl Cause {
    /// The level of the scope that ends: 0 is the plan.
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
    /// The enclosing scope that ends, and the cause.
    pub cause: Cause,
    /// The successor, if the plan knows it beforehand; the cursor finds it otherwise.
    pub follows: Option<Follows>,
}

impl From<Cause> for Ending {
    fn from(cause: Cause) -> Self {
        Self { cause, follows: None }
    }
}

impl Cause {
    /// Returns the ending of a scope that has this successor.
    #[must_use]
    pub const fn then(self, follows: Follows) -> Ending {
        Ending { cause: self, follows: Some(follows) }
    }
}
