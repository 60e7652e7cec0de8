//! Tests runs in which plans replace each other, and runs with modules: every command about records processes all
//! turns.

use std::fs;
use std::path::{Path, PathBuf};

use mdle_tests::executable::folder;

use super::asked;

const FILES: [(&str, &str); 4] = [
    ("out.mdle", "{ Out (wait 30s)\n  ((Atom (wait 2s) (go 20 0)) (Atom (wait 1s) (go 0 0.5)))^inf\n}\n"),
    ("back.mdle", "{ Back (bumper)\n  (Atom (wait 1s) (go -20 0))\n  (Atom (r0 < 10cm) (go 0 0.2))\n}\n"),
    ("commands", "load_plan back.mdle\nstep 45\nswap Back now\nstep 20\nrollback\nstep 25\nquit\n"),
    (
        "sound.mdle",
        "{ Sound (wait 20s)\n  (Atom (range(heading module) < 60cm) goAvoid(heading module))\n  (Atom (wait 1s) stop)\n}\n",
    ),
];

/// Returns a folder with `run.mcap`, the record of a run with these arguments.
fn recorded(name: &str, call: &str) -> PathBuf {
    let folder = folder(&format!("why-{name}"));
    for (name, text) in FILES {
        fs::write(folder.join(name), text).unwrap();
    }
    let options = "--target sim --world hall --speed max --log run.mcap";
    let ran = all(&folder, &[&format!("{call} {options}")]);
    assert!(ran.ends_with("[0]\n"), "{ran}");
    folder
}

/// Returns the answers to these calls of `mdle`, in order.
fn all(folder: &Path, calls: &[&str]) -> String {
    calls.iter().map(|call| asked(folder, &call.split(' ').collect::<Vec<_>>())).collect::<Vec<_>>().join("\n")
}

#[test]
fn answers_go_on_where_plans_replace_each_other() {
    let folder = recorded("several-plans", "shell out.mdle --paused -c commands");
    let calls = [
        // The first plan runs up to the turn in which another plan takes over.
        "why run.mcap 4.2",
        "why run.mcap 4.5",
        "why run.mcap 6",
        // The first plan continues where it was.
        "why run.mcap 6.5",
        "why run.mcap 8",
        "why run.mcap --not stop",
        // Atoms of the plan that was replaced, and of the plan that drove at the end.
        "why run.mcap --not back.mdle:3",
        "why run.mcap --not out.mdle:2",
    ];
    insta::assert_snapshot!(all(&folder, &calls));
}

#[test]
fn safety_rules_are_named_with_their_conditions() {
    let folder = folder("why-guards");
    let files = [
        ("ahead.mdle", "{ Ahead (wait 60s) (Atom (null) (go 60 0)) }\n"),
        ("back.mdle", "{ Back (wait 2s) (Atom (null) (go -20 0)) }\n"),
        ("ends.toml", "[guards.near]\nwhen = \"r0 < 60cm AND NOT bumper\"\nthen = \"end\"\n"),
        ("diverts.toml", "[guards.near]\nwhen = \"r0 < 60cm AND NOT bumper\"\nthen = \"back.mdle\"\n"),
    ];
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
    for rules in ["ends", "diverts"] {
        let run =
            format!("run ahead.mdle --target sim --world hall --speed max --safety {rules}.toml --log {rules}.mcap");
        assert!(all(&folder, &[&run]).ends_with("[6]\n"));
    }
    let answers = all(&folder, &["why ends.mcap 26.6", "why diverts.mcap 26.6", "why diverts.mcap 26.7"]);
    let condition = "near (ends.toml:2, \"r0 < 60cm AND NOT bumper\")";
    assert!(answers.contains(&format!("and 0 m/s, 0 rad/s was sent  <- safety ended: {condition}")), "{answers}");
    let diverted = "go -20 0 (back.mdle:1) ran from this turn on  <- safety: near (diverts.toml:2, ";
    assert!(answers.contains(diverted), "{answers}");
    let replaced =
        "go 60 0 (ahead.mdle:1) ran for 26.7 s until another plan took over  <- safety: near (diverts.toml:2, ";
    assert!(answers.contains(replaced), "{answers}");
    let json = all(&folder, &["why --json ends.mcap 26.6", "why --json diverts.mcap 26.7"]);
    assert!(json.contains("\"safety\":\"ended: near (ends.toml:2, "), "{json}");
    assert!(json.contains("\"began\":\"safety: near (diverts.toml:2, ") && json.contains("\"replaced\":{"), "{json}");
}

