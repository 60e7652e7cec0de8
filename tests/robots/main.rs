//! Tests of executables on simulated and emulated robots, in simulated time.

mod atrv;
mod batches;
mod building;
#[allow(unreachable_pub, reason = "the book shows the module as that of a library")]
mod closing;
mod contacts;
mod crowds;
mod driven;
mod emulators;
mod formation;
mod hanging;
mod lab_tour;
mod late_plans;
mod live_maps;
mod loaded;
mod meetings;
mod module_faults;
mod module_reads;
mod modules;
mod movement;
mod navigation;
mod odd_plans;
mod odd_records;
mod operands;
mod paths;
mod power;
mod processes;
mod pursuit;
mod record_tools;
mod records;
mod repeated_runs;
mod replays;
mod safety;
mod scenario_records;
mod scout;
mod sent_names;
mod sessions;
mod several;
mod shared_modules;
mod sound;
mod steps;
mod views;
#[allow(unreachable_pub, reason = "the book shows the module as that of a library")]
mod wall;
mod ways_back;
mod why;
