//! Reads the file of `--safety`: the safety rules, and the plans that rules start in place of the running plan.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use mdle_compiler::diagnostic::{Sources, judged};
use mdle_compiler::load::{self, Loaded};
use mdle_engine::safety::{Conditions, GuardError, Guardian, Rules, read};
use mdle_files::{InputError, Target, read_plan};
use mdle_record::SafetyTexts;
use mdle_runtime::{Alphabet, ModuleRead, Plan as _};

use crate::failure::{self, Failure};
use crate::plans::texts;
use crate::recorded_files;

/// Maximum size of a safety file, in bytes.
const LARGEST: u64 = 1_000_000;

/// A safety file that has been read.
#[derive(Debug)]
pub(crate) struct SafetyFile {
    path: PathBuf,
    text: String,
    rules: Rules,
    /// Files of the plans that rules start, taken from a record; `None` if these plans are files on the disk.
    recorded: Option<Vec<Vec<(String, String)>>>,
}

/// The rules of a safety file, compiled for a robot.
pub(crate) struct Guarded<A: Alphabet> {
    rules: Rules,
    conditions: Conditions<A>,
    diversions: Vec<Arc<Loaded<A>>>,
    texts: SafetyTexts,
}

impl SafetyFile {
    /// Reads the file. `named` is a prefix for the error message about an unreadable file: the place where another file
    /// names this file, or an empty text.
    ///
    /// # Errors
    /// Fails if the file cannot be read, or is not a safety file.
    pub(crate) fn read(path: &Path, named: &str) -> Result<Self, Failure> {
        let name = path.display();
        let unread = |error| Failure::Usage(format!("{named}the safety file {name} cannot be read: {error}"));
        let text = mdle_host::read_text(path, LARGEST).map_err(unread)?;
        Self::of_text(path, text, None)
    }

    /// Reads the rules of a record.
    ///
    /// # Errors
    /// Fails if the rules are not valid in this version.
    pub(crate) fn recorded(SafetyTexts { name, text, plans }: &SafetyTexts) -> Result<Self, Failure> {
        Self::of_text(Path::new(name), text.clone(), Some(plans.clone()))
    }

    fn of_text(path: &Path, text: String, recorded: Option<Vec<Vec<(String, String)>>>) -> Result<Self, Failure> {
        let rules = read(&text).map_err(|error| Failure::Usage(format!("{}:{error}", path.display())))?;
        Ok(Self { path: path.to_owned(), text, rules, recorded })
    }

    /// Returns the paths of the safety file and of the plans that rules start.
    pub(crate) fn files(&self) -> impl Iterator<Item = PathBuf> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let plans = self.rules.plans.iter().map(|plan| folder.join(&plan.file));
        [self.path.clone()].into_iter().chain(plans)
    }

    /// Compiles the conditions of the rules, and the plans that rules start, for the robot of a target. Plans are
    /// observed if `looks` is `true`.
    ///
    /// # Errors
    /// Fails if a condition or a plan has errors.
    pub(crate) fn compile<A: Alphabet>(&self, target: &Target, looks: bool) -> Result<Guarded<A>, Failure> {
        let mut sources = target.sources();
        let name = self.path.display().to_string();
        let compiled = Conditions::compile((&name, &self.text), &self.rules.guards, &mut sources, &target.alphabet);
        let conditions = compiled.map_err(|error| refused(error, &name, &sources))?;
        if self.recorded.is_none() {
            if self.rules == Rules::default() {
                failure::warning(&format!(
                    "the safety file {name} has no rules: only an input that is no number ends the plan"
                ));
            }
            failure::print(&sources, conditions.warnings());
        }
        let (mut diversions, mut texts) = (Vec::new(), Vec::new());
        let plans = self.files().skip(1).zip(&self.rules.plans);
        for (number, (file, plan)) in plans.enumerate() {
            let recorded = self.recorded.as_ref().map(|plans| plans.get(number).map_or(&[][..], Vec::as_slice));
            let named = NamedPlan { place: format!("{name}:{}", plan.line), file };
            let (loaded, files) = diversion(&named, recorded, target, looks)?;
            diversions.push(loaded);
            texts.push(files);
        }
        let texts = SafetyTexts { name, text: self.text.clone(), plans: texts };
        Ok(Guarded { rules: self.rules.clone(), conditions, diversions, texts })
    }
}