#[test]
fn a_plan_that_goes_on_ran_since_it_was_entered() {
    let folder = recorded("goes-on", "shell out.mdle --paused -c commands");
    let answer = all(&folder, &["why run.mcap 6.5"]);
    assert!(answer.contains(" but for 2.0 s in which another plan drove  <- rolled back"), "{answer}");
    assert!(answer.contains("(back.mdle:3) ran for") && answer.contains("until another plan took over"), "{answer}");
}

#[test]
fn a_plan_that_takes_over_is_a_transition() {
    let folder = recorded("take-over", "shell out.mdle --paused -c commands");
    fs::write(folder.join("steps"), "next\nnext\nnext\nnext\nnext\n").unwrap();
    let steps = all(&folder, &["replay --step run.mcap -c steps"]);
    let turns: Vec<_> = steps.lines().filter(|line| line.starts_with("turn ")).collect();
    assert!(turns.iter().any(|turn| turn.starts_with("turn 45 at 4.5 s")), "{steps}");
    assert!(turns.iter().any(|turn| turn.starts_with("turn 65 at 6.5 s")), "{steps}");
    let table = all(&folder, &["log export --csv run.mcap"]);
    let rows = table.lines().skip(2).filter(|line| line.contains(',')).collect::<Vec<_>>();
    let plan = |row: &str| row.split(',').nth(2).unwrap().to_owned();
    let others = rows.windows(2).filter(|pair| plan(pair[0]) != plan(pair[1])).count();
    assert_eq!(others, 2, "{table}");
    let info = all(&folder, &["log info run.mcap"]);
    let causes = rows.iter().filter(|row| row.contains("<") || row.contains("wait")).count();
    assert!(info.contains(&format!("transitions  {}\n", others + causes)), "{info}{table}");
}

#[test]
fn pictures_have_the_atoms_of_all_plans() {
    let folder = recorded("several-drawn", "shell out.mdle --paused -c commands");
    let drawn = all(&folder, &["plot run.mcap path.svg", "plot run.mcap time.svg --over-time"]);
    assert_eq!(drawn.matches("[0]\n").count(), 2, "{drawn}");
    for file in ["path.svg", "time.svg"] {
        let picture = fs::read_to_string(folder.join(file)).unwrap();
        let laws = ["go 20 0", "go 0 0.5", "go -20 0", "go 0 0.2"];
        assert!(laws.iter().all(|law| picture.contains(law)), "{file}: {picture}");
    }
    let script = all(&folder, &["log export --script run.mcap -o run.script"]);
    assert!(script.ends_with("another plan drove: a script is for one plan, and ends before it\n[2]\n"), "{script}");
    assert_eq!(fs::read_to_string(folder.join("run.script")).unwrap().lines().count(), 45);
}

#[test]
fn a_plan_that_reads_modules_is_explained() {
    let folder = recorded("modules", "run sound.mdle --point 2,1");
    let calls = ["why run.mcap 0", "why run.mcap 0.1", "why run.mcap 3", "why run.mcap --not stop"];
    insta::assert_snapshot!(all(&folder, &calls));
    let others = all(&folder, &["plot run.mcap run.svg", "log export --script run.mcap -o run.script"]);
    assert_eq!(others.matches("[0]\n").count(), 2, "{others}");
    let script = fs::read_to_string(folder.join("run.script")).unwrap();
    assert!(script.contains("\"fired\":[\"range heading module < 0.6\"]"), "{script}");
}
