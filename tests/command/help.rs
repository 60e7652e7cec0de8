//! Tests the texts of `--help`: each command and each option has a single line, which is an imperative for a command
//! and a noun phrase for an option.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::process::{Command, Output};

use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::root;

/// Commands of `mdlec`. The first one is `mdlec` without a command, which builds.
const COMMANDS: [&str; 20] = [
    "",
    "build",
    "run",
    "check",
    "fmt",
    "trace",
    "analyze",
    "draw",
    "decompile",
    "explain",
    "targets",
    "quarks",
    "bind",
    "new-target",
    "emulator",
    "lsp",
    "dap",
    "clean",
    "completions",
    "man",
];

/// Words with which a line must not begin, because they do not name its subject.
const OPENERS: [&str; 13] =
    ["What", "How", "Whether", "Where", "Which", "When", "Its", "The", "Says", "Lists", "Runs", "Finds", "Writes"];

/// Returns the help on standard output, and asserts that standard error is empty.
fn text(output: Output) -> String {
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the descriptions in a short help text, which are the right column of its lists of commands and options.
fn descriptions(help: &str) -> impl Iterator<Item = &str> {
    let lines = help
        .lines()
        .take_while(|line| *line != "Exit status:")
        .filter(|line| line.starts_with("  ") && !line.contains("Print help"));
    lines.filter_map(|line| line.trim_start().split_once("  ").map(|(_, text)| text.trim()))
}

fn assert_plain(help: &str) {
    let texts: Vec<_> = help.lines().take(1).chain(descriptions(help)).collect();
    assert!(texts.len() >= 2, "{help}");
    for text in texts {
        let first = text.split([' ', ',', ':']).next().unwrap();
        assert!(!OPENERS.contains(&first), "`{text}` begins with `{first}`");
        assert!(first.starts_with(char::is_uppercase) && !text.ends_with('.'), "`{text}`");
    }
}

#[test]
fn every_command_describes_itself_in_a_line() {
    let folder = folder("help");
    let mut shown = String::new();
    for command in COMMANDS {
        let arguments: Vec<_> = [command, "-h"].into_iter().filter(|word| !word.is_empty()).collect();
        let help = text(run_mdlec(&folder, &arguments));
        assert_plain(&help);
        writeln!(shown, "$ mdlec {}\n{help}", arguments.join(" ")).unwrap();
    }
    let listed = shown.split("Commands:\n").nth(1).unwrap().lines().take_while(|line| line.starts_with("  "));
    let listed: Vec<_> = listed.filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(listed.split_last(), Some((&"help", &COMMANDS[1..])));
    insta::assert_snapshot!(shown);
}

#[test]
fn shells_and_man_know_every_command() {
    let folder = folder("manual");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = text(run_mdlec(&folder, &["completions", shell]));
        assert!(COMMANDS.iter().all(|command| script.contains(command)) && script.contains("deny-warnings"), "{shell}");
    }
    fs::write(folder.join("mdlec.bash"), text(run_mdlec(&folder, &["completions", "bash"]))).unwrap();
    let typed = "COMP_WORDS=(mdlec co); COMP_CWORD=1; _mdlec mdlec co mdlec; echo ${COMPREPLY[@]}";
    let script = format!("source ./mdlec.bash; {typed}");
    let completed = Command::new("bash").args(["-c", &script]).current_dir(&folder).output().unwrap();
    assert_eq!(text(completed), "completions\n");
    let pages = ["", "decompile"].map(|command| {
        let arguments: Vec<_> = ["man", command].into_iter().filter(|word| !word.is_empty()).collect();
        text(run_mdlec(&folder, &arguments))
    });
    assert!(pages.iter().all(|page| page.starts_with(".ie ") && page.contains(".TH mdlec")), "{}", &pages[1][..300]);
    let source = format!("\"mdlec {}\"", env!("CARGO_PKG_VERSION"));
    assert!(pages.iter().all(|page| page.lines().nth(2).unwrap().contains(&source)), "{source}");
    assert!(COMMANDS[1..].iter().all(|command| pages[0].replace('\\', "").contains(&format!("mdlec-{command}(1)"))));
    assert!(pages[1].replace('\\', "").contains("--augment"));
}

#[test]
fn unknown_shells_and_commands_are_refused() {
    let folder = folder("manual_unknown");
    let refused =
        [&["completions", "tcsh"][..], &["man", "decompil"], &["--color", "blue", "targets"]].map(|arguments| {
            let output = run_mdlec(&folder, arguments);
            assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]));
            format!("$ mdlec {}\n{}", arguments.join(" "), String::from_utf8(output.stderr).unwrap())
        });
    insta::assert_snapshot!(refused.join("\n"));
}

