//! One turn of a plan: interrupts outermost first, then the law of the current atom (docs/src/reference/semantics.md,
//! 5.1).

use crate::{Begin, Cause, Cursor, Ending, Entries as _, Frame, Measured, Nanos, Output as _, Plan};

/// Maximum number of transitions in one turn; beyond it, the search for the next atom continues in the next
/// turn.
pub const TRANSITIONS_PER_TURN: u32 = 4096;

/// A transition of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// Number of the state that was left, in the expanded plan, counted from 1.
    pub from: u64,
    /// Number of the bracket of the scope that ended.
    pub scope: u32,
    /// Cause of the scope's end.
    pub cause: Cause,
    /// Index of the atom that was entered, in the order of the plan's text; `None` when the plan is over.
    pub atom: Option<u32>,
    /// Number of the state that was entered, in the expanded plan, counted from 1.
    pub to: u64,
}

/// Observer of a running plan. The machine calls the observer for every transition, in order.
pub trait Watch {
    /// `false` if the observer ignores its arguments; the state numbers are then not computed.
    const LOOKS: bool = true;

    /// Reports that the operand with this number has fired in the interrupt that ends a scope. The machine calls this
    /// for each such operand, in order, before [`Watch::transition`].
    fn operand(&mut self, _number: u32, _measured: Measured) {}

    /// Reports a transition, after it is made.
    fn transition(&mut self, transition: Transition);
}

/// An observer that ignores all transitions.
impl Watch for () {
    const LOOKS: bool = false;

    fn transition(&mut self, _: Transition) {}
}

/// Result of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn<U> {
    /// The input that the current atom's law computed.
    Law(U),
    /// The limit of transitions was reached: the null input is sent, and the search continues in the next turn.
    Cut,
    /// The plan is over: the null input is sent once more, then the robot is stopped.
    Over,
}

impl<U: Default> Turn<U> {
    /// Returns the input to send: the input of the law, or the null input.
    pub fn input(self) -> U {
        match self {
            Self::Law(input) => input,
            Self::Cut | Self::Over => U::default(),
        }
    }
}

/// A running plan.
#[derive(Debug)]
pub struct Machine<P: Plan> {
    plan: P,
    cursor: Cursor<P::Entered, P::Left>,
    frame: Frame,
}

impl<P: Plan> Machine<P> {
    /// Begins `plan` with the first output `y`, which was measured at time `t`. The first turn, made by
    /// [`Machine::turn`], has the same output and time.
    pub fn begin(mut plan: P, y: &P::Output, t: Nanos) -> Self {
        let frame = Frame(y.here().theta);
        let (mut entered, left) = plan.slots();
        entered.observe(y, None);
        let cursor = Cursor::start(plan.fsm(), entered, left, t);
        plan.enter(0, y, cursor.begins(Begin { now: t, frame }));
        Self { plan, cursor, frame }
    }

    /// Makes a turn with output `y` at time `t`: transitions until no enclosing interrupt fires, then the current
    /// atom's law.
    pub fn turn<W: Watch>(&mut self, y: &P::Output, t: Nanos, watch: &mut W) -> Turn<P::Input> {
        if self.plan.observes() { self.run::<true, W>(y, t, watch) } else { self.run::<false, W>(y, t, watch) }
    }

    /// Makes a turn. `OBSERVES` is the value of [`Plan::observes`]. If a plan determines this value at run time instead
    /// of at compile time, there are two copies of this loop, and the copy for plans that do not observe has no further
    /// checks.
    fn run<const OBSERVES: bool, W: Watch>(&mut self, y: &P::Output, t: Nanos, watch: &mut W) -> Turn<P::Input> {
        if OBSERVES {
            self.cursor.observe(y, self.plan.stalled(y, t));
        }
        let mut transitions: u32 = 0;
        let mut is_over = self.is_over();
        while !is_over {
            match self.plan.next(&self.cursor, y, t) {
                Some(ending) if transitions < TRANSITIONS_PER_TURN => {
                    is_over = self.step::<OBSERVES, W>(ending, y, t, watch);
                    transitions = transitions.saturating_add(1);
                }
                Some(_) => {
                    if OBSERVES {
                        self.plan.settle(&self.cursor, y, t);
                    }
                    return Turn::Cut;
                }
                None => {
                    if OBSERVES {
                        self.plan.settle(&self.cursor, y, t);
                    }
                    return Turn::Law(self.plan.input(y, t));
                }
            }
        }
        Turn::Over
    }

