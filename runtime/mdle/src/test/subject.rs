//! The tested plan: compiled, with its source words, and loaded for the simulator.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mdle_compiler::diagnostic::{Diagnostic, Severity, judged};
use mdle_compiler::fsm::{self, Element, Machine, PlanWords};
use mdle_compiler::load::{self, Loaded};
use mdle_compiler::{Compiled, compile};
use mdle_engine::Library;
use mdle_files::{Input, InputError, KnownSettings, NamedProcess, Settings, Spelling, Target, read_plan};
use mdle_host::Texts;
use mdle_runtime::{Condition, Fsm, Sensed, Words};
use mdle_sim::alphabet::Alphabet as SimAlphabet;

use super::file::{TestFile, TestFileError};
use crate::elements_named::elements_named;
use crate::failure::{self, Failure};

/// Default target of tests.
const SIM: &str = "sim";

/// A plan that is tested.
pub(super) struct Subject {
    /// Path of the plan's file.
    pub(super) file: PathBuf,
    pub(super) compiled: Compiled,
    /// Operands and lines of the plan.
    pub(super) words: PlanWords,
    pub(super) target: Target,
    /// Name of the target.
    pub(super) target_name: String,
    /// The plan for the simulator; `None` for another target.
    pub(super) loaded: Option<Arc<Loaded<SimAlphabet>>>,
    /// Arguments for the simulator from the `mdle.toml` beside the plan.
    pub(super) options: Vec<String>,
    /// Child processes that the `mdle.toml` beside the plan names as modules.
    processes: Vec<NamedByFile>,
}

/// A module that an `mdle.toml` names.
struct NamedByFile {
    /// Place of the module's entry in the file, for messages.
    place: String,
    name: String,
    command: String,
}

/// A condition that a test names.
pub(super) struct TestCondition {
    pub(super) machine: Machine,
    /// The condition for the simulator; `None` for another target.
    pub(super) loaded: Option<Arc<Loaded<SimAlphabet>>>,
}

impl Subject {
    /// Compiles the plan of the test file at `path`; returns it with its files. Messages of the compiler go to standard
    /// error; `refused` reports an error of the test file.
    ///
    /// # Errors
    /// Fails if the plan cannot be read or has errors.
    pub(super) fn read(
        path: &Path,
        tests: &TestFile,
        refused: &dyn Fn(&TestFileError) -> Failure,
    ) -> Result<(Self, Input), Failure> {
        let file = plan_file(path, tests);
        let settings = Settings::beside(&file)?;
        let given = tests.target.as_ref().map(|target| target.get_ref().as_str());
        // Scripts need no robot: without a target, the plan is compiled for a robot with every capability.
        let is_simulated = tests.test.iter().any(|test| test.script.is_none());
        let option = given.or_else(|| (is_simulated && !settings.names_target(None)).then_some(SIM));
        let target_name = settings.name_of_target(option).unwrap_or_default();
        let placed = |place: Option<Range<usize>>, error| {
            placed(place, error).map_or_else(Failure::Input, |error| refused(&error))
        };
        let target = settings.target(option);
        let target = target.map_err(|error| placed(tests.target.as_ref().map(|target| target.span()), error))?;
        let input = read_plan(&file, &target);
        let mut input = input.map_err(|error| placed(tests.plan.as_ref().map(|plan| plan.span()), error))?;
        let wanted = tests.name.as_ref().map(|name| name.get_ref().as_str());
        if let Some(name) = &tests.name {
            input.must_have(name.get_ref()).map_err(|error| placed(Some(name.span()), error))?;
        }
        let (plans, diagnostics) = input.compile(&target.alphabet, wanted);
        let errors: Vec<_> = diagnostics.iter().filter(|found| is_error(found)).cloned().collect();
        if let Err(sentence) = judged(&errors, false) {
            failure::print(&input.sources, &errors);
            failure::error(&format!("{}: {sentence} in the plan", path.display()));
            return Err(Failure::Plan);
        }
        let named = plans.into_iter().map(|compiled| (compiled.plan.root.name.clone(), compiled));
        let compiled = input.only(named.collect());
        let compiled = compiled.map_err(|error| Failure::Usage(error.message(Spelling::TestEntry)))?;
        let words = fsm::words(&compiled.machine, &input.sources, &target.alphabet);
        let loaded = match target_name == SIM {
            true => Some(Arc::new(load::load(&compiled.machine, &input.sources, &target.alphabet)?)),
            false => None,
        };
        let options = run_options(&settings, option)?;
        let processes = settings.modules().map(|NamedProcess { place, name, command }| NamedByFile {
            place: place.to_string(),
            name: name.to_owned(),
            command: command.to_owned(),
        });
        let processes = processes.collect();
        Ok((Self { file, compiled, words, target, target_name, loaded, options, processes }, input))
    }

    /// Returns the modules of a run: those of the program, and those that the `mdle.toml` names.
    ///
    /// # Errors
    /// Fails with a message if a name is not a module name, or is already taken.
    pub(super) fn modules(&self, library: &Library<Sensed>) -> Result<Library<Sensed>, String> {
        let mut library = library.clone();
        for NamedByFile { place, name, command } in &self.processes {
            library.admits(name).map_err(|refusal| format!("{place}: {refusal}"))?;
            library.process(name, command);
        }
        Ok(library)
    }

    /// Returns the state machine of the plan.
    pub(super) fn machine(&self) -> &Machine {
        &self.compiled.machine
    }

