//! Provides the alphabets that are built into mdlec, as texts and in parsed form: the shared alphabet and the alphabets
//! of the targets.

use crate::alphabet::{self as language, AlphabetFile, Capability};
use crate::diagnostic::{Diagnostic, Sources, has_errors};

/// An alphabet that is built into mdlec.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alphabet {
    /// Name of the alphabet, as used after `--target` or `use`.
    pub name: &'static str,
    /// Name of the file, as messages show it.
    pub file: &'static str,
    /// Text of the file.
    pub text: &'static str,
    /// `true` for the alphabet of a target, `false` for a shared alphabet.
    pub target: bool,
}

/// Returns the alphabets that are built into mdlec: first the shared alphabets, then the alphabets of the targets,
/// sorted by name.
#[must_use]
pub fn alphabets() -> &'static [Alphabet] {
    ALPHABETS
}

include!(concat!(env!("OUT_DIR"), "/alphabets.rs"));

/// A target's alphabet combined with the shared alphabets that it uses, and the files that define them.
#[derive(Debug)]
pub struct ReadAlphabet {
    /// The alphabet.
    pub alphabet: language::Alphabet,
    /// Names and texts of the files that define the alphabet, shared files first.
    pub files: Vec<(String, String)>,
}

/// Reads the shared alphabets, and the target's alphabet in `own`, which contains the file name and the text. Without
/// `own`, the result is the alphabet of a robot with every capability.
///
/// # Errors
/// Fails if the alphabets have errors; returns the files and the diagnostics.
pub fn read(own: Option<(String, String)>) -> Result<ReadAlphabet, (Sources, Vec<Diagnostic>)> {
    let mut reading = AlphabetFiles::default();
    let mut shared = Vec::new();
    for alphabet in alphabets().iter().filter(|alphabet| !alphabet.target) {
        shared.extend(reading.read(alphabet.file.to_owned(), alphabet.text.to_owned()));
    }
    let alphabet = match own {
        Some((file, text)) => reading.read(file, text).map(|file| {
            let (alphabet, found) = language::combine(file, &shared);
            reading.found.extend(found);
            alphabet
        }),
        None => shared.into_iter().next().map(language::Alphabet::shared),
    };
    let AlphabetFiles { sources, files, found } = reading;
    // An alphabet causes no warnings.
    match alphabet {
        Some(mut alphabet) if !has_errors(&found) => {
            alphabet.robots = robots();
            Ok(ReadAlphabet { alphabet, files })
        }
        Some(_) | None => Err((sources, found)),
    }
}

/// Returns the robots that are built into mdlec, with their capabilities, including capabilities that need an engine.
fn robots() -> Vec<(String, Vec<Capability>)> {
    let targets = alphabets().iter().filter(|alphabet| alphabet.target);
    let head = |builtin: &Alphabet| {
        let (file, _) = language::read(Sources::default().add(builtin.file, builtin.text), builtin.text);
        let head = file?.target?;
        Some((builtin.name.to_owned(), [head.capabilities, head.engine].concat()))
    };
    targets.filter_map(head).collect()
}

/// State of reading several alphabet files one after the other.
#[derive(Default)]
struct AlphabetFiles {
    sources: Sources,
    files: Vec<(String, String)>,
    found: Vec<Diagnostic>,
}

impl AlphabetFiles {
    fn read(&mut self, file: String, text: String) -> Option<AlphabetFile> {
        let source = self.sources.add(&file, &text);
        let (alphabet, found) = language::read(source, &text);
        self.found.extend(found);
        self.files.push((file, text));
        alphabet
    }
}
