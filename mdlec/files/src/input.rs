//! Reads plan files, together with the files that they use.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use mdle_compiler::alphabet::{Alphabet, nearest};
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources};
use mdle_compiler::plan::Bounds;
use mdle_compiler::projection::{RobotPlan, part_name, projected};
use mdle_compiler::rust::{self, Header};
use mdle_compiler::syntax::tree::{Arg, Plan};
use mdle_compiler::{Compiled, Limit, check_with, compile_bounded, compile_within, roots, syntax};

use crate::read::Unread;
use crate::text::{read_text, shown, without_mark};
use crate::{InputError, Target, Unsaved, read, unsaved};

/// A plan file, with the files that it uses and the files of the alphabet.
#[derive(Debug)]
pub struct Input {
    /// The texts of all these files, for messages.
    pub sources: Sources,
    /// Identifier of the plan file among the sources.
    pub source: SourceId,
    /// Paths of the plan file and of the files that it uses.
    paths: BTreeMap<SourceId, PathBuf>,
    /// Files that were read, by their canonical paths.
    read: BTreeMap<PathBuf, SourceId>,
    /// Texts that are used instead of files.
    unsaved: Unsaved,
    /// Plans of single robots, which the last compilation has derived from the plans of groups.
    parts: Vec<RobotPlan>,
    /// `true` if the files that the plan uses must not be read.
    is_alone: bool,
}

/// A group of robots: the name of its plan, and its robots in order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RobotGroup {
    /// Name of the plan of the whole group of robots, from which the plan of each robot is derived.
    pub name: String,
    /// Names of the robots.
    pub robots: Vec<String>,
}

impl RobotGroup {
    /// Returns the name of the plan of `robot`, or `None` if the group has no such robot.
    #[must_use]
    pub fn plan_of(&self, robot: &str) -> Option<String> {
        self.robots.iter().any(|known| known == robot).then(|| part_name(&self.name, robot))
    }
}

impl Input {
    /// Uses these texts instead of the files at their paths.
    #[must_use]
    pub fn with_unsaved(mut self, unsaved: Unsaved) -> Self {
        let own = self.path(self.source).and_then(|path| unsaved.place(path).ok());
        self.read.extend(own.map(|place| (place, self.source)));
        Self { unsaved, ..self }
    }

    /// Returns the path of a file that was read for the plan.
    #[must_use]
    pub fn path(&self, source: SourceId) -> Option<&Path> {
        self.paths.get(&source).map(PathBuf::as_path)
    }

    /// Returns an input that does not read the files that the plan uses, for a plan from an untrusted author.
    #[must_use]
    pub fn alone(self) -> Self {
        Self { is_alone: true, ..self }
    }

    /// Compiles the plans of the file, or only the plan `wanted`.
    pub fn compile(&mut self, alphabet: &Alphabet, wanted: Option<&str>) -> (Vec<Compiled>, Vec<Diagnostic>) {
        self.compile_within(alphabet, wanted, |_| Ok(()))
    }

    /// Compiles like [`Input::compile`], and reports an error for a plan that exceeds the limit.
    pub fn compile_within(
        &mut self,
        alphabet: &Alphabet,
        wanted: Option<&str>,
        limit: Limit,
    ) -> (Vec<Compiled>, Vec<Diagnostic>) {
        let text = self.sources.text(self.source).to_owned();
        let compiled = compile_within(self.source, &text, alphabet, wanted, self, limit);
        self.parts = compiled.0.iter().filter_map(|compiled| compiled.part.clone()).collect();
        compiled
    }

    /// Compiles like [`Input::compile`], and reports an error for a plan that exceeds the bounds before the plan is
    /// built.
    pub fn compile_bounded(&mut self, alphabet: &Alphabet, bounds: Bounds) -> (Vec<Compiled>, Vec<Diagnostic>) {
        let text = self.sources.text(self.source).to_owned();
        let compiled = compile_bounded(self.source, &text, alphabet, self, bounds);
        self.parts = compiled.0.iter().filter_map(|compiled| compiled.part.clone()).collect();
        compiled
    }

    /// Returns the names of the plans that [`Input::compile`] compiles, without compiling them.
    pub fn roots(&mut self, alphabet: &Alphabet) -> Vec<String> {
        let text = self.sources.text(self.source).to_owned();
        roots(self.source, &text, alphabet, self)
    }

