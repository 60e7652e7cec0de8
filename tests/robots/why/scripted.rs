//! Writes records of runs whose outputs are defined by a test turn by turn.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;

use mdle_compiler::load::{self, Loaded};
use mdle_files::Target;
use mdle_record::frames::Frames;
use mdle_record::{Applied, Begin, RecordFile, RecordedTransition, TurnMade};
use mdle_runtime::capability::Steering;
use mdle_runtime::{
    Compass, Machine, Measured, Meters, Mount, Nanos, PathStore, Ping, Pings, Plan as _, Pose, Published, Sensed,
    Shape, Supply, Transition, Turn, Twist, Watch,
};

type Alphabet = mdle_sim::alphabet::Alphabet;

/// Period of a turn.
pub(super) const PERIOD: Nanos = Nanos(100_000_000);

/// A plan for the simulated robot.
pub(super) struct Scripted {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) loaded: Arc<Loaded<Alphabet>>,
}

impl Scripted {
    pub(super) fn new(text: &str, target: &Target) -> Self {
        let mut input = mdle_files::plan(Path::new("plan.mdle"), text.to_owned(), target).unwrap();
        let (plans, diagnostics) = input.compile(&target.alphabet, None);
        let Some(compiled) = plans.into_iter().next() else { panic!("{text}: {diagnostics:?}") };
        let loaded = load::load::<Alphabet>(&compiled.machine, &input.sources, &target.alphabet).unwrap();
        Self { name: compiled.plan.root.name, text: text.to_owned(), loaded: Arc::new(loaded) }
    }

    /// Writes the record of a run with these outputs, which ends with the turn in which the plan is over.
    pub(super) fn record(&self, outputs: &[Sensed], file: &Path) {
        let begin = Begin {
            target: "sim".to_owned(),
            plan: self.name.clone(),
            period: PERIOD,
            files: vec![("plan.mdle".to_owned(), self.text.clone())],
            ..Begin::default()
        };
        let (mut frames, mut bytes) = (Frames::default(), Vec::new());
        frames.begin(&begin, &outputs[0], &mut bytes);
        let mut machine = Machine::begin(self.loaded.plan(), &outputs[0], Nanos(0));
        for (number, y) in (0..).zip(outputs) {
            let t = Nanos(number * PERIOD.0);
            let mut steps = Steps::default();
            let made = machine.turn(y, t, &mut steps);
            let applied = match made {
                Turn::Law(_) => Applied::Law,
                Turn::Cut => Applied::Cut,
                Turn::Over => Applied::Over,
            };
            let (sent, state) = (made.input(), machine.state());
            let turn = TurnMade { number, t, sent, applied, plan: 1, state, changes: &[], overruled: None };
            frames.turn(turn, y, steps.steps.into_iter(), &mut bytes);
            if machine.is_over() {
                break;
            }
        }
        frames.end(&mut bytes);
        let mut record = RecordFile::new(File::create(file).unwrap());
        record.write_all(&bytes).unwrap();
    }

    /// Returns the transitions in the turn of the last output, each with the scope that ended, the text of its
    /// condition, and the state that was entered.
    pub(super) fn last_steps(&self, outputs: &[Sensed]) -> Vec<(u32, String, u64)> {
        let mut machine = Machine::begin(self.loaded.plan(), &outputs[0], Nanos(0));
        let mut last = Vec::new();
        for (number, y) in (0..).zip(outputs) {
            let mut steps = Steps::default();
            machine.turn(y, Nanos(number * PERIOD.0), &mut steps);
            last = steps.steps;
        }
        last.iter().map(|step| (step.scope, machine.plan().condition(step.scope).to_owned(), step.to)).collect()
    }
}

/// Transitions of a turn, in the form in which a record stores them.
#[derive(Default)]
struct Steps {
    steps: Vec<RecordedTransition>,
    operands: Vec<u32>,
}

impl Watch for Steps {
    fn operand(&mut self, number: u32, _: Measured) {
        self.operands.push(number);
    }

    fn transition(&mut self, transition: Transition) {
        self.steps.push(RecordedTransition::new(&transition, std::mem::take(&mut self.operands)));
    }
}

/// Returns `turns` outputs. `change` is called with the number of each turn and a copy of the previous output, which it
/// changes.
pub(super) fn outputs(turns: u64, mut change: impl FnMut(u64, &mut Sensed)) -> Vec<Sensed> {
    let mut y = first();
    let turns = (0..turns).map(|number| {
        y.at = Nanos(number * PERIOD.0);
        change(number, &mut y);
        y
    });
    turns.collect()
}

/// Returns the output of a robot at the origin whose sonars have not pinged yet.
fn first() -> Sensed {
    let steering = Steering { rotate: 1.0, align: 1.0, avoid: 1.0 };
    let shape = Shape {
        body_radius: Meters(0.2),
        half_length: Meters(0.2),
        half_width: Meters(0.2),
        wheel_base: Meters(0.3),
        sonars_apart: None,
        ring_radius: Meters(0.2),
        confirmation: 1,
        steering,
    };
    Sensed {
        at: Nanos(0),
        data_age: Nanos(0),
        odometry: Pose::ORIGIN,
        velocity: Twist::default(),
        switches: 0,
        pings: Default::default(),
        compass: Compass::default(),
        supply: Supply::default(),
        shape,
        paths: PathStore::EMPTY,
        published: Published::NONE,
    }
}

/// Adds a ping of a sonar with this range to an output.
pub(super) fn ping(y: &mut Sensed, sonar: usize, range: f64) {
    let ping = Ping { range: Some(Meters(range)), at: y.at, pose: y.odometry, mount: Mount::default() };
    y.pings[sonar].push(ping);
}

/// Returns the output with another range in the newest ping of a sonar.
pub(super) fn with_range(y: &Sensed, sonar: usize, range: f64) -> Sensed {
    let mut changed = *y;
    let kept: Vec<Ping> = changed.pings[sonar].newest_first().copied().collect();
    let mut pings = Pings::default();
    kept.iter().skip(1).rev().for_each(|ping| pings.push(*ping));
    pings.push(Ping { range: Some(Meters(range)), ..kept[0] });
    changed.pings[sonar] = pings;
    changed
}

/// Writes the record `NAME.mcap` of a plan with these outputs to a folder.
pub(super) fn write(folder: &Path, name: &str, target: &Target, plan: &str, outputs: &[Sensed]) {
    let file = folder.join(format!("{name}.mcap"));
    Scripted::new(plan, target).record(outputs, &file);
    assert!(fs::metadata(file).unwrap().len() > 0);
}
