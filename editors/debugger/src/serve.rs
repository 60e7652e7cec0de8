//! Serves a client: answers `initialize` and `launch`, and then the requests of a session.

use serde_json::{Value, json};

use crate::ServeError;
use crate::breakpoints::Breakpoints;
use crate::client::{Client, ClientRequest};
use crate::launch::{Launch, LaunchedPlan};
use crate::motion::RequestedMotion;
use crate::requests;
use crate::run::DebugRun;
use crate::session::{Base, DebugSession};
use crate::variables::Lists;

/// Serves a client until it ends the session.
pub(crate) fn serve(client: &mut Client<'_>) -> Result<(), ServeError> {
    let mut base = Base { line: 1, column: 1 };
    loop {
        let request = client.request()?;
        match request.command.as_str() {
            "initialize" => {
                let first = |name: &str| u32::from(request.arguments.get(name) != Some(&Value::Bool(false)));
                base = Base { line: first("linesStartAt1"), column: first("columnsStartAt1") };
                client.respond(&request, Ok(capabilities()))?;
            }
            "launch" => match launched(&request.arguments) {
                Ok((launch, loaded)) => return debug(client, &request, base, &launch, &loaded),
                Err(reason) => client.respond(&request, Err(reason))?,
            },
            "attach" => client.respond(&request, Err("a plan is launched, with `program` and `script`".into()))?,
            "disconnect" | "terminate" => return client.respond(&request, Ok(Value::Null)),
            other => client.respond(&request, Err(format!("`{other}` came before `launch`")))?,
        }
    }
}

fn capabilities() -> Value {
    json!({
        "supportsConfigurationDoneRequest": true,
        "supportsFunctionBreakpoints": true,
        "supportsEvaluateForHovers": true,
        "supportsStepBack": true,
        "supportsSteppingGranularity": true,
        "supportsBreakpointLocationsRequest": true,
        "supportsTerminateRequest": true,
    })
}

fn launched(arguments: &Value) -> Result<(Launch, LaunchedPlan), String> {
    let words = |error: serde_json::Error| format!("`launch` needs the paths `program` and `script`: {error}");
    let launch: Launch = serde_json::from_value(arguments.clone()).map_err(words)?;
    let loaded = LaunchedPlan::read(&launch)?;
    Ok((launch, loaded))
}

/// Answers `launch`, and serves the client until it ends the session.
fn debug(
    client: &mut Client<'_>,
    request: &ClientRequest,
    base: Base,
    launch: &Launch,
    loaded: &LaunchedPlan,
) -> Result<(), ServeError> {
    let Some(run) = DebugRun::new(&loaded.compiled.plan, loaded.turns()) else {
        return client.respond(request, Err("the script has no turns".into()));
    };
    client.respond(request, Ok(Value::Null))?;
    client.event("initialized", json!({}))?;
    let breakpoints = Breakpoints::new(loaded);
    DebugSession { loaded, run, breakpoints, lists: Lists::default(), base, client }.serve(launch.stop_on_entry)
}

impl DebugSession<'_, '_, '_> {
    fn serve(&mut self, stops_on_entry: bool) -> Result<(), ServeError> {
        loop {
            let request = self.client.request()?;
            match request.command.as_str() {
                "disconnect" => return self.client.respond(&request, Ok(Value::Null)),
                "terminate" => {
                    self.client.respond(&request, Ok(Value::Null))?;
                    self.client.event("terminated", json!({}))?;
                }
                "configurationDone" => {
                    self.client.respond(&request, Ok(Value::Null))?;
                    self.start(stops_on_entry)?;
                }
                "pause" => {
                    self.client.respond(&request, Ok(Value::Null))?;
                    self.stopped("pause", "Paused", &[])?;
                }
                command => match RequestedMotion::of(command, &request.arguments) {
                    Some(motion) => {
                        self.client.respond(&request, Ok(json!({ "allThreadsContinued": true })))?;
                        self.go(motion)?;
                    }
                    None => {
                        let answer = requests::answer(self, command, &request.arguments);
                        self.client.respond(&request, answer)?;
                    }
                },
            }
        }
    }
}
