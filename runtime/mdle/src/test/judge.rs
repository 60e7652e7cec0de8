//! Compares the course of a run with the expectations of its test.

use mdle_compiler::fsm::Machine;
use mdle_runtime::trace::Seconds;
use mdle_runtime::{Nanos, Pose, Words};

use super::causes::NamedCause;
use super::course::{CourseTransition, TestCourse, TestEnd, atom_words};
use super::expected::{AtomsNamed, ByteRange, Expected, ExpectedEnd, ExpectedTransition, ForbiddenState};
use super::subject::Subject;

/// An expectation that a run has not met.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct UnmetExpectation {
    /// Place of the expectation in the test file.
    pub(super) place: ByteRange,
    /// Message about the run.
    pub(super) message: String,
    /// Text shown at the place of the expectation.
    pub(super) expected: String,
    /// The actual value.
    pub(super) got: String,
    /// Number of the atom at which the difference appears, with a text about it.
    pub(super) atom: Option<(u32, String)>,
    /// Time of the run at which the difference appears.
    pub(super) t: Nanos,
}

/// Returns the expectations that a run has not met.
pub(super) fn judge(expected: &Expected, course: &TestCourse, subject: &Subject) -> Vec<UnmetExpectation> {
    let judge = Judge { course, machine: subject.machine(), words: &subject.words };
    let mut failures = Vec::new();
    failures.extend(judge.fault(expected));
    failures.extend(expected.atoms.as_ref().and_then(|(place, atoms)| judge.atoms(place, atoms)));
    failures.extend(expected.order.as_ref().and_then(|(place, atoms)| judge.order(place, atoms)));
    failures.extend(expected.transitions.iter().filter_map(|(place, wanted)| judge.transition(place, wanted)));
    failures.extend(judge.never(expected));
    failures.extend(expected.end.as_ref().and_then(|(place, end)| judge.end(place, end)));
    failures.extend(judge.pose(expected));
    failures.extend(judge.most(expected));
    failures
}

struct Judge<'j> {
    course: &'j TestCourse,
    machine: &'j Machine,
    words: &'j dyn Words,
}