/// Prints the errors of a condition, and returns the failure.
fn refused(error: GuardError, name: &str, sources: &Sources) -> Failure {
    match error {
        GuardError::Faulty(diagnostics) => {
            failure::print(sources, &diagnostics);
            Failure::Usage(format!("the conditions of {name} have errors"))
        }
        GuardError::Unfit(line, sentence) => Failure::Usage(format!("{name}:{line}: {sentence}")),
        GuardError::Load(error) => error.into(),
    }
}

/// A plan that a rule starts in place of the running plan, with the names and texts of its files.
type Diversion<A> = (Arc<Loaded<A>>, Vec<(String, String)>);

/// A plan that a rule starts in place of the running plan.
struct NamedPlan {
    /// Place where the safety file names the plan, such as `rules.toml:3`.
    place: String,
    /// Path of the plan's file.
    file: PathBuf,
}

impl NamedPlan {
    /// Adds the place where the safety file names the plan to an error about the plan's file.
    fn refused(&self, error: InputError) -> InputError {
        InputError::NamedAt { place: self.place.clone(), error: Box::new(error) }
    }
}

/// Compiles and loads a plan that a rule starts, either from a file or from texts in a record.
fn diversion<A: Alphabet>(
    named: &NamedPlan,
    recorded: Option<&[(String, String)]>,
    target: &Target,
    looks: bool,
) -> Result<Diversion<A>, Failure> {
    let (machine, sources, files) = match recorded {
        Some(files) => {
            let (machine, sources) = recorded_files::compiled(files, None, target)?;
            (machine, sources, files.to_vec())
        }
        None => {
            let mut input = read_plan(&named.file, target).map_err(|error| named.refused(error))?;
            let (plans, diagnostics) = input.compile(&target.alphabet, None);
            failure::print(&input.sources, &diagnostics);
            if let Err(sentence) = judged(&diagnostics, false) {
                failure::error(&sentence);
                return Err(Failure::Plan);
            }
            let machines = plans.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine));
            let machine = input.only(machines.collect()).map_err(|error| named.refused(error))?;
            let files = texts(&input);
            (machine, input.sources, files)
        }
    };
    let loaded = load::load::<A>(&machine, &sources, &target.alphabet)?;
    let loaded = Arc::new(if looks { loaded.looked_at(Arc::new(machine)) } else { loaded });
    if loaded.plan().paths().is_empty() {
        return Ok((loaded, files));
    }
    let NamedPlan { place, file } = named;
    Err(Failure::Usage(format!(
        "{place}: the plan {} replays paths, which a plan of a safety rule cannot",
        file.display()
    )))
}

impl<A: Alphabet> Guarded<A> {
    /// Returns the guardian of a run with this period.
    pub(crate) fn guardian(&self, period: std::time::Duration) -> Guardian<A> {
        Guardian::new(self.rules.clone(), &self.conditions, period)
    }

    /// Returns the texts of the rules, and of the plans that rules start.
    pub(crate) fn texts(&self) -> &SafetyTexts {
        &self.texts
    }

    /// Returns the module attributes that the rules read.
    pub(crate) fn reads(&self) -> &'static [ModuleRead] {
        self.conditions.reads()
    }

    /// Returns the plans that rules start.
    pub(crate) fn diversions(&self) -> impl Iterator<Item = load::LoadedPlan<A>> {
        self.diversions.iter().map(Loaded::plan)
    }

    /// Returns the plan with this number among the plans that rules start; `None` if there is no such plan.
    pub(crate) fn diversion(&self, number: usize) -> Option<load::LoadedPlan<A>> {
        self.diversions.get(number).map(Loaded::plan)
    }
}
