//! The machine for which an executable is built: this machine, or another machine. To build for another machine, rustc
//! needs only the standard library for that machine.

use std::fs;
use std::path::Path;

use toml::de::DeTable;

use super::LinkError;
use super::toolchain::{command, output};

/// Short names of machines, with the target triples of static executables that rustc links without a C compiler
/// for them.
const SHORT: [(&str, &str); 3] = [
    ("aarch64", "aarch64-unknown-linux-musl"),
    ("armv7", "armv7-unknown-linux-musleabihf"),
    ("x86_64", "x86_64-unknown-linux-musl"),
];

/// Linker that comes with every installation of rustc.
const OWN_LINKER: &str = "rust-lld";

/// A machine for which executables are built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct BuildMachine {
    /// Target triple of the machine.
    pub(super) triple: String,
    /// `true` if it is not the machine on which the build runs.
    is_foreign: bool,
}

impl BuildMachine {
    /// Returns the machine on which the build runs, which has this target triple.
    pub(super) fn host(triple: &str) -> Self {
        Self { triple: triple.to_owned(), is_foreign: false }
    }

    /// Returns the machine `name`, which is a target triple or a short name; returns the `host` if `name` is `None`.
    ///
    /// # Errors
    /// Fails if rustc does not know the machine, if it does not run Linux, or if its standard library is not installed.
    pub(super) fn find(name: Option<&str>, host: &str) -> Result<Self, LinkError> {
        let name = name.unwrap_or(host);
        let triple = SHORT.iter().find(|(short, _)| *short == name).map_or(name, |(_, triple)| triple);
        if triple == host {
            return Ok(Self::host(host));
        }
        let mut rustc = command("rustc");
        rustc.args(["--print=target-libdir", "--print=cfg", "--target", triple]);
        let found = output(rustc, "rustc")?;
        let text = String::from_utf8_lossy(&found.stdout);
        let triple = triple.to_owned();
        let Some((libraries, about)) = text.split_once('\n').filter(|_| found.status.success()) else {
            return Err(LinkError::NoMachine(triple));
        };
        let is_for = |system: &str| about.lines().any(|line| line == format!("target_os=\"{system}\""));
        if is_for("none") {
            return Err(LinkError::NoSystem(triple));
        } else if !is_for("linux") {
            return Err(LinkError::NotLinux(triple));
        }
        if has_standard_library(Path::new(libraries)) {
            Ok(Self { triple, is_foreign: true })
        } else if is_offered_by_rustup(&triple) {
            Err(LinkError::MachineToAdd(triple))
        } else {
            Err(LinkError::MachineMissing(triple))
        }
    }

    /// Returns the environment variable that names the linker to cargo, with its value, if rustc's own linker is
    /// sufficient. It is sufficient for the C library musl, because rustc contains the object files that musl needs at
    /// the start and the end of a static executable. Returns `None` if the configuration in `cargo_home` names a
    /// linker, which the variable would override.
    pub(super) fn linker(&self, cargo_home: Option<&Path>) -> Option<(String, &'static str)> {
        let is_configured = || cargo_home.is_some_and(|home| names_linker(home, &self.triple));
        let own = self.is_foreign && self.triple.contains("-linux-musl") && !is_configured();
        own.then(|| {
            (format!("CARGO_TARGET_{}_LINKER", self.triple.to_uppercase().replace(['-', '.'], "_")), OWN_LINKER)
        })
    }

    /// Returns the triple if this is not the machine on which the build runs.
    pub(super) fn foreign(&self) -> Option<&str> {
        self.is_foreign.then_some(&self.triple)
    }
}

/// Returns `true` if the folder of a machine's libraries contains the standard library.
fn has_standard_library(folder: &Path) -> bool {
    let mut entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.any(|entry| entry.file_name().to_string_lossy().starts_with("libstd-"))
}

/// Returns `true` if the configuration in the folder `home` names a linker for this machine. Cargo reports a
/// configuration that cannot be read.
fn names_linker(home: &Path, triple: &str) -> bool {
    let text = |name| fs::read_to_string(home.join(name)).ok();
    ["config.toml", "config"].into_iter().filter_map(text).any(|text| has_linker(&text, triple).unwrap_or(false))
}

fn has_linker(configuration: &str, triple: &str) -> Option<bool> {
    let table = DeTable::parse(configuration).ok()?;
    let machine = table.get_ref().get("target")?.get_ref().get(triple)?;
    Some(machine.get_ref().get("linker").is_some())
}

/// Returns `true` if rustup can add the standard library of this machine.
fn is_offered_by_rustup(triple: &str) -> bool {
    let mut rustup = command("rustup");
    rustup.args(["target", "list"]);
    let listed = output(rustup, "rustup").map(|listed| listed.stdout).unwrap_or_default();
    String::from_utf8_lossy(&listed).lines().any(|line| line.split(' ').next() == Some(triple))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::BuildMachine;
    use crate::link::tests::folder;

    fn machine(triple: &str, is_foreign: bool) -> BuildMachine {
        BuildMachine { triple: triple.to_owned(), is_foreign }
    }

    #[test]
    fn musl_is_linked_by_rustc_itself() {
        let linker = machine("aarch64-unknown-linux-musl", true).linker(None);
        assert_eq!(linker, Some(("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER".to_owned(), "rust-lld")));
        assert_eq!(machine("aarch64-unknown-linux-gnu", true).linker(None), None);
        assert_eq!(machine("x86_64-unknown-linux-musl", false).linker(None), None);
    }

    #[test]
    fn a_linker_in_the_home_of_cargo_wins() {
        let home = folder("linkers");
        let is_own = |triple: &str| machine(triple, true).linker(Some(&home)).is_some();
        let musl = ["aarch64-unknown-linux-musl", "armv7-unknown-linux-musleabihf"];
        assert_eq!(musl.map(is_own), [true, true]);
        fs::write(home.join("config.toml"), "[target.aarch64-unknown-linux-musl]\nlinker = 'ld.lld'\n").unwrap();
        assert_eq!(musl.map(is_own), [false, true]);
        fs::write(home.join("config.toml"), "[target\n").unwrap();
        assert_eq!(musl.map(is_own), [true, true]);
    }
}
