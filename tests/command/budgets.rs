//! Tests inputs that exceed the resources of any computer, through the real binaries. Each command ends within a limit
//! of memory and time, with a result or with a message that names the limit.
//!
//! An unoptimized mdlec needs two minutes for plans just within the limits; without `MDLE_LONG` the plans here are
//! smaller.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_tests::chance::sized;
use mdle_tests::executable::{cache, folder, mdlec, run_mdlec};

/// Maximum address space of a process, in KiB: 1 GB.
const MEMORY: u32 = 1 << 20;
/// Maximum processor time of a process, in seconds. It is generous, because several tests run unoptimised code at the
/// same time.
const SECONDS: u32 = 60;

/// Runs a program in `folder` with both limits.
fn limited(folder: &Path, program: &Path, arguments: &[impl AsRef<OsStr>]) -> Output {
    let limits = format!("ulimit -v {MEMORY} && ulimit -t {SECONDS} && exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.arg("-c").arg(limits).arg(program).args(arguments);
    command.current_dir(folder).env("MDLEC_CACHE", cache()).output().expect("a shell")
}

/// Returns the exit status and the messages of a command; ignores its output.
fn judged(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = limited(folder, mdlec(), arguments);
    (output.status.code(), String::from_utf8(output.stderr).expect("UTF-8"))
}

/// Returns a plan `P` that uses a second plan `uses[0]` times, which uses a third plan `uses[1]` times, and so on. The
/// innermost plan is `inmost`, with its own name in place of `NAME`.
fn multiplied(uses: &[usize], inmost: &str) -> String {
    let name = |level: usize| if level == 0 { "P".to_owned() } else { format!("L{level}") };
    let levels = uses.iter().enumerate().map(|(level, uses)| {
        let used = vec![name(level + 1); *uses].join(" ");
        format!("{{ {} {used} }}\n", name(level))
    });
    levels.collect::<String>() + &inmost.replace("NAME", &name(uses.len()))
}

/// Returns a condition of `count` operands.
fn operands(count: usize) -> String {
    let operands: Vec<_> = (1..=count).map(|number| format!("wait {number}ms")).collect();
    operands.join(" OR ")
}

/// Commands that read a plan, except commands that only parse its text.
const COMMANDS: [&[&str]; 14] = [
    &["check"],
    &["check", "--target", "all"],
    &["analyze"],
    &["trace", "--script", "script.jsonl"],
    &["trace", "--script", "script.jsonl", "--machine", "table"],
    &["draw"],
    &["--emit", "plan"],
    &["--emit", "nondegenerate"],
    &["--emit", "expanded"],
    &["--emit", "fsm"],
    &["--emit", "matrices=matrices"],
    &["--emit", "scxml"],
    &["--emit", "formal"],
    &["--emit", "rust", "--target", "sim"],
];

fn with_plan(test: &str, plan: &str) -> std::path::PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), plan).unwrap();
    fs::write(folder.join("script.jsonl"), "{\"t\": 0}\n{\"t\": 0.5, \"fired\": [\"bumper\"]}\n").unwrap();
    folder
}

/// Asserts that every command refuses a plan with E0501 and this message.
fn assert_refused(test: &str, plan: &str, message: &str) {
    let folder = with_plan(test, plan);
    for command in COMMANDS {
        let (status, messages) = judged(&folder, &[command, &["plan.mdle"]].concat());
        let start: String = messages.chars().take(1000).collect();
        assert_eq!(status, Some(1), "{command:?}: {start}");
        // `check --target all` prints a table first.
        assert!(messages.contains(message) && messages.contains("error[E0501]: "), "{command:?}: {start}");
    }
}

#[test]
fn scopes_and_loops_that_plans_multiply_are_limited() {
    let levels = (0..18).map(|level| format!("{{ P{level} (wait 9s) P{0} P{0}^2 }}\n", level + 1));
    let plan = levels.collect::<String>() + "{ P18 (Atom (wait 9s) stop) }\n";
    let message = "`P1` has 524286 atoms, scopes and loops once every plan by name is copied in; the limit is 262144";
    assert_refused("levels", &plan, message);
}

#[test]
fn operands_that_plans_multiply_are_limited() {
    let plan = multiplied(&[26; 4], &format!("{{ NAME (Atom ({}) stop) }}\n", operands(1000)));
    let message = "`L2` has 676000 operands of conditions once every plan by name is copied in; the limit is 524288";
    assert_refused("operands", &plan, message);
    let plan = multiplied(&[10; 4], &format!("{{ NAME (Atom ({}) stop) }}\n", operands(1000)));
    let message = "error[E0501]: `L1` has 1000000 operands of conditions";
    assert_refused("fewer_operands", &plan, message);
    // The message also names the use that multiplies the operands.
    assert_refused("fewer_operands", &plan, "`L2` is used 10 times, with 100000 operands of conditions each time");
}

