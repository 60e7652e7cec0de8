//! `mdle run`: compiles a plan, loads it and runs it.

use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::Arc;

use mdle_compiler::diagnostic::judged;
use mdle_engine::Library;
use mdle_files::{Input, InputError, KnownSettings, SafetyEntry, Settings, Target};
use mdle_host::{Call, Program, RecordedPlan};
use mdle_runtime::Sensed;

use crate::arguments::{self, MapOption, RunArguments};
use crate::evidence::{MapFiles, pose};
use crate::failure::{self, Failure};
use crate::input_files::InputFiles;
use crate::link::{LinkFile, OpenRouter};
use crate::modules::{self, AudioSource, HEADING, MapRun, Saved, SoundInput};
use crate::plans::{self, texts};
use crate::safety::SafetyFile;
use crate::scenario;
use crate::session;
use crate::targets::{self, LinkedTarget, ReadyPlan};

/// Exit status if a map could not be written.
const FAULT: u8 = 3;

/// Runs a plan with the modules in `library` and the modules that the settings name; returns the exit status of the
/// run. `open_router` opens a link through a router.
///
/// # Errors
/// Fails if the plan cannot be run.
pub(crate) fn run(
    arguments: RunArguments,
    library: &mut Library<Sensed>,
    open_router: Option<OpenRouter>,
) -> Result<ExitCode, Failure> {
    if scenario::is_scenario(&arguments.file) {
        return scenario::run(&arguments, library);
    }
    let files = InputFiles::of_system(&arguments.file);
    run_files(arguments, &files, "", library, open_router)
}

/// Runs the plan in these files, as [`run`] does. `version` is the version text of the executable that contains the
/// files; empty for files on the disk.
///
/// # Errors
/// Fails if the plan cannot be run.
pub(crate) fn run_files(
    arguments: RunArguments,
    files: &InputFiles,
    version: &str,
    library: &mut Library<Sensed>,
    open_router: Option<OpenRouter>,
) -> Result<ExitCode, Failure> {
    let settings = files.settings(&arguments.file)?;
    let map = arguments.map.as_ref().map(map_run).transpose()?;
    if let Some(map) = &map {
        map.register(library);
    }
    modules::of_settings(&settings, &arguments, library)?;
    let name = settings.name_of_target(arguments.target.as_deref()).ok_or(InputError::NoTarget)?;
    let linked = targets::linked(&name).map_err(Failure::Usage)?;
    let target = Arc::new(settings.target(arguments.target.as_deref())?);
    let safety = safety_file(&arguments, &settings)?;
    let link = arguments.link.as_deref().map(|link| LinkFile::read(link, open_router)).transpose()?;
    let mut input = files.plan(&arguments.file, &target)?;
    let named = arguments.plan.as_deref();
    let group = link.as_ref().and_then(|link| Some((link, input.group(named)?)));
    let part = group.map(|(link, group)| link.part(&group)).transpose()?;
    let wanted = part.as_deref().or(named);
    let run = PlanRun { arguments: &arguments, files, linked: &linked, target: &target, safety: safety.as_ref() };
    let (plan, mut ready) = run.compiled(wanted, &mut input)?;
    // Who asks for help or for the version needs neither the module nor a link.
    let lacks_heading = !arguments.asks() && ready.reads(HEADING) && arguments.lacks_heading(library);
    ready.hears(arguments.hearing()?);
    let linked_by = link.as_ref().map(|link| link.path().to_owned());
    if !arguments.asks() {
        ready.link(link)?;
    }
    ready.records(arguments.records.as_deref())?;
    let program = Program { plan: &plan, version };
    let given: Vec<_> = arguments.options.iter().map(|option| option.to_string_lossy().into_owned()).collect();
    let mut options: Vec<OsString> = Vec::new();
    for option in settings.run_options(arguments.target.as_deref(), &given, |_| KnownSettings::default())? {
        let call = Call { words: arguments.words.clone(), options: option.arguments.clone(), ..no_call() };
        (linked.check)(program, &call).map_err(|text| option.refused(&text))?;
        options.extend(option.arguments);
    }
    let recorded = RecordedPlan {
        files: texts(&input),
        beside: beside(&arguments, ready.as_ref()),
        safety: ready.safety().cloned(),
        settings: determining(&arguments, &settings, &name),
    };
    options.extend(arguments.options);
    if map.is_some() && options.iter().any(|option| option.to_string_lossy().split('=').next() == Some("--runs")) {
        let sentence = "--map is for one run, and `--runs` makes several\nhelp: leave one of them out";
        return Err(Failure::Usage(sentence.to_owned()));
    }
    let read = input.inputs(&target).into_iter().chain(safety.iter().flat_map(SafetyFile::files)).chain(linked_by);
    let read = read.collect();
    let own_options = arguments::own_options(arguments.session.is_some(), !version.is_empty());
    drop(input);
    let call = Call { words: arguments.words, options, read, recorded, later_path: arguments.records, own_options };
    if lacks_heading && (linked.check)(program, &call).is_ok() {
        let help = "`--ears robot` loads one that hears sounds, and `--point X,Y` one that knows a point";
        failure::warning(&format!("the plan reads the module `{HEADING}`, and none is loaded\nhelp: {help}"));
    }
    let status = match &arguments.session {
        None => ready.run(program, call, library),
        Some(session) => session::held(session, &arguments.file, |seat| ready.session(&plan, call, library, seat))?,
    };
    Ok(map.map_or(status, |map| saved(&map, status)))
}

