//! The output of a scenario: the report on standard output, and the files that options name.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use mdle_host::{Clocked, PilotTurn, is_record};
use mdle_runtime::trace::{Json, Seconds};
use mdle_runtime::{Nanos, Printable, Sensed};
use mdle_sim::{FleetDrawing, TripDrawing};

use super::arguments::ScenarioOptions;
use super::member::{MemberState, MemberTurn, Runner};
use super::records::{ScenarioRecords, unwritten};
use super::setup::Scenario;

/// Reports and files of a run.
pub(super) struct ScenarioOutput {
    out: BufWriter<io::Stdout>,
    log: Option<GrowingFile>,
    records: Option<ScenarioRecords>,
    trail: Option<GrowingFile>,
    plot: Option<(PathBuf, FleetDrawing)>,
    trips: Option<(PathBuf, TripDrawing)>,
    paths: Option<PathBuf>,
    /// First error; after it, the run ends.
    failed: Option<String>,
}

/// A file to which lines are appended during the run.
struct GrowingFile {
    path: PathBuf,
    file: BufWriter<File>,
}

impl GrowingFile {
    fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).map_err(|error| unwritten(path, &error))?;
        Ok(Self { path: path.to_owned(), file: BufWriter::new(file) })
    }

    fn line(&mut self, line: &str) -> Result<(), String> {
        writeln!(self.file, "{line}").map_err(|error| unwritten(&self.path, &error))
    }
}

impl ScenarioOutput {
    /// Opens the files that the options name.
    ///
    /// # Errors
    /// Fails with a message if a file cannot be written.
    pub(super) fn open(options: &ScenarioOptions, scenario: &Scenario) -> Result<Self, String> {
        let table = |path: &Option<PathBuf>| path.as_deref().map(GrowingFile::create).transpose();
        let title = setup(scenario);
        let record = options.log.as_deref().filter(|log| is_record(log));
        let log = options.log.clone().filter(|log| !is_record(log));
        let mut output = Self {
            out: BufWriter::new(io::stdout()),
            log: table(&log)?,
            records: None,
            trail: table(&options.trail)?,
            plot: options.plot.clone().map(|path| (path, FleetDrawing::of(&scenario.world, &title))),
            trips: options.trips.clone().map(|path| (path, TripDrawing::of(&title))),
            paths: options.recorded_paths.clone(),
            failed: None,
        };
        if let Some(trail) = &mut output.trail {
            trail.line("t,robot,x,y,heading")?;
        }
        for path in [&options.plot, &options.trips].into_iter().flatten() {
            // A missing folder is reported now, and not after the run.
            File::create(path).map_err(|error| unwritten(path, &error))?;
        }
        // Records are created last: no other file can then fail and leave them without a run.
        output.records = record.map(|log| ScenarioRecords::create(log, scenario, &options.command)).transpose()?;
        Ok(output)
    }

    /// Writes a turn of a robot whose output is `y`.
    pub(super) fn turn(&mut self, runner: &Runner, y: &Sensed, t: Nanos, number: u64, made: &MemberTurn) {
        for line in &made.lines {
            self.line(t, &runner.name, line);
        }
        if let Some(records) = &mut self.records {
            let recorded = runner.recorded(PilotTurn { y, t, number }, made);
            let written = recorded.map_or(Ok(()), |turn| records.turn(&runner.name, turn));
            let written = match &runner.standing {
                MemberState::Drives => written,
                ended @ (MemberState::Over | MemberState::Killed | MemberState::Failed(_)) => {
                    written.and_then(|()| records.end(&runner.name, (y, t), &ended.words(None)))
                }
            };
            self.note(written);
        }
        let pose = runner.robot.pose();
        let (x, side, heading) = (pose.x.0, pose.y.0, pose.theta.degrees());
        if let Some(trail) = &mut self.trail {
            let written = trail.line(&format!("{},{},{x},{side},{heading}", Seconds(t), runner.name));
            self.note(written);
        }
        if let Some(log) = &mut self.log {
            let (state, law) = made.law.as_ref().map_or((0, ""), |(state, law)| (*state, law.as_str()));
            let lines: Vec<String> = made.lines.iter().map(|line| Json(line).to_string()).collect();
            let written = log.line(&format!(
                "{{\"turn\":{number},\"t\":{},\"robot\":{},\"state\":{state},\"law\":{},\"x\":{x},\"y\":{side},\
                 \"heading\":{heading},\"pressed\":{},\"events\":[{}]}}",
                Seconds(t),
                Json(&runner.name),
                Json(law),
                y.switches != 0,
                lines.join(","),
            ));
            self.note(written);
        }
        if let Some((_, drawing)) = &mut self.plot {
            drawing.went(&runner.name, &runner.robot, y.switches != 0);
        }
        if let Some((_, drawing)) = &mut self.trips {
            let law = made.law.as_ref().map_or("", |(_, law)| law.as_str());
            drawing.went(&runner.name, &pose, law, !made.lines.is_empty());
        }
        if let (Some(folder), Some((path, text))) = (&self.paths, &made.path) {
            let written = record(&folder.join(&runner.name), path, text);
            self.note(written);
        }
    }

