//! Defines the reasons why no executable was built, with messages that tell the user what to do.

use std::io;
use std::path::{Path, PathBuf};

/// Reason why no executable was built. The message is for the user of mdlec; a long message ends with a quotation from
/// cargo or rustc.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The output path is a folder.
    #[error("`{0}` is a folder: name a file for the output with `-o FILE`")]
    OutputIsFolder(PathBuf),
    /// The output path is a special file, such as a device.
    #[error("`{0}` is not a file: name a file for the executable with `-o FILE`")]
    OutputIsSpecial(PathBuf),
    /// The output path is a file that the command reads.
    #[error("`{0}` is an input of this command and would be lost: name another file for the output")]
    OutputIsInput(PathBuf),
    /// The folder of the output, at this path, does not exist.
    #[error("the folder `{0}` does not exist: make it, or name another with `-o FILE`")]
    OutputFolderMissing(PathBuf),
    /// The output cannot be written.
    #[error("`{path}` cannot be written ({error}): name another file for the output with `-o FILE`")]
    OutputRefused {
        /// Path of the output.
        path: PathBuf,
        /// Error of the system.
        error: io::Error,
    },

    /// There is no home folder.
    #[error("there is no home folder to keep compiled libraries in: name a folder with the variable MDLEC_CACHE")]
    NoCacheFolder,
    /// The system refuses to read or write the cache.
    #[error(
        "the cache cannot be used at `{path}` ({error}): make it writable or delete it, or name another folder with the \
         variable MDLEC_CACHE"
    )]
    Cache {
        /// Path in the cache.
        path: PathBuf,
        /// Error of the system.
        error: io::Error,
    },
    /// The cache, or a folder above it, belongs to another user.
    #[error(
        "the cache is not safe: `{path}` belongs to user {owner}, who could put code into executables; name a folder of your \
         own with the variable MDLEC_CACHE"
    )]
    CacheOfOther {
        /// Path of the folder.
        path: PathBuf,
        /// Numeric user identifier of the owner.
        owner: u32,
    },
    /// Others can write to a folder above the cache.
    #[error(
        "the cache is not safe: others can write to `{0}`, and could put code into executables; run `chmod go-w` on it, or \
         name another folder with the variable MDLEC_CACHE"
    )]
    CacheOpen(PathBuf),
    /// The folder that should be emptied is not a cache of mdlec.
    #[error("`{path}` is not a cache of mdlec: {why}; nothing was removed")]
    NotACache {
        /// Path of the folder.
        path: PathBuf,
        /// Reason why the folder is not a cache: an unknown file, or no lock file.
        why: String,
    },
    /// The disk is full; contains the path that could not be written.
    #[error("there is no room left at `{0}` (a full disk, a quota, or `ulimit -f`): make room, then try again")]
    DiskFull(PathBuf),

    /// Rust is not installed, or cannot be used.
    #[error("mdlec needs `{tool}` to build an executable, and {why}: install Rust from rustup.rs")]
    NoRust {
        /// Name of the program.
        tool: &'static str,
        /// Reason why the program cannot be used.
        why: String,
    },
    /// Rust is too old.
    #[error("mdlec needs Rust {needed} or newer to build an executable, and this is {found}: run `rustup update`")]
    OldRust {
        /// Minimum version of Rust.
        needed: &'static str,
        /// Installed version of Rust.
        found: String,
    },
    /// rustc does not know the machine.
    #[error(
        "`{0}` is no machine that this Rust compiles for: name aarch64, armv7, x86_64, or a line of \
         `rustc --print target-list`"
    )]
    NoMachine(String),
    /// The machine has no operating system.
    #[error(
        "executables run on Linux, and `{0}` does not: for a microcontroller, print the plan as Rust with `--emit rust`"
    )]
    NoSystem(String),
    /// The machine has another operating system.
    #[error(
        "executables run on Linux, and `{0}` is another system: name aarch64, armv7, x86_64 or another triple of Linux"
    )]
    NotLinux(String),
    /// The standard library of the machine is not installed, but rustup offers it; contains the target triple.
    #[error("Rust's standard library for `{0}` is not installed: run `rustup target add {0}`")]
    MachineToAdd(String),
    /// The standard library of the machine is not installed, and rustup does not offer it.
    #[error(
        "Rust's standard library for `{0}` is not installed, and rustup is not here or does not have it: install it as \
         your distribution or the makers of the machine advise"
    )]
    MachineMissing(String),
    /// The linker cannot make a static executable for another machine.
    #[error(
        "the linker cannot make a static executable for `{triple}`: name a linker for it in the configuration in cargo's \
         home, as `[target.{triple}]` and `linker = \"…\"`; its output is in `{log}`"
    )]
    MachineLinker {
        /// Target triple of the machine.
        triple: String,
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },
    /// There is no linker, or no static C library, on the machine that builds.
    #[error(
        "the linker cannot make a static executable: install the C compiler and the static C library of this system \
         (Debian: build-essential, Fedora: gcc and glibc-static); its output is in `{log}`"
    )]
    Linker {
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },
    /// Libraries are missing and cannot be fetched.
    #[error(
        "the libraries that executables are built on are not on this machine yet, and they cannot be fetched: connect \
         it to the network once and try again; cargo's output is in `{log}`"
    )]
    NoLibraries {
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },
    /// Libraries are missing, and cargo is configured not to fetch any.
    #[error(
        "the libraries that executables are built on are not on this machine yet, and cargo is configured not to fetch them: \
         unset CARGO_NET_OFFLINE, or `net.offline` in cargo's configuration, and try again with the network"
    )]
    Offline,

    /// The target's folder, at this path, is not a crate.
    #[error("`{0}` has no Cargo.toml: a target is the folder of its crate, with its alphabet")]
    NotACrate(PathBuf),
    /// The target's alphabet and its manifest name different crates.
    #[error("the target's alphabet names the crate `{name}`, but the Cargo.toml in `{folder}` makes {found}")]
    OtherCrate {
        /// Folder of the target.
        folder: PathBuf,
        /// Name of the crate in the alphabet.
        name: String,
        /// Name of the crate in the manifest, as cargo reads it.
        found: String,
    },
    /// The target's crate lacks a required dependency.
    #[error("the target crate `{crate_name}` must depend on `{missing}`: add it to [dependencies] of its Cargo.toml")]
    TargetLacks {
        /// Name of the target's crate.
        crate_name: String,
        /// Name of the missing package.
        missing: &'static str,
    },
    /// Cargo cannot read the target's manifest, or find its dependencies.
    #[error("cargo cannot use the target crate `{crate_name}`; this is not a fault of your plan:\n{text}")]
    TargetRefused {
        /// Name of the target's crate.
        crate_name: String,
        /// Output of cargo.
        text: String,
    },
    /// The target's crate does not compile.
    #[error("the target crate `{crate_name}` does not compile; this is not a fault of your plan:\n{text}")]
    TargetBroken {
        /// Name of the target's crate.
        crate_name: String,
        /// Errors of rustc, or the output of cargo if rustc reported none.
        text: String,
    },
    /// The target's crate does not fit its alphabet.
    #[error(
        "the target crate `{crate_name}` does not fit its alphabet: its module `alphabet` has to export a type for every \
         quark the alphabet declares, as `{log}` says; if it does, please report this with the plan and that file"
    )]
    TargetMisfit {
        /// Name of the target's crate.
        crate_name: String,
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },

    /// The path is not UTF-8, so a manifest cannot contain it.
    #[error("`{0}` is not UTF-8, which cargo's manifests need: rename it")]
    NotUtf8(PathBuf),
    /// A signal has stopped the build; contains the number of the signal.
    #[error("the build was stopped by signal {0}")]
    Stopped(u8),
    /// Cargo fails for an unknown reason.
    #[error(
        "cargo failed; its output is in `{log}`; if it makes no sense, delete the cache `{cache}` and try again; if this \
         stays, please report it with that file"
    )]
    Cargo {
        /// The folder of the cache.
        cache: PathBuf,
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },
    /// Rust code that mdlec has generated does not compile.
    #[error("internal error: mdlec made Rust that does not compile; please report it with the plan and `{log}`")]
    Emitted {
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },
    /// Sources that are part of mdlec do not compile.
    #[error(
        "internal error: the sources that came with mdlec do not compile; delete `{folder}` and try again; if this \
         stays, please report it with `{log}`"
    )]
    Packed {
        /// Folder of the sources in the cache.
        folder: PathBuf,
        /// File with the output of cargo and rustc.
        log: PathBuf,
    },
    /// There is no built-in target of this name.
    #[error("internal error: `{0}` is not built in; please report it")]
    NoSuchTarget(String),
}

impl LinkError {
    /// Returns the exit status of mdlec for this error.
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
            | Self::NoMachine(_)
            | Self::NoSystem(_)
            | Self::NotLinux(_)
            | Self::MachineToAdd(_)
            | Self::MachineMissing(_)
            | Self::MachineLinker { .. }
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

    /// Returns the error for a path in the cache that the system refused.
    pub(super) fn cache(path: &Path, error: io::Error) -> Self {
        let path = path.to_owned();
        if is_full(&error) { Self::DiskFull(path) } else { Self::Cache { path, error } }
    }

    /// Returns the error for an output that the system refused.
    pub(super) fn output(path: &Path, error: io::Error) -> Self {
        let path = path.to_owned();
        if is_full(&error) { Self::DiskFull(path) } else { Self::OutputRefused { path, error } }
    }
}

/// Returns `true` if the error means that the disk is full, or that a quota or the limit on the size of files of this
/// process has been reached.
fn is_full(error: &io::Error) -> bool {
    use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}
