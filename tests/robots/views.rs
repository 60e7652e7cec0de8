//! Tests `--watch`, `--plot`, `--record` and `--trail` on emulated robots. The driver does not know their world, so the
//! views are made from the poses and ranges that the robot reports.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::io::Read as _;
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Pace, Port, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, mdle};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);
/// A plan that drives ahead for 3 s, turns left by about 90°, and drives ahead for 3 s again: 1.2 m in two directions.
const PLAN: &str = "{ Corner (wait 1min)
  (Atom (wait 3s) (go 20 0)) (Atom (wait 4s) (go 0 0.4)) (Atom (wait 3s) (go 20 0))
}
";

fn simulated(body: Body, step: Duration) -> Simulated {
    let world = World::named("room").unwrap().unwrap();
    let make = Make { body, without: Vec::new(), seed: None };
    Simulated::with(&make, &world, world.start, step).unwrap()
}

/// Runs the plan on an emulated robot with these options and this standard output.
fn run<R: Emulated + Send>(folder: &Path, robot: R, target: &str, options: &[&str], out: Stdio) -> Output {
    called(Command::new(mdle()), folder, robot, target, options, out)
}

/// Runs the plan like [`run`], with a command that takes the arguments of `mdle`.
fn called<R: Emulated + Send>(
    mut command: Command,
    folder: &Path,
    mut robot: R,
    target: &str,
    options: &[&str],
    out: Stdio,
) -> Output {
    fs::write(folder.join("corner.mdle"), PLAN).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    command.args(["run", "corner.mdle", "--target", target, "--lockstep"]).args(options);
    command.arg("--device").arg(port.path()).current_dir(folder).stdout(out).stderr(Stdio::piped());
    thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, IN_LOCKSTEP, &|| !over.load(Ordering::Relaxed)));
        let output = command.spawn().unwrap().wait_with_output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    })
}

/// Asserts that a run on a robot has succeeded and has written the expected files.
fn check_files(folder: &Path, target: &str, output: &Output) {
    assert!(output.status.success(), "{target}: {}", String::from_utf8_lossy(&output.stderr));
    let [plot, record, trail] =
        ["plot.svg", "record.svg", "trail.csv"].map(|file| fs::read_to_string(folder.join(file)).unwrap());
    assert!(plot.contains(&format!("robot {target}, by odometry")), "{plot}");
    assert!(["way0", "way2"].iter().all(|way| plot.contains(&format!("class=\"{way}\""))), "{plot}");
    // The plot shows the echoes of the room, whose walls are heard on all sides.
    let echoes = plot.split_once("class=\"echo\"").and_then(|(_, after)| after.split('>').next()).unwrap();
    assert!(echoes.matches("h0").count() > 20, "{target}: {echoes}");
    assert!(record.contains("<animate") && record.contains("go 20 0"), "{record}");
    let rows: Vec<Vec<f64>> =
        trail.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    assert!(trail.starts_with("t,x,y,heading\n") && rows.len() == 101, "{target}: {} rows", rows.len());
    let [_, x, y, heading] = rows.last().unwrap()[..] else { panic!("{trail}") };
    assert!((0.4..0.8).contains(&x) && (0.4..0.8).contains(&y), "{target}: {x}, {y}");
    assert!((75.0..110.0).contains(&heading), "{target}: {heading}");
}

#[test]
fn robots_are_drawn_by_what_they_report() {
    let files = ["--plot", "plot.svg", "--record", "record.svg", "--trail", "trail.csv"];
    let folder = folder("views");
    let robot = Scout::new(simulated(Body::Scout, PERIOD)).unwrap();
    check_files(&folder, "scout", &run(&folder, robot, "scout", &files, Stdio::piped()));
    let step = step(IN_LOCKSTEP);
    let robot = Atrv::new(simulated(Body::Atrv, step), step, false).unwrap();
    check_files(&folder, "atrv", &run(&folder, robot, "atrv", &files, Stdio::piped()));
}

