//! Checks the files that options name. Only one option may name a file that a run writes, and the run must not read
//! this file.

use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use crate::Refusal;

/// Maximum number of symbolic links that are followed from a name.
const LINKS: usize = 40;

/// A file that an option names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedFile {
    /// Name of the option, such as `--log`.
    pub option: &'static str,
    /// Path of the file as given on the command line.
    pub path: PathBuf,
    /// `true` if the run writes the file, `false` if the run reads it.
    pub is_written: bool,
}

/// Identity of a file, independent of the path to it.
#[derive(Debug, PartialEq, Eq)]
enum Identity {
    /// An existing file, given by its device and its file number (inode) on the device.
    Known(u64, u64),
    /// A new file at this path.
    New(PathBuf),
}

/// Checks that no two options name the same file if the run writes it, and that the run does not write to this
/// program's own file.
///
/// # Errors
/// Returns a message for the operator that names the two options.
pub(crate) fn check(mut files: Vec<NamedFile>) -> Result<(), Refusal> {
    if let Ok(path) = std::env::current_exe() {
        files.push(NamedFile { option: "", path, is_written: false });
    }
    let known: Vec<_> = files.iter().map(|file| identity(&file.path)).collect();
    for (number, (file, own)) in files.iter().zip(&known).enumerate() {
        let (Some(own), true) = (own, file.is_written) else { continue };
        let same = files.iter().zip(&known).enumerate().find(|(other, (earlier, identity))| {
            *other != number && identity.as_ref() == Some(own) && (*other < number || !earlier.is_written)
        });
        if let Some((_, (other, _))) = same {
            return Err(Refusal::Usage(clash(file, other)));
        }
    }
    Ok(())
}

/// Returns the error message for the case that the file to write is the same file as `other`.
fn clash(file: &NamedFile, other: &NamedFile) -> String {
    let (option, path) = (file.option, file.path.display());
    match other {
        NamedFile { option: "", .. } => format!("{option} {path}: that is this program; name another file"),
        NamedFile { is_written: true, .. } => {
            format!("{option} {path}: {} writes the same file; name another one", other.option)
        }
        NamedFile { .. } => format!("{option} {path}: {} reads that file; name another one", other.option),
    }
}

/// Returns the identity of the file at a path; `None` if the identity is unknown, or if it is not a regular file (but a
/// device, for example).
fn identity(path: &Path) -> Option<Identity> {
    match fs::metadata(path) {
        Ok(found) => found.is_file().then(|| Identity::Known(found.dev(), found.ino())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let mut path = path.to_owned();
            for _ in 0..LINKS {
                let Ok(target) = fs::read_link(&path) else { break };
                // An absolute link target replaces the folder.
                path = path.with_file_name("").join(target);
            }
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            Some(Identity::New(fs::canonicalize(folder).ok()?.join(path.file_name()?)))
        }
        Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    /// Returns the error message for two output files with these names and an input file `input`, in a folder of the
    /// test; `None` if the files are accepted.
    fn refused(test: &str, log: &str, plot: &str) -> Option<String> {
        let folder = std::env::temp_dir().join(format!("mdle-files-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("sub")).unwrap();
        fs::write(folder.join("input"), "").unwrap();
        fs::write(folder.join("old"), "").unwrap();
        fs::hard_link(folder.join("old"), folder.join("hard")).unwrap();
        symlink("new", folder.join("dangling")).unwrap();
        symlink("input", folder.join("link")).unwrap();
        let file = |option, name: &str, is_written| NamedFile { option, path: folder.join(name), is_written };
        let files = vec![file("--log", log, true), file("--plot", plot, true), file("--world", "input", false)];
        let checked = check(files);
        let shown = format!("{}/", folder.display());
        fs::remove_dir_all(&folder).unwrap();
        let Err(Refusal::Usage(sentence)) = checked else { return None };
        Some(sentence.replace(&shown, ""))
    }

    #[test]
    fn an_output_is_a_file_of_its_own() {
        assert_eq!(refused("two", "new", "old"), None);
        let same = |plot: &str| Some(format!("--plot {plot}: --log writes the same file; name another one"));
        assert_eq!(refused("same", "new", "new"), same("new"));
        assert_eq!(refused("spelling", "new", "sub/../new"), same("sub/../new"));
        assert_eq!(refused("dangling", "new", "dangling"), same("dangling"));
        assert_eq!(refused("hard", "old", "hard"), same("hard"));
        // A device accepts several outputs.
        assert_eq!(refused("device", "/dev/null", "/dev/null"), None);
    }

    #[test]
    fn an_output_is_no_input_and_not_this_program() {
        let read = |name: &str| Some(format!("--log {name}: --world reads that file; name another one"));
        assert_eq!(refused("input", "input", "new"), read("input"));
        assert_eq!(refused("link", "link", "new"), read("link"));
        let this = std::env::current_exe().unwrap().display().to_string();
        let message = refused("program", &this, "new").unwrap();
        assert!(message.ends_with("that is this program; name another file"), "{message}");
    }
}
