//! Answers requests for the commands of `mdlec`, with the same bytes as the output of these commands.

use mdle_compiler::Compiled;
use mdle_compiler::alphabet::{Declaration, DeclarationKind};
use mdle_compiler::analysis::analyze as analysis;
use mdle_compiler::diagnostic::{Code, Diagnostic};
use mdle_compiler::picture;
use mdle_compiler::plan::signature;
use mdle_compiler::syntax;
use mdle_compiler::trace::{CountedRun, Script, run};
use serde_json::{Value, json};

use crate::document::Document;
use crate::robot::robot;

/// Maximum size of a trace, in bytes.
const TRACE_MOST: usize = 64 << 20;

fn output(text: impl Into<String>) -> Value {
    json!({ "output": text.into() })
}

/// Returns the messages as JSON, one per line.
pub(crate) fn check(document: &mut Document<'_>) -> Value {
    let found = document.check();
    output(messages(document, &found))
}

fn messages(document: &Document<'_>, found: &[Diagnostic]) -> String {
    found.iter().map(|diagnostic| document.sources.message(diagnostic).to_json() + "\n").collect()
}

/// Returns the text in the canonical layout; if it has errors, returns the messages as JSON.
pub(crate) fn fmt(document: &Document<'_>) -> Value {
    match syntax::format(document.source, document.text()) {
        Ok(text) => output(text),
        Err(found) => json!({ "messages": messages(document, &found) }),
    }
}

/// Returns the explanation of a code.
pub(crate) fn explain(code: &str) -> Result<Value, String> {
    let code =
        Code::ALL.iter().find(|known| known.name() == code).ok_or_else(|| format!("there is no code {code:?}"))?;
    Ok(output(format!("{code}: {}\n\n{}", code.title(), code.explanation().text())))
}

/// Returns the interrupts, laws and signals of a robot, each with its signature and its description.
pub(crate) fn quarks(name: &str) -> Result<Value, String> {
    let alphabet = &robot(name)?.alphabet;
    let able = alphabet.declarations().filter(|declaration| declaration.needs.iter().all(|need| alphabet.has(need)));
    let quark = |declaration: &Declaration| {
        let kind = match declaration.kind {
            DeclarationKind::Control => "law",
            DeclarationKind::Interrupt => "interrupt",
            DeclarationKind::Signal => "signal",
        };
        json!({ "kind": kind, "signature": signature(declaration), "about": declaration.docs })
    };
    Ok(able.map(quark).collect())
}

/// Returns the static analysis of a plan as text and as JSON.
pub(crate) fn analyze(document: &mut Document<'_>, plan: Option<&str>) -> Result<Value, String> {
    let Compiled { machine, .. } = document.compile(plan, |_| Ok(()))?;
    let analysis = analysis(&machine);
    Ok(json!({ "output": analysis.to_text(), "json": analysis.to_json() }))
}

/// Returns the picture of a plan.
pub(crate) fn draw(document: &mut Document<'_>, plan: Option<&str>) -> Result<Value, String> {
    let Compiled { machine, .. } = document.compile(plan, picture::fits)?;
    picture::svg(&machine).map(output).map_err(|too_large| document.rendered(&[too_large]))
}

/// Returns the trace of a plan that runs on a script.
pub(crate) fn trace(document: &mut Document<'_>, plan: Option<&str>, script: &str) -> Result<Value, String> {
    let compiled = document.compile(plan, |_| Ok(()))?;
    let script = Script::read(script).and_then(|script| compiled.worded(script, document.alphabet));
    let script = script.map_err(|error| format!("line {} of the script: {}", error.line, error.message))?;
    let mut text = String::new();
    for line in run(CountedRun::new(&compiled.machine), &script) {
        text += &format!("{line}\n");
        if text.len() > TRACE_MOST {
            return Err("the trace is too long to be shown: use `mdlec trace`".to_owned());
        }
    }
    Ok(output(text))
}
