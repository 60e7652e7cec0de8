//! Workloads of the front end: the plans of the repository, and generated plans of one megabyte and of ten megabytes.

use mdle_tests::repository::files;

use crate::plan_text::plan_text;

/// A workload: its name, and the texts of its files.
pub type Workload = (&'static str, Vec<String>);

/// Returns the plans of the repository.
#[must_use]
pub fn plans() -> Workload {
    let plans = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/"));
    ("plans", plans.map(|file| file.text).collect())
}

/// Returns one megabyte of plans in one file.
#[must_use]
pub fn one_megabyte() -> Workload {
    ("1 MB", vec![plan_text(1, 1_000_000)])
}

/// Returns ten megabytes of plans in one file. A parser with linear run time is as fast on them, in bytes per second,
/// as on one megabyte.
#[must_use]
pub fn ten_megabytes() -> Workload {
    ("10 MB", vec![plan_text(10, 10_000_000)])
}
