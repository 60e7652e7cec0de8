//! `mdle plot`: draws the path of a recorded run, or a chart of the run over time.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::process::ExitCode;

use mdle_compiler::alphabet::did_you_mean;
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Nanos, SONARS, Sensed};
use mdle_sim::{Drawing, SignalCurve, TimeChart};

use crate::arguments::Plot;
use crate::examined::{ExaminedPlan, ExaminedRun, ExaminedTurn};
use crate::failure::{Failure, unwritten};
use crate::log::created;
use crate::replay::{self, WantedPlan};

/// Draws the run of a record.
///
/// # Errors
/// Fails if the record or the plan cannot be read, or if the picture cannot be written.
pub(crate) fn plot(arguments: &Plot) -> Result<ExitCode, Failure> {
    let signals = arguments.signals.iter().map(|name| signal(name)).collect::<Result<Vec<_>, _>>()?;
    let (begin, record) = replay::record(&arguments.log)?;
    let name = arguments.log.display().to_string();
    let call = format!("mdle plot {name} {}", arguments.file.display());
    let (log, file) = (arguments.log.as_path(), arguments.plan.as_deref());
    let wanted = WantedPlan { log, file, begin: &begin, call: &call, has_run: true };
    let mut run = ExaminedRun::of(&wanted, record)?;
    let mut picture =
        if arguments.is_over_time { Picture::OverTime(Box::default()) } else { Picture::Unbegun(name.clone()) };
    let mut pictured = Pictured::default();
    while let Some(turn) = run.turn() {
        match turn {
            Ok(turn) => pictured.turn(&turn, run.plan().map(|plan| &**plan), &mut picture, &signals),
            Err(stop) => return stop.tell(&name, arguments.plan.as_deref()),
        }
    }
    let text = pictured.ended(picture, &begin.plan, run.is_whole());
    let mut file = created(&arguments.file)?;
    file.write_all(text.as_bytes()).map_err(|error| unwritten(&arguments.file.display(), &error))?;
    Ok(ExitCode::SUCCESS)
}

/// A picture that is being drawn while the record is read.
enum Picture {
    /// A picture of the path before the first output of the record; contains the name of the record.
    Unbegun(String),
    Path(Box<Drawing>),
    OverTime(Box<TimeChart>),
}

impl Picture {
    /// Appends the atoms of a plan to the atoms of a chart. Returns the index of the plan's first atom.
    fn add_atoms(&mut self, plan: &ExaminedPlan) -> usize {
        let Self::OverTime(chart) = self else { return 0 };
        let first = chart.atoms.len();
        chart.atoms.extend(plan.machine.atoms().map(|atom| atom.law().text.clone()));
        first
    }
}

/// State of the run up to a certain turn.
#[derive(Default)]
struct Pictured {
    /// Index of the current atom among the atoms of all plans, and the time at which the atom began; `None` if no atom
    /// runs.
    atom: Option<(usize, Nanos)>,
    /// Index of the current atom in its plan; `None` if no atom runs.
    entered: Option<u32>,
    /// Maps the number of each plan that has been active to the index of its first atom among the atoms of all plans.
    plans: BTreeMap<u64, usize>,
    /// Number of the active plan; `None` before the first plan begins.
    number: Option<u64>,
    touches: bool,
    end: Nanos,
    /// Cause of the last transition.
    by: String,
}

impl Pictured {
    /// Draws a turn; `plan` is `None` before the first plan begins.
    fn turn(
        &mut self,
        turn: &ExaminedTurn,
        plan: Option<&ExaminedPlan>,
        picture: &mut Picture,
        signals: &[CommonSignal],
    ) {
        let (t, y) = (turn.recorded.t, &turn.recorded.y);
        self.output(y, t, picture);
        if let Some(plan) = plan {
            self.atoms(turn, plan, picture);
        }
        if let Picture::OverTime(chart) = picture {
            if chart.signals.is_empty() {
                let named = signals.iter().map(|signal| SignalCurve { name: signal.title(), values: Vec::new() });
                chart.signals = named.collect();
            }
            for (signal, curve) in signals.iter().zip(&mut chart.signals) {
                curve.values.push((t, signal.value(y)));
            }
        }
        self.end = t;
    }

    /// Draws the output of a turn.
    fn output(&mut self, y: &Sensed, t: Nanos, picture: &mut Picture) {
        if let Picture::Unbegun(name) = picture {
            *picture = Picture::Path(Box::new(Drawing::without_world(y, name.clone(), false)));
        }
        let touches = y.pressed();
        if let Picture::Path(drawing) = picture {
            drawing.sensed(y, t, touches && !self.touches);
        }
        self.touches = touches;
    }

