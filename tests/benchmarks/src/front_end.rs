//! Workloads of the front end: the plans of the repository, and generated plans of one and of ten megabytes.

use mdle_tests::repository::files;

use crate::plan_text::plan_text;

/// A name, and the files of this workload.
pub type Workload = (&'static str, Vec<String>);

/// The plans of the repository.
#[must_use]
pub fn plans() -> Workload {
    let plans = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/"));
    ("plans", plans.map(|file| file.text).collect())
}

/// One megabyte of plans in one file.
#[must_use]
pub fn one_megabyte() -> Workload {
    ("1 MB", vec![plan_text(1, 1_000_000)])
}

/// Ten times as much: what is linear is no slower here.
#[must_use]
pub fn ten_megabytes() -> Workload {
    ("10 MB", vec![plan_text(10, 10_000_000)])
}
