//! `mdlec new-target`: creates a folder with a new robot from `targets/template`.

use std::fs;
use std::io;
use std::path::Path;

use super::{Bind, CommandFailure, NewTarget, bind, report};
use mdle_compiler::builtin;

/// Word in the template's files that the robot's name replaces.
const NAME: &str = "template";

/// Maximum length of a name, so that every file system accepts files that contain it.
const LONGEST: usize = 32;

/// Files of the template, except `src/alphabet.rs`, which `bind` writes.
const FILES: [(&str, &str); 6] = [
    ("Cargo.toml", include_str!("../../template/package.toml")),
    ("alphabet.mdle", include_str!("../../template/alphabet.txt")),
    ("src/lib.rs", include_str!("../../template/lib.rs")),
    ("src/hardware.rs", include_str!("../../template/hardware.rs")),
    ("src/quarks.rs", include_str!("../../template/quarks.rs")),
    ("tests/conformance.rs", include_str!("../../template/conformance.rs")),
];

/// Writes the folder of a new robot, completely or not at all, and prints the next steps.
pub(super) fn new_target(options: &NewTarget) -> Result<(), CommandFailure> {
    let name = options.name.as_str();
    must_be_free(name)?;
    let folder = Path::new(name);
    fs::create_dir(folder).map_err(|error| {
        if error.kind() == io::ErrorKind::AlreadyExists {
            CommandFailure::usage(format!(
                "`{name}` is there already\nhelp: take another name, or go to another folder"
            ))
        } else {
            CommandFailure::usage(format!("the folder `{name}` cannot be made: {error}"))
        }
    })?;
    fill(folder, name).inspect_err(|_| {
        // The original error is more helpful than an error of this removal.
        let _ = fs::remove_dir_all(folder);
    })?;
    report::note(format_args!(
        "`{name}` is a robot that can already run plans: it is simulated in {name}/src/hardware.rs, where your driver goes\n\
         next: `mdlec PLAN --target {name}`, and the page \"Add your robot\" of the book"
    ));
    Ok(())
}

/// Writes the files of a new robot into an empty folder.
fn fill(folder: &Path, name: &str) -> Result<(), CommandFailure> {
    let refused = |error| CommandFailure::usage(format!("`{name}` cannot be written: {error}"));
    for inside in ["src", "tests"] {
        fs::create_dir(folder.join(inside)).map_err(refused)?;
    }
    for (file, text) in FILES {
        fs::write(folder.join(file), named(file, text, name)).map_err(refused)?;
    }
    bind::bind(&Bind { alphabet: folder.join("alphabet.mdle"), check: false })
}

/// Returns the text of a template's file for a robot with this name. The package of the robot is not part of mdlec's
/// workspace, but has a workspace of its own, so that it can be built in any folder. Its manifest names no licence,
/// because the author of the robot chooses it.
fn named(file: &str, text: &str, name: &str) -> String {
    let text = text.replace(NAME, name);
    if file != "Cargo.toml" {
        return text;
    }
    const VERSION: &str = concat!(" = \"", env!("CARGO_PKG_VERSION"), "\"");
    let text = text.replace("license.workspace = true\n", "");
    let text = text.replace("[lints]\nworkspace = true\n", "[workspace]\n").replace(".workspace = true", VERSION);
    // A dependency that also selects features.
    text.replace("{ workspace = true", &format!("{{ version{VERSION}"))
}

/// Fails if the name conflicts with a package, a file or a word that has a special meaning for `--target`.
fn must_be_free(name: &str) -> Result<(), CommandFailure> {
    if is_taken(name) {
        return Err(CommandFailure::usage(format!(
            "`{name}` is a word that `--target` knows already\nhelp: take another name, such as `my_{name}`"
        )));
    }
    if is_good(name) {
        return Ok(());
    }
    let near = near(name);
    Err(CommandFailure::usage(format!(
        "`{name}` cannot be the name of a robot: write small letters, digits and `_`, a letter first, {LONGEST} at most\n\
         help: `mdlec new-target {near}`"
    )))
}

fn is_good(name: &str) -> bool {
    name.len() <= LONGEST
        && name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
}

fn is_taken(name: &str) -> bool {
    name == "all" || builtin::alphabets().iter().any(|alphabet| alphabet.name == name)
}

/// Returns a valid name that resembles `name`, or `rover` if there is none.
fn near(name: &str) -> String {
    let last = Path::new(name).file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let near: String = last.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if is_good(&near) && !is_taken(&near) { near } else { "rover".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::{is_good, named, near};

    #[test]
    fn a_name_is_good_for_a_package_and_a_file() {
        for name in ["rover", "r2_d2", "a", "fn", &"x".repeat(32)] {
            assert!(is_good(name), "{name}");
        }
        for name in ["", "Rover", "2wheels", "_rover", "my-rover", "my rover", "../rover", "größe", &"x".repeat(33)] {
            assert!(!is_good(name) && is_good(&near(name)), "{name}");
        }
        assert_eq!(["My-Rover", "../rover/", "2wheels", "x/Sim"].map(near), ["my_rover", "rover", "rover", "rover"]);
    }

    #[test]
    fn a_manifest_leaves_our_workspace() {
        let ours = "name = \"template-target\"\nlicense.workspace = true\n\n[dependencies]\n\
                    mdle-host.workspace = true\nmdle-atoms = { workspace = true, features = [\"a\"] }\n\n[lints]\nworkspace = true\n";
        let theirs = concat!(
            "name = \"rover-target\"\n\n[dependencies]\nmdle-host = \"",
            env!("CARGO_PKG_VERSION"),
            "\"\nmdle-atoms = { version = \"",
            env!("CARGO_PKG_VERSION"),
            "\", features = [\"a\"] }\n\n[workspace]\n"
        );
        assert_eq!(named("Cargo.toml", ours, "rover"), theirs);
    }
}
