//! Answers the requests that a client sends while the run is stopped. An answer depends only on the state of the
//! session.

use std::path::PathBuf;

use mdle_compiler::diagnostic::Span;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::places::{StopPlace, between};
use crate::session::DebugSession;
use crate::stack::{StackFrame, frames};
use crate::why::{sentence, why};

/// Number of the debugged plan's only thread.
pub(crate) const THREAD: i64 = 1;

#[derive(Deserialize)]
struct Source {
    path: Option<PathBuf>,
}

#[derive(Deserialize)]
struct SetBreakpoints {
    source: Source,
    #[serde(default)]
    breakpoints: Vec<Wanted>,
}

#[derive(Deserialize)]
struct Wanted {
    line: u32,
    column: Option<u32>,
}

#[derive(Deserialize)]
struct SetNames {
    breakpoints: Vec<Named>,
}

#[derive(Deserialize)]
struct Named {
    name: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Locations {
    source: Source,
    line: u32,
    end_line: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct OfFrame {
    frame_id: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Evaluate {
    expression: String,
    frame_id: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct StackTrace {
    start_frame: Option<usize>,
    levels: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct OfReference {
    variables_reference: usize,
}

/// Answers a request.
///
/// # Errors
/// Returns a sentence for the user if the request cannot be answered.
pub(crate) fn answer(
    session: &mut DebugSession<'_, '_, '_>,
    command: &str,
    arguments: &Value,
) -> Result<Value, String> {
    match command {
        "setBreakpoints" => set_breakpoints(session, read(arguments)?),
        "setFunctionBreakpoints" => Ok(set_names(session, read(arguments)?)),
        "setExceptionBreakpoints" => Ok(json!({ "breakpoints": [] })),
        "breakpointLocations" => Ok(locations(session, read(arguments)?)),
        "threads" => Ok(json!({ "threads": [{ "id": THREAD, "name": session.loaded.compiled.plan.root.name }] })),
        "stackTrace" => Ok(stack_trace(session, &read(arguments)?)),
        "scopes" => scopes(session, &read(arguments)?),
        "variables" => variables(session, &read(arguments)?),
        "evaluate" => evaluate(session, &read(arguments)?),
        other => Err(format!("`{other}` is no request that a plan can answer")),
    }
}

fn read<T: DeserializeOwned>(arguments: &Value) -> Result<T, String> {
    let words = |error: serde_json::Error| format!("the arguments cannot be read: {error}");
    let arguments = if arguments.is_null() { json!({}) } else { arguments.clone() };
    serde_json::from_value(arguments).map_err(words)
}

fn set_breakpoints(session: &mut DebugSession<'_, '_, '_>, wanted: SetBreakpoints) -> Result<Value, String> {
    let path = wanted.source.path.ok_or("breakpoints can only be set in files")?;
    let base = session.base;
    let from_base = |wanted: &Wanted| {
        (wanted.line.saturating_sub(base.line), wanted.column.map(|column| column.saturating_sub(base.column)))
    };
    let wanted: Vec<_> = wanted.breakpoints.iter().map(from_base).collect();
    let set = session.breakpoints.set(session.loaded, &path, &wanted);
    let answered = set.into_iter().map(|(id, place)| match place {
        Err(reason) => json!({ "id": id, "verified": false, "message": reason }),
        Ok(place) => {
            let mut answer = position(session, &place);
            answer["id"] = json!(id);
            answer["verified"] = json!(true);
            answer
        }
    });
    Ok(json!({ "breakpoints": answered.collect::<Vec<_>>() }))
}

fn position(session: &DebugSession<'_, '_, '_>, place: &StopPlace) -> Value {
    json!({ "line": place.line + session.base.line, "column": place.column + session.base.column })
}

fn set_names(session: &mut DebugSession<'_, '_, '_>, wanted: SetNames) -> Value {
    let names: Vec<String> = wanted.breakpoints.into_iter().map(|named| named.name).collect();
    let set = session.breakpoints.set_names(&session.loaded.compiled.plan, &names);
    let answered = set.into_iter().map(|(id, set)| match set {
        Ok(()) => json!({ "id": id, "verified": true }),
        Err(reason) => json!({ "id": id, "verified": false, "message": reason }),
    });
    json!({ "breakpoints": answered.collect::<Vec<_>>() })
}

fn locations(session: &DebugSession<'_, '_, '_>, asked: Locations) -> Value {
    let Some(source) = asked.source.path.and_then(|path| session.loaded.source(&path)) else {
        return json!({ "breakpoints": [] });
    };
    let first = asked.line.saturating_sub(session.base.line);
    let last = asked.end_line.map_or(first, |line| line.saturating_sub(session.base.line));
    let places = between(session.breakpoints.places(), source, first, last);
    json!({ "breakpoints": places.map(|place| position(session, place)).collect::<Vec<_>>() })
}

fn stack_trace(session: &DebugSession<'_, '_, '_>, asked: &StackTrace) -> Value {
    let loaded = session.loaded;
    let mut frames = frames(&session.run, &loaded.compiled.plan);
    if frames.is_empty() {
        let root = &loaded.compiled.plan.root;
        frames.push(StackFrame {
            name: format!("{} has ended", root.name),
            span: root.span,
            open: 0,
            loops: Vec::new(),
        });
    }
    let total = frames.len();
    let asked_for = frames.iter().enumerate().skip(asked.start_frame.unwrap_or(0));
    let levels = asked.levels.filter(|levels| *levels > 0).unwrap_or(usize::MAX);
    let shown = asked_for.take(levels).map(|(number, frame)| shown(session, number, frame));
    json!({ "stackFrames": shown.collect::<Vec<_>>(), "totalFrames": total })
}

/// Converts a frame to an object of the protocol, including its place in a file.
fn shown(session: &DebugSession<'_, '_, '_>, number: usize, frame: &StackFrame) -> Value {
    let loaded = session.loaded;
    let (source, line, column) = loaded.place(frame.span);
    let (_, end_line, end_column) = loaded.place(Span { start: frame.span.end, ..frame.span });
    let path = loaded.path(source);
    let name = path.as_deref().and_then(|path| path.file_name()).unwrap_or_default();
    json!({
        "id": number + 1,
        "name": frame.name,
        "source": { "name": name.to_string_lossy(), "path": path },
        "line": line + session.base.line,
        "column": column + session.base.column,
        "endLine": end_line + session.base.line,
        "endColumn": end_column + session.base.column,
    })
}

/// Returns the frame with this number or, if there is no number, the frame of the current atom. Returns `None` if the
/// plan has ended.
fn frame(session: &DebugSession<'_, '_, '_>, number: Option<usize>) -> Result<Option<StackFrame>, String> {
    let frames = frames(&session.run, &session.loaded.compiled.plan);
    let index = number.unwrap_or(1).checked_sub(1).filter(|index| *index < frames.len().max(1));
    let index = index.ok_or_else(|| "there is no such frame: the run has gone on".to_owned())?;
    Ok(frames.into_iter().nth(index))
}

fn scopes(session: &mut DebugSession<'_, '_, '_>, asked: &OfFrame) -> Result<Value, String> {
    let frame = frame(session, asked.frame_id)?;
    Ok(json!({ "scopes": session.lists.scopes(session.loaded, &session.run, frame.as_ref()) }))
}

fn variables(session: &DebugSession<'_, '_, '_>, asked: &OfReference) -> Result<Value, String> {
    let list = session.lists.get(asked.variables_reference);
    let list = list.ok_or("there are no such variables: the run has gone on")?;
    Ok(json!({ "variables": list }))
}

/// Explains why a condition holds or does not hold.
fn evaluate(session: &mut DebugSession<'_, '_, '_>, asked: &Evaluate) -> Result<Value, String> {
    let frames = frames(&session.run, &session.loaded.compiled.plan);
    let from = asked.frame_id.unwrap_or(1).saturating_sub(1).min(frames.len());
    let (inside, outwards) = frames.split_at(from);
    let mut found = outwards.iter().chain(inside);
    let reasons = found.find_map(|frame| why(session.loaded, &session.run, frame, &asked.expression));
    let reasons = reasons.ok_or_else(|| {
        format!(
            "`{}` is no condition of the atom or of a scope around it, and no operand of one",
            asked.expression.trim()
        )
    })?;
    let references: Vec<Value> =
        reasons.iter().map(|reason| session.lists.reason(reason)["variablesReference"].clone()).collect();
    // A comparison has no operands to show.
    let reference = references.into_iter().next().unwrap_or_default();
    Ok(json!({ "result": sentence(&reasons, &asked.expression), "variablesReference": reference }))
}
