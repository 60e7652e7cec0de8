//! Tests the result of a turn (docs/src/reference/semantics.md, 5).

use std::vec::Vec;

use crate::fsm::{Atom, Bracket, Kind};
use crate::{
    Begin, Cause, Cursor, Ending, Follows, Fsm, Machine, Nanos, Output, Plan, TRANSITIONS_PER_TURN, Transition, Turn,
    Watch,
};

/// An output: the brackets whose interrupts have fired, and `true` if the current law is done.
struct Sensed(&'static [u32], bool);

impl Output for Sensed {}

/// A handwritten plan. The input of atom `a`, numbered as written from 0, is `a + 1`.
struct Toy {
    brackets: Vec<Bracket>,
    atoms: Vec<Atom>,
    termination: u64,
    /// Numbers of the atoms entered, in order.
    entered: Vec<u32>,
    /// Number of inputs computed.
    computed: u32,
    /// `true` if the plan uses the successors that [`Fsm::follows`] computes in advance.
    foresees: bool,
}

/// Bracket of the plan in [`Toy::nested`].
const PLAN: u32 = 0;
const SCOPE: u32 = 1;
const FIRST: u32 = 2;
const SECOND: u32 = 3;
const LAST: u32 = 4;

impl Toy {
    /// Returns `{ Plan { Scope (Atom first) (Atom second) } (Atom last) }`.
    fn nested() -> Self {
        Self::new(
            [
                Bracket::scope(0, 0, 2, 0),
                Bracket::scope(1, 0, 1, 0),
                Bracket::scope(2, 0, 0, 1),
                Bracket::scope(2, 1, 1, 1),
                Bracket::scope(1, 2, 2, 0),
            ],
            [Atom::new(FIRST, 1), Atom::new(SECOND, 2), Atom::new(LAST, 3)],
            4,
        )
    }

    /// Returns `{ Plan ((Atom first))^times (Atom last) }`, where bracket 2 is the scope of the first atom; 0 times
    /// means a loop without end.
    fn repeated(times: u64) -> Self {
        Self::new(
            [
                Bracket::scope(0, 0, 1, 0),
                Bracket::repeat(times, 0, u64::from(times > 0), 0, 0, 0),
                Bracket::scope(1, 0, 0, 1),
                Bracket::scope(1, 1, 1, 0),
            ],
            [Atom::new(FIRST, 1), Atom::new(3, times.max(1) + 1)],
            times.max(1) + 2,
        )
    }

    fn new(brackets: impl Into<Vec<Bracket>>, atoms: impl Into<Vec<Atom>>, termination: u64) -> Self {
        Self {
            brackets: brackets.into(),
            atoms: atoms.into(),
            termination,
            entered: Vec::new(),
            computed: 0,
            foresees: true,
        }
    }
}

impl Plan for Toy {
    type Output = Sensed;
    type Input = u32;
    type Entered = [Nanos; 3];
    type Left = [u64; 1];

    fn fsm(&self) -> Fsm<'_> {
        Fsm { brackets: &self.brackets, atoms: &self.atoms, termination: self.termination }
    }

    fn slots(&self) -> ([Nanos; 3], [u64; 1]) {
        ([Nanos::ZERO; 3], [0])
    }

    fn enter(&mut self, atom: u32, _: &Sensed, _: Begin) {
        self.entered.push(atom);
    }

    fn next(&self, cursor: &Cursor<[Nanos; 3], [u64; 1]>, y: &Sensed, _: Nanos) -> Option<Ending> {
        let own = self.atoms[cursor.atom() as usize].scope;
        let Kind::Scope { level: own } = self.brackets[own as usize].kind else { panic!("an atom's own scope") };
        let outermost = (0..=own).find(|level| y.0.contains(&cursor.scope(self.fsm(), *level)));
        let cause = outermost.map(Cause::Fired).or(y.1.then_some(Cause::Completed(own)))?;
        let follows = self.fsm().follows(cursor.scope(self.fsm(), cause.level())).filter(|_| self.foresees);
        Some(Ending { cause, follows })
    }

    fn input(&mut self, _: &Sensed, _: Nanos) -> u32 {
        self.computed += 1;
        self.entered[self.entered.len() - 1] + 1
    }

    fn law(&self, _: u32) -> &str {
        "law"
    }

    fn condition(&self, _: u32) -> &str {
        "condition"
    }

    fn name(&self, _: u32) -> &str {
        ""
    }
}

