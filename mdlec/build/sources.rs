//! Embeds in mdlec the sources from which executables are built, so that an installed mdlec needs no checkout. Writes
//! the sources as a table, which `link::sources` includes.

use std::error::Error;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use crate::targets::{checkout, manifest, targets};

/// Packages that are embedded in addition to those of the targets: targets share them, or scenarios need them.
const SHARED: [&str; 13] = [
    "runtime/core",
    "runtime/quantity",
    "runtime/sound",
    "runtime/record",
    "runtime/host",
    "runtime/serial",
    "atoms",
    "atoms/conformance",
    "targets/sim/simulator",
    "runtime/engine",
    "runtime/mdle",
    "mdlec/compiler",
    "mdlec/files",
];

/// Names of folders that are not embedded, because no build of an executable reads them. Nested packages are not
/// embedded with the enclosing package either.
const LEFT_OUT: [&str; 5] = ["tests", "benches", "examples", "snapshots", "target"];

/// Name of a workspace's lock file.
const LOCK: &str = "Cargo.lock";

/// Name of two kinds of folders: `targets/emulator` contains the package that all robot emulators share, and
/// `targets/NAME/emulator` contains the emulator of a target.
const EMULATOR: &str = "emulator";

/// Writes `$OUT_DIR/sources.rs`: the files with their contents, a hash of all files, the targets, and the emulators of
/// targets.
pub(crate) fn pack() -> Result<(), Box<dyn Error>> {
    let root = checkout("..")?;
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let targets = targets(&root)?;
    let emulated = targets.iter().filter(|name| manifest(&root.join("targets").join(name).join(EMULATOR)).is_some());
    let emulated: Vec<_> = emulated.cloned().collect();
    let mut packages: Vec<_> = SHARED.into_iter().map(str::to_owned).collect();
    packages.extend(targets.iter().map(|name| format!("targets/{name}")));
    packages.push(format!("targets/{EMULATOR}"));
    packages.extend(emulated.iter().map(|name| format!("targets/{name}/{EMULATOR}")));

    // A target with its own lock file is a separate workspace, with libraries that no other plan needs.
    let is_apart = |package: &String| root.join(package).join(LOCK).is_file();
    let (apart, members): (Vec<_>, Vec<_>) = packages.iter().cloned().partition(is_apart);
    let reduced = out.join("workspace.toml");
    fs::write(&reduced, workspace(&root, &members, &apart)?)?;
    let mut files = vec![("Cargo.toml".to_owned(), reduced), (LOCK.to_owned(), root.join(LOCK))];
    for package in &packages {
        println!("cargo::rerun-if-changed={}", root.join(package).display());
        collect(&root.join(package), package, &mut files)?;
    }
    for watched in ["Cargo.toml", LOCK, "targets"] {
        println!("cargo::rerun-if-changed={}", root.join(watched).display());
    }
    for (name, path) in &mut files {
        if name.ends_with("/Cargo.toml") {
            let reduced = out.join(name.replace('/', "_"));
            fs::write(&reduced, manifest_of(&fs::read_to_string(&*path)?)?)?;
            *path = reduced;
        }
    }
    files.sort();
    fs::write(out.join("sources.rs"), table(&root, &files, &targets, &emulated)?)?;
    Ok(())
}

/// Returns the root manifest with only `packages` as members. The packages `apart` are excluded, because each of them
/// is a separate workspace.
fn workspace(root: &Path, packages: &[String], apart: &[String]) -> Result<String, Box<dyn Error>> {
    let mut manifest: toml::Table = read_manifest(root)?.parse()?;
    let workspace = table_in(&mut manifest, "workspace")?;
    workspace.remove("default-members");
    workspace.insert("members".to_owned(), packages.to_vec().into());
    workspace.insert("exclude".to_owned(), apart.to_vec().into());
    table_in(workspace, "dependencies")?.retain(|_, dependency| {
        let path = dependency.get("path").and_then(toml::Value::as_str);
        path.is_none_or(|path| packages.iter().any(|package| package == path))
    });
    Ok(toml::to_string(&manifest)?)
}

