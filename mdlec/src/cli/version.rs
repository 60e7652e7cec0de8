//! Texts on which an executable depends, for its answer to `--version`; they contain neither places nor times.

use mdle_files::{Input, Target};

/// Returns the version text: the hash of the plan's text and of the files that it uses, the target, the hash of
/// its alphabet and of the shared alphabets, and the version of the compiler.
pub(super) fn version(input: &Input, target: &Target) -> String {
    format!(
        "text {}, target {}, alphabet {}, mdlec {}",
        hash(input.texts()),
        target.alphabet.name,
        hash(target.texts()),
        env!("CARGO_PKG_VERSION")
    )
}

/// Returns twelve hexadecimal digits that identify a sequence of texts.
fn hash<'t>(texts: impl Iterator<Item = &'t str>) -> String {
    let mut hasher = blake3::Hasher::new();
    for text in texts {
        // The length keeps a text apart from the next.
        hasher.update(&text.len().to_le_bytes()).update(text.as_bytes());
    }
    hasher.finalize().to_hex()[..12].to_owned()
}