#[test]
fn names_that_plans_multiply_are_limited() {
    let long = "N".repeat(100_000);
    let plan = multiplied(
        &[26, 26, 26],
        &format!("{{ NAME {} }}\n{{ {long} (Atom (wait 1) stop) }}\n", vec![&*long; 26].join(" ")),
    );
    assert_refused("names", &plan, "bytes of text once every plan by name is copied in; the limit is 67108864");
    let text = format!("{{ NAME (Atom (wait 1) path \"{}\") }}\n", "f".repeat(100_000));
    assert_refused("texts", &multiplied(&[26; 4], &text), "bytes of text");
}

#[test]
fn arguments_that_plans_multiply_are_limited() {
    let long = "f".repeat(100_000);
    let uses = |name: &str, argument: &str| vec![format!("{name}({argument})"); 26].join(" ");
    let plan = format!(
        "{{ P {} }}\n{{ A(p: robot) {} }}\n{{ B(p: robot) {} }}\n{{ C(p: robot) (Atom (sync p) stop) }}\n",
        uses("A", &long),
        uses("B", "p"),
        uses("C", "p")
    );
    assert_refused("arguments", &plan, "bytes of text");
}

/// Asserts that a plan has no errors, and that each of these commands prints a result or names a limit.
fn assert_ends(test: &str, plan: &str, commands: &[&[&str]]) {
    let folder = with_plan(test, plan);
    let (status, messages) = judged(&folder, &["check", "plan.mdle"]);
    assert_eq!(status, Some(0), "{}", messages.chars().take(1000).collect::<String>());
    for command in commands {
        let (status, messages) = judged(&folder, &[command, &["plan.mdle"][..]].concat());
        let start: String = messages.chars().take(1000).collect();
        let is_reported =
            status == Some(1) && (messages.contains("error[E0501]: ") || messages.contains("error[E0502]: "));
        assert!(status == Some(0) || is_reported, "{command:?}: {status:?}: {start}");
    }
}

const ANALYZE: &[&str] = &["analyze"];
const RUST: &[&str] = &["--emit", "rust", "--target", "sim"];

#[test]
fn the_most_atoms_come_to_a_result() {
    let atom =
        |condition: &str| multiplied(sized(&[18; 3], &[18; 4]), &format!("{{ NAME (Atom ({condition}) stop) }}\n"));
    assert_ends("atoms", &atom("wait 1"), &[ANALYZE, RUST, &["--emit", "fsm"], &["draw"]]);
    assert_ends("memories", &atom("RISING bumper"), &[&["check"]]);
}

#[test]
fn the_most_operands_and_texts_come_to_a_result() {
    let uses: &[usize] = sized(&[16, 1], &[16, 16, 8, 1]);
    let plan = multiplied(uses, &format!("{{ NAME (Atom ({}) stop) }}\n", operands(255)));
    assert_ends("most_operands", &plan, &[ANALYZE, RUST]);
    let long = "N".repeat(8000);
    let plan = multiplied(&[20; 3], &format!("{{ NAME {long} }}\n{{ {long} (Atom (wait 1) stop) }}\n"));
    assert_ends("most_text", &plan, &[ANALYZE, &["--emit", "plan"]]);
}

#[test]
fn operands_that_cannot_fire_are_analysed_in_linear_time() {
    let atom = "{ NAME (Atom (bumper AND NOT bumper OR wait 1) stop) }\n";
    assert_ends("never", &multiplied(sized(&[18; 3], &[18; 4]), atom), &[ANALYZE]);
}

#[test]
fn signs_before_brackets_are_read_in_linear_time() {
    let [signs, ends] = ["-(", ")"].map(|text| text.repeat(50_000));
    let folder = with_plan("signs", &format!("{{ P (Atom (v > {signs}1{ends}) stop) }}\n"));
    let (status, messages) = judged(&folder, &["check", "plan.mdle"]);
    assert!(status == Some(1) && messages.contains("unexpected character `-`"), "{status:?}: {messages}");
}

#[test]
fn loops_multiply_conditions_within_limits() {
    let plan = format!("{{ P ExecPlan 90000 {{ (Atom ({}) stop) }} }}\n", operands(1000));
    let folder = with_plan("loops", &plan);
    for kind in ["expanded", "fsm", "scxml"] {
        let (status, messages) = judged(&folder, &["plan.mdle", "--emit", kind]);
        let is_reported = messages.contains("error[E0502]: ");
        assert!(status == Some(1) && is_reported, "{kind}: {status:?}: {messages}");
    }
    assert_ends("loops", &plan, &[ANALYZE, RUST]);
}

