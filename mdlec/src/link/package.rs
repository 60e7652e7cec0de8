//! Writes the cargo package for the Rust code that was generated from a plan.

use std::fmt::Write as _;
use std::path::Path;

use super::cache::{remove, write_if_changed};
use super::hash::hash;
use super::machine::BuildMachine;
use super::plan_package::PlanPackage;
use super::target::{Dependencies, utf8};
use super::toolchain::Toolchain;
use super::{Cache, Entry, LinkError, Package, build_record, sources};

/// Writes the cargo package of a plan or of a scenario. Unchanged files keep their times, which cargo compares.
pub(super) fn write(
    cache: &Cache,
    package: &Package<'_>,
    dependencies: &Dependencies,
    toolchain: &Toolchain,
    machine: &BuildMachine,
) -> Result<PlanPackage, LinkError> {
    let main = main(package, &version(package, dependencies, toolchain));
    let name = name(package, &main, &dependencies.identity, &machine.triple);
    write_package(cache, &name, &[("src/main.rs", &main), ("src/plan.rs", package.rust)], dependencies)
}

/// Returns the text that the executable prints for `--version` after the plan's name. If two builds differ although
/// this text is equal, the reason is the crate of a third-party target or the path of the cache.
fn version(package: &Package<'_>, dependencies: &Dependencies, toolchain: &Toolchain) -> String {
    let code = [package.rust, sources::hash(), &dependencies.lock].join("\0");
    format!("({}, code {}, rustc {})", package.version, &hash(code.as_bytes())[..12], toolchain.release)
}

/// Writes the package of the emulator of `robot`, whose crate is `crate_name`.
pub(super) fn write_emulator(
    cache: &Cache,
    robot: &str,
    crate_name: &str,
    dependencies: &Dependencies,
) -> Result<PlanPackage, LinkError> {
    let main = format!(
        "//! Made by mdlec: runs a robot emulator.\n\n\
         fn main() -> ::std::process::ExitCode {{\n    ::{crate_name}::main()\n}}\n"
    );
    write_package(cache, &format!("emulator-{robot}"), &[("src/main.rs", &main)], dependencies)
}

/// Writes the package `name` with these source files.
fn write_package(
    cache: &Cache,
    name: &str,
    sources: &[(&str, &str)],
    dependencies: &Dependencies,
) -> Result<PlanPackage, LinkError> {
    let folder = cache.plans().join(name);
    let (manifest, lock) = (manifest(name, dependencies)?, dependencies.lock.as_str());
    let files: Vec<_> = [("Cargo.toml", &*manifest)].into_iter().chain(sources.iter().copied()).collect();
    match write_files(&folder, &files, lock) {
        Ok(()) => {}
        Err(full @ LinkError::DiskFull(_)) => return Err(full),
        // Writing fails if, for example, a file is in the place of a folder.
        Err(_) => {
            remove(&folder)?;
            write_files(&folder, &files, lock)?;
        }
    }
    let texts: Vec<_> = files.iter().map(|(_, text)| *text).chain([lock]).collect();
    Ok(PlanPackage { folder, hash: hash(texts.join("\0").as_bytes()) })
}

/// Writes `files` to `folder`, and `lock` as cargo's initial lock file.
fn write_files(folder: &Path, files: &[(&str, &str)], lock: &str) -> Result<(), LinkError> {
    for (name, text) in files {
        write_if_changed(&folder.join(name), text.as_bytes())?;
    }
    // Cargo adds the plan's own package to the lock file, and removes packages that the plan does not need.
    if write_if_changed(&folder.join("seed.lock"), lock.as_bytes())? || !build_record::has_lock(folder) {
        write_if_changed(&folder.join("Cargo.lock"), lock.as_bytes())?;
    }
    Ok(())
}