#[derive(Default)]
struct Watched(Vec<Transition>);

impl Watch for Watched {
    fn transition(&mut self, transition: Transition) {
        self.0.push(transition);
    }
}

const QUIET: Sensed = Sensed(&[], false);

fn begin(plan: Toy) -> Machine<Toy> {
    Machine::begin(plan, &QUIET, Nanos::ZERO)
}

/// Makes one turn; returns its result and its transitions.
fn turn(machine: &mut Machine<Toy>, y: Sensed) -> (Turn<u32>, Vec<Transition>) {
    let mut watched = Watched::default();
    (machine.turn(&y, Nanos::ZERO, &mut watched), watched.0)
}

#[test]
fn a_turn_in_which_nothing_fires_computes_the_law() {
    let mut machine = begin(Toy::nested());
    assert_eq!(turn(&mut machine, QUIET), (Turn::Law(1), Vec::new()));
    assert_eq!((machine.state(), machine.atom(), machine.is_over()), (1, Some(0), false));
}

#[test]
fn the_outermost_interrupt_wins() {
    let mut machine = begin(Toy::nested());
    let transition = Transition { from: 1, scope: SCOPE, cause: Cause::Fired(1), atom: Some(2), to: 3 };
    assert_eq!(turn(&mut machine, Sensed(&[FIRST, SCOPE], true)).1[0], transition);
    let mut machine = begin(Toy::nested());
    let over = Transition { from: 1, scope: PLAN, cause: Cause::Fired(0), atom: None, to: 4 };
    assert_eq!(turn(&mut machine, Sensed(&[FIRST, SCOPE, PLAN], true)), (Turn::Over, std::vec![over]));
}

#[test]
fn an_interrupt_is_named_where_the_law_is_done_as_well() {
    let plan = Toy::nested();
    let cause = |y| {
        let transition = turn(&mut begin(Toy::nested()), y).1[0];
        (transition.cause, transition.by(&plan))
    };
    assert_eq!(cause(Sensed(&[FIRST], true)), (Cause::Fired(2), "condition"));
    assert_eq!(cause(Sensed(&[LAST], true)), (Cause::Completed(2), "completed"));
}

#[test]
fn an_atom_whose_interrupt_has_fired_is_entered_and_never_computed() {
    let mut machine = begin(Toy::nested());
    let (result, transitions) = turn(&mut machine, Sensed(&[FIRST, SECOND], false));
    assert_eq!((result, transitions.len()), (Turn::Law(3), 2));
    assert_eq!((&*machine.plan().entered, machine.plan().computed), (&[0, 1, 2][..], 1));
}

#[test]
fn a_plan_that_is_over_stays_over() {
    let mut machine = begin(Toy::nested());
    assert_eq!(turn(&mut machine, Sensed(&[PLAN], false)).0, Turn::Over);
    assert_eq!(turn(&mut machine, QUIET), (Turn::Over, Vec::new()));
    assert_eq!((machine.state(), machine.atom(), machine.is_over()), (4, None, true));
    assert_eq!(machine.plan().entered, [0], "nothing is entered at the end");
    assert_eq!(Turn::<u32>::Over.input(), 0, "the null input");
}

#[test]
fn a_plan_that_nobody_watches_is_over_as_well() {
    for foresees in [true, false] {
        let mut machine = begin(Toy { foresees, ..Toy::nested() });
        assert_eq!(machine.turn(&Sensed(&[PLAN], false), Nanos::ZERO, &mut ()), Turn::Over);
        assert_eq!((machine.state(), machine.atom(), machine.is_over()), (4, None, true));
    }
}

#[test]
fn as_many_transitions_as_the_limit_are_no_cut() {
    let mut machine = begin(Toy::repeated(u64::from(TRANSITIONS_PER_TURN)));
    let (result, transitions) = turn(&mut machine, Sensed(&[FIRST], false));
    assert_eq!((result, transitions.len()), (Turn::Law(2), 4096));
}

