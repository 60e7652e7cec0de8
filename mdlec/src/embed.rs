//! Embeds plans in an application: the application's build script compiles them to Rust, and the application includes
//! that.
//!
//! ```no_run
//! // build.rs
//! mdlec::embed::plan("plans/dock.mdle").target("sim").write();
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
//! The package has `mdlec` among its `[build-dependencies]`, and among its `[dependencies]` what the Rust refers to:
//! `mdle-runtime` and the target's crate, here `mdle-sim`. [`write`](Embed::write) makes one type of the plan, which
//! implements `mdle_runtime::Plan`: `mdle_host::run` runs it as an executable that `mdlec` makes, and
//! `mdle_runtime::Machine` turn by turn.

use std::path::PathBuf;
use std::process;

use crate::cli;

/// A plan to embed.
#[derive(Debug, Clone)]
#[must_use = "nothing is embedded before it is written"]
pub struct Embed {
    file: PathBuf,
    target: Option<String>,
    plan: Option<String>,
}

/// Embeds a plan of this file; a path is relative to the folder of the package.
pub fn plan(file: impl Into<PathBuf>) -> Embed {
    Embed { file: file.into(), target: None, plan: None }
}

impl Embed {
    /// Sets the robot, which is required: one of `mdlec targets`, or the folder of a target of your own.
    pub fn target(self, target: impl Into<String>) -> Self {
        Self { target: Some(target.into()), ..self }
    }

    /// Selects a plan of the file; required if several plans are not used by any other.
    pub fn plan(self, name: impl Into<String>) -> Self {
        Self { plan: Some(name.into()), ..self }
    }

    /// Writes `$OUT_DIR/STEM.rs`, where `STEM` is the plan file's name without its extension; embedding two plans of
    /// one file overwrites the first. Makes cargo show the warnings, and run the build script again when a file changes
    /// that was read: the plan, the files that it uses, and the alphabet of a target of your own.
    ///
    /// If the plan has errors, this process ends with exit status 1 and prints the messages of `mdlec check` on
    /// standard error; if the plan's file or the target cannot be read, or the Rust cannot be written, it ends with 2.
    pub fn write(self) {
        if let Err(status) = cli::embed(&self.file, self.target.as_deref(), self.plan.as_deref()) {
            process::exit(status.into());
        }
    }
}