    /// Records that the run ends at time `t` with the output `y`. `law` is the law that the robot still runs; `None` if
    /// no law runs.
    pub(super) fn ends(&mut self, runner: &Runner, (y, t): (&Sensed, Nanos), law: Option<&str>) {
        self.line(t, &runner.name, &runner.standing.words(law));
        if let Some(records) = &mut self.records {
            let ended = records.end(&runner.name, (y, t), "end of the scenario");
            self.note(ended);
        }
    }

    /// Removes the records of a run that cannot begin.
    pub(super) fn discard(self) {
        self.records.into_iter().for_each(ScenarioRecords::remove);
    }

    /// Returns `true` if the robots are recorded.
    pub(super) fn records(&self) -> bool {
        self.records.is_some()
    }

    /// Writes a line about a robot at time `t`.
    pub(super) fn line(&mut self, t: Nanos, robot: &str, line: &str) {
        self.text(&format!("{}  {robot}: {line}", Clocked(t)));
    }

    /// Writes a message to the report. A closed pipe is not an error.
    pub(super) fn text(&mut self, message: &str) {
        for line in message.lines() {
            if let Err(error) = writeln!(self.out, "{}", Printable(line))
                && error.kind() != io::ErrorKind::BrokenPipe
            {
                self.note(Err(format!("standard output cannot be written: {error}")));
            }
        }
    }

    fn note(&mut self, written: Result<(), String>) {
        if let (Err(sentence), None) = (written, &self.failed) {
            self.failed = Some(sentence);
        }
    }

    /// Returns `true` if a file could not be written.
    pub(super) fn has_failed(&self) -> bool {
        self.failed.is_some()
    }

    /// Writes the pictures, and all buffered lines of the files.
    ///
    /// # Errors
    /// Fails with a message if a file could not be written.
    pub(super) fn close(mut self) -> Result<(), String> {
        let pictures = [
            self.plot.take().map(|(path, drawing)| (path, drawing.picture())),
            self.trips.take().map(|(path, drawing)| (path, drawing.picture())),
        ];
        for (path, picture) in pictures.into_iter().flatten() {
            let written = fs::write(&path, picture).map_err(|error| unwritten(&path, &error));
            self.note(written);
        }
        for table in [self.log.take(), self.trail.take()].into_iter().flatten() {
            let GrowingFile { path, mut file } = table;
            let written = file.flush().map_err(|error| unwritten(&path, &error));
            self.note(written);
        }
        let flushed = match self.out.flush() {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                Err(format!("standard output cannot be written: {error}"))
            }
            Ok(()) | Err(_) => Ok(()),
        };
        self.note(flushed);
        self.failed.map_or(Ok(()), Err)
    }
}

/// Returns a description of a scenario for titles.
fn setup(scenario: &Scenario) -> String {
    let robots = scenario.members.iter().map(|member| format!("{} ({})", member.name, member.body));
    let seed = scenario.seed.map_or_else(|| "no errors".to_owned(), |seed| format!("seed {seed}"));
    format!("world {}, {}, {seed}", scenario.world_name, robots.collect::<Vec<_>>().join(", "))
}

/// Replaces the file of a path in `folder`. A program that reads the file at the same time gets either the old path or
/// the new path.
fn record(folder: &Path, name: &str, text: &str) -> Result<(), String> {
    let file = folder.join(if Path::new(name).extension().is_some() { name.to_owned() } else { format!("{name}.csv") });
    let unfinished = file.with_extension(format!("{}.tmp", std::process::id()));
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&unfinished, text));
    let written = written.and_then(|()| fs::rename(&unfinished, &file));
    written.map_err(|error| unwritten(&file, &error))
}
