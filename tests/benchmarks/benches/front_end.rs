//! Text to tree, in bytes a second: mdlec's front end beside the bare parser of the same grammar.
//!
//! `mdlec` puts each tree into an arena that has been used before, so that the parser is measured; `mdlec, first` into a new one,
//! so that the time is in it which the system takes to hand out memory. Trees are taken down outside of the measured time.

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mdle_benchmarks::bare;
use mdle_benchmarks::front_end::{one_megabyte, plans, ten_megabytes};
use mdlec::diagnostic::SourceId;
use mdlec::syntax::{Arena, arena_for, parse};

/// Reads a text; whether it had no fault.
fn reads(text: &str, arena: &Arena) -> bool {
    let (file, found) = parse(SourceId(0), black_box(text), arena);
    black_box(&file);
    found.is_empty()
}

fn front_end(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("front_end");
    group.sample_size(20);
    for (name, texts) in [plans(), one_megabyte(), ten_megabytes()] {
        assert!(texts.iter().all(|text| bare::accepts(text) && reads(text, &Arena::new())), "{name}");
        group.throughput(Throughput::BytesDecimal(texts.iter().map(|text| text.len() as u64).sum()));
        group.bench_function(BenchmarkId::new("bare", name), |bencher| {
            bencher.iter(|| texts.iter().all(|text| bare::accepts(black_box(text))));
        });
        group.bench_function(BenchmarkId::new("mdlec", name), |bencher| {
            let mut arena = Arena::new();
            bencher.iter(|| {
                texts.iter().all(|text| {
                    arena.reset();
                    reads(text, &arena)
                })
            });
        });
        group.bench_function(BenchmarkId::new("mdlec, first", name), |bencher| {
            let read = |arenas: &mut Vec<Arena>| texts.iter().zip(arenas).all(|(text, arena)| reads(text, arena));
            let arenas = || texts.iter().map(|text| arena_for(text)).collect::<Vec<_>>();
            bencher.iter_batched_ref(arenas, read, BatchSize::PerIteration);
        });
    }
    group.finish();
}

criterion_group!(benches, front_end);
criterion_main!(benches);
