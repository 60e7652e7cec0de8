//! Tests that two processes linked over TCP exchange attributes of modules, and plans, by the clock.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use mdle_tests::executable::{folder, mdle};

use super::addresses;

/// Writes the link files of `ada` and `bob`. `keys` are additional entries for each file: for the robot itself and for
/// its peer.
fn with_links(folder: &Path, keys: [(&str, &str); 2]) {
    let [ada, bob] = addresses();
    for ((own, at, other, address), (more, peer)) in
        [("ada", ada, "bob", bob), ("bob", bob, "ada", ada)].into_iter().zip(keys)
    {
        let text = format!(
            "name = \"{own}\"\nlisten = \"{at}\"\nkey = \"key\"\n{more}\n[[robot]]\nname = \"{other}\"\naddress = \"{address}\"\n{peer}\n"
        );
        fs::write(folder.join(format!("{own}.toml")), text).unwrap();
    }
}

/// Starts `mdle` with these arguments.
fn begin(folder: &Path, words: &[&str]) -> Child {
    let mut command = Command::new(mdle());
    let command = command.args(words).args(["--target", "sim", "--world", "room"]).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for a run to end and returns its standard output, its standard error and its exit status.
fn ended(child: Child) -> String {
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("{out}{err}[{}]", status.code().unwrap())
}

pub(crate) fn a_plan_reads_a_module_of_another_process() {
    let folder = folder("tcp_modules");
    with_links(&folder, [("", ""), ("shares = [\"near\"]", "")]);
    let near = "echo '{\"publishes\": {\"range\": \"m\"}}'; while read line; do echo '{\"range\": 0.25}'; done";
    fs::write(folder.join("near.sh"), near).unwrap();
    fs::write(folder.join("stand.mdle"), "{ Stand (wait 4s) (Atom (null) stop) }").unwrap();
    let reads = "{ Reads (wait 20s OR age(bob_near module) > 1s) (Atom (range(bob_near module) < 30cm) stop) \
                 (Atom (null) stop) }";
    fs::write(folder.join("reads.mdle"), reads).unwrap();
    let bob = begin(&folder, &["run", "stand.mdle", "--link", "bob.toml", "--module", "near=exec sh near.sh"]);
    let ada = begin(&folder, &["run", "reads.mdle", "--link", "ada.toml", "--log", "ada.mcap"]);
    let [bob, ada] = [bob, ada].map(ended);
    assert!(bob.ends_with("[0]"), "{bob}");
    assert!(ada.contains("<- range(bob_near module) = 0.25 m < 30cm"), "{ada}");
    assert!(ada.contains("plan over: age(bob_near module) = ") && ada.ends_with("[0]"), "{ada}");
    let replayed = Command::new(mdle()).args(["replay", "ada.mcap"]).current_dir(&folder).output().unwrap();
    let text = String::from_utf8(replayed.stdout).unwrap();
    assert!(text.starts_with("the same to the bit, "), "{text}");
}

/// Runs a session of `ada`, which sends a plan to `bob`. `of_ada` and `of_bob` are additional entries in the link files
/// about the peer. Returns the outputs of both robots.
fn send(test: &str, [of_ada, of_bob]: [&str; 2], plan: &str) -> [String; 2] {
    let folder = folder(test);
    with_links(&folder, [("", of_ada), ("", of_bob)]);
    fs::write(folder.join("stand.mdle"), "{ Stand (wait 5s) (Atom (null) stop) }").unwrap();
    fs::write(folder.join("go.mdle"), plan).unwrap();
    let commands = "load_plan go.mdle\nwait 1500ms\ncall /link/bob/send_plan Go now\nwait\n";
    fs::write(folder.join("commands.txt"), commands).unwrap();
    let bob = begin(&folder, &["run", "stand.mdle", "--link", "bob.toml", "--log", "bob.mcap"]);
    let ada = begin(&folder, &["shell", "stand.mdle", "--link", "ada.toml", "-x", "-c", "commands.txt"]);
    let outputs = [ada, bob].map(ended);
    let replayed = Command::new(mdle()).args(["replay", "bob.mcap"]).current_dir(&folder).output().unwrap();
    let text = String::from_utf8(replayed.stdout).unwrap();
    assert!(text.starts_with("the same to the bit, "), "{text}");
    outputs
}

const GO: &str = "{ Go (wait 1s) (Atom (null) (go 10 0)) }";
const KEY: &str = "plans = \"a word of two\"";

pub(crate) fn a_plan_takes_over_in_another_process() {
    let [ada, bob] = send("tcp_plan", [KEY, KEY], GO);
    assert!(ada.contains("Go is sent to bob") && ada.contains("bob takes the plan: Go takes over"), "{ada}");
    assert!(bob.contains("go 10 0 (plan of ada:1)  <- main set to Go"), "{bob}");
    assert!(bob.contains("plan over: wait 1s (plan of ada:1)") && bob.ends_with("[0]"), "{bob}");
}

pub(crate) fn a_plan_with_another_key_is_refused() {
    let [ada, bob] = send("tcp_plan_key", [KEY, "plans = \"another\""], GO);
    let refused = bob.contains("a letter of ada is refused: it has another key `plans`");
    assert!(refused && bob.contains("plan over: wait 5s (stand.mdle:1)"), "{ada}{bob}");
}

pub(crate) fn a_plan_of_a_stranger_is_refused() {
    let [ada, bob] = send("tcp_plan_stranger", [KEY, ""], GO);
    let refused = bob.contains("a letter of ada is refused: no plans are exchanged with ada");
    assert!(refused && bob.contains("plan over: wait 5s (stand.mdle:1)"), "{ada}{bob}");
}

pub(crate) fn a_plan_for_a_stranger_is_not_sent() {
    let [ada, bob] = send("tcp_plan_none", ["", KEY], GO);
    assert!(ada.contains("/link/bob/send_plan") && ada.ends_with("[1]"), "{ada}");
    assert!(bob.contains("plan over: wait 5s (stand.mdle:1)"), "{bob}");
}

pub(crate) fn a_plan_that_the_other_robot_cannot_run_is_refused() {
    let [ada, bob] = send("tcp_plan_faulty", [KEY, KEY], "{ Go (wait 1s) (Atom (null) path(way)) }");
    assert!(ada.contains("bob refuses the plan Go: the plan replays the path `way`"), "{ada}");
    assert!(bob.contains("plan over: wait 5s (stand.mdle:1)"), "{bob}");
}