/// Returns a package's manifest without the tests, benchmarks and examples, whose files are not embedded: cargo rejects
/// a manifest that names a missing file.
fn manifest_of(text: &str) -> Result<String, Box<dyn Error>> {
    let mut manifest: toml::Table = text.parse()?;
    if !["test", "bench", "example"].map(|kind| manifest.remove(kind).is_some()).contains(&true) {
        return Ok(text.to_owned());
    }
    Ok(toml::to_string(&manifest)?)
}

/// Returns the text of the manifest in `folder`.
fn read_manifest(folder: &Path) -> Result<String, Box<dyn Error>> {
    Ok(fs::read_to_string(manifest(folder).ok_or_else(|| format!("{} has no manifest", folder.display()))?)?)
}

/// Returns the table `name` in `table`.
fn table_in<'a>(table: &'a mut toml::Table, name: &str) -> Result<&'a mut toml::Table, String> {
    table.get_mut(name).and_then(toml::Value::as_table_mut).ok_or_else(|| format!("Cargo.toml has no table `{name}`"))
}

/// Appends to `files` the files to be embedded from `folder` and its subfolders. `name` is the prefix of their names.
fn collect(folder: &Path, name: &str, files: &mut Vec<(String, PathBuf)>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let own = text(path.file_name())?;
        let is_manifest = manifest(folder).is_some_and(|manifest| manifest == path);
        let below = format!("{name}/{}", if is_manifest { "Cargo.toml" } else { own });
        if path.is_dir() {
            if !LEFT_OUT.contains(&own) && manifest(&path).is_none() {
                collect(&path, &below, files)?;
            }
        } else if own != "tests.rs" && !own.starts_with('.') && !own.ends_with('~') {
            files.push((below, path));
        }
    }
    Ok(())
}

/// Returns the generated Rust code: the table of files, the hash, the targets and the emulators.
fn table(
    root: &Path,
    files: &[(String, PathBuf)],
    targets: &[String],
    emulated: &[String],
) -> Result<String, Box<dyn Error>> {
    let mut hasher = blake3::Hasher::new();
    let mut rust = "pub(super) static FILES: &[(&str, &[u8])] = &[\n".to_owned();
    for (name, path) in files {
        let contents = fs::read(path)?;
        // The zero byte and the length separate name and contents, so that different files never give the same input of
        // the hash.
        hasher.update(name.as_bytes()).update(&[0]).update(&contents.len().to_le_bytes()).update(&contents);
        writeln!(rust, "    ({name:?}, include_bytes!({:?})),", text(Some(path.as_os_str()))?)?;
    }
    writeln!(rust, "];\npub(super) const HASH: &str = {:?};", &hasher.finalize().to_hex()[..12])?;

    rust.push_str("pub(super) static TARGETS: &[(&str, &str)] = &[\n");
    for name in targets {
        writeln!(rust, "    ({name:?}, {:?}),", package_name(&root.join("targets").join(name))?)?;
    }
    rust.push_str("];\npub(super) static EMULATORS: &[(&str, &str)] = &[\n");
    for name in emulated {
        let folder = root.join("targets").join(name).join(EMULATOR);
        writeln!(rust, "    ({name:?}, {:?}),", package_name(&folder)?)?;
    }
    rust.push_str("];\n");
    Ok(rust)
}

/// Returns the name of the package in `folder`, according to its manifest.
fn package_name(folder: &Path) -> Result<String, Box<dyn Error>> {
    let manifest: toml::Table = read_manifest(folder)?.parse()?;
    let name = manifest.get("package").and_then(|package| package.get("name")).and_then(toml::Value::as_str);
    Ok(name.ok_or_else(|| format!("{} has no package name", folder.display()))?.to_owned())
}

/// Returns a path, or a part of a path, as text.
fn text(path: Option<&OsStr>) -> Result<&str, String> {
    path.and_then(OsStr::to_str).ok_or_else(|| format!("{path:?} is not UTF-8"))
}
