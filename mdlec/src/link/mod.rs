//! Builds a static executable from generated Rust code or from the files of a scenario. For this, it writes a cargo
//! package and runs cargo.
//!
//! All files are in the [`Cache`]. The sources of executables are part of mdlec and are unpacked there once. An
//! installed mdlec therefore needs no checkout and, once cargo has fetched the libraries, no network:
//!
//! ```text
//! lock                    locked while an mdlec works; contains the number of its process
//! compiled                the hashes of the files in target/
//! src-VERSION-HASH/       the unpacked sources; those of versions that are no longer used are removed
//! target/                 the build results of cargo, for all plans
//! tmp/                    temporary files of the current build
//! plans/plan-NAME-HASH/   the package of a plan; HASH is of its text as Rust, of the target and of the machine
//! ```
//!
//! Only its user has access to the cache. mdlec repairs damage in it: it compares its own files byte by byte and build
//! results by their hash, and compiles everything again if cargo cannot read the remaining files.
//!
//! Builds are reproducible: the bytes of an executable depend on the text of the plan, on mdlec, on the target, on
//! Rust's version and on the path of the cache, but not on the plan's folder or on earlier builds. The path of the
//! cache matters because cargo derives the symbols of a package's code from the path of the package.
//!
//! Libraries have the versions of mdlec's own lock file, and compiler flags are the same in every environment. The
//! paths of the cache, of cargo's home and of the user's home do not get into the executable.
#![allow(clippy::disallowed_methods, reason = "what is done here is I/O")]

mod access;
mod build_failure;
mod build_record;
mod cache;
mod cache_damage;
mod cargo;
mod cleanup;
mod clear;
mod error;
mod guard;
mod hash;
mod ignored;
mod machine;
mod messages;
mod output;
mod package;
mod plan_package;
mod progress;
mod seal;
mod sources;
mod superseded;
mod target;
mod toolchain;

use std::fs::File;
use std::path::{Path, PathBuf};

pub use cache::Cache;
pub use cleanup::leave_nothing_behind;
pub use clear::clear;
pub use error::LinkError;
pub use ignored::ignored_configuration;
pub use output::{must_not_be_read, write_whole};
pub use progress::BuildStep;
pub use sources::{emulators, known};
pub use target::TargetCrate;

use cargo::PackageBuild;
use machine::BuildMachine;
use messages::{CachedExecutable, CargoResult};
use output::OutputFile;
use seal::Seal;
use sources::SourcesCopy;
use target::Dependencies;
use toolchain::Toolchain;

/// A plan as Rust code, or a scenario or a plan as its files, with the data that its executable needs.
#[derive(Debug, Clone, Copy)]
pub struct Package<'a> {
    /// Name of the plan or of the scenario, which the executable shows.
    pub plan_name: &'a str,
    /// Version text of the plan, its target and mdlec, for the executable's answer to `--version`.
    pub version: &'a str,
    /// File of the plan or of the scenario.
    pub plan_file: &'a Path,
    /// Files that were read; the executable must not overwrite them.
    pub inputs: &'a [PathBuf],
    /// Item of the generated Rust code that the executable runs.
    pub entry: Entry<'a>,
    /// The generated Rust code, without inner attributes.
    pub rust: &'a str,
    /// Crate of the robot.
    pub target: &'a TargetCrate<'a>,
    /// Machine that will run the executable, as a target triple or a short name; `None` for this machine.
    pub machine: Option<&'a str>,
}

/// Item of generated Rust code that an executable runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry<'a> {
    /// Type that implements a plan.
    Plan(&'a str),
    /// Constant `FILES`, the names and contents of a scenario's files.
    Scenario,
    /// Constant `FILES`, the names and texts of a plan's files, which an engine runs.
    Engine {
        /// Name of the target.
        target: &'a str,
        /// Name of the plan; `None` means the only plan that no other plan uses.
        plan: Option<&'a str>,
    },
}

/// A built executable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Built {
    /// Size of the executable, in bytes.
    pub size: u64,
    /// `true` if the executable was already in the cache, from an earlier build of the same text.
    pub fresh: bool,
}

