//! Tests the command line of `mdle run`: its messages, and its exit statuses if nothing is run.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use mdle_tests::executable::{folder, mdle, run_mdlec};

/// A plan that drives ahead for two seconds.
const PLAN: &str = "{ Ahead (bumper)\n  (Atom (wait 2s) (go 20 0))\n}\n";

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs `mdle` with these arguments, and returns its standard output, its standard error and its exit status.
fn report(folder: &Path, line: &str) -> String {
    let Output { status, stdout, stderr } = run(folder, &line.split(' ').collect::<Vec<_>>());
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("$ mdle {line}\n{out}{err}[{}]\n", status.code().unwrap())
}

fn with_plan(test: &str) -> std::path::PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    folder
}

#[test]
fn failures_to_run_have_a_help() {
    let folder = with_plan("refused");
    fs::write(folder.join("two.mdle"), "{ A (Atom (wait 1) stop) }\n{ B (Atom (wait 1) stop) }\n").unwrap();
    fs::write(folder.join("bad.mdle"), "{ P (Atom (bumber) stop) }\n").unwrap();
    let lines = [
        "run missing.mdle --target sim",
        "run . --target sim",
        "run plan --target sim",
        "run plan.mdle",
        "run plan.mdle --target sym",
        "run plan.mdle --target ./rover",
        "run two.mdle --target sim",
        "run two.mdle --target sim --plan C",
        "run bad.mdle --target sim",
        "run --world office plan.mdle",
        "run plan.mdle --target sim --wrold office",
        "run plan.mdle --target sim --pont 1,2",
        "run plan.mdle --target sim --comands a.txt",
        "run plan.mdle --target sim --world moon",
        "run plan.mdle --target sim --turns 0",
        "run plan.mdle --target sim --log plan.mdle",
        "run plan.mdle --target sim --log -",
        "man repley",
        "man log cut up",
        "completions tcsh",
    ];
    insta::assert_snapshot!(lines.map(|line| report(&folder, line)).join("\n"));
    assert_eq!(fs::read_to_string(folder.join("plan.mdle")).unwrap(), PLAN);
}

#[test]
fn help_names_every_option() {
    let folder = with_plan("help");
    insta::assert_snapshot!(
        ["--help", "run --help", "shell --help", "new-module --help", "test --help"]
            .map(|line| report(&folder, line))
            .join("\n")
    );
    let help = report(&folder, "run plan.mdle --target sim --help");
    assert!(help.contains("Usage: mdle run plan.mdle --target sim [OPTIONS]\n"), "{help}");
    assert!(help.contains("--start-noise") && help.ends_with("[0]\n"), "{help}");
}

/// All commands about records have the same exit statuses.
#[test]
fn commands_about_records_describe_themselves() {
    let folder = folder("record-help");
    let lines = [
        "why --help",
        "log --help",
        "log cut --help",
        "log export --help",
        "plot --help",
        "why run.mcap",
        "log export",
    ];
    let helps = lines.map(|line| report(&folder, line)).join("\n");
    let rule = "1 if the record was changed, or the plan has errors or is not that of the record; 2 for wrong usage";
    assert_eq!(helps.matches(rule).count(), 3, "{helps}");
    insta::assert_snapshot!(helps);
}

#[test]
fn shells_and_man_know_every_command_of_mdle() {
    let folder = folder("mdle_manual");
    let text = |line: &str| String::from_utf8(run(&folder, &line.split(' ').collect::<Vec<_>>()).stdout).unwrap();
    let help = text("--help");
    let listed = help.split("Commands:\n").nth(1).unwrap().lines().take_while(|line| line.starts_with("  "));
    let commands: Vec<_> = listed.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() > 9, "{commands:?}");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = text(&format!("completions {shell}"));
        assert!(commands.iter().all(|command| script.contains(command)) && script.contains("deny-warnings"), "{shell}");
    }
    fs::write(folder.join("mdle.bash"), text("completions bash")).unwrap();
    let typed = "COMP_WORDS=(mdle re); COMP_CWORD=1; _mdle mdle re mdle; echo ${COMPREPLY[@]}";
    let script = format!("source ./mdle.bash; {typed}");
    let completed = Command::new("bash").args(["-c", &script]).current_dir(&folder).output().unwrap();
    assert_eq!(String::from_utf8(completed.stdout).unwrap(), "replay\n");
    let [all, replay, cut] = ["man", "man replay", "man log cut"].map(|line| text(line).replace('\\', ""));
    assert!(all.contains(".TH mdle 1"), "{all}");
    let source = format!("\"mdle {}\"", env!("CARGO_PKG_VERSION"));
    assert!([&all, &replay, &cut].iter().all(|page| page.contains(&source)), "{cut}");
    assert!(commands.iter().all(|command| all.contains(&format!("mdle-{command}(1)"))), "{all}");
    assert!(replay.contains(".TH mdle-replay 1") && replay.contains("--until"), "{replay}");
    assert!(cut.contains(".TH mdle-log-cut 1") && cut.contains("TIME"), "{cut}");
}

