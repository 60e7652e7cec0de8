//! Executes the commands of code lenses: `mdle.run` returns a command line, and `mdle.draw` returns a picture.

use mdle_compiler::picture;
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::params::RequestError;

/// Name of the command that runs a plan. The command returns the words of a command line for the editor's terminal.
pub(crate) const RUN: &str = "mdle.run";
/// Name of the command that draws a plan. The command returns the picture as SVG.
pub(crate) const DRAW: &str = "mdle.draw";

/// Executes a command, whose arguments are the URI of a document and the name of a plan.
pub(crate) fn execute(documents: &Documents, params: &Value) -> Result<Value, RequestError> {
    let argument = |at: usize| params.pointer(&format!("/arguments/{at}")).and_then(Value::as_str);
    let (Some(uri), Some(name)) = (argument(0), argument(1)) else {
        return Err(RequestError::params("the arguments are the URI of a document and the name of a plan"));
    };
    let document = documents.open.get(uri).ok_or_else(|| RequestError::unknown(uri))?;
    match params.get("command").and_then(Value::as_str) {
        Some(RUN) => Ok(json!(["mdlec", "run", document.path.display().to_string(), "--plan", name])),
        Some(DRAW) => {
            let mut plan = documents.plan(document).map_err(|error| RequestError::failed(error.to_string()))?;
            plan.input.must_have(name).map_err(|error| RequestError::failed(error.to_string()))?;
            let (compiled, _) = plan.input.compile(&plan.target.alphabet, Some(name));
            let compiled = compiled.first().ok_or_else(|| RequestError::failed(format!("`{name}` has errors")))?;
            let drawn = picture::svg(&compiled.machine).map_err(|too_large| RequestError::failed(too_large.message))?;
            Ok(json!({ "svg": drawn }))
        }
        other => Err(RequestError::params(&format!("mdlec has no command `{}`", other.unwrap_or_default()))),
    }
}
