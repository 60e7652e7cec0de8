//! Reasons why no plan was embedded, as a build script shows them.

use std::fmt;
use std::io;
use std::path::PathBuf;

use mdle_compiler::diagnostic::{Diagnostic, Severity, Sources, most_shown};
use mdle_files::{FaultyFile, InputError, Spelling};

/// Reason why no plan was embedded.
///
/// `Debug` prints the message as well, since a `main` that returns the error prints that form.
#[derive(thiserror::Error)]
pub enum EmbedError {
    /// The plan has errors.
    #[error("{}", report(.sources, .diagnostics))]
    Plan {
        /// Files to which the diagnostics refer.
        sources: Box<Sources>,
        /// Diagnostics of `mdlec check`, which include errors.
        diagnostics: Vec<Diagnostic>,
    },
    /// The plan or the target cannot be read, or the plan to compile is not determined.
    #[error("{}", .0.message(Spelling::BuildScript))]
    Input(InputError),
    /// The process is not a build script, as cargo has not set `OUT_DIR`.
    #[error("the variable OUT_DIR is not set: plans are embedded by the build script of a package")]
    NoOutDir,
    /// The name of an input has a line break, after which cargo would read another instruction.
    #[error(
        "the name {0:?} contains a line break, so cargo cannot watch this file\nhelp: rename the file or its folder"
    )]
    LineBreak(PathBuf),
    /// The file to write is a file that was read: its path.
    #[error("`{0}` is the plan itself and would be lost: rename the plan's file")]
    OutputIsInput(PathBuf),
    /// The Rust code cannot be written.
    #[error("`{path}` cannot be written: {error}")]
    Output {
        /// File to write.
        path: PathBuf,
        /// Error of the system.
        error: io::Error,
    },
    /// Cargo cannot be informed on standard output.
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

/// Returns the number of errors, followed by the diagnostics for people.
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
