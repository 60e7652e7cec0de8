//! The directions of the architecture: who may use whom, between packages and between the rooms of the compiler.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::process::Command;

use mdle_tests::repository::{TextFile, files, names_from, root};

/// Packages of the workspace that each package may use. A folder that is not listed may not hold a package.
const PACKAGES: &[(&str, &[&str])] = &[
    ("runtime/core", &[]),
    ("runtime/host", &["mdle-runtime"]),
    ("runtime/serial", &["mdle-runtime", "mdle-host"]),
    ("atoms", &["mdle-runtime"]),
    ("mdlec", &["mdle-runtime"]),
    ("targets/sim", &["mdle-runtime", "mdle-host", "mdle-atoms"]),
    ("targets/scout", &["mdle-runtime", "mdle-host", "mdle-serial", "mdle-atoms"]),
    ("targets/atrv", &["mdle-runtime", "mdle-host", "mdle-serial", "mdle-atoms"]),
    ("targets/template", &["mdle-runtime", "mdle-host", "mdle-atoms"]),
    // The runtime, the line and the conformance are there for the tests of robots alone.
    ("targets/emulator", &["mdle-runtime", "mdle-host", "mdle-serial", "mdle-atoms", "mdle-sim"]),
    // The drivers and the conformance of robots are there for their tests alone: they share no word of the language.
    ("targets/scout/emulator", &["mdle-runtime", "mdle-host", "mdle-atoms", "mdle-sim", "mdle-emulator", "mdle-scout"]),
    ("targets/atrv/emulator", &["mdle-runtime", "mdle-host", "mdle-atoms", "mdle-sim", "mdle-emulator", "mdle-atrv"]),
    (
        "tests",
        &[
            "mdle-runtime",
            "mdle-host",
            "mdle-atoms",
            "mdle-sim",
            "mdle-emulator",
            "mdle-scout-emulator",
            "mdle-scout",
            "mdle-atrv",
            "mdle-atrv-emulator",
            "mdle-scripted",
            "mdlec",
        ],
    ),
    ("tests/scripted", &["mdle-runtime"]),
    ("tests/benchmarks", &["mdle-host", "mdle-runtime", "mdle-sim", "mdle-tests", "mdlec"]),
    ("tests/benchmarks/turn", &["mdle-runtime", "mdlec"]),
    ("tests/bare", &["mdle-runtime", "mdle-atoms"]),
    ("tests/application", &["mdle-runtime", "mdle-host", "mdle-sim", "mdlec"]),
    ("tests/mutants", &[]),
    ("tests/fuzz", &["mdle-tests"]),
];

/// Rooms of the compiler that each room may use. `crate` is the text of `lib.rs` itself.
const ROOMS: &[(&str, &[&str])] = &[
    ("diagnostic", &[]),
    ("alphabet", &["diagnostic"]),
    ("syntax", &["diagnostic", "alphabet"]),
    ("plan", &["diagnostic", "syntax", "alphabet"]),
    ("fsm", &["diagnostic", "alphabet", "plan"]),
    ("trace", &["diagnostic", "alphabet", "plan", "fsm"]),
    ("picture", &["diagnostic", "plan", "fsm"]),
    ("theorem", &["alphabet", "syntax"]),
    ("rust", &["diagnostic", "syntax", "alphabet", "plan", "fsm"]),
    ("analysis", &["diagnostic", "alphabet", "plan", "fsm", "rust"]),
    ("link", &["crate", "diagnostic", "syntax", "alphabet", "plan", "fsm", "rust"]),
    (
        "cli",
        &[
            "crate",
            "diagnostic",
            "syntax",
            "alphabet",
            "plan",
            "fsm",
            "trace",
            "picture",
            "theorem",
            "rust",
            "analysis",
            "link",
        ],
    ),
    ("embed", &["cli"]),
    ("main", &["cli"]),
];

/// The rooms that may read files and the environment.
const WITH_IO: &[&str] = &["main", "cli", "embed", "link"];

