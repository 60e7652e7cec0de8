//! The installed Rust toolchain: its version, and the commands that run its programs.

use std::ffi::OsStr;
use std::path::{self, PathBuf};
use std::process::{Command, Output, Stdio};
use std::{env, io};

use super::LinkError;

/// Oldest Rust version that compiles the embedded sources.
const NEEDED: &str = env!("CARGO_PKG_RUST_VERSION");

/// Prefixes of environment variables that cargo may read, because the user chooses them. They concern cargo's folders,
/// its registries, the network, and the number of jobs. All other variables of cargo and rustc are removed, because
/// they could change builds, or make cargo build everything again.
const KEPT: [&str; 6] =
    ["CARGO_HOME", "CARGO_HTTP_", "CARGO_NET_", "CARGO_REGISTRIES_", "CARGO_REGISTRY_", "CARGO_BUILD_JOBS"];

/// Working folder of cargo and rustc. They search it, and every folder above it, for `.cargo/config.toml` and
/// `rust-toolchain.toml`, which can run code; only the superuser can create these files in this folder.
const OUTSIDE: &str = "/";

/// The installed Rust.
#[derive(Debug)]
pub(super) struct Toolchain {
    /// Target triple of this machine.
    pub(super) host: String,
    /// Version of rustc, such as `1.95.0`.
    pub(super) release: String,
}

impl Toolchain {
    /// Runs `rustc` to find its version and host.
    pub(super) fn find() -> Result<Self, LinkError> {
        let mut command = command("rustc");
        command.arg("-vV");
        let found = output(command, "rustc")?;
        let description = String::from_utf8_lossy(&found.stdout);
        let field = |name: &str| description.lines().find_map(|line| line.strip_prefix(name));
        let (Some(host), Some(release), true) = (field("host: "), field("release: "), found.status.success()) else {
            // For example, rustup without a toolchain, which the first line reports.
            let errors = String::from_utf8_lossy(&found.stderr);
            let why = errors.lines().next().unwrap_or("it printed no error").trim_start_matches("error: ").to_owned();
            return Err(LinkError::NoRust { tool: "rustc", why });
        };
        if version(release) < version(NEEDED) {
            return Err(LinkError::OldRust { needed: NEEDED, found: release.to_owned() });
        }
        Ok(Self { host: host.to_owned(), release: release.to_owned() })
    }
}

/// Returns the first two numbers of a version.
fn version(text: &str) -> Option<(u32, u32)> {
    let mut parts = text.split('.');
    Some((parts.next()?.parse().ok()?, parts.next()?.parse().ok()?))
}

/// Returns a command for `tool` that ignores the configuration of cargo and rustc in the environment and in the folder
/// of this process.
pub(super) fn command(tool: &str) -> Command {
    let mut command = Command::new(tool);
    command.current_dir(OUTSIDE).stdin(Stdio::null());
    for (name, _) in env::vars_os().filter(|(name, _)| is_about_builds(name)) {
        command.env_remove(name);
    }
    for name in ["CARGO_HOME", "RUSTUP_HOME"] {
        command.envs(absolute(name).map(|folder| (name, folder)));
    }
    command
}

/// Returns the absolute path of the folder in the variable `name`; a relative path is relative to the current
/// folder.
pub(super) fn absolute(name: &str) -> Option<PathBuf> {
    env::var_os(name).filter(|folder| !folder.is_empty()).and_then(|folder| path::absolute(folder).ok())
}

/// Returns the folder of cargo's configuration and of the packages that cargo has fetched.
pub(super) fn cargo_home() -> Option<PathBuf> {
    absolute("CARGO_HOME").or_else(|| Some(env::home_dir()?.join(".cargo")))
}

/// Runs `command` to its end. `tool` is the name of the program in error messages.
pub(super) fn output(mut command: Command, tool: &'static str) -> Result<Output, LinkError> {
    command.output().map_err(|error| unusable(tool, &error))
}

/// Returns `true` if this variable could change the results of cargo or rustc. Returns `false` for `RUSTUP_TOOLCHAIN`,
/// because users choose their Rust version with it.
fn is_about_builds(name: &OsStr) -> bool {
    let Some(name) = name.to_str() else { return false };
    let own = name == "CARGO" || name.starts_with("CARGO_") || name.starts_with("__CARGO_");
    let kept = KEPT.iter().any(|kept| name.starts_with(kept));
    (own && !kept) || name == "RUSTC" || name.starts_with("RUSTC_") || matches!(name, "RUSTFLAGS" | "RUSTDOCFLAGS")
}

/// Returns the error for a program that could not be run.
pub(super) fn unusable(tool: &'static str, error: &io::Error) -> LinkError {
    let missing = error.kind() == io::ErrorKind::NotFound;
    let why = if missing { "it is not installed".to_owned() } else { format!("it cannot be run ({error})") };
    LinkError::NoRust { tool, why }
}

#[cfg(test)]
mod tests {
    use std::ffi::OsStr;

    use super::{is_about_builds, version};

    #[test]
    fn what_changes_a_build_is_removed_and_the_rest_kept() {
        for name in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_TARGET_DIR", "CARGO_BUILD_TARGET", "RUSTC_WRAPPER"]
        {
            assert!(is_about_builds(OsStr::new(name)), "{name}");
        }
        for name in ["CARGO", "CARGO_PROFILE_RELEASE_LTO", "CARGO_MANIFEST_DIR", "RUSTC", "RUSTC_WORKSPACE_WRAPPER"] {
            assert!(is_about_builds(OsStr::new(name)), "{name}");
        }
        for name in ["CARGO_HOME", "CARGO_HTTP_PROXY", "CARGO_NET_OFFLINE", "CARGO_BUILD_JOBS", "RUSTUP_TOOLCHAIN"] {
            assert!(!is_about_builds(OsStr::new(name)), "{name}");
        }
        assert!(!is_about_builds(OsStr::new("PATH")));
    }

    #[test]
    fn versions_are_compared_as_numbers() {
        assert!(version("1.100.0-nightly") > version("1.95"));
        assert!(version("1.80.1") < version("1.95"));
    }
}