    /// Returns, for each atom, `true` if a text names it: by the law, by the law's name, or by the name of an
    /// enclosing scope.
    ///
    /// # Errors
    /// Fails with a message and a help text if the plan has no such atom.
    pub(super) fn atoms(&self, text: &str) -> Result<Vec<bool>, (String, String)> {
        let named = elements_named(self.machine(), &self.target, text)?;
        let is_inside = |element: Element<'_>| element.outwards().any(|element| named.contains(&element.number()));
        Ok(self.machine().atoms().map(|atom| is_inside(atom.element())).collect())
    }

    /// Compiles a condition on the output of one turn.
    ///
    /// # Errors
    /// Fails with a message if the text is not such a condition.
    pub(super) fn condition(&self, text: &str) -> Result<TestCondition, String> {
        let law = self.machine().atom(0).law().text.clone();
        let plan = format!("{{ Condition ({text})\n (Atom (null) ({law})) }}");
        let mut sources = self.target.sources();
        let source = sources.add("condition", plan.as_str());
        let (mut plans, diagnostics) = compile(source, &plan, &self.target.alphabet, None);
        if let Some(error) = diagnostics.iter().find(|found| is_error(found)) {
            return Err(error.message.clone());
        }
        let machine = match (plans.pop(), plans.len()) {
            (Some(compiled), 0) if compiled.machine.atoms().count() == 1 => compiled.machine,
            _ => return Err("this is not one condition".to_owned()),
        };
        let rows = fsm::rows(&machine);
        let root = rows.guards.iter().take(1).map(|guard| &guard.condition);
        if let Some(word) = root.chain(&rows.operands).find_map(memory) {
            return Err(format!("`{word}` depends on more than one turn, which a condition of a test cannot"));
        }
        let load = |_| load::load(&machine, &sources, &self.target.alphabet).map(Arc::new);
        let loaded = self.loaded.as_ref().map(load).transpose().map_err(|error| error.to_string())?;
        Ok(TestCondition { machine, loaded })
    }

    /// Returns the operands of the plan, each with its element, its number and its text as written.
    pub(super) fn operands(&self) -> impl Iterator<Item = (u32, u32, mdle_runtime::OperandWords<'_>)> {
        let elements = self.machine().elements().map(|element| element.number());
        elements.flat_map(move |element| {
            (0..).map_while(move |number| Some((element, number, self.words.operand(element, number)?)))
        })
    }
}

/// Returns the error at its place in the test file, if it has a place there and the plan's own file has no errors.
///
/// # Errors
/// Returns `error` unchanged if there is no such place, or if the plan's own file has errors.
fn placed(place: Option<Range<usize>>, error: InputError) -> Result<TestFileError, InputError> {
    let Some(place) = place.filter(|_| !matches!(error, InputError::Faulty(_))) else { return Err(error) };
    let message = error.message(Spelling::TestEntry);
    let unread = "`plan` names a file, relative to the folder of the test file";
    let (message, help) = message.split_once("\nhelp: ").unwrap_or((&message, unread));
    Ok(TestFileError::at(place, message).help(help))
}

impl Texts for Subject {
    fn fsm(&self) -> Fsm<'_> {
        self.machine().tables()
    }

    fn law(&self, atom: u32) -> &str {
        &self.machine().atom(atom).law().text
    }

    fn condition(&self, scope: u32) -> &str {
        self.machine().element(scope).condition_text()
    }

    fn name(&self, scope: u32) -> &str {
        self.machine().element(scope).name()
    }

    fn source(&self) -> &dyn Words {
        &self.words
    }

    fn paths(&self) -> &[&'static str] {
        &[]
    }
}

fn is_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.code.severity() == Severity::Error
}

/// Returns the plan file of a test file: the file that it names, or the file beside it.
fn plan_file(path: &Path, tests: &TestFile) -> PathBuf {
    match &tests.plan {
        Some(plan) => path.with_file_name("").join(plan.get_ref()),
        None => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            path.with_file_name(format!("{}.mdle", name.strip_suffix(super::file::ENDING).unwrap_or(&name)))
        }
    }
}

/// Returns the options of the `mdle.toml` beside the plan that apply to a test too.
fn run_options(settings: &Settings, target: Option<&str>) -> Result<Vec<String>, Failure> {
    const OF_TESTS: [&str; 8] =
        ["--world=", "--start=", "--body=", "--without=", "--battery=", "--period=", "--paths=", "--start-noise="];
    let options = settings.run_options(target, &[], |_| KnownSettings::default())?;
    let words = options.iter().flat_map(|option| &option.arguments).map(|word| word.to_string_lossy().into_owned());
    Ok(words.filter(|word| OF_TESTS.iter().any(|name| word.starts_with(name))).collect())
}

/// Returns the keyword of an operand that depends on more than the output of one turn; `None` for any other operand.
fn memory<I>(operand: &Condition<I>) -> Option<&'static str> {
    match operand {
        Condition::Null | Condition::Quark(_) | Condition::Or(..) | Condition::And(..) | Condition::Not(_) => None,
        Condition::Wait(_) => Some("wait"),
        Condition::Elapsed(..) => Some("t"),
        Condition::Driven(..) => Some("way"),
        Condition::Lasting(..) => Some("stuck"),
        Condition::Rising(..) => Some("RISING"),
        Condition::After(..) => Some("after"),
    }
}
