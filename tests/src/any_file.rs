//! Properties of any bytes as a file that is not a plan: an alphabet, a machine, a script, a world, a map, a path, a
//! robot's configuration, or a record. libFuzzer searches for bytes that violate them, and a test checks the corpus.
//!
//! Each function panics if a property does not hold.

use std::fs;
use std::io::Write as _;
use std::sync::LazyLock;

use mdle_compiler::alphabet::{self, AlphabetFile};
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, has_errors};
use mdle_compiler::trace::{CountedRun, Script, run};
use mdle_compiler::{Compiled, builtin, compile, rust};
use mdle_host::setpoints;
use mdle_record::frames::Frames;
use mdle_record::{RecordFile, RecordedTurn, Records, TurnMade};
use mdle_runtime::{MetersPerSecond, Radians, RadiansPerSecond, Twist};
use mdle_sim::{Point, Walls, World};
use mdle_theory::theorem;

use crate::any_text::text;
use crate::pipeline::scripted;

/// Maximum number of steps of the search for the plan of a machine.
const STEPS: u64 = 2_000;

/// Alphabets that targets share.
static SHARED: LazyLock<Vec<AlphabetFile>> = LazyLock::new(|| {
    let shared = builtin::alphabets().iter().filter(|file| !file.target);
    shared.filter_map(|file| alphabet::read(SourceId(0), file.text).0).collect()
});

/// Plan that is run on scripts.
static PLAN: LazyLock<Vec<Compiled>> = LazyLock::new(|| {
    let plan = "{ P (a) ExecPlan inf { (Atom (b OR wait 1) idle) (Atom (RISING c) idle) } }";
    compile(SourceId(0), plan, scripted(), None).0
});

/// Asserts that an alphabet is read or has errors that can be shown, and that bindings in Rust can be generated for an
/// alphabet without errors.
pub fn alphabet(bytes: &[u8]) {
    let text = text(bytes);
    let mut sources = Sources::default();
    let source = sources.add("alphabet.mdle", text.as_str());
    let (file, found) = alphabet::read(source, &text);
    for label in found.iter().flat_map(|diagnostic| &diagnostic.labels) {
        assert!(text.get(label.span.within(source)).is_some(), "{label:?}");
    }
    shown(&sources, &found);
    assert!(file.is_some() || has_errors(&found), "no alphabet and no error");
    let Some(file) = file.filter(|file| file.target.is_some() && !has_errors(&found)) else { return };
    let (alphabet, found) = alphabet::combine(file, &SHARED);
    if !has_errors(&found) {
        let bound = rust::bind(&alphabet);
        assert!(syn::parse_file(&bound).is_ok(), "{bound}");
    }
}

/// Asserts that a machine is read or has an error. A machine that is read must have an answer by Theorem 1, and a plan
/// with `after`.
pub fn machine(bytes: &[u8]) {
    let Ok(machine) = theorem::read(&text(bytes)) else { return };
    let answer = theorem::decompile(&machine, STEPS);
    // The call only must not panic.
    let _ = theorem::as_printed(&machine, &answer);
    match &answer {
        theorem::TheoremResult::String(found) => assert!(!theorem::string(&machine, found).is_empty()),
        theorem::TheoremResult::None(broken) => {
            assert!(broken.iter().all(|broken| !broken.sentence(&machine).is_empty()))
        }
        theorem::TheoremResult::Stopped(steps) => assert!(*steps >= STEPS),
    }
    assert!(!theorem::augment(&machine).is_empty());
}

/// Asserts that a script is read or has an error, that the time of a script never decreases, and that a plan can be run
/// on it.
pub fn script(bytes: &[u8]) {
    let Ok(script) = Script::read(&text(bytes)) else { return };
    assert!(script.turns().is_sorted_by_key(|turn| turn.t), "{script:?}");
    for plan in PLAN.iter() {
        let lines = run(CountedRun::new(&plan.machine), &script);
        assert!(lines.count() <= script.turns().len());
    }
}

/// Asserts that a world is read or has an error, and that distances in the world are valid numbers.
pub fn world(bytes: &[u8]) {
    if let Ok(world) = World::parse("world.toml", &text(bytes)) {
        stands(&world);
    }
}

