//! Links the browser module with a stack as large as that of native programs, and with a limit on its memory.

#![allow(clippy::disallowed_methods, reason = "cargo tells a build script the target by its environment")]

/// Size of the stack, in bytes, for deeply nested plans.
const STACK: u32 = 8 << 20;
/// Maximum size of the memory, in bytes; a page that exceeds it gets an error and continues.
const MEMORY: u32 = 1 << 30;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "wasm32") {
        println!("cargo::rustc-link-arg-cdylib=-zstack-size={STACK}");
        println!("cargo::rustc-link-arg-cdylib=--max-memory={MEMORY}");
    }
}
