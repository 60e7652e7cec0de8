//! Generates the parser from its grammar, and a table of the alphabets that are built into mdlec.

#![allow(clippy::disallowed_methods, reason = "what is done here is I/O")]

#[path = "build/targets.rs"]
mod targets;

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    // Once a build script names a file to watch, as `alphabets` does, Cargo no longer watches the whole package by
    // itself.
    for watched in ["src", "build.rs", "build/targets.rs"] {
        println!("cargo::rerun-if-changed={watched}");
    }
    lalrpop::process_src()?;
    alphabets()
}

/// Writes `$OUT_DIR/alphabets.rs`, which `src/builtin.rs` includes. The file contains the shared alphabet, and then the
/// alphabets of the targets.
fn alphabets() -> Result<(), Box<dyn Error>> {
    let root = targets::checkout("../..")?;
    println!("cargo::rerun-if-changed={}", root.join("targets").display());
    let names = targets::targets(&root)?.into_iter().map(|name| (format!("targets/{name}/alphabet.mdle"), name, true));
    let shared = ("atoms/alphabet.mdle".to_owned(), "atoms".to_owned(), false);
    let mut rust = "static ALPHABETS: &[Alphabet] = &[\n".to_owned();
    for (file, name, target) in [shared].into_iter().chain(names) {
        let path = root.join(&file);
        println!("cargo::rerun-if-changed={}", path.display());
        let path = path.to_str().ok_or_else(|| format!("{path:?} is not UTF-8"))?;
        writeln!(
            rust,
            "    Alphabet {{ name: {name:?}, file: {file:?}, text: include_str!({path:?}), target: {target} }},"
        )?;
    }
    rust.push_str("];\n");
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("alphabets.rs"), rust)?;
    Ok(())
}