/// Creates the map of a run.
fn map_run(map: &MapOption) -> Result<MapRun, Failure> {
    let origin = pose("--map-at", &map.at)?;
    Ok(MapRun::new(origin, MapFiles::new(&map.file, Some(&map.file.with_extension("png")))?))
}

/// Saves the map of a run that has ended with the exit status `status`. Returns the resulting exit status.
fn saved(map: &MapRun, status: ExitCode) -> ExitCode {
    match map.save() {
        Ok(Saved::Map | Saved::NoTurn) => status,
        Ok(Saved::NoPing) => {
            failure::warning("no sonar has pinged, so there is no map to save");
            status
        }
        Err(sentence) => {
            failure::error(&format!("the map {sentence}"));
            ExitCode::from(FAULT)
        }
    }
}

/// Returns a call without arguments.
fn no_call() -> Call {
    let recorded = RecordedPlan::default();
    Call {
        words: Vec::new(),
        options: Vec::new(),
        read: Vec::new(),
        recorded,
        later_path: None,
        own_options: Vec::new(),
    }
}

impl RunArguments {
    /// Returns `true` if the run has no module `heading`. Returns `false` in a session, because a session may load the
    /// module later.
    fn lacks_heading(&self, library: &Library<Sensed>) -> bool {
        self.ears.is_none() && self.session.is_none() && library.admits(HEADING).is_ok()
    }

    /// Opens the source of sound that `--ears` names; returns `None` without this option.
    fn hearing(&self) -> Result<Option<SoundInput>, Failure> {
        let Some(ears) = &self.ears else { return Ok(None) };
        let source = AudioSource::open(ears).map_err(Failure::Usage)?;
        Ok(Some(SoundInput { source, radius: self.head }))
    }
}

/// Returns the entry for a safety file in the settings; `None` if there is no such entry, or if the arguments name a
/// safety file.
fn safety_entry(arguments: &RunArguments, settings: &Settings) -> Option<SafetyEntry> {
    settings.safety().filter(|_| arguments.safety.is_none())
}

/// Reads the safety file of a run; `None` if the run has no safety file.
fn safety_file(arguments: &RunArguments, settings: &Settings) -> Result<Option<SafetyFile>, Failure> {
    if let Some(SafetyEntry { place, file }) = safety_entry(arguments, settings) {
        return SafetyFile::read(&file, &format!("{place}: ")).map(Some);
    }
    arguments.safety.as_deref().map(|file| SafetyFile::read(file, "")).transpose()
}

/// Returns the arguments that the settings add to `arguments`, except the options of the run. `target` is the name of
/// the run's target.
fn determining(arguments: &RunArguments, settings: &Settings, target: &str) -> Vec<String> {
    let target = arguments.target.is_none().then(|| ["--target".to_owned(), target.to_owned()]);
    let modules = modules::only_of_settings(settings, arguments);
    let modules = modules.flat_map(|module| ["--module".to_owned(), format!("{}={}", module.name, module.command)]);
    let safety = safety_entry(arguments, settings);
    let safety = safety.map(|entry| ["--safety".to_owned(), entry.file.display().to_string()]);
    target.into_iter().flatten().chain(modules).chain(safety.into_iter().flatten()).collect()
}

/// Returns a list of the inputs of a run other than the plan and the robot's outputs; empty if there are no such
/// inputs.
fn beside(arguments: &RunArguments, ready: &dyn ReadyPlan) -> String {
    let parts: [(bool, &str); 5] = [
        (ready.safety().is_some(), "safety rules"),
        (arguments.session.is_some(), "the commands of a session"),
        (ready.reads_modules(), "modules"),
        (arguments.link.is_some(), "the state link"),
        (arguments.records.is_some(), "recorded paths"),
    ];
    parts.into_iter().filter_map(|(is_there, words)| is_there.then_some(words)).collect::<Vec<_>>().join(" and ")
}

/// The arguments, files and target of a run, for which its plan is compiled and loaded.
struct PlanRun<'r> {
    arguments: &'r RunArguments,
    files: &'r InputFiles,
    linked: &'r LinkedTarget,
    target: &'r Arc<Target>,
    safety: Option<&'r SafetyFile>,
}

impl PlanRun<'_> {
    /// Compiles and loads the plan `wanted`; without a name, the only plan. Returns the name of the plan, and the
    /// loaded plan. Messages go to standard error.
    fn compiled(&self, wanted: Option<&str>, input: &mut Input) -> Result<(String, Box<dyn ReadyPlan>), Failure> {
        if let Some(name) = wanted {
            input.must_have(name)?;
        }
        let (compiled, diagnostics) = input.compile(&self.target.alphabet, wanted);
        self.files.compiled(input, &diagnostics);
        if let Err(sentence) = judged(&diagnostics, self.arguments.deny_warnings) {
            failure::error(&sentence);
            return Err(Failure::Plan);
        }
        let named = compiled.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine));
        let named = named.map(|(name, machine)| (name.clone(), (name, machine)));
        let (name, machine) = input.only(named.collect())?;
        let mut ready = (self.linked.load)(&machine, input, self.target, self.safety)?;
        if self.arguments.session.is_some() {
            ready.describe(plans::facts(&machine, &plans::rendered(&input.sources, &diagnostics)));
        }
        Ok((name, ready))
    }
}
