//! Tests the dependency rules of ARCHITECTURE.md, between packages and between the rooms of the compiler.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::process::Command;

use crate::packages::PACKAGES;
use mdle_tests::repository::{TextFile, files, names_from, root};

/// Packages that do not need an operating system, and can therefore run in a browser or in the program of a robot.
const PURE: &[&str] = &[
    "runtime/core",
    "runtime/quantity",
    "runtime/sound",
    "atoms",
    "atoms/conformance",
    "mdlec/compiler",
    "mdlec/theory",
    "editors/service",
    "targets/sim/simulator",
    "web/module",
];

/// Packages that need an operating system, or use its arguments, signals, threads or folders.
const OF_THE_SYSTEM: &[&str] = &[
    "clap",
    "clap_builder",
    "etcetera",
    "getrandom",
    "home",
    "libc",
    "linux-raw-sys",
    "nix",
    "rustix",
    "signal-hook",
    "thread-priority",
    "windows-sys",
];

/// Folders that contain the compiler's rooms, each with the name of its package in Rust code.
const ROOM_FOLDERS: &[(&str, &str)] =
    &[("mdlec/compiler/src/", "mdle_compiler"), ("mdlec/theory/src/", "mdle_theory"), ("mdlec/src/", "mdlec")];

/// Rooms of the compiler, each with the rooms that it may use. A room is a top-level module of a package. `crate`
/// stands for the code in `lib.rs` itself.
const ROOMS: &[(&str, &[&str])] = &[
    ("diagnostic", &[]),
    ("alphabet", &["diagnostic"]),
    ("builtin", &["diagnostic", "alphabet"]),
    ("syntax", &["diagnostic", "alphabet"]),
    ("projection", &["diagnostic", "syntax", "alphabet"]),
    ("plan", &["diagnostic", "syntax", "alphabet"]),
    ("fsm", &["diagnostic", "syntax", "alphabet", "plan"]),
    ("load", &["diagnostic", "alphabet", "plan", "fsm"]),
    ("trace", &["diagnostic", "alphabet", "plan", "fsm"]),
    ("picture", &["diagnostic", "plan", "fsm"]),
    ("rust", &["diagnostic", "syntax", "alphabet", "plan", "fsm"]),
    ("analysis", &["diagnostic", "alphabet", "plan", "fsm", "rust"]),
    ("theorem", &["alphabet", "syntax"]),
    ("equations", &["diagnostic", "plan", "fsm"]),
    ("link", &[]),
    (
        "cli",
        &[
            "crate",
            "diagnostic",
            "builtin",
            "syntax",
            "alphabet",
            "plan",
            "fsm",
            "trace",
            "picture",
            "theorem",
            "equations",
            "rust",
            "analysis",
            "link",
        ],
    ),
    ("main", &["cli"]),
];

/// Rooms that may read files and the environment.
const WITH_IO: &[&str] = &["main", "cli", "link"];

#[test]
fn packages_use_only_those_below_them() {
    let mut breaches = Vec::new();
    for manifest in files(&["Cargo.toml"]) {
        let Some(folder) = manifest.path.strip_suffix("/Cargo.toml") else { continue };
        match PACKAGES.iter().find(|(package, _)| *package == folder) {
            None => breaches.push(format!("{folder}: say in tests/repository/packages.rs what it may use")),
            Some((_, allowed)) => breaches.extend(
                ours(&manifest)
                    .filter(|name| !allowed.contains(name))
                    .map(|name| format!("{}: may not use {name}", manifest.path)),
            ),
        }
    }
    assert_eq!(breaches, [""; 0]);
}

#[test]
fn what_a_robot_runs_needs_no_package_but_libm() {
    assert_eq!(needed("runtime/core"), BTreeSet::from(["libm", "mdle-runtime"].map(str::to_owned)));
    assert_eq!(needed("atoms"), BTreeSet::from(["libm", "mdle-atoms", "mdle-runtime"].map(str::to_owned)));
}

