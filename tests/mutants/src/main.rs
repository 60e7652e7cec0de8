//! Mutation tests: puts small faults into the code that decides what a robot does, and counts which of them tests catch.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test tool fails by panicking")]
#![allow(clippy::print_stdout, reason = "what it prints is what it is for")]
#![allow(clippy::wildcard_enum_match_arm, reason = "Rust's syntax has more nodes than are changed here")]

mod checkout;
mod choice;
mod equivalent;
mod finder;
mod mutant;
mod operators;
mod pieces;
mod report;
mod template;
mod trial;

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;

use checkout::Checkout;
use choice::Source;
use equivalent::Equivalents;
use mutant::Mutant;
use report::Report;
use trial::{Outcome, Trials};

/// Puts small faults into the code, one at a time, and says which test catches each of them.
#[derive(Debug, Parser)]
struct Options {
    /// Try every mutant, those of `equivalent.toml` as well.
    #[arg(long)]
    all: bool,
    /// Try this many, other ones with every seed.
    #[arg(long, default_value_t = 5, conflicts_with = "all")]
    count: usize,
    /// What decides which; the hash of the commit if it is not given.
    #[arg(long)]
    seed: Option<u64>,
    /// Only mutants whose lines, as they are printed, contain this.
    #[arg(long, default_value = "")]
    only: String,
    /// Print the mutants and try none.
    #[arg(long)]
    list: bool,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let sources = choice::sources();
    let mutants = choice::all(&sources);
    let seed = options.seed.unwrap_or_else(choice::seed_of_commit);
    let mut chosen = choice::shuffled(&mutants, seed);
    chosen.retain(|mutant| mutant.to_string().contains(&options.only));
    if options.list {
        chosen.iter().for_each(|mutant| println!("{mutant}"));
        return ExitCode::SUCCESS;
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
    chosen.retain(|mutant| options.all || equivalents.find(mutant).is_none());
    let count = if options.all { usize::MAX } else { options.count };
    let report = try_all(&chosen, count, &sources, &equivalents);
    println!("{report}");
    if report.is_good() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Tries mutants until this many have compiled.
fn try_all(chosen: &[&Mutant], count: usize, sources: &[Source], equivalents: &Equivalents) -> Report {
    let trials = Trials::prepare(Checkout::copy());
    let mut report = Report::default();
    for mutant in chosen {
        if report.compiled() == count {
            break;
        }
        let source = sources.iter().find(|source| source.file == mutant.file).expect("the mutant's file");
        let start = Instant::now();
        let outcome = trials.run(mutant, &source.text);
        let equivalent = equivalents.find(mutant);
        report.add(mutant, outcome, equivalent.is_some());
        if outcome != Outcome::DoesNotCompile {
            let reason = equivalent.map_or(String::new(), |entry| format!(" (changes nothing: {})", entry.reason));
            println!("{mutant}: {}{reason} [{:.0?}]", report::said(outcome), start.elapsed());
        }
    }
    report
}