#[test]
fn a_bad_plan_has_the_messages_of_the_compiler() {
    let folder = folder("messages");
    for (name, text) in [("one", "{ P (Atom (bumber) stop) }\n"), ("many", "{ P (Atom (bumper) go 1\n) ) ^ { }\n")] {
        let file = format!("{name}.mdle");
        fs::write(folder.join(&file), text).unwrap();
        let [mdlec, mdle] =
            [run_mdlec(&folder, &["run", &file, "--target", "sim"]), run(&folder, &["run", &file, "--target", "sim"])];
        assert_eq!((mdle.status.code(), mdle.stderr), (Some(1), mdlec.stderr), "{name}");
        assert_eq!(mdlec.status.code(), Some(1));
    }
    let latin = b"{ P (Atom (bumper) stop) } -- \xE4\n";
    fs::write(folder.join("latin.mdle"), latin).unwrap();
    let [mdlec, mdle] = [
        run_mdlec(&folder, &["run", "latin.mdle", "--target", "sim"]),
        run(&folder, &["run", "latin.mdle", "--target", "sim"]),
    ];
    assert_eq!((mdle.status.code(), mdle.stderr), (mdlec.status.code(), mdlec.stderr));
}

#[test]
fn the_settings_beside_a_plan_hold_for_its_run() {
    let folder = with_plan("settings");
    fs::write(folder.join("mdle.toml"), "target = \"sim\"\nworld = \"hall\"\n\n[options]\nspeed = \"max\"\n").unwrap();
    let run = report(&folder, "run plan.mdle");
    assert!(run.contains("plan over: wait 2s") && run.ends_with("[0]\n"), "{run}");
    assert_eq!(
        run.replace("run plan.mdle", ""),
        report(&folder, "run plan.mdle --world hall").replace("run plan.mdle --world hall", "")
    );
    fs::write(folder.join("mdle.toml"), "target = \"sim\"\n\n[options]\nspede = \"max\"\n").unwrap();
    insta::assert_snapshot!(report(&folder, "run plan.mdle"));
    fs::write(folder.join("mdle.toml"), "target = \"./rover\"\n").unwrap();
    assert!(
        report(&folder, "run plan.mdle").starts_with("$ mdle run plan.mdle\nerror: `mdle` has no target `./rover`")
    );
}

#[test]
fn the_settings_beside_a_plan_name_its_modules() {
    let folder = with_plan("settings_modules");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("near.mdle", "{ Near (range(ears module) < 1m) (Atom (null) stop) }\n");
    let ears = "echo '{\"publishes\": {\"range\": \"m\"}}'; while read line; do echo '{\"range\": 0.25}'; done";
    write("near.sh", ears);
    let settings = "target = \"sim\"\n\n[options]\nspeed = \"max\"\n\n[modules]\n";
    write("mdle.toml", &format!("{settings}ears = \"exec sh near.sh\"\n"));
    let own = report(&folder, "run near.mdle");
    assert!(own.contains("range(ears module) = 0.25 m < 1m") && own.ends_with("[0]\n"), "{own}");
    let replaced = report(&folder, "run near.mdle --module ears=true");
    assert!(replaced.contains("module `ears` cannot be loaded: its process has ended"), "{replaced}");
    let wrong =
        ["ears = 7\n", "2 = \"true\"\n", "ears = \"true\"\nsensors = \"true\"\n", "mdle = \"true\"\n"].map(|line| {
            write("mdle.toml", &format!("{settings}{line}"));
            report(&folder, "run near.mdle")
        });
    write("mdle.toml", "target = \"sim\"\nmodules = \"ears\"\n");
    insta::assert_snapshot!(format!("{}{}", wrong.concat(), report(&folder, "run near.mdle")));
}

#[test]
fn the_settings_beside_a_plan_name_its_safety_rules() {
    let folder = with_plan("settings_safety");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    let settings = "target = \"sim\"\nworld = \"hall\"\nsafety = \"rules.toml\"\n\n[options]\nspeed = \"max\"\n";
    write("mdle.toml", settings);
    let missing = report(&folder, "run plan.mdle");
    write("rules.toml", "[guards.far]\nwhen = \"x > 20cm\"\nthen = \"end\"\n");
    write("none.toml", "# no rules\n");
    let own = report(&folder, "run plan.mdle --log run.mcap");
    let info = report(&folder, "log info run.mcap");
    assert!(info.contains("--safety rules.toml"), "{info}");
    let replaced = report(&folder, "run plan.mdle --safety none.toml");
    assert!(replaced.ends_with("[0]\n"), "{replaced}");
    let navigated = report(&folder, "navigate plan.mdle A B");
    insta::assert_snapshot!([missing, own, navigated].join("\n"));
}