#[test]
fn pure_packages_need_no_operating_system() {
    for package in PURE {
        let needed = needed(package);
        let system: Vec<_> = OF_THE_SYSTEM.iter().filter(|name| needed.contains(**name)).collect();
        assert!(system.is_empty(), "{package} needs {system:?}; `cargo tree --invert NAME` says by which package");
    }
    // This checks that the names in the list are those that cargo prints.
    assert!(
        ["clap", "rustix", "signal-hook", "thread-priority"].iter().all(|name| needed("runtime/host").contains(*name))
    );
}

#[test]
fn emulators_are_built_on_the_libraries_of_executables() {
    // If the features differed, a library and all packages that depend on it would be compiled again.
    let libraries = |folder: &str| -> BTreeSet<String> {
        tree(folder, "{p} [{f}]", &["x86_64-unknown-linux-gnu"]).lines().map(str::to_owned).collect()
    };
    let version = |library: &str| library.split(" [").next().unwrap_or_default().to_owned();
    for robot in ["scout", "atrv"] {
        let (executable, emulator) = (libraries("targets/sim"), libraries(&format!("targets/{robot}/emulator")));
        let versions: BTreeSet<_> = executable.iter().map(|library| version(library)).collect();
        let others = emulator.difference(&executable).filter(|library| versions.contains(&version(library)));
        assert_eq!(others.collect::<Vec<_>>(), [""; 0], "{robot}");
        assert!(emulator.intersection(&executable).any(|library| library.starts_with("mdle-simulator ")), "{robot}");
    }
}

/// Returns the packages that the build of the package in `folder` includes on Linux or in a browser, with the package
/// itself.
fn needed(folder: &str) -> BTreeSet<String> {
    let packages = tree(folder, "{p}", &["x86_64-unknown-linux-gnu", "wasm32-unknown-unknown"]);
    packages
        .lines()
        .filter_map(|line| line.split(' ').next())
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect()
}

/// Returns a line in the format `format` for each package that the build of the package in `folder` includes on these
/// targets.
fn tree(folder: &str, format: &str, targets: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["tree", "--offline", "--no-default-features", "--edges", "normal", "--no-dedupe"]);
    command.args(["--prefix", "none", "--format", format]).current_dir(root().join(folder));
    command.args(targets.iter().flat_map(|target| ["--target", target]));
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("names")
}

/// Returns the workspace's packages that a manifest lists as dependencies of any kind.
fn ours(manifest: &TextFile) -> impl Iterator<Item = &str> {
    let mut in_dependencies = false;
    manifest.text.lines().filter_map(move |line| {
        if line.starts_with('[') {
            in_dependencies = line.contains("dependencies");
        }
        let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
        (in_dependencies && name.starts_with("mdle")).then_some(name)
    })
}

#[test]
fn rooms_of_the_compiler_use_only_those_before_them() {
    let mut breaches = Vec::new();
    for Room { room, inside, file } in rooms() {
        let Some((_, allowed)) = ROOMS.iter().find(|(name, _)| *name == room) else {
            breaches.push(format!("{}: say in tests/repository/directions.rs what it may use", file.path));
            continue;
        };
        let crates = ["crate"].into_iter().chain(ROOM_FOLDERS.iter().map(|(_, name)| *name));
        for name in crates.flat_map(|name| names_from(&file.text, name)) {
            let is_room = ROOMS.iter().any(|(room, _)| *room == name);
            let used = if is_room { name.as_str() } else { "crate" };
            if used != room && !allowed.contains(&used) {
                breaches.push(format!("{}: may not use {name}", file.path));
            }
        }
        if let Some(line) = climbs_to_the_root(&inside, &file) {
            breaches.push(format!("{}: say `crate::` and not `{line}`", file.path));
        }
    }
    assert_eq!(breaches, [""; 0]);
}

/// A file of a room of the compiler.
struct Room {
    /// Name of the room.
    room: String,
    /// Path of the file, relative to its package's `src`.
    inside: String,
    /// Text of the file, without tests.
    file: TextFile,
}

