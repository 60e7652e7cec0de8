//! Tests three robots in three processes that are linked over TCP, by the clock.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::Write as _;
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use mdle_tests::executable::{folder, mdle};

const NAMES: [&str; 3] = ["ada", "bob", "eve"];

/// Writes the link file of each robot, and returns the addresses of the robots. `key_of_eve` is the key of `eve`.
fn with_links(folder: &Path, key_of_eve: &str) -> [SocketAddr; 3] {
    let addresses = super::addresses();
    for (name, address) in NAMES.into_iter().zip(addresses) {
        let key = if name == "eve" { key_of_eve } else { "key" };
        let mut text = format!("name = \"{name}\"\nlisten = \"{address}\"\nkey = \"{key}\"\n");
        for (other, at) in NAMES.into_iter().zip(addresses).filter(|(other, _)| *other != name) {
            text += &format!("[[robot]]\nname = \"{other}\"\naddress = \"{at}\"\n");
        }
        fs::write(folder.join(format!("{name}.toml")), text).unwrap();
    }
    addresses
}

fn begin(folder: &Path, name: &str, plan: &str) -> Child {
    fs::write(folder.join(format!("{name}.mdle")), plan).unwrap();
    let line = format!("run {name}.mdle --target sim --link {name}.toml --world room --log {name}.mcap");
    let mut command = Command::new(mdle());
    let command = command.args(line.split(' ')).current_dir(folder);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for a run to end, asserts that its plan is over, and returns its standard output and standard error.
fn ended(child: Child) -> String {
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert_eq!(status.code(), Some(0), "{out}{err}");
    out + &err
}

pub(crate) fn three_processes_meet_and_go_on_when_one_is_killed() {
    let folder = folder("links");
    let addresses = with_links(&folder, "key");
    let waits = "{ P (wait 30s) (Atom (rendezvous bob AND rendezvous eve) stop) (Atom (NOT sync eve) stop) \
                 (Atom (sync bob) stop) }";
    let mut eve = begin(&folder, "eve", &waits.replace("bob", "ada").replace("eve)", "bob)"));
    let ada = begin(&folder, "ada", waits);
    sleep(Duration::from_millis(700));
    let meets = "{ P (wait 30s) (Atom (rendezvous ada AND rendezvous eve) stop) (Atom (wait 4) stop) }";
    let bob = begin(&folder, "bob", meets);
    // An unknown client connects while the robots meet.
    let mut stranger = TcpStream::connect(addresses[0]).unwrap();
    stranger.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
    sleep(Duration::from_millis(1500));
    eve.kill().unwrap();
    eve.wait().unwrap();
    let [ada, bob] = [ada, bob].map(ended);
    assert!(ada.contains("<- rendezvous bob and rendezvous eve"), "{ada}");
    assert!(ada.contains("<- NOT sync eve") && ada.contains("plan over: sync bob"), "{ada}");
    assert!(ada.contains("is refused: it sends no states"), "{ada}");
    assert!(bob.contains("<- rendezvous ada and rendezvous eve") && bob.contains("plan over: wait 4"), "{bob}");
    for (record, end) in [("ada", " turns\n"), ("bob", " turns\n"), ("eve", " turns; the record has no end\n")] {
        let arguments = ["replay".to_owned(), format!("{record}.mcap")];
        let replayed = Command::new(mdle()).args(arguments).current_dir(&folder).output().unwrap();
        let text = String::from_utf8(replayed.stdout).unwrap();
        assert!(text.starts_with("the same to the bit, ") && text.ends_with(end), "{record}: {text}");
    }
}

pub(crate) fn a_robot_with_another_key_is_no_peer() {
    let folder = folder("link_keys");
    with_links(&folder, "another");
    let ada = begin(&folder, "ada", "{ P (wait 2) (Atom (sync eve) stop) }");
    let eve = begin(&folder, "eve", "{ P (wait 2) (Atom (sync ada) stop) }");
    for report in [ada, eve].map(ended) {
        assert!(report.contains("plan over: wait 2") && report.contains("it has another key"), "{report}");
    }
}

#[test]
fn a_plan_with_unknown_robots_is_refused() {
    let folder = folder("link_unknown");
    with_links(&folder, "key");
    fs::write(folder.join("plan.mdle"), "{ P (wait 2) (Atom (sync bop) stop) }").unwrap();
    let router = "name = \"ada\"\nrouter = \"tcp/127.0.0.1:7447\"\nkey = \"key\"\nrobot = []\n";
    fs::write(folder.join("router.toml"), router).unwrap();
    for (link, words) in [
        (" --link ada.toml", "did you mean `bob`?"),
        ("", "there is no link to it"),
        (" --link no.toml", "cannot be read"),
        (" --link router.toml", "router.toml: this `mdle` has no links by a router\nhelp: "),
    ] {
        let line = format!("run plan.mdle --target sim{link}");
        let output = Command::new(mdle()).args(line.split(' ')).current_dir(&folder).output().unwrap();
        let refused = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && refused.contains(words), "{line}: {refused}");
    }
}

/// Returns the processor time that a process has used on all cores, in ticks.
fn used(process: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    // The name of the program may contain spaces.
    let (_, fields) = text.rsplit_once(')').unwrap();
    fields.split_whitespace().skip(11).take(2).map(|ticks| ticks.parse::<u64>().unwrap()).sum()
}

#[test]
fn a_robot_idles_while_it_can_open_no_file() {
    let folder = folder("link_files");
    let addresses = with_links(&folder, "key");
    fs::write(folder.join("ada.mdle"), "{ P (wait 5) (Atom (null) stop) }").unwrap();
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -n 48; exec \"$0\" \"$@\""]).arg(mdle());
    let command =
        command.args("run ada.mdle --target sim --link ada.toml --world room".split(' ')).current_dir(&folder);
    let ada = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_secs(1));
    let mut strangers = Vec::new();
    let mut hold = |milliseconds: u64| {
        for _ in 0..milliseconds / 10 {
            strangers.extend(TcpStream::connect_timeout(&addresses[0], Duration::from_millis(5)).ok());
            sleep(Duration::from_millis(10));
        }
    };
    hold(1000);
    let before = used(ada.id());
    hold(2000);
    let ticks = used(ada.id()) - before;
    let report = ended(ada);
    assert!(report.contains("a connection is refused: the system does not accept it: "), "{report}");
    // A tick is a hundredth of a second.
    assert!(ticks < 100, "{ticks} ticks in two seconds");
}
