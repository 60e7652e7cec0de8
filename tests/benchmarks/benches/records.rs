//! Measures the record of an hour of a robot at ten turns per second, with sixteen sonars and the channels of viewers:
//! the size of the record, the time per turn in the control thread, and the speed of `mdle replay` and `mdle why`.
//!
//! `mdle` runs in a separate process of this program, which an environment variable selects.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::env;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use mdle_record::frames::Frames;
use mdle_record::{Records, TurnMade};

/// Number of turns in an hour.
const TURNS: u32 = 36_000;
/// Environment variable that makes this program run as `mdle`.
const ROLE: &str = "MDLE_RECORDS_ROLE";
/// Number of rounds; the fastest round counts.
const ROUNDS: usize = 3;

/// A plan that drives around a square for an hour.
const PLAN: &str = "{ Hour (wait 1h)
  ((Atom (wait 5s OR r0 < 60cm) (go 20 0)) (Atom (null) turn 90))^inf
}
";

fn main() -> ExitCode {
    if env::var(ROLE).is_ok() {
        return mdle::main();
    }
    let folder = env::temp_dir().join(format!("mdle-records-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("hour.mdle"), PLAN).expect("a plan");
    let run = "run hour.mdle --target sim --body scout --world hall --seed 1 --speed max";
    let alone = fastest(|| mdle(&folder, run));
    let recorded = fastest(|| mdle(&folder, &format!("{run} --log hour.mcap")));
    let size = fs::metadata(folder.join("hour.mcap")).expect("a record").len();
    println!("run of an hour           {:>8.2} s, recorded {:.2} s", alone.as_secs_f64(), recorded.as_secs_f64());
    println!("size of the record       {:>8.1} MB", size as f64 / 1e6);
    println!("encoding of a turn       {:>8.2} µs", encoding(&folder.join("hour.mcap")).as_secs_f64() * 1e6);
    let replay = fastest(|| mdle(&folder, "replay hour.mcap"));
    println!("replay                   {:>8.0} turns/s", f64::from(TURNS) / replay.as_secs_f64());
    println!("why, near the end        {:>8.2} s", fastest(|| mdle(&folder, "why hour.mcap 3590")).as_secs_f64());
    println!("why not, the whole hour  {:>8.2} s", fastest(|| mdle(&folder, "why hour.mcap --not Hour")).as_secs_f64());
    fs::remove_dir_all(&folder).expect("its own folder");
    ExitCode::SUCCESS
}

/// Returns the duration of the fastest of [`ROUNDS`] rounds.
fn fastest(round: impl Fn() -> Duration) -> Duration {
    (0..ROUNDS).map(|_| round()).min().unwrap_or_default()
}

/// Returns the duration of a run of `mdle` with these arguments.
fn mdle(folder: &Path, arguments: &str) -> Duration {
    let program = env::current_exe().expect("this program");
    let mut command = Command::new(program);
    command.args(arguments.split(' ')).current_dir(folder).env(ROLE, "mdle");
    let begin = Instant::now();
    let output = command.output().expect("it runs");
    let passed = begin.elapsed();
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    passed
}

/// Returns the average time that the control thread takes to encode a turn of the record.
fn encoding(record: &Path) -> Duration {
    let file = File::open(record).expect("the record");
    let (_, records) = Records::open(BufReader::new(file)).expect("a record");
    let turns: Vec<_> = records.map(|turn| turn.expect("a turn")).collect();
    let round = || {
        let (mut frames, mut bytes, begin) = (Frames::default(), Vec::new(), Instant::now());
        for turn in &turns {
            bytes.clear();
            let made = TurnMade {
                number: turn.number,
                t: turn.t,
                sent: turn.sent,
                applied: turn.applied,
                plan: turn.plan,
                state: turn.state,
                changes: &turn.changes,
                overruled: turn.overruled.as_ref(),
            };
            frames.turn(made, &turn.y, turn.steps.iter().cloned(), &mut bytes);
            std::hint::black_box(&bytes);
        }
        begin.elapsed()
    };
    fastest(round) / u32::try_from(turns.len()).unwrap_or(TURNS).max(1)
}
