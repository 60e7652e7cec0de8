//! Requests of the protocol, each with the function that answers it.

use lsp_server::ErrorCode;
use serde_json::{Value, json};

use crate::answers::{self, RequestedDocument};
use crate::documents::{Documents, is_alphabet};
use crate::params::{Params, RequestError};
use crate::{commands, refactoring};
use mdle_language_service::tokens;

/// Returns the capabilities of the server for the answer to `initialize`.
pub(crate) fn capabilities() -> Value {
    json!({
        "positionEncoding": "utf-16",
        "textDocumentSync": { "openClose": true, "change": 2, "save": {} },
        "hoverProvider": true,
        "completionProvider": { "triggerCharacters": ["(", "{", " "] },
        "signatureHelpProvider": { "triggerCharacters": ["(", " ", ","] },
        "definitionProvider": true,
        "referencesProvider": true,
        "documentHighlightProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "selectionRangeProvider": true,
        "inlayHintProvider": true,
        "codeLensProvider": {},
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "documentFormattingProvider": true,
        "documentRangeFormattingProvider": true,
        "executeCommandProvider": { "commands": [commands::RUN, commands::DRAW] },
        "semanticTokensProvider": {
            "full": true,
            "legend": { "tokenTypes": tokens::KINDS, "tokenModifiers": ["definition"] },
        },
    })
}

/// Returns the URI of the document that a request refers to.
pub(crate) fn uri_of(params: &Value) -> Result<String, RequestError> {
    let uri = params.pointer("/textDocument/uri").and_then(Value::as_str);
    uri.map(str::to_owned).ok_or_else(|| RequestError::params("missing `textDocument.uri`"))
}

/// A function that answers a request about a document.
type AnswerFunction = fn(&mut RequestedDocument<'_>, &Params) -> Result<Value, RequestError>;

/// Returns the function that answers requests with this method; `None` if there is none.
fn function(method: &str) -> Option<AnswerFunction> {
    Some(match method {
        "textDocument/hover" => answers::hover,
        "textDocument/completion" => answers::completion,
        "textDocument/signatureHelp" => answers::signature,
        "textDocument/definition" => refactoring::definition,
        "textDocument/references" => refactoring::references,
        "textDocument/documentHighlight" => refactoring::highlights,
        "textDocument/prepareRename" => refactoring::prepare,
        "textDocument/rename" => refactoring::rename,
        "textDocument/documentSymbol" => answers::symbols,
        "textDocument/foldingRange" => answers::folds,
        "textDocument/selectionRange" => answers::selections,
        "textDocument/inlayHint" => answers::hints,
        "textDocument/codeLens" => answers::lenses,
        "textDocument/codeAction" => answers::fixes,
        "textDocument/formatting" => answers::formatting,
        "textDocument/rangeFormatting" => answers::range_formatting,
        "textDocument/semanticTokens/full" => answers::tokens,
        _ => return None,
    })
}

/// Answers a request.
pub(crate) fn answer(documents: &Documents, method: &str, params: Value) -> Result<Value, RequestError> {
    if method == "workspace/executeCommand" {
        return commands::execute(documents, &params);
    }
    let unknown = || RequestError { code: ErrorCode::MethodNotFound, message: format!("mdlec has no `{method}`") };
    let function = function(method).ok_or_else(unknown)?;
    let params: Params = serde_json::from_value(params).map_err(|error| RequestError::params(&error.to_string()))?;
    let uri = &params.text_document.uri;
    let document = documents.open.get(uri).ok_or_else(|| RequestError::unknown(uri))?;
    if is_alphabet(&document.path) {
        return Ok(Value::Null);
    }
    let plan = documents.plan_for_any(document).map_err(|error| RequestError::failed(error.to_string()))?;
    function(&mut RequestedDocument { documents, uri, document, plan }, &params)
}
