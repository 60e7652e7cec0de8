//! Builds packages, and shows the progress on standard error.

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::Instant;

use mdle_runtime::Printable;

use super::{CommandFailure, report};
use crate::link::{self, BuildStep, Built, Cache, Package};

/// Builds a package, shows the progress, and prints a note about the executable that was built. `target` is the folder
/// of a third-party target.
pub(super) fn build_package(
    package: &Package<'_>,
    output: &Path,
    target: Option<&Path>,
    started: Instant,
) -> Result<(), CommandFailure> {
    let mut shown = ProgressOutput::default();
    let built = Cache::of_user()
        .and_then(|cache| link::build(&cache, package, output, &mut |progress| shown.progress(&progress)));
    shown.close();
    if !built.as_ref().is_ok_and(|built| built.fresh) {
        note_ignored(package.plan_file, target);
    }
    let Built { size, .. } = built?;
    let seconds = started.elapsed().as_secs_f64();
    let size = size as f64 / 1e6;
    report::note(format_args!("{}: built in {seconds:.2} s, {size:.1} MB", output.display()));
    Ok(())
}

/// Prints a note if builds ignore a configuration file of cargo or rustup that is near the plan or in the folder of its
/// target.
fn note_ignored(plan: &Path, target: Option<&Path>) {
    let beside = plan.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let folders: Vec<&Path> = target.into_iter().chain([beside]).collect();
    if let Some(file) = link::ignored_configuration(&folders) {
        report::note(format_args!(
            "{} has no effect: builds read the configuration in cargo's home only",
            file.display()
        ));
    }
}

/// Shows the progress. On a terminal, this is a single line that is overwritten; otherwise it is a line for each new
/// step.
#[derive(Default)]
pub(super) struct ProgressOutput {
    open: bool,
}

impl ProgressOutput {
    pub(super) fn progress(&mut self, progress: &BuildStep) {
        if report::is_json() {
            return;
        }
        let mut out = io::stderr().lock();
        // If standard error is closed, nobody sees the progress, so a write error is ignored.
        let _ = if out.is_terminal() {
            self.open = true;
            write!(out, "\r\x1b[K{}", Printable(progress))
        } else if progress.is_first() {
            writeln!(out, "{}", Printable(progress))
        } else {
            Ok(())
        };
    }

    pub(super) fn close(&mut self) {
        if std::mem::take(&mut self.open) {
            Self::wipe();
        }
    }

    /// Clears the current line of the terminal.
    pub(super) fn wipe() {
        let mut out = io::stderr().lock();
        if out.is_terminal() {
            let _ = write!(out, "\r\x1b[K");
        }
    }
}
