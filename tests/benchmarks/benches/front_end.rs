//! Text to tree, in bytes a second: mdlec's front end beside the bare parser of the same grammar.
//!
//! A tree is taken down outside of the measured time, for it is what a caller wants to have.

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mdle_benchmarks::bare;
use mdle_benchmarks::front_end::{one_megabyte, plans, ten_megabytes};
use mdlec::diagnostic::SourceId;
use mdlec::syntax::parse;

fn front_end(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("front_end");
    group.sample_size(20);
    for (name, texts) in [plans(), one_megabyte(), ten_megabytes()] {
        assert!(texts.iter().all(|text| bare::accepts(text) && parse(SourceId(0), text).1.is_empty()), "{name}");
        group.throughput(Throughput::BytesDecimal(texts.iter().map(|text| text.len() as u64).sum()));
        group.bench_function(BenchmarkId::new("bare", name), |bencher| {
            bencher.iter(|| texts.iter().all(|text| bare::accepts(black_box(text))));
        });
        group.bench_function(BenchmarkId::new("mdlec", name), |bencher| {
            let read = |()| texts.iter().map(|text| parse(SourceId(0), black_box(text))).collect::<Vec<_>>();
            bencher.iter_batched(|| (), read, BatchSize::PerIteration);
        });
    }
    group.finish();
}

criterion_group!(benches, front_end);
criterion_main!(benches);