#[test]
fn the_search_goes_on_in_the_turn_after_a_cut() {
    let mut machine = begin(Toy::repeated(u64::from(TRANSITIONS_PER_TURN) + 1));
    let (result, transitions) = turn(&mut machine, Sensed(&[FIRST], false));
    assert_eq!((result, transitions.len(), machine.state()), (Turn::Cut, 4096, 4097));
    assert_eq!((result.input(), machine.plan().computed), (0, 0), "the null input");
    let (result, transitions) = turn(&mut machine, Sensed(&[FIRST], false));
    assert_eq!((result, transitions.len(), machine.state()), (Turn::Law(2), 1, 4098));
}

#[test]
fn a_loop_without_end_is_cut_in_every_turn() {
    let mut machine = begin(Toy::repeated(0));
    for _ in 0..3 {
        let (result, transitions) = turn(&mut machine, Sensed(&[FIRST], false));
        assert_eq!((result, transitions.len(), machine.state()), (Turn::Cut, 4096, 1));
    }
}

#[test]
fn who_watches_and_what_is_foreseen_changes_nothing() {
    const SCRIPT: [Sensed; 6] = [
        QUIET,
        Sensed(&[FIRST], false),
        Sensed(&[SECOND, LAST], true),
        Sensed(&[FIRST, SECOND], false),
        Sensed(&[SCOPE], false),
        Sensed(&[PLAN], false),
    ];
    let plans = [Toy::nested as fn() -> Toy, || Toy::repeated(4095), || Toy::repeated(4096), || Toy::repeated(4097)];
    for (plan, foresees) in plans.into_iter().flat_map(|plan| [(plan, false), (plan, true)]) {
        let begin = |foresees| begin(Toy { foresees, ..plan() });
        let (mut watched, mut unwatched) = (begin(false), begin(foresees));
        for y in SCRIPT {
            let result = watched.turn(&y, Nanos(1), &mut Watched::default());
            assert_eq!(unwatched.turn(&y, Nanos(1), &mut ()), result);
            assert_eq!(unwatched.cursor(), watched.cursor());
        }
        assert_eq!(unwatched.plan().entered, watched.plan().entered);
    }
}

#[test]
fn what_follows_is_known_where_no_loop_has_a_say() {
    let plan = Toy::nested();
    let follows = [PLAN, SCOPE, FIRST, SECOND, LAST].map(|scope| plan.fsm().follows(scope).unwrap());
    let expected = [(3, 0, 0), (2, 1, 2), (1, 2, 3), (2, 1, 2), (3, 0, 0)];
    assert_eq!(follows, expected.map(|(atom, from, to)| Follows::new(atom, from, to)));
    let plan = Toy::repeated(2);
    assert_eq!(
        [0, 2, 3].map(|scope| plan.fsm().follows(scope)),
        [Some(Follows::new(2, 0, 0)), None, Some(Follows::new(2, 0, 0))]
    );
}

#[test]
fn a_way_without_loops_is_cut_as_well() {
    const ATOMS: u32 = 5000;
    let long = || {
        let plan = [Bracket::scope(0, 0, ATOMS - 1, 0)];
        let brackets: Vec<_> =
            plan.into_iter().chain((0..ATOMS).map(|atom| Bracket::scope(1, atom, atom, 0))).collect();
        let atoms: Vec<_> = (1..=ATOMS).map(|atom| Atom::new(atom, u64::from(atom))).collect();
        begin(Toy::new(brackets, atoms, u64::from(ATOMS) + 1))
    };
    let every_atom = Sensed((1..=ATOMS).collect::<Vec<_>>().leak(), false);
    let (mut watched, mut unwatched) = (long(), long());
    for (outcome, state) in [(Turn::Cut, 4097), (Turn::Over, 5001)] {
        assert_eq!(unwatched.turn(&every_atom, Nanos::ZERO, &mut ()), outcome);
        assert_eq!(watched.turn(&every_atom, Nanos::ZERO, &mut Watched::default()), outcome);
        assert_eq!((unwatched.state(), watched.state()), (state, state));
    }
}
