//! Measures the time per turn of each machine in each of the three cases.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mdle_workload::cases::{Case, run};
use mdle_workload::machines::by_hand::{Match8, Match1000, NestedMatch8, Table};
use mdle_workload::machines::plan::{Plan8, Plan1000, Plan100000};
use mdle_workload::machines::smlang::{Smlang8, Smlang1000};
use mdle_workload::machines::statig::{Statig8, Statig1000};
use mdle_workload::machines::{Nothing, Robot};

/// Number of turns, a whole number of passes through 8 and through 1,000 atoms.
const TURNS: u32 = 10_000;

fn measure<M: Robot>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group("turn");
    group.sample_size(20).throughput(Throughput::Elements(u64::from(TURNS)));
    for case in Case::ALL {
        group.bench_function(BenchmarkId::new(name, format!("{case:?}")), |bencher| {
            bencher.iter(|| run::<M>(black_box(case), TURNS));
        });
    }
    group.finish();
}

fn turn(criterion: &mut Criterion) {
    measure::<Nothing>(criterion, "nothing");
    measure::<Plan8>(criterion, "plan_8");
    measure::<Match8>(criterion, "match_8");
    measure::<NestedMatch8>(criterion, "nested_match_8");
    measure::<Table<8>>(criterion, "table_8");
    measure::<Statig8>(criterion, "statig_8");
    measure::<Smlang8>(criterion, "smlang_8");
    measure::<Plan1000>(criterion, "plan_1000");
    measure::<Match1000>(criterion, "match_1000");
    measure::<Table<1_000>>(criterion, "table_1000");
    measure::<Statig1000>(criterion, "statig_1000");
    measure::<Smlang1000>(criterion, "smlang_1000");
    measure::<Plan100000>(criterion, "plan_100000");
    measure::<Table<100_000>>(criterion, "table_100000");
}

criterion_group!(benches, turn);
criterion_main!(benches);
