//! `mdle shell`: runs a plan together with a front end for commands.

use std::fs::File;
use std::io::{self, BufReader, IsTerminal as _};
use std::os::fd::{AsFd as _, OwnedFd};
use std::os::unix::fs::FileTypeExt as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, channel};
use std::thread::Builder;
use std::time::Duration;

use mdle_engine::shell::{Conversation, FileLines, Lines, converse};
use mdle_engine::tree::{Desk, Hub};

use crate::arguments::SessionOptions;
use crate::failure::Failure;
use crate::terminal::{HeldTerminal, Printing};

/// Maximum wait, after a run, for the last answer of the front end.
const LAST_ANSWER: Duration = Duration::from_secs(1);
/// Exit status for a session in which a command has been refused.
const REFUSED: u8 = 1;

/// Data that a run needs in order to serve its session.
pub(crate) struct SessionInputs {
    pub(crate) desk: Desk,
    /// `true` if stepped time is paused at the beginning of the run.
    pub(crate) is_paused: bool,
    /// Stream to which the run writes its reports.
    pub(crate) stream: OwnedFd,
}

/// Runs a session together with `run`; `plan` is the path of the plan's file. Returns the exit status of the run. If
/// the status would be 0 but a command from a file or a pipe was refused, returns 1.
///
/// # Errors
/// Fails if the commands cannot be read.
pub(crate) fn held(
    options: &SessionOptions,
    plan: &Path,
    run: impl FnOnce(SessionInputs) -> ExitCode,
) -> Result<ExitCode, Failure> {
    let (hub, desk) = Desk::with_hub();
    let unheld = |error: io::Error| Failure::Usage(format!("the system gives no session: {error}"));
    let (terminal, printing) = if options.commands.is_none() && io::stdin().is_terminal() {
        HeldTerminal::take().map(|(terminal, printing)| (Some(terminal), Some(printing))).map_err(unheld)?
    } else {
        (None, None)
    };
    let stderr = io::stderr();
    let stream = terminal.as_ref().map_or(stderr.as_fd(), |terminal| terminal.reports().as_fd());
    let stream = stream.try_clone_to_owned().map_err(unheld)?;
    let outcome = front_end(options, plan, hub, printing)?;
    let status = run(SessionInputs { desk, is_paused: options.is_paused, stream });
    if let Some(terminal) = terminal {
        // The front end may be waiting for a person to type: the session ends without it.
        terminal.give_back();
        return Ok(status);
    }
    // Waits after a fault as well: the last answers name the commands that were not carried out.
    let is_well = outcome.recv_timeout(LAST_ANSWER).unwrap_or(true);
    Ok(if !is_well && status == ExitCode::SUCCESS { ExitCode::from(REFUSED) } else { status })
}

/// Starts the front end on a separate thread. If `printing` is given, the front end uses the terminal; otherwise, it
/// reads commands from a file or from standard input. At the end, the returned channel receives `true` if every command
/// was carried out.
fn front_end(
    options: &SessionOptions,
    plan: &Path,
    hub: Hub,
    printing: Option<Printing>,
) -> Result<Receiver<bool>, Failure> {
    let file = match &options.commands {
        Some(path) => Some(opened(path)?),
        None if plan == Path::new("-") => {
            let sentence = "the plan and the commands cannot both come from standard input\nhelp: name a file of \
                            commands, as in `-c FILE`";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        None => None,
    };
    let name = options.commands.as_ref().map_or("standard input".to_owned(), |path| path.display().to_string());
    let conversation = Conversation {
        file: printing.is_none().then_some(name),
        role: options.role,
        stops_at_errors: options.stops_at_errors,
        echoes: options.echoes,
    };
    let (sender, outcome) = channel();
    let talk = move || {
        let mut lines: Box<dyn Lines> = match (file, printing.map(|printing| printing.begin(&hub))) {
            (Some(file), _) => Box::new(FileLines::new(BufReader::new(file))),
            (None, Some(Ok(terminal))) => Box::new(terminal),
            (None, Some(Err(_)) | None) => Box::new(FileLines::new(BufReader::new(io::stdin()))),
        };
        let is_well = converse(&hub, &conversation, &mut *lines, &mut io::stdout(), &mut io::stderr());
        let _ = sender.send(is_well);
    };
    let started = Builder::new().name("shell".to_owned()).spawn(talk);
    started.map_err(|error| Failure::Usage(format!("the system gives no thread for the shell: {error}")))?;
    Ok(outcome)
}

/// Opens a file of commands, which may be a pipe.
pub(crate) fn opened(path: &Path) -> Result<File, Failure> {
    let unread =
        |error: io::Error| Failure::Usage(format!("the commands in {} cannot be read: {error}", path.display()));
    let file = File::open(path).map_err(unread)?;
    let kind = file.metadata().map_err(unread)?.file_type();
    if kind.is_file() || kind.is_fifo() || kind.is_char_device() {
        Ok(file)
    } else {
        Err(unread(io::Error::other("expected a file or a pipe")))
    }
}