    /// Returns, as MDLe text, the plans of all robots in the groups of the file, or only the plan `wanted`. The text is
    /// empty if the file has no group.
    pub fn projected(&mut self, alphabet: &Alphabet, wanted: Option<&str>) -> String {
        let text = self.sources.text(self.source).to_owned();
        projected(self.source, &text, alphabet, wanted, self)
    }

    /// Returns the group whose plan is called `wanted`. If `wanted` is `None`, returns the group of the file's only
    /// plan. Returns `None` if there is no such plan, or if it is not the plan of a group.
    pub fn group(&mut self, wanted: Option<&str>) -> Option<RobotGroup> {
        let (arena, text) = (syntax::Arena::new(), self.sources.text(self.source).to_owned());
        let (files, _) = syntax::parse_with(self.source, &text, &arena, self);
        let own = files.plans.get(..files.own).unwrap_or(&[]);
        let plan = match (wanted, own) {
            (Some(wanted), _) => files.plans.iter().find(|plan| plan.name.node == wanted && plan.group.is_some()),
            (None, [only]) => Some(only),
            (None, _) => None,
        }?;
        Some(RobotGroup { name: plan.name.node.to_owned(), robots: robots(plan)? })
    }

    /// Returns the diagnostics of the file.
    pub fn check(&mut self, alphabet: &Alphabet) -> Vec<Diagnostic> {
        let text = self.sources.text(self.source).to_owned();
        check_with(self.source, &text, alphabet, self)
    }

    /// Returns the paths of the files that were read for the plan, its own file first.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.paths.values().map(PathBuf::as_path)
    }

    /// Returns the texts of the files that were read for the plan, its own file first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.paths.keys().map(|source| self.sources.text(*source))
    }

    /// Returns the paths of the files that were read for the plan and for `target`, none of which an output may
    /// overwrite.
    pub fn inputs(&self, target: &Target) -> Vec<PathBuf> {
        let named = |path: &Path| if path == Path::new("-") { PathBuf::from("/dev/stdin") } else { path.to_owned() };
        self.files().map(named).chain(target.files()).collect()
    }

    /// Returns the names of the plans in the file and in the files that it uses. For a group, returns the name of each
    /// robot's plan.
    pub fn plan_names(&mut self) -> Vec<String> {
        let (arena, text) = (syntax::Arena::new(), self.sources.text(self.source).to_owned());
        let (files, _) = syntax::parse_with(self.source, &text, &arena, self);
        let names = files.plans.iter().flat_map(|plan| match robots(plan) {
            Some(robots) => robots.iter().map(|robot| part_name(plan.name.node, robot)).collect(),
            None => vec![plan.name.node.to_owned()],
        });
        names.collect()
    }

    /// Returns the labels of the plans in the file and in the files that it uses, such as `Γ_from^to`, each
    /// with the name of its plan.
    pub fn labels(&mut self) -> Vec<(String, String)> {
        let (arena, text) = (syntax::Arena::new(), self.sources.text(self.source).to_owned());
        let (files, _) = syntax::parse_with(self.source, &text, &arena, self);
        let named =
            |plan: &syntax::tree::Plan<'_>| Some((plan.label.as_ref()?.node.to_owned(), plan.name.node.to_owned()));
        files.plans.iter().filter_map(named).collect()
    }

    /// Returns `true` if the plan `name`, in the file or in a file that it uses, takes parameters.
    pub fn takes_parameters(&mut self, name: &str) -> bool {
        let (arena, text) = (syntax::Arena::new(), self.sources.text(self.source).to_owned());
        let (files, _) = syntax::parse_with(self.source, &text, &arena, self);
        files.plans.iter().any(|plan| plan.name.node == name && !plan.params.is_empty())
    }

    /// Checks that the file, or a file that it uses, contains a plan with this name.
    ///
    /// # Errors
    /// Fails if there are plans, but none of them has this name.
    pub fn must_have(&mut self, name: &str) -> Result<(), InputError> {
        let plans = self.plan_names();
        if plans.is_empty() || plans.iter().any(|plan| plan == name) {
            return Ok(());
        }
        let file = self.sources.name(self.source).to_owned();
        Err(InputError::UnknownPlan { file, name: name.to_owned(), plans })
    }

    /// Returns the only result in `plans`, which contains the results of [`compile`](Self::compile) with the names of
    /// the plans.
    ///
    /// # Errors
    /// Fails if `plans` is empty or has several plans.
    pub fn only<T>(&self, mut plans: Vec<(String, T)>) -> Result<T, InputError> {
        match (plans.pop(), plans.len()) {
            (Some((_, only)), 0) => Ok(only),
            (last, _) => {
                let plans: Vec<_> = plans.into_iter().chain(last).map(|(name, _)| name).collect();
                let file = self.sources.name(self.source).to_owned();
                let is_part = |name: &String| self.parts.iter().any(|part| part.plan == *name);
                Err(match !plans.is_empty() && plans.iter().all(is_part) {
                    true => InputError::Group { file, plans },
                    false => InputError::NotOnePlan { file, plans },
                })
            }
        }
    }

    /// Converts a plan of the file to Rust code for the crate of `target`.
    ///
    /// # Errors
    /// Fails with E0501 for a plan that is too large.
    pub fn rust(&self, compiled: &Compiled, target: &Target) -> Result<String, Diagnostic> {
        rust::fits(&compiled.nondegenerate)?;
        let file = self.paths.get(&self.source).and_then(|path| path.file_name()).unwrap_or_default();
        let header = Header { sources: &self.sources, file: &file.to_string_lossy(), plan: &compiled.plan.root.name };
        Ok(rust::emit(&compiled.machine, header, &target.alphabet))
    }
}