/// Returns the files of the compiler's rooms, without their tests. A `lib.rs` belongs to no room, because it shows all
/// stages on one screen; neither do files that only tests share.
fn rooms() -> impl Iterator<Item = Room> {
    files(&[".rs"]).into_iter().filter_map(|file| {
        let inside = ROOM_FOLDERS.iter().find_map(|(folder, _)| file.path.strip_prefix(folder))?.to_owned();
        let room = inside.split(['/', '.']).next().unwrap_or_default().to_owned();
        let text = file.text.split("#[cfg(test)]").next().unwrap_or_default().to_owned();
        let is_left_out = ["lib.rs", "samples.rs"].contains(&inside.as_str());
        let is_test = inside.ends_with("/tests.rs") || inside.contains("/tests/");
        (!is_left_out && !is_test).then_some(Room { room, inside, file: TextFile { text, ..file } })
    })
}

/// Returns the first line in which `super::` leads out of the room, and which could use other rooms without naming
/// `crate::`.
fn climbs_to_the_root<'f>(inside: &str, file: &'f TextFile) -> Option<&'f str> {
    let folders = inside.matches('/').count();
    // room.rs and room/mod.rs are one level below the root.
    let depth = if inside.ends_with("/mod.rs") { folders } else { folders + 1 };
    let climb = "super::".repeat(depth);
    file.text.lines().map(str::trim).find(|line| !line.starts_with("//") && line.contains(&climb))
}

#[test]
fn machines_written_from_the_rules_share_no_stepping_with_others() {
    // From the lowering, the machines may only use the limit of expanded states and the matrices.
    let machines = [
        ("tree", &[][..]),
        ("table", &["expanded_states"]),
        ("matrix", &["Matrices", "Transition", "UnitVector", "matrices"]),
    ];
    for (machine, of_fsm) in machines {
        let path = format!("mdlec/compiler/src/trace/{machine}.rs");
        let file = files(&[".rs"]).into_iter().find(|file| file.path == path).expect(&path);
        let used = [
            (names_from(&file.text, "mdle_runtime"), &["Frame", "TRANSITIONS_PER_TURN"][..]),
            (names_from(&file.text, "crate"), &["diagnostic", "fsm", "plan"]),
            (names_from(&file.text, "crate::fsm"), of_fsm),
            (
                names_from(&file.text, "super"),
                &["ScriptedInput", "COMPLETED", "Fired", "EntryTime", "Machine", "Reports", "TurnResult"],
            ),
        ];
        for (names, allowed) in used {
            let others: Vec<_> = names.iter().filter(|name| !allowed.contains(&name.as_str())).collect();
            assert_eq!(others, [""; 0], "in {path}");
        }
    }
    let lowering =
        files(&[".rs"]).into_iter().find(|file| file.path == "mdlec/compiler/src/fsm/matrices.rs").expect("matrices");
    assert_eq!(names_from(&lowering.text, "mdle_runtime"), [""; 0], "in {}", lowering.path);
}

#[test]
fn the_lowering_is_validated_by_code_of_its_own() {
    let path = "mdlec/compiler/src/fsm/validation.rs";
    let file = files(&[".rs"]).into_iter().find(|file| file.path == path).expect(path);
    // From the lowering it may only use the definition of a machine, and from the runtime that of its tables.
    assert_eq!(names_from(&file.text, "super"), ["MachineDraft", "RecordPlace", "Sizes"]);
    assert_eq!(names_from(&file.text, "mdle_runtime"), ["fsm", "Here", "Radians"]);
    assert_eq!(names_from(&file.text, "mdle_runtime::fsm"), ["Bracket", "Kind"]);
    assert_eq!(names_from(&file.text, "crate"), ["diagnostic", "plan"]);
}

