//! The robot's crate, and the packages that a plan for it is built on.
//!
//! A plan and its target must meet the same `mdle-runtime`: one type of that name in two packages is two types. So a
//! target of a third party decides. What it has by path is taken from there for the plan as well; what it has by
//! version or from git is replaced, in its crate too, by the sources that came with mdlec.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::cargo;
use super::sources::{self, SHARED, Sources};
use super::{LinkError, package};

/// The crate of a robot. It implements `mdle_host::Target` for a type that its root exports as `Target`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TargetCrate<'a> {
    /// One that came with mdlec.
    Builtin {
        /// What `--target` calls it.
        name: &'a str,
        /// The crate that its alphabet names.
        crate_name: &'a str,
    },
    /// A third party's.
    Path {
        /// The folder of its Cargo.toml.
        folder: &'a Path,
        /// The crate that its alphabet names.
        crate_name: &'a str,
    },
}

impl<'a> TargetCrate<'a> {
    /// The crate that its alphabet names.
    #[must_use]
    pub fn crate_name(&self) -> &'a str {
        match self {
            Self::Builtin { crate_name, .. } | Self::Path { crate_name, .. } => crate_name,
        }
    }

    /// Refuses an `output` that is a file of a third party's crate. An executable there may be written over: its folder is a
    /// good place to build plans in.
    pub(super) fn must_not_lose(&self, output: &Path) -> Result<(), LinkError> {
        let Self::Path { folder, .. } = self else { return Ok(()) };
        let is_inside = output.canonicalize().is_ok_and(|output| {
            folder.canonicalize().is_ok_and(|folder| output.starts_with(folder)) && !is_executable(&output)
        });
        if is_inside { Err(LinkError::OutputIsInput(output.to_owned())) } else { Ok(()) }
    }
}

/// Returns `true` if `file` begins as an executable of Linux does.
fn is_executable(file: &Path) -> bool {
    let mut start = [0; 4];
    File::open(file).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == *b"\x7fELF"
}

/// What the package of a plan depends on.
#[derive(Debug)]
pub(super) struct Dependencies {
    /// Package names with their folders.
    pub(super) packages: Vec<(String, PathBuf)>,
    /// Packages of the target to replace: the source as `[patch]` names it, the package, the folder instead.
    pub(super) patches: Vec<(String, String, PathBuf)>,
    /// The lock file to start from.
    pub(super) lock: String,
    /// What tells this target from others.
    pub(super) identity: String,
    /// The folder of the sources that came with mdlec: a fault in there is ours.
    pub(super) ours: PathBuf,
}

/// Finds out what a plan for `target` is built on.
pub(super) fn dependencies(target: &TargetCrate<'_>, sources: &Sources) -> Result<Dependencies, LinkError> {
    match target {
        TargetCrate::Builtin { name, crate_name } => builtin(name, crate_name, sources),
        TargetCrate::Path { folder, crate_name } => by_path(folder, crate_name, sources),
    }
}

/// Everything from the unpacked sources.
fn builtin(name: &str, crate_name: &str, sources: &Sources) -> Result<Dependencies, LinkError> {
    let (folder, package) = sources::builtin(name)
        .filter(|(_, package)| package.replace('-', "_") == crate_name)
        .ok_or_else(|| LinkError::NoSuchTarget(name.to_owned()))?;
    let mut packages: Vec<_> =
        SHARED.iter().map(|(name, folder)| ((*name).to_owned(), sources.folder.join(folder))).collect();
    packages.push((package.to_owned(), sources.folder.join(folder)));
    Ok(Dependencies {
        packages,
        patches: Vec::new(),
        lock: sources::text(sources::LOCK).to_owned(),
        identity: name.to_owned(),
        ours: sources.folder.clone(),
    })
}

