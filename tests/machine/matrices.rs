//! Tests that the matrices that `--emit matrices` prints or writes, when they are read back, make the same transitions
//! as the machine `table` (paper, Eqs. 2 to 4), and that the command reports which of the two forms of matrices it has
//! chosen.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;

use mdle_compiler::trace::{COMPLETED, Fired, Script, TableMachine, TraceLine, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;
use mdle_theory::equations::{Terms, equation, matrix_files, most_states, terms};
use serde_json::Value;

/// Number of random plans.
const PLANS: u64 = 140;
/// Maximum number of states of a plan that is tested, because each matrix is read as a whole.
const STATES: u64 = 300;

/// A matrix that was read back: its name, its text, the row of the 1 in each column, with rows numbered from 1, and its
/// scopes.
#[derive(Debug)]
struct Read {
    name: String,
    text: String,
    rows: Vec<usize>,
    /// For each scope, the number of its interrupt, its first state and its last state.
    places: Vec<(usize, usize, usize)>,
}

/// All matrices of a plan that were read back.
#[derive(Debug, Default)]
struct Matrices {
    live: Vec<Read>,
    never: Vec<Read>,
}

impl Matrices {
    /// Returns the numbers of the interrupts of all scopes that contain a state, outermost first.
    fn around(&self, state: usize) -> Vec<usize> {
        let all = self.live.iter().chain(&self.never).filter(|read| read.name != "completed");
        let places = all.flat_map(|read| &read.places);
        let mut numbers: Vec<_> = places.filter(|place| holds(place, state)).map(|(number, ..)| *number).collect();
        numbers.sort_unstable();
        numbers
    }

    /// Asserts that the product of the matrices of the fired interrupts makes the transitions of a trace. Returns the
    /// number of transitions.
    fn follow(&self, trace: &[TraceLine<'_>], combined: bool) -> usize {
        let (mut e, mut count) = (1, 0);
        for TraceLine { turn, outcome, .. } in trace {
            for Fired { from, level, by, .. } in &outcome.fired {
                assert_eq!(e as u64, *from, "turn {turn}");
                let number = self.around(e)[*level];
                let is_it = |read: &&Read| {
                    read.places.iter().any(|place| place.0 == number && holds(place, e))
                        && (read.name == "completed") == (*by == COMPLETED)
                };
                let read = self.live.iter().find(is_it).unwrap_or_else(|| panic!("turn {turn}: {by} at e{e}"));
                // With `--combine`, interrupts with different texts share a matrix, which has the text of one of them.
                assert!(combined || read.text == *by || read.name == "completed", "turn {turn}: {read:?} is not {by}");
                e = read.rows[e - 1];
                count += 1;
            }
            assert_eq!(e as u64, outcome.state, "turn {turn}");
        }
        count
    }
}

fn holds(place: &(usize, usize, usize), state: usize) -> bool {
    (place.1..=place.2).contains(&state)
}

/// Reads a MatrixMarket coordinate file of a square matrix with exactly one 1 in each column. Returns the row of the 1
/// in each column.
fn read_market(text: &str) -> Vec<usize> {
    assert!(text.lines().all(|line| line.len() <= 1024));
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("%%MatrixMarket matrix coordinate integer general"));
    let numbers = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<usize>>();
    let mut lines = lines.filter(|line| !line.starts_with('%')).map(numbers);
    let size = lines.next().unwrap();
    let (states, entries) = (size[0], lines.collect::<Vec<_>>());
    assert_eq!(size, [states, states, entries.len()]);
    columns(
        states,
        entries.iter().map(|entry| {
            assert_eq!((entry.len(), entry[2]), (3, 1));
            (entry[0], entry[1])
        }),
    )
}

/// Returns the row of the 1 in each column. `ones` contains the row and the column of every 1.
///
/// # Panics
/// If a column does not contain exactly one 1.
fn columns(states: usize, ones: impl Iterator<Item = (usize, usize)>) -> Vec<usize> {
    let mut rows = vec![0; states];
    for (row, column) in ones {
        assert!((1..=states).contains(&row) && rows[column - 1] == 0, "column {column} has two ones");
        rows[column - 1] = row;
    }
    assert!(rows.iter().all(|row| *row != 0), "a column has no one: {rows:?}");
    rows
}

/// Reads the matrices from the list of files and from the files.
fn read_files(list: &str, files: &BTreeMap<String, String>) -> Matrices {
    let list: Value = serde_json::from_str(list).unwrap();
    let number = |value: &Value| value.as_u64().unwrap() as usize;
    let entries = |key: &str| {
        let entries = list[key].as_array().unwrap().iter().map(|entry| Read {
            name: entry["name"].as_str().unwrap().into(),
            text: entry["text"].as_str().unwrap().into(),
            rows: entry["file"].as_str().map(|file| read_market(&files[file])).unwrap_or_default(),
            places: entry["places"]
                .as_array()
                .unwrap()
                .iter()
                .map(|place| (number(&place["number"]), number(&place["first"]), number(&place["last"])))
                .collect(),
        });
        entries.collect()
    };
    Matrices { live: entries("matrices"), never: entries("never") }
}

/// Reads the matrices from the equation in the paper's notation and the explanations of its symbols.
fn read_equation(text: &str) -> Matrices {
    let (sum, symbols) = text.split_once("where the state is one of\n").unwrap();
    let mut rows = BTreeMap::new();
    for beside in sum.trim_end_matches('\n').split("\n\n").filter(|beside| *beside != "Π(t) = 0") {
        let lines: Vec<Vec<_>> = beside.lines().map(|line| line.split(['⎡', '⎢', '⎣']).skip(1).collect()).collect();
        for block in 0..lines[0].len() {
            let parts = lines.iter().map(|line| line[block].split_once(['⎤', '⎥', '⎦']).unwrap());
            let (entries, names): (Vec<_>, Vec<_>) = parts.unzip();
            let name = names.iter().find_map(|part| part.split_once("ξ\u{304}")?.1.split_once("(t)")).unwrap().0;
            let ones = entries.iter().zip(1..).flat_map(|(entries, row)| {
                let entries = entries.split(' ').zip(1..);
                entries.filter(|(entry, _)| *entry == "1").map(move |(_, column)| (row, column))
            });
            rows.insert(name.to_owned(), columns(entries.len(), ones));
        }
    }
    let mut matrices = Matrices::default();
    for line in symbols.lines().filter_map(|line| line.strip_prefix("  ξ")) {
        let read = read_symbol(line, &mut rows);
        if read.rows.is_empty() { matrices.never.push(read) } else { matrices.live.push(read) }
    }
    assert!(rows.is_empty(), "nothing is said of {rows:?}");
    matrices
}

/// Reads an explanation of a symbol, such as `2  bumper, at e1…e2 of Q (2), e3 (5)`, and takes the matrix of the symbol
/// from `rows`.
fn read_symbol(line: &str, rows: &mut BTreeMap<String, Vec<usize>>) -> Read {
    let (symbol, what) = line.split_once(' ').unwrap();
    let (text, places) = what.trim_start().rsplit_once(", at ").unwrap();
    let places = places.split(", ").map(|place| {
        let states = place.split(' ').next().unwrap();
        let (first, last) = states.split_once('…').unwrap_or((states, states));
        let number = place.rsplit_once('(').map_or(symbol, |(_, number)| number.trim_end_matches(')'));
        let state = |text: &str| text.strip_prefix('e').unwrap().parse().unwrap();
        (number.parse().unwrap(), state(first), state(last))
    });
    let (places, rows) = (places.collect(), rows.remove(symbol).unwrap_or_default());
    Read { name: symbol.trim_start_matches('_').into(), text: text.into(), rows, places }
}

fn written(terms: &Terms<'_>) -> Matrices {
    let files = matrix_files(terms).expect("a small plan");
    read_files(&files.list(), &files.files().collect())
}

#[test]
fn matrices_that_are_read_back_drive_the_transitions_of_the_table() {
    let (mut plans, mut small, mut transitions, mut summed) = (0, 0, 0, 0);
    for seed in 0..repeated(PLANS) {
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 2 + (seed % 20) as usize, false).to_string();
        let script = Script::read(&script(&mut chance, 12)).unwrap();
        let Ok(compiled) = compile(&text) else { continue };
        if compiled.machine.states() > STATES {
            continue;
        }
        println!("seed {seed}\n{text}");
        let plan = &compiled.nondegenerate;
        let trace: Vec<_> = run(TableMachine::new(plan).unwrap(), &script).collect();
        plans += 1;
        for combined in [false, true] {
            let terms = terms(plan, combined).unwrap();
            summed += terms.live.iter().filter(|term| term.places.len() > 1 && term.name != "completed").count();
            transitions += written(&terms).follow(&trace, combined);
            if let Some(text) = equation(&terms) {
                small += 1;
                transitions += read_equation(&text).follow(&trace, combined);
            } else {
                assert!(terms.states() > most_states());
            }
        }
    }
    println!("{plans} plans, {small} in the paper's notation, {transitions} transitions, {summed} sums");
    let tried = repeated(PLANS) as usize;
    assert!(plans > tried * 3 / 4 && small > tried / 2 && transitions > tried * 25 && summed > tried / 2);
}

