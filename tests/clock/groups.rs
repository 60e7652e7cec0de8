//! Tests the plan of a group whose robots run in separate processes that are linked over TCP.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::process::{Command, Stdio};

use mdle_tests::executable::{folder, mdle};

use super::addresses;

const PLAN: &str = "{ Group [ada bob] Pair (any bumper OR wait 20s)
  (Atom (all rendezvous) stop)
  (Atom (wait 1) (go 20 0))
}
";

pub(crate) fn each_program_runs_the_part_of_its_link() {
    let folder = folder("group_over_tcp");
    fs::write(folder.join("pair.mdle"), PLAN).unwrap();
    let [ada, bob] = addresses();
    let robots = [("ada", ada, "bob", bob), ("bob", bob, "ada", ada)];
    let children = robots.map(|(own, listen, other, address)| {
        let link = format!(
            "name = \"{own}\"\nlisten = \"{listen}\"\nkey = \"key\"\n[[robot]]\nname = \"{other}\"\naddress = \"{address}\"\n"
        );
        fs::write(folder.join(format!("{own}.toml")), link).unwrap();
        let line = format!("run pair.mdle --target sim --speed 1 --link {own}.toml");
        let mut command = Command::new(mdle());
        command.args(line.split(' ')).current_dir(&folder).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    });
    let causes = [["all rendezvous", "wait 1"], ["past ada 2", "past ada 3"]];
    for ((child, (own, ..)), [met, driven]) in children.into_iter().zip(robots).zip(causes) {
        let output = child.wait_with_output().unwrap();
        let [report, errors] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert_eq!(output.status.code(), Some(0), "{own}: {report}{errors}");
        let drives = format!("go 20 0 (pair.mdle:3, Pair)  <- {met}");
        let stops = format!("stop (pair.mdle:1)  <- {driven}");
        assert!(report.contains(&drives) && report.contains(&stops), "{own}: {report}{errors}");
    }
}
