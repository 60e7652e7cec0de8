//! Exports the files of a run, byte for byte as `mdle run` writes them.

use std::fmt::Write as _;

use mdle_runtime::trace::{Fired, Line};
use mdle_runtime::{Nanos, Plan as _, Turn};
use mdle_simulator::Drawing;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::causes;
use crate::course::{Course, CourseEnd, CourseExchange, CourseTurn};
use crate::plan::Plan;
use crate::setup::{PERIOD, PageSetup};

/// Maximum size of a log or a table, in bytes.
const MOST: usize = 128 << 20;

/// A file of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ExportKind {
    /// JSON lines of `--log`.
    Log,
    /// Table of `--trail`.
    Trail,
    /// Picture of `--plot`.
    Plot,
    /// Animation of `--record`.
    Record,
}

/// Repeats a run, and returns its file of this kind.
pub(crate) fn export(kind: ExportKind, setup: &PageSetup) -> Result<Value, String> {
    let plan = Plan::of(&setup.draft, setup.plan.as_deref())?;
    let ready = setup.ready()?;
    let mut course = Course::new(&plan, &ready, false)?;
    let words = setup.in_words(&ready.make);
    let mut files = ExportedFiles {
        kind,
        text: if kind == ExportKind::Trail { "t,x,y,heading\n".to_owned() } else { String::new() },
        drawing: Drawing::of(&course.robot, &ready.world, words, kind == ExportKind::Record),
    };
    let mut t = Nanos::ZERO;
    while course.end.is_none() {
        let Some(exchange) = course.exchange() else { break };
        files.exchanged(&course, &exchange);
        let Some(made) = course.turn(&exchange.y) else { break };
        t = made.t;
        files.turned(&course, &made);
        if files.text.len() > MOST {
            return Err("this run is too long for such a file: use `mdle run`".to_owned());
        }
    }
    let (is_over, by) = match &course.end {
        Some(CourseEnd::Over) => {
            (true, course.machine.as_ref().map_or_else(String::new, |m| causes::last(m.plan(), &course.seen)))
        }
        Some(CourseEnd::Fault(_)) => (false, "a fault".to_owned()),
        Some(CourseEnd::Limit) | None => (false, "--timeout".to_owned()),
    };
    files.drawing.ended(course.plan_name(), is_over, &by, t.max(Nanos(course.turns.saturating_sub(1) * PERIOD.0)));
    if let Some(exchange) = course.release() {
        files.exchanged(&course, &exchange);
    }
    course.stop();
    files.drawing.stopped(&course.robot);
    Ok(json!({ "output": files.finished() }))
}

/// The files that the run is writing.
struct ExportedFiles {
    kind: ExportKind,
    text: String,
    drawing: Drawing,
}

impl ExportedFiles {
    fn exchanged(&mut self, course: &Course, exchange: &CourseExchange) {
        let CourseExchange { t, y, hits } = exchange;
        if self.kind == ExportKind::Trail {
            let pose = course.robot.pose();
            // Writing to a string cannot fail.
            let _ = writeln!(self.text, "{},{},{},{}", t.seconds(), pose.x.0, pose.y.0, pose.theta.degrees());
        }
        self.drawing.exchanged(&course.robot, y, *t, *hits);
    }

    fn turned(&mut self, course: &Course, made: &CourseTurn) {
        let Some(machine) = &course.machine else { return };
        let plan = machine.plan();
        if let Some((atom, written)) = made.began.and_then(|atom| Some((atom, plan.fsm().atoms.get(atom as usize)?))) {
            self.drawing.began(written.state, plan.law(atom), made.t);
        }
        if self.kind != ExportKind::Log {
            return;
        }
        let applied = match made.turn {
            Turn::Law(_) => machine.atom(),
            Turn::Cut | Turn::Over => None,
        };
        let source = plan.source();
        let fired = course.seen.transitions.iter().map(|(transition, operands)| Fired {
            from: transition.from,
            level: usize::from(transition.cause.level()),
            by: transition.by(plan),
            operands: operands
                .iter()
                .filter_map(|(number, _)| source.operand(transition.scope, *number).map(|words| words.text)),
        });
        let line = Line {
            turn: made.number,
            t: made.t,
            state: machine.state(),
            law: applied.map(|atom| plan.law(atom)),
            frame: machine.frame().filter(|_| applied.is_some()),
            fired,
        };
        let _ = writeln!(self.text, "{line}");
    }

    fn finished(self) -> String {
        match self.kind {
            ExportKind::Log | ExportKind::Trail => self.text,
            ExportKind::Plot => self.drawing.picture(),
            ExportKind::Record => self.drawing.animation(),
        }
    }
}