/// Finds out what the emulator of `robot` is built on.
pub(super) fn emulator_dependencies(robot: &str, sources: &Sources) -> Result<Dependencies, LinkError> {
    let (folder, package) = sources::emulator(robot).ok_or_else(|| LinkError::NoSuchTarget(robot.to_owned()))?;
    Ok(Dependencies {
        packages: vec![(package.to_owned(), sources.folder.join(folder))],
        patches: Vec::new(),
        lock: sources::text(sources::LOCK).to_owned(),
        identity: robot.to_owned(),
        ours: sources.folder.clone(),
    })
}

/// The target's own choice.
fn by_path(folder: &Path, crate_name: &str, sources: &Sources) -> Result<Dependencies, LinkError> {
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
            // Atoms of the target's own choice come by way of the target, or not at all.
            None if name == "mdle-atoms" && by_path => {}
            None if name == "mdle-atoms" => packages.push((name.to_owned(), ours)),
            None => return Err(LinkError::TargetLacks { crate_name: crate_name.to_owned(), missing: name }),
        }
    }
    packages.push((own.name.clone(), manifest.parent().unwrap_or(folder).to_owned()));
    // Without a lock file of its own the target is built with the versions of mdlec's, as far as they are the same.
    let lock = fs::read_to_string(metadata.workspace_root.join(sources::LOCK));
    Ok(Dependencies {
        packages,
        patches,
        lock: lock.unwrap_or_else(|_| sources::text(sources::LOCK).to_owned()),
        identity: package::utf8(&manifest)?.to_owned(),
        ours: sources.folder.clone(),
    })
}

/// What cargo says of the package at `manifest`, with everything that it takes from its workspace filled in.
fn read(manifest: &Path, crate_name: &str) -> Result<Metadata, LinkError> {
    let mut command = cargo::command("cargo");
    command
        .args(["metadata", "--no-deps", "--offline", "--color=never", "--format-version=1", "--manifest-path"])
        .arg(manifest);
    let refused = |text| LinkError::TargetRefused { crate_name: crate_name.to_owned(), text };
    let found = cargo::output(command, "cargo")?;
    if !found.status.success() {
        return Err(refused(String::from_utf8_lossy(&found.stderr).trim_end().to_owned()));
    }
    serde_json::from_slice(&found.stdout).map_err(|error| refused(error.to_string()))
}

/// The part of `cargo metadata` that is read.
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
    targets: Vec<Made>,
    dependencies: Vec<Dependency>,
}

/// A crate that a package makes.
#[derive(Debug, Deserialize)]
struct Made {
    name: String,
    kind: Vec<String>,
}

/// A dependency as the manifest has it; `kind` is null for one of the library.
#[derive(Debug, Deserialize)]
struct Dependency {
    name: String,
    kind: Option<String>,
    source: Option<String>,
    registry: Option<String>,
    path: Option<PathBuf>,
}

impl Described {
    /// Its library must be the crate that the alphabet names.
    fn makes(&self, folder: &Path, crate_name: &str) -> Result<(), LinkError> {
        let library = self.targets.iter().find(|made| made.kind.iter().any(|kind| kind == "lib"));
        if library.is_some_and(|library| library.name == crate_name) {
            return Ok(());
        }
        let found = library.map_or_else(|| "no library".to_owned(), |library| format!("`{}`", library.name));
        Err(LinkError::OtherCrate { folder: folder.to_owned(), said: crate_name.to_owned(), found })
    }
}

impl Dependency {
    /// Whether it is one of the packages that every plan is built on.
    fn is_shared(&self) -> bool {
        self.kind.is_none() && SHARED.iter().any(|(name, _)| *name == self.name)
    }

    /// Where it comes from, as a `[patch]` table is called.
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
    use super::{Dependency, Sources, TargetCrate, dependencies};

    #[test]
    fn what_a_target_has_by_path_the_plan_takes_from_there() {
        let cache = cache("by_path");
        let sources = Sources::unpack(&cache).unwrap();
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
