//! Combines a target's own alphabet with the shared alphabets that it uses into the complete alphabet of a robot.

use std::fmt;

use mdle_quantity::nearest;

use super::synonyms;
use super::{AlphabetFile, Capability, Declaration, DeclarationKind};
use crate::diagnostic::{Code, Diagnostic};

/// Complete alphabet of a robot. Plans for the robot are checked against it.
#[derive(Debug, Clone, PartialEq)]
pub struct Alphabet {
    /// Name of the target, or of the shared alphabet if there is no target.
    pub name: String,
    /// Rust crate that implements the target; empty if there is no target.
    pub crate_name: String,
    /// Period of a turn, in nanoseconds; `None` if the target does not declare it.
    pub period: Option<u64>,
    /// Capabilities of the robot.
    pub capabilities: Vec<Capability>,
    /// Capabilities that the robot has only if an engine runs its plan.
    pub engine: Vec<Capability>,
    /// `false` if the plan is compiled to an executable, which has no engine.
    pub has_engine: bool,
    /// Robots that messages may suggest, with their capabilities.
    pub robots: Vec<(String, Vec<Capability>)>,
    /// `true` if there is no target; the robot is then assumed to have every capability.
    everything: bool,
    declarations: Vec<Declaration>,
}

/// Combines a target's alphabet with those alphabets in `shared` that it uses. Returns the combined alphabet and the
/// diagnostics.
#[must_use]
pub fn combine(target: AlphabetFile, shared: &[AlphabetFile]) -> (Alphabet, Vec<Diagnostic>) {
    let mut found = Vec::new();
    let mut declarations = target.declarations;
    for (used, span) in &target.uses {
        let Some(file) = shared.iter().find(|file| file.name == *used) else {
            let names: Vec<_> = shared.iter().map(|file| file.name.as_str()).collect();
            let message = format!("there is no shared alphabet `{used}`");
            let report = Diagnostic::new(Code::E0601, message, *span, "not known");
            found.push(report.help(format!("the shared alphabets are {}", names.join(", "))));
            continue;
        };
        for declaration in &file.declarations {
            if !declarations.iter().any(|own| replaces(own, declaration)) {
                declarations.push(declaration.clone());
            }
        }
    }
    let head = target.target;
    let alphabet = Alphabet {
        name: target.name,
        crate_name: head.as_ref().map(|head| head.crate_name.clone()).unwrap_or_default(),
        period: head.as_ref().and_then(|head| head.period),
        engine: head.as_ref().map(|head| head.engine.clone()).unwrap_or_default(),
        has_engine: true,
        capabilities: head.map(|head| head.capabilities).unwrap_or_default(),
        robots: Vec::new(),
        everything: false,
        declarations: in_order(declarations, shared),
    };
    (alphabet, found)
}

impl Alphabet {
    /// Returns the alphabet that consists only of the shared file `file`, for a robot that has every capability.
    #[must_use]
    pub fn shared(file: AlphabetFile) -> Self {
        Self {
            name: file.name,
            crate_name: String::new(),
            period: None,
            capabilities: Vec::new(),
            engine: Vec::new(),
            has_engine: true,
            robots: Vec::new(),
            everything: true,
            declarations: file.declarations,
        }
    }

    /// Returns the capabilities of the robot; empty for a shared file, which is for a robot with every capability.
    #[must_use]
    pub fn capabilities(&self) -> &[Capability] {
        &self.capabilities
    }

    /// Returns the declarations of quarks and signals.
    pub fn declarations(&self) -> impl Iterator<Item = &Declaration> {
        self.declarations.iter()
    }

    /// Returns the declarations with this name, in the order in which overloads are numbered.
    pub fn declarations_of(&self, name: &str) -> impl Iterator<Item = &Declaration> {
        self.declarations.iter().filter(move |declaration| declaration.name == name)
    }

