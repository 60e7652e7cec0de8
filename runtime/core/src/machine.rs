//! One turn of a plan: interrupts outermost first, then the law of the atom that is left standing (semantics, section 5).

use crate::{Begin, Cursor, Frame, Fsm, Nanos, Output, Slots};

/// The most transitions of one turn; the search for the next atom then goes on in the next turn.
pub const TRANSITIONS_PER_TURN: u32 = 4096;

/// What the atoms and the scopes of a plan mean on one robot: `mdlec` emits it, or it is loaded from text.
///
/// [`Machine`] alone decides what runs next.
pub trait Plan {
    /// The robot's output.
    type Output: Output;
    /// The robot's input; its default is the null input.
    type Input: Default;
    /// A place for the entry time of each level of scopes.
    type Entered: Slots<Nanos>;
    /// A place for the counter of each level of loops.
    type Left: Slots<u64>;

    /// The machine's tables.
    fn fsm(&self) -> Fsm<'_>;
    /// Storage for a cursor; values do not matter.
    fn slots(&self) -> (Self::Entered, Self::Left);
    /// Makes the law of `atom`, which is now the current one; called once for each atom entered.
    fn enter(&mut self, atom: u32, y: &Self::Output, begin: Begin);
    /// The outermost scope around the current atom whose interrupt has fired, the law's completion last.
    fn fired(&self, cursor: &Cursor<Self::Entered, Self::Left>, y: &Self::Output, t: Nanos) -> Option<Cause>;
    /// The input that the current atom's law computes.
    fn input(&mut self, y: &Self::Output, t: Nanos) -> Self::Input;

    /// The quark text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// The condition text of a scope's interrupt, by its bracket.
    fn condition(&self, scope: u32) -> &str;
    /// The name of a scope, by its bracket; empty for an atom.
    fn name(&self, scope: u32) -> &str;
}

/// Why a scope ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The interrupt of the scope of this level has fired.
    Fired(u16),
    /// The law of the atom, whose scope is of this level, is done, and no interrupt around it has fired.
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

/// A transition of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The state left, in the expanded plan, from 1.
    pub from: u64,
    /// The scope that ended, by its bracket.
    pub scope: u32,
    /// Why it ended.
    pub cause: Cause,
    /// The atom entered, as written, from 0; `None` when the plan is over.
    pub atom: Option<u32>,
    /// The state entered.
    pub to: u64,
}

/// Told of every transition, in order.
pub trait Watch {
    /// A transition was made.
    fn transition(&mut self, transition: Transition);
}

/// What came of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn<U> {
    /// The current atom's law computed this input.
    Law(U),
    /// The limit of transitions cut the search: the null input, and the search goes on in the next turn.
    Cut,
    /// The plan is over: the null input once more, then the robot's stop.
    Over,
}

impl<U: Default> Turn<U> {
    /// The input to send: the law's, or the null input.
    pub fn input(self) -> U {
        match self {
            Self::Law(input) => input,
            Self::Cut | Self::Over => U::default(),
        }
    }
}

/// A plan that runs.
#[derive(Debug)]
pub struct Machine<P: Plan> {
    plan: P,
    cursor: Cursor<P::Entered, P::Left>,
    frame: Frame,
}

impl<P: Plan> Machine<P> {
    /// Begins `plan` at the first output `y` and its time; the turn itself is [`Machine::turn`], with the same two.
    pub fn begin(mut plan: P, y: &P::Output, t: Nanos) -> Self {
        let frame = Frame(y.here());
        let (entered, left) = plan.slots();
        let cursor = Cursor::start(plan.fsm(), entered, left, t);
        plan.enter(0, y, Begin { now: t, frame });
        Self { plan, cursor, frame }
    }

    /// One turn with output `y` at time `t`: transitions until no interrupt around the current atom has fired, then its law.
    pub fn turn(&mut self, y: &P::Output, t: Nanos, watch: &mut impl Watch) -> Turn<P::Input> {
        if self.is_over() {
            return Turn::Over;
        }
        let mut made: u32 = 0;
        while let Some(cause) = self.plan.fired(&self.cursor, y, t) {
            if made == TRANSITIONS_PER_TURN {
                return Turn::Cut;
            }
            made = made.saturating_add(1);
            let transition = self.step(cause, t);
            watch.transition(transition);
            let Some(atom) = transition.atom else { return Turn::Over };
            self.plan.enter(atom, y, Begin { now: t, frame: self.frame });
        }
        Turn::Law(self.plan.input(y, t))
    }

    /// Makes the transition that `cause` asks for.
    fn step(&mut self, cause: Cause, t: Nanos) -> Transition {
        let fsm = self.plan.fsm();
        let from = self.cursor.state(fsm);
        let scope = self.cursor.scope(fsm, cause.level());
        let goes_on = self.cursor.end(fsm, cause.level(), t);
        let atom = goes_on.then_some(self.cursor.atom());
        Transition { from, scope, cause, atom, to: self.cursor.state(fsm) }
    }

    /// Whether the plan is over.
    pub fn is_over(&self) -> bool {
        self.cursor.atom() as usize >= self.plan.fsm().atoms.len()
    }

    /// The number of the current state in the expanded plan; the termination state when the plan is over.
    pub fn state(&self) -> u64 {
        self.cursor.state(self.plan.fsm())
    }

    /// The current atom, as written, from 0; `None` when the plan is over.
    pub fn atom(&self) -> Option<u32> {
        (!self.is_over()).then_some(self.cursor.atom())
    }

    /// The plan, for its texts.
    pub fn plan(&self) -> &P {
        &self.plan
    }
}
