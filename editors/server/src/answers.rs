//! Answers requests about a single document: converts the results of the language features to protocol objects.

use std::ops::Range;

use serde_json::{Value, json};

use crate::commands;
use crate::convert::{self, Converter};
use crate::documents::{Document, Documents, Plan, Positions, ProtocolPosition};
use crate::params::{Params, RequestError};
use mdle_language_service::completion::ItemKind;
use mdle_language_service::diagnostics::findings;
use mdle_language_service::formatting::TextEdit;
use mdle_language_service::lines::{LineStarts, Position};
use mdle_language_service::outline::{Symbol, SymbolKind};
use mdle_language_service::tokens as colours;
use mdle_language_service::view::{View, view};
use mdle_language_service::{
    completion, fixes as quick, formatting as layout, hints as inlay, hover as about, lenses as lens, outline,
};

/// The document that a request refers to.
#[derive(Debug)]
pub(crate) struct RequestedDocument<'d> {
    pub(crate) documents: &'d Documents,
    pub(crate) uri: &'d str,
    pub(crate) document: &'d Document,
    pub(crate) plan: Plan,
}

impl RequestedDocument<'_> {
    /// Calls `feature` with a view of the document, and returns its result.
    pub(crate) fn view<T>(&mut self, feature: impl FnOnce(&View<'_>) -> T) -> T {
        self.plan.view(feature)
    }

    pub(crate) fn byte(&self, at: Option<ProtocolPosition>) -> Result<usize, RequestError> {
        let at = at.ok_or_else(|| RequestError::params("missing `position`"))?;
        Ok(LineStarts::of(&self.document.text).byte(&self.document.text, at.into()))
    }

    fn bytes(&self, range: Option<Positions>) -> Result<Range<usize>, RequestError> {
        let Positions { start, end } = range.ok_or_else(|| RequestError::params("missing `range`"))?;
        Ok(LineStarts::of(&self.document.text).range(&self.document.text, start.into(), end.into()))
    }

    pub(crate) fn converter(&self) -> Converter<'_> {
        Converter::new(self.documents, &self.plan)
    }

    fn edits(&self, edits: Option<Vec<TextEdit>>) -> Value {
        let mut converter = self.converter();
        let edit = |edit: TextEdit| json!({ "range": converter.own(&edit.range), "newText": edit.text });
        edits.map_or(Value::Null, |edits| edits.into_iter().map(edit).collect())
    }
}

