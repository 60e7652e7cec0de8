//! Runs the lab tour on a Cortex-M.
#![cfg_attr(target_os = "none", no_std, no_main)]

/// The emitted plan, which `.ci/cross` writes to the folder `PLANS`.
#[cfg(target_os = "none")]
mod lab_tour {
    include!(concat!(env!("PLANS"), "/lab_tour.rs"));
}
#[cfg(target_os = "none")]
#[path = "../semihosted.rs"]
mod semihosted;

/// Does nothing, because the executable for this machine is `desk`.
#[cfg(not(target_os = "none"))]
fn main() {}