#[test]
fn safety_rules_stand_between_plan_and_robot() {
    let folder = with_plan("safety");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("none.toml", "# no rules\n");
    write("end.toml", "[guards.far]\nwhen = \"x > 20cm\"\nthen = \"end\"\n");
    write("back.toml", "[guards.far]\nwhen = \"x > 20cm\"\nthen = \"plans/back.mdle\"\n");
    write("wrong.toml", "\n[limits]\nspeed = 3\n");
    write("condition.toml", "[guards.far]\nwhen = \"x > 20kg\"\nthen = \"end\"\n");
    write("memory.toml", "[guards.far]\nwhen = \"wait 3s\"\nthen = \"end\"\n");
    write("lost.toml", "[contact]\nthen = \"lost.mdle\"\n");
    fs::write(folder.join("latin.toml"), b"# \xE4\n").unwrap();
    fs::create_dir_all(folder.join("plans")).unwrap();
    write("plans/back.mdle", "{ Back (wait 1s) (Atom (null) (go -20 0)) }\n");
    let fast = "--target sim --speed max --world hall";
    let plain = report(&folder, &format!("run plan.mdle {fast}"));
    let unruled = report(&folder, &format!("run plan.mdle {fast} --safety none.toml"));
    let warning = "warning: the safety file none.toml has no rules: only an input that is no number ends the plan\n";
    let unruled = unruled.replace(warning, "");
    assert_eq!(unruled.split_once('\n').unwrap().1, plain.split_once('\n').unwrap().1);
    write("forward.toml", "[guards.near]\nwhen = \"x > 20cm\"\nthen = \"hold forward\"\n");
    let forward = report(&folder, &format!("run plan.mdle {fast} --safety forward.toml"));
    assert!(forward.contains("  safety: near holds the robot from driving forwards\n"), "{forward}");
    write("apart.toml", "[[fence]]\ninside = [[1, -1], [3, -1], [3, 1], [1, 1]]\ndeceleration = \"0.5m/s2\"\n");
    let apart = report(&folder, &format!("run plan.mdle {fast} --safety apart.toml"));
    assert!(
        apart.contains("warning: the robot starts outside `fence`, at x = 0.00 m, y = 0.00 m by odometry: "),
        "{apart}"
    );
    write(
        "narrow.toml",
        "[[fence]]\ninside = [[-0.5, -1], [3, -1], [3, 1], [-0.5, 1]]\nmargin = \"60cm\"\ndeceleration = \"1m/s2\"\n",
    );
    let within = report(&folder, &format!("run plan.mdle {fast} --safety narrow.toml"));
    assert!(within.contains("warning: the robot starts within the margin of `fence`, at x = 0.00 m"), "{within}");
    write("broken.toml", "\n[contact]\nthen = \"plans/broken.mdle\"\n");
    write("plans/broken.mdle", "{ Broken (wiat 1s) (Atom (null) stop) }\n");
    write("path.toml", "\n[contact]\nthen = \"plans/path.mdle\"\n");
    write("plans/path.mdle", "{ Path (null) (Atom (null) path(hall)) }\n");
    let files = ["end", "back", "wrong", "condition", "memory", "lost", "broken", "path", "latin", "missing"];
    let runs = files.map(|file| report(&folder, &format!("run plan.mdle {fast} --safety {file}.toml")));
    let written = report(&folder, &format!("run plan.mdle {fast} --safety back.toml --log plans/back.mdle"));
    insta::assert_snapshot!(format!("{}\n{written}", runs.join("\n")));
}

#[test]
fn names_that_no_new_module_can_have() {
    let folder = with_plan("new_module");
    fs::create_dir(folder.join("there")).unwrap();
    let names = ["there", "plan.mdle", "sensors", "mdle", "match", "My-Ears", "../ears", "2ears", ""];
    let refused = names.map(|name| report(&folder, &format!("new-module {name}")));
    let others = ["new-module", "new-module ears --checkout .", "new-module ears --checkout missing", "new-module a b"];
    let others = others.map(|line| report(&folder, line));
    insta::assert_snapshot!([refused.as_slice(), others.as_slice()].concat().join("\n"));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "nothing is written");
}

#[test]
fn a_plan_comes_from_standard_input() {
    let folder = folder("standard_input");
    let mut command = Command::new(mdle());
    command.args(["run", "-", "--target", "sim", "--speed", "max"]).current_dir(&folder);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(PLAN.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("plan over: wait 2s (standard input:2"), "{text}");
}
