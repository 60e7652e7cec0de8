//! Defines the reasons why a plan could not be embedded, with the messages that a build script shows.

use std::fmt;
use std::io;
use std::path::PathBuf;

use mdle_compiler::diagnostic::{Diagnostic, Severity, Sources, most_shown};
use mdle_files::{FaultyFile, InputError, Spelling};

/// Reason why a plan could not be embedded.
///
/// `Debug` prints the same text as `Display`, because a `main` that returns the error prints it with `Debug`.
#[derive(thiserror::Error)]
pub enum EmbedError {
    /// The plan has errors.
    #[error("{}", report(.sources, .diagnostics))]
    Plan {
        /// Texts of the files to which the diagnostics refer.
        sources: Box<Sources>,
        /// Diagnostics as in `mdlec check`; at least one is an error.
        diagnostics: Vec<Diagnostic>,
    },
    /// The plan or the target cannot be read, or it is not clear which plan of the file to compile.
    #[error("{}", .0.message(Spelling::BuildScript))]
    Input(InputError),
    /// The process is not a build script: cargo has not set `OUT_DIR`.
    #[error("the variable OUT_DIR is not set: plans are embedded by the build script of a package")]
    NoOutDir,
    /// The name of an input file contains a line break. Cargo would read the text after it as another instruction.
    #[error(
        "the name {0:?} contains a line break, so cargo cannot watch this file\nhelp: rename the file or its folder"
    )]
    LineBreak(PathBuf),
    /// The output file, at this path, is also an input file.
    #[error("`{0}` is a file that the plan is read from, and would be lost: rename that file")]
    OutputIsInput(PathBuf),
    /// The Rust code cannot be written.
    #[error("`{path}` cannot be written: {error}")]
    Output {
        /// File to write.
        path: PathBuf,
        /// Error of the system.
        error: io::Error,
    },
    /// The instructions for cargo cannot be written to standard output.
    #[error("cargo does not get the list of files to watch: {0}")]
    Cargo(io::Error),
}

impl fmt::Debug for EmbedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl From<InputError> for EmbedError {
    fn from(error: InputError) -> Self {
        let InputError::Faulty(FaultyFile { sources, diagnostics, .. }) = error else { return Self::Input(error) };
        Self::Plan { sources: Box::new(sources), diagnostics }
    }
}

/// Returns a message with the number of errors, followed by the diagnostics as text.
fn report(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    let errors = diagnostics.iter().filter(|found| found.code.severity() == Severity::Error).count();
    let most = most_shown(diagnostics);
    let texts: Vec<_> = diagnostics.iter().take(most).map(|found| sources.render(found)).collect();
    let others = match diagnostics.len() - texts.len() {
        0 => String::new(),
        others => format!("… and {others} more\n"),
    };
    let errors = if errors == 1 { "1 error".to_owned() } else { format!("{errors} errors") };
    format!("the plan is not embedded: {errors}\n\n{}{others}", texts.concat())
}
