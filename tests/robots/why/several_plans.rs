//! Runs in which plans replace each other, and runs with modules: every command about records goes through all turns.

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

/// A folder with the record `run.mcap` of this call.
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

/// The answers to these calls, one after the other.
fn all(folder: &Path, calls: &[&str]) -> String {
    calls.iter().map(|call| asked(folder, &call.split(' ').collect::<Vec<_>>())).collect::<Vec<_>>().join("\n")
}

#[test]
fn answers_go_on_where_plans_replace_each_other() {
    let folder = recorded("several-plans", "shell out.mdle --paused -c commands");
    let calls = [
        // The first plan, up to the turn in which another one takes over.
        "why run.mcap 4.2",
        "why run.mcap 4.5",
        "why run.mcap 6",
        // The first plan again, where it was.
        "why run.mcap 6.5",
        "why run.mcap 8",
        "why run.mcap --not stop",
        // Of the plan that was replaced, and of the one that drove at the end.
        "why run.mcap --not back.mdle:3",
        "why run.mcap --not out.mdle:2",
    ];
    insta::assert_snapshot!(all(&folder, &calls));
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