    /// Leaves the scope that ends, and enters the atom that follows. Returns `true` if no atom follows; the plan is
    /// then over.
    ///
    /// The function is inlined: a plan whose generated code contains the successor then enters it without a table
    /// lookup.
    #[inline(always)]
    fn step<const OBSERVES: bool, W: Watch>(&mut self, ending: Ending, y: &P::Output, t: Nanos, watch: &mut W) -> bool {
        let looked = W::LOOKS.then(|| self.look(ending.cause, y, t, watch));
        if OBSERVES {
            self.plan.leave(&self.cursor, ending.cause, y, t);
        }
        match ending.follows {
            Some(follows) => self.cursor.follow(follows, t),
            None => {
                self.cursor.end(self.plan.fsm(), ending.cause.level(), t);
            }
        }
        if let Some((from, scope)) = looked {
            let to = self.cursor.state(self.plan.fsm());
            watch.transition(Transition { from, scope, cause: ending.cause, atom: self.atom(), to });
        }
        let is_over = self.is_over();
        if !is_over {
            self.plan.enter(self.cursor.atom(), y, self.cursor.begins(Begin { now: t, frame: self.frame }));
        }
        is_over
    }

    /// Passes the operands that have fired to `watch`. Returns the numbers of the state and the scope that are about to
    /// be left.
    fn look<W: Watch>(&self, cause: Cause, y: &P::Output, t: Nanos, watch: &mut W) -> (u64, u32) {
        let fsm = self.plan.fsm();
        let scope = self.cursor.scope(fsm, cause.level());
        match cause {
            Cause::Fired(_) => {
                self.plan.operands(&self.cursor, scope, y, t, &mut |number, measured| watch.operand(number, measured));
            }
            Cause::Completed(_) => {}
        }
        (self.cursor.state(fsm), scope)
    }

    /// Records the output at which the plan is suspended: the output that followed its last input.
    pub fn suspend(&mut self, y: &P::Output) {
        self.cursor.observe(y, None);
    }

    /// Creates the law of the current atom again, for a plan that resumes after another plan has driven the robot. The
    /// path driven since [`Machine::suspend`] does not count.
    pub fn reenter(&mut self, y: &P::Output, t: Nanos) {
        self.cursor.resume(y);
        if !self.is_over() {
            self.plan.enter(self.cursor.atom(), y, self.cursor.begins(Begin { now: t, frame: self.frame }));
        }
    }

    /// Returns `true` if the plan is over.
    pub fn is_over(&self) -> bool {
        self.cursor.atom() as usize >= self.plan.fsm().atoms.len()
    }

    /// Returns the number of the current state in the expanded plan; the termination state when the plan is
    /// over.
    pub fn state(&self) -> u64 {
        self.cursor.state(self.plan.fsm())
    }

    /// Returns the index of the current atom in the order of the plan's text; `None` when the plan is over.
    pub fn atom(&self) -> Option<u32> {
        (!self.is_over()).then_some(self.cursor.atom())
    }

    /// Returns the frame of the current atom if a `FRAME here` encloses it; `None` for an atom in the plan's frame.
    pub fn frame(&self) -> Option<Frame> {
        self.cursor.frame()
    }

    /// Returns the position in the plan.
    pub fn cursor(&self) -> &Cursor<P::Entered, P::Left> {
        &self.cursor
    }

    /// Returns the plan, for example to read its texts.
    pub fn plan(&self) -> &P {
        &self.plan
    }
}
