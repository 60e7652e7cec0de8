//! Executables on simulated and emulated robots, in simulated time.

mod atrv;
mod batches;
mod building;
mod contacts;
mod driven;
mod emulators;
mod lab_tour;
mod late_plans;
mod loaded;
mod module_faults;
mod modules;
mod movement;
mod odd_plans;
mod operands;
mod paths;
mod power;
mod processes;
mod record_tools;
mod records;
mod replays;
mod safety;
mod scout;
mod sessions;
mod several;
mod steps;
mod why;
