//! Why there is no executable, in sentences that say what to do.

use std::io;
use std::path::{Path, PathBuf};

/// Why there is no executable. Its text is for the person who called mdlec; a long one quotes cargo or rustc at its end.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The output is a folder.
    #[error("`{0}` is a folder: name a file for the output with `-o FILE`")]
    OutputIsFolder(PathBuf),
    /// The output is a device or the like.
    #[error("`{0}` is not a file: name a file for the executable with `-o FILE`")]
    OutputIsSpecial(PathBuf),
    /// The output is a file that the command reads.
    #[error("`{0}` is an input of this command and would be lost: name another file for the output")]
    OutputIsInput(PathBuf),
    /// The folder of the output is not there.
    #[error("the folder `{0}` does not exist: make it, or name another with `-o FILE`")]
    OutputFolderMissing(PathBuf),
    /// The output cannot be written.
    #[error("`{path}` cannot be written ({error}): name another file for the output with `-o FILE`")]
    OutputRefused {
        /// The output.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },

    /// There is no home folder.
    #[error("there is no home folder to keep compiled libraries in: name a folder with the variable MDLEC_CACHE")]
    NoCacheFolder,
    /// The cache cannot be written or read.
    #[error(
        "the cache cannot be used at `{path}` ({error}): make it writable or delete it, or name another folder with the \
         variable MDLEC_CACHE"
    )]
    Cache {
        /// Where in the cache.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The cache, or a folder above it, belongs to another user.
    #[error(
        "the cache is not safe: `{path}` belongs to user {owner}, who could put code into executables; name a folder of your \
         own with the variable MDLEC_CACHE"
    )]
    CacheOfOther {
        /// The folder.
        path: PathBuf,
        /// The number of the user.
        owner: u32,
    },
    /// Others can write to a folder above the cache.
    #[error(
        "the cache is not safe: others can write to `{0}`, and could put code into executables; run `chmod go-w` on it, or \
         name another folder with the variable MDLEC_CACHE"
    )]
    CacheOpen(PathBuf),
    /// The folder is to be emptied, and is not a cache.
    #[error("`{path}` is not a cache of mdlec: {why}; nothing was removed")]
    NotACache {
        /// The folder.
        path: PathBuf,
        /// The content that a cache does not have, or the lack of its lock file.
        why: String,
    },
    /// No space is left.
    #[error("there is no room left at `{0}` (a full disk, a quota, or `ulimit -f`): make room, then try again")]
    DiskFull(PathBuf),

    /// Rust is not installed, or not usable.
    #[error("mdlec needs `{tool}` to build an executable, and {why}: install Rust from rustup.rs")]
    NoRust {
        /// The program.
        tool: &'static str,
        /// What is wrong with it.
        why: String,
    },
    /// Rust is too old.
    #[error("mdlec needs Rust {needed} or newer to build an executable, and this is {found}: run `rustup update`")]
    OldRust {
        /// The oldest that does.
        needed: &'static str,
        /// What is installed.
        found: String,
    },
    /// There is no linker, or no static C library.
    #[error(
        "the linker cannot make a static executable: install the C compiler and the static C library of this system \
         (Debian: build-essential, Fedora: gcc and glibc-static); what it says is in `{log}`"
    )]
    Linker {
        /// What was said.
        log: PathBuf,
    },
    /// Libraries are missing and cannot be fetched.
    #[error(
        "the libraries that executables are built on are not on this machine yet, and they cannot be fetched: connect \
         it to the network once and try again; what cargo says is in `{log}`"
    )]
    NoLibraries {
        /// What was said.
        log: PathBuf,
    },
    /// Libraries are missing and cargo is told not to fetch any.
    #[error(
        "the libraries that executables are built on are not on this machine yet, and cargo is told not to fetch them: \
         unset CARGO_NET_OFFLINE, or `net.offline` in cargo's configuration, and try again with the network"
    )]
    Offline,

    /// The target's folder is not a crate.
    #[error("`{0}` has no Cargo.toml: a target is the folder of its crate, with its alphabet")]
    NotACrate(PathBuf),
    /// The target's alphabet and its manifest name different crates.
    #[error("the target's alphabet names the crate `{said}`, but the Cargo.toml in `{folder}` makes {found}")]
    OtherCrate {
        /// The target's folder.
        folder: PathBuf,
        /// What the alphabet says.
        said: String,
        /// What cargo says.
        found: String,
    },
    /// The target's crate does not depend on what it must.
    #[error("the target crate `{crate_name}` must depend on `{missing}`: add it to [dependencies] of its Cargo.toml")]
    TargetLacks {
        /// The target's crate.
        crate_name: String,
        /// The package.
        missing: &'static str,
    },
    /// Cargo cannot read the target's manifest, or find what it depends on.
    #[error("cargo cannot use the target crate `{crate_name}`; this is not a fault of your plan:\n{text}")]
    TargetRefused {
        /// The target's crate.
        crate_name: String,
        /// What cargo says.
        text: String,
    },
    /// The target's crate does not compile.
    #[error("the target crate `{crate_name}` does not compile; this is not a fault of your plan:\n{text}")]
    TargetBroken {
        /// The target's crate.
        crate_name: String,
        /// What rustc says.
        text: String,
    },
    /// The target's crate is not what its alphabet says.
    #[error(
        "the target crate `{crate_name}` does not fit its alphabet: its module `alphabet` has to export a type for every \
         quark the alphabet declares, as `{log}` says; if it does, please report this with the plan and that file"
    )]
    TargetMisfit {
        /// The target's crate.
        crate_name: String,
        /// What was said.
        log: PathBuf,
    },

    /// A path that no manifest can hold.
    #[error("`{0}` is not UTF-8, so cargo cannot be told of it: rename it")]
    NotUtf8(PathBuf),
    /// The build was stopped.
    #[error("the build was stopped by signal {0}")]
    Stopped(u8),
    /// Cargo fails for a reason that is not known here.
    #[error(
        "cargo failed; what it says is in `{log}`; if it makes no sense, delete the cache `{cache}` and try again; if this \
         stays, please report it with that file"
    )]
    Cargo {
        /// The folder of the cache.
        cache: PathBuf,
        /// What was said.
        log: PathBuf,
    },
    /// Our own Rust does not compile.
    #[error("internal error: mdlec made Rust that does not compile; please report it with the plan and `{log}`")]
    Emitted {
        /// What was said.
        log: PathBuf,
    },
    /// What came with mdlec does not compile.
    #[error(
        "internal error: the sources that came with mdlec do not compile; delete `{folder}` and try again; if this \
         stays, please report it with `{log}`"
    )]
    Packed {
        /// The sources in the cache.
        folder: PathBuf,
        /// What was said.
        log: PathBuf,
    },
    /// A built-in target that is none.
    #[error("internal error: `{0}` is not built in; please report it")]
    NoSuchTarget(String),
}

