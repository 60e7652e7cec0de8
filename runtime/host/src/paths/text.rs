//! Parses the text of a path: a header with the columns and their units, then a row for each setpoint; `#` begins a
//! comment.

use std::f64::consts::PI;
use std::str::from_utf8;
use std::time::Duration;

use mdle_runtime::{MetersPerSecond, Nanos, Radians, Setpoint, Twist};

/// Maximum time between two rows. With more time between them, the motion from one row to the next would be a guess.
pub(super) const APART: Duration = Duration::from_secs(1);

/// Header of a path file, as messages show it.
const HEADER: &str = "`time s, heading deg, speed cm/s`";
/// Factor by which the speeds of a path may exceed the robot's limits, because measured speeds may be slightly above
/// the limits.
const MARGIN: f64 = 1.05;
/// Latest time of a row, in nanoseconds: three months. Up to this time, an `f64` represents every whole number exactly.
const LATEST: f64 = (1_u64 << 53) as f64;

/// A column of a path file. Each of its units has a factor that converts to nanoseconds, radians, or metres per second.
struct Column {
    name: &'static str,
    units: [(&'static str, f64); 2],
}

const COLUMNS: [Column; 3] = [
    Column { name: "time", units: [("s", 1e9), ("ms", 1e6)] },
    Column { name: "heading", units: [("deg", PI / 180.0), ("rad", 1.0)] },
    Column { name: "speed", units: [("cm/s", 0.01), ("m/s", 1.0)] },
];

/// An error in a path: its line and column, counted from 1, and the message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TextFault {
    pub(super) place: Option<(usize, usize)>,
    pub(super) what: String,
}

/// A cell of a row: the text between two commas.
#[derive(Debug, Clone, Copy)]
struct RowCell<'t> {
    place: (usize, usize),
    text: &'t str,
}

impl RowCell<'_> {
    fn wrong(&self, what: String) -> TextFault {
        TextFault { place: Some(self.place), what }
    }

    /// Returns the number in the cell; an error message calls the number `what`.
    fn number(&self, what: &str) -> Result<f64, TextFault> {
        match self.text.parse::<f64>() {
            _ if self.text.is_empty() => Err(self.wrong(format!("the {what} is missing"))),
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) | Err(_) => Err(self.wrong(format!("the {what} is `{}`: expected a number", self.text))),
        }
    }
}

/// Returns the bytes of a file as text.
pub(super) fn utf8(bytes: &[u8]) -> Result<&str, TextFault> {
    from_utf8(bytes).map_err(|error| {
        let before = String::from_utf8_lossy(bytes.get(..error.valid_up_to()).unwrap_or_default());
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
        TextFault { place: Some((line, column)), what: "this is not UTF-8; save the file as text in UTF-8".to_owned() }
    })
}

/// Returns the setpoints in `text`, which must not exceed the maximum speeds `fastest` of the robot. The first setpoint
/// is at time 0, and each other setpoint is later than the previous one.
pub(super) fn setpoints(text: &str, fastest: Twist) -> Result<Vec<Setpoint>, TextFault> {
    // Some spreadsheets begin a file with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let rows = text.lines().map(|line| line.split_once('#').map_or(line, |(row, _)| row));
    let mut lines = (1..).zip(rows).filter(|(_, row)| !row.trim().is_empty());
    let Some((line, header)) = lines.next() else {
        return Err(TextFault { place: None, what: format!("there is nothing in it; a path begins with {HEADER}") });
    };
    let units = units(&cells(line, header))?;
    let mut rows = PathRows { units, fastest, setpoints: Vec::new() };
    lines.try_for_each(|(line, row)| rows.push(&cells(line, row)))?;
    if rows.setpoints.len() < 2 {
        let what = "a path needs two rows at least: where it begins, and where it ends".to_owned();
        return Err(TextFault { place: None, what });
    }
    Ok(rows.setpoints)
}

/// Returns the cells of a line.
fn cells(line: usize, text: &str) -> Vec<RowCell<'_>> {
    let mut column = 1;
    let cells = text.split(',').map(|cell| {
        let blanks = cell.chars().take_while(|blank| blank.is_whitespace()).count();
        // An empty cell is reported at its start.
        let place = (line, column + if cell.trim().is_empty() { 0 } else { blanks });
        column += cell.chars().count() + 1;
        RowCell { place, text: cell.trim() }
    });
    cells.collect()
}

/// Returns the unit of each column.
fn units(header: &[RowCell<'_>]) -> Result<[(&'static str, f64); 3], TextFault> {
    if let [cell] = header
        && cell.text.contains([';', '\t'])
    {
        return Err(cell.wrong(format!("expected commas between the columns, as in {HEADER}")));
    }
    let mut units = [("", 0.0); 3];
    for (number, cell) in header.iter().enumerate() {
        if cell.text.parse::<f64>().is_ok() {
            return Err(cell.wrong(format!("no units are given; put {HEADER} in front")));
        }
        let (Some(column), Some(place)) = (COLUMNS.get(number), units.get_mut(number)) else {
            return Err(cell.wrong(format!("`{}` is one column too many; expected {HEADER}", cell.text)));
        };
        *place = column.unit(cell)?;
    }
    match (COLUMNS.get(header.len()), header.last()) {
        (Some(missing), Some(last)) => {
            Err(last.wrong(format!("the column `{}` is missing; expected {HEADER}", missing.name)))
        }
        (Some(_) | None, _) => Ok(units),
    }
}

