//! Embeds in mdlec the sources from which executables are built.

#![allow(clippy::disallowed_methods, reason = "what is done here is I/O")]

#[path = "build/sources.rs"]
mod sources;
#[path = "build/targets.rs"]
mod targets;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Without any `rerun-if-changed`, cargo would watch the whole package. `sources` prints such lines, so the
    // package's own sources have to be named as well.
    println!("cargo::rerun-if-changed=src");
    sources::pack()
}