#[test]
fn color_decides_about_messages_and_help() {
    let folder = folder("color");
    fs::write(folder.join("plan.mdle"), "{ P (bumpr) (Atom (wait 1) stop) }\n").unwrap();
    for (color, is_colored) in [("always", true), ("auto", false), ("never", false)] {
        for arguments in [&["check", "plan.mdle"][..], &["check"], &["--help"]] {
            let output = run_mdlec(&folder, &[arguments, &["--color", color]].concat());
            let all = [output.stdout, output.stderr].concat();
            assert_eq!(all.contains(&0x1b), is_colored, "{color} {arguments:?}: {}", String::from_utf8_lossy(&all));
        }
    }
}

#[test]
fn long_help_has_examples_and_exit_statuses() {
    let help = text(run_mdlec(&folder("long_help"), &["--help"]));
    insta::assert_snapshot!(help);
}

#[test]
fn executables_describe_their_options_in_a_line() {
    let folder = folder("help_of_executables");
    fs::write(folder.join("rest.mdle"), "{ Rest (Atom (wait 1ms) stop) }\n").unwrap();
    let mut shown = String::new();
    for robot in ["sim", "scout"] {
        let built = run_mdlec(&folder, &["rest.mdle", "--target", robot, "-o", robot]);
        assert_eq!(built.status.code(), Some(0), "{}", String::from_utf8_lossy(&built.stderr));
        for option in ["-h", "--help"] {
            let help = text(Command::new(folder.join(robot)).arg(option).output().unwrap());
            writeln!(shown, "$ ./{robot} {option}\n{help}").unwrap();
            if option == "-h" {
                assert_plain(&help);
            }
        }
    }
    insta::assert_snapshot!(shown);
}

/// Returns the options of an executable as its help lists them, with the placeholders of their values.
fn options_of(help: &str) -> String {
    let lines =
        help.lines().filter_map(|line| line.trim_start().split_once("--").filter(|(before, _)| before.len() < 5));
    let options = lines.map(|(_, option)| option.split("  ").next().unwrap_or_default());
    let options = options.filter(|option| !["help", "version"].contains(option)).map(|option| format!("{option}\n"));
    format!(
        "# Options of an executable for this robot, as its help lists them; checked by tests/command/help.rs.\n{}",
        options.collect::<String>()
    )
}

#[test]
fn listed_options_are_those_of_executables() {
    let folder = folder("listed_options");
    fs::write(folder.join("rest.mdle"), "{ Rest (Atom (wait 1ms) stop) }\n").unwrap();
    for robot in ["sim", "scout", "atrv"] {
        let built = run_mdlec(&folder, &["rest.mdle", "--target", robot, "-o", robot]);
        assert_eq!(built.status.code(), Some(0), "{}", String::from_utf8_lossy(&built.stderr));
        let options = options_of(&text(Command::new(folder.join(robot)).arg("-h").output().unwrap()));
        assert!(options.lines().count() > 5, "{options}");
        let list = root().join(format!("targets/{robot}/options.txt"));
        if std::env::var("INSTA_UPDATE").as_deref() == Ok("always") {
            fs::write(&list, &options).unwrap();
        }
        let listed = fs::read_to_string(&list).unwrap_or_default();
        assert_eq!(listed, options, "INSTA_UPDATE=always writes {}", list.display());
    }
}

#[test]
fn a_version_names_what_was_built() {
    let folder = folder("version");
    let version = |plan: &str, texts: [&str; 2]| {
        let place = folder.join(plan);
        fs::create_dir_all(&place).unwrap();
        fs::write(place.join("plan.mdle"), texts[0]).unwrap();
        fs::write(place.join("legs.mdle"), texts[1]).unwrap();
        let built = run_mdlec(&place, &["plan.mdle", "--target", "sim", "-o", "plan"]);
        assert_eq!(built.status.code(), Some(0), "{}", String::from_utf8_lossy(&built.stderr));
        text(Command::new(place.join("plan")).arg("--version").output().unwrap())
    };
    let texts = ["use \"legs.mdle\"\n{ Rest Legs }\n", "{ Legs (Atom (wait 1ms) stop) }\n"];
    let first = version("first", texts);
    let words: Vec<_> = first.split_whitespace().collect();
    let ["Rest", "(text", own, "target", "sim,", "alphabet", alphabet, "mdlec", compiler, rest @ ..] = &*words else {
        panic!("{first}")
    };
    assert_eq!((own.len(), alphabet.len(), *compiler), (13, 13, "0.2.0,"));
    let ["code", code, "rustc", release] = rest else { panic!("{first}") };
    assert!(code.len() == 13 && release.starts_with("1."), "{first}");
    assert_eq!(version("second", texts), first);
    let used = version("third", [texts[0], "{ Legs (Atom (wait 2ms) stop) }\n"]);
    assert!(
        used != first && used.contains(&first[first.find(", target").unwrap()..first.find(", code").unwrap()]),
        "{used}"
    );
}
