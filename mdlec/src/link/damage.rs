//! Damage in the cache that cargo does not see, as it goes by the times of files and not by what is in them.

use std::os::unix::process::ExitStatusExt;

use super::cache::remove;
use super::cargo::Job;
use super::messages::{Complaint, Run};
use super::package::PlanPackage;
use super::{LinkError, Progress, TargetCrate, record};

/// What rustc says of a library that is not there, or of which nothing is left.
const ABSENT: &str = "can't find crate for `";

/// The same of those that came with mdlec.
const OURS_ABSENT: &str = "can't find crate for `mdle_";

/// What rustc says of a library that it cannot read.
const UNREADABLE: [&str; 5] = [
    "found invalid metadata files for crate",
    "found possibly newer version of crate",
    ABSENT,
    "error: linking with `",
    "error: internal compiler error",
];

/// What the linker says where it is the system, or a target's crate, that lacks something.
const LACKING: [&str; 4] = ["unable to find library", "cannot find -l", "undefined symbol", "undefined reference"];

/// What has to be built again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Damage {
    /// The executable of the plan.
    Executable,
    /// Everything that cargo has compiled.
    Libraries,
}

/// What of the cache is damaged, judged by a run of cargo.
pub(super) fn found(job: &Job<'_>, run: &Run, target: &TargetCrate<'_>) -> Option<Damage> {
    if run.status.success() {
        let stored = run.executable.as_ref().filter(|executable| executable.fresh)?;
        return (!record::fits(job.plan, &stored.path)).then_some(Damage::Executable);
    }
    if run.lacks_room() || run.status.signal().is_some() {
        return None;
    }
    // It reads files there and takes them for its own.
    if run.is_cargo_broken() {
        return Some(Damage::Libraries);
    }
    let folder = job.cache.target();
    let names_folder = folder.to_str().is_some_and(|folder| run.stderr.contains(folder));
    // A compiler that fails without a word is shown with its command line, which names the folder as well.
    let refused = !run.began && names_folder && !run.stderr.contains("process didn't exit successfully");
    // What was compiled a moment ago is not damaged: whatever is wrong then will not mend by doing it again.
    let spoilt = run.reused && run.complaints.iter().any(|complaint| is_of_damage(complaint, job.plan, target));
    (refused || spoilt).then_some(Damage::Libraries)
}

/// Whether an error can come of a library that is damaged.
fn is_of_damage(complaint: &Complaint, plan: &PlanPackage, target: &TargetCrate<'_>) -> bool {
    let says = |signs: &[&str]| signs.iter().any(|sign| complaint.text.contains(sign));
    // What came with mdlec does not fail by itself, but what mdlec makes of a plan can be wrong.
    let is_tested = matches!(target, TargetCrate::Builtin { .. }) && complaint.manifest != plan.manifest();
    complaint.is_error && !says(&LACKING) && (is_tested || says(&UNREADABLE) && !is_forgotten(complaint, target))
}

/// Whether a third party's crate names one that it does not depend on.
fn is_forgotten(complaint: &Complaint, target: &TargetCrate<'_>) -> bool {
    let TargetCrate::Path { folder, .. } = target else { return false };
    let is_own = folder.canonicalize().is_ok_and(|folder| complaint.manifest.starts_with(folder));
    is_own && complaint.text.contains(ABSENT) && !complaint.text.contains(OURS_ABSENT)
}

/// Removes what is damaged, so that the next run of cargo makes it anew.
pub(super) fn clear(damage: Damage, job: &Job<'_>, progress: &mut dyn FnMut(Progress)) -> Result<(), LinkError> {
    match damage {
        Damage::Executable => job.clean(),
        Damage::Libraries => {
            progress(Progress::Mending);
            remove(&job.cache.target())
        }
    }
}
