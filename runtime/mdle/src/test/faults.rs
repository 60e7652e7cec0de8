//! Faults of the simulated robot at given times of a run.

use mdle_host::Quantity;
use mdle_runtime::{Meters, Nanos, Ping, Pings, SONARS, Sensed, Twist};
use mdle_sim::Observed;

use super::expected::time;
use super::file::{At, FaultText, TestFileError};

/// The names of the faults, for messages.
const NAMES: &str = "`bumper`, `sonar`, `battery`, `blocked` and `robot`";
/// Maximum range of a sonar, in metres.
const FURTHEST: f64 = 100.0;

/// A fault with the time during which it lasts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TimedFault {
    from: Nanos,
    until: Nanos,
    fault: SensorFault,
}

#[derive(Debug, Clone, PartialEq)]
enum SensorFault {
    /// All bumper switches are in contact.
    Bumper,
    /// A sonar returns this range: the number of the sonar, and the range.
    Sonar(usize, Meters),
    /// The battery has this charge, from 0 to 1.
    Battery(f64),
    /// The wheels do not turn.
    Blocked,
    /// The robot does not answer.
    Robot,
}

/// Reads a fault.
///
/// # Errors
/// Fails with a message if there is no such fault, or if one of its values is missing.
pub(super) fn read(text: &FaultText) -> Result<TimedFault, TestFileError> {
    let FaultText { fault: name, from, until, sonar, range, percent } = text;
    let needs = |key: &str, example: &str| {
        let message = format!("the fault `{}` needs `{key}`", name.get_ref());
        TestFileError::at(name.span(), message).help(format!("as in `{key} = {example}`"))
    };
    let fault = match name.get_ref().as_str() {
        "bumper" => SensorFault::Bumper,
        "blocked" => SensorFault::Blocked,
        "robot" => SensorFault::Robot,
        "battery" => {
            let percent = percent.as_ref().ok_or_else(|| needs("percent", "10"))?;
            if *percent.get_ref() > 100 {
                return Err(TestFileError::at(percent.span(), "a charge is at most 100 percent"));
            }
            SensorFault::Battery(f64::from(*percent.get_ref()) / 100.0)
        }
        "sonar" => {
            let sonar = sonar.as_ref().ok_or_else(|| needs("sonar", "0"))?;
            let number = usize::from(*sonar.get_ref());
            if number >= SONARS {
                return Err(TestFileError::at(sonar.span(), format!("the sonars are 0 to {}", SONARS - 1)));
            }
            SensorFault::Sonar(number, Meters(range_of(range.as_ref().ok_or_else(|| needs("range", "\"30cm\""))?)?))
        }
        other => {
            let near =
                mdle_compiler::alphabet::did_you_mean(other, &["bumper", "sonar", "battery", "blocked", "robot"]);
            let message = format!("there is no fault `{other}`{near}");
            return Err(TestFileError::at(name.span(), message).help(format!("the faults are {NAMES}")));
        }
    };
    let unused = [
        sonar.as_ref().map(|at| (at.span(), "sonar", matches!(fault, SensorFault::Sonar(..)))),
        range.as_ref().map(|at| (at.span(), "range", matches!(fault, SensorFault::Sonar(..)))),
        percent.as_ref().map(|at| (at.span(), "percent", matches!(fault, SensorFault::Battery(_)))),
    ];
    if let Some((place, key, _)) = unused.into_iter().flatten().find(|(.., is_used)| !is_used) {
        return Err(TestFileError::at(place, format!("the fault `{}` has no `{key}`", name.get_ref())));
    }
    let from = from.as_ref().map_or(Ok(Nanos::ZERO), time)?;
    let end = until.as_ref().map_or(Ok(Nanos::MAX), time)?;
    if let Some(until) = until.as_ref().filter(|_| end <= from) {
        return Err(TestFileError::at(until.span(), "the fault ends before it begins"));
    }
    Ok(TimedFault { from, until: end, fault })
}

fn range_of(text: &At<String>) -> Result<f64, TestFileError> {
    let read = Quantity::Length.read(text.get_ref(), "m");
    let read = read.map_err(|sentence| TestFileError::at(text.span(), sentence))?;
    if (0.0..=FURTHEST).contains(&read) {
        return Ok(read);
    }
    Err(TestFileError::at(text.span(), format!("a range is from 0 to {FURTHEST} m")))
}

/// Returns the faults that are active at a time.
fn lasting(faults: &[TimedFault], t: Nanos) -> impl Iterator<Item = &SensorFault> {
    faults.iter().filter(move |fault| fault.from <= t && t < fault.until).map(|fault| &fault.fault)
}

/// Applies the faults to the input and the battery before the exchange at time `t`; returns the input to send.
///
/// # Errors
/// Fails with a message if the robot does not answer.
pub(super) fn before(faults: &[TimedFault], robot: &mut Observed, input: Twist, t: Nanos) -> Result<Twist, String> {
    let mut input = input;
    for fault in lasting(faults, t) {
        match fault {
            SensorFault::Robot => return Err("the robot does not answer, as the test asks".to_owned()),
            SensorFault::Blocked => input = Twist::default(),
            SensorFault::Battery(charge) => robot.set_charge(*charge),
            SensorFault::Bumper | SensorFault::Sonar(..) => {}
        }
    }
    Ok(input)
}

/// Applies the faults to the output of the exchange at time `t`.
pub(super) fn after(faults: &[TimedFault], y: &mut Sensed, t: Nanos) {
    for fault in lasting(faults, t) {
        match fault {
            SensorFault::Bumper => y.switches = u32::MAX,
            SensorFault::Sonar(number, range) => {
                if let Some(pings) = y.pings.get_mut(*number) {
                    *pings = reading(pings, *range);
                }
            }
            SensorFault::Battery(_) | SensorFault::Blocked | SensorFault::Robot => {}
        }
    }
}

/// Returns the pings of a sonar as if all of them had this range.
fn reading(pings: &Pings, range: Meters) -> Pings {
    let known: Vec<Ping> = pings.newest_first().copied().collect();
    let mut faulty = Pings::default();
    known.into_iter().rev().for_each(|ping| faulty.push(Ping { range: Some(range), ..ping }));
    faulty
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Mount, Pose};

    use super::*;

    #[test]
    fn a_sonar_returns_its_range_and_keeps_its_times() {
        let ping = |at, range| Ping { range, at: Nanos(at), pose: Pose::ORIGIN, mount: Mount::default() };
        let mut pings = Pings::default();
        pings.push(ping(1, None));
        pings.push(ping(2, Some(Meters(2.0))));
        let faulty = reading(&pings, Meters(0.3));
        let kept: Vec<_> = faulty.newest_first().map(|ping| (ping.at, ping.range)).collect();
        assert_eq!(kept, [(Nanos(2), Some(Meters(0.3))), (Nanos(1), Some(Meters(0.3)))]);
    }

    #[test]
    fn a_fault_lasts_from_its_begin_up_to_its_end() {
        let fault = TimedFault { from: Nanos(2), until: Nanos(4), fault: SensorFault::Bumper };
        let lasts = [1, 2, 3, 4].map(|t| lasting(std::slice::from_ref(&fault), Nanos(t)).count());
        assert_eq!(lasts, [0, 1, 1, 0]);
    }
}
