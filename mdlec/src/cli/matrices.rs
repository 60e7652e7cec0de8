//! `mdlec PLAN --emit matrices`: prints matrices in the paper's notation, or writes MatrixMarket files into a folder.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::{CommandFailure, report};
use crate::link;
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::diagnostic::{Code, Diagnostic};
use mdle_compiler::plan::Nondegenerate;
use mdle_theory::equations::{self, MatrixFiles};

/// Prints the matrices, or writes them into a folder without overwriting any of `inputs`. Only small matrices are
/// printed. Files may contain at most ten million ones in total.
pub(super) fn matrices(
    plan: &Nondegenerate,
    combined: bool,
    folder: Option<&Path>,
    sources: &Sources,
    inputs: &[PathBuf],
) -> Result<(), CommandFailure> {
    let refused = |found: Diagnostic| {
        report::diagnostics(sources, &[found], false);
        CommandFailure::PLAN
    };
    let terms = equations::terms(plan, combined).map_err(refused)?;
    let Some(folder) = folder else {
        let text = equations::equation(&terms).ok_or_else(|| {
            CommandFailure::usage(format!(
                "this plan has {} states, and matrices of more than {} are not for a terminal\nhelp: have them written as \
                 MatrixMarket files into a folder: `--emit matrices=FOLDER`; `--emit fsm` lists only the transitions",
                terms.states(),
                equations::most_states(),
            ))
        })?;
        return report::print(&text);
    };
    let files = equations::matrix_files(&terms).map_err(|(ones, most)| {
        let root = plan.plan().root.span;
        let message =
            format!("the {} matrices of this plan have {ones} ones; written are at most {most}", terms.live.len());
        let help = "`--combine` makes one matrix of equal interrupts, and `--emit fsm` lists only the transitions";
        refused(Diagnostic::new(Code::E0502, message, root, "this plan").help(help))
    })?;
    let count = write(&files, folder, inputs)?;
    report::note(format_args!(
        "{count} {} of {} states as MatrixMarket files in `{}`; `{}` says which interrupt each belongs to",
        if count == 1 { "matrix" } else { "matrices" },
        terms.states(),
        folder.display(),
        MatrixFiles::LIST,
    ));
    Ok(())
}

/// Writes the matrix files and then their list, and returns the number of matrices. If the folder contains an earlier
/// list, its matrix files are removed first.
fn write(files: &MatrixFiles<'_, '_>, folder: &Path, inputs: &[PathBuf]) -> Result<usize, CommandFailure> {
    let failed = |error: io::Error| CommandFailure::usage(format!("`{}` cannot be written: {error}", folder.display()));
    fs::create_dir_all(folder).map_err(failed)?;
    let old = matrix_files_in(folder).map_err(failed)?;
    let list = folder.join(MatrixFiles::LIST);
    let lost = old.iter().chain([&list]).try_for_each(|file| link::must_not_be_read(file, inputs));
    lost?;
    if list.exists() {
        old.iter().try_for_each(fs::remove_file).map_err(failed)?;
    }
    let put = |name: &str, text: &str| {
        link::write_whole(&folder.join(name), text.as_bytes(), inputs).map_err(CommandFailure::from)
    };
    let mut count = 0;
    for (name, text) in files.files() {
        put(&name, &text)?;
        count += 1;
    }
    put(MatrixFiles::LIST, &files.list())?;
    Ok(count)
}

/// Returns the files in a folder that have names of matrix files. They are removed before new files are written,
/// because files of an earlier plan could be mistaken for files of this plan.
fn matrix_files_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let stem = name.to_str().and_then(|name| name.strip_suffix(".mtx"));
        let is_number = |digits: &str| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        if stem.is_some_and(|stem| stem == "completed" || stem.strip_prefix('x').is_some_and(is_number)) {
            files.push(entry.path());
        }
    }
    Ok(files)
}