impl LinkError {
    /// The exit status of mdlec.
    #[must_use]
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::TargetRefused { .. }
            | Self::TargetBroken { .. }
            | Self::TargetMisfit { .. }
            | Self::OutputIsFolder(_)
            | Self::OutputIsSpecial(_)
            | Self::OutputIsInput(_)
            | Self::OutputFolderMissing(_)
            | Self::OutputRefused { .. }
            | Self::NoCacheFolder
            | Self::Cache { .. }
            | Self::CacheOfOther { .. }
            | Self::CacheOpen(_)
            | Self::NotACache { .. }
            | Self::DiskFull(_)
            | Self::NoRust { .. }
            | Self::OldRust { .. }
            | Self::Linker { .. }
            | Self::NoLibraries { .. }
            | Self::Offline
            | Self::NotACrate(_)
            | Self::OtherCrate { .. }
            | Self::TargetLacks { .. }
            | Self::NotUtf8(_)
            | Self::Cargo { .. } => 2,
            Self::Stopped(signal) => 128_u8.saturating_add(*signal),
            Self::Emitted { .. } | Self::Packed { .. } | Self::NoSuchTarget(_) => 101,
        }
    }

    /// The system refused something in the cache.
    pub(super) fn cache(path: &Path, error: io::Error) -> Self {
        let path = path.to_owned();
        if is_full(&error) { Self::DiskFull(path) } else { Self::Cache { path, error } }
    }

    /// The system refused the output.
    pub(super) fn output(path: &Path, error: io::Error) -> Self {
        let path = path.to_owned();
        if is_full(&error) { Self::DiskFull(path) } else { Self::OutputRefused { path, error } }
    }
}

/// Whether no space is left, on the disk, for the user, or for the process.
fn is_full(error: &io::Error) -> bool {
    use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}