/// Asserts that a map is read as a world or has an error. The bytes before `P2` or `P5` are the YAML file.
pub fn map(bytes: &[u8]) {
    let begin = bytes.windows(2).position(|pair| [&b"P2"[..], b"P5"].contains(&pair));
    let (header, image) = bytes.split_at(begin.unwrap_or(bytes.len()));
    if let Ok(world) = World::of_map(("map.yaml", &text(header)), ("map.pgm", image)) {
        stands(&world);
    }
}

fn stands(world: &World) {
    let walls = Walls::of(world);
    let start = Point { x: world.start.x.0, y: world.start.y.0 };
    assert!(walls.clearance(start, 5.0) >= 0.0);
    for look in 0..8_u32 {
        let range = walls.ray(start, Radians(f64::from(look)), 1e7);
        assert!(range.is_none_or(|range| (0.0..1e7).contains(&range)), "{range:?}");
    }
}

/// Asserts that a path is read or has an error. The times of a path must increase, and its speeds must be within the
/// limit.
pub fn path(bytes: &[u8]) {
    let fastest = Twist { v: MetersPerSecond(0.5), omega: RadiansPerSecond(1.0) };
    let Ok(setpoints) = setpoints("path.csv", bytes, fastest) else { return };
    assert!(setpoints.is_sorted_by(|one, other| one.at < other.at), "{setpoints:?}");
    assert!(
        setpoints.iter().all(|setpoint| setpoint.speed.0.abs() < 0.6 && setpoint.heading.0.is_finite()),
        "{setpoints:?}"
    );
}

/// Asserts that a record is read or has an error, and that a complete record keeps its turns when it is written again.
pub fn record(bytes: &[u8]) {
    let Ok((begin, turns)) = Records::open(bytes) else { return };
    let Ok(turns) = turns.collect::<Result<Vec<_>, _>>() else { return };
    let Some(first) = turns.first() else { return };
    let (mut frames, mut written, mut file) = (Frames::default(), Vec::new(), Vec::new());
    frames.begin(&begin, &first.y, &mut written);
    for turn in &turns {
        let RecordedTurn { number, t, sent, applied, plan, state, .. } = *turn;
        let (changes, overruled) = (turn.changes.as_slice(), turn.overruled.as_ref());
        let made = TurnMade { number, t, sent, applied, plan, state, changes, overruled };
        frames.turn(made, &turn.y, turn.steps.iter().cloned(), &mut written);
    }
    frames.end(&mut written);
    RecordFile::new(&mut file).write_all(&written).expect("a record that was read can be written");
    let (again, same) = Records::open(file.as_slice()).expect("a record");
    let same: Vec<_> = same.map(|turn| turn.expect("a turn")).collect();
    // Compared as text, because NaN is not equal to itself.
    assert_eq!(format!("{again:?} {same:?}"), format!("{begin:?} {turns:?}"));
}

/// Asserts that a robot's configuration is read or has an error, and that the shown text of a configuration can be read
/// back unchanged.
pub fn configuration(bytes: &[u8]) {
    let name = format!("mdle-any-file-{}-{:?}.toml", std::process::id(), std::thread::current().id());
    let file = std::env::temp_dir().join(name);
    let again = |shown: String| {
        fs::write(&file, shown).expect("a temporary file");
        file.as_path()
    };
    fs::write(&file, bytes).expect("a temporary file");
    if let Ok(read) = mdle_scout::Configured::read(Some(file.as_path()), None) {
        let second = mdle_scout::Configured::read(Some(again(read.to_string())), None);
        assert_eq!(second.map(|second| second.config), Ok(read.config));
    }
    fs::write(&file, bytes).expect("a temporary file");
    if let Ok(read) = mdle_atrv::Configured::read(Some(file.as_path()), None) {
        let second = mdle_atrv::Configured::read(Some(again(read.to_string())), None);
        assert_eq!(second.map(|second| second.config), Ok(read.config));
    }
    fs::remove_file(&file).expect("a temporary file");
}

/// Asserts that each diagnostic can be shown as text and as JSON.
fn shown(sources: &Sources, found: &[Diagnostic]) {
    for diagnostic in found {
        let shown = sources.render(diagnostic);
        assert!(shown.starts_with("error[") || shown.starts_with("warning["), "{diagnostic:?}\n{shown}");
        assert!(!sources.message(diagnostic).to_json().is_empty(), "{diagnostic:?}");
    }
}