/// Builds the executable of `package` and writes it to `output`, completely or not at all.
///
/// # Errors
/// Fails if `output` cannot be written, which is checked before the build; if the target's crate does not compile; if
/// this machine lacks something that the build for `package.machine` needs; or if mdlec has generated invalid Rust
/// code.
pub fn build(
    cache: &Cache,
    package: &Package<'_>,
    output: &Path,
    progress: &mut dyn FnMut(BuildStep),
) -> Result<Built, LinkError> {
    let destination = OutputFile::check(output, package.inputs)?;
    package.target.must_not_lose(output)?;
    let locked = cache.lock(progress)?;
    let toolchain = Toolchain::find()?;
    let machine = BuildMachine::find(package.machine, &toolchain.host)?;
    let sources = SourcesCopy::unpack(cache)?;
    let dependencies = match package.entry {
        Entry::Plan(_) => target::dependencies(package.target, &sources)?,
        Entry::Scenario | Entry::Engine { .. } => target::engine_dependencies(&sources),
    };
    let plan = package::write(cache, package, &dependencies, &toolchain, &machine)?;
    superseded::remove_before(cache, package.plan_file, &machine, &plan)?;
    let job = PackageBuild { cache, machine: &machine, plan: &plan };
    let executable = make(&job, package.target, &dependencies, progress)?;
    let size = destination.copy(&executable.path)?;
    // The lock is held until here, because another build of this plan would overwrite the executable.
    drop(locked);
    Ok(Built { size, fresh: executable.fresh })
}

/// A robot emulator in the cache.
#[derive(Debug)]
pub struct Emulator {
    /// Path of the executable.
    pub path: PathBuf,
    /// Lock that prevents other builds from overwriting the executable. It is released when this process becomes the
    /// emulator.
    _locked: File,
}

/// Builds the emulator of `robot`, which is one of [`emulators`].
///
/// # Errors
/// Fails if this machine lacks something that a build needs, or if `robot` has no emulator.
pub fn emulator(cache: &Cache, robot: &str, progress: &mut dyn FnMut(BuildStep)) -> Result<Emulator, LinkError> {
    let locked = cache.lock(progress)?;
    let machine = BuildMachine::host(&Toolchain::find()?.host);
    let sources = SourcesCopy::unpack(cache)?;
    let dependencies = target::emulator_dependencies(robot, &sources)?;
    let crate_name: String = dependencies.packages.iter().map(|(package, _)| package.replace('-', "_")).collect();
    let package = package::write_emulator(cache, robot, &crate_name, &dependencies)?;
    let job = PackageBuild { cache, machine: &machine, plan: &package };
    let target = TargetCrate::Builtin { name: robot, crate_name: &crate_name };
    let executable = make(&job, &target, &dependencies, progress)?;
    Ok(Emulator { path: executable.path, _locked: locked })
}

/// Builds the executable of a package; the executable remains in the cache.
fn make(
    job: &PackageBuild<'_>,
    target: &TargetCrate<'_>,
    dependencies: &Dependencies,
    progress: &mut dyn FnMut(BuildStep),
) -> Result<CachedExecutable, LinkError> {
    let run = run(job, target, progress)?;
    match &run.executable {
        Some(executable) if run.status.success() => {
            build_record::write(job.plan, &executable.path)?;
            Ok(executable.clone())
        }
        Some(_) | None => Err(build_failure::fault(job, &run, target, dependencies)),
    }
}

/// Runs cargo. If the result shows damage in the cache, removes the damaged part and runs cargo again.
fn run(
    job: &PackageBuild<'_>,
    target: &TargetCrate<'_>,
    progress: &mut dyn FnMut(BuildStep),
) -> Result<CargoResult, LinkError> {
    let mut mended = Vec::new();
    let mut seal = Seal::check(job.cache, progress)?;
    loop {
        let run = job.build(&mut seal, progress)?;
        match cache_damage::found(job, &run, target) {
            Some(damage) if !mended.contains(&damage) => {
                cache_damage::clear(damage, job, progress)?;
                mended.push(damage);
            }
            Some(_) | None => return Ok(run),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::Cache;

    /// Returns an empty folder in cargo's output folder for the test of this name.
    pub(super) fn folder(name: &str) -> PathBuf {
        let folder = Path::new(env!("OUT_DIR")).join("link-tests").join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder.canonicalize().unwrap()
    }

    /// Returns an empty cache for the test of this name.
    pub(super) fn cache(name: &str) -> Cache {
        Cache::at(&folder(name)).unwrap()
    }
}
