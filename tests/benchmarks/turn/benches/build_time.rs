//! Measures the build time of emitted Rust as the number of written-out atoms grows, and as a loop count grows.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use std::{env, fs};

/// Number of times that each file is compiled; the fastest run counts.
const RUNS: usize = 5;

/// Files that the build script has written, each with its description.
const PLANS: &[(&str, &str)] = &[
    ("plan_8.rs", "8 atoms written out"),
    ("plan_100.rs", "100 atoms written out"),
    ("plan_1000.rs", "1,000 atoms written out"),
    ("plan_10000.rs", "10,000 atoms written out"),
    ("looped_2.rs", "2 passes through 2 atoms"),
    ("looped_5000.rs", "5,000 passes through 2 atoms"),
    ("looped_1000000000.rs", "10^9 passes through 2 atoms"),
];

/// Code that is added to an emitted file to include the compile time of a turn, which is generic and therefore compiled
/// only where it is used.
const TURN: &str = "
pub fn turn(
    machine: &mut ::mdle_runtime::Machine<T>,
    y: &::mdle_workload::Output,
    t: ::mdle_runtime::Nanos,
) -> ::mdle_runtime::Turn<::mdle_workload::Input> {
    machine.turn(y, t, &mut ())
}
";

fn main() {
    let folder = env::temp_dir().join(format!("mdle-build-time-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder to write to");
    let libraries = libraries();
    println!("{:<32}{:>10}{:>10}", "", "wall, ms", "user, ms");
    let show = |what: &str, text: &str| {
        let source = folder.join("source.rs");
        fs::write(&source, text).expect("a folder to write to");
        let times = (0..RUNS).map(|_| compile(&source, &folder, &libraries));
        let best = times.reduce(|best, time| (best.0.min(time.0), best.1.min(time.1))).expect("more than no runs");
        println!("{what:<32}{:>10.0}{:>10.0}", best.0, best.1);
    };
    show("an empty library", "");
    show("an empty library, no std", "#![no_std]");
    for (file, what) in PLANS {
        let emitted = fs::read_to_string(Path::new(env!("OUT_DIR")).join(file)).expect("the build script's file");
        show(what, &format!("{emitted}{TURN}"));
    }
    fs::remove_dir_all(folder).expect("the folder of this run");
}

/// Returns the libraries that an emitted file uses, each with its name and the path of the built file.
fn libraries() -> Vec<(&'static str, PathBuf)> {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let output = Command::new(env!("CARGO"))
        .args(["build", "--release", "--lib", "--no-default-features", "--message-format=json"])
        .args(["--manifest-path", manifest])
        .output()
        .expect("cargo");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let messages = String::from_utf8(output.stdout).expect("JSON");
    let built: Vec<serde_json::Value> = messages.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let file = |name: &str| {
        // The last match counts: an earlier one is the runtime of mdlec, which is a dependency of the build script.
        let library = built.iter().rfind(|message| message["target"]["name"] == name)?;
        let files = library["filenames"].as_array()?.iter().filter_map(serde_json::Value::as_str);
        files.map(PathBuf::from).find(|file| file.extension().is_some_and(|extension| extension == "rlib"))
    };
    ["mdle_runtime", "mdle_workload"].map(|name| (name, file(name).expect("a library"))).into()
}

/// Compiles a library as cargo does for a plan. Returns the wall-clock time and the user time, in milliseconds.
fn compile(source: &Path, folder: &Path, libraries: &[(&str, PathBuf)]) -> (f64, f64) {
    let mut command = Command::new("rustc");
    command.args(["--edition=2024", "--crate-type=lib", "--emit=link", "-Copt-level=3", "-Ccodegen-units=1"]);
    command.args(["-Cstrip=symbols", "--cap-lints=allow", "--out-dir"]).arg(folder).arg(source);
    for (name, file) in libraries {
        command.arg("--extern").arg(format!("{name}={}", file.display()));
        let dependencies = file.parent().expect("a folder").join("deps");
        command.arg("-L").arg(format!("dependency={}", dependencies.display()));
    }
    let (start, used) = (Instant::now(), used_by_children());
    let status = command.status().expect("rustc");
    assert!(status.success(), "rustc {}", source.display());
    (start.elapsed().as_secs_f64() * 1e3, used_by_children() - used)
}

/// Returns the user time of all children so far, in milliseconds: field 16 of `/proc/self/stat`, in hundredths of a
/// second.
fn used_by_children() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").expect("Linux");
    let after_name = stat.rsplit(')').next().expect("a name in brackets");
    let ticks = after_name.split_whitespace().nth(13).expect("as proc(5) has it");
    10.0 * ticks.parse::<f64>().expect("a number")
}
