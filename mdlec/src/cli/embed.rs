//! A plan for a build script: its Rust where cargo wants what a build makes, and the files that cargo is to watch.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::build::{self, Emitted, emitted};
use super::{Failure, MessageFormat, report};
use crate::link;

/// Writes `$OUT_DIR/STEM.rs` and tells cargo of warnings and of the files that were read. The exit status, if that is not
/// done; why not was said on standard error then.
pub(crate) fn embed(file: &Path, target: Option<&str>, plan: Option<&str>) -> Result<(), u8> {
    report::choose(MessageFormat::BuildScript);
    write(file, target, plan).map_err(|failure| failure.told())
}

fn write(file: &Path, target: Option<&str>, plan: Option<&str>) -> Result<(), Failure> {
    let Some(folder) = env::var_os("OUT_DIR") else {
        return Err(Failure::usage(
            "the variable OUT_DIR is not set: plans are embedded by the build script of a package",
        ));
    };
    let Emitted { target, input, rust, .. } = emitted(file, target, plan, false)?;
    let mut name = OsString::from(file.file_stem().unwrap_or_default());
    name.push(".rs");
    link::write_whole(&PathBuf::from(folder).join(name), rust.as_bytes()).map_err(|error| build::failure(&error))?;
    // The alphabets that came with mdlec change with it, and then cargo runs the build script again in any case.
    let of_target =
        target.folder.iter().flat_map(|folder| ["alphabet.mdle", "src/alphabet.rs"].map(|file| folder.join(file)));
    let read = input.files().map(Path::to_owned).chain(of_target);
    report::print_exactly(&read.map(|file| format!("cargo::rerun-if-changed={}\n", file.display())).collect::<String>())
}
