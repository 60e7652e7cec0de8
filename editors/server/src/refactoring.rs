//! Implements definition, references and rename across the files of a project.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use mdle_compiler::diagnostic::{Code, Severity};
use mdle_files::{place, read};
use serde_json::{Value, json};

use crate::answers::RequestedDocument;
use crate::convert;
use crate::documents::{Document, Documents, Plan};
use crate::params::{Params, RequestError};
use mdle_language_service::diagnostics::FileRange;
use mdle_language_service::lines::LineStarts;
use mdle_language_service::rename::{self as names, NamedItem};

/// A definition: the canonical path of its file, and the byte range of the name.
type Definition = (PathBuf, Range<usize>);

/// Converts the place of a definition to a form that is the same for all files that use the definition. Returns `None`
/// if the place is in an alphabet file.
fn global(plan: &Plan, defined: &FileRange) -> Option<Definition> {
    let path = plan.input.path(defined.source)?;
    Some((place(path).unwrap_or_else(|_| path.to_owned()), defined.range.clone()))
}

fn named(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Option<(NamedItem, Definition)>, RequestError> {
    let byte = asked.byte(params.position)?;
    let named = asked.view(|view| names::named(view, byte));
    Ok(named.and_then(|named| {
        let definition = global(&asked.plan, &named.defined)?;
        Some((named, definition))
    }))
}

pub(crate) fn definition(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let byte = asked.byte(params.position)?;
    if let Some(used) = asked.view(|view| names::used_file(view, byte)) {
        let file = asked.document.path.parent().unwrap_or(Path::new("")).join(used);
        let start = json!({ "line": 0, "character": 0 });
        return Ok(json!({ "uri": asked.documents.uri(&file), "range": { "start": start, "end": start } }));
    }
    let found = named(asked, params)?;
    Ok(found.and_then(|(named, _)| asked.converter().location(&named.defined)).unwrap_or_default())
}

pub(crate) fn highlights(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let Some((named, _)) = named(asked, params)? else { return Ok(Value::Null) };
    let places = asked.view(|view| names::references(view, |place| *place == named.defined));
    let mut converter = asked.converter();
    Ok(places.iter().map(|place| json!({ "range": converter.range(place) })).collect())
}

pub(crate) fn references(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let Some((_, definition)) = named(asked, params)? else { return Ok(Value::Null) };
    let declared = params.context.as_ref().and_then(|context| context.get("includeDeclaration"));
    let with_definition = declared.and_then(Value::as_bool).unwrap_or(true);
    let mut locations = Vec::new();
    for (path, UsingFile { text, ranges, .. }) in files_with(asked.documents, &definition) {
        let (uri, lines) = (asked.documents.uri(&path), LineStarts::of(&text));
        let is_shown = |range: &&Range<usize>| with_definition || **range != definition.1 || path != definition.0;
        let range = |range: &Range<usize>| json!({ "uri": uri, "range": convert::range(&text, &lines, range) });
        locations.extend(ranges.iter().filter(is_shown).map(range));
    }
    Ok(locations.into())
}

pub(crate) fn prepare(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let Some((named, _)) = named(asked, params)? else { return Ok(Value::Null) };
    Ok(json!({ "range": asked.converter().range(&named.here), "placeholder": named.name }))
}

pub(crate) fn rename(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let name = params.new_name.as_deref().ok_or_else(|| RequestError::params("missing `newName`"))?;
    if !names::is_name(name) {
        return Err(RequestError::failed(format!("`{name}` is no name: letters, digits and `_`, and no keyword")));
    }
    let Some((named, definition)) = named(asked, params)? else {
        return Err(RequestError::failed("only plans, parameters and labels can be renamed"));
    };
    let files = files_with(asked.documents, &definition);
    keeps_meanings(asked.documents, &files, name)
        .map_err(|reason| RequestError::failed(format!("`{}` cannot become `{name}`: {reason}", named.name)))?;
    let mut changes = BTreeMap::new();
    for (path, UsingFile { text, ranges, .. }) in files.iter().filter(|(_, file)| !file.ranges.is_empty()) {
        let lines = LineStarts::of(text);
        let edit = |range: &Range<usize>| json!({ "range": convert::range(text, &lines, range), "newText": name });
        changes.insert(asked.documents.uri(path), ranges.iter().map(edit).collect::<Vec<_>>());
    }
    Ok(json!({ "changes": changes }))
}

/// A file that uses a definition.
#[derive(Debug)]
struct UsingFile {
    text: String,
    /// Byte ranges of the name's occurrences in the file.
    ranges: Vec<Range<usize>>,
    meanings: Vec<(u8, Option<usize>)>,
    errors: Vec<Code>,
}

/// Returns the files of the project that use a definition, by path.
fn files_with(documents: &Documents, definition: &Definition) -> BTreeMap<PathBuf, UsingFile> {
    let mut files = BTreeMap::new();
    let mut paths: BTreeSet<PathBuf> = documents.project();
    paths.insert(definition.0.clone());
    for path in paths {
        let at = place(&path).unwrap_or_else(|_| path.clone());
        let opened = documents.open.values().find(|document| document.path == path);
        let opened = opened
            .or_else(|| documents.open.values().find(|document| place(&document.path).is_ok_and(|own| own == at)));
        let text = opened.map(|document| document.text.clone());
        let text = text.or_else(|| mdle_files::read_text(&path, read::LARGEST_PLAN).ok());
        let Some(text) = text.filter(|_| !files.contains_key(&at)) else { continue };
        if let Some(file) = seen(documents, &path, text, definition) {
            files.insert(at, file);
        }
    }
    files
}

/// Reads a file, and returns it if it uses the definition; `None` otherwise.
fn seen(documents: &Documents, path: &Path, text: String, definition: &Definition) -> Option<UsingFile> {
    let document = Document { path: path.to_owned(), text, version: 0 };
    let mut plan = documents.plan_for_any(&document).ok()?;
    let source = plan.input.source;
    // The places are compared with the definition after the view, which borrows the files of the input.
    let (all, meanings) = plan.view(|view| {
        let places = view.sources;
        let all: Vec<_> = mdle_language_service::mentions::mentions(view.files, view.alphabet)
            .into_iter()
            .filter_map(|mention| {
                let defined = mdle_language_service::diagnostics::place(places, mention.defined?);
                Some((mdle_language_service::diagnostics::place(places, mention.span), defined))
            })
            .collect();
        (all, names::meanings(view))
    });
    let is_meant = |defined: &FileRange| global(&plan, defined).is_some_and(|found| found == *definition);
    let meant: Vec<_> = all.iter().filter(|(_, defined)| is_meant(defined)).collect();
    if meant.is_empty() {
        return None;
    }
    let own = meant.iter().filter(|(place, _)| place.source == source);
    let ranges: BTreeSet<_> = own.map(|(place, _)| (place.range.start, place.range.end)).collect();
    let found = plan.input.check(&plan.target.alphabet);
    let errors = found.iter().filter(|found| found.code.severity() == Severity::Error).map(|found| found.code);
    Some(UsingFile {
        errors: errors.collect(),
        ranges: ranges.into_iter().map(|(start, end)| start..end).collect(),
        meanings,
        text: document.text,
    })
}

/// Checks that all names in `files` keep their meanings if the definition is renamed to `name`.
fn keeps_meanings(documents: &Documents, files: &BTreeMap<PathBuf, UsingFile>, name: &str) -> Result<(), String> {
    let mut renamed = documents.clone();
    for (path, file) in files {
        let mut text = file.text.clone();
        for range in file.ranges.iter().rev() {
            text.replace_range(range.clone(), name);
        }
        let document = Document { path: path.clone(), text, version: 0 };
        renamed.open.insert(documents.uri(path), document);
    }
    for (path, file) in files {
        let Some(document) = renamed.open.get(&documents.uri(path)) else { continue };
        let mut plan = renamed.plan_for_any(document).map_err(|error| error.to_string())?;
        let found = plan.input.check(&plan.target.alphabet);
        let errors: Vec<_> = found.iter().filter(|found| found.code.severity() == Severity::Error).collect();
        if errors.len() > file.errors.len() {
            let new = errors.iter().find(|found| !file.errors.contains(&found.code)).or(errors.first());
            return Err(new.map_or_else(String::new, |found| found.message.clone()));
        }
        if plan.view(names::meanings) != file.meanings {
            return Err(format!("another name in `{}` would change its meaning", path.display()));
        }
    }
    Ok(())
}
