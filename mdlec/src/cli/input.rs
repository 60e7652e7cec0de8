//! Reads plans and alphabets, the input files of commands.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::{Failure, read, report};
use mdle_compiler::alphabet::{self, Alphabet, AlphabetFile, Capability, Declaration, DeclarationKind};
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, has_errors};
use mdle_compiler::plan::signature;
use mdle_compiler::{Compiled, builtin, check_with, compile_with, syntax};
use read::Unread;

/// The robot that plans are checked against.
pub(super) struct Target {
    /// Alphabet of the robot.
    pub(super) alphabet: Alphabet,
    /// Folder of a target that is not part of mdlec.
    pub(super) folder: Option<PathBuf>,
    /// The `mdle.toml` beside the plan, if there is one.
    pub(super) settings: Option<PathBuf>,
    /// Files from which the alphabet was read, so that messages can show them.
    sources: Vec<(String, String)>,
}

impl Target {
    /// Texts of the alphabet's files: the shared ones, then the target's own.
    pub(super) fn texts(&self) -> impl Iterator<Item = &str> {
        self.sources.iter().map(|(_, text)| text.as_str())
    }

    /// Files that were read for the target.
    pub(super) fn files(&self) -> impl Iterator<Item = PathBuf> {
        let own =
            self.folder.iter().flat_map(|folder| ["alphabet.mdle", "src/alphabet.rs"].map(|file| folder.join(file)));
        own.chain(self.settings.clone())
    }
}

/// A plan file, together with the alphabet's files and the files that it uses.
pub(super) struct Input {
    pub(super) sources: Sources,
    pub(super) source: SourceId,
    /// Paths of the plan file and of the files that it uses.
    paths: BTreeMap<SourceId, PathBuf>,
    /// Files that were read, by their canonical paths.
    read: BTreeMap<PathBuf, SourceId>,
}

impl Input {
    /// Compiles the plans of the file, or only its plan `wanted`.
    pub(super) fn compile(&mut self, alphabet: &Alphabet, wanted: Option<&str>) -> (Vec<Compiled>, Vec<Diagnostic>) {
        let text = self.sources.text(self.source).to_owned();
        compile_with(self.source, &text, alphabet, wanted, self)
    }

    /// Returns the diagnostics of the file.
    pub(super) fn check(&mut self, alphabet: &Alphabet) -> Vec<Diagnostic> {
        let text = self.sources.text(self.source).to_owned();
        check_with(self.source, &text, alphabet, self)
    }

    /// Files that were read for the plan, its own first.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        self.paths.values().map(PathBuf::as_path)
    }

    /// Texts of the files that were read for the plan, its own first.
    pub(super) fn texts(&self) -> impl Iterator<Item = &str> {
        self.paths.keys().map(|source| self.sources.text(*source))
    }

    /// Files that were read for the plan and for `target`, which no output may overwrite.
    pub(super) fn inputs(&self, target: &Target) -> Vec<PathBuf> {
        let named = |path: &Path| if path == Path::new("-") { PathBuf::from("/dev/stdin") } else { path.to_owned() };
        self.files().map(named).chain(target.files()).collect()
    }

    /// Names of the plans in the file and in the files that it uses.
    pub(super) fn plan_names(&mut self) -> Vec<String> {
        let (arena, text) = (syntax::Arena::new(), self.sources.text(self.source).to_owned());
        let (files, _) = syntax::parse_with(self.source, &text, &arena, self);
        files.plans.iter().map(|plan| plan.name.node.to_owned()).collect()
    }
}

impl syntax::Loader for Input {
    fn find(&mut self, from: SourceId, path: &str) -> Result<SourceId, String> {
        let folder = self.paths.get(&from).and_then(|path| path.parent()).unwrap_or(Path::new(""));
        let file = folder.join(path);
        let name = file.display().to_string();
        let refused = |why: Unread| match why.is_missing() {
            true => format!(
                "there is no file `{name}`{}",
                like(&file).map_or_else(String::new, |like| format!("; did you mean `{like}`?"))
            ),
            false => why.of(&name),
        };
        let place = file.canonicalize().map_err(|error| refused(Unread::System(error)))?;
        if let Some(source) = self.read.get(&place) {
            return Ok(*source);
        }
        let bytes = read::file(&place, read::LARGEST_PLAN).map_err(refused)?;
        if let Some(refusal) = self.sources.refusal(&name, bytes.len()) {
            return Err(refusal);
        }
        let text = String::from_utf8(without_mark(bytes)).map_err(|_| format!("`{name}` is not UTF-8 text"))?;
        let source = self.sources.add(name, text);
        self.paths.insert(source, file);
        self.read.insert(place, source);
        Ok(source)
    }