/// A plan with a matrix of each of the paper's three types.
const PLAN: &str = "{ P (bumper) { Q (wait 9) (Atom (wait 1) stop) (Atom (wait 2) (go 5 0)) }\n  \
                    ((Atom (wait 3) stop) (Atom (wait 1) rotate 90))^inf }\n";

#[test]
fn matrices_are_printed_or_written_into_a_folder() {
    let folder = folder("matrices");
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    let message = |arguments: &[&str]| {
        let output = run_mdlec(&folder, &[&["plan.mdle", "--emit"], arguments].concat());
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (status, printed, report) = message(&["matrices"]);
    assert_eq!((status, &*report), (Some(0), ""));
    insta::assert_snapshot!("matrices_of_each_type", printed);
    let names = |folder: &str| {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = entries.collect();
        names.sort();
        names
    };
    let there = folder.join("written/here");
    let (status, printed, report) = message(&["matrices=written/here"]);
    assert_eq!((status, &*printed), (Some(0), ""));
    assert_eq!(
        report,
        "7 matrices of 5 states as MatrixMarket files in `written/here`; `matrices.json` says which interrupt each belongs \
         to\n"
    );
    let there = there.to_str().unwrap();
    assert_eq!(
        names(there),
        ["completed.mtx", "matrices.json", "x1.mtx", "x2.mtx", "x3.mtx", "x4.mtx", "x5.mtx", "x6.mtx"]
    );
    // Files of an earlier plan are removed; files that mdlec did not write are kept.
    fs::write(folder.join("written/here/x.mtx"), "mine").unwrap();
    // Timers of different scopes are never combined into one matrix.
    fs::write(folder.join("plan.mdle"), PLAN.replace("(wait 1)", "(atIsection 1000)")).unwrap();
    assert_eq!(message(&["matrices", "--combine", "-o", "written/here"]).0, Some(0));
    assert_eq!(
        names(there),
        ["completed.mtx", "matrices.json", "x.mtx", "x1.mtx", "x2.mtx", "x3.mtx", "x4.mtx", "x5.mtx"]
    );
}

#[test]
fn failures_to_print_or_write_have_a_help() {
    let folder = folder("no_matrices");
    let message = |plan: &str, arguments: &[&str]| {
        fs::write(folder.join("plan.mdle"), plan).unwrap();
        let output = run_mdlec(&folder, &[&["plan.mdle", "--emit"], arguments].concat());
        assert_eq!(output.stdout, b"");
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (status, report) = message("{ P (Atom (wait 1) stop)^16 }", &["matrices"]);
    assert!(status == Some(2) && report.contains("`--emit matrices=FOLDER`"), "{report}");
    let (status, report) = message("{ P (Atom (wait 1) stop)^9999 }", &["matrices=large"]);
    assert!(status == Some(1) && report.contains("error[E0502]") && report.contains("99990000 ones"), "{report}");
    assert!(!folder.join("large").exists());
    // Combined, the interrupts have a single matrix.
    let (status, report) = message("{ P (Atom (bumper) stop)^9999 }", &["matrices=large", "--combine"]);
    assert!(status == Some(0) && report.contains("1 matrix of 10000 states"), "{report}");
    let (status, report) = message(PLAN, &["matrices=plan.mdle"]);
    assert!(status == Some(2) && report.contains("`plan.mdle` cannot be written"), "{report}");
    let (status, report) = message(PLAN, &["fsm", "--combine"]);
    assert!(status == Some(2) && report.contains("`--emit matrices`"), "{report}");
}
