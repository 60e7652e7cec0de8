//! Compiles the text of a plan for the target `scripted`, and computes the traces of all machines.

use std::ops::Range;
use std::sync::LazyLock;

use mdle_compiler::Compiled;
use mdle_compiler::alphabet::{self, Alphabet};
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, has_errors, most_shown};
use mdle_compiler::fsm::{Machine, expand, lower};
use mdle_compiler::syntax::Loader;
use mdle_compiler::trace::{CountedRun, MatrixProduct, Script, TableMachine, TraceLine, TreeWalk, run};

/// Maximum number of states of a plan that is also run in its expanded form.
const EXPANDED: u64 = 2000;

/// Name of the only file that plans can use in these tests.
pub const LIBRARY_FILE: &str = "library.mdle";
/// Text of [`LIBRARY_FILE`].
pub const LIBRARY: &str =
    "{ Stroll (T: time) (b OR wait T) (Atom (a) seek) (drift, c, T) }\n{ Pause (Atom (wait 0.1) idle) }\n";

const SCRIPTED_FILE: &str = include_str!("../scripted/alphabet.mdle");

static SCRIPTED: LazyLock<Alphabet> = LazyLock::new(|| {
    let (file, found) = alphabet::read(Sources::default().add("", ""), SCRIPTED_FILE);
    assert_eq!(found, [], "the alphabet of `scripted`");
    let (alphabet, found) = alphabet::combine(file.expect("an alphabet"), &[]);
    assert_eq!(found, [], "the alphabet of `scripted`");
    alphabet
});

/// Returns the alphabet of the target `scripted`.
#[must_use]
pub fn scripted() -> &'static Alphabet {
    &SCRIPTED
}

/// Compiles the plan `Main` of a text.
///
/// # Errors
/// Returns the errors as text for a user.
pub fn compile(text: &str) -> Result<Compiled, String> {
    compile_plan(text, "Main")
}

/// Compiles the plan `name` of a text.
///
/// # Errors
/// Returns the errors as text for a user.
pub fn compile_plan(text: &str, name: &str) -> Result<Compiled, String> {
    let (sources, library, source) = placed(text);
    let mut library = Library(library);
    let (mut compiled, found) = mdle_compiler::compile_with(source, text, scripted(), Some(name), &mut library);
    assert_eq!(compiled.is_empty(), has_errors(&found), "a plan or an error:\n{text}");
    match compiled.pop() {
        Some(compiled) => Ok(compiled),
        None => Err(rendered(&sources, &found)),
    }
}

/// Returns the files of a plan for the target `scripted`, in the form in which [`compile`] uses them.
#[must_use]
pub fn sources(text: &str) -> Sources {
    placed(text).0
}

/// Returns the diagnostics of a text that are shown to a user, each with its byte range, except those in the library.
#[must_use]
pub fn diagnostics(text: &str) -> Vec<(Diagnostic, Range<usize>)> {
    let (sources, library, source) = placed(text);
    let found = mdle_compiler::check_with(source, text, scripted(), &mut Library(library));
    let most = most_shown(&found);
    let placed = found.into_iter().take(most).filter_map(|diagnostic| {
        let (file, range) = sources.range(diagnostic.span()?);
        (file == source).then_some((diagnostic, range))
    });
    placed.collect()
}

/// Returns the files, with the identifiers of the library and of the plan.
fn placed(text: &str) -> (Sources, SourceId, SourceId) {
    let mut sources = Sources::default();
    sources.add("alphabet.mdle", SCRIPTED_FILE);
    let library = sources.add(LIBRARY_FILE, LIBRARY);
    let plan = sources.add("plan.mdle", text);
    (sources, library, plan)
}

/// Loader that finds only [`LIBRARY`].
struct Library(SourceId);

impl Loader for Library {
    fn find(&mut self, _: SourceId, path: &str) -> Result<SourceId, String> {
        if path == LIBRARY_FILE { Ok(self.0) } else { Err(format!("there is no file `{path}`")) }
    }

    fn text(&self, _: SourceId) -> &'static str {
        LIBRARY
    }
}

fn rendered(sources: &Sources, found: &[Diagnostic]) -> String {
    found.iter().map(|diagnostic| sources.render(diagnostic)).collect()
}

/// A plan in the forms that the machines run.
#[derive(Debug)]
pub struct Machines<'c> {
    compiled: &'c Compiled,
    /// The plan's machine with expanded finite loops; `None` if it has too many states.
    expanded: Option<Machine>,
}

impl<'c> Machines<'c> {
    /// Returns the machines of a plan.
    #[must_use]
    pub fn new(compiled: &'c Compiled) -> Self {
        let expand = || lower(&expand(&compiled.nondegenerate)?);
        let is_small = compiled.machine.states() <= EXPANDED;
        Self { compiled, expanded: is_small.then(|| expand().expect("a small plan")) }
    }

    /// Returns the name and the trace of each machine.
    #[must_use]
    pub fn traces(&self, script: &Script) -> Vec<(&'static str, Vec<TraceLine<'_>>)> {
        let mut traces = vec![
            ("tree", run(TreeWalk::new(&self.compiled.plan), script).collect()),
            ("counted", run(CountedRun::new(&self.compiled.machine), script).collect()),
        ];
        if let Some(expanded) = &self.expanded {
            let plan = &self.compiled.nondegenerate;
            traces.extend([
                ("table", run(TableMachine::new(plan).expect("a small plan"), script).collect()),
                ("matrix", run(MatrixProduct::new(plan).expect("a small plan"), script).collect()),
                ("counted, expanded", run(CountedRun::new(expanded), script).collect()),
            ]);
        }
        traces
    }
}