impl syntax::Loader for Input {
    fn find(&mut self, from: SourceId, path: &str) -> Result<SourceId, String> {
        if self.is_alone {
            return Err(format!("the plan comes without other files, so `{path}` is not read"));
        }
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
        let place = self.unsaved.place(&file).map_err(|error| refused(Unread::System(error)))?;
        if let Some(source) = self.read.get(&place) {
            return Ok(*source);
        }
        let bytes = match self.unsaved.text(&place) {
            Some(text) => text.as_bytes().to_vec(),
            None => read::file(&place, read::LARGEST_PLAN).map_err(refused)?,
        };
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

/// Reads a plan file; `-` is standard input.
///
/// # Errors
/// Fails if the file cannot be read or is not text.
pub fn read_plan(path: &Path, target: &Target) -> Result<Input, InputError> {
    plan(path, read_text(path, read::LARGEST_PLAN)?, target)
}

/// Returns the input for the plan file at `path`, whose text has already been read.
///
/// # Errors
/// Fails if the text is too long.
pub fn plan(path: &Path, text: String, target: &Target) -> Result<Input, InputError> {
    let mut sources = target.sources();
    let source = add(&mut sources, path, text)?;
    let paths = BTreeMap::from([(source, path.to_owned())]);
    let read = unsaved::place(path).map(|place| (place, source)).into_iter().collect();
    Ok(Input { sources, source, paths, read, unsaved: Unsaved::default(), parts: Vec::new(), is_alone: false })
}

/// Returns the names of the robots of a group's plan; `None` for the plan of a single robot.
fn robots(plan: &Plan<'_>) -> Option<Vec<String>> {
    let names = plan.group?.iter().filter_map(|robot| match robot {
        Arg::Name(name) => Some(name.node.to_owned()),
        Arg::Number(_) | Arg::Infinity(_) | Arg::String(_) | Arg::Module(_) => None,
    });
    Some(names.collect())
}

/// Adds the text of a plan file.
///
/// # Errors
/// Fails if the text is too long.
pub fn add(sources: &mut Sources, path: &Path, text: String) -> Result<SourceId, InputError> {
    let name = shown(path);
    match sources.refusal(&name, text.len()) {
        Some(refusal) => Err(InputError::Unusable(refusal)),
        None => Ok(sources.add(name, text)),
    }
}

/// Returns the name of the plan file in the folder of `path` that the user probably meant. This is a name that differs
/// only in case or in the extension. If there is none, it is a name that differs only in a few letters.
fn like(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.to_lowercase();
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let files: BTreeSet<String> = files.collect();
    let same = files.iter().find(|file| [name.clone(), format!("{name}.mdle")].contains(&file.to_lowercase()));
    let plans = || files.iter().map(String::as_str).filter(|file| file.ends_with(".mdle"));
    same.map(String::as_str).or_else(|| nearest(&name, plans())).map(str::to_owned)
}
