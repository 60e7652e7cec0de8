//! Embeds plans in an application: the build script of the application compiles the plans to Rust code, which the
//! application includes.
//!
//! ```no_run
//! // build.rs
//! fn main() -> Result<(), mdle_embed::EmbedError> {
//!     mdle_embed::plan("plans/dock.mdle").target("sim").write()
//! }
//! ```
//!
//! ```text
//! // src/main.rs
//! mod dock {
//!     include!(concat!(env!("OUT_DIR"), "/dock.rs"));
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     mdle_host::run::<mdle_sim::Target, _>("Dock", dock::Dock::new)
//! }
//! ```
//!
//! The package needs `mdle-embed` in its `[build-dependencies]`, and in its `[dependencies]` the crates that the
//! generated Rust uses: `mdle-runtime` and the target's crate, here `mdle-sim`. [`write`](Embed::write) generates one
//! type, which implements `mdle_runtime::Plan`. `mdle_host::run` runs the plan like an executable that `mdlec` builds,
//! and `mdle_runtime::Machine` runs it turn by turn.
#![allow(clippy::disallowed_methods, reason = "a build script writes files")]

mod error;

use std::env;
use std::ffi::OsString;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use mdle_compiler::diagnostic::{Diagnostic, JsonMessage, Sources, has_errors};
use mdle_files::InputError;
use mdle_runtime::Printable;

pub use error::EmbedError;

/// A plan to embed.
#[derive(Debug, Clone)]
#[must_use = "nothing is embedded before it is written"]
pub struct Embed {
    file: PathBuf,
    target: Option<String>,
    plan: Option<String>,
}

/// Returns an [`Embed`] for the plan in `file`. A relative path is relative to the folder of the package.
pub fn plan(file: impl Into<PathBuf>) -> Embed {
    Embed { file: file.into(), target: None, plan: None }
}

impl Embed {
    /// Sets the robot: a name from `mdlec targets`, or the folder of a target of your own. This call is required.
    pub fn target(self, target: impl Into<String>) -> Self {
        Self { target: Some(target.into()), ..self }
    }

    /// Selects a plan of the file. This call is required if the file contains several plans that no other plan uses.
    pub fn plan(self, name: impl Into<String>) -> Self {
        Self { plan: Some(name.into()), ..self }
    }

    /// Writes `$OUT_DIR/STEM.rs`, where `STEM` is the plan file's name without its extension; a second plan that is
    /// embedded from the same file overwrites the first. Makes cargo show the warnings. Also makes cargo run the build
    /// script again if an input file changes: the plan, a file that the plan uses, or the alphabet of a target of your
    /// own.
    ///
    /// # Errors
    /// Fails if the plan has errors, if its file or the target cannot be read, or if the Rust code cannot be written. A
    /// `main` that returns the error shows the messages of `mdlec check`.
    pub fn write(self) -> Result<(), EmbedError> {
        let folder = env::var_os("OUT_DIR").ok_or(EmbedError::NoOutDir)?;
        let mut name = OsString::from(self.file.file_stem().unwrap_or_default());
        name.push(".rs");
        let output = PathBuf::from(folder).join(name);
        let instructions = self.write_to(&output)?;
        let mut out = io::stdout().lock();
        out.write_all(instructions.as_bytes()).and_then(|()| out.flush()).map_err(EmbedError::Cargo)
    }

