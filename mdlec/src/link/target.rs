//! The crate of a robot, and the packages on which a plan for the robot depends.
//!
//! A plan and its target must use the same package `mdle-runtime`, because Rust treats the same type in two packages as
//! two types. The path dependencies of a third-party target are therefore used for the plan as well. Dependencies of
//! the target that are named by version or come from git are replaced, for the plan and for the target, by the sources
//! that are part of mdlec.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::sources::{self, SHARED, SourcesCopy};
use super::{LinkError, toolchain};

/// Crate of a robot. The root of the crate exports a type as `Target`, for which the crate implements
/// `mdle_host::Target`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetCrate<'a> {
    /// A target that is part of mdlec.
    Builtin {
        /// Name of the target for `--target`.
        name: &'a str,
        /// Name of the crate in the target's alphabet.
        crate_name: &'a str,
    },
    /// A third-party target.
    Path {
        /// Folder of the crate's `Cargo.toml`.
        folder: &'a Path,
        /// Name of the crate in the target's alphabet.
        crate_name: &'a str,
    },
}

impl<'a> TargetCrate<'a> {
    /// Returns the name of the crate in the target's alphabet.
    #[must_use]
    pub fn crate_name(&self) -> &'a str {
        match self {
            Self::Builtin { crate_name, .. } | Self::Path { crate_name, .. } => crate_name,
        }
    }

    /// Fails if `output` is a file in the folder of a third-party crate, unless it is an executable. Executables may be
    /// overwritten, because users build plans in that folder.
    pub(super) fn must_not_lose(&self, output: &Path) -> Result<(), LinkError> {
        let Self::Path { folder, .. } = self else { return Ok(()) };
        let is_inside = output.canonicalize().is_ok_and(|output| {
            folder.canonicalize().is_ok_and(|folder| output.starts_with(folder)) && !is_executable(&output)
        });
        if is_inside { Err(LinkError::OutputIsInput(output.to_owned())) } else { Ok(()) }
    }
}

/// Returns `true` if `file` begins with the magic number of an ELF file, as executables of Linux do.
fn is_executable(file: &Path) -> bool {
    let mut start = [0; 4];
    File::open(file).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == *b"\x7fELF"
}

/// Dependencies of a plan's package.
#[derive(Debug)]
pub(super) struct Dependencies {
    /// Names of packages, with their folders.
    pub(super) packages: Vec<(String, PathBuf)>,
    /// Packages of the target that are replaced. Each entry contains the source that `[patch]` names, the name of the
    /// package, and the folder to use instead.
    pub(super) patches: Vec<(String, String, PathBuf)>,
    /// Initial lock file of the package.
    pub(super) lock: String,
    /// Text that distinguishes this target from all others.
    pub(super) identity: String,
    /// Folder of mdlec's own sources; a compile error in them is a bug in mdlec.
    pub(super) ours: PathBuf,
}

/// Returns the dependencies of a plan for `target`.
pub(super) fn dependencies(target: &TargetCrate<'_>, sources: &SourcesCopy) -> Result<Dependencies, LinkError> {
    match target {
        TargetCrate::Builtin { name, crate_name } => builtin(name, crate_name, sources),
        TargetCrate::Path { folder, crate_name } => by_path(folder, crate_name, sources),
    }
}

/// Returns the dependencies of a built-in target, all from the unpacked sources.
fn builtin(name: &str, crate_name: &str, sources: &SourcesCopy) -> Result<Dependencies, LinkError> {
    let (folder, package) = sources::builtin(name)
        .filter(|(_, package)| package.replace('-', "_") == crate_name)
        .ok_or_else(|| LinkError::NoSuchTarget(name.to_owned()))?;
    let mut packages: Vec<_> =
        SHARED.iter().map(|(name, folder)| ((*name).to_owned(), sources.folder.join(folder))).collect();
    packages.push((package.to_owned(), sources.folder.join(&folder)));
    // A target that is a separate workspace has its own lock file.
    let own = sources::text(&format!("{folder}/{}", sources::LOCK));
    let lock = if own.is_empty() { sources::text(sources::LOCK) } else { own };
    Ok(Dependencies {
        packages,
        patches: Vec::new(),
        lock: lock.to_owned(),
        identity: name.to_owned(),
        ours: sources.folder.clone(),
    })
}