#[test]
fn robots_are_watched_at_a_terminal() {
    let folder = folder("watched");
    let keys = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&keys).unwrap();
    unlockpt(&keys).unwrap();
    let name = ptsname(&keys, Vec::new()).unwrap();
    let screen = Path::new(std::ffi::OsStr::from_bytes(name.as_bytes()));
    let screen = File::options().read(true).write(true).open(screen).unwrap();
    tcsetwinsize(&screen, Winsize { ws_row: 30, ws_col: 90, ws_xpixel: 0, ws_ypixel: 0 }).unwrap();
    let mut keys = File::from(keys);
    let reading = thread::spawn(move || {
        let (mut shown, mut bytes) = (Vec::new(), [0; 4096]);
        // The reading ends when all processes have closed the terminal.
        while let Ok(count @ 1..) = keys.read(&mut bytes) {
            shown.extend_from_slice(&bytes[..count]);
        }
        String::from_utf8_lossy(&shown).into_owned()
    });
    let robot = Scout::new(simulated(Body::Scout, PERIOD)).unwrap();
    let output = run(&folder, robot, "scout", &["--watch"], screen.into());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = reading.join().unwrap();
    let (pictures, behind) = shown.rsplit_once("\x1b[?1049l").unwrap();
    assert!(pictures.starts_with("\x1b[?1049h") && pictures.contains("Ctrl-C stops the robot"), "{pictures}");
    // The first picture shows the running atom with its place, and walls made of echoes; how many pictures follow
    // depends on the clock.
    assert!(pictures.contains("go 20 0  (corner.mdle:2"), "{pictures}");
    assert!(pictures.chars().filter(|letter| ('\u{2801}'..='\u{28FF}').contains(letter)).count() > 8, "{pictures}");
    assert!(behind.contains("plan over: wait 3s (corner.mdle:2)"), "{behind}");
}

/// An error of a view does not stop the robot.
#[test]
fn a_file_that_may_not_grow_is_an_error_at_the_end() {
    let folder = folder("views-limited");
    for (option, file, what) in [("--trail", "run.csv", "trail"), ("--plot", "run.svg", "plot")] {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -f 0; exec \"$@\"", "sh"]).arg(mdle());
        let robot = Scout::new(simulated(Body::Scout, PERIOD)).unwrap();
        let output = called(shell, &folder, robot, "scout", &[option, file], Stdio::piped());
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert!(out.ends_with("plan over: wait 3s (corner.mdle:2)\n"), "{out}");
        assert!(err.contains(&format!("the {what} ")) && err.contains("cannot be written"), "{err}");
        assert_eq!((output.status.code(), folder.join(file).exists()), (Some(3), false), "{err}");
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "the plan alone is left");
}

#[test]
fn a_file_that_cannot_be_written_is_refused_before_the_robot_is_opened() {
    let folder = folder("views-refused");
    fs::write(folder.join("corner.mdle"), PLAN).unwrap();
    let refused = |options: &str| {
        let words = ["run", "corner.mdle", "--target", "scout", "--device", "/nowhere"];
        let output = Command::new(mdle()).args(words).args(options.split(' ')).current_dir(&folder).output().unwrap();
        format!("{}[{}]\n", String::from_utf8(output.stderr).unwrap(), output.status.code().unwrap())
    };
    let all = [
        "--plot missing/run.svg",
        "--trail .",
        "--record run.png",
        "--plot run.svg --record run.svg",
        "--log run.csv --trail run.csv",
        "--watch",
    ];
    insta::assert_snapshot!(all.map(refused).concat(), @r"
    error: --plot missing/run.svg: the folder does not exist; make it first
    [2]
    error: --trail .: that is a folder; name a file in it
    [2]
    error: invalid value 'run.png' for '--record <FILE.svg>': this option writes SVG, not PNG; name the file `run.svg`

    For more information, try '--help'.
    [2]
    error: --record run.svg: --plot writes the same file; name another one
    [2]
    error: --trail run.csv: --log writes the same file; name another one
    [2]
    error: --watch: standard output is not a terminal; run it in a terminal, or make a picture with --plot or --record
    [2]
    ");
    let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["corner.mdle"]);
}
