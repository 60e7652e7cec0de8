//! Tests that `mdlec` never prints text from plans, file names, options or machines that could control a terminal or
//! reverse lines.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_compiler::alphabet::combine;
use mdle_compiler::compile;
use mdle_compiler::diagnostic::{SourceId, Sources, has_errors};
use mdle_compiler::rust::{Header, Shape, bind, emit_as};
use mdle_runtime::is_printable;
use mdle_tests::executable::{command, folder};
use mdle_tests::golden::alphabet;
use mdle_tests::xml;

/// Text that colors and clears a terminal, renames its window, rings the bell, returns to the start of the line, and
/// reverses text.
const HOSTILE: &str = "a\u{1b}[2J\u{1b}]0;x\u{7}\u{9b}31m\r\u{202e}\u{2066}\u{200f}\u{2028}\u{7f}z";

fn hostile(text: &str) -> String {
    text.replace("HOSTILE", HOSTILE)
}

/// Runs a command in this folder, and asserts that its output contains only printable characters.
fn printable(folder: &Path, arguments: &[&str]) -> Output {
    let output = command(folder, arguments).output().expect("mdlec runs");
    assert_printable(&output, arguments);
    output
}

fn assert_printable(output: &Output, arguments: &[&str]) {
    for (stream, bytes) in [("output", &output.stdout), ("error", &output.stderr)] {
        let text = String::from_utf8(bytes.clone()).expect("UTF-8");
        let is_shown = |letter: char| matches!(letter, '\n' | '\t') || is_printable(letter);
        let wrong: String = text.chars().filter(|letter| !is_shown(*letter)).collect();
        assert!(wrong.is_empty(), "{arguments:?}, standard {stream}: {wrong:?} in {text:?}");
        assert!(!text.contains("panicked"), "{text}");
    }
}

/// A valid plan with hostile comments and a hostile file name.
const GOOD: &str =
    "// HOSTILE\n/// HOSTILE\n{ P (bumper OR wait 1)\n  // HOSTILE\n  (Atom (wait 2) path \"HOSTILE\")\n}\n";

/// Returns a folder with the files of a test: plans, machines, alphabets and scripts.
fn prepared(test: &str) -> std::path::PathBuf {
    let folder = folder(test);
    let write = |name: &str, text: &str| fs::write(folder.join(hostile(name)), hostile(text)).unwrap();
    write("HOSTILE.mdle", GOOD);
    write("group.mdle", "{ Group [a b] P (wait 9) // HOSTILE\n  (Atom (wait 2) path \"HOSTILE\")\n}\n");
    write("wrong.mdle", "use \"HOSTILE\"\n{ P (bumpr \"HOSTILE\")\n  (Atom (null) path \"HOSTILE\" 1)\n Q HOSTILE }\n");
    write("script.jsonl", "{\"t\": 0}\n{\"HOSTILE\n");
    write("good.jsonl", "{}\n{}\n");
    let names = serde_json::to_string(HOSTILE).unwrap();
    let fsm = |laws: &str, text: &str, to: &str| {
        format!(
            "{{\"states\": [{names}, \"b\"], \"laws\": [{laws}],\n\"interrupts\": [{{\"name\": {names}, \"text\": {text},\n\
             \"moves\": {{{names}: {to}}}}}]}}"
        )
    };
    write("good.json", &fsm("\"stop\"", "\"bumper\"", "\"b\""));
    write("laws.json", &fsm(&names, "\"bumper\"", "\"b\""));
    write("text.json", &fsm("\"stop\"", &names, "\"b\""));
    write("quoted.json", &fsm("\"path \\\"\u{202e}\\\"\"", "\"bumper\"", "\"b\""));
    write("state.json", &fsm("\"stop\"", "\"bumper\"", &names.replace('z', "y")));
    write("none.json", &format!("{{\"states\": [{names}, \"b\"], \"interrupts\": []}}"));
    write("broken.json", "{\"states\": [HOSTILE");
    fs::create_dir_all(folder.join(hostile("HOSTILE/src"))).unwrap();
    write("HOSTILE/alphabet.mdle", "target x : crate y;\n/// HOSTILE\ninterrupt HOSTILE;\n");
    folder
}

#[test]
fn no_command_prints_what_a_terminal_obeys() {
    let folder = prepared("hostile_commands");
    let plan = hostile("HOSTILE.mdle");
    let plan = plan.as_str();
    let emits = ["tree", "plan", "nondegenerate", "expanded", "matrices", "dot", "mermaid", "scxml", "formal", "rust"];
    for emit in emits {
        let output = printable(&folder, &[plan, "--target", "sim", "--emit", emit]);
        assert!(output.status.success(), "{emit}: {}", String::from_utf8_lossy(&output.stderr));
    }
    for good in [&["check", "group.mdle"][..], &["group.mdle", "--emit", "projected"]] {
        assert!(printable(&folder, good).status.success(), "{good:?}");
    }
    assert!(!printable(&folder, &["group.mdle", "--emit", "dot"]).status.success());
    for good in [&["check", plan][..], &["check", "--target", "all", plan], &["analyze", plan], &["draw", plan]] {
        assert!(printable(&folder, good).status.success(), "{good:?}");
    }
    for machine in ["good.json", "laws.json", "text.json", "quoted.json", "state.json", "none.json", "broken.json"] {
        for how in [&[][..], &["--as-printed"], &["--augment"]] {
            let output = printable(&folder, &[&["decompile", machine], how].concat());
            let has_plan = machine == "good.json" || machine == "none.json" && how == ["--augment"];
            assert_eq!(
                output.status.success(),
                has_plan,
                "{machine} {how:?}: {}",
                String::from_utf8_lossy(&output.stderr)
            );
        }
    }
    for wrong in [
        &["check", "wrong.mdle"][..],
        &["check", "--target", "all", "wrong.mdle", plan],
        &["wrong.mdle", "--emit", "tree"],
        &["fmt", "--check", plan, "wrong.mdle"],
        &["trace", plan, "--script", "script.jsonl"],
        &["bind", &hostile("HOSTILE/alphabet.mdle")],
        &["quarks", "--target", HOSTILE],
        &["check", "--target", HOSTILE, plan],
    ] {
        assert!(!printable(&folder, wrong).status.success(), "{wrong:?}");
    }
}

