//! Tests that robots of a scenario send each other attributes of modules, and plans, over the link in addition to their
//! states.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::Command;

use mdle_tests::executable::{folder, mdle};

/// A room with a source of constant noise.
const ROOM: &str = "t60 = 0.24\n[[wall]]\npoints = [[-2, -3], [5, -3], [5, 3], [-2, 3], [-2, -3]]\n\
                    [[sound]]\nat = [3, 1]\nkind = \"white\"\n";

/// Runs `mdle` with these arguments; returns its output, its messages and its exit status.
pub(super) fn run(folder: &Path, words: &str) -> (String, String, i32) {
    let output = Command::new(mdle()).args(words.split(' ')).current_dir(folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (out, err, output.status.code().unwrap())
}

/// Writes a scenario of `ada` and `bob`, 1 m apart, each with additional entries and a plan. `more` is appended to the
/// scenario.
pub(super) fn scenario(folder: &Path, [ada, bob]: [(&str, &str); 2], more: &str) {
    let mut text = "world = \"room.toml\"\nseed = 1\n".to_owned();
    for (name, (keys, plan), start) in [("ada", ada, "0, 0, 0"), ("bob", bob, "0, 1, 0")] {
        fs::write(folder.join(format!("{name}.mdle")), plan).unwrap();
        text += &format!("[[robot]]\nname = \"{name}\"\nfile = \"{name}.mdle\"\nstart = \"{start}\"\n{keys}\n");
    }
    fs::write(folder.join("room.toml"), ROOM).unwrap();
    fs::write(folder.join("two.toml"), text + more).unwrap();
}

/// Asserts that the record of a robot replays to the bit.
fn assert_replayed(folder: &Path, robot: &str) {
    let (out, err, status) = run(folder, &format!("replay run.{robot}.mcap"));
    assert!(out.starts_with("the same to the bit, ") && status == 0, "{robot}: {out}{err}");
}

#[test]
fn a_plan_reads_a_module_of_another_robot() {
    let folder = folder("shared_modules");
    let ada = "{ A (wait 20s OR age(bob_sensors module) > 500ms)\n\
               (Atom (range(bob_heading module) > 1m) stop)\n(Atom (null) (go 1 0)) }";
    let bob = "ears = \"8.75cm\"\nshares = [\"heading\", \"sensors\"]\nkilled = \"4s\"";
    scenario(&folder, [("", ada), (bob, "{ B (wait 20s) (Atom (null) stop) }")], "");
    let (out, err, status) = run(&folder, "run two.toml --log run.mcap");
    assert!(
        status == 4 && out.contains("ada: go 1 0 (ada.mdle:3)  <- range(bob_heading module) = 2 m > 1m"),
        "{out}{err}"
    );
    // The last state that bob sends is that of the turn at 3.9 s.
    assert!(out.contains("4.6 s  ada: plan over: age(bob_sensors module) = 0.6 s > 500ms"), "{out}{err}");
    assert_replayed(&folder, "ada");
    // Lost messages make values older, but newer values still arrive.
    let losses = "\n[link]\nlatency = \"0ms..200ms\"\nloss = 0.3\n";
    scenario(&folder, [("", ada), (bob, "{ B (wait 20s) (Atom (null) stop) }")], losses);
    let (out, err, _) = run(&folder, "run two.toml --log lossy.mcap");
    assert!(out.contains("<- range(bob_heading module) = 2 m > 1m"), "{out}{err}");
}

#[test]
fn a_robot_shares_only_modules_that_it_has() {
    let folder = folder("shared_unknown");
    let stand = "{ S (wait 3s OR age(bob_heading module) > 1s) (Atom (null) stop) }";
    scenario(&folder, [("", stand), ("shares = [\"heading\"]", "{ B (wait 3s) (Atom (null) stop) }")], "");
    let (out, err, status) = run(&folder, "run two.toml");
    insta::assert_snapshot!(format!("{out}{err}[{status}]"), @"
    error: the robot `bob`: the state link is to share attributes of a module: no module `heading` is loaded
    [2]
    ");
    scenario(&folder, [("", stand), ("ears = \"8.75cm\"", "{ B (wait 3s) (Atom (null) stop) }")], "");
    let (out, _, status) = run(&folder, "run two.toml");
    assert!(status == 3 && out.contains("/usr/bob_heading/age, which no module has published within 2 s"), "{out}");
}

/// Entry with which `bob` accepts plans from `ada`. `STANDS` is a plan for either robot that ends after 8 s.
const TAKES: &str = "plans-from = [\"ada\"]";
const STANDS: &str = "{ S (wait 8s)\n(Atom (wait 5s) stop)\n(Atom (null) stop) }";

/// Returns the scenario's entry for a plan that `ada` sends to `bob` at the time `at`.
fn sent(at: &str, file: &str, when: &str) -> String {
    format!("[[sent-plan]]\nat = \"{at}\"\nfrom = \"ada\"\nto = \"bob\"\nfile = \"{file}\"\nwhen = \"{when}\"\n")
}

#[test]
fn a_plan_of_another_robot_takes_over() {
    let folder = folder("sent_plans");
    fs::write(folder.join("go.mdle"), "{ Go (wait 2s)\n(Atom (null) (go 10 0)) }").unwrap();
    for (when, begins, over) in [("now", "2.2", "4.2"), ("atom", "5.0", "7.0"), ("plan", "8.0", "10.0")] {
        let late = "\n[link]\nlatency = \"100ms\"\n";
        // The sender must still run when the plan begins.
        let ada = STANDS.replace("8s", "9s");
        scenario(&folder, [("", &ada), (TAKES, STANDS)], &(sent("2s", "go.mdle", when) + late));
        let (out, err, status) = run(&folder, "run two.toml --log run.mcap");
        assert_eq!(status, 0, "{when}: {out}{err}");
        for line in [
            format!("{begins} s  bob: go 10 0 (plan of ada:2)  <- "),
            format!("{over} s  bob: plan over: wait 2s (plan of ada:1)"),
            format!("{begins} s  bob: state link: the plan of ada: Go takes over"),
            "ada: state link: bob takes the plan: Go takes over".to_owned(),
            "9.0 s  ada: plan over: wait 9s".to_owned(),
        ] {
            assert!(out.contains(&line), "{when}: {line}\n{out}{err}");
        }
        if when != "now" {
            let waits = format!("bob: state link: the plan of ada: Go waits, and takes over when the {when} ends");
            assert!(out.contains(&waits), "{when}: {out}{err}");
        }
        assert_replayed(&folder, "bob");
    }
}

#[test]
fn a_plan_that_does_not_check_changes_nothing() {
    let folder = folder("sent_faulty");
    fs::write(folder.join("secret.mdle"), "{ Secret (wait 1s) (Atom (null) stop) }").unwrap();
    // Texts of a kilobyte that would take gigabytes of memory.
    let doubling = (1..=13).map(|n| format!("{{ P{n} (wait {n}) P{} P{} }}\n", n - 1, n - 1));
    let doubled = doubling.collect::<String>() + "{ P0 (wait 9) (Atom (wait 1) stop) }";
    let copied = |times: usize, condition: &str, count: usize| {
        let one = format!("{{ P0 ({}) (Atom (wait 1) stop) }}\n", vec![condition; count].join("\n OR "));
        format!("{{ Go (wait 9) {} }}\n{one}", vec!["P0"; times].join("\n "))
    };
    let wide = copied(40, "bumper", 600);
    let wordy = copied(50, &format!("range({} module) > 1m", "a".repeat(100)), 180);
    let roots = (0..500).map(|n| format!("{{ R{n} (wait 9) P13 }}\n")).collect::<String>() + &doubled;
    let cases = [
        ("{ Go (wait 2s) (Atom (null) (goo 10 0)) }", "there is no law called `goo`"),
        ("{ Go (wait 2s", "error"),
        ("{ A (wait 2s) (Atom (null) stop) } { B (wait 2s) (Atom (null) stop) }", "the text has several plans"),
        (
            "use \"secret.mdle\" { Go (wait 2s) Secret }",
            "the plan comes without other files, so `secret.mdle` is not read",
        ),
        ("{ Go (wait 2s) (Atom (null) path(way)) }", "the plan replays the path `way`"),
        ("{ Go (null) (Atom (null) (go 20 0)) }", "the plan never ends"),
        ("{ Go (null) ExecPlan inf { (Atom (wait 1) (go 20 0)) } }", "the plan never ends"),
        ("{ Go (wait inf) ExecPlan inf { (Atom (wait 1) (go 20 0)) } }", "the plan never ends"),
        ("{ Go (range(none module) > 1m) (Atom (null) stop) }", "/usr/none/range"),
        ("{ Go (wait 2s) (Atom (rendezvous eve) stop) }", "the plan names the robot `eve`"),
        (&doubled, "atoms, scopes and loops once every plan by name is copied in; the limit is 10000"),
        (&wide, "operands of conditions once every plan by name is copied in; the limit is 10000"),
        (&wordy, "bytes of text once every plan by name is copied in; the limit is 1000000"),
        (&roots, "the text has several plans, and one of them can drive: R0, R1…"),
    ];
    for (text, words) in cases {
        fs::write(folder.join("go.mdle"), text).unwrap();
        scenario(&folder, [("", STANDS), (TAKES, STANDS)], &sent("2s", "go.mdle", "now"));
        let (out, err, status) = run(&folder, "run two.toml --log run.mcap");
        assert_eq!(status, 0, "{text}: {out}{err}");
        let refused = "bob: warning: state link: the plan of ada is refused: ";
        let told = "ada: warning: state link: bob refuses the plan go.mdle: ";
        assert!(out.contains(refused) && out.contains(told) && out.contains(words), "{text}: {out}{err}");
        assert!(out.contains("8.0 s  bob: plan over: wait 8s (bob.mdle:1)"), "{text}: {out}{err}");
        assert_replayed(&folder, "bob");
    }
    scenario(&folder, [("", STANDS), ("", STANDS)], &sent("2s", "go.mdle", "now"));
    let (out, err, _) = run(&folder, "run two.toml");
    assert!(out.contains("the plan of ada is refused: bob takes no plans of ada"), "{out}{err}");
    assert!(out.contains("8.0 s  bob: plan over: wait 8s (bob.mdle:1)"), "{out}{err}");
}

#[test]
fn a_wrong_sent_plan_is_refused_with_place_and_cure() {
    let folder = folder("sent_wrong");
    fs::write(folder.join("go.mdle"), "{ Go (wait 2s) (Atom (null) stop) }").unwrap();
    fs::write(folder.join("long.mdle"), "{ Go (wait 2s) (Atom (null) stop) }".to_owned() + &" ".repeat(70_000))
        .unwrap();
    let good = sent("2s", "go.mdle", "now");
    let cases = [
        (TAKES, good.replace("\"bob\"", "\"bop\"")),
        (TAKES, good.replace("\"bob\"", "\"ada\"")),
        (TAKES, good.replace("go.mdle", "gone.mdle")),
        (TAKES, good.replace("go.mdle", "long.mdle")),
        (TAKES, good.replace("now", "soon")),
        (TAKES, good.replace("2s", "2m")),
        ("plans-from = [\"adda\"]", String::new()),
        ("plans-from = [\"bob\"]", String::new()),
    ];
    let messages = cases.map(|(keys, more)| {
        scenario(&folder, [("", STANDS), (keys, STANDS)], &more);
        let (_, err, status) = run(&folder, "run two.toml");
        format!("{err}[{status}]\n")
    });
    insta::assert_snapshot!(messages.join("\n"));
}