    /// Draws the atoms that began in a turn.
    fn atoms(&mut self, turn: &ExaminedTurn, plan: &ExaminedPlan, picture: &mut Picture) {
        let (number, t) = (turn.recorded.plan, turn.recorded.t);
        let first = *self.plans.entry(number).or_insert_with(|| picture.add_atoms(plan));
        let is_other = self.number.replace(number) != Some(number);
        let began = turn.moments.first().filter(|_| is_other).map(|moment| Some(moment.atom));
        for entered in began.into_iter().chain(turn.transitions.iter().map(|(transition, _)| transition.atom)) {
            self.leaves(t, picture);
            self.atom = entered.map(|atom| (first + atom as usize, t));
            self.entered = entered;
        }
        if let (Some((_, since)), Some(atom), Picture::Path(drawing)) = (self.atom, self.entered, &mut *picture)
            && since == t
        {
            let atom = plan.machine.atom(atom);
            drawing.began(atom.state(), &atom.law().text, t);
        }
        if let Some((transition, _)) = turn.transitions.iter().last() {
            self.by = transition.cause.by(plan.texts.condition(transition.scope)).to_owned();
        }
    }

    /// Draws the time that was spent in the current atom, when the atom ends.
    fn leaves(&self, t: Nanos, picture: &mut Picture) {
        if let (Some((atom, since)), Picture::OverTime(chart)) = (self.atom, picture)
            && since < t
        {
            chart.stays.push((atom, since, t));
        }
    }

    /// Completes the picture after the last turn; `plan` is the name of the plan.
    fn ended(self, mut picture: Picture, plan: &str, is_whole: bool) -> String {
        self.leaves(self.end, &mut picture);
        let is_over = self.atom.is_none() && self.number.is_some();
        let by = match (is_over, is_whole) {
            (true, _) => self.by.as_str(),
            (false, true) => "the end of the record",
            (false, false) => "the record has no end",
        };
        match picture {
            Picture::Unbegun(_) => TimeChart::default().picture(),
            Picture::Path(mut drawing) => {
                drawing.ended(plan, is_over, by, self.end);
                drawing.picture()
            }
            Picture::OverTime(mut chart) => {
                chart.title = format!("{plan}, {:.1} s: {by}", self.end.seconds());
                chart.end = self.end;
                chart.picture()
            }
        }
    }
}

/// A signal that the records of all robots contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CommonSignal {
    Speed,
    TurnRate,
    X,
    Y,
    Heading,
    Battery,
    Range(usize),
}

const SIGNALS: [(&str, &str, CommonSignal); 6] = [
    ("v", "cm/s", CommonSignal::Speed),
    ("omega", "rad/s", CommonSignal::TurnRate),
    ("x", "m", CommonSignal::X),
    ("y", "m", CommonSignal::Y),
    ("theta", "deg", CommonSignal::Heading),
    ("battery", "V", CommonSignal::Battery),
];

/// Returns the signal called `name`.
///
/// # Errors
/// Fails if there is no such signal.
fn signal(name: &str) -> Result<CommonSignal, Failure> {
    let range = name.strip_prefix('r').and_then(|number| number.parse().ok()).filter(|number| *number < SONARS);
    let named = || SIGNALS.iter().find(|known| known.0 == name).map(|known| known.2);
    let names: Vec<&str> = SIGNALS.iter().map(|known| known.0).collect();
    range.map(CommonSignal::Range).or_else(named).ok_or_else(|| {
        let help = names.join(", ");
        let meant = did_you_mean(name, &names);
        Failure::Usage(format!("a record has no signal `{name}`{meant}\nhelp: its signals are {help}, and r0 to r15"))
    })
}

impl CommonSignal {
    /// Returns the name of the signal with its unit.
    fn title(self) -> String {
        match self {
            Self::Range(sonar) => format!("r{sonar} [m]"),
            Self::Speed | Self::TurnRate | Self::X | Self::Y | Self::Heading | Self::Battery => {
                let known = SIGNALS.iter().find(|known| known.2 == self);
                known.map_or_else(String::new, |(name, unit, _)| format!("{name} [{unit}]"))
            }
        }
    }

    /// Returns the value of the signal in its unit; infinite for a sonar without an echo or without a ping.
    fn value(self, y: &Sensed) -> f64 {
        match self {
            Self::Speed => y.velocity.v.0 * 100.0,
            Self::TurnRate => y.velocity.omega.0,
            Self::X => y.odometry.x.0,
            Self::Y => y.odometry.y.0,
            Self::Heading => y.odometry.theta.wrapped().degrees(),
            Self::Battery => y.supply.battery.0,
            Self::Range(sonar) => {
                let newest = y.pings.get(sonar).and_then(|pings| pings.newest_first().next());
                newest.and_then(|ping| ping.range).map_or(f64::INFINITY, |range| range.0)
            }
        }
    }
}