impl Column {
    /// Returns the unit that a cell of the header gives for this column.
    fn unit(&self, cell: &RowCell<'_>) -> Result<(&'static str, f64), TextFault> {
        let Self { name, units: [(one, _), (other, _)] } = self;
        let mut words = cell.text.split_whitespace();
        if words.next() != Some(name) {
            return Err(cell.wrong(format!("expected the column `{name}`, found `{}`; as in {HEADER}", cell.text)));
        }
        let word = words.collect::<Vec<_>>().join(" ");
        let unit = self.units.into_iter().find(|(unit, _)| *unit == word);
        unit.ok_or_else(|| {
            let expected = format!("expected `{name} {one}` or `{name} {other}`");
            cell.wrong(match word.as_str() {
                "" => format!("the unit of `{name}` is missing: {expected}"),
                word => format!("`{word}` is no unit of `{name}`: {expected}"),
            })
        })
    }
}

/// Setpoints of the rows that have been parsed so far.
struct PathRows {
    units: [(&'static str, f64); 3],
    fastest: Twist,
    setpoints: Vec<Setpoint>,
}

impl PathRows {
    fn push(&mut self, row: &[RowCell<'_>]) -> Result<(), TextFault> {
        let [(_, nanos), (_, radians), (_, metres)] = self.units;
        let (time, heading, speed) = match row {
            [time, heading, speed] => (time, heading, speed),
            [_, _, _, more, ..] => {
                return Err(more.wrong(format!("`{}` is one value too many; expected time, heading, speed", more.text)));
            }
            [.., last] => return Err(last.wrong("a value is missing; expected time, heading, speed".to_owned())),
            [] => return Ok(()),
        };
        let at = self.time(time, time.number("time")? * nanos)?;
        let setpoint = Setpoint {
            at,
            heading: Radians(heading.number("heading")? * radians).wrapped(),
            speed: MetersPerSecond(speed.number("speed")? * metres),
        };
        self.check_speed(speed, setpoint.speed)?;
        self.check_turn(heading, &setpoint)?;
        self.setpoints.push(setpoint);
        Ok(())
    }

    /// Checks and returns the time of the next setpoint. `nanos` is the time since the first setpoint, in nanoseconds.
    fn time(&self, cell: &RowCell<'_>, nanos: f64) -> Result<Nanos, TextFault> {
        if nanos > LATEST {
            return Err(cell.wrong(format!("no path is as long as {}", self.shown(cell))));
        }
        // A negative time becomes 0 here, and is reported below.
        let at = Nanos(nanos.round() as u64);
        match self.setpoints.last() {
            None if nanos != 0.0 => {
                Err(cell.wrong(format!("the first row is at {}: a path begins at time 0", self.shown(cell))))
            }
            None => Ok(at),
            Some(last) if nanos.is_sign_negative() || at <= last.at => Err(cell.wrong(format!(
                "the row before is at {} s, and this one at {}: times have to increase",
                last.at.seconds(),
                self.shown(cell)
            ))),
            Some(last) if u128::from(at.since(last.at).0) > APART.as_nanos() => Err(cell.wrong(format!(
                "a gap: there is no row between {} s and {} s, and two rows may be {} s apart; fill it, or cut the path in two",
                last.at.seconds(),
                at.seconds(),
                APART.as_secs()
            ))),
            Some(_) => Ok(at),
        }
    }

    /// Returns a time as written in the file, with its unit.
    fn shown(&self, cell: &RowCell<'_>) -> String {
        let [(unit, _), ..] = self.units;
        format!("{} {unit}", cell.text)
    }

    fn check_speed(&self, cell: &RowCell<'_>, speed: MetersPerSecond) -> Result<(), TextFault> {
        let ([.., (unit, metres)], fastest) = (self.units, self.fastest.v.0);
        if speed.0.abs() <= fastest * MARGIN {
            return Ok(());
        }
        let fastest = fastest / metres;
        Err(cell.wrong(format!("{} {unit} is too fast: this robot drives at {fastest} {unit} at most", cell.text)))
    }

    /// Checks that the robot has enough time to turn from the heading of the previous setpoint to the heading of `to`.
    fn check_turn(&self, cell: &RowCell<'_>, to: &Setpoint) -> Result<(), TextFault> {
        let Some(from) = self.setpoints.last() else { return Ok(()) };
        let (turn, seconds) = (Radians(to.heading.0 - from.heading.0).wrapped(), to.at.since(from.at).seconds());
        let fastest = self.fastest.omega.0;
        if turn.0.abs() <= fastest * MARGIN * seconds {
            return Ok(());
        }
        let [turn, fastest] = [turn.0.abs(), fastest].map(|angle| (Radians(angle).degrees() * 10.0).round() / 10.0);
        Err(cell.wrong(format!(
            "{turn} deg in {seconds} s is too fast a turn: this robot turns by {fastest} deg/s at most; give it more time"
        )))
    }
}