#[test]
fn limits_are_asked_before_a_plan_is_lowered() {
    // This warning needs the plan's machine; it is not printed for a plan that is not lowered to a machine.
    let never = "(Atom (bumper AND NOT bumper OR wait 1) stop)";
    let assert_is_asked = |test: &str, plan: &str, commands: &[&[&str]], limit: &str| {
        let folder = with_plan(test, plan);
        let (status, warnings) = judged(&folder, &["check", "plan.mdle"]);
        assert!(status == Some(0) && warnings.contains("warning["), "{warnings}");
        for command in commands {
            let (status, messages) = judged(&folder, &[command, &["plan.mdle"][..]].concat());
            assert!(status == Some(1) && messages.contains(limit), "{command:?}: {messages}");
            assert!(!messages.contains("warning["), "{command:?}: {messages}");
        }
    };
    let atoms = vec!["(Atom (wait 1) stop)"; 1000].join(" ");
    let plan = format!("{{ P ExecPlan 100 {{ {never} {atoms} }} }}\n");
    let pictures: [&[&str]; 3] = [&["draw"], &["--emit", "dot"], &["--emit", "mermaid"]];
    assert_is_asked("pictures", &plan, &pictures, "this plan has 1001 atoms; a picture shows 1000 at most");
    let expanded = ["expanded", "fsm", "matrices", "scxml"].map(|kind| ["--emit", kind]);
    let traces = ["table", "matrix"].map(|machine| ["trace", "--script", "script.jsonl", "--machine", machine]);
    let forms: Vec<&[&str]> =
        expanded.iter().map(|form| &form[..]).chain(traces.iter().map(|form| &form[..])).collect();
    assert_is_asked(
        "states",
        &plan,
        &forms,
        "expanded, this plan has 100101 states; an expanded form has at most 100000",
    );
    let long = format!("{{ P {never} {} }}\n{{ L (Atom ({}) stop) }}\n", vec!["L"; 270].join(" "), operands(1000));
    assert_is_asked("rust", &long, &[RUST], "Rust is emitted for 262144 in all");
}

/// Returns an image of this size in the format PGM. A pixel is black if `stands` returns `true` for its column and row.
fn image(width: usize, height: usize, stands: impl Fn(usize, usize) -> bool) -> Vec<u8> {
    let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    bytes.extend(pixels.map(|(column, row)| if stands(column, row) { 0 } else { 254 }));
    bytes
}

/// Returns the text of `count` parallel walls of 200 km, at a distance of `apart` metres.
fn long_walls(count: usize, apart: f64) -> String {
    let wall = |number: usize| {
        let x = 5.0 + number as f64 * apart;
        format!("[[wall]]\npoints = [[{x}, -1e5], [{x}, 1e5]]\n")
    };
    (0..count).map(wall).collect()
}

#[test]
fn worlds_are_ready_or_refused() {
    let folder = folder("worlds_within_limits");
    fs::write(folder.join("rest.mdle"), "{ Rest (Atom (wait 10ms) stop) }\n").unwrap();
    let built = run_mdlec(&folder, &["rest.mdle", "--target", "sim"]);
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let map = |name: &str, image: &[u8]| {
        let origin = "resolution: 0.05\norigin: [-500, -100, 0]\n";
        fs::write(folder.join(format!("{name}.yaml")), format!("image: {name}.pgm\n{origin}")).unwrap();
        fs::write(folder.join(format!("{name}.pgm")), image).unwrap();
    };
    let (width, height) = (3000, 1000);
    let edge = |column, row| row == 0 || row + 1 == height || column == 0 || column + 1 == width;
    map("comb", &image(width, height, |column, row| edge(column, row) || (column % 2 == 0 && row + 2 < height)));
    map("dots", &image(4000, 4000, |column, row| column % 2 == 1 && row % 2 == 1));
    fs::write(folder.join("long.toml"), long_walls(3000, 0.001)).unwrap();
    fs::write(folder.join("longer.toml"), long_walls(20_000, 0.001)).unwrap();
    fs::write(folder.join("large.toml"), "[[wall]]\npoints = [[2, 0], [3, 0]]\n".repeat(1_000_000)).unwrap();
    for (world, status, message) in [
        ("comb.yaml", 0, ""),
        ("dots.yaml", 2, "dots.pgm: what stands has more than 4000000 sides of pixels"),
        ("long.toml", 0, ""),
        ("longer.toml", 2, "20000 walls and sides lie too close together for the size of the world"),
        ("large.toml", 2, "a world of 35000000 bytes is too large; expected at most 8388608"),
    ] {
        let run = limited(&folder, &folder.join("rest"), &["--speed", "max", "--world", world]);
        let messages = String::from_utf8(run.stderr).expect("UTF-8");
        assert_eq!(run.status.code(), Some(status), "{world}: {messages}");
        assert!(messages.contains(message), "{world}: {messages}");
    }
}
