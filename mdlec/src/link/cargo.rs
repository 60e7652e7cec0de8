//! Runs cargo as a child process, with the same flags in every environment and without its output on the
//! terminal.

use std::env;
use std::ffi::OsString;
use std::process::{Command, Stdio};

use super::guard::GroupGuard;
use super::machine::BuildMachine;
use super::messages::{self, CargoResult};
use super::plan_package::PlanPackage;
use super::seal::Seal;
use super::toolchain::{self, cargo_home, output, unusable};
use super::{BuildStep, Cache, LinkError, cleanup};

/// Settings of the build profile, passed to cargo by `--config`, so that neither a configuration file nor the
/// environment can override them. Executables rely on these settings.
const PROFILE: [&str; 13] = [
    // A panic in a driver has to reach the code that stops the robot.
    "profile.release.panic='unwind'",
    // Executables compute the same results on every machine, regardless of its configuration.
    "profile.release.overflow-checks=false",
    "profile.release.debug-assertions=false",
    "profile.release.package.'*'.overflow-checks=false",
    "profile.release.package.'*'.debug-assertions=false",
    "profile.release.opt-level=3",
    "profile.release.codegen-units=1",
    "profile.release.lto=false",
    "profile.release.incremental=false",
    "profile.release.debug=false",
    "profile.release.rpath=false",
    "profile.release.strip='symbols'",
    // Options are parsed only once, and their parser is a seventh of an executable.
    "profile.release.package.clap_builder.opt-level='s'",
];

/// A build of the package of a plan.
#[derive(Debug)]
pub(super) struct PackageBuild<'a> {
    pub(super) cache: &'a Cache,
    pub(super) machine: &'a BuildMachine,
    pub(super) plan: &'a PlanPackage,
}

impl PackageBuild<'_> {
    /// Builds the package, without the network if possible.
    pub(super) fn build(&self, seal: &mut Seal, progress: &mut dyn FnMut(BuildStep)) -> Result<CargoResult, LinkError> {
        let run = self.attempt(false, seal, progress)?;
        if !run.lacks_libraries() {
            return Ok(run);
        }
        progress(BuildStep::Fetching);
        self.attempt(true, seal, progress)
    }

    /// Builds the package once; fetches missing libraries if `online` is `true`.
    fn attempt(
        &self,
        online: bool,
        seal: &mut Seal,
        progress: &mut dyn FnMut(BuildStep),
    ) -> Result<CargoResult, LinkError> {
        let mut command = self.command("build");
        command
            .arg("--message-format=json")
            .env("CARGO_ENCODED_RUSTFLAGS", self.flags())
            .env("TMPDIR", self.cache.scratch()?);
        if !online {
            command.arg("--offline");
        }
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let guard = GroupGuard::start().map_err(|error| unusable("sh", &error))?;
        let (child, _watched) = cleanup::spawn(&mut command, &guard).map_err(|error| unusable("cargo", &error))?;
        messages::follow(child, online, &self.plan.manifest(), seal, progress)
            .map_err(|error| unusable("cargo", &error))
    }

    /// Removes the build results of the plan itself.
    pub(super) fn clean(&self) -> Result<(), LinkError> {
        let mut command = self.command("clean");
        command.arg("--offline").arg("--package").arg(self.plan.name());
        // If this command fails, the following build reports the reason.
        output(command, "cargo").map(|_| ())
    }

    /// Returns cargo's command `name` for the plan.
    fn command(&self, name: &str) -> Command {
        let mut command = toolchain::command("cargo");
        // With an explicit triple, cargo does not apply the flags to procedural macros: a static one could not be
        // loaded.
        command.args([name, "--release", "--color=never", "--target", &self.machine.triple]);
        command.arg("--manifest-path").arg(self.plan.manifest());
        command.arg("--target-dir").arg(self.cache.target());
        command.args(PROFILE.iter().flat_map(|setting| ["--config", setting]));
        // Both override cargo's configuration, so that all build results are in the cache.
        command.env("CARGO_BUILD_BUILD_DIR", self.cache.target()).env("CARGO_INCREMENTAL", "0");
        command.envs(self.machine.linker(cargo_home().as_deref()));
        command
    }

    /// Returns the flags of rustc. They make the executable static and give it a fixed address, so that it needs no
    /// relocation table. They also remove the paths of this machine from it.
    ///
    /// The flags are equal for all plans, because cargo would compile everything again for other flags. Therefore they
    /// do not remove the path of a target that is outside the home folder, and the messages of panics show this path.
    fn flags(&self) -> OsString {
        let mut flags = OsString::from("-Ctarget-feature=+crt-static\x1f-Crelocation-model=static");
        let home = env::home_dir();
        // If several prefixes match a path, the last one takes effect.
        let places = [(home, "~"), (cargo_home(), "/cargo"), (Some(self.cache.folder().to_owned()), "/mdle")];
        for (place, name) in places {
            let Some(place) = place.filter(|place| place.parent().is_some()) else { continue };
            flags.push("\x1f--remap-path-prefix=");
            flags.push(place);
            flags.push("=");
            flags.push(name);
        }
        flags
    }
}