    /// Writes the Rust code to `output`, and returns the instructions for cargo.
    fn write_to(&self, output: &Path) -> Result<String, EmbedError> {
        let mut target = mdle_files::target(Some(self.target.as_deref().ok_or(InputError::NoTarget)?))?;
        // An application runs no modules beside its plan.
        target.alphabet.has_engine = false;
        let mut input = mdle_files::read_plan(&self.file, &target)?;
        if let Some(name) = &self.plan {
            input.must_have(name)?;
        }
        let (plans, found) = input.compile(&target.alphabet, self.plan.as_deref());
        let faulty = |sources: Sources, diagnostics| EmbedError::Plan { sources: Box::new(sources), diagnostics };
        if has_errors(&found) {
            return Err(faulty(input.sources, found));
        }
        let compiled = input.only(plans.into_iter().map(|plan| (plan.plan.root.name.clone(), plan)).collect())?;
        target.must_be_bound()?;
        let rust = match input.rust(&compiled, &target) {
            Ok(rust) => rust,
            Err(too_large) => return Err(faulty(input.sources, vec![too_large])),
        };
        // The built-in alphabets change only with mdlec, and then cargo runs the build script again anyway.
        let inputs = input.inputs(&target);
        let watched = inputs.iter().map(|file| watched(file)).collect::<Result<String, _>>()?;
        if is_among(output, &inputs) {
            return Err(EmbedError::OutputIsInput(output.to_owned()));
        }
        // Cargo runs an interrupted build script again, so an incomplete file does no harm.
        fs::write(output, rust).map_err(|error| EmbedError::Output { path: output.to_owned(), error })?;
        Ok(warnings(&input.sources, &found) + &watched)
    }
}

/// Returns `true` if `output` is the same file as one of `inputs`, even under a different path.
fn is_among(output: &Path, inputs: &[PathBuf]) -> bool {
    let Ok(output) = output.canonicalize() else { return false };
    inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == output))
}

/// Returns the lines that make cargo show warnings.
fn warnings(sources: &Sources, found: &[Diagnostic]) -> String {
    found.iter().map(|warning| warning_line(&sources.message(warning))).collect()
}

/// Returns a warning as a single line, because cargo accepts only single lines.
fn warning_line(warning: &JsonMessage<'_>) -> String {
    let place = warning.spans.first().map(|place| format!("{}:{}:{}: ", place.file, place.line, place.column));
    let help: String = warning.help.iter().map(|help| format!("; help: {help}")).collect();
    let text = format!("{}{}{help} [{}]", place.unwrap_or_default(), warning.message, warning.code.unwrap_or_default());
    format!("cargo::warning={}\n", Printable(text))
}

/// Returns the line that makes cargo watch `file`. Fails if the name contains a line break, because cargo would read
/// the text after the line break as another instruction.
fn watched(file: &Path) -> Result<String, EmbedError> {
    let line = format!("cargo::rerun-if-changed={}", file.display());
    if line.contains(['\n', '\r']) { Err(EmbedError::LineBreak(file.to_owned())) } else { Ok(line + "\n") }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::{EmbedError, plan, watched};

    #[test]
    fn a_name_with_a_line_break_is_refused() {
        assert_eq!(watched(Path::new("plans/round 1.mdle")).unwrap(), "cargo::rerun-if-changed=plans/round 1.mdle\n");
        for name in ["a\ncargo::rustc-link-arg=b", "a\r\nb"] {
            let refusal = watched(Path::new(name)).unwrap_err();
            assert!(refusal.to_string().contains("contains a line break"));
        }
    }

    #[test]
    fn a_plan_that_reads_modules_is_refused() {
        let file = std::env::temp_dir().join(format!("mdle-embed-modules-{}.mdle", std::process::id()));
        fs::write(&file, "{ Follow (bumper) (Atom (range(heading module) < 1m) (go 20 0)) }\n").unwrap();
        let refusal = plan(&file).target("sim").write_to(&file.with_extension("rs")).unwrap_err().to_string();
        fs::remove_file(file).unwrap();
        assert!(refusal.contains("error[E0403]: `range` reads modules, and an executable has none"), "{refusal}");
    }

    #[test]
    fn the_plan_itself_is_not_overwritten() {
        let file = std::env::temp_dir().join(format!("mdle-embed-{}.rs", std::process::id()));
        let text = "{ Rest (Atom (wait 1ms) stop) }\n";
        fs::write(&file, text).unwrap();
        let refusal = plan(&file).target("sim").write_to(&file).unwrap_err();
        assert!(matches!(refusal, EmbedError::OutputIsInput(_)), "{refusal}");
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
        fs::remove_file(file).unwrap();
    }
}