    /// Returns the names of all quarks and signals; a name with several declarations occurs several times.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.declarations.iter().map(|declaration| declaration.name.as_str())
    }

    /// Returns `true` if the robot has the capability `needed`, with at least the number of devices that `needed`
    /// demands.
    #[must_use]
    pub fn has(&self, needed: &Capability) -> bool {
        self.everything || is_among(needed, &self.capabilities) || self.has_engine && is_among(needed, &self.engine)
    }

    /// Returns `true` if the robot has the capability only if an engine runs its plan.
    #[must_use]
    pub fn needs_engine(&self, needed: &Capability) -> bool {
        !is_among(needed, &self.capabilities) && is_among(needed, &self.engine)
    }

    /// Returns the names of the robots that have all these capabilities.
    #[must_use]
    pub fn robots_with(&self, needed: &[Capability]) -> Vec<&str> {
        let can = |capabilities: &[Capability]| needed.iter().all(|needed| is_among(needed, capabilities));
        self.robots.iter().filter(|(_, own)| can(own)).map(|(name, _)| name.as_str()).collect()
    }

    /// Returns the name of the quark or signal that a user who typed `name` probably meant: a similar name, or a name
    /// that has `name` as a synonym. If `kind` is given, only declarations of this kind are considered.
    #[must_use]
    pub fn nearest(&self, name: &str, kind: Option<DeclarationKind>) -> Option<&str> {
        let names = || {
            let of_kind = self.declarations.iter().filter(|found| kind.is_none_or(|kind| found.kind == kind));
            of_kind.map(|declaration| declaration.name.as_str())
        };
        nearest(name, names()).or_else(|| synonyms::meant(name).find_map(|meant| names().find(|name| *name == meant)))
    }

    /// Returns the quarks of this kind that have `name` as a synonym; the most probable one comes first.
    pub fn synonyms(&self, name: &str, kind: DeclarationKind) -> impl Iterator<Item = &Declaration> {
        synonyms::meant(name).filter_map(move |meant| self.declarations_of(meant).find(|found| found.kind == kind))
    }

    /// Returns a hash that identifies the alphabet for which a target was built. It covers the target's name, crate,
    /// period and capabilities, and all declarations.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let text = format!("{} {} {:?} {:?}", self.name, self.crate_name, self.period, self.capabilities);
        let mut hasher = blake3::Hasher::new();
        hasher.update(text.as_bytes());
        if !self.engine.is_empty() {
            hasher.update(format!(" engine {:?}", self.engine).as_bytes());
        }
        for declaration in &self.declarations {
            hasher.update(declaration.to_string().as_bytes());
        }
        hasher.finalize().as_bytes().first_chunk().copied().map_or(0, u64::from_be_bytes)
    }
}

/// Returns `true` if `capabilities` contains the capability `needed`, with at least the number of devices that `needed`
/// demands.
fn is_among(needed: &Capability, capabilities: &[Capability]) -> bool {
    capabilities.iter().any(|own| own.name == needed.name && own.size >= needed.size)
}

/// Returns `true` if a target's own declaration replaces a shared one, because both have the same name and the same
/// kinds of arguments.
fn replaces(own: &Declaration, shared: &Declaration) -> bool {
    let kinds = |declaration: &Declaration| -> Vec<_> { declaration.params.iter().map(|param| param.kind).collect() };
    own.name == shared.name && kinds(own) == kinds(shared)
}

/// Sorts declarations in the order of the shared alphabets; a target's additions come last. The first declaration of a
/// name therefore remains the first one, even if the target replaces declarations.
fn in_order(mut declarations: Vec<Declaration>, shared: &[AlphabetFile]) -> Vec<Declaration> {
    let order: Vec<&Declaration> = shared.iter().flat_map(|file| &file.declarations).collect();
    let place = |found: &Declaration| order.iter().position(|shared| replaces(found, shared)).unwrap_or(order.len());
    declarations.sort_by_cached_key(place);
    declarations
}

impl fmt::Display for Capability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.size {
            Some(size) => write!(f, "{}[{size}]", self.name),
            None => f.write_str(&self.name),
        }
    }
}

/// Writes the canonical form of the declaration, without its documentation and its span, as input for the hash.
impl fmt::Display for Declaration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {}(", self.kind, self.name)?;
        for param in &self.params {
            let unit = param.unit.map(|unit| unit.name);
            write!(f, "{}: {:?} {unit:?} {:?} {:?}, ", param.name, param.kind, param.default, param.range)?;
            if let Some(except) = param.except {
                write!(f, "not {except:?}, ")?;
            }
            if !param.with.is_empty() {
                write!(f, "with {:?}, ", param.with)?;
            }
        }
        let unit = self.unit.map(|(unit, tolerance)| (unit.name, tolerance));
        let exclusive = if self.exclusive { " exclusive" } else { "" };
        write!(f, ") {unit:?} {} {}{exclusive} {:?}", self.completes, self.remembers, self.needs)
    }
}