/// Returns the dependencies of a scenario and of a plan with the engine: only the package that runs both. It includes
/// all robots and the compiler.
pub(super) fn engine_dependencies(sources: &SourcesCopy) -> Dependencies {
    let (name, folder) = sources::RUNNER;
    Dependencies {
        packages: vec![(name.to_owned(), sources.folder.join(folder))],
        patches: Vec::new(),
        lock: sources::text(sources::LOCK).to_owned(),
        identity: "engine".to_owned(),
        ours: sources.folder.clone(),
    }
}

/// Returns the dependencies of the emulator of `robot`.
pub(super) fn emulator_dependencies(robot: &str, sources: &SourcesCopy) -> Result<Dependencies, LinkError> {
    let (folder, package) = sources::emulator(robot).ok_or_else(|| LinkError::NoSuchTarget(robot.to_owned()))?;
    Ok(Dependencies {
        packages: vec![(package.to_owned(), sources.folder.join(folder))],
        patches: Vec::new(),
        lock: sources::text(sources::LOCK).to_owned(),
        identity: robot.to_owned(),
        ours: sources.folder.clone(),
    })
}

/// Returns the dependencies of a plan for a third-party target. The target's manifest selects them.
fn by_path(folder: &Path, crate_name: &str, sources: &SourcesCopy) -> Result<Dependencies, LinkError> {
    let manifest = folder.join("Cargo.toml").canonicalize().map_err(|_| LinkError::NotACrate(folder.to_owned()))?;
    let metadata = read(&manifest, crate_name)?;
    let own = metadata.packages.iter().find(|package| package.manifest_path == manifest);
    let own = own.ok_or_else(|| LinkError::NotACrate(folder.to_owned()))?;
    own.makes(folder, crate_name)?;

    let mut packages = Vec::new();
    let mut patches = Vec::new();
    let by_path = own.dependencies.iter().any(|dependency| dependency.path.is_some() && dependency.is_shared());
    for (name, ours) in SHARED {
        let ours = sources.folder.join(ours);
        match own.dependencies.iter().find(|dependency| dependency.name == name && dependency.kind.is_none()) {
            Some(Dependency { path: Some(path), .. }) => packages.push((name.to_owned(), path.clone())),
            Some(dependency) => {
                patches.push((dependency.patched_source(), name.to_owned(), ours.clone()));
                packages.push((name.to_owned(), ours));
            }
            // A target with path dependencies brings its own package of atoms, or uses none.
            None if name == "mdle-atoms" && by_path => {}
            None if name == "mdle-atoms" => packages.push((name.to_owned(), ours)),
            None => return Err(LinkError::TargetLacks { crate_name: crate_name.to_owned(), missing: name }),
        }
    }
    packages.push((own.name.clone(), manifest.parent().unwrap_or(folder).to_owned()));
    // A target without a lock file is built with the versions in mdlec's lock file, where these fit its dependencies.
    let lock = fs::read_to_string(metadata.workspace_root.join(sources::LOCK));
    Ok(Dependencies {
        packages,
        patches,
        lock: lock.unwrap_or_else(|_| sources::text(sources::LOCK).to_owned()),
        identity: utf8(&manifest)?.to_owned(),
        ours: sources.folder.clone(),
    })
}

/// Runs `cargo metadata` for the package at `manifest`, including the settings that come from its workspace.
fn read(manifest: &Path, crate_name: &str) -> Result<Metadata, LinkError> {
    let mut command = toolchain::command("cargo");
    command
        .args(["metadata", "--no-deps", "--offline", "--color=never", "--format-version=1", "--manifest-path"])
        .arg(manifest);
    let refused = |text| LinkError::TargetRefused { crate_name: crate_name.to_owned(), text };
    let found = toolchain::output(command, "cargo")?;
    if !found.status.success() {
        return Err(refused(String::from_utf8_lossy(&found.stderr).trim_end().to_owned()));
    }
    serde_json::from_slice(&found.stdout).map_err(|error| refused(error.to_string()))
}

/// Returns a path as text for a manifest.
pub(super) fn utf8(path: &Path) -> Result<&str, LinkError> {
    path.to_str().ok_or_else(|| LinkError::NotUtf8(path.to_owned()))
}