/// Returns a readable package name that is unique for the generated Rust code, the target and the machine. All
/// executables are built in one folder, and their bytes depend on the name.
fn name(package: &Package<'_>, main: &str, target: &str, machine: &str) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in [main, package.rust, target, machine] {
        hasher.update(&part.len().to_le_bytes()).update(part.as_bytes());
    }
    let stem = package.plan_file.file_stem().unwrap_or_default().to_string_lossy();
    let stem: String = stem.chars().take(40).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    format!("plan-{stem}-{}", &hasher.finalize().to_hex()[..12])
}

/// Returns the text of `Cargo.toml`.
fn manifest(name: &str, dependencies: &Dependencies) -> Result<String, LinkError> {
    let mut text = format!(
        "# Made by mdlec, and made again whenever the plan is compiled.\n\
         [package]\nname = {}\nversion = \"0.0.0\"\nedition = \"2024\"\npublish = false\n\n\
         [workspace]\n\n[dependencies]\n",
        quoted(name)
    );
    for (package, folder) in &dependencies.packages {
        let _ = writeln!(text, "{} = {{ path = {} }}", quoted(package), quoted(utf8(folder)?));
    }
    for (source, package, folder) in &dependencies.patches {
        let (source, package, folder) = (quoted(source), quoted(package), quoted(utf8(folder)?));
        let _ = write!(text, "\n[patch.{source}.{package}]\npath = {folder}\n");
    }
    Ok(text)
}

/// Returns the text of `src/main.rs`.
fn main(package: &Package<'_>, version: &str) -> String {
    let (target, name) = (package.target.crate_name(), package.plan_name);
    let (does, program, run) = match package.entry {
        Entry::Plan(plan) => (
            "the plan on its target",
            "::mdle_host::Program",
            format!("::mdle_host::run::<::{target}::Target, _>(program, plan::{plan}::new)"),
        ),
        Entry::Scenario => ("a scenario", "::mdle::Program", "::mdle::run_scenario(program, plan::FILES)".to_owned()),
        Entry::Engine { target, plan } => (
            "a plan with the engine",
            "::mdle::Program",
            format!("::mdle::run_plan(program, plan::FILES, {target:?}, {plan:?})"),
        ),
    };
    format!(
        "//! Made by mdlec: runs {does}.\n\n\
         // Included, as a build script's output is: emitted text must be fit for both.\n\
         #[forbid(unsafe_code)]\n\
         mod plan {{\n    include!(\"plan.rs\");\n}}\n\n\
         fn main() -> ::std::process::ExitCode {{\n    \
             let program = {program} {{ plan: {name:?}, version: {version:?} }};\n    \
             {run}\n\
         }}\n"
    )
}