impl Plan {
    /// Calls `feature` with a view of the plan, and returns its result.
    pub(crate) fn view<T>(&mut self, feature: impl FnOnce(&View<'_>) -> T) -> T {
        view(self.input.source, &mut self.input, |input| &input.sources, &self.target.alphabet, feature)
    }
}

fn markdown(text: &str) -> Value {
    json!({ "kind": "markdown", "value": text })
}

pub(crate) fn hover(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let byte = asked.byte(params.position)?;
    let Some(hover) = asked.view(|view| about::hover(view, byte)) else { return Ok(Value::Null) };
    Ok(json!({ "contents": markdown(&hover.text), "range": asked.converter().own(&hover.range) }))
}

pub(crate) fn completion(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let byte = asked.byte(params.position)?;
    let found = asked.view(|view| completion::completion(view, byte));
    let range = asked.converter().own(&found.range);
    let item = |item: completion::Item| {
        let is_snippet = item.kind == ItemKind::Snippet;
        json!({
            "label": item.label,
            "kind": kind_of_item(item.kind),
            "detail": item.detail,
            "documentation": markdown(&item.docs),
            "insertTextFormat": if is_snippet { 2 } else { 1 },
            "textEdit": { "range": range, "newText": item.insert },
        })
    };
    Ok(found.items.into_iter().map(item).collect())
}

/// Returns the protocol's number for a kind of proposal.
fn kind_of_item(kind: ItemKind) -> u32 {
    match kind {
        ItemKind::Law => 3,
        ItemKind::Interrupt => 23,
        ItemKind::Signal | ItemKind::Parameter => 6,
        ItemKind::Plan => 7,
        ItemKind::Unit => 11,
        ItemKind::Label => 18,
        ItemKind::Type => 25,
        ItemKind::Keyword => 14,
        ItemKind::Snippet => 15,
    }
}

pub(crate) fn signature(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let byte = asked.byte(params.position)?;
    let Some(found) = asked.view(|view| completion::signature_at(view, byte)) else { return Ok(Value::Null) };
    let params: Vec<_> = found.params.iter().map(|label| json!({ "label": label })).collect();
    let signature = json!({ "label": found.label, "documentation": markdown(&found.docs), "parameters": params });
    Ok(json!({ "signatures": [signature], "activeSignature": 0, "activeParameter": found.active }))
}

pub(crate) fn symbols(asked: &mut RequestedDocument<'_>, _: &Params) -> Result<Value, RequestError> {
    let symbols = asked.view(outline::symbols);
    let mut converter = asked.converter();
    Ok(symbols.iter().map(|symbol| symbol_value(&mut converter, symbol)).collect())
}

fn symbol_value(converter: &mut Converter<'_>, symbol: &Symbol) -> Value {
    let children: Vec<_> = symbol.children.iter().map(|child| symbol_value(converter, child)).collect();
    json!({
        "name": symbol.name,
        "detail": symbol.detail,
        "kind": match symbol.kind {
            SymbolKind::Plan => 5,
            SymbolKind::Behavior => 3,
            SymbolKind::Labelled => 20,
        },
        "range": converter.own(&symbol.range),
        "selectionRange": converter.own(&symbol.name_range),
        "children": children,
    })
}

pub(crate) fn folds(asked: &mut RequestedDocument<'_>, _: &Params) -> Result<Value, RequestError> {
    let folds = asked.view(outline::folds);
    let (text, lines) = (&asked.document.text, LineStarts::of(&asked.document.text));
    let line = |byte: usize| lines.position(text, byte).line;
    let fold = |range: &Range<usize>| json!({ "startLine": line(range.start), "endLine": line(range.end) });
    Ok(folds.iter().map(fold).collect())
}

pub(crate) fn selections(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let positions = params.positions.clone().ok_or_else(|| RequestError::params("missing `positions`"))?;
    let bytes: Vec<_> = positions.into_iter().map(|at| asked.byte(Some(at))).collect::<Result<_, _>>()?;
    let nested: Vec<_> = asked.view(|view| bytes.iter().map(|byte| outline::selections(view, *byte)).collect());
    let mut converter = asked.converter();
    let mut chain = |ranges: &Vec<Range<usize>>| {
        ranges.iter().rev().fold(Value::Null, |parent, range| {
            let range = converter.own(range);
            if parent.is_null() { json!({ "range": range }) } else { json!({ "range": range, "parent": parent }) }
        })
    };
    Ok(nested.iter().map(&mut chain).collect())
}

pub(crate) fn hints(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let range = asked.bytes(params.range)?;
    let hints = asked.view(inlay::hints);
    let (text, lines) = (&asked.document.text, LineStarts::of(&asked.document.text));
    let shown = hints.iter().filter(|hint| range.start <= hint.byte && hint.byte <= range.end);
    let hint = |hint: &inlay::Hint| {
        let position = convert::position(lines.position(text, hint.byte));
        json!({ "position": position, "label": hint.text, "paddingLeft": true })
    };
    Ok(shown.map(hint).collect())
}

pub(crate) fn lenses(asked: &mut RequestedDocument<'_>, _: &Params) -> Result<Value, RequestError> {
    let runnables = asked.view(lens::runnables);
    let mut converter = asked.converter();
    let lens = |plan: &lens::Runnable| {
        let range = converter.own(&plan.range);
        [("Run", commands::RUN), ("Draw", commands::DRAW)].map(|(title, command)| {
            let command = json!({ "title": title, "command": command, "arguments": [asked.uri, plan.name] });
            json!({ "range": range, "command": command })
        })
    };
    Ok(runnables.iter().flat_map(lens).collect())
}

pub(crate) fn fixes(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let range = asked.bytes(params.range)?;
    let only = params.context.as_ref().and_then(|context| context.get("only")).and_then(Value::as_array);
    if only.is_some_and(|only| !only.iter().filter_map(Value::as_str).any(|kind| "quickfix".starts_with(kind))) {
        return Ok(json!([]));
    }
    let diagnostics = asked.plan.input.check(&asked.plan.target.alphabet);
    let (sources, own) = (&asked.plan.input.sources, asked.plan.input.source);
    let fixes = quick::fixes(sources, &diagnostics, |place| place.source == own, &range);
    let mut converter = asked.converter();
    let mut actions = Vec::new();
    for fix in &fixes {
        let Some(uri) = converter.uri(fix.place.source) else { continue };
        let is_only = fixes.iter().filter(|other| other.diagnostic == fix.diagnostic).count() == 1;
        let found = diagnostics.get(fix.diagnostic).map(std::slice::from_ref).unwrap_or(&[]);
        let found: Vec<_> = findings(sources, found).iter().map(|found| converter.diagnostic(found, None)).collect();
        let edit = json!({ "range": converter.range(&fix.place), "newText": fix.replacement });
        actions.push(json!({
            "title": fix.title,
            "kind": "quickfix",
            "isPreferred": is_only,
            "diagnostics": found,
            "edit": { "changes": { uri: [edit] } },
        }));
    }
    Ok(actions.into())
}

pub(crate) fn formatting(asked: &mut RequestedDocument<'_>, _: &Params) -> Result<Value, RequestError> {
    Ok(asked.edits(layout::document(&asked.document.text)))
}

pub(crate) fn range_formatting(asked: &mut RequestedDocument<'_>, params: &Params) -> Result<Value, RequestError> {
    let range = asked.bytes(params.range)?;
    let edits = asked.view(|view| layout::range(view, &range));
    Ok(asked.edits(edits))
}

pub(crate) fn tokens(asked: &mut RequestedDocument<'_>, _: &Params) -> Result<Value, RequestError> {
    let tokens = asked.view(colours::tokens);
    let (text, lines) = (&asked.document.text, LineStarts::of(&asked.document.text));
    let mut data: Vec<u32> = Vec::with_capacity(5 * tokens.len());
    let mut last = Position { line: 0, character: 0 };
    for token in tokens {
        let [start, end] = [token.range.start, token.range.end].map(|byte| lines.position(text, byte));
        let line = start.line - last.line;
        let character = if line == 0 { start.character - last.character } else { start.character };
        let kind = u32::try_from(token.kind).unwrap_or(0);
        data.extend([line, character, end.character - start.character, kind, u32::from(token.is_definition)]);
        last = start;
    }
    Ok(json!({ "data": data }))
}