#[test]
fn tables_of_a_machine_are_read_by_its_face() {
    let mut breaches = Vec::new();
    for Room { room, file, .. } in rooms() {
        if ["picture", "rust", "analysis"].contains(&room.as_str()) {
            let kinds = names_from(&file.text, "mdle_runtime::fsm").contains(&"Kind".to_owned());
            breaches.extend(kinds.then(|| format!("{}: an element has a kind of its own", file.path)));
        }
        // The tables are written by the lowering and read by `element`; validation shares no code with either.
        let has_tables = ["lower", "element", "validation"].map(|name| format!("mdlec/compiler/src/fsm/{name}.rs"));
        let uses_machines = room == "fsm" || names_from(&file.text, "crate").contains(&"fsm".to_owned());
        if has_tables.contains(&file.path) || !uses_machines {
            continue;
        }
        breaches.extend(indexed(&file.text).map(|line| format!("{}: read an element: {line}", file.path)));
        let drafts = room != "fsm" && file.text.contains(".draft()");
        breaches.extend(drafts.then(|| format!("{}: drafts are for tests", file.path)));
    }
    assert_eq!(breaches, [""; 0]);
}

#[test]
fn the_host_is_generic_in_few_files() {
    // Code that is generic over a plan or its robot is compiled again in the crate of each plan.
    let generic =
        ["drive", "executable", "helm", "lib", "pilot", "position", "supervisor", "target", "target_options", "trials"]
            .map(|name| format!("runtime/host/src/{name}.rs"));
    let mut breaches = Vec::new();
    for file in files(&[".rs"]).into_iter().filter(|file| file.path.starts_with("runtime/host/src/")) {
        let is_test = file.path.contains("tests");
        let bounds = [": Plan", ": Target", "Machine<"];
        let code = file.text.lines().map(str::trim).filter(|line| !line.starts_with("//"));
        let lines: Vec<_> = code.filter(|line| bounds.iter().any(|bound| line.contains(bound))).collect();
        if !is_test && !generic.contains(&file.path) {
            breaches.extend(lines.iter().map(|line| format!("{}: take a `dyn Drive`: {line}", file.path)));
        }
    }
    assert_eq!(breaches, [""; 0]);
}

/// Returns the lines that access an entry of a machine's tables by index.
fn indexed(text: &str) -> impl Iterator<Item = &str> {
    let tables = ["brackets", "scopes", "atoms", "laws"];
    let takes = ["[", ".get(", ".get_mut("];
    let lines = text.lines().map(str::trim).filter(|line| !line.starts_with("//"));
    lines.filter(move |line| {
        let found =
            tables.iter().flat_map(|table| line.match_indices(table).map(move |(at, _)| (at, at + table.len())));
        let mut whole =
            found.filter(|(at, _)| !line[..*at].ends_with(|letter: char| letter.is_alphanumeric() || letter == '_'));
        whole.any(|(_, end)| takes.iter().any(|take| line[end..].starts_with(take)))
    })
}

#[test]
fn an_index_into_a_table_is_found() {
    let text = "let a = lowered.brackets[number];\nself.atoms.get(first)\n// laws[0]\nlet scopes = &[1];\nmy_laws[0]; laws.len()";
    assert_eq!(indexed(text).collect::<Vec<_>>(), ["let a = lowered.brackets[number];", "self.atoms.get(first)"]);
}

#[test]
fn stages_of_the_compiler_read_no_files() {
    let mut breaches = Vec::new();
    for Room { room, file, .. } in rooms().filter(|file| !WITH_IO.contains(&file.room.as_str())) {
        for name in names_from(&file.text, "std") {
            if ["fs", "env", "process", "net", "time", "thread"].contains(&name.as_str()) {
                breaches.push(format!("{}: std::{name} is not for {room}", file.path));
            }
        }
    }
    assert_eq!(breaches, [""; 0]);
}

#[test]
fn names_are_found_in_paths_and_in_groups() {
    let text =
        "use crate::plan::{self, Node};\n// crate::never\nuse crate::{a::{b, c},\n    D, e as f};\nlet x = crate::g();";
    assert_eq!(names_from(text, "crate"), ["plan", "a", "D", "e", "g"]);
    assert_eq!(names_from("$crate::x my_crate::y", "crate"), ["x"]);
}