#[test]
fn packages_use_only_those_below_them() {
    let mut breaches = Vec::new();
    for manifest in files(&["Cargo.toml"]) {
        let Some(folder) = manifest.path.strip_suffix("/Cargo.toml") else { continue };
        match PACKAGES.iter().find(|(package, _)| *package == folder) {
            None => breaches.push(format!("{folder}: say in tests/repository/directions.rs what it may use")),
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
    let needed = |folder: &str| {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let shown = ["--no-default-features", "--edges", "normal", "--prefix", "none", "--format", "{p}"];
        let output =
            Command::new(cargo).args(["tree", "--offline"]).args(shown).current_dir(root().join(folder)).output();
        let output = output.expect("cargo runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let packages = String::from_utf8(output.stdout).expect("names");
        packages.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect::<BTreeSet<_>>()
    };
    assert_eq!(needed("runtime/core"), BTreeSet::from(["libm", "mdle-runtime"].map(str::to_owned)));
    assert_eq!(needed("atoms"), BTreeSet::from(["libm", "mdle-atoms", "mdle-runtime"].map(str::to_owned)));
}

/// Returns the packages of the workspace that a manifest names as dependencies, of any sort.
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
    for (room, file) in rooms() {
        let Some((_, allowed)) = ROOMS.iter().find(|(name, _)| *name == room) else {
            breaches.push(format!("{}: say in tests/repository/directions.rs what it may use", file.path));
            continue;
        };
        for name in names_from(&file.text, "crate").into_iter().chain(names_from(&file.text, "mdlec")) {
            let is_room = ROOMS.iter().any(|(room, _)| *room == name);
            let used = if is_room { name.as_str() } else { "crate" };
            if used != room && !allowed.contains(&used) {
                breaches.push(format!("{}: may not use {name}", file.path));
            }
        }
        if let Some(line) = climbs_to_the_root(&file) {
            breaches.push(format!("{}: say `crate::` and not `{line}`", file.path));
        }
    }
    assert_eq!(breaches, [""; 0]);
}

/// Returns the files of the compiler's rooms without tests. `lib.rs`, which shows them all on one screen, belongs to no
/// room, nor do files that only tests share.
fn rooms() -> impl Iterator<Item = (String, TextFile)> {
    files(&[".rs"]).into_iter().filter_map(|file| {
        let inside =
            file.path.strip_prefix("mdlec/src/").filter(|inside| !["lib.rs", "samples.rs"].contains(inside))?;
        let room = inside.split(['/', '.']).next().unwrap_or_default().to_owned();
        let text = file.text.split("#[cfg(test)]").next().unwrap_or_default().to_owned();
        let is_test = inside.ends_with("/tests.rs") || inside.contains("/tests/");
        (!is_test).then_some((room, TextFile { text, ..file }))
    })
}

/// A line whose `super::` lead out of the room, where the names of other rooms could be had without `crate::`.
fn climbs_to_the_root(file: &TextFile) -> Option<&str> {
    let folders = file.path.matches('/').count();
    // mdlec/src/room.rs and mdlec/src/room/mod.rs are one step below the root.
    let depth = if file.path.ends_with("/mod.rs") { folders - 2 } else { folders - 1 };
    let climb = "super::".repeat(depth);
    file.text.lines().map(str::trim).find(|line| !line.starts_with("//") && line.contains(&climb))
}

#[test]
fn machines_written_from_the_rules_share_no_stepping_with_others() {
    // What they may take from the lowering: the limit of what is expanded, and the matrices themselves.
    let machines = [
        ("tree", &[][..]),
        ("table", &["expanded_states"]),
        ("matrix", &["Matrices", "Transition", "UnitVector", "matrices"]),
    ];
    for (machine, of_fsm) in machines {
        let path = format!("mdlec/src/trace/{machine}.rs");
        let file = files(&[".rs"]).into_iter().find(|file| file.path == path).expect(&path);
        let used = [
            (names_from(&file.text, "mdle_runtime"), &["Frame", "TRANSITIONS_PER_TURN"][..]),
            (names_from(&file.text, "crate"), &["diagnostic", "fsm", "plan"]),
            (names_from(&file.text, "crate::fsm"), of_fsm),
            (
                names_from(&file.text, "super"),
                &["Applied", "COMPLETED", "Fired", "Machine", "Moment", "Outcome", "Reports"],
            ),
        ];
        for (names, allowed) in used {
            let others: Vec<_> = names.iter().filter(|name| !allowed.contains(&name.as_str())).collect();
            assert_eq!(others, [""; 0], "in {path}");
        }
    }
    let lowering = files(&[".rs"]).into_iter().find(|file| file.path == "mdlec/src/fsm/matrices.rs").expect("matrices");
    assert_eq!(names_from(&lowering.text, "mdle_runtime"), [""; 0], "in {}", lowering.path);
}

#[test]
fn the_lowering_is_validated_by_code_of_its_own() {
    let path = "mdlec/src/fsm/validation.rs";
    let file = files(&[".rs"]).into_iter().find(|file| file.path == path).expect(path);
    // Of the lowering it may know what a machine is, and of the runtime what its tables are.
    assert_eq!(names_from(&file.text, "super"), ["Draft", "RecordPlace", "Sizes"]);
    assert_eq!(names_from(&file.text, "mdle_runtime"), ["fsm", "Here", "Radians"]);
    assert_eq!(names_from(&file.text, "mdle_runtime::fsm"), ["Bracket", "Kind"]);
    assert_eq!(names_from(&file.text, "crate"), ["diagnostic", "plan"]);
}

#[test]
fn tables_of_a_machine_are_read_by_its_face() {
    let mut breaches = Vec::new();
    for (room, file) in rooms() {
        if ["picture", "rust", "analysis"].contains(&room.as_str()) {
            let kinds = names_from(&file.text, "mdle_runtime::fsm").contains(&"Kind".to_owned());
            breaches.extend(kinds.then(|| format!("{}: an element has a kind of its own", file.path)));
        }
        // Lowering writes the tables, the face reads them, and validation shares no code with either.
        let has_tables = ["lower", "machine", "validation"].map(|name| format!("mdlec/src/fsm/{name}.rs"));
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
    // What is generic over a plan or its robot is compiled in the crate of each plan.
    let generic = ["drive", "executable", "lib", "target"].map(|name| format!("runtime/host/src/{name}.rs"));
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

/// The lines that take an entry of a machine's tables by its number.
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
    for (room, file) in rooms().filter(|(room, _)| !WITH_IO.contains(&room.as_str())) {
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
