//! Checks the extensions of output files before any input is read, refuses extensions of formats that the command does
//! not write, and names the output file that no option names.

use std::path::{Path, PathBuf};

use super::{CommandFailure, EmitKind};

/// Extensions of picture files.
const PICTURES: [&str; 12] = ["svg", "png", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "pdf", "ps", "eps"];

/// Refuses a file name for the picture of `mdlec draw` if it has an extension other than `.svg`.
pub(super) fn svg(file: &Path) -> Result<(), CommandFailure> {
    let Some(given) = file.extension().filter(|given| !given.eq_ignore_ascii_case("svg")) else { return Ok(()) };
    let (shown, name) = (file.display(), file.with_extension("svg"));
    Err(CommandFailure::usage(format!(
        "`{shown}`: `mdlec draw` writes SVG, not {}\nhelp: name the file `{}`",
        given.to_string_lossy().to_uppercase(),
        name.display()
    )))
}

/// Refuses the extension of a picture file for an executable or for a form of `plan`, because none of these is a
/// picture file.
pub(super) fn no_picture(file: &Path, kind: EmitKind, plan: &Path) -> Result<(), CommandFailure> {
    let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if !PICTURES.iter().any(|picture| ending.eq_ignore_ascii_case(picture)) {
        return Ok(());
    }
    let written = match kind {
        EmitKind::Exe => "an executable",
        EmitKind::Dot => "text for Graphviz",
        EmitKind::Mermaid => "text for mermaid",
        EmitKind::Matrices => "a folder of MatrixMarket files",
        EmitKind::Tree
        | EmitKind::Plan
        | EmitKind::Nondegenerate
        | EmitKind::Expanded
        | EmitKind::Fsm
        | EmitKind::Scxml
        | EmitKind::Formal
        | EmitKind::Projected
        | EmitKind::Rust => "text",
    };
    let picture: PathBuf = file.with_extension("svg");
    Err(CommandFailure::usage(format!(
        "`{}`: this command writes {written}, not a picture\nhelp: `mdlec draw {} -o {}` draws the plan",
        file.display(),
        plan.display(),
        picture.display()
    )))
}

/// Returns the default path of a plan's executable: the file name of the plan without its extension. Standard input has
/// no file name, so the executable gets the name of the plan.
pub(super) fn default_output(path: &Path, plan_name: &str) -> PathBuf {
    path.file_stem().filter(|stem| *stem != "-").map_or_else(|| PathBuf::from(plan_name), PathBuf::from)
}
