//! Resolves quarks by name. Chooses the declaration for a call, checks that the robot has the quark, and assigns the
//! same id to equal calls.

use std::collections::BTreeMap;

use super::arguments::{Arguments, complaints, fit, kind_words, signature, written};
use super::moves;
use super::parameters::DefinitionNames;
use super::{Quark, QuarkId, Value};
use crate::alphabet::{Alphabet, Declaration, DeclarationKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::Call;

/// The quarks that have been resolved so far.
#[derive(Debug)]
pub(super) struct ResolvedQuarks<'a> {
    alphabet: &'a Alphabet,
    met: Vec<Quark>,
    ids: BTreeMap<Quark, QuarkId>,
}

impl<'a> ResolvedQuarks<'a> {
    pub(super) fn new(alphabet: &'a Alphabet) -> Self {
        Self { alphabet, met: Vec::new(), ids: BTreeMap::new() }
    }

    pub(super) fn alphabet(&self) -> &'a Alphabet {
        self.alphabet
    }

    pub(super) fn get(&self, id: QuarkId) -> Option<&Quark> {
        self.met.get(id.0 as usize)
    }

    pub(super) fn into_vec(self) -> Vec<Quark> {
        self.met
    }

    /// Resolves `call` as a quark of this kind.
    pub(super) fn resolve(
        &mut self,
        call: &Call,
        kind: DeclarationKind,
        names: DefinitionNames<'_, '_>,
    ) -> Result<QuarkId, Vec<Diagnostic>> {
        let name = call.name;
        let declarations: Vec<&Declaration> = self.alphabet.declarations_of(name).collect();
        let of_kind = declarations.iter().copied().enumerate().filter(|(_, declaration)| declaration.kind == kind);
        let mut candidates: Vec<_> = of_kind.collect();
        if candidates.is_empty() {
            return Err(vec![match declarations.first() {
                Some(other) => wrong_kind(call, other.kind, kind),
                None => self.unknown(call, kind, names.plans),
            }]);
        }
        // Declarations of one name differ in the kinds of their arguments. If none fits, the errors are those for the
        // declaration with the fewest errors.
        candidates.sort_by_key(|(_, declaration)| complaints(call, declaration, names.parameters));
        let mut wrong = None;
        for (overload, declaration) in candidates {
            let fitted = fit(call, declaration, &self.alphabet.name, names.parameters);
            match fitted.and_then(|arguments| self.available(call, declaration).map(|()| arguments)) {
                Ok(arguments) => return Ok(self.intern(declaration, overload, arguments)),
                Err(found) => wrong = wrong.or(Some((declaration, found))),
            }
        }
        let Some((declaration, found)) = wrong else { return Err(Vec::new()) };
        let declared = |found: Diagnostic| found.also(declaration.span, format!("`{name}` is declared here"));
        Err(found.into_iter().map(declared).collect())
    }

    fn intern(&mut self, declaration: &Declaration, overload: usize, arguments: Arguments) -> QuarkId {
        // As in the paper, the range of a sonar is written as one word, such as `r3`.
        let is_indexed =
            declaration.kind == DeclarationKind::Signal && matches!(arguments.values[..], [Value::Sonar(_)]);
        let blank = if is_indexed { "" } else { " " };
        let text = [declaration.name.clone()].into_iter().chain(arguments.words).collect::<Vec<_>>().join(blank);
        self.add(Quark {
            name: declaration.name.clone(),
            overload,
            args: arguments.values,
            completes: declaration.completes,
            remembers: declaration.remembers,
            exclusive: declaration.exclusive,
            comparison: None,
            text,
        })
    }

    /// Returns the id of a quark. If the quark is new, adds it.
    pub(super) fn add(&mut self, quark: Quark) -> QuarkId {
        if let Some(id) = self.ids.get(&quark) {
            return *id;
        }
        let id = QuarkId(u32::try_from(self.met.len()).unwrap_or(u32::MAX));
        self.met.push(quark.clone());
        self.ids.insert(quark, id);
        id
    }

    /// Checks that the robot has the capabilities that the quark needs.
    fn available(&self, call: &Call, declaration: &Declaration) -> Result<(), Vec<Diagnostic>> {
        let missing = declaration.needs.iter().filter(|capability| !self.alphabet.has(capability));
        let missing: Vec<String> = missing.map(|capability| format!("`{capability}`")).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let quark = &declaration.name;
        let needs_engine = |capability| self.alphabet.has(capability) || self.alphabet.needs_engine(capability);
        if declaration.needs.iter().all(needs_engine) {
            let is_link = declaration.needs.iter().any(|capability| capability.name == "state_link");
            let what = if is_link { "needs the state link" } else { "reads modules" };
            let message = format!("`{quark}` {what}, and an executable has none");
            let report = Diagnostic::new(Code::E0403, message, call.span, "needs an engine");
            return Err(vec![
                report.help(
                    "`mdle run PLAN --target TARGET` runs such plans, and with `--engine` mdlec builds an executable that does; \
                     `mdle run --help` lists the targets",
                ),
            ]);
        }
        let missing = missing.join(" and ");
        let robot = &self.alphabet.name;
        let verb = match declaration.kind {
            DeclarationKind::Control => "run",
            DeclarationKind::Interrupt => "detect",
            DeclarationKind::Signal => "measure",
        };
        let message = format!("`{robot}` cannot {verb} `{quark}`: it has no {missing}");
        let report = Diagnostic::new(Code::E0401, message, call.span, format!("needs {missing}"));
        let robots = self.alphabet.robots_with(&declaration.needs);
        Err(vec![match robots.as_slice() {
            [] if self.alphabet.robots.is_empty() => report.help("`mdlec targets` lists the robots and what each has"),
            [] => report.help(format!(
                "no robot that comes with mdlec has {missing}; without `--target`, `mdlec check` assumes one that has everything"
            )),
            robots => report.help(format!("robots that have {missing}: {}", robots.join(", "))),
        }])
    }

    fn unknown(&self, call: &Call, kind: DeclarationKind, plans: &[&str]) -> Diagnostic {
        let name = call.name;
        let what = match kind {
            DeclarationKind::Control => "law",
            DeclarationKind::Interrupt => "interrupt",
            DeclarationKind::Signal => "signal",
        };
        if plans.contains(&name) {
            let message = format!("`{name}` is a plan, but {} is expected here", kind_words(kind));
            let report = Diagnostic::new(Code::E0204, message, call.name_span(), "a plan");
            return match kind {
                DeclarationKind::Control => report.help(format!("a plan is an element by itself, without `Atom`: `{name}`")),
                DeclarationKind::Interrupt | DeclarationKind::Signal => report.help(
                    "parentheses after a plan's own name are its condition; write `(null)` before them if they are a string",
                ),
            };
        }
        let message = format!("there is no {what} called `{name}`");
        let report = Diagnostic::new(Code::E0201, message, call.name_span(), "not in the alphabet");
        if matches!(name, "any" | "all" | "formation") {
            return report.help(format!("only a group has `{name}`: `{{ Group [robot1 robot2] Name … }}`"));
        }
        if matches!(name, "true" | "false" | "True" | "False") {
            return report
                .help("an interrupt is true or false by itself: `bumper` or `NOT bumper`; `null` is never true");
        }
        if matches!(name, "pi" | "PI" | "Pi" | "π") {
            return report.fix("there are no constants; for an angle write {}", call.name_span(), "180deg");
        }
        if let Some(law) = moves::meant(call).filter(|_| kind == DeclarationKind::Control) {
            let is_known = self.alphabet.declarations_of(law.name).next().is_some();
            if is_known {
                return report.fix(law.words, call.span, law.call);
            }
        }
        match self.alphabet.nearest(name, Some(kind)).and_then(|near| self.alphabet.declarations_of(near).next()) {
            Some(near) => {
                let words = format!("did you mean `{}`?", signature(near));
                let report = report.fix(&words, call.name_span(), near.name.as_str());
                let others = self.alphabet.synonyms(name, kind).filter(|other| other.name != near.name);
                others.fold(report, |report, other| report.help(format!("or `{}`? {}", signature(other), other.docs)))
            }
            None => report.help(format!("these are known: {}", self.known(kind))),
        }
    }

    fn known(&self, kind: DeclarationKind) -> String {
        let mut known: Vec<&str> = self
            .alphabet
            .names()
            .filter(|name| self.alphabet.declarations_of(name).any(|declaration| declaration.kind == kind))
            .collect();
        known.sort_unstable();
        known.dedup();
        known.join(", ")
    }
}

fn wrong_kind(call: &Call, found: DeclarationKind, expected: DeclarationKind) -> Diagnostic {
    let (name, written) = (call.name, written(call));
    let message = format!("`{name}` is {}, but {} is expected here", kind_words(found), kind_words(expected));
    let report = Diagnostic::new(Code::E0204, message, call.name_span(), kind_words(found));
    match (found, expected) {
        (DeclarationKind::Control, DeclarationKind::Interrupt) => report.help(format!(
            "an atom is `(Atom (interrupt) law)`: the law comes last, as in `(Atom (wait 10) {written})`"
        )),
        (DeclarationKind::Interrupt, DeclarationKind::Control) => report.help(format!(
            "an atom is `(Atom (interrupt) law)`: write `(Atom ({written}) stop)` to wait for it at rest"
        )),
        (DeclarationKind::Signal, DeclarationKind::Interrupt) => {
            report.fix("compare it with a value: {}", call.span, format!("{written} < 1"))
        }
        (DeclarationKind::Interrupt, DeclarationKind::Signal) => {
            report.help(format!("an interrupt is not compared: write `{written}` or `NOT {written}` alone"))
        }
        (DeclarationKind::Signal | DeclarationKind::Control | DeclarationKind::Interrupt, _) => report,
    }
}
