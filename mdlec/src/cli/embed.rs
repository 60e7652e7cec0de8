//! Embeds a plan for a build script: writes Rust to cargo's output folder, and names the files that cargo must watch.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::build::{Emitted, emitted, needs_target};
use super::{Color, Failure, MessageFormat, executable, input, report};
use crate::link;

/// Writes `$OUT_DIR/STEM.rs`, and prints warnings and the files that were read, for cargo. Fails with the exit status,
/// after the message was printed on standard error.
pub(crate) fn embed(file: &Path, target: Option<&str>, plan: Option<&str>) -> Result<(), u8> {
    report::choose(MessageFormat::BuildScript, Color::Auto);
    write(file, target, plan).map_err(|failure| failure.told())
}

fn write(file: &Path, target: Option<&str>, plan: Option<&str>) -> Result<(), Failure> {
    let Some(folder) = env::var_os("OUT_DIR") else {
        return Err(Failure::usage(
            "the variable OUT_DIR is not set: plans are embedded by the build script of a package",
        ));
    };
    needs_target(target.is_some())?;
    let Emitted { target, input, rust, .. } = emitted(file, input::target(target)?, plan, false)?;
    let inputs = input.inputs(&target);
    // The alphabets that came with mdlec change with it, and then cargo runs the build script again in any case.
    let watched = inputs.iter().map(|file| watched(file)).collect::<Result<String, _>>()?;
    let mut name = OsString::from(file.file_stem().unwrap_or_default());
    name.push(".rs");
    let output = PathBuf::from(folder).join(name);
    link::write_whole(&output, rust.as_bytes(), &inputs).map_err(|error| executable::failure(&error))?;
    report::print_exactly(&watched)
}

/// Line that makes cargo watch `file`. Cargo would read text after a line break as another instruction.
fn watched(file: &Path) -> Result<String, Failure> {
    let line = format!("cargo::rerun-if-changed={}", file.display());
    if line.contains(['\n', '\r']) {
        return Err(Failure::usage(format!(
            "the name {file:?} holds a line break, so cargo cannot watch this file\nhelp: rename the file or its folder"
        )));
    }
    Ok(line + "\n")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::watched;

    #[test]
    fn a_name_with_a_line_break_is_refused() {
        assert_eq!(watched(Path::new("plans/round 1.mdle")).unwrap(), "cargo::rerun-if-changed=plans/round 1.mdle\n");
        for name in ["a\ncargo::rustc-link-arg=b", "a\r\nb"] {
            let refusal = watched(Path::new(name)).unwrap_err();
            assert_eq!(refusal.status, 2);
            assert!(refusal.message.unwrap().contains("holds a line break"));
        }
    }
}
