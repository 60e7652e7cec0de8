//! Mutation tests: puts small faults into the code that decides what a robot does, and counts the faults that tests
//! catch.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test tool fails by panicking")]
#![allow(clippy::print_stdout, reason = "what it prints is what it is for")]
#![allow(clippy::wildcard_enum_match_arm, reason = "Rust's syntax has more nodes than are changed here")]

mod at_once;
mod checkout;
mod choice;
mod drivers;
mod equivalent;
mod finder;
mod judge;
mod mutant;
mod operators;
mod pieces;
mod refusals;
mod report;
mod schemata;
mod template;
mod trial;

use std::io::{BufWriter, ErrorKind, Write};
use std::process::ExitCode;

use clap::Parser;

use equivalent::Equivalents;
use judge::Judge;
use mutant::Mutant;

/// Insert small faults into the code, one at a time, and report which test catches each fault.
#[derive(Debug, Parser)]
struct Options {
    /// Try every mutant.
    #[arg(long)]
    all: bool,
    /// Also try the mutants in `equivalent.toml`, which no test is known to catch.
    #[arg(long)]
    equivalent: bool,
    /// Number of mutants to try; each seed selects different ones.
    #[arg(long, default_value_t = 5, conflicts_with = "all")]
    count: usize,
    /// Random seed that selects the mutants; the hash of the commit by default.
    #[arg(long)]
    seed: Option<u64>,
    /// Try only mutants whose printed line contains this text.
    #[arg(long, default_value = "")]
    only: String,
    /// Try the faults of `drivers.toml` in the robots' drivers; conformance tests must find them.
    #[arg(long, conflicts_with_all = ["all", "equivalent", "count", "seed", "only", "list"])]
    drivers: bool,
    /// Print the mutants without trying them.
    #[arg(long)]
    list: bool,
}

fn main() -> ExitCode {
    let options = Options::parse();
    if options.drivers {
        return if drivers::all_are_caught() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    }
    let sources = choice::sources();
    let mutants = choice::all(&sources);
    let seed = options.seed.unwrap_or_else(choice::seed_of_commit);
    let mut chosen = choice::shuffled(&mutants, seed);
    chosen.retain(|mutant| mutant.to_string().contains(&options.only));
    if options.list {
        return list(&chosen);
    }
    let equivalents = Equivalents::read();
    let stale: Vec<_> = equivalents.stale(&mutants).collect();
    for entry in &stale {
        println!("equivalent.toml has an entry without a mutant or a reason: {}", report::name(entry));
    }
    if !stale.is_empty() {
        return ExitCode::FAILURE;
    }
    println!("{} mutants, seed {seed}", mutants.len());
    chosen.retain(|mutant| options.equivalent || equivalents.find(mutant).is_none());
    let judge = Judge { sources: &sources, equivalents: &equivalents };
    let report = if options.all { judge.all(&chosen) } else { judge.some(&chosen, options.count) };
    println!("{report}");
    if report.is_good() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Prints mutants until the reader of the output closes it.
fn list(mutants: &[&Mutant]) -> ExitCode {
    let mut out = BufWriter::new(std::io::stdout().lock());
    let printed = mutants.iter().try_for_each(|mutant| writeln!(out, "{mutant}")).and_then(|()| out.flush());
    match printed {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => panic!("the list: {error}"),
        _ => ExitCode::SUCCESS,
    }
}
