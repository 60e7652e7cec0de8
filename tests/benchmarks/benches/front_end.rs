//! Measures the parser, from text to tree, in megabytes per second.
//!
//! Two kinds of runs alternate, and the fastest run of each kind counts. `used` puts each tree into an arena that was
//! used before, and thus measures the parser alone. `new` puts each tree into a new arena, and thus includes the time
//! in which the system provides memory. The time in which trees are dropped is not measured.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use mdle_benchmarks::front_end::{one_megabyte, plans, ten_megabytes};
use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::syntax::{Arena, arena_for, parse};

/// Number of bytes that the runs of a kind parse in total.
const BYTES: usize = 200_000_000;

fn main() {
    println!("{:8} {:>6} {:>12} {:>12}", "", "runs", "used, MB/s", "new");
    for (name, texts) in [plans(), one_megabyte(), ten_megabytes()] {
        assert!(texts.iter().all(|text| reads(text, &Arena::new())), "{name}");
        let bytes: usize = texts.iter().map(String::len).sum();
        // Short texts are parsed several times per run, because the clock is not precise enough for a shorter run.
        let (runs, repeats) = (BYTES / bytes.max(100_000), (100_000 / bytes).max(1));
        let [used, new] = fastest(&texts, runs, repeats);
        let speed = |time: Duration| (bytes * repeats) as f64 / time.as_secs_f64() / 1e6;
        println!("{name:8} {runs:>6} {:>12.1} {:>12.1}", speed(used), speed(new));
    }
}

/// Returns the time of the fastest run in a used arena, and of the fastest run in new arenas.
fn fastest(texts: &[String], runs: usize, repeats: usize) -> [Duration; 2] {
    let mut fastest = [Duration::MAX; 2];
    let mut used = Arena::new();
    for _ in 0..runs {
        let mut new: Vec<Vec<Arena>> = Vec::new();
        new.resize_with(repeats, || texts.iter().map(|text| arena_for(text)).collect());
        let times = [
            time(repeats, |_| {
                texts.iter().all(|text| {
                    used.reset();
                    reads(text, &used)
                })
            }),
            time(repeats, |run| texts.iter().zip(&new[run]).all(|(text, arena)| reads(text, arena))),
        ];
        fastest = std::array::from_fn(|which| fastest[which].min(times[which]));
    }
    fastest
}

fn time(repeats: usize, mut reads: impl FnMut(usize) -> bool) -> Duration {
    let start = Instant::now();
    let sound = (0..repeats).all(&mut reads);
    let time = start.elapsed();
    assert!(sound, "a text has a fault");
    time
}

/// Parses a text; returns `true` if it has no errors.
fn reads(text: &str, arena: &Arena) -> bool {
    let (file, found) = parse(SourceId(0), black_box(text), arena);
    black_box(&file);
    found.is_empty()
}
