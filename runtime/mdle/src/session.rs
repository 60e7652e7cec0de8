//! `mdle shell`: a run with a front end beside it.

use std::fs::File;
use std::io::{self, BufReader, IsTerminal as _};
use std::os::unix::fs::FileTypeExt as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, channel};
use std::thread::Builder;
use std::time::Duration;

use mdle_engine::shell::{Conversation, Input, Lines, Terminal, converse};
use mdle_engine::tree::{Desk, Hub};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::arguments::SessionOptions;
use crate::failure::Failure;

/// Maximum wait after a run for the last answer of the front end.
const LAST_ANSWER: Duration = Duration::from_millis(500);
/// Exit status of a session in which a command was refused.
const REFUSED: u8 = 1;

/// What a run needs for its session.
pub(crate) struct Seat {
    pub(crate) desk: Desk,
    /// `true` if stepped time stands before the first turn.
    pub(crate) is_paused: bool,
}

/// Holds a session around `run`; `plan` is the file of the plan. Returns the exit status of the run, or 1 if that is 0
/// and a command of a file or a pipe was refused.
///
/// # Errors
/// The commands cannot be read.
pub(crate) fn held(
    options: &SessionOptions,
    plan: &Path,
    run: impl FnOnce(Seat) -> ExitCode,
) -> Result<ExitCode, Failure> {
    let (hub, desk) = Desk::with_hub();
    let is_terminal = options.commands.is_none() && io::stdin().is_terminal();
    let before = if is_terminal { tcgetattr(io::stdin()).ok() } else { None };
    let outcome = front_end(options, plan, hub, is_terminal)?;
    let status = run(Seat { desk, is_paused: options.is_paused });
    // A person who is typing is not waited for.
    let is_well = outcome.recv_timeout(if is_terminal { Duration::ZERO } else { LAST_ANSWER }).unwrap_or(true);
    if let Some(before) = before {
        // The line that is being typed has changed how the terminal reads.
        let _ = tcsetattr(io::stdin(), OptionalActions::Now, &before);
    }
    let is_refused = status == ExitCode::SUCCESS && !is_well && !is_terminal;
    Ok(if is_refused { ExitCode::from(REFUSED) } else { status })
}

/// Starts the front end on a thread of its own; it sends `true` when every command was carried out.
fn front_end(options: &SessionOptions, plan: &Path, hub: Hub, is_terminal: bool) -> Result<Receiver<bool>, Failure> {
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
        file: (!is_terminal).then_some(name),
        role: options.role,
        stops_at_errors: options.stops_at_errors,
        echoes: options.echoes,
    };
    let (sender, outcome) = channel();
    let talk = move || {
        let lines: Result<Box<dyn Lines>, _> = match file {
            Some(file) => Ok(Box::new(Input::new(BufReader::new(file)))),
            None if is_terminal => Terminal::open(hub.clone()).map(|terminal| Box::new(terminal) as _),
            None => Ok(Box::new(Input::new(BufReader::new(io::stdin())))),
        };
        let mut lines = lines.unwrap_or_else(|_| Box::new(Input::new(BufReader::new(io::stdin()))));
        let is_well = converse(&hub, &conversation, &mut *lines, &mut io::stdout(), &mut io::stderr());
        let _ = sender.send(is_well);
    };
    let started = Builder::new().name("shell".to_owned()).spawn(talk);
    started.map_err(|error| Failure::Usage(format!("the system gives no thread for the shell: {error}")))?;
    Ok(outcome)
}

/// Opens a file of commands, which may be a pipe.
fn opened(path: &Path) -> Result<File, Failure> {
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
