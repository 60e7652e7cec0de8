//! Texts on which an executable depends, for its answer to `--version`; they contain neither places nor times.

use mdle_files::Target;

/// Returns the version text: the hash of `texts`, which are those of the plan and of the files that it uses, the
/// target, the hash of its alphabet and of the shared alphabets, and the version of the compiler.
pub(super) fn version<'t>(texts: impl Iterator<Item = &'t [u8]>, target: &Target) -> String {
    format!(
        "text {}, target {}, alphabet {}, mdlec {}",
        hash(texts),
        target.alphabet.name,
        hash(target.texts().map(str::as_bytes)),
        env!("CARGO_PKG_VERSION")
    )
}

/// Returns twelve hexadecimal digits that identify a sequence of texts.
fn hash<'t>(texts: impl Iterator<Item = &'t [u8]>) -> String {
    let mut hasher = blake3::Hasher::new();
    for text in texts {
        // The length keeps a text apart from the next.
        hasher.update(&text.len().to_le_bytes()).update(text);
    }
    hasher.finalize().to_hex()[..12].to_owned()
}
