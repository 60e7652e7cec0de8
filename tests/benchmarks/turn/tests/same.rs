//! Tests that all machines with the same number of atoms write the same numbers in every turn; if not, a comparison of
//! them would be meaningless.

use mdle_runtime::{Nanos, Turn};
use mdle_workload::machines::Robot;
use mdle_workload::machines::by_hand::{Match8, NestedMatch8, Table};
use mdle_workload::machines::loaded::{Loaded8, LoadedRising8};
use mdle_workload::machines::plan::{Plan8, Rows8, RowsRising8};
use mdle_workload::machines::smlang::Smlang8;
use mdle_workload::machines::statig::Statig8;
use mdle_workload::{Input, Output};

/// Returns, for each turn, the growth of the measurement, which is less than `leap`, and the switch. Turns with no, one
/// and several transitions occur, and the plan ends both by itself and by the switch.
fn script(leap: u32) -> Vec<(f64, bool)> {
    let mut seed = 1_u32;
    let mut draw = |below: u32| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) % below
    };
    (0..5_000).map(|_| (f64::from(draw(2 * leap)) / 2.0, draw(501) == 0)).collect()
}

/// Returns the result of a machine in each turn. When the plan is over, both the plan and the measurement restart,
/// because mdlec's machines limit the number of transitions in a turn and the other machines do not.
fn turns<M: Robot>(script: &[(f64, bool)]) -> Vec<Turn<Input>> {
    let mut y = Output::default();
    let mut machine = M::begin(&y, Nanos(0));
    let turn = |(t, (growth, halt)): (u64, &(f64, bool))| {
        y = Output { measured: y.measured + growth, halt: *halt };
        let turn = machine.turn(&y, Nanos(t));
        if turn == Turn::Over {
            y = Output::default();
            machine = M::begin(&y, Nanos(t));
        }
        turn
    };
    (0..).zip(script).map(turn).collect()
}

/// Asserts that a machine has the same results as the table, and that these results include all kinds of turns.
fn assert_same<M: Robot, const N: usize>(leap: u32) {
    let script = script(leap);
    let expected = turns::<Table<N>>(&script);
    assert!(expected.contains(&Turn::Over), "it ends");
    assert!(expected.iter().any(|turn| matches!(turn, Turn::Law(input) if input.left > 2.0)), "it goes on");
    assert!(turns::<M>(&script) == expected, "{}", std::any::type_name::<M>());
}

#[test]
fn machines_of_8_atoms_write_the_same() {
    assert_same::<Match8, 8>(2);
    assert_same::<NestedMatch8, 8>(2);
    assert_same::<Plan8, 8>(2);
    assert_same::<Rows8, 8>(2);
    assert_same::<Loaded8, 8>(2);
    assert_same::<Statig8, 8>(2);
    assert_same::<Smlang8, 8>(2);
}

#[test]
fn rows_with_a_memory_write_the_same() {
    let script = script(2);
    assert!(turns::<RowsRising8>(&script) == turns::<LoadedRising8>(&script));
}

#[cfg(feature = "thousands")]
mod thousands {
    use mdle_workload::machines::by_hand::Match1000;
    use mdle_workload::machines::plan::{Plan1000, Plan100000};
    use mdle_workload::machines::smlang::Smlang1000;
    use mdle_workload::machines::statig::Statig1000;

    use super::assert_same;

    #[test]
    fn machines_of_1000_atoms_write_the_same() {
        assert_same::<Match1000, 1_000>(8);
        assert_same::<Plan1000, 1_000>(8);
        assert_same::<Statig1000, 1_000>(8);
        assert_same::<Smlang1000, 1_000>(8);
    }

    #[test]
    fn machines_of_100000_atoms_write_the_same() {
        assert_same::<Plan100000, 100_000>(2_000);
    }
}
