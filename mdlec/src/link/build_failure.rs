//! Finds the cause of a failed build: the plan, the target's crate, the machine or mdlec.

use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};

use super::cargo::PackageBuild;
use super::messages::{CargoResult, Complaint, NO_LINKER};
use super::target::Dependencies;
use super::{LinkError, TargetCrate};

/// Message of cargo when the network does not answer.
const NETWORK: &str = "spurious network error";

/// Messages of rustc when there is no linker, or when the linker fails.
const LINKER: [&str; 2] = [NO_LINKER, "error: linking with `"];

/// Returns the error that explains why a run of cargo ended without an executable.
pub(super) fn fault(
    job: &PackageBuild<'_>,
    run: &CargoResult,
    target: &TargetCrate<'_>,
    dependencies: &Dependencies,
) -> LinkError {
    let text = run.text();
    if run.lacks_room() {
        return LinkError::DiskFull(job.cache.folder().to_owned());
    }
    if let Some(signal) = run.status.signal() {
        return LinkError::Stopped(u8::try_from(signal).unwrap_or(u8::MAX));
    }
    // mdlec did not pass `--offline` to this run, so cargo's message means that the user's configuration forbids the
    // network.
    if run.online && run.lacks_libraries() {
        return LinkError::Offline;
    }
    let log = match job.plan.keep(&text) {
        Ok(log) => log,
        Err(error) => return error,
    };
    if run.is_cargo_broken() {
        return LinkError::Cargo { log, cache: job.cache.folder().to_owned() };
    }
    let errors = run.complaints.iter().filter(|complaint| complaint.is_error);
    let (plan, ours) = (job.plan.manifest(), &dependencies.ours);
    if let Some(error) = errors.clone().find(|error| LINKER.iter().any(|sign| error.text.starts_with(sign))) {
        return linker(error, &plan, job.machine.foreign(), log);
    }
    // The first crate that fails is the cause: crates that depend on it are not compiled.
    match errors.map(|error| &error.manifest).next() {
        Some(manifest) if *manifest == plan => emitted(target, log),
        Some(manifest) if manifest.starts_with(ours) => LinkError::Packed { folder: ours.clone(), log },
        Some(_) | None => {
            others(job, run, target, &text, log, &|manifest| *manifest == plan || manifest.starts_with(ours))
        }
    }
}

/// Returns the error for a linker that failed. If the error occurred while the executable of the package `plan` was
/// linked, this is the linker for the machine `foreign`. Otherwise it is the linker for this machine.
fn linker(error: &Complaint, plan: &Path, foreign: Option<&str>, log: PathBuf) -> LinkError {
    // In other packages, only build scripts and procedural macros are linked, and these run on this machine.
    match foreign.filter(|_| error.manifest == plan) {
        Some(triple) => LinkError::MachineLinker { triple: triple.to_owned(), log },
        None => LinkError::Linker { log },
    }
}

/// Returns the error for Rust code of mdlec that does not compile.
fn emitted(target: &TargetCrate<'_>, log: PathBuf) -> LinkError {
    match target {
        TargetCrate::Builtin { .. } => LinkError::Emitted { log },
        // More often, the cause is a crate that is out of date with its alphabet.
        TargetCrate::Path { crate_name, .. } => LinkError::TargetMisfit { crate_name: (*crate_name).to_owned(), log },
    }
}

/// Returns the error for a run in which cargo did not begin to compile, or in which a crate that mdlec has not
/// generated does not compile.
fn others(
    job: &PackageBuild<'_>,
    run: &CargoResult,
    target: &TargetCrate<'_>,
    text: &str,
    log: PathBuf,
    is_ours: &dyn Fn(&PathBuf) -> bool,
) -> LinkError {
    match target {
        TargetCrate::Builtin { .. } | TargetCrate::Path { .. } if !run.began && text.contains(NETWORK) => {
            LinkError::NoLibraries { log }
        }
        TargetCrate::Builtin { .. } if !run.began && run.online => LinkError::NoLibraries { log },
        TargetCrate::Builtin { .. } => LinkError::Cargo { log, cache: job.cache.folder().to_owned() },
        TargetCrate::Path { crate_name, .. } if !run.began => {
            LinkError::TargetRefused { crate_name: (*crate_name).to_owned(), text: run.stderr.trim_end().to_owned() }
        }
        TargetCrate::Path { crate_name, .. } => {
            let theirs = run.complaints.iter().filter(|complaint| !is_ours(&complaint.manifest));
            let theirs: String = theirs.map(|complaint| complaint.text.as_str()).collect();
            // If a build script fails, only cargo reports it.
            let output = if run.complaints.iter().any(|complaint| complaint.is_error) { theirs.as_str() } else { text };
            LinkError::TargetBroken { crate_name: (*crate_name).to_owned(), text: output.trim_end().to_owned() }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Complaint, LinkError, linker};

    #[test]
    fn build_scripts_need_the_linker_of_this_machine() {
        let plan = Path::new("plans/plan/Cargo.toml");
        let fault = |manifest: &str, foreign| {
            let text = "error: linker `cc` not found\n".to_owned();
            linker(&Complaint { manifest: manifest.into(), is_error: true, text }, plan, foreign, "build.log".into())
        };
        let script = "registry/quote/Cargo.toml";
        assert!(matches!(fault(script, Some("armv7")), LinkError::Linker { .. }));
        assert!(matches!(fault(script, None), LinkError::Linker { .. }));
        assert!(matches!(fault("plans/plan/Cargo.toml", None), LinkError::Linker { .. }));
        let own = fault("plans/plan/Cargo.toml", Some("armv7"));
        assert!(matches!(own, LinkError::MachineLinker { triple, .. } if triple == "armv7"));
    }
}
