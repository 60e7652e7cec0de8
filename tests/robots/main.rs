//! Executables on simulated and emulated robots, in simulated time.

mod atrv;
mod batches;
mod emulators;
mod lab_tour;
mod loaded;
mod modules;
mod movement;
mod operands;
mod paths;
mod power;
mod safety;
mod scout;
mod several;
