//! A copy of this checkout in which mutants are built and tested. Its target folder is kept between runs.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the folder of the repository.
pub(crate) fn root() -> &'static Path {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).expect("the package lies two folders deep")
}

/// The copy of the checkout.
#[derive(Debug)]
pub(crate) struct Checkout {
    folder: PathBuf,
}

impl Checkout {
    /// Updates the copy so that it contains exactly the files that git tracks or would add.
    pub(crate) fn copy() -> Self {
        let this = std::env::current_exe().expect("a program has a path");
        // TARGET/PROFILE/mdle-mutants
        let folder = this.ancestors().nth(2).expect("a target folder").join("mutants");
        let checkout = Self { folder };
        let files: BTreeSet<PathBuf> = git(&["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
            .split('\0')
            .filter(|name| !name.is_empty() && root().join(name).is_file())
            .map(|name| checkout.sources().join(name))
            .collect();
        remove_others(&checkout.sources(), &files);
        for file in &files {
            let inside = file.strip_prefix(checkout.sources()).expect("a file of the copy");
            let wanted = fs::read(root().join(inside)).expect("a file of the checkout");
            // An unchanged file is not written, because cargo would rebuild it.
            if fs::read(file).ok().as_ref() != Some(&wanted) {
                fs::create_dir_all(file.parent().expect("a file is in a folder")).expect("a folder");
                fs::copy(root().join(inside), file).expect("a copy");
            }
        }
        checkout
    }

    /// Returns the folder of the copied files.
    pub(crate) fn sources(&self) -> PathBuf {
        self.folder.join("checkout")
    }

    /// Returns the folder of cargo's build results for the copied files.
    pub(crate) fn target(&self) -> PathBuf {
        self.folder.join("target")
    }

    /// Writes a file of the copy.
    pub(crate) fn write(&self, file: &str, text: &str) {
        fs::write(self.sources().join(file), text).expect("a file of the copy");
    }
}

/// Returns the output of git in this checkout.
pub(crate) fn git(arguments: &[&str]) -> String {
    let mut command = Command::new("git");
    // The checkout may belong to another user where tests run.
    command.args(["-c", "safe.directory=*"]).args(arguments).current_dir(root());
    let output = command.output().expect("git runs");
    assert!(output.status.success(), "git {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("names of files are UTF-8")
}

/// Removes all files below this folder except `files`.
fn remove_others(folder: &Path, files: &BTreeSet<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            remove_others(&path, files);
        } else if !files.contains(&path) {
            fs::remove_file(&path).expect("a file of the copy");
        }
    }
}
