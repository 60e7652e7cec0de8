//! Tests signals to the engine, and to the process group of a module, in each phase of a turn; counts the turns until
//! the robot is at rest.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "how many turns it took is seen with --nocapture")]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::Atrv;
use mdle_emulator::{MotionOrder, Pace};
use mdle_runtime::Pose;
use mdle_scout_emulator::scout::Scout;
use mdle_tests::executable::folder;

use super::signalled::run::{Ran, Robot, distance, drove, ran_by, send};

/// A plan that drives while a module publishes.
const PLAN: &str = "{ Listen (age(ears module) > 500ms OR wait 20s) (Atom (null) (go 20 0)) }\n";
/// A child process that publishes a bearing at each turn break, and writes its process number to a file.
const EARS: &str = "echo $$ > $1; echo '{\"publishes\": {\"bearing\": \"deg\"}}'\n\
                    while read line; do echo '{\"bearing\": 0}'; done\n";
const PERIOD: Duration = Duration::from_millis(100);
/// Times from a command to the signal, in milliseconds. They fall into the exchange, into the turn, of which a module
/// takes 40 ms, into the turn break, and into the wait for the next turn.
const MOMENTS: [u64; 6] = [0, 10, 30, 45, 60, 80];
/// Time for which the robot drives before the signal.
const DRIVES: Duration = Duration::from_millis(500);
/// Maximum movement in a step for which a robot counts as at rest, in metres.
const STANDS: f64 = 1e-5;
/// Number of runs at the same time.
const AT_A_TIME: usize = 12;

/// A signal and its receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Blow {
    /// SIGKILL to the engine.
    KillsEngine,
    /// SIGTERM to the engine.
    EndsEngine,
    /// SIGKILL to the process group of the module.
    KillsModule,
}

impl Blow {
    const ALL: [Self; 3] = [Self::KillsEngine, Self::EndsEngine, Self::KillsModule];

    /// Sends the signal. `pid` is the file with the process number of the module.
    fn strike(self, engine: u32, pid: &Path) {
        match self {
            Self::KillsEngine => send(9, engine),
            Self::EndsEngine => send(15, engine),
            Self::KillsModule => {
                let process = fs::read_to_string(pid).unwrap();
                let stat = fs::read_to_string(format!("/proc/{}/stat", process.trim())).unwrap();
                // After the name: the state, the parent, and the group.
                let group = stat.rsplit(") ").next().unwrap().split(' ').nth(2).unwrap();
                assert!(Command::new("sh").args(["-c", &format!("kill -9 -{group}")]).status().unwrap().success());
            }
        }
    }
}

/// Runs the plan, and sends the signal at the time `moment` after a command. Returns the run, and the number of turns
/// from the signal until the robot was at rest.
fn struck<R: Robot>(folder: &Path, blow: Blow, moment: Duration) -> (Ran<R>, u32) {
    let pid = folder.join(format!("{blow:?}-{}", moment.as_millis()));
    let mut command = Command::new(env!("CARGO_BIN_EXE_ahead"));
    command.args(["run", "plan.mdle", "--target", R::NAME]).current_dir(folder);
    command.arg("--module").arg(format!("ears=exec sh ears.sh {}", pid.display())).args(["--config", "config.toml"]);
    // Times since the first command to drive, since the last command, and since the signal; pose at the last step.
    let (mut driven, mut waited, mut since) = (Duration::ZERO, Duration::ZERO, None);
    let (mut commands, mut last, mut stood) = (0, Pose::default(), None);
    let mut ran = ran_by::<R>(command, Pace::Real, None, &mut |robot, received, time| {
        if received.commands != commands {
            (commands, waited) = (received.commands, Duration::ZERO);
        }
        waited += time;
        driven += if drove(robot) { time } else { Duration::ZERO };
        if since.is_none() && driven >= DRIVES && waited >= moment && waited < PERIOD {
            blow.strike(received.process, &pid);
            since = Some(Duration::ZERO);
        }
        if let Some(since) = since.as_mut().filter(|_| time > Duration::ZERO) {
            *since += time;
            let stands = distance(&last, &robot.pose()) <= STANDS;
            stood = stands.then(|| stood.unwrap_or(*since));
        }
        last = robot.pose();
    });
    // The program has ended, and `ran_by` has let a period pass since then.
    let mut since = since.expect("a blow") + PERIOD;
    while stood.is_none() {
        ran.robot.pass(Pace::Real.step()).unwrap();
        since += Pace::Real.step();
        stood = (distance(&last, &ran.robot.pose()) <= STANDS).then_some(since);
        last = ran.robot.pose();
        assert!(since < Duration::from_secs(20), "it never stands");
    }
    let turns = stood.unwrap_or_default().as_millis().div_ceil(PERIOD.as_millis());
    (ran, u32::try_from(turns).unwrap())
}