    fn text(&self, source: SourceId) -> &str {
        self.sources.text(source)
    }
}

/// Removes a byte order mark, which editors write and which is not part of a plan.
pub(super) fn without_mark(bytes: Vec<u8>) -> Vec<u8> {
    bytes.strip_prefix(b"\xEF\xBB\xBF").map(<[u8]>::to_vec).unwrap_or(bytes)
}

/// Reads the target that an option names; without an option a robot with every capability.
pub(super) fn target(option: Option<&str>) -> Result<Target, Failure> {
    let Some(name) = option else { return read_alphabets(None, "") };
    if let Some(builtin) = builtin::alphabets().iter().find(|alphabet| alphabet.target && alphabet.name == name) {
        return read_alphabets(Some((builtin.file.to_owned(), builtin.text.to_owned())), name);
    }
    let folder = Path::new(name);
    if !folder.is_dir() {
        return Err(unknown_target(name));
    }
    let file = folder.join("alphabet.mdle");
    let text = read_text(&file, read::LARGEST_PLAN)?;
    let mut target = read_alphabets(Some((file.display().to_string(), text)), name)?;
    target.folder = Some(folder.to_owned());
    Ok(target)
}

/// Reads the alphabet in this file, with the shared ones that it uses.
pub(super) fn alphabet(file: &Path) -> Result<Alphabet, Failure> {
    let name = file.display().to_string();
    let text = read_text(file, read::LARGEST_PLAN)?;
    read_alphabets(Some((name.clone(), text)), &name).map(|target| target.alphabet)
}

/// Reads a plan file; `-` is standard input.
pub(super) fn read_plan(path: &Path, target: &Target) -> Result<Input, Failure> {
    plan(path, read_text(path, read::LARGEST_PLAN)?, target)
}

/// Makes the input of a plan file whose text was read.
pub(super) fn plan(path: &Path, text: String, target: &Target) -> Result<Input, Failure> {
    let mut sources = Sources::default();
    for (name, text) in &target.sources {
        sources.add(name, text);
    }
    let source = add(&mut sources, path, text)?;
    let paths = BTreeMap::from([(source, path.to_owned())]);
    let read = path.canonicalize().map(|place| (place, source)).into_iter().collect();
    Ok(Input { sources, source, paths, read })
}

/// Adds the text of a plan file.
pub(super) fn add(sources: &mut Sources, path: &Path, text: String) -> Result<SourceId, Failure> {
    let name = shown(path);
    match sources.refusal(&name, text.len()) {
        Some(refusal) => Err(Failure::usage(refusal)),
        None => Ok(sources.add(name, text)),
    }
}

/// Name of a file in messages.
fn shown(path: &Path) -> String {
    if path == Path::new("-") { "standard input".into() } else { path.display().to_string() }
}

/// Reads a text file of at most `most` bytes, or standard input for `-`.
pub(super) fn read_text(path: &Path, most: u64) -> Result<String, Failure> {
    let name = shown(path);
    let is_input = path == Path::new("-");
    let bytes = if is_input { read::standard_input(most) } else { read::file(path, most) };
    let bytes = bytes.map_err(|why| {
        Failure::usage(if why.is_missing() {
            format!("there is no file `{name}`{}", plan_nearby(path))
        } else {
            why.of(&name) + why.help()
        })
    })?;
    String::from_utf8(without_mark(bytes)).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let (sources, found) = report::not_utf8(&name, error.as_bytes(), valid);
        report::diagnostics(&sources, &[found], false);
        Failure::PLAN
    })
}

/// Prints the list of `mdlec targets`.
pub(super) fn print_targets() -> Result<(), Failure> {
    let mut text = String::new();
    for builtin in builtin::alphabets().iter().filter(|alphabet| alphabet.target) {
        let target = target(Some(builtin.name))?;
        let capabilities: Vec<_> = target.alphabet.capabilities.iter().map(ToString::to_string).collect();
        text += &format!("{}: {}\n", builtin.name, capabilities.join(", "));
    }
    report::print(&text)
}

/// Maximum width of the column of signatures in characters; longer signatures exceed the column.
const WIDEST: usize = 100;

/// Prints the list of `mdlec quarks`.
pub(super) fn print_quarks(option: Option<&str>) -> Result<(), Failure> {
    let target = target(option)?;
    let widths = target.alphabet.declarations().map(|declaration| signature(declaration).chars().count());
    let width = widths.filter(|width| *width <= WIDEST).max().unwrap_or(0);
    let mut text = String::new();
    for (kind, title) in [
        (DeclarationKind::Interrupt, "interrupts"),
        (DeclarationKind::Control, "laws"),
        (DeclarationKind::Signal, "signals"),
    ] {
        text += &format!("{title}\n");
        let of_kind = target.alphabet.declarations().filter(|declaration| declaration.kind == kind);
        of_kind.for_each(|declaration| text += &line(declaration, &target.alphabet, width));
    }
    report::print(&text)
}

