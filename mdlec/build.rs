//! Packs the sources from which executables are built.

#![allow(clippy::disallowed_methods, reason = "what is done here is I/O")]

#[path = "build/sources.rs"]
mod sources;
#[path = "build/targets.rs"]
mod targets;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Cargo watches the package by itself only as long as a build script names nothing, and `sources` does.
    println!("cargo::rerun-if-changed=src");
    sources::pack()
}
