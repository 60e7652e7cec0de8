//! Parses the commands of the shell, which become requests.

use crate::tree::{Change, Operation};

/// A typed command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ShellCommand {
    /// An empty line or a comment.
    Nothing,
    /// Perform an operation on the node or folder with this path.
    Ask(String, Operation),
    /// Change the current folder, at which relative paths begin.
    Enter(String),
    /// Print the current folder.
    Here,
    /// Print all commands, or the description of a node.
    Help(Option<String>),
    /// Print a command with its arguments and its description.
    Explain((&'static str, &'static str, &'static str)),
    /// Let the stored plan with this name take over. The arguments name the moment.
    Swap(String, Vec<String>),
    /// End the session, as the end of the command file does.
    Quit,
}

/// All commands, with their arguments and descriptions.
pub(super) const COMMANDS: [(&str, &str, &str); 19] = [
    ("ls", "[PATH]", "list a folder"),
    ("cd", "[PATH]", "change the folder"),
    ("pwd", "", "print the folder"),
    ("get", "PATH", "print a value"),
    ("set", "PATH VALUE", "set a value, as in `set /clock/pace 2`"),
    ("call", "PATH [ARGUMENTS]", "call a method"),
    ("watch", "PATH", "print a value when it changes"),
    ("unwatch", "PATH", "print it no longer"),
    ("help", "[PATH|COMMAND]", "print the commands, or what a name or a command is"),
    ("load_plan", "FILE|TEXT", "compile the plans of a file or of a text in braces, and store them"),
    ("swap", "PLAN [now|atom|plan]", "let a stored plan take over: now, when the atom ends, or when the plan ends"),
    ("cancel", "", "take back a plan that has not taken over yet"),
    ("rollback", "", "end the plan on trial: the plan before it goes on"),
    ("pause", "", "stop simulated time"),
    ("resume", "", "let simulated time go on"),
    ("step", "[N]", "make N turns, and stop the time"),
    ("wait", "[TIME]", "let the robot's clock go on for this long, or until the end of the plan"),
    ("pace", "N|max", "set the pace of simulated time"),
    ("quit", "", "stop the robot, and end the session"),
];

/// Parses a line that was typed in the folder `here`.
///
/// # Errors
/// Fails with a sentence that explains what to type instead.
pub(super) fn command(line: &str, here: &str) -> Result<ShellCommand, String> {
    let line = line.trim();
    if line.is_empty() || line.starts_with('#') {
        return Ok(ShellCommand::Nothing);
    }
    let (name, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    let (first, others) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
    let Some((_, arguments, _)) = COMMANDS.iter().find(|(known, ..)| *known == name) else {
        let names = COMMANDS.map(|(name, ..)| name);
        let near = mdle_compiler::alphabet::did_you_mean(name, &names);
        let help = if near.is_empty() { "; `help` lists them" } else { "" };
        return Err(format!("there is no command `{name}`{near}{help}"));
    };
    let usage = || match *arguments {
        "" => Err(format!("`{name}` takes no arguments")),
        arguments => Err(format!("`{name}` is used as `{name} {arguments}`")),
    };
    let words = || rest.split_whitespace().map(str::to_owned).collect();
    let call =
        |path: &str, arguments| Ok(ShellCommand::Ask(path.to_owned(), Operation::Change(Change::Call(arguments))));
    let path = || path(first, here);
    match name {
        "pwd" | "pause" | "resume" | "quit" | "cancel" | "rollback" if !rest.is_empty() => usage(),
        "ls" | "cd" | "get" | "help" | "watch" | "unwatch" if !others.is_empty() => usage(),
        "get" | "call" | "set" | "pace" | "load_plan" | "swap" | "watch" | "unwatch" if first.is_empty() => usage(),
        "set" if others.trim().is_empty() => usage(),
        "ls" => Ok(ShellCommand::Ask(path(), Operation::List)),
        "cd" if first.is_empty() => Ok(ShellCommand::Enter("/".to_owned())),
        "cd" => Ok(ShellCommand::Enter(path())),
        "pwd" => Ok(ShellCommand::Here),
        "get" => Ok(ShellCommand::Ask(path(), Operation::Get)),
        "watch" | "unwatch" => Ok(ShellCommand::Ask(path(), Operation::Watch(name == "watch"))),
        "set" => Ok(ShellCommand::Ask(path(), Operation::Change(Change::Set(others.trim().to_owned())))),
        "call" => call(&path(), others.split_whitespace().map(str::to_owned).collect()),
        "help" => Ok(match COMMANDS.into_iter().find(|(known, ..)| *known == first) {
            Some(command) => ShellCommand::Explain(command),
            None => ShellCommand::Help((!first.is_empty()).then(path)),
        }),
        "pace" => Ok(ShellCommand::Ask("/clock/pace".to_owned(), Operation::Change(Change::Set(rest.to_owned())))),
        "quit" => Ok(ShellCommand::Quit),
        "swap" => Ok(ShellCommand::Swap(first.to_owned(), others.split_whitespace().map(str::to_owned).collect())),
        "load_plan" | "cancel" | "rollback" => call(&format!("/usr/mdle/{name}"), words()),
        other => call(&format!("/clock/{other}"), words()),
    }
}

/// Converts a path that was typed in the folder `here` to an absolute path.
fn path(typed: &str, here: &str) -> String {
    let from = if typed.starts_with('/') { "" } else { here };
    let mut parts: Vec<&str> = Vec::new();
    for part in from.split('/').chain(typed.split('/')) {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            name => parts.push(name),
        }
    }
    format!("/{}", parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_becomes_a_request() {
        let ask = |path: &str, operation| Ok(ShellCommand::Ask(path.to_owned(), operation));
        assert_eq!(command("  # nothing", "/"), Ok(ShellCommand::Nothing));
        assert_eq!(command("ls", "/usr"), ask("/usr", Operation::List));
        assert_eq!(command("get ../clock/./now", "/usr"), ask("/clock/now", Operation::Get));
        assert_eq!(command("cd ../../..", "/usr"), Ok(ShellCommand::Enter("/".to_owned())));
        let set = Operation::Change(Change::Set("a b".to_owned()));
        assert_eq!(command("set x\t a b ", "/"), ask("/x", set));
        let step = Operation::Change(Change::Call(vec!["3".to_owned()]));
        assert_eq!(command("step 3", "/"), ask("/clock/step", step));
    }

    #[test]
    fn a_wrong_line_is_refused_with_what_to_type() {
        let lines = ["fly", "sett x 1", "set", "set x", "get", "get a b", "pause now", "pace", "ls a b", "call"];
        insta::assert_snapshot!(lines.map(|line| command(line, "/").unwrap_err()).join("\n"), @"
        there is no command `fly`; `help` lists them
        there is no command `sett`; did you mean `set`?
        `set` is used as `set PATH VALUE`
        `set` is used as `set PATH VALUE`
        `get` is used as `get PATH`
        `get` is used as `get PATH`
        `pause` takes no arguments
        `pace` is used as `pace N|max`
        `ls` is used as `ls [PATH]`
        `call` is used as `call PATH [ARGUMENTS]`
        ");
    }
}
