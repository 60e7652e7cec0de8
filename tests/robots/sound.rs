//! Tests plans that follow sounds, heard by the microphones of the simulated robot, from a WAV file, and through the
//! pipe of a recorder (docs/src/sound.md).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use hound::{SampleFormat, WavSpec, WavWriter};
use mdle_tests::chance::sized;
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;

/// Position of the sound source in the plan's world, in metres. `ARRIVED` is the distance at which a robot has arrived,
/// in metres.
const SOURCE: (f64, f64) = (5.5, 4.2);
const ARRIVED: f64 = 0.8;
/// First random seed of these tests. No parameter was tuned with these seeds.
const FIRST: u64 = 9_820_000;

/// Copies the plan and its world into a folder.
fn copy_plan(folder: &Path) {
    for file in ["sound_following.mdle", "studio.toml"] {
        fs::copy(root().join("plans/sound").join(file), folder.join(file)).unwrap();
    }
}

/// Runs the plan with `mdle run` and these arguments.
fn run(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(mdle());
    command.args(["run", "sound_following.mdle", "--target", "sim", "--speed", "max"]).args(arguments.split(' '));
    command.current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

/// Returns the exit status and standard error.
fn refusal(output: &Output) -> String {
    format!("[{}] {}", output.status.code().unwrap(), String::from_utf8_lossy(&output.stderr))
}

/// Writes a WAV file with a second of 16-bit samples that all have this value.
fn write_wav(path: &Path, sample_rate: u32, channels: u16, value: i16) {
    let spec = WavSpec { channels, sample_rate, bits_per_sample: 16, sample_format: SampleFormat::Int };
    let mut writer = WavWriter::create(path, spec).unwrap();
    (0..sample_rate * u32::from(channels)).for_each(|_| writer.write_sample(value).unwrap());
    writer.finalize().unwrap();
}

/// Returns the minimum distance between the positions in a trail and the sound source.
fn nearest(trail: &str) -> f64 {
    let distances = trail.lines().skip(1).map(|line| {
        let numbers: Vec<f64> = line.split(',').filter_map(|text| text.parse().ok()).collect();
        libm::hypot(numbers[1] - SOURCE.0, numbers[2] - SOURCE.1)
    });
    distances.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_robot_follows_what_it_hears_around_a_box() {
    let folder = folder("follows");
    copy_plan(&folder);
    let (all, mut arrived) = (sized(3, 50), 0);
    for seed in FIRST..FIRST + all {
        let heading = seed * 77 % 360;
        let start = format!("--start 1.2,1.5,{heading} --seed {seed}");
        let output = run(&folder, &format!("--world studio.toml --ears robot --trail trail.csv {start}"));
        let report = String::from_utf8_lossy(&output.stdout).into_owned() + &refusal(&output);
        let distance = nearest(&fs::read_to_string(folder.join("trail.csv")).unwrap());
        let is_there = output.status.success() && distance < ARRIVED && report.contains("plan over: wait 60s");
        println!("{seed}: {distance:.2} m, {report}");
        arrived += u64::from(is_there);
    }
    println!("{arrived} of {all}");
    assert!(50 * arrived >= 48 * all, "{arrived} of {all}");
}

#[test]
fn sound_is_the_same_every_time() {
    let folder = folder("same");
    copy_plan(&folder);
    let course = |trail: &str| {
        let output = run(&folder, &format!("--world studio.toml --ears robot --seed 7 --trail {trail}"));
        assert!(output.status.success(), "{}", refusal(&output));
        fs::read(folder.join(trail)).unwrap()
    };
    assert_eq!(course("first.csv"), course("second.csv"));
}

#[test]
fn robots_of_a_scenario_hear_by_their_own_ears() {
    let folder = folder("scenario_ears");
    copy_plan(&folder);
    let robot = |name: &str, start: &str, ears: &str| {
        format!("[[robot]]\nname = \"{name}\"\nfile = \"sound_following.mdle\"\nstart = \"{start}\"\n{ears}")
    };
    let ears = "ears = \"8.75cm\"\n";
    let robots = robot("ada", "1.2,1.5,90", ears) + &robot("bob", "1,4.8,-90", ears);
    fs::write(folder.join("s.toml"), format!("world = \"studio.toml\"\nseed = 5\n{robots}")).unwrap();
    let course = |trail: &str| {
        let mut command = Command::new(mdle());
        command.args(["run", "s.toml", "--trail", trail]).current_dir(&folder);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", refusal(&output));
        fs::read_to_string(folder.join(trail)).unwrap()
    };
    let trail = course("first.csv");
    assert_eq!(trail, course("second.csv"));
    for name in ["ada", "bob"] {
        let of_robot =
            trail.lines().filter_map(|line| line.split_once(&format!(",{name},")).map(|(t, at)| format!("{t},{at}\n")));
        let distance = nearest(&("t,x,y,heading\n".to_owned() + &of_robot.collect::<String>()));
        // The second robot to arrive keeps its distance from the first one.
        assert!(distance < ARRIVED + 0.5, "{name}: {distance}");
    }
}

#[test]
fn sound_that_cannot_be_used_is_refused() {
    let folder = folder("refused");
    copy_plan(&folder);
    write_wav(&folder.join("slow.wav"), 22_050, 2, 5);
    write_wav(&folder.join("one.wav"), 44_100, 1, 5);
    write_wav(&folder.join("silent.wav"), 44_100, 2, 0);
    let expected = [
        (
            "slow.wav",
            "[2] error: --ears slow.wav: 22050 samples a second; expected 44100\n\
             help: `sox slow.wav -r 44100 out.wav` converts it\n",
        ),
        (
            "one.wav",
            "[2] error: --ears one.wav: one channel; expected two\n\
             help: a bearing is the delay between two ears, the left one first\n",
        ),
        ("silent.wav", "[2] error: --ears silent.wav: the left channel is silent: each of its samples is 0\n"),
        (
            "robot",
            "[2] error: --ears robot: the world has no source of sound\n\
             help: add one to a world file, as `[[sound]]` and `at = [5, 3]`\n",
        ),
    ];
    for (ears, message) in expected {
        assert_eq!(refusal(&run(&folder, &format!("--world hall --ears {ears}"))), message);
    }
}

#[test]
fn options_of_one_robot_are_refused_for_a_scenario() {
    let scenario = root().join("plans/formation/formation.toml");
    for words in [&["--ears", "robot"][..], &["--deny-warnings"]] {
        let output = Command::new(mdle()).arg("run").arg(&scenario).args(words).output().unwrap();
        let sentence = "is for one robot, and a scenario names the plan of each\nhelp: leave it out\n";
        assert_eq!(refusal(&output), format!("[2] error: {} {sentence}", words[0]));
    }
}

#[test]
fn a_plan_goes_on_after_its_sound() {
    let folder = folder("sound_ends");
    copy_plan(&folder);
    let spec = WavSpec { channels: 2, sample_rate: 44_100, bits_per_sample: 16, sample_format: SampleFormat::Int };
    let mut writer = WavWriter::create(folder.join("noise.wav"), spec).unwrap();
    let mut noise: u32 = 1;
    for _ in 0..4 * 44_100 {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        // Equal samples for both ears: the sound is straight ahead.
        (0..2).for_each(|_| writer.write_sample((noise >> 18) as i16).unwrap());
    }
    writer.finalize().unwrap();
    let output = run(&folder, "--world hall --ears noise.wav");
    let told = "module `heading` makes no further turn: the sound of the file has ended";
    assert!(refusal(&output).starts_with("[0] ") && refusal(&output).contains(told), "{}", refusal(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("plan over: wait 60s"), "{output:?}");
    let plan = fs::read_to_string(folder.join("sound_following.mdle")).unwrap();
    let ends = plan.replace("wait 60s", "wait 60s OR age(heading module) > 2s");
    fs::write(folder.join("sound_following.mdle"), ends).unwrap();
    let output = run(&folder, "--world hall --ears noise.wav");
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(report.starts_with("6.") && report.contains("plan over: age(heading module)"), "{report}");
}

#[test]
fn a_recorder_that_ends_at_once_stops_the_robot() {
    let folder = folder("recorder");
    copy_plan(&folder);
    let message = refusal(&run(&folder, "--world hall --ears -"));
    assert!(message.starts_with("[3] ") && message.contains("the recorder has ended"), "{message}");
}