#[test]
fn no_option_is_printed_as_a_terminal_obeys_it() {
    let folder = prepared("hostile_options");
    let plan = &hostile("HOSTILE.mdle");
    for wrong in [
        &["explain", HOSTILE][..],
        &["new-target", HOSTILE],
        &["quarks", "--target", &hostile("HOSTILE2")],
        &[plan, "--plan", HOSTILE, "--emit", "plan"],
        &[plan, "--emit", HOSTILE],
        &[plan, &hostile("--HOSTILE")],
        &[plan, "--message-format", HOSTILE],
        &[plan, "--emit", "plan", "-o", &hostile("HOSTILE.no/x")],
        &["decompile", "good.json", "--steps", HOSTILE],
        &["check", &hostile("HOSTILE.no")],
        &["check", HOSTILE],
        &["bind", HOSTILE],
        &["trace", plan, "--script", HOSTILE],
        &["decompile", HOSTILE],
        &[HOSTILE],
    ] {
        assert!(!printable(&folder, wrong).status.success(), "{wrong:?}");
    }
}

#[test]
fn layout_is_the_users_own_text_to_the_byte() {
    let folder = prepared("hostile_fmt");
    let laid_out = mdle_tests::executable::run_mdlec_reading(&folder, &["fmt", "-"], &hostile(GOOD));
    let text = String::from_utf8(laid_out.stdout).unwrap();
    assert_eq!(text.matches(HOSTILE).count(), 4, "{text:?}");
}

#[test]
fn emitted_rust_is_printable_in_every_shape() {
    let sim = alphabet(Some("sim"));
    let atoms = format!("(Atom (wait 1 OR bumper) path \"{HOSTILE}\") {{ Q (wait 2) (Atom (bumper) stop) }}");
    let text = format!("{{ P {} }}", atoms.repeat(3));
    let (compiled, found) = compile(SourceId(0), &text, &sim, None);
    assert!(!has_errors(&found), "{found:?}");
    let mut sources = Sources::default();
    sources.add(HOSTILE, text);
    for shape in [Shape::Code, Shape::Rows] {
        let rust = emit_as(shape, &compiled[0].machine, Header { sources: &sources, file: HOSTILE, plan: "P" }, &sim);
        assert!(rust.chars().all(|letter| letter == '\n' || is_printable(letter)), "{shape:?}: {rust:?}");
        assert!(syn::parse_file(&rust).is_ok_and(|file| !file.items.is_empty()), "{shape:?}: {rust}");
    }
    let own = hostile("target t : crate t;\n/// HOSTILE\ncontrol halt;\n/// HOSTILE\ninterrupt hit;\n");
    let (own, found) = mdle_compiler::alphabet::read(SourceId(0), &own);
    assert!(found.is_empty(), "{found:?}");
    let bound = bind(&combine(own.unwrap(), &[]).0);
    assert!(bound.chars().all(|letter| letter == '\n' || is_printable(letter)), "{bound:?}");
    assert!(syn::parse_file(&bound).is_ok(), "{bound}");
}

#[test]
fn an_executable_of_a_hostile_plan_is_built_runs_and_draws() {
    let folder = prepared("hostile_run");
    let plan = hostile("HOSTILE.mdle");
    let output = printable(&folder, &[&plan, "--target", "sim", "-o", "tour"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: String = (0..30).map(|turn| format!("{}.{}, 0, 10\n", turn / 10, turn % 10)).collect();
    let path = format!("time s, heading deg, speed cm/s\n{rows}");
    fs::write(folder.join(hostile("HOSTILE.csv")), path).unwrap();
    fs::write(folder.join("world.toml"), hostile("[start]\n\"HOSTILE\" = 1\n")).unwrap();
    let run = |arguments: &[&str]| {
        let output = Command::new(folder.join("tour")).args(arguments).current_dir(&folder).output().unwrap();
        assert_printable(&output, arguments);
        output
    };
    let driven = run(&["--speed", "max", "--plot", "plot.svg", "--record", "film.svg", "--turns", "5"]);
    assert_eq!(driven.status.code(), Some(4), "{driven:?}");
    for picture in ["plot.svg", "film.svg"] {
        let text = fs::read_to_string(folder.join(picture)).unwrap();
        assert!(text.contains("aU+001B[2J"), "{text}");
        assert!(text.chars().all(|letter| letter == '\n' || is_printable(letter)), "{picture}");
        assert_eq!(xml::read(&text).name, "svg");
    }
    for wrong in [
        &["--world", HOSTILE][..],
        &["--world", "world.toml"],
        &["--start", HOSTILE],
        &["--body", HOSTILE],
        &["--without", HOSTILE],
        &["--speed", HOSTILE],
        &["--paths", HOSTILE],
        &["--period", HOSTILE],
        &["--plot", &hostile("HOSTILE.no/x")],
        &["--log", &hostile("HOSTILE.no/x")],
        &[&hostile("--HOSTILE")],
    ] {
        assert_eq!(run(wrong).status.code(), Some(2), "{wrong:?}");
    }
}