fn line(declaration: &Declaration, alphabet: &Alphabet, width: usize) -> String {
    let missing: Vec<_> =
        declaration.needs.iter().filter(|need| !alphabet.has(need)).map(ToString::to_string).collect();
    let missing = match missing.as_slice() {
        [] => String::new(),
        missing => format!(" (not on {}: it has no {})", alphabet.name, missing.join(", ")),
    };
    let exclusive =
        if declaration.exclusive { " Exclusive: fires for one value of its arguments at a time." } else { "" };
    format!("  {:width$}  {}{exclusive}{missing}\n", signature(declaration), declaration.docs)
}

fn read_alphabets(own: Option<(String, String)>, name: &str) -> Result<Target, Failure> {
    let mut reading = Reading::default();
    let mut shared = Vec::new();
    for alphabet in builtin::alphabets().iter().filter(|alphabet| !alphabet.target) {
        shared.extend(reading.read(alphabet.file.to_owned(), alphabet.text.to_owned()));
    }
    let alphabet = match own {
        Some((file, text)) => reading.read(file, text).map(|file| {
            let (mut alphabet, found) = alphabet::combine(file, &shared);
            reading.found.extend(found);
            alphabet.robots = robots();
            alphabet
        }),
        None => shared.into_iter().next().map(Alphabet::shared),
    };
    report::diagnostics(&reading.sources, &reading.found, false);
    match alphabet {
        Some(alphabet) if !has_errors(&reading.found) => {
            Ok(Target { alphabet, folder: None, settings: None, sources: reading.files })
        }
        Some(_) | None => Err(Failure::usage(format!("the alphabet of target `{name}` has errors"))),
    }
}

/// Robots that are part of mdlec, each with its capabilities.
fn robots() -> Vec<(String, Vec<Capability>)> {
    let targets = builtin::alphabets().iter().filter(|alphabet| alphabet.target);
    let head = |builtin: &builtin::Alphabet| {
        let (file, _) = alphabet::read(Sources::default().add(builtin.file, builtin.text), builtin.text);
        Some((builtin.name.to_owned(), file?.target?.capabilities))
    };
    targets.filter_map(head).collect()
}

/// Alphabet files that are read one after the other.
#[derive(Default)]
struct Reading {
    sources: Sources,
    files: Vec<(String, String)>,
    found: Vec<Diagnostic>,
}

impl Reading {
    fn read(&mut self, file: String, text: String) -> Option<AlphabetFile> {
        let source = self.sources.add(&file, &text);
        let (alphabet, found) = alphabet::read(source, &text);
        self.found.extend(found);
        self.files.push((file, text));
        alphabet
    }
}

fn unknown_target(name: &str) -> Failure {
    let known: Vec<_> = builtin::alphabets().iter().filter(|found| found.target).map(|found| found.name).collect();
    if name.contains('/') {
        return Failure::usage(format!(
            "there is no folder `{name}`\nhelp: the built-in targets are {}",
            known.join(", ")
        ));
    }
    Failure::usage(format!(
        "there is no target `{name}`{}\nhelp: the targets are {}; a target of your own is named by its folder, \
         as in `{}`",
        did_you_mean(name, &known),
        known.join(", "),
        report::option("target", "../rover")
    ))
}

/// End of a sentence about an unknown name: the similar name, if there is one.
pub(super) fn did_you_mean(name: &str, known: &[&str]) -> String {
    let near = alphabet::nearest(name, known.iter().copied());
    near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default()
}

/// Name of the plan file next to `path` that was probably meant: one that differs in upper or lower case or in the
/// extension, or else in few letters.
fn like(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.to_lowercase();
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let files: BTreeSet<String> = files.collect();
    let same = files.iter().find(|file| [name.clone(), format!("{name}.mdle")].contains(&file.to_lowercase()));
    let plans = || files.iter().map(String::as_str).filter(|file| file.ends_with(".mdle"));
    same.map(String::as_str).or_else(|| alphabet::nearest(&name, plans())).map(str::to_owned)
}

/// Hint for a path without the extension `.mdle`.
fn plan_nearby(path: &Path) -> String {
    let with_ending = path.with_extension("mdle");
    if with_ending.is_file() { format!("\nhelp: there is `{}`", with_ending.display()) } else { String::new() }
}