impl Judge<'_> {
    fn failure(&self, place: &ByteRange, message: String, expected: String, got: String) -> UnmetExpectation {
        UnmetExpectation { place: place.clone(), message, expected, got, atom: self.last_atom(), t: self.course.t }
    }

    /// Returns the number of the last atom of the run, with a text about its end; `None` if no atom began.
    fn last_atom(&self) -> Option<(u32, String)> {
        let last = self.course.began.last()?;
        let words = match self.course.ending {
            TestEnd::Over => "the plan ended in this atom",
            TestEnd::Running | TestEnd::Failed(_) => "the run ended in this atom",
        };
        Some((last.atom, format!("{words}, which began at {} s", Seconds(last.t))))
    }

    /// Returns the failure for a fault that ended the run, unless the test expects the fault.
    fn fault(&self, expected: &Expected) -> Option<UnmetExpectation> {
        let TestEnd::Failed(fault) = &self.course.ending else { return None };
        let place = match &expected.end {
            Some((_, ExpectedEnd::Failed)) => return None,
            Some((place, ExpectedEnd::By(..) | ExpectedEnd::Running)) => place.clone(),
            None => 0..0,
        };
        let words = "the run was to go on without a fault".to_owned();
        Some(self.failure(&place, format!("a fault ended the run: {fault}"), words, fault.clone()))
    }

    fn atoms(&self, place: &ByteRange, atoms: &[AtomsNamed]) -> Option<UnmetExpectation> {
        let began = &self.course.began;
        let differs =
            (0..atoms.len().max(began.len())).find(|number| match (atoms.get(*number), began.get(*number)) {
                (Some(named), Some(began)) => !named.holds(began.atom),
                (Some(_), None) | (None, Some(_)) => true,
                (None, None) => false,
            })?;
        let got = began.get(differs);
        let (message, expected, place) = match (atoms.get(differs), got) {
            (Some(named), Some(_)) => {
                ("another atom began".to_owned(), format!("`{}` was to begin", named.text), &named.place)
            }
            (Some(named), None) => {
                ("an atom did not begin".to_owned(), format!("`{}` was to begin", named.text), &named.place)
            }
            (None, _) => ("one more atom began".to_owned(), "these are all atoms that were to begin".to_owned(), place),
        };
        let got_words = got.map_or("no further atom began".to_owned(), |began| {
            format!("{} began at {} s", atom_words(self.machine, self.words, Some(began.atom)), Seconds(began.t))
        });
        let failure = self.failure(place, message, expected, got_words);
        Some(match got {
            Some(began) => {
                let words = format!("this atom began at {} s", Seconds(began.t));
                UnmetExpectation { atom: Some((began.atom, words)), t: began.t, ..failure }
            }
            None => failure,
        })
    }

    fn order(&self, _: &ByteRange, atoms: &[AtomsNamed]) -> Option<UnmetExpectation> {
        let mut began = self.course.began.iter();
        let mut last: Option<(&AtomsNamed, Nanos)> = None;
        for named in atoms {
            match began.find(|began| named.holds(began.atom)) {
                Some(found) => last = Some((named, found.t)),
                None => {
                    let after = last.map_or(String::new(), |(before, t)| {
                        format!(" after `{}`, which began at {} s", before.text, Seconds(t))
                    });
                    let message = format!("`{}` did not begin", named.text);
                    let got = self.began_after(last.map_or(Nanos::ZERO, |(_, t)| t));
                    return Some(self.failure(&named.place, message, format!("was to begin{after}"), got));
                }
            }
        }
        None
    }

    /// Returns the names of the atoms that began at time `t` or later.
    fn began_after(&self, t: Nanos) -> String {
        const MOST: usize = 6;
        let began: Vec<_> = self.course.began.iter().filter(|began| began.t >= t).collect();
        let words = |atom| atom_words(self.machine, self.words, Some(atom));
        let mut shown: Vec<_> = began.iter().take(MOST).map(|began| words(began.atom)).collect();
        if began.len() > MOST {
            shown.push(format!("… and {} more", began.len() - MOST));
        }
        if shown.is_empty() { "nothing began".to_owned() } else { format!("{} began", shown.join(", ")) }
    }

    fn transition(&self, place: &ByteRange, wanted: &ExpectedTransition) -> Option<UnmetExpectation> {
        let is_named = |named: &Option<AtomsNamed>, atom: Option<u32>| {
            named.as_ref().is_none_or(|named| atom.is_some_and(|atom| named.holds(atom)))
        };
        let is_to = |step: &CourseTransition| match &wanted.to {
            None => true,
            Some(None) => step.to.is_none(),
            Some(named) => is_named(named, step.to),
        };
        let is_by = |step: &CourseTransition| wanted.by.as_ref().is_none_or(|(_, cause)| self.is_by(step, cause));
        let fits = |step: &&CourseTransition| is_named(&wanted.from, step.from) && is_to(step) && is_by(step);
        let is_in_time = |step: &&CourseTransition| {
            wanted.after.is_none_or(|after| step.t >= after) && wanted.within.is_none_or(|within| step.t <= within)
        };
        let candidates: Vec<_> = self.course.steps.iter().filter(fits).collect();
        if candidates.iter().any(is_in_time) {
            return None;
        }
        let words = wanted.words();
        let (message, got, step) = match candidates.first() {
            Some(step) => ("a transition was made at another time", format!("at {} s", Seconds(step.t)), Some(*step)),
            None => {
                let nearest = self.nearest(&[&|step| is_named(&wanted.from, step.from), &is_to, &is_by]);
                let got = nearest.map_or("no transition".to_owned(), |step| self.step_words(step));
                ("a transition was not made", got, nearest)
            }
        };
        let failure = self.failure(place, message.to_owned(), words, got);
        let Some(step) = step else { return Some(failure) };
        let atom = step.from.map(|atom| (atom, format!("left at {} s by {}", Seconds(step.t), step.words)));
        Some(UnmetExpectation { atom, t: step.t, ..failure })
    }

    /// Returns the transition that meets the largest number of `conditions`, the first if there are several; `None` if
    /// there were no transitions.
    fn nearest(&self, conditions: &[&dyn Fn(&CourseTransition) -> bool]) -> Option<&CourseTransition> {
        let met = |step: &CourseTransition| conditions.iter().filter(|condition| condition(step)).count();
        let most = self.course.steps.iter().map(met).max()?;
        self.course.steps.iter().find(|step| met(step) == most)
    }

    /// Returns a transition in words.
    fn step_words(&self, step: &CourseTransition) -> String {
        let [from, to] = [step.from, step.to].map(|atom| atom_words(self.machine, self.words, atom));
        format!("the nearest was from {from} to {to} at {} s by {}", Seconds(step.t), step.words)
    }

    fn is_by(&self, step: &CourseTransition, cause: &NamedCause) -> bool {
        match cause {
            NamedCause::Completed => step.has_completed,
            NamedCause::Operands(operands) => operands
                .iter()
                .any(|(scope, number)| !step.has_completed && step.scope == *scope && step.operands.contains(number)),
            NamedCause::Scopes(scopes) => !step.has_completed && scopes.contains(&step.scope),
        }
    }

    fn never(&self, expected: &Expected) -> Vec<UnmetExpectation> {
        let failures = self.course.breaches.iter().filter_map(|breach| {
            let (place, never) = expected.never.get(breach.number)?;
            let at = format!("at {} s", Seconds(breach.t));
            let (message, got) = match never {
                ForbiddenState::Closer(least) => {
                    let gap = centimetres(breach.gap.unwrap_or(0.0).max(0.0), *least);
                    ("the robot came too close to an obstacle".to_owned(), format!("{gap} cm {at}"))
                }
                ForbiddenState::While { words, .. } => (format!("`{words}` was the case"), format!("it was {at}")),
            };
            let atom = breach.atom.map(|atom| (atom, format!("this atom ran {at}")));
            let failure = self.failure(place, message, "never".to_owned(), got);
            Some(UnmetExpectation { atom, t: breach.t, ..failure })
        });
        failures.collect()
    }

    fn end(&self, place: &ByteRange, end: &ExpectedEnd) -> Option<UnmetExpectation> {
        let last = self.course.last();
        let is_met = match end {
            ExpectedEnd::By(_, cause) => last.is_some_and(|step| self.is_by(step, cause)),
            ExpectedEnd::Running => self.course.ending == TestEnd::Running,
            ExpectedEnd::Failed => matches!(self.course.ending, TestEnd::Failed(_)),
        };
        // A fault is reported as a separate failure.
        if is_met || (matches!(self.course.ending, TestEnd::Failed(_)) && !matches!(end, ExpectedEnd::Failed)) {
            return None;
        }
        let expected = match end {
            ExpectedEnd::By(text, _) => format!("the plan was to end by `{text}`"),
            ExpectedEnd::Running => "the plan was to go on".to_owned(),
            ExpectedEnd::Failed => "a fault was to end the run".to_owned(),
        };
        let got = match last {
            Some(step) => format!("it ended at {} s by {}", Seconds(step.t), step.words),
            None => format!("it was not over at {} s, when the run ended", Seconds(self.course.t)),
        };
        let message = match last {
            Some(_) => "the plan ended otherwise",
            None => "the plan was not over",
        };
        let failure = self.failure(place, message.to_owned(), expected, got);
        let atom = last.and_then(|step| Some((step.from?, format!("the plan ended in this atom by {}", step.words))));
        Some(UnmetExpectation { atom: atom.or_else(|| failure.atom.clone()), ..failure })
    }

    fn pose(&self, expected: &Expected) -> Option<UnmetExpectation> {
        let ((place, _, goal), pose) = (expected.pose.as_ref()?, self.course.pose?);
        if goal.holds(&pose) {
            return None;
        }
        let words = "the robot was to end here".to_owned();
        Some(self.failure(place, "the robot ended elsewhere".to_owned(), words, format!("at {}", pose_words(&pose))))
    }

    fn most(&self, expected: &Expected) -> Vec<UnmetExpectation> {
        let TestCourse { turns, steps, t, .. } = self.course;
        let transitions = steps.len() as u64;
        let counts =
            [(&expected.most_turns, *turns, "turns"), (&expected.most_transitions, transitions, "transitions")];
        let counts = counts.into_iter().filter_map(|(most, count, what)| {
            let (place, most) = most.as_ref().filter(|(_, most)| count > *most)?;
            let got = format!("{count} {what}");
            Some(self.failure(place, format!("the run had more {what}"), format!("at most {most}"), got))
        });
        let late = expected.most_time.as_ref().filter(|(_, most)| t > most).map(|(place, most)| {
            let (expected, got) = (format!("at most {} s", Seconds(*most)), format!("{} s", Seconds(*t)));
            self.failure(place, "the run was longer".to_owned(), expected, got)
        });
        counts.chain(late).collect()
    }
}

/// Returns a distance in centimetres, with as many decimals as needed to show that it is below `least`; both
/// are in metres.
fn centimetres(gap: f64, least: f64) -> String {
    let text = |decimals: usize| format!("{:.decimals$}", gap * 100.0);
    let is_below = |text: &String| text.parse::<f64>().is_ok_and(|shown| shown < least * 100.0);
    (1..9).map(text).find(is_below).unwrap_or_else(|| text(9))
}

/// Returns the position and the heading of a pose, in the syntax of `--start`.
pub(super) fn pose_words(pose: &Pose) -> String {
    // Zeros are shown without a sign.
    let shown = |value: f64| format!("{:.2}", value + 0.0).replace("-0.00", "0.00");
    format!("{},{},{:.0}", shown(pose.x.0), shown(pose.y.0), libm::round(pose.theta.degrees()) + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_differs_from_its_limit() {
        let shown =
            [(0.01996, 0.02), (0.0199999, 0.02), (0.5, 0.6), (0.0, 0.02)].map(|(gap, least)| centimetres(gap, least));
        assert_eq!(shown, ["1.996", "1.99999", "50.0", "0.0"]);
    }
}
