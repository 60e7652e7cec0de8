//! Counts the instructions of 10,000 turns of each machine in each of the three cases. The numbers are equal in every
//! run.

use gungraun::prelude::*;
use gungraun::{Callgrind, EntryPoint};
use mdle_workload::cases::{Case, run};
use mdle_workload::machines::Nothing;
use mdle_workload::machines::by_hand::{Match8, Match1000, NestedMatch8, Table};
use mdle_workload::machines::plan::{Plan8, Plan1000, Plan100000};
use mdle_workload::machines::smlang::{Smlang8, Smlang1000};
use mdle_workload::machines::statig::{Statig8, Statig1000};

/// Number of turns, a whole number of passes through 8 and through 1,000 atoms.
const TURNS: u32 = 10_000;

/// A benchmark for each machine.
macro_rules! machines {
    ($($name:ident: $machine:ty),+ $(,)?) => {
        $(
            #[library_benchmark]
            #[bench::steady(Case::Steady)]
            #[bench::each(Case::Each)]
            #[bench::halt(Case::Halt)]
            fn $name(case: Case) -> f64 {
                run::<$machine>(std::hint::black_box(case), TURNS)
            }
        )+

        library_benchmark_group!(name = turns, benchmarks = [$($name),+]);
        library_benchmark_group!(name = turns_alone, config = turn_alone(), benchmarks = [$($name),+]);
    };
}

machines! {
    nothing: Nothing,
    plan_8: Plan8,
    match_8: Match8,
    nested_match_8: NestedMatch8,
    table_8: Table<8>,
    statig_8: Statig8,
    smlang_8: Smlang8,
    plan_1000: Plan1000,
    match_1000: Match1000,
    table_1000: Table<1_000>,
    statig_1000: Statig1000,
    smlang_1000: Smlang1000,
    plan_100000: Plan100000,
    table_100000: Table<100_000>,
}

/// Returns a configuration that counts the instructions of a machine's turn, without those of the plan's beginning and
/// of the loop that calls the turn.
fn turn_alone() -> LibraryBenchmarkConfig {
    let turn = EntryPoint::Custom("*as mdle_workload::machines::Robot>::turn".to_owned());
    LibraryBenchmarkConfig::default().tool(Callgrind::default().entry_point(turn)).clone()
}

main!(library_benchmark_groups = [turns, turns_alone]);