/// Returns a text as a TOML string. The escape sequences are those of JSON, which are valid in TOML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::super::tests::cache;
    use super::super::{Cache, Entry, Package, TargetCrate, build_record};
    use super::{BuildMachine, Dependencies, PlanPackage, Toolchain, manifest};

    const HOST: &str = "x86_64-unknown-linux-gnu";
    const TARGET: TargetCrate<'static> = TargetCrate::Builtin { name: "sim", crate_name: "mdle_sim" };

    fn package<'a>(plan_file: &'a str, rust: &'a str) -> Package<'a> {
        Package {
            plan_name: "Nap",
            version: "text 0, target sim",
            plan_file: Path::new(plan_file),
            entry: Entry::Plan("Nap"),
            inputs: &[],
            rust,
            target: &TARGET,
            machine: None,
        }
    }

    fn dependencies() -> Dependencies {
        Dependencies {
            packages: vec![("mdle-sim".to_owned(), PathBuf::from("/a \"b\"/sim"))],
            patches: vec![("crates-io".to_owned(), "mdle-host".to_owned(), PathBuf::from("/src/host"))],
            lock: "version = 4\n".to_owned(),
            identity: "sim".to_owned(),
            ours: PathBuf::from("/src"),
        }
    }

    fn toolchain() -> Toolchain {
        Toolchain { host: HOST.to_owned(), release: "1.95.0".to_owned() }
    }

    fn write(cache: &Cache, plan_file: &str, rust: &str) -> PlanPackage {
        super::write(cache, &package(plan_file, rust), &dependencies(), &toolchain(), &BuildMachine::host(HOST))
            .unwrap()
    }

    #[test]
    fn the_manifest_stands_alone() {
        insta::assert_snapshot!(manifest("plan-nap-0", &dependencies()).unwrap());
    }

    #[test]
    fn the_program_runs_the_plan_on_its_target() {
        insta::assert_snapshot!(super::main(&package("nap.mdle", ""), "(text 0)"));
    }

    #[test]
    fn the_program_of_a_scenario_runs_its_files() {
        let package = Package { plan_name: "two \"robots\"", entry: Entry::Scenario, ..package("two.toml", "") };
        insta::assert_snapshot!(super::main(&package, "(text 0)"));
    }

    #[test]
    fn the_program_with_the_engine_runs_the_files_of_its_plan() {
        let entry = Entry::Engine { target: "scout", plan: Some("Nap") };
        insta::assert_snapshot!(super::main(&Package { entry, ..package("nap.mdle", "") }, "(text 0)"));
    }

    #[test]
    fn a_name_is_one_that_cargo_takes() {
        let name = |file, rust, target| super::name(&package(file, rust), "", target, HOST);
        assert!(name("plans/größe 2.mdle", "", "sim").starts_with("plan-gr__e_2-"));
        assert!(name("-", "", "sim").starts_with("plan-_-"));
        let nap = name("nap.mdle", "", "sim");
        assert_eq!(name("elsewhere/nap.mdle", "", "sim"), nap);
        assert_ne!(name("nap.mdle", "mod a {}", "sim"), nap);
        assert_ne!(name("nap.mdle", "", "scout"), nap);
        assert_ne!(super::name(&package("nap.mdle", ""), "", "sim", "aarch64-unknown-linux-musl"), nap);
    }

    #[test]
    fn the_version_names_what_is_compiled() {
        let version = |rust, lock: &str, release: &str| {
            let dependencies = Dependencies { lock: lock.to_owned(), ..dependencies() };
            let toolchain = Toolchain { release: release.to_owned(), ..toolchain() };
            super::version(&package("nap.mdle", rust), &dependencies, &toolchain)
        };
        let first = version("", "", "1.95.0");
        assert!(first.starts_with("(text 0, target sim, code ") && first.ends_with(", rustc 1.95.0)"), "{first}");
        assert_eq!(version("", "", "1.95.0"), first);
        for other in [version("mod a {}", "", "1.95.0"), version("", "#", "1.95.0"), version("", "", "1.96.0")] {
            assert_ne!(other, first);
        }
    }

    #[test]
    fn what_has_not_changed_keeps_its_time() {
        let cache = cache("package");
        let file = |name| write(&cache, "nap.mdle", "mod a {}").folder.join(name);
        let time = |name| fs::metadata(file(name)).unwrap().modified().unwrap();
        assert_eq!(time("src/plan.rs"), time("src/plan.rs"));
        assert_eq!(fs::read_to_string(file("src/plan.rs")).unwrap(), "mod a {}");
    }

    #[test]
    fn a_lock_file_stays_as_cargo_left_it() {
        let cache = cache("lock");
        let write = || write(&cache, "nap.mdle", "mod a {}");
        let lock = write().folder.join("Cargo.lock");
        let text = || fs::read_to_string(&lock).unwrap();
        let package = write();
        fs::write(&lock, "grown").unwrap();
        build_record::write(&package, &lock).unwrap();
        write();
        assert_eq!(text(), "grown");
        for damaged in ["garbage", ""] {
            fs::write(&lock, damaged).unwrap();
            write();
            assert_eq!(text(), dependencies().lock);
        }
    }
}
