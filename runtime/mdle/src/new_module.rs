//! `mdle new-module`: writes a crate that contains a new module, and a program `mdle` that uses the module. The files
//! come from `runtime/mdle/template`.

use std::fs;
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::failure::Failure;

/// Word in the template's files that is replaced by the module's name.
const NAME: &str = "template";
/// Maximum length of a name. File names contain this name, and every file system must accept them.
const LONGEST: usize = 32;
/// Names that are already used by other modules and packages of a program.
const TAKEN: [&str; 8] = ["mdle", "sensors", "heading", "test", "libm", "core", "std", "alloc"];
/// Keywords of Rust, which cannot be names of crates.
const WORDS: [&str; 38] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "pub", "ref", "return", "self", "static", "struct", "super", "trait",
];
/// Further keywords of Rust.
const FURTHER: [&str; 12] =
    ["true", "try", "type", "typeof", "union", "unsafe", "unsized", "use", "virtual", "where", "while", "yield"];

/// Files of the template.
const FILES: [(&str, &str); 5] = [
    ("Cargo.toml", include_str!("../template/package.toml")),
    ("src/lib.rs", include_str!("../template/lib.rs")),
    ("src/main.rs", include_str!("../template/main.rs")),
    ("plan.mdle", include_str!("../template/plan.mdle")),
    ("tests/run.rs", include_str!("../template/run.rs")),
];

/// The arguments of `mdle new-module`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct NewModule {
    /// Name of the module and of its folder.
    pub(crate) name: String,
    /// Path of a checkout of mdle; `None` for `../mdle`, relative to the new folder.
    pub(crate) checkout: Option<PathBuf>,
}

/// Writes the folder, either completely or not at all, and prints the next steps.
pub(crate) fn new_module(arguments: &NewModule) -> Result<ExitCode, Failure> {
    let name = arguments.name.as_str();
    must_be_free(name)?;
    let folder = Path::new(name);
    if folder.symlink_metadata().is_ok() {
        return Err(exists(name));
    }
    let sources = sources(arguments.checkout.as_deref())?;
    fs::create_dir(folder).map_err(|error| {
        let is_there = error.kind() == ErrorKind::AlreadyExists;
        if is_there { exists(name) } else { Failure::Usage(format!("the folder `{name}` cannot be made: {error}")) }
    })?;
    fill(folder, name, &sources).map_err(|error| {
        // Best effort: the cause is reported, even if the folder cannot be removed.
        let _ = fs::remove_dir_all(folder);
        Failure::Usage(format!("`{name}` cannot be written: {error}"))
    })?;
    let next = format!(
        "`{name}` is a program with all of `mdle` and a module `{name}`, which is in {name}/src/lib.rs\n\
         next: `cargo test` in {name}, and the page \"A module of your own\" of the book\n"
    );
    // If standard output is closed, the text cannot be shown anywhere.
    let _ = io::stdout().write_all(next.as_bytes());
    Ok(ExitCode::SUCCESS)
}

/// Returns the failure for a name that an existing file or folder already has.
fn exists(name: &str) -> Failure {
    Failure::Usage(format!("`{name}` exists already\nhelp: take another name, or go to another folder"))
}

/// Writes the files into an empty folder.
fn fill(folder: &Path, name: &str, sources: &Path) -> io::Result<()> {
    for inside in ["src", "tests"] {
        fs::create_dir(folder.join(inside))?;
    }
    FILES.iter().try_for_each(|(file, text)| fs::write(folder.join(file), named(file, text, name, sources)))
}

/// Returns the text of a template file with the module's name inserted. The manifest gets its own workspace instead of
/// mdle's, and no licence, because the author chooses the licence.
fn named(file: &str, text: &str, name: &str, sources: &Path) -> String {
    let text = text.replace(NAME, name);
    if file != "Cargo.toml" {
        return text;
    }
    let own = |package: &str, folder: &str| {
        let path = sources.join(folder).display().to_string();
        (format!("{package}.workspace = true"), format!("{package} = {{ path = {path:?} }}"))
    };
    let packages = [own("mdle", "runtime/mdle"), own("mdle-runtime", "runtime/core")];
    let text = text.replace("license.workspace = true\n", "").replace("libm.workspace = true", "libm = \"0.2\"");
    let text = text.replace("[lints]\nworkspace = true\n", "[workspace]\n");
    packages.iter().fold(text, |text, (ours, theirs)| text.replace(ours, theirs))
}

/// Returns the folder of a checkout of mdle in the form in which the manifest names it.
fn sources(checkout: Option<&Path>) -> Result<PathBuf, Failure> {
    let is_checkout = |folder: &Path| folder.join("runtime/mdle/Cargo.toml").is_file();
    let Some(checkout) = checkout else {
        // The new folder will be in the current one.
        let sentence =
            "there is no checkout of mdle in `../mdle` of the new folder\nhelp: `--checkout FOLDER` names one";
        let is_there = is_checkout(Path::new("mdle"));
        return is_there.then(|| PathBuf::from("../mdle")).ok_or_else(|| Failure::Usage(sentence.to_owned()));
    };
    let is_checkout = is_checkout(checkout);
    let folder = checkout.canonicalize().ok().filter(|folder| is_checkout && folder.to_str().is_some());
    folder.ok_or_else(|| {
        Failure::Usage(format!("`{}` is no checkout of mdle: it has no runtime/mdle", checkout.display()))
    })
}

/// Fails if `name` conflicts with a package, another module or a keyword of Rust.
fn must_be_free(name: &str) -> Result<(), Failure> {
    let refused = |sentence: &str, near: String| {
        Err(Failure::Usage(format!("`{name}` {sentence}\nhelp: `mdle new-module {near}`")))
    };
    if is_good(name) && is_taken(name) {
        return refused("is the name of something else", format!("my_{name}"));
    }
    if is_good(name) {
        return Ok(());
    }
    let sentence = format!(
        "cannot be the name of a module: write small letters, digits and `_`, a letter first, {LONGEST} at most"
    );
    refused(&sentence, near(name))
}

fn is_good(name: &str) -> bool {
    name.len() <= LONGEST
        && name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
}

fn is_taken(name: &str) -> bool {
    TAKEN.contains(&name) || WORDS.contains(&name) || FURTHER.contains(&name)
}

/// Proposes a valid name that resembles this one.
fn near(name: &str) -> String {
    let last = Path::new(name).file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let near: String = last.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if is_good(&near) && !is_taken(&near) { near } else { "ears".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_leaves_our_workspace() {
        let (_, ours) = FILES[0];
        let theirs = named("Cargo.toml", ours, "ears", Path::new("../mdle"));
        assert!(!theirs.contains("workspace ="), "{theirs}");
        assert!(theirs.contains("name = \"ears\"\n") && theirs.ends_with("\n[workspace]\n"), "{theirs}");
        assert!(theirs.contains("mdle-runtime = { path = \"../mdle/runtime/core\" }\n"), "{theirs}");
    }

    #[test]
    fn a_proposed_name_is_free() {
        for name in ["", "Ears", "2ears", "my ears", "../sensors", &"x".repeat(33), "é"] {
            assert!(!is_good(name) && is_good(&near(name)) && !is_taken(&near(name)), "{name}");
        }
    }
}
