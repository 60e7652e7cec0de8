//! The requests of the protocol, each with the function that answers it.

use lsp_server::ErrorCode;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::answers::{self, Asked};
use crate::documents::{At, Documents, Positions, is_alphabet};
use crate::{commands, refactoring, tokens};

/// Error that answers a request.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub(crate) code: ErrorCode,
    pub(crate) message: String,
}

impl Refusal {
    /// Parameters that are not those of the protocol.
    pub(crate) fn params(message: &str) -> Self {
        Self { code: ErrorCode::InvalidParams, message: message.to_owned() }
    }

    /// A document that the client has not opened.
    pub(crate) fn unknown(uri: &str) -> Self {
        Self::params(&format!("`{uri}` is not open"))
    }

    /// A request that cannot be met, with the reason for the user.
    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self { code: ErrorCode::RequestFailed, message: message.into() }
    }
}

/// Parameters of the requests about a document, as far as they have them.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Params {
    text_document: Named,
    pub(crate) position: Option<At>,
    pub(crate) range: Option<Positions>,
    pub(crate) positions: Option<Vec<At>>,
    pub(crate) new_name: Option<String>,
    pub(crate) context: Option<Value>,
}

#[derive(Debug, Deserialize)]
struct Named {
    uri: String,
}

/// Lists the abilities of the server, as `initialize` answers.
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

/// URI of the document that a request is about.
pub(crate) fn uri_of(params: &Value) -> Result<String, Refusal> {
    let uri = params.pointer("/textDocument/uri").and_then(Value::as_str);
    uri.map(str::to_owned).ok_or_else(|| Refusal::params("missing `textDocument.uri`"))
}

/// Function that answers a request about a document.
type Answer = fn(&mut Asked<'_>, &Params) -> Result<Value, Refusal>;

/// The function for a method.
fn function(method: &str) -> Option<Answer> {
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
pub(crate) fn answer(documents: &Documents, method: &str, params: Value) -> Result<Value, Refusal> {
    if method == "workspace/executeCommand" {
        return commands::execute(documents, &params);
    }
    let unknown = || Refusal { code: ErrorCode::MethodNotFound, message: format!("mdlec has no `{method}`") };
    let function = function(method).ok_or_else(unknown)?;
    let params: Params = serde_json::from_value(params).map_err(|error| Refusal::params(&error.to_string()))?;
    let uri = &params.text_document.uri;
    let document = documents.open.get(uri).ok_or_else(|| Refusal::unknown(uri))?;
    if is_alphabet(&document.path) {
        return Ok(Value::Null);
    }
    let plan = documents.plan_for_any(document).map_err(|error| Refusal::failed(error.to_string()))?;
    function(&mut Asked { documents, uri, document, plan }, &params)
}
