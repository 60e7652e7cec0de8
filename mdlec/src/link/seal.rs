//! Checks the hashes of everything that builds use from the cache: libraries, procedural macros, build scripts and
//! their output.
//!
//! Cargo compares only the times of files. This module keeps a list of all compiled files with the hashes of their
//! contents. Before cargo runs, each file that is not listed or does not match its hash is removed, so that cargo
//! compiles it again. The list reveals damage, and files that other users added while they had access to the folder. It
//! does not stop an attacker who can write to the cache, because the list itself is in the cache. The permissions of
//! the cache prevent others from writing to it.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use super::cache::{remove, write_if_changed};
use super::hash::hash;
use super::{BuildStep, Cache, LinkError};

/// Name of the list in the cache.
const LIST: &str = "compiled";

/// The files that cargo has compiled, with their hashes.
#[derive(Debug)]
pub(super) struct Seal {
    /// Folder to which paths in the list are relative.
    target: PathBuf,
    list: PathBuf,
    hashes: BTreeMap<String, String>,
}

impl Seal {
    /// Reads the list of compiled files and their hashes from the cache. Removes each compiled file that is not listed
    /// or has a different hash, so that cargo compiles it again. Must be called with the cache locked.
    pub(super) fn check(cache: &Cache, progress: &mut dyn FnMut(BuildStep)) -> Result<Self, LinkError> {
        let (target, list) = (cache.target(), cache.folder().join(LIST));
        let text = fs::read_to_string(&list).unwrap_or_default();
        // A file that was compiled again is listed again: its last line counts.
        let lines = text.lines().filter_map(|line| line.split_once(' '));
        let hashes = lines.map(|(hash, path)| (path.to_owned(), hash.to_owned())).collect();
        let mut seal = Self { target, list, hashes };

        // A symbolic link would lead out of the cache.
        if seal.target.is_symlink() {
            remove(&seal.target)?;
        }
        let mut files = Vec::new();
        taken(&seal.target, false, &mut files).map_err(|error| LinkError::cache(&seal.target, error))?;
        let (good, bad): (Vec<_>, Vec<_>) = files.iter().zip(seal.fit(&files)).partition(|(_, fits)| *fits);
        // Files that an interrupted build compiled are not listed, and are not damage.
        if bad.iter().any(|(file, _)| seal.listed(file).is_some()) {
            progress(BuildStep::Discarding);
        }
        bad.iter().try_for_each(|(file, _)| remove(file))?;
        let good = good.iter().filter_map(|(file, _)| Some((seal.name(file)?.to_owned(), seal.listed(file)?.clone())));
        seal.hashes = good.collect();
        let text: String = seal.hashes.iter().map(|(path, hash)| format!("{hash} {path}\n")).collect();
        write_if_changed(&seal.list, text.as_bytes())?;
        Ok(seal)
    }

    /// Records the hashes of `files` in the list. If `fresh` is `true`, cargo has found the files already compiled. In
    /// this case, files that are already listed keep their hashes.
    pub(super) fn add(&mut self, files: &[PathBuf], fresh: bool) {
        let new = files.iter().filter(|file| !fresh || self.listed(file).is_none());
        let lines: Vec<_> = new.filter_map(|file| Some((self.name(file)?.to_owned(), hash_of(file)?))).collect();
        let text: String = lines.iter().map(|(path, hash)| format!("{hash} {path}\n")).collect();
        // A file that cannot be listed is compiled again in the next build.
        let _ = File::options()
            .create(true)
            .append(true)
            .open(&self.list)
            .and_then(|mut list| list.write_all(text.as_bytes()));
        self.hashes.extend(lines);
    }

    /// Records in the list the files in the folder of a build script: the script under both of its names, or its
    /// output.
    pub(super) fn add_script(&mut self, inside: &Path, fresh: bool) {
        let mut files = Vec::new();
        // A file that cannot be read is compiled again in the next build.
        let _ = taken(inside.parent().unwrap_or(inside), false, &mut files);
        self.add(&files, fresh);
    }

    /// Returns, for each file, `true` if it is listed and unchanged.
    fn fit(&self, files: &[PathBuf]) -> Vec<bool> {
        let next = AtomicUsize::new(0);
        let work = || {
            let mut fitting = Vec::new();
            while let Some((index, file)) =
                Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, files.get(i)?)))
            {
                let fits =
                    !file.is_symlink() && self.listed(file).is_some_and(|hash| hash_of(file).as_ref() == Some(hash));
                fitting.extend(fits.then_some(index));
            }
            fitting
        };
        let mut fits = vec![false; files.len()];
        thread::scope(|scope| {
            let workers: Vec<_> = (0..workers()).map(|_| scope.spawn(work)).collect();
            for index in workers.into_iter().filter_map(|worker| worker.join().ok()).flatten() {
                fits[index] = true;
            }
        });
        fits
    }

    /// Returns the listed hash of a file.
    fn listed(&self, file: &Path) -> Option<&String> {
        self.hashes.get(self.name(file)?)
    }

    /// Returns the name of a file in the list; `None` if the file cannot be in the list.
    fn name<'f>(&self, file: &'f Path) -> Option<&'f str> {
        file.strip_prefix(&self.target).ok()?.to_str().filter(|name| !name.contains('\n'))
    }
}

fn hash_of(file: &Path) -> Option<String> {
    fs::read(file).ok().map(|bytes| hash(&bytes))
}

/// Returns the number of threads that read files: at most 4, which is enough to read at the speed of memory.
fn workers() -> usize {
    thread::available_parallelism().map_or(1, |all| all.get().min(4))
}

