//! The program `mdle` with the module `template`.

use std::process::ExitCode;

use template::WayBack;

fn main() -> ExitCode {
    mdle::main_with(|library| library.registered("template", WayBack::declare))
}
