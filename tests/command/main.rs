//! Tests of the command line of `mdlec` and `mdle`: options, output, messages and limits, through the real binaries.

mod bad_input;
mod budgets;
mod command_line;
mod cut_short;
mod editor;
mod explain;
mod help;
mod hostile_text;
mod large_input;
mod mdle_modules;
mod mdle_plans;
mod mdle_recorder;
mod mdle_run;
mod mdle_shell;
mod mdle_terminal;
mod mdle_test;
mod mdle_test_outputs;
mod mdle_test_random;
mod newcomer;
mod other_machines;
mod proposals;
mod random_input;
mod reproducible;
mod settings;
mod strange_files;
mod used_files;