/// Asserts that a robot comes to rest after every signal in every phase. `most` contains the maximum number of turns
/// for each kind of signal. Returns a line for each kind of signal.
fn every_phase<R: Robot>(most: [u32; 3]) -> String {
    let folder = folder(&format!("phases_{}", R::NAME));
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    fs::write(folder.join("ears.sh"), EARS).unwrap();
    // With this gap, all sonars of a Scout ping early.
    fs::write(folder.join("config.toml"), if R::NAME == Scout::NAME { "gap = 4\n" } else { "" }).unwrap();
    let cases: Vec<_> = Blow::ALL.into_iter().flat_map(|blow| MOMENTS.map(|moment| (blow, moment))).collect();
    let (next, turns) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME / 2 {
            scope.spawn(|| {
                while let Some((blow, moment)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let (ran, stood) = struck::<R>(&folder, *blow, Duration::from_millis(*moment));
                    assert_end(*blow, &ran);
                    turns.lock().unwrap().push((*blow, *moment, stood));
                }
            });
        }
    });
    let mut turns = turns.into_inner().unwrap();
    turns.sort_by_key(|(blow, moment, _)| (*blow as u8, *moment));
    let lines = Blow::ALL.map(|blow| {
        let of_blow: Vec<_> = turns.iter().filter(|(other, ..)| *other == blow).map(|(.., turns)| *turns).collect();
        assert_eq!(of_blow.len(), MOMENTS.len());
        assert!(of_blow.iter().all(|turns| *turns <= most[blow as usize]), "{} {blow:?}: {of_blow:?}", R::NAME);
        format!("{} {blow:?}: {of_blow:?} turns\n", R::NAME)
    });
    lines.concat()
}

/// Asserts the exit status, the messages and the last command after the signal.
fn assert_end<R: Robot>(blow: Blow, ran: &Ran<R>) {
    let (status, errors) = (ran.output.status.code(), ran.errors());
    let bytes = &ran.received.bytes;
    match blow {
        Blow::KillsEngine => {
            assert_eq!(status, None, "{errors}");
            assert_eq!(
                ran.robot.orders().last().map(|(_, order)| order),
                Some(MotionOrder::Drive),
                "its own watchdog stops it"
            );
        }
        Blow::EndsEngine => {
            assert!(status == Some(143) && errors.contains("stopped by SIGTERM\n"), "{status:?} {errors}");
            assert!(ran.robot.is_secured(bytes), "{:02X?}", &bytes[bytes.len().saturating_sub(150)..]);
        }
        Blow::KillsModule => {
            let report = String::from_utf8_lossy(&ran.output.stdout);
            assert!(status == Some(0) && report.contains("plan over: age(ears module)"), "{status:?} {report}{errors}");
            assert!(errors.contains("module `ears` makes no further turn: its process has ended"), "{errors}");
            assert!(ran.robot.is_secured(bytes), "{:02X?}", &bytes[bytes.len().saturating_sub(150)..]);
        }
    }
}

#[test]
fn a_robot_stands_after_a_signal_in_each_phase() {
    // If the engine is killed, the watchdogs of both robots stop them after a second.
    let (scout, atrv) = thread::scope(|scope| {
        let scout = scope.spawn(|| every_phase::<Scout>([16, 8, 16]));
        let atrv = every_phase::<Atrv>([16, 8, 16]);
        (scout.join().unwrap(), atrv)
    });
    println!("{scout}{atrv}");
}
