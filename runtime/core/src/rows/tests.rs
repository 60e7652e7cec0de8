//! Tests conditions in table rows, and the memory of a table-driven plan.

use std::vec::Vec;

use super::{ConditionValues, InRows};
use crate::fsm::{Atom, Bracket};
use crate::{
    Alphabet, Argument, Begin, Cause, Comparison, Completes, Condition, Control, Cursor, Examined, Fact, Follows,
    Frame, Fsm, Guard, Interrupt, Law, LawRow, Limit, MarkRow, Measured, Memories, Memory, Nanometers, Nanos, NoSignal,
    Output, Plan, Radians, Rows, Texts,
};

/// Numbers of the interrupts that fire.
struct Sensed(&'static [u8]);

impl Output for Sensed {}

struct Fires(u8);

impl Interrupt<Sensed> for Fires {
    fn fired(&self, y: &Sensed) -> bool {
        y.0.contains(&self.0)
    }
}

/// Law whose input is the heading of the frame in which the law began. The law is done when the output contains
/// 99.
#[derive(Default)]
struct Points(f64);

impl Control<Sensed> for Points {
    type Law = Points;

    fn begin(&self, _: &Sensed, begin: Begin) -> Points {
        Points(begin.frame.0.0)
    }
}

impl Law<Sensed> for Points {
    type Input = f64;

    fn input(&mut self, _: &Sensed, _: Nanos) -> f64 {
        self.0
    }
}

impl Completes<Sensed> for Points {
    fn completed(&self, y: &Sensed, _: Nanos) -> bool {
        y.0.contains(&99)
    }
}

struct Toy;

impl Alphabet for Toy {
    type Output = Sensed;
    type Input = f64;
    type Interrupt = Fires;
    type Signal = NoSignal;
    type Control = Points;
    type Law = Points;

    const NAME: &'static str = "toy";
    const HASH: u64 = 0;
    const CAPABILITIES: &'static [&'static str] = &[];
    const LIMITS: &'static [Limit] = &[];

    fn interrupt(_: &str, _: &[Argument<'_>]) -> Option<Fires> {
        None
    }

    fn signal(_: &str, _: &[Argument<'_>]) -> Option<NoSignal> {
        None
    }

    fn comparison(_: Comparison<NoSignal, NoSignal>) -> Option<Fires> {
        None
    }

    fn control(_: &str, _: &[Argument<'_>]) -> Option<Points> {
        None
    }
}

/// Returns the values that a condition with these operands reads three nanoseconds after its scope was entered.
fn at<'r, M>(operands: &'r [Condition<Fires>], y: &'r Sensed, memory: &'r M) -> ConditionValues<'r, Fires, Sensed, M> {
    ConditionValues { stalled: None, y, since: Nanos(3), level: 0, way: Nanometers(5), operands, memory }
}

#[test]
fn a_condition_that_is_its_own_operand_holds_nobody_up() {
    let nothing = Sensed(&[]);
    for operand in [Condition::Not(0), Condition::Or(0, 1), Condition::And(0, 1), Condition::Rising(0, 0)] {
        let operands: [Condition<Fires>; 1] = [operand];
        let or = Condition::Or(0, 1);
        // An operand that refers to itself or to an earlier operand is ignored, as if it had not fired.
        assert_eq!(or.fired(&at(&operands, &nothing, &()), 0), matches!(operands[0], Condition::Not(_)));
        assert_eq!(or.cause(&at(&operands, &nothing, &())), 0);
        let mut memories = Vec::new();
        or.low(&at(&operands, &nothing, &()), 0, &mut |memory| memories.push(memory));
        assert_eq!(memories, []);
    }
    let (always, operands) = (Sensed(&[0]), [Condition::Quark(Fires(0))]);
    assert!(Condition::Or(0, 1).fired(&at(&operands, &always, &()), 0));
    assert!(!Condition::Or(0, 1).fired(&at(&operands, &always, &()), 1));
    let operands = [Condition::Not(0), Condition::Quark(Fires(0))];
    assert_eq!(Condition::Or(0, 2).cause(&at(&operands, &always, &())), 0, "the NOT of what is not there has fired");
}

#[test]
fn operators_are_those_of_logic() {
    let operands = [Condition::Quark(Fires(0)), Condition::Quark(Fires(1))];
    let fired = |condition: Condition<Fires>| {
        let numbers: [&'static [u8]; 4] = [&[], &[0], &[1], &[0, 1]];
        numbers.map(|numbers| condition.fired(&at(&operands, &Sensed(numbers), &()), 0))
    };
    assert_eq!(fired(Condition::Null), [false; 4]);
    assert_eq!(fired(Condition::Or(0, 2)), [false, true, true, true]);
    assert_eq!(fired(Condition::And(0, 2)), [false, false, false, true]);
    assert_eq!(fired(Condition::Not(1)), [true, true, false, false]);
}

#[test]
fn an_operand_may_stand_right_behind_what_it_belongs_to() {
    let operands = [Condition::Not(1), Condition::Quark(Fires(0))];
    assert!(Condition::Not(0).fired(&at(&operands, &Sensed(&[0]), &()), 0));
    assert!(!Condition::Not(0).fired(&at(&operands, &Sensed(&[]), &()), 0));
    let operands = [Condition::Quark(Fires(0)), Condition::Not(2), Condition::Quark(Fires(1))];
    let cause = |y: Sensed| Condition::Or(0, 2).cause(&at(&operands, &y, &()));
    assert_eq!([cause(Sensed(&[])), cause(Sensed(&[1]))], [1, 0]);
}

#[test]
fn times_fire_from_their_first_moment_until_before_their_last() {
    let fired = |condition: Condition<Fires>| condition.fired(&at(&[], &Sensed(&[]), &()), 0);
    assert_eq!([2, 3, 4].map(|time| fired(Condition::Wait(Nanos(time)))), [true, true, false]);
    assert_eq!(
        [(2, 3), (2, 4), (3, 4), (4, 5)].map(|(from, until)| fired(Condition::Elapsed(Nanos(from), Nanos(until)))),
        [false, true, true, false]
    );
}

#[test]
fn rising_fires_if_its_operand_does_and_once_did_not() {
    let operands = [Condition::Quark(Fires(0))];
    let fired = |y: &Sensed, was_low: bool| {
        let mut memories = Memories::new(2, [false; 2]);
        memories.set(0, 1, was_low);
        Condition::Rising(1, 0).fired(&at(&operands, y, &memories), 0)
    };
    let (high, low) = (Sensed(&[0]), Sensed(&[]));
    assert_eq!(
        [fired(&high, true), fired(&high, false), fired(&low, true), fired(&low, false)],
        [true, false, false, false]
    );
    assert!(!Condition::Rising(1, 0).fired(&at(&operands, &high, &()), 0), "where nothing is remembered");
}

#[test]
fn the_cause_is_the_first_operand_of_an_or_that_has_fired() {
    let operands = [0, 1, 2, 3].map(|number| Condition::Quark(Fires(number)));
    let cause =
        |condition: Condition<Fires>, y: &[&'static [u8]; 1]| condition.cause(&at(&operands, &Sensed(y[0]), &()));
    assert_eq!(cause(Condition::Or(1, 3), &[&[2, 3]]), 1);
    assert_eq!(cause(Condition::Or(1, 3), &[&[0, 1]]), 0);
    assert_eq!(cause(Condition::Or(0, 1), &[&[1]]), 0, "it is not one of them");
    assert_eq!(cause(Condition::Or(0, 1), &[&[]]), 0);
    assert_eq!(cause(Condition::And(1, 2), &[&[1, 2]]), 0);
}

#[test]
fn fired_operands_have_their_values() {
    let operands = [
        Condition::And(2, 2),
        Condition::Wait(Nanos(3)),
        Condition::Not(4),
        Condition::Elapsed(Nanos(0), Nanos(9)),
        Condition::Quark(Fires(0)),
    ];
    let fired = |numbers: &'static [u8]| {
        let mut values = Vec::new();
        let sensed = Sensed(numbers);
        let tell = &mut |number, measured| values.push((number, measured));
        Condition::Or(0, 2).tell_fired(&at(&operands, &sensed, &()), tell);
        values
    };
    let since = Measured::Elapsed(Nanos(3));
    assert_eq!(fired(&[]), [(0, Measured::Nothing), (1, since), (2, since)]);
    assert_eq!(fired(&[0]), [(1, since), (2, since)]);
}

#[test]
fn each_low_rising_is_noted_once() {
    let operands = [
        Condition::Rising(0, 2),
        Condition::Not(3),
        Condition::Rising(1, 4),
        Condition::Or(5, 2),
        Condition::Quark(Fires(9)),
        Condition::Rising(2, 7),
        Condition::Rising(3, 8),
        Condition::Quark(Fires(0)),
        Condition::Rising(4, 9),
        Condition::Quark(Fires(9)),
        // Not part of any condition.
        Condition::Rising(5, 11),
        Condition::Quark(Fires(9)),
    ];
    let mut memories = Vec::new();
    Condition::And(0, 2).low(&at(&operands, &Sensed(&[0]), &()), 0, &mut |memory| memories.push(memory));
    assert_eq!(memories, [0, 1, 3, 4], "the operand of 2 has fired");
}

/// `{ P { Q (Atom) } (Atom) }` with all conditions given, and with labels for the elements that end with the
/// first atom and with `Q`.
struct Remembering {
    guards: [Guard<Fires>; 4],
    operands: Vec<Condition<Fires>>,
}

const BRACKETS: [Bracket; 4] =
    [Bracket::scope(0, 0, 1, 0), Bracket::scope(1, 0, 0, 0), Bracket::scope(2, 0, 0, 1), Bracket::scope(1, 1, 1, 0)];
const ATOMS: [Atom; 2] = [Atom::new(2, 1), Atom::new(3, 2)];
const MARKS: [MarkRow; 2] = [
    MarkRow { bracket: 1, level: 0, first: 3, count: 1, first_fact: 0, facts: 1 },
    MarkRow { bracket: 2, level: 0, first: 1, count: 2, first_fact: 1, facts: 2 },
];
const FACTS: [Fact; 3] =
    [Fact { memory: 3, operand: Some(0) }, Fact { memory: 1, operand: None }, Fact { memory: 2, operand: Some(1) }];
const WIDTH: usize = 5;
const LEVELS: usize = 3;
type Set = [bool; WIDTH * LEVELS];
type Remembers<'r> = InRows<&'r Rows<'r, Toy>, [Nanos; LEVELS], [u64; 0], Memories<Set>>;
type At = Cursor<[Nanos; LEVELS], [u64; 0]>;
const BEGIN: Begin = Begin { now: Nanos::ZERO, frame: Frame(Radians(0.25)) };

impl Remembering {
    fn new(plan: Condition<Fires>, atom: Condition<Fires>, operands: impl Into<Vec<Condition<Fires>>>) -> Self {
        let guard = |condition, level, around, follows| Guard { condition, level, around, follows };
        let behind = Some(Follows::new(1, 1, 2));
        let guards = [
            guard(plan, 0, 0, None),
            guard(Condition::Null, 1, 0, behind),
            guard(atom, 2, 0, behind),
            guard(Condition::Null, 1, 0, None),
        ];
        Self { guards, operands: operands.into() }
    }

    /// Calls `act` on a plan whose memories are set as in `before`; returns the result and, for each level, the
    /// memories that are then set.
    fn after<R>(&self, before: Set, act: impl FnOnce(&mut Remembers<'_>, &mut At) -> R) -> (R, Vec<usize>) {
        let laws = [0.0, 1.0].map(|angle| LawRow { control: Points::default(), frame: Radians(angle) });
        let fsm = Fsm { brackets: &BRACKETS, atoms: &ATOMS, termination: 3 };
        let (guards, operands) = (&self.guards, &self.operands);
        let rows: Rows<'_, Toy> =
            Rows { fsm, guards, operands, laws: &laws, marks: &MARKS, facts: &FACTS, texts: Texts::NONE };
        let slots = ([Nanos::ZERO; LEVELS], []);
        let memories = Memories::new(WIDTH as u32, before);
        let mut plan = InRows::remembering(&rows, slots.0, slots.1, memories);
        let mut cursor = Cursor::start(fsm, slots.0, slots.1, Nanos::ZERO);
        plan.enter(0, &Sensed(&[]), BEGIN);
        let result = act(&mut plan, &mut cursor);
        let is_set = |place: &usize| plan.memory.is_set((place / WIDTH) as u16, (place % WIDTH) as u32);
        (result, (0..WIDTH * LEVELS).filter(is_set).collect())
    }
}

#[test]
fn a_turn_sets_the_memory_of_every_rising_around_its_atom_that_is_low() {
    let low = |y: Sensed| {
        let operands = [
            Condition::Rising(1, 2),
            Condition::Rising(0, 3),
            Condition::Quark(Fires(0)),
            Condition::Quark(Fires(1)),
            Condition::Quark(Fires(2)),
        ];
        let plan = Remembering::new(Condition::And(0, 2), Condition::Rising(2, 4), operands);
        let settle = |plan: &mut Remembers<'_>, cursor: &mut At| plan.settle(cursor, &y, Nanos::ZERO);
        plan.after([false; WIDTH * LEVELS], settle).1
    };
    let of_atom = 2 * WIDTH + 2;
    assert_eq!(low(Sensed(&[])), [0, 1, of_atom]);
    assert_eq!(low(Sensed(&[1])), [1, of_atom]);
    assert_eq!(low(Sensed(&[0, 2])), [0]);
}

/// Returns a plan whose first atom ends when either of two conditions fires.
fn ends_by_either() -> Remembering {
    let operands = [Condition::Quark(Fires(0)), Condition::Quark(Fires(1))];
    Remembering::new(Condition::Null, Condition::Or(0, 2), operands)
}

#[test]
fn what_ends_is_written_down_with_its_cause_and_what_was_inside_is_forgotten() {
    let memories = |cause: Cause, y: Sensed| {
        let leave = |plan: &mut Remembers<'_>, cursor: &mut At| plan.leave(cursor, cause, &y, Nanos::ZERO);
        ends_by_either().after([true; WIDTH * LEVELS], leave).1
    };
    // Memories 0 and 4 belong to no label. `Q` ends as well, but not by its own condition.
    assert_eq!(memories(Cause::Fired(2), Sensed(&[1])), [0, 1, 2, 4]);
    assert_eq!(memories(Cause::Fired(2), Sensed(&[0, 1])), [0, 1, 4]);
    assert_eq!(memories(Cause::Completed(2), Sensed(&[1])), [0, 1, 4]);
}

#[test]
fn a_scope_ends_at_the_moment_for_which_it_waits() {
    for (condition, from) in [(Condition::Wait(Nanos(3)), 3), (Condition::Elapsed(Nanos(2), Nanos(9)), 2)] {
        let plan = Remembering::new(condition, Condition::Null, []);
        let ends = (0..6).map(|now| {
            let next = |plan: &mut Remembers<'_>, cursor: &mut At| plan.next(cursor, &Sensed(&[]), Nanos(now));
            plan.after([false; WIDTH * LEVELS], next).0.is_some()
        });
        assert_eq!(ends.collect::<Vec<_>>(), (0..6).map(|now| now >= from).collect::<Vec<_>>());
    }
}

#[test]
fn a_law_begins_with_its_atom_in_its_frame() {
    let inputs = |plan: &mut Remembers<'_>, _: &mut At| {
        let y = Sensed(&[]);
        [0, 1, 0].map(|atom| {
            plan.enter(atom, &y, BEGIN);
            plan.input(&y, Nanos::ZERO)
        })
    };
    assert_eq!(ends_by_either().after([false; WIDTH * LEVELS], inputs).0, [0.25, 1.25, 0.25]);
    let none = |plan: &mut Remembers<'_>, cursor: &mut At| {
        let y = Sensed(&[]);
        plan.enter(9, &y, BEGIN);
        (plan.own, plan.input(&y, Nanos::ZERO), plan.next(cursor, &y, Nanos::ZERO))
    };
    let none = ends_by_either().after([false; WIDTH * LEVELS], none).0;
    assert_eq!(none, (0, 0.0, None), "there is no such atom, and it is never done");
}

#[test]
fn an_atom_ends_when_its_law_is_done_and_not_before() {
    let next = |y: Sensed| {
        let next = |plan: &mut Remembers<'_>, cursor: &mut At| plan.next(cursor, &y, Nanos::ZERO);
        ends_by_either().after([false; WIDTH * LEVELS], next).0
    };
    assert_eq!(next(Sensed(&[])), None);
    assert!(matches!(next(Sensed(&[99])), Some(ending) if ending.cause == Cause::Completed(2)));
    assert!(matches!(next(Sensed(&[1, 99])), Some(ending) if ending.cause == Cause::Fired(2)));
}

#[test]
fn the_first_operand_of_all_can_end_a_scope() {
    let y = Sensed(&[0]);
    let next = |plan: &mut Remembers<'_>, cursor: &mut At| plan.next(cursor, &y, Nanos::ZERO);
    let (next, _) = ends_by_either().after([false; WIDTH * LEVELS], next);
    assert!(matches!(next, Some(ending) if ending.cause == Cause::Fired(2)), "{next:?}");
}

#[test]
fn every_part_of_a_condition_is_examined_in_order() {
    let operands = [
        Condition::And(2, 2),
        Condition::Wait(Nanos(3)),
        Condition::Not(4),
        Condition::Rising(0, 5),
        Condition::Quark(Fires(0)),
        Condition::Elapsed(Nanos(9), Nanos(12)),
    ];
    let examined = |numbers: &'static [u8]| {
        let mut fired = Vec::new();
        let tell = &mut |part: Examined| fired.push(part.fired);
        Condition::Or(0, 2).examine(&at(&operands, &Sensed(numbers), &()), 0, tell);
        fired
    };
    // In order: OR, AND, NOT and its quark, RISING and its time, and the timer.
    assert_eq!(examined(&[]), [true, false, true, false, false, false, true]);
    assert_eq!(examined(&[0]), [true, false, false, true, false, false, true]);
    let itself: [Condition<Fires>; 1] = [Condition::Or(0, 1)];
    let mut count = 0;
    Condition::Or(0, 1).examine(&at(&itself, &Sensed(&[]), &()), 0, &mut |_| count += 1);
    assert_eq!(count, 2);
}
