//! Generates the parser of the tree-sitter grammar, and compiles it with its scanner.

use std::env;
use std::path::{Path, PathBuf};

use tree_sitter_generate::{ABI_VERSION_MAX, OptLevel, generate_parser_in_directory};

fn main() {
    let grammar = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tree-sitter");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names a folder"));
    let (file, scanner) = (grammar.join("grammar.js"), grammar.join("src/scanner.c"));
    for file in [&file, &scanner, &grammar.join("tree-sitter.json")] {
        println!("cargo:rerun-if-changed={}", file.display());
    }
    let mut found = Vec::new();
    let generated = generate_parser_in_directory(
        &grammar,
        Some(&out),
        Some(&file),
        ABI_VERSION_MAX,
        None,
        Some("node"),
        true,
        OptLevel::default(),
        &mut found,
    );
    if let Err(error) = generated {
        panic!("{}: {error}", file.display());
    }
    cc::Build::new().include(&out).file(out.join("parser.c")).file(scanner).warnings(false).compile("mdle");
}
