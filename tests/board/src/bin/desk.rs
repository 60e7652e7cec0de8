//! Runs the lab tour of the simulated robot on this machine. Writes what the robot senses to `sensed`, and prints to
//! `desk.out`.
//!
//! `desk BODY SEED` selects the body and the random seed.

/// The emitted plan, which `.ci/cross` writes to the folder `PLANS`.
#[cfg(not(target_os = "none"))]
mod lab_tour {
    include!(concat!(env!("PLANS"), "/lab_tour.rs"));
}
#[cfg(not(target_os = "none"))]
#[path = "../simulated.rs"]
mod simulated;

/// Runs the tour.
#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    simulated::tour()
}
