//! Writes the code that the benchmarks compare: the Rust that mdlec emits for T(N), and the same machine written for
//! each peer.

#[path = "build/peers.rs"]
mod peers;
#[path = "build/plan.rs"]
mod plan;

use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=alphabet.mdle");
    let folder = env::var_os("OUT_DIR").expect("cargo names a folder");
    let write =
        |name: &str, text: String| fs::write(Path::new(&folder).join(name), text).expect("a folder to write to");
    let thousands = env::var_os("CARGO_FEATURE_THOUSANDS").is_some();
    for atoms in [8, 1_000].into_iter().filter(|atoms| *atoms == 8 || thousands) {
        write(&format!("plan_{atoms}.rs"), plan::emitted(&plan::written_out(atoms)));
        write(&format!("match_{atoms}.rs"), peers::matching(atoms));
        write(&format!("statig_{atoms}.rs"), peers::statig(atoms));
        write(&format!("smlang_{atoms}.rs"), peers::smlang(atoms));
    }
    for (name, text) in [("rows_8", plan::written_out(8)), ("rows_rising_8", plan::rising(8))] {
        write(&format!("{name}.rs"), plan::rows(&text));
        write(&format!("{name}.mdle"), text);
    }
    if thousands {
        for atoms in [100, 10_000, 100_000] {
            write(&format!("plan_{atoms}.rs"), plan::emitted(&plan::written_out(atoms)));
        }
        for passes in [2, 5_000, 1_000_000_000] {
            write(&format!("looped_{passes}.rs"), plan::emitted(&plan::looped(passes)));
        }
    }
}