/// Adds to `files` all symbolic links below `folder` and all files that a build uses; if `all` is `true`, adds every
/// file.
fn taken(folder: &Path, all: bool, files: &mut Vec<PathBuf>) -> io::Result<()> {
    let entries = match fs::read_dir(folder) {
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => return Ok(()),
        entries => entries?,
    };
    for entry in entries {
        let entry = entry?;
        let (kind, path, name) = (entry.file_type()?, entry.path(), entry.file_name());
        if kind.is_dir() {
            // Cargo's fingerprint files have the same names as build scripts.
            if name != ".fingerprint" {
                taken(&path, all || name == "out", files)?;
            }
        } else if all || kind.is_symlink() || is_taken(&path, &name) {
            files.push(path);
        }
    }
    Ok(())
}

/// Returns `true` for a library, for a procedural macro, for a build script under either of its names, and for the
/// output of a build script with its instructions to cargo.
fn is_taken(path: &Path, name: &OsStr) -> bool {
    let extension = path.extension().and_then(OsStr::to_str);
    let is_library = extension.is_some_and(|extension| matches!(extension, "rlib" | "rmeta" | "so" | "a"));
    let starts = |start: &str| name.as_encoded_bytes().starts_with(start.as_bytes());
    let is_script = extension.is_none() && (starts("build-script-") || starts("build_script_"));
    is_library || is_script || name == "output"
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::super::Cache;
    use super::super::tests::cache;
    use super::{BuildStep, Seal};

    /// Creates a cache with files such as cargo writes, and records all of them in the list.
    fn sealed(test: &str) -> (Cache, [PathBuf; 4]) {
        let cache = cache(test);
        let names = ["deps/liba-1.rlib", "deps/libb-2.so", "build/c-3/build-script-build", "build/c-4/output"];
        let files = names.map(|name| cache.target().join("release").join(name));
        for file in &files {
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, file.as_os_str().as_encoded_bytes()).unwrap();
        }
        fs::create_dir_all(cache.target().join("release/build/c-4/out/deep")).unwrap();
        fs::write(cache.target().join("release/build/c-4/out/deep/table.rs"), "table").unwrap();
        let mut seal = Seal::check(&Cache::at(&cache.folder().join("elsewhere")).unwrap(), &mut |_| {}).unwrap();
        (seal.target, seal.list) = (cache.target(), cache.folder().join("compiled"));
        seal.add(&files[..3], false);
        seal.add_script(&cache.target().join("release/build/c-4/out"), false);
        (cache, files)
    }

    /// Checks the cache, and returns `true` if a file differs.
    fn differs(cache: &Cache) -> bool {
        let mut progress = Vec::new();
        Seal::check(cache, &mut |step| progress.push(step)).unwrap();
        !progress.is_empty()
    }

    #[test]
    fn what_is_as_it_was_compiled_stays() {
        let (cache, files) = sealed("seal_good");
        assert!(!differs(&cache) && !differs(&cache));
        assert!(files.iter().all(|file| file.exists()));
        assert!(cache.target().join("release/build/c-4/out/deep/table.rs").exists());
    }

    #[test]
    fn what_differs_is_removed() {
        let (cache, files) = sealed("seal_differs");
        let written = cache.target().join("release/build/c-4/out/deep/table.rs");
        for file in files.iter().chain([&written]) {
            fs::write(file, "strange").unwrap();
            assert!(differs(&cache), "{}", file.display());
            assert!(!file.exists() && !differs(&cache), "{}", file.display());
        }
    }

    #[test]
    fn what_is_not_listed_is_removed() {
        let (cache, files) = sealed("seal_unlisted");
        let folder = files[0].parent().unwrap();
        let link = |name: &str, to: &Path| std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
        fs::write(folder.join("libstrange-5.rlib"), "strange").unwrap();
        fs::write(folder.join("liba-1.d"), "times").unwrap();
        let note = cache.target().join("release/.fingerprint/c-3/build-script-build-script-build");
        fs::create_dir_all(note.parent().unwrap()).unwrap();
        fs::write(&note, "cargo's").unwrap();
        link("anywhere", cache.folder());
        assert!(!differs(&cache), "a build that was stopped leaves such files");
        assert!(!folder.join("libstrange-5.rlib").exists() && !folder.join("anywhere").is_symlink());
        assert!(folder.join("liba-1.d").exists() && note.exists() && cache.folder().exists());
        // A symbolic link to the same contents is rejected.
        fs::rename(&files[0], cache.folder().join("moved")).unwrap();
        link("liba-1.rlib", &cache.folder().join("moved"));
        assert!(differs(&cache) && !files[0].is_symlink() && cache.folder().join("moved").exists());
        fs::rename(cache.target(), cache.folder().join("elsewhere/target")).unwrap();
        std::os::unix::fs::symlink("elsewhere/target", cache.target()).unwrap();
        assert!(!differs(&cache) && !cache.target().exists() && cache.folder().join("elsewhere/target").exists());
    }

    #[test]
    fn a_list_that_is_damaged_trusts_nothing() {
        let (cache, files) = sealed("seal_list");
        fs::write(cache.folder().join("compiled"), "garbage\n\u{FFFD} \n").unwrap();
        assert!(!differs(&cache));
        assert!(files.iter().all(|file| !file.exists()));
    }

    #[test]
    fn a_file_that_was_compiled_again_has_its_new_hash() {
        let (cache, files) = sealed("seal_again");
        let mut seal = Seal::check(&cache, &mut |_: BuildStep| {}).unwrap();
        fs::write(&files[0], "again").unwrap();
        seal.add(&files[..1], false);
        assert!(!differs(&cache) && files[0].exists());
    }
}