/// The part of the output of `cargo metadata` that mdlec uses.
#[derive(Debug, Deserialize)]
struct Metadata {
    packages: Vec<Described>,
    workspace_root: PathBuf,
}

/// A package of the target's workspace.
#[derive(Debug, Deserialize)]
struct Described {
    name: String,
    manifest_path: PathBuf,
    targets: Vec<BuiltCrate>,
    dependencies: Vec<Dependency>,
}

/// A crate that a package builds.
#[derive(Debug, Deserialize)]
struct BuiltCrate {
    name: String,
    kind: Vec<String>,
}

/// A dependency in the manifest; `kind` is null for a dependency of the library.
#[derive(Debug, Deserialize)]
struct Dependency {
    name: String,
    kind: Option<String>,
    source: Option<String>,
    registry: Option<String>,
    path: Option<PathBuf>,
}

impl Described {
    /// Checks that the package's library is the crate that the alphabet names.
    fn makes(&self, folder: &Path, crate_name: &str) -> Result<(), LinkError> {
        let library = self.targets.iter().find(|made| made.kind.iter().any(|kind| kind == "lib"));
        if library.is_some_and(|library| library.name == crate_name) {
            return Ok(());
        }
        let found = library.map_or_else(|| "no library".to_owned(), |library| format!("`{}`", library.name));
        Err(LinkError::OtherCrate { folder: folder.to_owned(), name: crate_name.to_owned(), found })
    }
}

impl Dependency {
    /// Returns `true` for a package on which every plan depends.
    fn is_shared(&self) -> bool {
        self.kind.is_none() && SHARED.iter().any(|(name, _)| *name == self.name)
    }

    /// Returns the source of the dependency, in the form in which a `[patch]` table names it.
    fn patched_source(&self) -> String {
        let source = self.source.as_deref().unwrap_or_default();
        if self.registry.is_none() && !source.starts_with("git+") {
            return "crates-io".to_owned();
        }
        let url = source.split_once('+').map_or(source, |(_, url)| url);
        url.split(['?', '#']).next().unwrap_or(url).to_owned()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::tests::cache;
    use super::{Dependency, SourcesCopy, TargetCrate, dependencies};

    #[test]
    fn what_a_target_has_by_path_the_plan_takes_from_there() {
        let cache = cache("by_path");
        let sources = SourcesCopy::unpack(&cache).unwrap();
        let package = |folder: &str, manifest: &str| {
            let folder = cache.folder().join(folder);
            fs::create_dir_all(folder.join("src")).unwrap();
            fs::write(folder.join("src/lib.rs"), "").unwrap();
            fs::write(folder.join("Cargo.toml"), manifest).unwrap();
            folder
        };
        package("mine/core", "[package]\nname = \"mdle-runtime\"\n");
        package("mine/host", "[package]\nname = \"mdle-host\"\n");
        let manifest = "[workspace]\n[package]\nname = \"mdle-rover\"\n[dependencies]\n\
             mdle-runtime = { path = \"../mine/core\" }\nmdle-host = { path = \"../mine/host\" }\n";
        let folder = package("rover", manifest);
        fs::write(folder.join("Cargo.lock"), "# theirs").unwrap();

        let target = TargetCrate::Path { folder: &folder, crate_name: "mdle_rover" };
        let found = dependencies(&target, &sources).unwrap();
        let names = ["mdle-runtime", "mdle-host", "mdle-rover"];
        let folders = [cache.folder().join("mine/core"), cache.folder().join("mine/host"), folder];
        let expected: Vec<_> = names.map(str::to_owned).into_iter().zip(folders).collect();
        assert_eq!(found.packages, expected);
        assert!(found.patches.is_empty());
        assert_eq!(found.lock, "# theirs");
    }

    #[test]
    fn sources_are_called_as_a_patch_calls_them() {
        let called = |source: &str, registry: Option<&str>| {
            let (source, registry) = (Some(source.to_owned()), registry.map(str::to_owned));
            Dependency { name: String::new(), kind: None, source, registry, path: None }.patched_source()
        };
        assert_eq!(called("registry+https://default.example/index", None), "crates-io");
        assert_eq!(called("git+https://host.example/mdle?branch=main#0f", None), "https://host.example/mdle");
        let other = "https://other.example/index";
        assert_eq!(called("registry+https://other.example/index", Some(other)), other);
    }
}
