//! Makes two parsers of plans from one grammar: `syntax/grammar.rs`, and `without_recovery.rs`, which stops at the first error.
//!
//! A parser that recovers from errors pays for it with every token, for its stack has room for them, and its tables are larger.

use std::env;
use std::error::Error;
use std::fs;
use std::path::PathBuf;

/// Writes the parsers to `$OUT_DIR`.
pub(crate) fn make() -> Result<(), Box<dyn Error>> {
    lalrpop::process_src()?;
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let folder = out.join("grammars");
    fs::create_dir_all(&folder)?;
    let grammar = without_recovery(&fs::read_to_string("src/syntax/grammar.lalrpop")?);
    fs::write(folder.join("without_recovery.lalrpop"), grammar)?;
    lalrpop::Configuration::new().emit_rerun_directives(false).set_in_dir(folder).set_out_dir(out).process()
}

/// The grammar less the alternatives that recover from an error, each of which is a line of its own.
fn without_recovery(grammar: &str) -> String {
    grammar.lines().filter(|line| !line.contains("<error:!>")).flat_map(|line| [line, "\n"]).collect()
}
