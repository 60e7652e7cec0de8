//! `mdle plot`: pictures of a recorded run, of its path or over time.

use std::io::Write as _;
use std::process::ExitCode;

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::fsm::Machine;
use mdle_runtime::{Nanos, SONARS, Sensed};
use mdle_sim::{Drawing, SignalCurve, TimeChart};

use crate::arguments::Plot;
use crate::failure::Failure;
use crate::log::{created, unwritten};
use crate::replay::{self, WantedPlan};
use crate::rerun::{Rerun, RerunTurn};
use crate::why;

/// Draws a record.
///
/// # Errors
/// The record or the plan cannot be read, or the picture cannot be written.
pub(crate) fn plot(arguments: &Plot) -> Result<ExitCode, Failure> {
    let signals = arguments.signals.iter().map(|name| signal(name)).collect::<Result<Vec<_>, _>>()?;
    let (begin, record) = replay::record(&arguments.log)?;
    let name = arguments.log.display().to_string();
    let call = format!("mdle plot {name} {}", arguments.file.display());
    let (log, file) = (arguments.log.as_path(), arguments.plan.as_deref());
    let wanted = WantedPlan { log, file, begin: &begin, call: &call, has_run: true };
    let (machine, mut rerun) = why::reruns(&wanted, record)?;
    let mut picture =
        if arguments.is_over_time { Picture::OverTime(Box::default()) } else { Picture::Unbegun(name.clone()) };
    let mut pictured = Pictured { atom: None, touches: false, end: Nanos::ZERO, by: String::new() };
    while let Some(turn) = rerun.turn(&mut |_, _| false) {
        match turn {
            Ok(turn) => pictured.turn(&turn, &machine, &*rerun, &mut picture, &signals)?,
            Err(stop) => return why::stopped(&stop, &name, arguments.plan.as_deref()),
        }
    }
    let text = pictured.ended(picture, &begin.plan, &*rerun);
    let mut file = created(&arguments.file)?;
    file.write_all(text.as_bytes()).map_err(|error| unwritten(&arguments.file.display(), &error))?;
    Ok(ExitCode::SUCCESS)
}

/// A picture while the record is read.
enum Picture {
    /// The path, before the first output of the record of this name.
    Unbegun(String),
    Path(Box<Drawing>),
    OverTime(Box<TimeChart>),
}

/// The run up to a turn.
struct Pictured {
    /// The current atom, and the time at which it began.
    atom: Option<(u32, Nanos)>,
    touches: bool,
    end: Nanos,
    /// Cause of the last transition.
    by: String,
}

impl Pictured {
    fn turn(
        &mut self,
        turn: &RerunTurn,
        machine: &Machine,
        rerun: &dyn Rerun,
        picture: &mut Picture,
        signals: &[Signal],
    ) -> Result<(), Failure> {
        let (t, y) = (turn.recorded.t, &turn.recorded.y);
        if let Picture::Unbegun(name) = picture {
            *picture = Picture::Path(Box::new(Drawing::without_world(y, name.clone(), false)));
        }
        if let Picture::OverTime(chart) = picture
            && chart.atoms.is_empty()
        {
            chart.atoms = machine.atoms().map(|atom| atom.law().text.clone()).collect();
            chart.signals =
                signals.iter().map(|signal| SignalCurve { name: signal.title(), values: Vec::new() }).collect();
        }
        let touches = y.switches != 0;
        if let Picture::Path(drawing) = picture {
            drawing.sensed(y, t, touches && !self.touches);
        }
        self.touches = touches;
        let mut entered = if self.atom.is_none() && turn.recorded.number == 0 { vec![Some(0)] } else { Vec::new() };
        entered.extend(turn.transitions.iter().map(|(transition, _)| transition.atom));
        for atom in entered {
            self.leaves(t, picture);
            self.atom = atom.map(|atom| (atom, t));
        }
        if let (Some((atom, since)), Picture::Path(drawing)) = (self.atom, &mut *picture)
            && since == t
        {
            drawing.began(machine.atom(atom).state(), rerun.texts().law(atom), t);
        }
        if let Picture::OverTime(chart) = picture {
            for (signal, curve) in signals.iter().zip(&mut chart.signals) {
                curve.values.push((t, signal.value(y)));
            }
        }
        if let Some((transition, _)) = turn.transitions.iter().last() {
            self.by = transition.cause.by(rerun.texts().condition(transition.scope)).to_owned();
        }
        self.end = t;
        Ok(())
    }

    /// Ends the stay in the current atom.
    fn leaves(&self, t: Nanos, picture: &mut Picture) {
        if let (Some((atom, since)), Picture::OverTime(chart)) = (self.atom, picture)
            && since < t
        {
            chart.stays.push((atom as usize, since, t));
        }
    }

    /// Returns the picture after the last turn of a plan of this name.
    fn ended(self, mut picture: Picture, plan: &str, rerun: &dyn Rerun) -> String {
        self.leaves(self.end, &mut picture);
        let is_over = self.atom.is_none();
        let by = match (is_over, rerun.is_whole()) {
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

/// A signal of any robot with records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Signal {
    Speed,
    TurnRate,
    X,
    Y,
    Heading,
    Battery,
    Range(usize),
}

const SIGNALS: [(&str, &str, Signal); 6] = [
    ("v", "cm/s", Signal::Speed),
    ("omega", "rad/s", Signal::TurnRate),
    ("x", "m", Signal::X),
    ("y", "m", Signal::Y),
    ("theta", "deg", Signal::Heading),
    ("battery", "V", Signal::Battery),
];

/// Returns the signal of a name.
///
/// # Errors
/// There is no such signal.
fn signal(name: &str) -> Result<Signal, Failure> {
    let range = name.strip_prefix('r').and_then(|number| number.parse().ok()).filter(|number| *number < SONARS);
    let named = || SIGNALS.iter().find(|known| known.0 == name).map(|known| known.2);
    let names: Vec<&str> = SIGNALS.iter().map(|known| known.0).collect();
    range.map(Signal::Range).or_else(named).ok_or_else(|| {
        let help = names.join(", ");
        let meant = did_you_mean(name, &names);
        Failure::Usage(format!("a record has no signal `{name}`{meant}\nhelp: its signals are {help}, and r0 to r15"))
    })
}

impl Signal {
    /// Returns the name with its unit.
    fn title(self) -> String {
        match self {
            Self::Range(sonar) => format!("r{sonar} [m]"),
            Self::Speed | Self::TurnRate | Self::X | Self::Y | Self::Heading | Self::Battery => {
                let known = SIGNALS.iter().find(|known| known.2 == self);
                known.map_or_else(String::new, |(name, unit, _)| format!("{name} [{unit}]"))
            }
        }
    }

    /// Returns the value in its unit; infinite where a sonar heard nothing.
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
