//! Selects mutants by a random seed, and lists the files from which they are taken.

use std::fs;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::checkout::{git, root};
use crate::mutant::{Mutant, mutants};

/// Areas that are mutated, each a list of files and folders. Mutants are taken from each area in turn, regardless of
/// its size.
const AREAS: &[&[&str]] = &[
    &[
        "runtime/core/src/condition.rs",
        "runtime/core/src/cursor.rs",
        "runtime/core/src/follows.rs",
        "runtime/core/src/fsm.rs",
        "runtime/core/src/machine.rs",
        "runtime/core/src/memory.rs",
        "runtime/core/src/operator.rs",
        "runtime/core/src/plan.rs",
        "runtime/core/src/rows.rs",
        "runtime/core/src/signal.rs",
    ],
    &["mdlec/compiler/src/plan/functions.rs", "mdlec/compiler/src/plan/nondegenerate.rs"],
    &["mdlec/compiler/src/fsm/lower.rs"],
    &["mdlec/compiler/src/rust"],
];

/// A file that is mutated.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) area: usize,
    pub(crate) file: String,
    pub(crate) text: String,
}

/// Returns the files of all areas.
pub(crate) fn sources() -> Vec<Source> {
    let mut sources = Vec::new();
    for (area, paths) in AREAS.iter().enumerate() {
        let names = paths.iter().flat_map(|path| {
            let path = path.to_owned();
            if root().join(path).is_dir() { in_folder(path) } else { vec![path.to_owned()] }
        });
        sources.extend(names.map(|file| {
            let text = fs::read_to_string(root().join(&file)).unwrap_or_else(|error| panic!("{file}: {error}"));
            Source { area, file, text }
        }));
    }
    sources
}

/// Returns the Rust files in a folder, except tests.
fn in_folder(folder: &str) -> Vec<String> {
    let names = fs::read_dir(root().join(folder)).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    let names = names.map(|name| name.into_string().expect("a name in UTF-8"));
    let mut files: Vec<_> = names.filter(|name| name.ends_with(".rs") && name != "tests.rs").collect();
    files.sort();
    files.into_iter().map(|name| format!("{folder}/{name}")).collect()
}

/// Returns all mutants of these files.
pub(crate) fn all(sources: &[Source]) -> Vec<Mutant> {
    let found = sources.iter().map(|Source { area, file, text }| {
        mutants(*area, file, text).unwrap_or_else(|error| panic!("{file}: {error}"))
    });
    found.flatten().collect()
}

/// Returns the mutants in a random order that depends on `seed` and takes a mutant from each area in turn.
pub(crate) fn shuffled(mutants: &[Mutant], seed: u64) -> Vec<&Mutant> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let mut areas: Vec<Vec<(u64, &Mutant)>> = vec![Vec::new(); AREAS.len()];
    for mutant in mutants {
        areas[mutant.area].push((chance.next_u64(), mutant));
    }
    let mut ranked = Vec::new();
    for area in &mut areas {
        area.sort_by_key(|(chance, _)| *chance);
        ranked.extend(area.iter().enumerate().map(|(rank, (chance, mutant))| ((rank, *chance), *mutant)));
    }
    ranked.sort_by_key(|(key, _)| *key);
    ranked.into_iter().map(|(_, mutant)| mutant).collect()
}

/// Returns a random seed that differs in every commit.
pub(crate) fn seed_of_commit() -> u64 {
    let commit = git(&["rev-parse", "HEAD"]);
    commit.get(..15).and_then(|start| u64::from_str_radix(start, 16).ok()).expect("the hash of a commit")
}
