//! The arguments of `mdle new-module`.

use std::path::PathBuf;

use clap::{Arg, Command, value_parser};

/// Returns the definition of the command `mdle new-module` and its arguments.
pub(super) fn new_module() -> Command {
    Command::new("new-module")
        .about("Create a crate with a module of your own, and a program `mdle` that has it")
        .arg(
            Arg::new("name")
                .value_name("NAME")
                .help("Name of the module and of its folder, which is created in the current folder")
                .required(true),
        )
        .arg(
            Arg::new("checkout")
                .long("checkout")
                .value_name("FOLDER")
                .help("Checkout of mdle, whose packages the crate uses [default: ../mdle from the new folder]")
                .value_parser(value_parser!(PathBuf)),
        )
        .after_help("Exit status: 0, or 2 if the folder cannot be created")
}
