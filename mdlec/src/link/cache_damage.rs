//! Detects damage in the cache that cargo does not notice, because cargo compares the times of files and not their
//! contents.

use std::os::unix::process::ExitStatusExt;

use super::cache::remove;
use super::cargo::PackageBuild;
use super::messages::{CargoResult, Complaint, NO_LINKER};
use super::plan_package::PlanPackage;
use super::{BuildStep, LinkError, TargetCrate, build_record};

/// Message of rustc about a library that is missing or empty.
const ABSENT: &str = "can't find crate for `";

/// Message of rustc about a missing library of mdlec itself.
const OURS_ABSENT: &str = "can't find crate for `mdle_";

/// Messages of rustc about a library that it cannot read.
const UNREADABLE: [&str; 5] = [
    "found invalid metadata files for crate",
    "found possibly newer version of crate",
    ABSENT,
    "error: linking with `",
    "error: internal compiler error",
];

/// Messages of rustc or the linker about a linker, a C library or a symbol that the system or a target's crate lacks.
const LACKING: [&str; 6] = [
    NO_LINKER,
    "crt1.o: No such file",
    "unable to find library",
    "cannot find -l",
    "undefined symbol",
    "undefined reference",
];

/// Part of the cache that must be built again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Damage {
    /// The executable of the plan.
    Executable,
    /// All build results of cargo.
    Libraries,
}

/// Returns the part of the cache that is damaged according to a run of cargo; `None` if there is no sign of damage.
pub(super) fn found(job: &PackageBuild<'_>, run: &CargoResult, target: &TargetCrate<'_>) -> Option<Damage> {
    if run.status.success() {
        let stored = run.executable.as_ref().filter(|executable| executable.fresh)?;
        return (!build_record::fits(job.plan, &stored.path)).then_some(Damage::Executable);
    }
    if run.lacks_room() || run.status.signal().is_some() {
        return None;
    }
    // Cargo trusts the files in its output folder, and can panic if one of them is damaged.
    if run.is_cargo_broken() {
        return Some(Damage::Libraries);
    }
    let folder = job.cache.target();
    let names_folder = folder.to_str().is_some_and(|folder| run.stderr.contains(folder));
    // If the compiler fails without a message, cargo prints the compiler's command line, which contains the folder as
    // well.
    let refused = !run.began && names_folder && !run.stderr.contains("process didn't exit successfully");
    // A crate that was compiled in this run is not damaged: compiling it again would not help.
    let spoilt = run.reused && run.complaints.iter().any(|complaint| is_of_damage(complaint, job.plan, target));
    (refused || spoilt).then_some(Damage::Libraries)
}

/// Returns `true` if a damaged library may be the cause of the error.
fn is_of_damage(complaint: &Complaint, plan: &PlanPackage, target: &TargetCrate<'_>) -> bool {
    let says = |signs: &[&str]| signs.iter().any(|sign| complaint.text.contains(sign));
    // The sources that are part of mdlec are tested, so an error in them indicates damage. The code that mdlec emits
    // for a plan can be wrong.
    let is_tested = matches!(target, TargetCrate::Builtin { .. }) && complaint.manifest != plan.manifest();
    complaint.is_error && !says(&LACKING) && (is_tested || says(&UNREADABLE) && !is_forgotten(complaint, target))
}

/// Returns `true` if the error is caused by a third-party crate that uses another crate without naming it among its
/// dependencies.
fn is_forgotten(complaint: &Complaint, target: &TargetCrate<'_>) -> bool {
    let TargetCrate::Path { folder, .. } = target else { return false };
    let is_own = folder.canonicalize().is_ok_and(|folder| complaint.manifest.starts_with(folder));
    is_own && complaint.text.contains(ABSENT) && !complaint.text.contains(OURS_ABSENT)
}

/// Removes the damaged part, so that the next run of cargo builds it again.
pub(super) fn clear(
    damage: Damage,
    job: &PackageBuild<'_>,
    progress: &mut dyn FnMut(BuildStep),
) -> Result<(), LinkError> {
    match damage {
        Damage::Executable => job.clean(),
        Damage::Libraries => {
            progress(BuildStep::Mending);
            remove(&job.cache.target())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::folder;
    use super::{Complaint, PlanPackage, TargetCrate, is_of_damage};

    #[test]
    fn a_linker_that_the_system_lacks_is_no_damage() {
        let plan = PlanPackage { folder: folder("lacking"), hash: String::new() };
        let target = TargetCrate::Builtin { name: "sim", crate_name: "mdle_sim" };
        let is_damage = |text: &str| {
            let manifest = plan.folder.join("registry/quote/Cargo.toml");
            is_of_damage(&Complaint { manifest, is_error: true, text: text.to_owned() }, &plan, &target)
        };
        assert!(!is_damage("error: linker `cc` not found\n"));
        let failed = "error: linking with `cc` failed: exit status: 1\n";
        assert!(!is_damage(&format!("{failed}/usr/bin/ld: cannot find Scrt1.o: No such file or directory\n")));
        assert!(is_damage(&format!("{failed}libquote-1.rlib: file format not recognized\n")));
    }
}
